//! One reality for several vehicles: their bodies, the things they handle, guests, and a clock.
//!
//! A [`Room`] is an executor to each of its vehicles. Who instructs drives the mover of that name; each
//! is told what its own body and eyes know, and nothing else. What the parts of a mover do, and how they
//! are suspended, is in `docs/executor.md`.

mod chronicle;
mod durable;
mod laws;
mod mover;
mod opening;
mod reach;
mod sight;
mod telling;
mod tempo;
mod things;
mod turn;
mod users;

use std::collections::{BTreeMap, VecDeque};
use std::convert::Infallible;

use agent_core::model::{Symbol, Time};
use agent_core::protocol::{Answer, Input, Instruction, Ledger, Machine, Output, Reply};
use maps::Restaurant;

use crate::parts::{Job, Part, PartName, PartsError, PartsVocabulary};
use crate::refusal::refuse;
use crate::{FaultRates, Faults, Floor, FloorError, MoverSpec, Place, SetupError, SimulatedRobot};

use chronicle::Chronicle;

pub use chronicle::{Deed, Doing};
pub use mover::Mover;
pub use tempo::{Pace, Tempo};
pub use things::{Bottle, Guest, Spot, Things, Whereabouts};
pub use users::about as users_speak_about;

/// What a room is called as an executor.
pub const ROOM: &str = "room";

/// Why a room could not be set up, to be read after "cannot set up the room: ".
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RoomError {
    /// The floor plan.
    #[error(transparent)]
    Floor(#[from] FloorError),
    /// What actions are to a vehicle.
    #[error(transparent)]
    Vocabulary(#[from] PartsError),
    /// The base of a vehicle.
    #[error("{vehicle}: {why}")]
    Base {
        /// Whose.
        vehicle: Symbol,
        /// What is wrong with it.
        why: SetupError,
    },
}

/// Reality for several vehicles.
///
/// [`Input::Observation`] tells it what users and scenarios do: `(not (stands cola1 kitchen))` takes a
/// bottle away, `(seated ann table1)` has a guest sit down, `(spill table3)` spills something, and so
/// on; facts about doors go to the floor. What makes no sense changes nothing.
///
/// Nothing ticks; between two events everything is a formula of the time.
#[derive(Clone, Debug)]
pub struct Room {
    vocabulary: PartsVocabulary,
    movers: BTreeMap<Symbol, Mover>,
    names: Names,
    spec: MoverSpec,
    tempo: Tempo,
    things: Things,
    chronicle: Chronicle,
    now: Time,
    outputs: VecDeque<Output<Infallible>>,
    ledger: Ledger,
}

/// Names that never change.
#[derive(Clone, Debug)]
struct Names {
    vehicles: Vec<Symbol>,
    kinds: Vec<Symbol>,
    entrance: Vec<Symbol>,
    tables: Vec<Symbol>,
}

impl Room {
    /// The room of a restaurant as it opens.
    ///
    /// # Errors
    /// What cannot be.
    pub fn new(restaurant: &Restaurant) -> Result<Self, RoomError> {
        let plan = restaurant.room();
        let level = restaurant.level();
        let floor = Floor::try_from(&**restaurant.site())?;
        let map = maps::whole_node_level(restaurant.site()).facts;
        let vocabulary = PartsVocabulary::new(&level.domain, &level.model, map)?;
        let spec = MoverSpec {
            max_speed_m_s: plan.mover.speed_m_s,
            acceleration_m_s2: plan.mover.acceleration_m_s2,
            deceleration_m_s2: plan.mover.deceleration_m_s2,
            turn_rate_rad_s: plan.mover.turn_rate_rad_s,
        };
        let mut movers = BTreeMap::new();
        for (name, vehicle) in &plan.vehicles {
            let has = |part: &str| vehicle.parts.contains(&Symbol::from(part));
            let start = Place::at(vehicle.start.as_str());
            let base = has("base").then(|| {
                let model = vocabulary.of_the_base();
                let none = Faults::none();
                SimulatedRobot::new(&level.domain, model, floor.clone(), spec, start, none)
            });
            let base = base.transpose().map_err(|why| RoomError::Base {
                vehicle: name.clone(),
                why,
            })?;
            let parts = [PartName::Arm, PartName::Eyes, PartName::Voice].into_iter();
            let parts = parts
                .filter(|part| has(part.as_str()))
                .map(|part| (part, Part::new(part)));
            let mover = Mover {
                name: name.clone(),
                start: vehicle.start.clone(),
                base,
                parts: parts.collect(),
                slots: match has("tray") {
                    true => restaurant.slots().cloned().collect(),
                    false => Vec::new(),
                },
                gone: false,
                ways: BTreeMap::new(),
                ahead: None,
                told: Vec::new(),
                told_of: None,
            };
            movers.insert(name.clone(), mover);
        }
        let of_kind = |kind: &str| {
            let nodes = restaurant.site().nodes();
            let nodes = nodes.filter(|node| node.kind() == Some(kind));
            nodes.map(|node| node.name().clone()).collect()
        };
        let mut room = Self {
            vocabulary,
            names: Names {
                vehicles: movers.keys().cloned().collect(),
                kinds: plan.kinds().into_iter().cloned().collect(),
                entrance: of_kind("entrance"),
                tables: of_kind("table"),
            },
            movers,
            spec,
            tempo: Tempo::even(),
            things: Things::of(restaurant),
            chronicle: Chronicle::default(),
            now: Time::ZERO,
            outputs: VecDeque::new(),
            ledger: Ledger::default(),
        };
        // What the bases have learnt at their start is what they are told first.
        let names = room.names.vehicles.clone();
        for name in &names {
            room.take_from_base(name);
        }
        Ok(room)
    }

    /// The same with things that take more or less time than the model says.
    #[must_use]
    pub fn with_tempo(mut self, tempo: Tempo) -> Self {
        self.tempo = tempo;
        self
    }

    /// The same with a part of a vehicle that does not always do as it is told.
    #[must_use]
    pub fn with_faults(mut self, vehicle: &str, part: PartName, faults: Faults) -> Self {
        if let Some(mover) = self.movers.get_mut(&Symbol::from(vehicle)) {
            match (part, &mut mover.base, mover.parts.get_mut(&part)) {
                (PartName::Base, Some(base), _) => base.set_faults(faults),
                (_, _, Some(part)) => part.set_faults(faults),
                _ => {}
            }
        }
        self
    }

    /// The same with chance in all parts of all vehicles.
    #[must_use]
    pub fn with_chance(mut self, seed: u64, rates: FaultRates) -> Self {
        let mut seed = seed;
        for vehicle in self.names.vehicles.clone() {
            for part in [
                PartName::Base,
                PartName::Arm,
                PartName::Eyes,
                PartName::Voice,
            ] {
                seed = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(1);
                self = self.with_faults(vehicle.as_str(), part, Faults::random(seed, rates));
            }
        }
        self
    }

    /// When something was last seen to.
    pub fn time(&self) -> Time {
        self.now
    }

    /// What is there beside the vehicles.
    pub fn things(&self) -> &Things {
        &self.things
    }

    /// All vehicles' bodies, by name.
    pub fn movers(&self) -> impl Iterator<Item = &Mover> {
        self.movers.values()
    }

    /// The body of that vehicle.
    pub fn mover(&self, vehicle: &str) -> Option<&Mover> {
        self.movers.get(&Symbol::from(vehicle))
    }

    /// All that users may speak of, by what it is.
    pub fn names(&self) -> [(&'static str, Vec<&Symbol>); 5] {
        [
            ("bottle", self.things.bottles.keys().collect()),
            ("guest", self.things.guests.keys().collect()),
            ("kind", self.names.kinds.iter().collect()),
            ("node", self.things.places.iter().collect()),
            ("vehicle", self.names.vehicles.iter().collect()),
        ]
    }

    /// The latest things that were done, oldest first.
    pub fn done(&self) -> impl DoubleEndedIterator<Item = &Deed> + ExactSizeIterator {
        self.chronicle.kept.iter()
    }

    /// How many things were done, over all starts.
    pub fn done_count(&self) -> u64 {
        self.chronicle.count
    }

    fn instructed(&mut self, from: &Symbol, instruction: Instruction) -> Answer {
        if !self.movers.contains_key(from) {
            let known: Vec<&str> = self.names.vehicles.iter().map(Symbol::as_str).collect();
            let known = known.join(", ");
            return rejected(format!(
                "nothing here is driven by {from}; there are {known}"
            ));
        }
        match self.which(from, &instruction) {
            Ok((PartName::Base, to)) => self.instruct_base(from, instruction, to),
            Ok((part, _)) => self.instruct_part(from, part, instruction),
            Err(reason) => rejected(reason),
        }
    }

    /// Which part that is for; and if it is a drive, where it leads.
    fn which(
        &self,
        vehicle: &Symbol,
        instruction: &Instruction,
    ) -> Result<(PartName, Option<Symbol>), String> {
        let Some(mover) = self.movers.get(vehicle) else {
            return Err(format!("there is no vehicle {vehicle}"));
        };
        let known = mover.part_of(instruction.id());
        let Instruction::Execute { action, .. } = instruction else {
            let first = mover.parts.keys().next().copied();
            let way = mover.ways.get(instruction.id()).cloned();
            // What nobody knows anybody can say so.
            let anybody = match (&mover.base, first) {
                (None, Some(part)) => part,
                _ => PartName::Base,
            };
            return Ok((known.unwrap_or(anybody), way));
        };
        let job = self.vocabulary.job(action)?;
        let part = job.part();
        let has = match part {
            PartName::Base => mover.base.is_some(),
            _ => mover.parts.contains_key(&part),
        };
        if !has {
            let article = match part {
                PartName::Arm => "an ",
                PartName::Eyes => "",
                PartName::Base | PartName::Voice => "a ",
            };
            return Err(format!(
                "{vehicle} has no {part}: {action} needs {article}{part}"
            ));
        }
        match job {
            Job::Base { to } => Ok((part, to)),
            Job::Part { .. } => Ok((part, None)),
        }
    }

    /// The next moment in which something happens by itself.
    fn next_due(&self) -> Option<Time> {
        let movers = self.movers.values().filter_map(Mover::due);
        movers
            .chain(self.things.next_plan().map(|(time, _)| time))
            .min()
    }

    /// Lets everything happen that is due, in its order.
    fn advance(&mut self, now: Time) {
        while let Some(time) = self.next_due().filter(|time| *time <= now) {
            self.now = self.now.max(time);
            while let Some((_, guest)) = self.things.next_plan().filter(|(at, _)| *at <= time) {
                self.things.follow_plan(&guest);
            }
            for name in self.names.vehicles.clone() {
                self.wake(&name);
            }
            self.after();
        }
        self.now = self.now.max(now);
    }
}

fn rejected(reason: String) -> Answer {
    Answer::Rejected { reason }
}

impl Machine for Room {
    type In = Infallible;
    type Out = Infallible;

    fn handle(&mut self, now: Time, input: Input<Infallible>) -> Option<Reply> {
        // What was due has happened before anybody speaks.
        self.advance(now);
        let reply = match input {
            Input::Instruction { from, instruction } => {
                let answer = self.instructed(&from, instruction);
                Some(Reply::Instruction(answer))
            }
            Input::Observation(changes) => {
                self.somebody_changes(&changes);
                None
            }
            Input::Neighbour { name, there } => {
                self.neighbour(&name, there);
                None
            }
            Input::Reborn { name } => {
                self.reborn(&name);
                None
            }
            other => refuse(other, "the room"),
        };
        self.after();
        self.advance(now);
        reply
    }

    fn poll_output(&mut self) -> Option<Output<Infallible>> {
        self.outputs.pop_front()
    }

    fn wake_at(&self) -> Option<Time> {
        self.next_due()
    }

    fn wind_down(&mut self, now: Time) {
        self.advance(now);
        for name in self.names.vehicles.clone() {
            self.stop_what_can_be(&name);
        }
        self.after();
        self.advance(now);
    }

    fn rests(&self) -> bool {
        self.movers.values().all(|mover| {
            let mut parts = mover.parts.values();
            let still = parts.all(|part| part.due().is_none());
            still && mover.base.as_ref().is_none_or(Machine::rests)
        })
    }
}
