//! An action that is begun as soon as the robot stands and its superior is there.
//!
//! For a moment after a start nobody knows yet where the robot stands. Whoever sends an instruction then
//! is not refused for something that it cannot know. Neither is a superior that counts as gone: it may
//! have sent it before it went, or be back before that is known here. To give it its action back as
//! suspended would have it resume that at once, and so on for as long as nobody sees it.

use agent_core::model::Time;
use agent_core::protocol::{ActionId, Happening};
use serde::{Deserialize, Serialize};

use super::{Controller, End};
use crate::WORLD;
use crate::memory::Record;

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

    /// What has waited for the robot to stand, or for its superior, is begun if neither is missing.
    pub(super) fn begin_what_waits(&mut self, now: Time) {
        let missing = self.halt.is_some() || self.gone.contains(WORLD) || self.unseen.is_some();
        let waiting = self
            .waiting
            .take_if(|waiting| !missing && !self.gone.contains(&waiting.job.superior));
        let Some(waiting) = waiting else {
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

    /// What has waited was recalled: it begins once its superior is seen.
    pub(super) fn what_waits_was_recalled(&mut self) {
        let waiting = self.waiting.as_ref();
        self.unseen = waiting.map(|waiting| waiting.job.superior.clone());
        self.resumed_before = waiting.is_some_and(|waiting| waiting.resumed);
    }

    /// Nothing goes on in a robot that has just started: what was suspended once, and was asked for again
    /// before the start, is suspended until it is asked for again.
    pub(super) fn what_waits_stays_suspended(&mut self) {
        if std::mem::take(&mut self.resumed_before)
            && let Some(waiting) = self.waiting.take_if(|waiting| waiting.resumed)
        {
            self.report_suspended(&waiting.job);
            self.memory.keep(waiting.job);
        }
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
