//! The action that runs.

use agent_core::model::Time;
use agent_core::protocol::{ActionId, Happening};
use serde::{Deserialize, Serialize};

use super::{Controller, Skill};
use crate::Ticket;
use crate::faults::Fault;
use crate::memory::Record;

/// The action that runs.
#[derive(Clone, Debug)]
pub(super) struct Active {
    pub(super) begun: Begun,
    pub(super) expected_end: Time,
    pub(super) fault: Option<Fault>,
    /// When something is to be done about the fault.
    pub(super) errand_at: Option<Time>,
}

/// What is written down of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Begun {
    /// What would be recorded if it were suspended before it has begun.
    pub(super) job: Record,
    pub(super) ticket: Ticket,
    pub(super) at: Time,
    pub(super) suspendable: bool,
    /// Share of the usual speed.
    pub(super) pace: f64,
    pub(super) run: Run,
    /// Set once a start has come in between.
    pub(super) cut: Option<Cut>,
    /// Its superior has lost its memory and is told nothing of it.
    pub(super) disowned: bool,
}

#[derive(Clone, Copy, Debug, Eq, PartialEq, Serialize, Deserialize)]
pub(super) enum Run {
    Going,
    /// A superior has asked for it and been told yes, or it is gone.
    Stopping,
    /// The list of faults has it so.
    Failing,
}

/// Who has started anew while an action ran. Everything is halted then; how far the action was,
/// only the sensors can tell.
#[derive(Clone, Copy, Debug, Eq, PartialEq, Serialize, Deserialize)]
pub(super) enum Cut {
    /// The controller. Motors and sensors remember.
    Controller,
    /// Motors and sensors. What they do not know may have happened all the same.
    World,
}

impl Active {
    /// Of the job that was running when a process ended.
    pub(super) fn found(begun: Begun, now: Time) -> Self {
        Self {
            begun,
            expected_end: now,
            fault: None,
            errand_at: None,
        }
    }

    pub(super) fn is(&self, id: &ActionId) -> bool {
        self.begun.job.id == *id
    }

    pub(super) fn drives(&self) -> bool {
        matches!(self.begun.job.rest, Skill::Drive { .. })
    }

    /// Whether it is on its way to a standstill.
    pub(super) fn is_stopping(&self) -> bool {
        self.begun.run != Run::Going || self.begun.cut.is_some()
    }
}

impl Controller {
    /// The active action of that identity.
    pub(super) fn active(&self, id: &ActionId) -> Option<&Active> {
        self.active.as_ref().filter(|active| active.is(id))
    }

    /// Has the active action stop, if it can be suspended. Whether it can.
    pub(super) fn try_to_stop(&mut self, now: Time) -> bool {
        let Some(active) = &mut self.active else {
            return false;
        };
        let (refuses, late) = match active.fault {
            Some(Fault::RefusedSuspension) => (true, None),
            Some(Fault::LateStop { delay }) => (false, Some(delay)),
            _ => (false, None),
        };
        if !active.begun.suspendable || refuses {
            return false;
        }
        if active.begun.run != Run::Going {
            return true;
        }
        active.begun.run = Run::Stopping;
        if active.begun.cut.is_some() {
            // A halt is on its way already.
        } else if let Some(delay) = late {
            active.errand_at = Some(now + delay);
        } else {
            self.stop_motors();
            self.tell_stopping(now);
        }
        true
    }

    /// The motors have been told to stop the active action, because a superior wants it suspended.
    pub(super) fn tell_stopping(&mut self, now: Time) {
        let Some(job) = self.active.as_ref().map(|active| active.begun.job.clone()) else {
            return;
        };
        let (id, action) = (job.id.clone(), job.action.clone());
        self.event(now, &job, Happening::ActionStopping { id, action });
    }
}
