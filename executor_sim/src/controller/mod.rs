//! The robot's executor: one action at a time, and records of those that were suspended.

mod active;
mod durable;
#[cfg(feature = "process")]
mod inspect;
mod instructions;
mod neighbours;
mod restart;
mod sensors;
mod skill;
mod surroundings;
mod waiting;

use std::collections::{BTreeSet, VecDeque};

use agent_core::model::{Action, Domain, ExecutionModel, FactChange, Symbol, Time};
use agent_core::protocol::Ledger;
use agent_core::protocol::{Event, Happening, Input, Machine, Output, Reply, Report};

use crate::faults::Fault;
use crate::memory::{End, Memory, Record};
use crate::refusal::refuse;
use crate::{Faults, Floor, MotorCommand, Sensor, Ticket};

use active::{Active, Begun, Run};
use surroundings::Surroundings;
use waiting::Waiting;

pub use skill::{Skill, Vocabulary, VocabularyError};

/// What superiors talk to. It knows the world only by its sensors.
///
/// Invariant: the motors carry out at most one command of its, that of the active action; it sends
/// one only to answer an instruction. After a start it first halts everything and begins nothing
/// before the sensors have said where the robot stands. The action that was running is suspended
/// then, or it ends: as what the sensors tell of it, or unknown.
///
/// An action belongs to the superior that had it begun: that one gets its reports. Any superior
/// may suspend it. If its superior is gone, it is suspended, for then nobody could stop it.
#[derive(Clone, Debug)]
pub struct Controller {
    vocabulary: Vocabulary,
    surroundings: Surroundings,
    faults: Faults,
    memory: Memory,
    active: Option<Active>,
    waiting: Option<Waiting>,
    last_ticket: u64,
    /// Everything was told to halt, and has not said yet that it has.
    halt: Option<Ticket>,
    /// Neighbours that are not there.
    gone: BTreeSet<Symbol>,
    /// The superior of an action that was recalled and has not been begun, until it is seen.
    unseen: Option<Symbol>,
    /// It was resumed, and that was before the start.
    resumed_before: bool,
    outputs: VecDeque<Output<MotorCommand>>,
    ledger: Ledger,
}

impl Controller {
    /// One that has just started and remembers nothing, unless it [recalls] it.
    ///
    /// [recalls]: agent_core::protocol::Durable::recall
    pub fn new(
        domain: &Domain,
        model: &ExecutionModel,
        floor: Floor,
        faults: Faults,
    ) -> Result<Self, VocabularyError> {
        let mut controller = Self {
            vocabulary: Vocabulary::new(domain, model)?,
            surroundings: Surroundings::new(floor),
            faults,
            memory: Memory::default(),
            active: None,
            waiting: None,
            last_ticket: 0,
            halt: None,
            gone: BTreeSet::new(),
            unseen: None,
            resumed_before: false,
            outputs: VecDeque::new(),
            ledger: Ledger::default(),
        };
        controller.halt();
        Ok(controller)
    }

    /// What is true of the robot's place and of all doors, and that nothing else is: for a
    /// superior that has just been met. Nothing, as long as the robot drives or has not said yet
    /// where it stands.
    pub fn announcement(&mut self) -> Vec<FactChange> {
        if self.stands() {
            self.surroundings.announce()
        } else {
            Vec::new()
        }
    }

    /// What goes wrong from now on.
    pub(crate) fn set_faults(&mut self, faults: Faults) {
        self.faults = faults;
    }

    /// What it does, and whether it is stopping.
    pub(crate) fn doing(&self) -> Option<(&Action, bool)> {
        let active = self.active.as_ref()?;
        Some((&active.begun.job.action, active.is_stopping()))
    }

    /// How many suspended actions it keeps.
    pub(crate) fn depth(&self) -> usize {
        self.memory.depth()
    }

    /// Whether it has heard of that execution, and not forgotten it.
    pub(crate) fn knows(&self, id: &agent_core::protocol::ActionId) -> bool {
        self.active(id).is_some()
            || self.waits(id).is_some()
            || self.memory.record(id).is_some()
            || self.memory.over(id).is_some()
    }

    /// Whether the robot's place is what was last heard of it.
    fn stands(&self) -> bool {
        let drives = self.active.as_ref().is_some_and(Active::drives);
        self.surroundings.place().is_some() && !drives
    }

    /// Has the motors do the job. There is no active action.
    fn set_going(&mut self, now: Time, job: Record, suspendable: bool, fault: Option<Fault>) {
        self.last_ticket = self.last_ticket.saturating_add(1);
        let ticket = Ticket(self.last_ticket);
        let pace = match fault {
            Some(Fault::Slow { pace }) => pace,
            _ => 1.0,
        };
        // Until the motors say better.
        let expected_s = match &job.rest {
            Skill::Drive { arc, .. } => self
                .surroundings
                .floor()
                .passage(arc)
                .map_or(0.0, |passage| passage.length_m),
            Skill::Speak { duration_s }
            | Skill::SetDoor { duration_s, .. }
            | Skill::Deed { duration_s, .. } => *duration_s,
        };
        let command = match &job.rest {
            Skill::Drive { arc, to } => MotorCommand::Drive {
                ticket,
                arc: arc.clone(),
                to: to.clone(),
                pace,
            },
            Skill::Speak { duration_s } => MotorCommand::Speak {
                ticket,
                duration_s: duration_s / pace,
            },
            Skill::SetDoor {
                door,
                open,
                duration_s,
            } => MotorCommand::SetDoor {
                ticket,
                door: door.clone(),
                open: *open,
                duration_s: duration_s / pace,
            },
            Skill::Deed { what, duration_s } => MotorCommand::Deed {
                ticket,
                what: what.clone(),
                duration_s: duration_s / pace,
            },
        };
        self.report(&job, Report::Started);
        self.outputs.push_back(Output::Local(command));
        self.active = Some(Active {
            begun: Begun {
                job,
                ticket,
                at: now,
                suspendable,
                pace,
                run: Run::Going,
                cut: None,
                disowned: false,
            },
            expected_end: now + Time::from_secs(expected_s / pace),
            fault,
            errand_at: None,
        });
    }

    /// Has the motors stop what the active action does.
    fn stop_motors(&mut self) {
        let Some(active) = &mut self.active else {
            return;
        };
        active.errand_at = None;
        let ticket = active.begun.ticket;
        let command = match active.begun.job.rest {
            Skill::Drive { .. } => MotorCommand::Brake { ticket },
            Skill::Speak { .. } => MotorCommand::Hush { ticket },
            // Only a fault stops it: no superior may.
            Skill::SetDoor { .. } | Skill::Deed { .. } => return self.halt(),
        };
        self.outputs.push_back(Output::Local(command));
    }

    /// Does what the fault has in store, if its time has come.
    fn run_errand(&mut self, now: Time) {
        if let Some(active) = &mut self.active
            && active.errand_at.is_some_and(|time| time <= now)
        {
            let asked = active.begun.run == Run::Stopping;
            if !asked {
                active.begun.run = Run::Failing;
            }
            self.stop_motors();
            if asked {
                self.tell_stopping(now);
            }
        }
    }

    /// The action that was active is over.
    fn end(&mut self, now: Time, begun: Begun, end: End) {
        if begun.disowned {
            self.drop_disowned(&begun.job);
        } else {
            self.end_job(now, begun.job, end);
        }
    }

    /// An action is over.
    fn end_job(&mut self, now: Time, job: Record, end: End) {
        let report = self.outcome(&job.rest, &end);
        let failure = match &end {
            End::Failure { reason, .. } | End::Unknown { reason } => Some(reason.clone()),
            End::Success | End::Cleared => None,
        };
        self.memory.end(&job, end);
        self.report(&job, report);
        let (id, action) = (job.id.clone(), job.action.clone());
        self.event(
            now,
            &job,
            Happening::ActionFinished {
                id,
                action,
                failure,
            },
        );
    }

    /// What a superior is told of an action that is over: its outcome, and what is true now. While
    /// the robot drives for another, nothing certain can be said of its place.
    fn outcome(&mut self, skill: &Skill, end: &End) -> Report {
        let mut facts = Vec::new();
        if self.stands() {
            facts = self.surroundings.tell(skill.arc());
        }
        if let Skill::SetDoor { door, .. } = skill {
            facts.push(self.surroundings.door_fact(door));
        }
        match end {
            End::Failure { reason, blocked_by } => {
                let doors = blocked_by.iter().filter_map(|fact| fact.args.first());
                facts.extend(doors.map(|door| self.surroundings.door_fact(door)));
                Report::Failure {
                    reason: reason.clone(),
                    facts,
                    blocked_by: blocked_by.clone(),
                }
            }
            End::Unknown { reason } => Report::Unknown {
                reason: reason.clone(),
                facts,
            },
            End::Success | End::Cleared => Report::Success { facts },
        }
    }

    /// To the superior whose action it is; and what is in it for all of them to know.
    fn report(&mut self, job: &Record, report: Report) {
        let facts = match &report {
            Report::Success { facts }
            | Report::Failure { facts, .. }
            | Report::Unknown { facts, .. }
            | Report::Suspended { facts } => facts.clone(),
            Report::Started | Report::Progress { .. } => Vec::new(),
        };
        self.outputs.push_back(Output::Report {
            to: job.superior.clone(),
            id: job.id.clone(),
            report,
        });
        if !facts.is_empty() {
            self.outputs.push_back(Output::Observed {
                facts,
                reported_to: Some(job.superior.clone()),
            });
        }
    }

    fn event(&mut self, now: Time, job: &Record, what: Happening) {
        self.outputs.push_back(Output::Event(Event {
            at: now,
            goal: Some(job.id.to_string().into()),
            stack_depth: self.memory.depth(),
            what,
        }));
    }
}

impl Machine for Controller {
    type In = Sensor;
    type Out = MotorCommand;

    fn handle(&mut self, now: Time, input: Input<Sensor>) -> Option<Reply> {
        self.run_errand(now);
        match input {
            Input::Instruction { from, instruction } => {
                Some(Reply::Instruction(self.instructed(now, from, instruction)))
            }
            Input::Local(sensor) => {
                self.sensed(now, sensor);
                None
            }
            Input::Neighbour { name, there } => {
                self.neighbour(now, name, there);
                None
            }
            Input::Reborn { name } => {
                self.reborn(now, &name);
                None
            }
            other => refuse(other, "a robot"),
        }
    }

    fn poll_output(&mut self) -> Option<Output<MotorCommand>> {
        self.outputs.pop_front()
    }

    fn wake_at(&self) -> Option<Time> {
        self.active.as_ref()?.errand_at
    }

    fn wind_down(&mut self, now: Time) {
        // What cannot be stopped runs to its end, if there is time for it.
        let _ = self.try_to_stop(now);
    }

    fn rests(&self) -> bool {
        // Nobody hears from motors that cannot be reached; they stop by themselves.
        self.gone.contains(crate::WORLD) || self.active.is_none() && self.halt.is_none()
    }
}
