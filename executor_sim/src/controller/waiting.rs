//! An action that is begun as soon as the robot stands.
//!
//! For a moment after a start nobody knows yet where it does. Whoever sends an instruction then is
//! not refused for something that it cannot know.

use agent_core::model::{Symbol, Time};
use agent_core::protocol::{ActionId, Happening};
use serde::{Deserialize, Serialize};

use super::memory::Record;
use super::{Controller, End};
use crate::WORLD;

/// An action that was accepted. Nothing has moved for it yet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Waiting {
    pub(super) job: Record,
    pub(super) suspendable: bool,
    /// It was suspended before.
    pub(super) resumed: bool,
}

impl Controller {
    /// Whether all that is missing for an action to be begun is that the robot says where it stands.
    pub(super) fn is_only_halting(&self) -> bool {
        let busy = self.active.is_some() || self.waiting.is_some();
        self.halt.is_some() && !busy && !self.gone.contains(WORLD)
    }

    /// The action of that identity, if it waits.
    pub(super) fn waits(&self, id: &ActionId) -> Option<&Waiting> {
        self.waiting
            .as_ref()
            .filter(|waiting| waiting.job.id == *id)
    }

    /// Makes a record of what waits, if it can be suspended. Whether it can.
    pub(super) fn set_waiting_aside(&mut self, now: Time) -> bool {
        match self.waiting.take_if(|waiting| waiting.suspendable) {
            Some(waiting) => {
                self.keep(now, waiting.job);
                true
            }
            None => false,
        }
    }

    /// What waits for that superior, which is gone, is not begun.
    pub(super) fn waits_for_nobody(&mut self, now: Time, superior: &Symbol) {
        let waiting = self.waiting.as_ref();
        if waiting.is_none_or(|waiting| waiting.job.superior != *superior)
            || self.set_waiting_aside(now)
        {
            return;
        }
        if let Some(waiting) = self.waiting.take() {
            let reason = format!("`{superior}`, which wants it, is gone");
            let blocked_by = Vec::new();
            self.end_job(now, waiting.job, End::Failure { reason, blocked_by });
        }
    }

    /// The robot stands: what has waited for that is begun.
    pub(super) fn begin_what_waits(&mut self, now: Time) {
        let Some(waiting) = self.waiting.take() else {
            return;
        };
        let Waiting {
            job,
            suspendable,
            resumed,
        } = waiting;
        if let Err(reason) = self.fits_here(&job.rest) {
            let blocked_by = Vec::new();
            self.end_job(now, job, End::Failure { reason, blocked_by });
            return;
        }
        let fault = if resumed {
            None
        } else {
            self.faults.next_action()
        };
        self.begin(now, job, suspendable, resumed, fault);
    }

    /// Has the motors do it, and says so.
    pub(super) fn begin(
        &mut self,
        now: Time,
        job: Record,
        suspendable: bool,
        resumed: bool,
        fault: Option<crate::Fault>,
    ) {
        let (id, action) = (job.id.clone(), job.action.clone());
        self.set_going(now, job.clone(), suspendable, fault);
        let what = if resumed {
            Happening::ActionResumed { id, action }
        } else {
            Happening::ActionStarted { id, action }
        };
        self.event(now, &job, what);
    }
}
