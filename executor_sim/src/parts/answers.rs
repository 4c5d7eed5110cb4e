//! What a part answers, row for row as `docs/executor.md` has it.

use agent_core::model::{Action, Symbol, Time};
use agent_core::protocol::{ActionId, Answer, Happening, Report};

use super::{Errand, Moment, Part, Run, Waiting, Work, outcome};
use crate::memory::{End, Record};

/// An action that a part is to begin.
pub(crate) struct Order {
    pub(crate) id: ActionId,
    pub(crate) superior: Symbol,
    pub(crate) action: Action,
    pub(crate) work: Work,
    pub(crate) suspendable: bool,
    /// How many seconds it takes for one of the model's.
    pub(crate) tempo: f64,
}

impl Part {
    pub(crate) fn execute(&mut self, moment: &mut Moment<'_>, order: Order) -> Answer {
        let id = &order.id;
        if self.is_active(id) || self.waits(id) {
            return Answer::Accepted;
        }
        if self.memory.record(id).is_some() {
            return rejected(format!("{id} is suspended: resume it or clear it"));
        }
        // An identity is used once: this is the same instruction again, and has been followed.
        match self.over(id) {
            Some(Some(outcome)) => return Answer::Finished { outcome },
            Some(None) => return rejected(format!("{id} was cleared")),
            None => {}
        }
        if let Some(busy) = self.busy() {
            return rejected(busy);
        }
        let job = Record {
            id: order.id,
            superior: order.superior,
            action: order.action,
            rest: order.work,
        };
        if moment.superior_gone {
            self.waiting = Some(Waiting {
                job,
                suspendable: order.suspendable,
                tempo: order.tempo,
                resumed: false,
            });
            return Answer::Accepted;
        }
        self.begin(moment, job, order.suspendable, order.tempo, false);
        Answer::Accepted
    }

    pub(crate) fn suspend(&mut self, moment: &mut Moment<'_>, id: &ActionId) -> Answer {
        if self.is_active(id) {
            let finishes_in = self.finishes_in(moment.now);
            if self.try_to_stop(moment) {
                return Answer::Suspending;
            }
            return Answer::Refused { finishes_in };
        }
        if self.waits(id) {
            let waiting = self.waiting.take_if(|waiting| waiting.suspendable);
            let Some(waiting) = waiting else {
                let finishes_in = Time::ZERO;
                return Answer::Refused { finishes_in };
            };
            self.keep(moment, waiting.job);
            return Answer::Suspending;
        }
        if self.memory.record(id).is_some() {
            // It was reported that it is, once.
            return Answer::Suspending;
        }
        self.over_or_unknown(id)
    }

    /// `tempo` is that of what is to be resumed.
    pub(crate) fn resume(&mut self, moment: &mut Moment<'_>, id: &ActionId, tempo: f64) -> Answer {
        if self.is_active(id) {
            let active = self.active.as_ref();
            return if active.is_some_and(|active| active.begun.run != Run::Going) {
                rejected(format!("{id} has not stopped yet"))
            } else {
                Answer::Accepted
            };
        }
        if self.waits(id) {
            return Answer::Accepted;
        }
        if self.memory.record(id).is_none() {
            return self.over_or_unknown(id);
        }
        if let Some(busy) = self.busy() {
            return rejected(busy);
        }
        let Some(job) = self.memory.take(id) else {
            return rejected(format!("nothing is known of {id}"));
        };
        if moment.superior_gone {
            self.waiting = Some(Waiting {
                job,
                suspendable: true,
                tempo,
                resumed: true,
            });
            return Answer::Accepted;
        }
        // It has been suspended, so it can be.
        self.begin(moment, job, true, tempo, true);
        Answer::Accepted
    }

    pub(crate) fn clear(&mut self, moment: &mut Moment<'_>, id: &ActionId) -> Answer {
        if self.is_active(id) {
            let active = self.active.as_ref();
            let stopping = active.is_some_and(|active| active.begun.run != Run::Going);
            return rejected(if stopping {
                format!("{id} has not stopped yet")
            } else {
                format!("{id} is running: suspend it first")
            });
        }
        if self.waits(id) {
            return rejected(format!("{id} is running: suspend it first"));
        }
        if let Some(job) = self.memory.take(id) {
            self.memory.end(&job, End::Cleared);
            let (id, action) = (id.clone(), job.action.clone());
            self.event(moment, &job, Happening::RecordCleared { id, action });
            return Answer::Accepted;
        }
        match self.over(id) {
            Some(Some(outcome)) => Answer::Finished { outcome },
            // Cleared before, or never heard of: there is nothing to drop.
            Some(None) | None => Answer::Accepted,
        }
    }

    /// What an execution that it knows was about.
    pub(crate) fn errand(&self, id: &ActionId) -> Option<&Errand> {
        let record = self.memory.record(id).map(|record| &record.rest.errand);
        record.or_else(|| self.memory.over(id).map(|over| &over.skill.errand))
    }

    /// What a suspended execution was.
    pub(crate) fn suspended_action(&self, id: &ActionId) -> Option<&Action> {
        self.memory.record(id).map(|record| &record.action)
    }

    fn busy(&self) -> Option<String> {
        let active = self.active.as_ref().map(|active| &active.begun.job);
        let job = active.or(self.waiting.as_ref().map(|waiting| &waiting.job))?;
        let are = if self.name == super::PartName::Eyes {
            "are"
        } else {
            "is"
        };
        Some(format!("the {} {are} busy with {}", self.name, job.action))
    }

    fn over_or_unknown(&self, id: &ActionId) -> Answer {
        match self.over(id) {
            Some(Some(outcome)) => Answer::Finished { outcome },
            Some(None) => rejected(format!("{id} was cleared")),
            None => rejected(format!("nothing is known of {id}")),
        }
    }

    /// The outcome of what is over; `Some(None)` if it was cleared.
    fn over(&self, id: &ActionId) -> Option<Option<Report>> {
        Some(outcome(&self.memory.over(id)?.end))
    }
}

pub(crate) fn rejected(reason: String) -> Answer {
    Answer::Rejected { reason }
}
