//! A role as its neighbours know it, whatever machine is inside.

use std::collections::BTreeMap;

use agent_core::agent::Agent;
use agent_core::model::{Fact, FactChange, Symbol, Time};
use agent_core::planner::AnyPlanner;
use agent_core::protocol::{Arrival, Effect, Envelope, Input, Row, Rows, Station, Unreadable};
use executor_sim::{Controller, MotorCommand, Sensor};

use crate::mutant::{Mutant, Wayward};
use crate::scenario::Who;

/// The way back to whoever waits for a response.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Way {
    /// To a user, about that request.
    User(u32),
    /// To a neighbour, as it was when it asked.
    Neighbour {
        /// Who.
        who: Who,
        /// Its line.
        line: u64,
        /// Its epoch.
        epoch: u64,
        /// Through which of its channels.
        kind: Kind,
    },
}

/// What a channel carries.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub enum Kind {
    /// Down.
    Instruction,
    /// Up.
    Report,
    /// Between controller and world.
    Local,
}

/// An agent that may have a mistake in it.
pub type SomeAgent = Wayward<Agent<AnyPlanner>>;
/// A controller that may have a mistake in it.
pub type SomeController = Wayward<Controller>;

/// A process: what is gone when it dies.
#[derive(Clone, Debug)]
pub enum Role {
    /// A parent or a child.
    Agent(Box<Station<SomeAgent, Way>>),
    /// A robot's controller.
    Controller(Box<Station<SomeController, Way>>),
}

/// An arrival of any role.
pub type AnyArrival = Arrival<Sensor>;
/// An effect of any role.
pub type AnyEffect = Effect<MotorCommand, Way>;

macro_rules! station {
    ($role:expr, $station:ident => $value:expr) => {
        match $role {
            Role::Agent($station) => $value,
            Role::Controller($station) => $value,
        }
    };
}

impl Role {
    /// An agent that starts in that epoch and finds those rows.
    ///
    /// # Errors
    /// If it cannot read them.
    pub fn agent(
        who: Who,
        epoch: u64,
        agent: Agent<AnyPlanner>,
        rows: &Rows,
        mutant: Option<Mutant>,
    ) -> Result<Self, Unreadable> {
        let agent = Wayward::new(agent, mutant);
        Station::recall(who.name().into(), epoch, agent, rows)
            .map(|station| Self::Agent(Box::new(station)))
    }

    /// A controller that starts in that epoch and finds those rows.
    ///
    /// # Errors
    /// If it cannot read them.
    pub fn controller(
        who: Who,
        epoch: u64,
        controller: Controller,
        rows: &Rows,
        mutant: Option<Mutant>,
    ) -> Result<Self, Unreadable> {
        let controller = Wayward::new(controller, mutant);
        Station::recall(who.name().into(), epoch, controller, rows)
            .map(|station| Self::Controller(Box::new(station)))
    }

    /// Takes one arrival.
    pub fn handle(&mut self, now: Time, arrival: AnyArrival, way: Option<Way>) {
        match self {
            Self::Agent(station) => {
                if let Some(arrival) = for_agent(arrival) {
                    station.handle(now, arrival, way);
                }
            }
            Self::Controller(station) => station.handle(now, arrival, way),
        }
    }

    /// See [`Station::write_down`].
    pub fn write_down(&mut self) -> Option<Vec<Row>> {
        station!(self, station => station.write_down())
    }

    /// See [`Station::wants_writing`].
    pub fn wants_writing(&self) -> bool {
        station!(self, station => station.wants_writing())
    }

    /// See [`Station::written`].
    pub fn written(&mut self) {
        station!(self, station => station.written());
    }

    /// See [`Station::poll_effect`].
    pub fn poll_effect(&mut self) -> Option<AnyEffect> {
        match self {
            Self::Agent(station) => station.poll_effect().map(of_agent),
            Self::Controller(station) => station.poll_effect(),
        }
    }

    /// See [`Station::wake_at`].
    pub fn wake_at(&self) -> Option<Time> {
        station!(self, station => station.wake_at())
    }

    /// See [`Station::held`].
    pub fn held(&self) -> usize {
        station!(self, station => station.held())
    }

    /// See [`Station::line`].
    pub fn line(&self) -> u64 {
        station!(self, station => station.line())
    }

    /// The agent in it, if it is one.
    pub fn as_agent(&self) -> Option<&Agent<AnyPlanner>> {
        match self {
            Self::Agent(station) => Some(&station.machine().inner),
            Self::Controller(_) => None,
        }
    }

    /// The controller in it, if it is one.
    pub fn as_controller(&self) -> Option<&Controller> {
        match self {
            Self::Controller(station) => Some(&station.machine().inner),
            Self::Agent(_) => None,
        }
    }

    /// See [`Station::release`].
    pub fn release(&mut self) {
        station!(self, station => station.release());
    }

    /// See [`Station::refuse_waiting`].
    pub fn refuse_waiting(&mut self) -> Vec<Way> {
        station!(self, station => station.refuse_waiting())
    }
}

fn for_agent(arrival: AnyArrival) -> Option<Arrival<std::convert::Infallible>> {
    Some(match arrival {
        Arrival::Instruction(message) => Arrival::Instruction(message),
        Arrival::StopAhead(message) => Arrival::StopAhead(message),
        Arrival::Report(message) => Arrival::Report(message),
        Arrival::Answered {
            by,
            line,
            seq,
            answer,
        } => Arrival::Answered {
            by,
            line,
            seq,
            answer,
        },
        Arrival::Delivered { by, line, seq } => Arrival::Delivered { by, line, seq },
        Arrival::Appeared { name, line } => Arrival::Appeared { name, line },
        Arrival::Unreadable(message) => Arrival::Unreadable(message),
        Arrival::Input(input) => Arrival::Input(match input {
            Input::Goal(goal) => Input::Goal(goal),
            Input::Command(command) => Input::Command(command),
            Input::Instruction { from, instruction } => Input::Instruction { from, instruction },
            Input::Answer { to, answer } => Input::Answer { to, answer },
            Input::Report { id, report } => Input::Report { id, report },
            Input::Observation(facts) => Input::Observation(facts),
            Input::Neighbour { name, there } => Input::Neighbour { name, there },
            Input::Reborn { name } => Input::Reborn { name },
            Input::Wake => Input::Wake,
            Input::Local(_) => return None,
        }),
        Arrival::Local(_) => return None,
    })
}

fn of_agent(effect: Effect<std::convert::Infallible, Way>) -> AnyEffect {
    match effect {
        Effect::Instruct { to, message } => Effect::Instruct { to, message },
        Effect::StopAhead { to, message } => Effect::StopAhead { to, message },
        Effect::Report { to, message } => Effect::Report { to, message },
        Effect::Local(Envelope { body, .. }) => match body {},
        Effect::Observed { facts, reported_to } => Effect::Observed { facts, reported_to },
        Effect::Seen {
            to,
            facts,
            reported,
        } => Effect::Seen {
            to,
            facts,
            reported,
        },
        Effect::Event { number, event } => Effect::Event { number, event },
        Effect::Respond { to, response, line } => Effect::Respond { to, response, line },
    }
}

/// What an executor has told, for superiors that have missed something.
#[derive(Clone, Debug, Default)]
pub struct Board {
    told: BTreeMap<(bool, Fact), FactChange>,
    /// Counts what was told.
    pub seq: u64,
}

impl Board {
    /// Notes what is told.
    pub fn tell(&mut self, facts: &[FactChange]) {
        self.seq += 1;
        for change in facts {
            let key = match change {
                FactChange::Add(fact) | FactChange::Remove(fact) => (false, fact.clone()),
                FactChange::Set(function, _) => (true, function.clone()),
            };
            self.told.insert(key, change.clone());
        }
    }

    /// Whether anything was told.
    pub fn is_used(&self) -> bool {
        self.seq > 0
    }

    /// All that was told.
    pub fn all(&self) -> Vec<FactChange> {
        self.told.values().cloned().collect()
    }
}

/// The name of somebody.
pub fn name(who: Who) -> Symbol {
    who.name().into()
}
