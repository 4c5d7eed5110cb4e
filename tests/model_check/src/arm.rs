//! An executor with the rules of the robot's controller and without its motion.

use std::collections::{BTreeMap, VecDeque};

use agent_core::model::{Action, Fact, FactChange, Symbol, Time};
use agent_core::protocol::{
    ActionId, Answer, Durable, Input, Instruction, Ledger, Machine, Output, Reply, Report, Row,
    Rows, Unreadable, read_row,
};
use serde::{Deserialize, Serialize};

use crate::world::{Motor, Sensor};

/// An action that may be going on.
#[derive(Clone, Debug, Eq, PartialEq, Serialize, Deserialize)]
struct Job {
    id: ActionId,
    superior: Symbol,
    action: Action,
}

/// What survives its process.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Memory {
    active: Option<(Job, u64)>,
    /// Accepted, and begun as soon as everything stands.
    waiting: Option<Job>,
    records: BTreeMap<ActionId, Job>,
    /// How actions have ended; `None` if they were cleared.
    over: BTreeMap<ActionId, Option<Report>>,
    last_ticket: u64,
}

/// Executes one action at a time.
#[derive(Clone, Debug, Default)]
pub struct Arm {
    memory: Memory,
    /// It was told to stop.
    stopping: bool,
    /// Everything was told to halt and has not said that it has.
    halting: bool,
    gone: bool,
    outputs: VecDeque<Output<Motor>>,
    ledger: Ledger,
    fault: Option<&'static str>,
}

impl Arm {
    /// One that has just started: it halts first.
    pub fn new() -> Self {
        let mut arm = Self {
            halting: true,
            ..Self::default()
        };
        arm.outputs.push_back(Output::Local(Motor::Halt));
        arm
    }

    /// What is not written down.
    pub fn volatile_parts(&self) -> (bool, bool, bool) {
        (self.stopping, self.halting, self.gone)
    }

    /// What it was told that no superior may say.
    pub fn fault_told(&self) -> Option<&'static str> {
        self.fault
    }

    /// Whether nothing is running, waiting or kept.
    pub fn is_empty(&self) -> bool {
        let memory = &self.memory;
        memory.active.is_none() && memory.waiting.is_none() && memory.records.is_empty()
    }

    fn report(&mut self, job: &Job, report: Report) {
        self.outputs.push_back(Output::Report {
            to: job.superior.clone(),
            id: job.id.clone(),
            report,
        });
    }

    fn begin(&mut self, job: Job) {
        self.memory.last_ticket += 1;
        let ticket = self.memory.last_ticket;
        self.report(&job, Report::Started);
        self.outputs.push_back(Output::Local(Motor::Go {
            ticket,
            id: job.id.clone(),
            action: job.action.clone(),
        }));
        self.memory.active = Some((job, ticket));
        self.stopping = false;
    }

    fn keep(&mut self, job: Job) {
        self.report(&job, Report::Suspended { facts: Vec::new() });
        self.memory.records.insert(job.id.clone(), job);
    }

    fn succeed(&mut self, job: &Job) {
        let mut fact: Fact = job.action.clone();
        fact.name = "done".into();
        let facts = vec![FactChange::Add(fact)];
        let report = Report::Success { facts };
        self.memory
            .over
            .insert(job.id.clone(), Some(report.clone()));
        self.report(job, report);
    }

    fn stop(&mut self) {
        if let Some((_, ticket)) = &self.memory.active
            && !self.stopping
        {
            let ticket = *ticket;
            self.stopping = true;
            self.outputs
                .push_back(Output::Local(Motor::Stop { ticket }));
        }
    }

    fn is_active(&self, id: &ActionId) -> bool {
        let active = self.memory.active.as_ref();
        active.is_some_and(|(job, _)| job.id == *id)
    }

    fn waits(&self, id: &ActionId) -> bool {
        self.memory
            .waiting
            .as_ref()
            .is_some_and(|job| job.id == *id)
    }

    fn over(&self, id: &ActionId) -> Option<Answer> {
        Some(match self.memory.over.get(id)? {
            Some(outcome) => Answer::Finished {
                outcome: outcome.clone(),
            },
            None => rejected("it was cleared"),
        })
    }

    /// Starts it, or as soon as everything stands.
    fn start(&mut self, job: Job) -> Answer {
        if self.gone {
            self.keep(job);
        } else if self.halting && self.memory.active.is_none() && self.memory.waiting.is_none() {
            self.memory.waiting = Some(job);
        } else if self.memory.active.is_some() || self.memory.waiting.is_some() {
            self.fault = Some("S3: told to start while something else is going on");
            return rejected("busy");
        } else {
            self.begin(job);
        }
        Answer::Accepted
    }

    fn instructed(&mut self, superior: Symbol, instruction: Instruction) -> Answer {
        match instruction {
            Instruction::Execute { id, action, .. } => {
                let known = self.is_active(&id) || self.waits(&id);
                if known || self.memory.records.contains_key(&id) || self.over(&id).is_some() {
                    // The controller would only say so; here it must not come about.
                    self.fault = Some("S7: the same execution is begun twice");
                    return Answer::Accepted;
                }
                let job = Job {
                    id,
                    superior,
                    action,
                };
                if self.halting && self.memory.active.is_some() {
                    return rejected("it is not known yet how things stand");
                }
                self.start(job)
            }
            Instruction::Suspend { id } => {
                if self.is_active(&id) {
                    self.stop();
                    return Answer::Suspending;
                }
                if let Some(job) = self.memory.waiting.take_if(|job| job.id == id) {
                    self.keep(job);
                    return Answer::Suspending;
                }
                if self.memory.records.contains_key(&id) {
                    return Answer::Suspending;
                }
                self.over(&id).unwrap_or_else(|| rejected("not known"))
            }
            Instruction::Resume { id, .. } => {
                if self.is_active(&id) {
                    return match self.stopping || self.halting {
                        true => rejected("it has not stopped yet"),
                        false => Answer::Accepted,
                    };
                }
                if self.waits(&id) {
                    return Answer::Accepted;
                }
                match self.memory.records.remove(&id) {
                    Some(job) => self.start(job),
                    None => self.over(&id).unwrap_or_else(|| rejected("not known")),
                }
            }
            Instruction::Clear { id } => {
                if self.is_active(&id) || self.waits(&id) {
                    return rejected("it is running");
                }
                if self.memory.records.remove(&id).is_some() {
                    self.memory.over.insert(id, None);
                    return Answer::Accepted;
                }
                match self.memory.over.get(&id) {
                    Some(Some(outcome)) => Answer::Finished {
                        outcome: outcome.clone(),
                    },
                    _ => Answer::Accepted,
                }
            }
        }
    }

    fn sensed(&mut self, sensor: &Sensor) {
        let done = match sensor {
            Sensor::Done { ticket } if self.has_ticket(*ticket) => true,
            Sensor::Stopped { ticket } if self.has_ticket(*ticket) => false,
            Sensor::Halted { done } if self.halting => {
                self.halting = false;
                let done = *done;
                let active = self.memory.active.as_ref();
                active.is_some_and(|(_, ticket)| done == Some(*ticket))
            }
            _ => return,
        };
        self.stopping = false;
        match self.memory.active.take() {
            Some((job, _)) if done => self.succeed(&job),
            Some((job, _)) => self.keep(job),
            None => {}
        }
        if let Some(job) = self.memory.waiting.take_if(|_| !self.halting) {
            self.begin(job);
        }
    }

    fn has_ticket(&self, wanted: u64) -> bool {
        let active = self.memory.active.as_ref();
        !self.halting && active.is_some_and(|(_, ticket)| *ticket == wanted)
    }
}

fn rejected(reason: &str) -> Answer {
    Answer::Rejected {
        reason: reason.to_owned(),
    }
}

impl Machine for Arm {
    type In = Sensor;
    type Out = Motor;

    fn handle(&mut self, _: Time, input: Input<Sensor>) -> Option<Reply> {
        match input {
            Input::Instruction { from, instruction } => {
                return Some(Reply::Instruction(self.instructed(from, instruction)));
            }
            Input::Local(sensor) => self.sensed(&sensor),
            Input::Neighbour { there, .. } => {
                self.gone = !there;
                if self.gone {
                    self.stop();
                    if let Some(job) = self.memory.waiting.take() {
                        self.keep(job);
                    }
                }
            }
            Input::Reborn { .. } => self.fault = Some("S9: a superior is said to have no memory"),
            _ => {}
        }
        None
    }

    fn poll_output(&mut self) -> Option<Output<Motor>> {
        self.outputs.pop_front()
    }

    fn wake_at(&self) -> Option<Time> {
        None
    }
}

impl Durable for Arm {
    fn write_down(&mut self) -> Vec<Row> {
        self.ledger.put("m/arm".to_owned(), &self.memory);
        self.ledger.take()
    }

    fn recall(&mut self, rows: &Rows) -> Result<(), Unreadable> {
        self.memory = read_row(rows, "m/arm")?.unwrap_or_default();
        self.ledger = Ledger::of(rows, "m/");
        Ok(())
    }

    fn is_suspended(&self, _: &Symbol, id: &ActionId) -> bool {
        self.memory.records.contains_key(id)
    }

    fn is_stop(output: &Motor) -> bool {
        matches!(output, Motor::Stop { .. } | Motor::Halt)
    }
}
