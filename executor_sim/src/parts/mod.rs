//! What a vehicle is made of, beside the base that drives: an arm with a gripper, eyes, and a voice.
//!
//! Each part does one thing at a time, all of them at once, and each answers for itself as
//! `docs/executor.md` says: it is an executor without a place of its own. A tray is no part that does
//! anything; it only holds what the arm puts there.

mod answers;
mod course;
mod durable;
mod errand;
mod vocabulary;

use std::fmt;

use agent_core::model::{Fact, Symbol, Time};
use agent_core::protocol::{ActionId, Event, Happening, Report};
use serde::{Deserialize, Serialize};

use crate::Faults;
use crate::faults::Fault;
use crate::memory::{End, Memory, Record};

pub(crate) use answers::Order;
pub use errand::{Errand, Work};
pub use vocabulary::{Job, PartsError, PartsVocabulary};

/// A part that does something.
#[derive(Clone, Copy, Debug, Eq, PartialEq, Ord, PartialOrd, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PartName {
    /// It drives.
    Base,
    /// It grasps, carries over and puts down, with one gripper.
    Arm,
    /// They look for a while.
    Eyes,
    /// It speaks and asks.
    Voice,
}

impl PartName {
    /// As it is written in `room.toml`.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Base => "base",
            Self::Arm => "arm",
            Self::Eyes => "eyes",
            Self::Voice => "voice",
        }
    }
}

impl fmt::Display for PartName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// Why something cannot be done, or no longer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hindrance {
    /// In words.
    pub reason: String,
    /// What would have to hold.
    pub blocked_by: Vec<Fact>,
}

/// What a part works on, as far as its vehicle can reach it.
pub(crate) trait Reality {
    /// Takes hold of what the errand is about.
    fn begin(&mut self, errand: &Errand) -> Result<(), Hindrance>;
    /// Whether it can still go on.
    fn goes_on(&self, errand: &Errand) -> Result<(), Hindrance>;
    /// Its time is over: does it.
    fn finish(&mut self, errand: &Errand) -> Result<(), Hindrance>;
    /// It was broken off, and the part has come to rest.
    fn let_go(&mut self, errand: &Errand);
}

/// The moment in which something happens to a part.
pub(crate) struct Moment<'a> {
    pub(crate) now: Time,
    pub(crate) reality: &'a mut dyn Reality,
    /// Nobody could stop what is begun now.
    pub(crate) superior_gone: bool,
    pub(crate) said: &'a mut Vec<Said>,
}

/// What a part says. The facts in its reports are for whoever knows the whole vehicle to add.
pub(crate) enum Said {
    Report {
        to: Symbol,
        id: ActionId,
        report: Report,
        errand: Errand,
    },
    Event(Event),
}

/// One part: one thing at a time, and records of those that were suspended.
#[derive(Clone, Debug)]
pub(crate) struct Part {
    name: PartName,
    faults: Faults,
    memory: Memory<Work>,
    active: Option<Active>,
    waiting: Option<Waiting>,
    ledger: agent_core::protocol::Ledger,
}

/// What runs.
#[derive(Clone, Debug)]
struct Active {
    begun: Begun,
    fault: Option<Fault>,
    /// When something is to be done about the fault.
    errand_at: Option<Time>,
}

/// What is written down of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Begun {
    /// What would be recorded if it were suspended before it has begun.
    job: Record<Work>,
    suspendable: bool,
    at: Time,
    end: Time,
    /// How many seconds it takes for one of the model's.
    tempo: f64,
    run: Run,
    /// It was told to stop, and is at rest then.
    rest_at: Option<Time>,
    /// Its superior has lost its memory and is told nothing of it.
    disowned: bool,
}

#[derive(Clone, Copy, Debug, Eq, PartialEq, Serialize, Deserialize)]
enum Run {
    Going,
    /// A superior has asked for it and been told yes, or it is gone.
    Stopping,
    /// The list of faults has it so.
    Failing,
}

/// Accepted, and not begun as nobody could stop it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Waiting {
    job: Record<Work>,
    suspendable: bool,
    tempo: f64,
    resumed: bool,
}

impl Part {
    pub(crate) fn new(name: PartName) -> Self {
        Self {
            name,
            faults: Faults::none(),
            memory: Memory::default(),
            active: None,
            waiting: None,
            ledger: agent_core::protocol::Ledger::default(),
        }
    }

    pub(crate) fn set_faults(&mut self, faults: Faults) {
        self.faults = faults;
    }

    /// Whether it has ever heard of that execution, and not forgotten it.
    pub(crate) fn knows(&self, id: &ActionId) -> bool {
        self.is_active(id)
            || self.waits(id)
            || self.memory.record(id).is_some()
            || self.memory.over(id).is_some()
    }

    /// Whether that is suspended.
    pub(crate) fn is_suspended(&self, id: &ActionId) -> bool {
        self.memory.record(id).is_some()
    }

    /// How many suspended things it keeps.
    pub(crate) fn depth(&self) -> usize {
        self.memory.depth()
    }

    /// What it does, and whether it is coming to rest.
    pub(crate) fn doing(&self) -> Option<(&Record<Work>, bool)> {
        let active = self.active.as_ref()?;
        Some((&active.begun.job, active.begun.run != Run::Going))
    }

    fn is_active(&self, id: &ActionId) -> bool {
        let active = self.active.as_ref();
        active.is_some_and(|active| active.begun.job.id == *id)
    }

    fn waits(&self, id: &ActionId) -> bool {
        let waiting = self.waiting.as_ref();
        waiting.is_some_and(|waiting| waiting.job.id == *id)
    }

    fn event(&self, moment: &mut Moment<'_>, job: &Record<Work>, what: Happening) {
        moment.said.push(Said::Event(Event {
            at: moment.now,
            goal: Some(job.id.to_string().into()),
            stack_depth: self.memory.depth(),
            what,
        }));
    }

    fn report(moment: &mut Moment<'_>, job: &Record<Work>, report: Report) {
        moment.said.push(Said::Report {
            to: job.superior.clone(),
            id: job.id.clone(),
            report,
            errand: job.rest.errand.clone(),
        });
    }
}

/// The report of an end, without facts. `Cleared` is none.
fn outcome(end: &End) -> Option<Report> {
    let facts = Vec::new();
    match end {
        End::Success => Some(Report::Success { facts }),
        End::Failure { reason, blocked_by } => Some(Report::Failure {
            reason: reason.clone(),
            facts,
            blocked_by: blocked_by.clone(),
        }),
        End::Unknown { reason } => Some(Report::Unknown {
            reason: reason.clone(),
            facts,
        }),
        End::Cleared => None,
    }
}
