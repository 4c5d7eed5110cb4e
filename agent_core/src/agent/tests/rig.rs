//! One agent in the small world, and what is said to it and by it.

use std::convert::Infallible;

use super::toy;
use crate::agent::Agent;
use crate::language::{parse_atom, parse_tasks};
use crate::model::{FactChange, Time};
use crate::planner::{NaivePlanner, Settings};
use crate::protocol::{
    ActionId, Durable, Event, GoalRequest, Happening, Input, Instruction, Machine, Output, Reply,
    Report, Row, Rows, Urgency,
};

/// An agent that says everything to whoever asks.
pub struct Rig {
    pub agent: Agent<NaivePlanner>,
    make: fn(u64, NaivePlanner) -> Agent<NaivePlanner>,
    pub now: Time,
    epoch: u64,
    pub rows: Rows,
    /// All that was told to executors and not taken yet.
    pub instructed: Vec<(String, Instruction)>,
    pub reports: Vec<(ActionId, Report)>,
    pub events: Vec<Event>,
}

impl Rig {
    pub fn new() -> Self {
        Self::of(toy::agent)
    }

    /// The same with an agent that is made otherwise.
    pub fn of(make: fn(u64, NaivePlanner) -> Agent<NaivePlanner>) -> Self {
        let planner = NaivePlanner::new(Settings::default());
        Self {
            agent: make(1, planner),
            make,
            now: Time::ZERO,
            epoch: 1,
            rows: Rows::new(),
            instructed: Vec::new(),
            reports: Vec::new(),
            events: Vec::new(),
        }
    }

    pub fn give(&mut self, input: Input<Infallible>) -> Option<Reply> {
        let reply = self.agent.handle(self.now, input);
        while self.agent.wake_at() == Some(Time::ZERO) {
            self.agent.handle(self.now, Input::Wake);
        }
        self.agent.check();
        while let Some(output) = self.agent.poll_output() {
            match output {
                Output::Instruct { to, instruction } => {
                    self.instructed.push((to.to_string(), instruction));
                }
                Output::Report { id, report, .. } => self.reports.push((id, report)),
                Output::Event(event) => self.events.push(event),
                Output::Observed { .. } | Output::Seen { .. } => {}
                Output::Local(never) => match never {},
            }
        }
        for Row { key, value } in self.agent.write_down() {
            match value {
                Some(value) => self.rows.insert(key, value),
                None => self.rows.remove(&key),
            };
        }
        reply
    }

    /// The process dies, and is started again. Nobody is seen yet.
    pub fn restart(&mut self) {
        self.epoch += 1;
        let planner = NaivePlanner::new(Settings::default());
        self.agent = (self.make)(self.epoch, planner);
        let recalled = self.agent.recall(&self.rows);
        recalled.expect("what an agent has written down can be read");
    }

    pub fn goal(&mut self, id: &str, tasks: &str, urgency: Urgency) -> Option<Reply> {
        self.give(Input::Goal(GoalRequest {
            id: Some(id.into()),
            tasks: parse_tasks(tasks).expect("tasks"),
            urgency,
            priority: 0,
            deadline: None,
        }))
    }

    pub fn boss(&mut self, instruction: Instruction) -> Option<Reply> {
        let from = "boss".into();
        self.give(Input::Instruction { from, instruction })
    }

    /// The boss has a task done.
    pub fn execute(&mut self, number: u64, task: &str) {
        self.boss(Instruction::Execute {
            id: boss(number),
            action: parse_atom(task).expect("a task"),
            map: None,
        });
    }

    pub fn neighbour(&mut self, name: &str, there: bool) {
        let name = name.into();
        self.give(Input::Neighbour { name, there });
    }

    pub fn reborn(&mut self, name: &str) {
        self.give(Input::Reborn { name: name.into() });
    }

    pub fn passes(&mut self, seconds: f64) {
        self.now = self.now + Time::from_secs(seconds);
        self.give(Input::Wake);
    }

    /// What was said to executors since this was asked last, in short.
    pub fn said(&mut self) -> Vec<String> {
        let said = std::mem::take(&mut self.instructed);
        let said = said.into_iter().map(|(to, instruction)| match instruction {
            Instruction::Execute { action, .. } => format!("{to}: {action}"),
            Instruction::Suspend { .. } => format!("{to}: suspend"),
            Instruction::Resume { .. } => format!("{to}: resume"),
            Instruction::Clear { .. } => format!("{to}: clear"),
        });
        said.collect()
    }

    /// The running execution.
    pub fn running(&self) -> ActionId {
        let (id, _, _) = self.agent.executing().expect("something is executed");
        id.clone()
    }

    pub fn report(&mut self, report: Report) {
        let id = self.running();
        self.give(Input::Report { id, report });
    }

    pub fn success(&mut self) {
        self.report(Report::Success { facts: Vec::new() });
    }

    pub fn suspended(&mut self) {
        self.report(Report::Suspended { facts: Vec::new() });
    }

    /// What somebody sees.
    pub fn seen(&mut self, facts: &[&str]) {
        self.give(Input::Observation(toy::changes(facts)));
    }

    /// The executor has done it, and says what its sensors tell.
    pub fn done(&mut self, facts: &[&str]) {
        let facts = toy::changes(facts);
        self.report(Report::Success { facts });
    }

    /// Why actions have failed.
    pub fn failures(&self) -> Vec<&str> {
        let why = self.events.iter().filter_map(|event| match &event.what {
            Happening::ActionFinished { failure, .. } => failure.as_deref(),
            _ => None,
        });
        why.collect()
    }

    pub fn unknown(&mut self, facts: Vec<FactChange>) {
        let reason = "its process has died".to_owned();
        self.report(Report::Unknown { reason, facts });
    }

    /// What happened, in its latest form.
    pub fn happened(&self, is: impl Fn(&Happening) -> bool) -> bool {
        self.events.iter().any(|event| is(&event.what))
    }
}

/// An execution of the boss's.
pub fn boss(number: u64) -> ActionId {
    ActionId {
        agent: "boss".into(),
        epoch: 7,
        number,
    }
}
