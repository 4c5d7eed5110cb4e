//! Vehicles and their room, made from a setting and run until everybody is served.

use std::collections::BTreeMap;

use agent_core::language::parse_fact_change;
use agent_core::model::{FactChange, Symbol, Time};
use agent_core::planner::{AnyPlanner, PlannerKind, Settings};
use agent_core::protocol::Input;
use executor_sim::{Room, Tempo};
use vehicle::Vehicle;

use super::setting::Setting;
use super::{CHANCE, Course, ROOM, Team};
use crate::ExperimentError;

/// Nobody waits longer for a drink.
const AT_MOST: Time = Time(24 * 3_600_000_000);

type Member = Vehicle<AnyPlanner>;

/// A crew at work.
pub(super) struct Crew {
    team: Team<Room, Member>,
    course: Course,
}

impl Crew {
    fn new(setting: &Setting, seed: Option<u64>) -> Result<Self, ExperimentError> {
        let restaurant = &setting.restaurant;
        let mut room = Room::new(restaurant).map_err(ExperimentError::setup)?;
        if let Some(seed) = seed {
            room = room.with_tempo(Tempo::varied(seed, CHANCE));
        }
        let names = restaurant.room().vehicles.keys();
        let vehicles = names.map(|name| Ok((name.clone(), member(setting, name)?)));
        let vehicles: Result<BTreeMap<Symbol, Member>, ExperimentError> = vehicles.collect();
        Ok(Self {
            team: Team::new(room, vehicles?),
            course: Course::default(),
        })
    }

    /// Tells a vehicle facts, as a user would.
    pub(super) fn tell(&mut self, vehicle: &str, facts: &[&str]) -> Result<(), ExperimentError> {
        let facts: Result<Vec<FactChange>, _> =
            facts.iter().map(|fact| parse_fact_change(fact)).collect();
        let facts = facts.map_err(ExperimentError::setup)?;
        self.team.tell(vehicle, Input::Observation(facts));
        self.note();
        Ok(())
    }

    /// Lets time pass until then.
    pub(super) fn run_until(&mut self, until: Time) {
        self.team.run_until(until);
        self.note();
    }

    fn note(&mut self) {
        for (who, event) in self.team.take_events() {
            // What the room tells of its movers, their vehicles tell too.
            if who != ROOM {
                self.course.note(&who, &event);
            }
        }
    }
}

/// A vehicle that has just been made.
fn member(setting: &Setting, name: &Symbol) -> Result<Member, ExperimentError> {
    let restaurant = &setting.restaurant;
    let configuration =
        vehicle::configuration(restaurant, name.as_str(), 1).map_err(ExperimentError::setup)?;
    let equipment = vehicle::equipment(restaurant, name.as_str(), 1.0);
    let planner = AnyPlanner::new(PlannerKind::Graph, Settings::default());
    Ok(vehicle::vehicle(
        configuration,
        equipment,
        setting.together,
        planner,
    ))
}

/// An evening, until every guest is served. `begin` does what somebody does at its beginning.
pub(super) fn serve(
    name: &str,
    setting: &Setting,
    seed: Option<u64>,
    begin: impl FnOnce(&mut Crew) -> Result<(), ExperimentError>,
) -> Result<Course, ExperimentError> {
    let mut crew = Crew::new(setting, seed)?;
    begin(&mut crew)?;
    let guests = setting.restaurant.room().guests.len();
    while crew.course.served.len() < guests && crew.team.step(AT_MOST) {
        crew.note();
    }
    let broken = crew.team.room().check();
    broken.map_err(|why| ExperimentError::course(name, why))?;
    Ok(crew.course)
}
