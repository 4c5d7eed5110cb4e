//! An evening is played: the room and the vehicles are the product's, their messages go as chance will have
//! it, and after every step the room's laws and the vehicles' own are looked at.

use std::collections::{BTreeMap, BTreeSet};

use agent_core::model::{Atom, FactChange, Symbol, Time};
use agent_core::planner::{AnyPlanner, PlannerKind, Settings};
use agent_core::protocol::{Durable, Event, GoalRequest, Happening, Input, Rows, Urgency};
use agent_core::service::{Body, Message};
use executor_sim::{Room, Spot, Tempo};
use experiments::{Course, Noise, ROOM, Team};
use vehicle::{Vehicle, configuration, equipment};

use super::judge::Judge;
use super::scene::{Incident, Scene};

pub type Member = Vehicle<AnyPlanner>;

/// An evening that is going on.
pub struct Evening {
    pub scene: Scene,
    pub team: Team<Room, Member>,
    pub judge: Judge,
    pub course: Course,
    pub dead: BTreeSet<Symbol>,
    /// Who was not there at some time.
    pub was_dead: BTreeSet<Symbol>,
    /// Who was started again without a journal.
    pub forgetful: BTreeSet<Symbol>,
    journals: BTreeMap<Symbol, Rows>,
    epochs: BTreeMap<Symbol, u64>,
    events: Vec<(Symbol, Event)>,
    goals: u32,
    seed: u64,
}

fn change(so: bool, name: &str, args: &[&Symbol]) -> FactChange {
    let fact = Atom::new(name, args.iter().map(|arg| arg.as_str()));
    match so {
        true => FactChange::Add(fact),
        false => FactChange::Remove(fact),
    }
}

impl Evening {
    pub fn new(seed: u64, scene: Scene) -> Self {
        let room = Room::new(&scene.restaurant).expect("the restaurant is in order");
        let room = room.with_tempo(Tempo::varied(seed, 0.15));
        let names: Vec<Symbol> = scene.restaurant.room().vehicles.keys().cloned().collect();
        let vehicles = names
            .iter()
            .map(|name| (name.clone(), make(&scene, name, 1)));
        let mut team = Team::new(room, vehicles.collect());
        if let Some(rates) = scene.noise {
            team = team.with_noise(Noise::new(seed, rates));
        }
        Self {
            judge: Judge::new(team.room()),
            team,
            course: Course::default(),
            dead: BTreeSet::new(),
            was_dead: BTreeSet::new(),
            forgetful: BTreeSet::new(),
            journals: BTreeMap::new(),
            epochs: names.into_iter().map(|name| (name, 1)).collect(),
            events: Vec::new(),
            goals: 0,
            seed,
            scene,
        }
    }

    /// All incidents, each in its time.
    pub fn play(&mut self) {
        for (at, incident) in self.scene.incidents.clone() {
            self.until(at);
            self.happen(incident);
            self.look();
        }
        let last = self.scene.last();
        self.until(last);
    }

    pub fn until(&mut self, until: Time) {
        while self.team.step(until) {
            self.look();
        }
        self.team.run_until(until);
        self.look();
    }

    fn happen(&mut self, incident: Incident) {
        match incident {
            Incident::Take(bottle) => self.take(&bottle),
            Incident::Put {
                bottle,
                place,
                edge,
            } => self.put(&bottle, &place, edge),
            Incident::Block(place) => {
                let change = change(true, "blocked", &[&place]);
                self.team.change(vec![change]);
            }
            Incident::Free(place) => {
                let change = change(false, "blocked", &[&place]);
                self.team.change(vec![change.clone()]);
                self.tell_anybody(vec![change]);
            }
            Incident::Spill(place, whom) => {
                let spill = change(true, "spill", &[&place]);
                self.team.change(vec![spill]);
                self.judge.spilt(&place);
                self.goal("clean", &place, whom);
            }
            Incident::Clear(table) => self.goal("clear", &table, None),
            Incident::Kill(whom) => {
                if let Some(mut dead) = self.team.kill(whom.as_str()) {
                    let rows = dead.write_down().into_iter();
                    let rows = rows.filter_map(|row| Some((row.key, row.value?)));
                    self.journals.insert(whom.clone(), rows.collect());
                    self.was_dead.insert(whom.clone());
                    self.dead.insert(whom);
                }
            }
            Incident::Restart(whom, remembers) => self.restart(&whom, remembers),
        }
    }

    fn restart(&mut self, whom: &Symbol, remembers: bool) {
        let Some(rows) = self.journals.remove(whom) else {
            return;
        };
        let epoch = self.epochs.entry(whom.clone()).or_default();
        *epoch += 1;
        let mut again = make(&self.scene, whom, *epoch);
        if remembers {
            let recalled = again.recall(&rows);
            self.assert(recalled.is_ok(), &format!("{recalled:?}"));
        } else {
            self.forgetful.insert(whom.clone());
        }
        self.dead.remove(whom);
        self.team.restart(whom.as_str(), again, remembers);
    }

    fn take(&mut self, bottle: &Symbol) {
        let Some(known) = self.team.room().things().bottle(bottle.as_str()) else {
            return;
        };
        if known.given_to.is_some() {
            return;
        }
        let gone = match &known.spot {
            Spot::Proper { node } => change(false, "stands", &[bottle, node]),
            Spot::Edge { node } => change(false, "edge", &[bottle, node]),
            Spot::Hand { .. } => change(false, "holding", &[bottle]),
            Spot::Slot { slot, .. } => change(false, "loaded", &[bottle, slot]),
            Spot::Away => return,
        };
        self.judge.moved(bottle, Spot::Away);
        self.team.change(vec![gone]);
    }

    fn put(&mut self, bottle: &Symbol, place: &Symbol, edge: bool) {
        let Some(known) = self.team.room().things().bottle(bottle.as_str()) else {
            return;
        };
        let mut told = Vec::new();
        match &known.spot {
            _ if known.given_to.is_some() => return,
            Spot::Hand { .. } | Spot::Slot { .. } => return,
            Spot::Proper { node } => told.push(change(false, "stands", &[bottle, node])),
            Spot::Edge { node } => told.push(change(false, "edge", &[bottle, node])),
            Spot::Away => {}
        }
        let node = place.clone();
        let (name, spot) = match edge {
            true => ("edge", Spot::Edge { node }),
            false => ("stands", Spot::Proper { node }),
        };
        told.push(change(true, name, &[bottle, place]));
        self.judge.moved(bottle, spot);
        self.team.change(told.clone());
        self.tell_anybody(told);
    }

    /// Somebody who is there is told.
    fn tell_anybody(&mut self, changes: Vec<FactChange>) {
        let vehicles = self.scene.restaurant.room().vehicles.keys();
        let there: Vec<&Symbol> = vehicles.filter(|name| !self.dead.contains(*name)).collect();
        // Another one each time.
        let chosen = there.get(self.goals as usize % there.len().max(1));
        self.goals += 1;
        if let Some(name) = chosen.map(|name| (*name).clone()) {
            self.team.tell(name.as_str(), Input::Observation(changes));
        }
    }

    /// A user's emergency, for that vehicle or for whoever can do it.
    fn goal(&mut self, task: &str, place: &Symbol, whom: Option<Symbol>) {
        self.goals += 1;
        let request = GoalRequest {
            id: Some(format!("user-{}", self.goals).into()),
            tasks: vec![Atom::new(task, [place.as_str()])],
            urgency: Urgency::Emergency,
            priority: 0,
            deadline: None,
        };
        let vehicles = self.scene.restaurant.room().vehicles.keys();
        let mut there = vehicles.filter(|name| !self.dead.contains(*name));
        let Some(first) = there.next().cloned() else {
            return;
        };
        match whom.filter(|name| !self.dead.contains(name)) {
            Some(name) => {
                self.team.tell(name.as_str(), Input::Goal(request));
            }
            None => {
                let message = Message {
                    by: "user".into(),
                    at: self.team.now(),
                    body: Body::Goal(request),
                };
                self.team.tell(first.as_str(), Input::Local(message));
            }
        }
    }

    /// Nothing has changed that nobody has told of.
    fn look(&mut self) {
        let new = self.team.take_events();
        if new.is_empty() {
            return;
        }
        for (who, event) in new {
            if who != ROOM {
                self.course.note(&who, &event);
            }
            self.events.push((who, event));
        }
        for name in self.epochs.keys() {
            if let Some(vehicle) = self.team.vehicle(name.as_str()) {
                vehicle.mind().check();
            }
        }
        let lawful = self.team.room().check();
        self.assert(lawful.is_ok(), &format!("{lawful:?}"));
        let lawful = self.judge.look(self.team.room());
        self.assert(lawful.is_ok(), &format!("{lawful:?}"));
    }

    /// The vehicles that are there.
    pub fn living(&self) -> impl Iterator<Item = (&Symbol, &Member)> {
        let names = self.epochs.keys();
        names.filter_map(|name| Some((name, self.team.vehicle(name.as_str())?)))
    }

    /// A bottle of that kind that nobody was given and somebody who is there could bring.
    pub fn to_be_had(&self, kind: &Symbol) -> Option<String> {
        let mut bottles = self.team.room().things().bottles();
        let found = bottles.find(|(_, bottle)| {
            let is_in_reach = match &bottle.spot {
                Spot::Proper { node } => node == "kitchen",
                Spot::Edge { .. } => true,
                Spot::Hand { vehicle } | Spot::Slot { vehicle, .. } => !self.dead.contains(vehicle),
                Spot::Away => false,
            };
            bottle.kind == *kind && bottle.given_to.is_none() && !bottle.used && is_in_reach
        });
        found.map(|(name, bottle)| format!("{name}, which is {}", bottle.spot))
    }

    #[track_caller]
    pub fn assert(&self, so: bool, what: &str) {
        assert!(
            so,
            "SEED={} at {}: {what}\n{}\n{}\n{what}",
            self.seed,
            self.team.now(),
            self.story(),
            self.scene.tell(),
        );
    }

    /// What happened, in short.
    fn story(&self) -> String {
        let from = std::env::var("FROM").ok();
        let from: f64 = from.and_then(|it| it.parse().ok()).unwrap_or_default();
        let lines = self.events.iter().filter_map(|(who, event)| {
            let dull = matches!(
                event.what,
                Happening::PlanSelected { .. } | Happening::FactsTold { .. }
            );
            if dull || event.at.secs() < from {
                return None;
            }
            let goal = event.goal.as_ref().map_or("", |it| it.as_str());
            let at = event.at.secs();
            Some(format!("{at:.1} {who} {goal} {:?}", event.what))
        });
        lines.collect::<Vec<_>>().join("\n")
    }
}

fn make(scene: &Scene, name: &Symbol, epoch: u64) -> Member {
    let restaurant = &scene.restaurant;
    let configuration = configuration(restaurant, name.as_str(), epoch).expect("it is there");
    let equipment = equipment(restaurant, name.as_str(), 1.0);
    let planner = AnyPlanner::new(PlannerKind::Graph, Settings::default());
    vehicle::vehicle(configuration, equipment, scene.together, planner)
}
