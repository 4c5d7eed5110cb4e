//! How what a part does goes on and ends.

use agent_core::model::{Symbol, Time};
use agent_core::protocol::{Happening, Report};

use super::{Active, Begun, Hindrance, Moment, Part, Run, Waiting, Work, outcome};
use crate::faults::Fault;
use crate::memory::{End, Record};

/// What is due. In the order in which simultaneous things happen.
#[derive(Clone, Copy, Eq, PartialEq, Ord, PartialOrd)]
enum Due {
    /// What was told to stop is at rest.
    Rest,
    /// It is done.
    End,
    /// Something is to be done about a fault.
    Fault,
}

impl Part {
    /// When something is due.
    pub(crate) fn due(&self) -> Option<Time> {
        self.next().map(|(time, _)| time)
    }

    fn next(&self) -> Option<(Time, Due)> {
        let active = self.active.as_ref()?;
        let next = match active.begun.rest_at {
            Some(rest_at) => [Some((rest_at, Due::Rest)), None],
            None => [
                Some((active.begun.end, Due::End)),
                active.errand_at.map(|time| (time, Due::Fault)),
            ],
        };
        next.into_iter().flatten().min()
    }

    /// Lets happen what is due.
    pub(crate) fn advance(&mut self, moment: &mut Moment<'_>) {
        while let Some((_, due)) = self.next().filter(|(time, _)| *time <= moment.now) {
            match due {
                Due::Rest => self.come_to_rest(moment),
                Due::End => {
                    let Some(active) = self.active.take() else {
                        return;
                    };
                    let job = &active.begun.job;
                    let end = match moment.reality.finish(&job.rest.errand) {
                        Ok(()) => End::Success,
                        Err(hindrance) => {
                            moment.reality.let_go(&job.rest.errand);
                            failure(hindrance)
                        }
                    };
                    self.end(moment, active.begun, end);
                }
                Due::Fault => self.do_fault(moment),
            }
        }
    }

    /// Whether what it does can go on; if not, it has failed.
    pub(crate) fn check(&mut self, moment: &mut Moment<'_>) {
        let Some(active) = &self.active else { return };
        let errand = &active.begun.job.rest.errand;
        let Err(hindrance) = moment.reality.goes_on(errand) else {
            return;
        };
        if let Some(active) = self.active.take() {
            moment.reality.let_go(&active.begun.job.rest.errand);
            self.end(moment, active.begun, failure(hindrance));
        }
    }

    pub(super) fn finishes_in(&self, now: Time) -> Time {
        let active = self.active.as_ref();
        active.map_or(Time::ZERO, |active| active.begun.end.since(now))
    }

    /// Sets it going. Nothing else runs.
    pub(super) fn begin(
        &mut self,
        moment: &mut Moment<'_>,
        job: Record<Work>,
        suspendable: bool,
        tempo: f64,
        resumed: bool,
    ) {
        let fault = if resumed {
            None
        } else {
            self.faults.next_action()
        };
        Self::report(moment, &job, Report::Started);
        let (id, action) = (job.id.clone(), job.action.clone());
        let what = if resumed {
            Happening::ActionResumed { id, action }
        } else {
            Happening::ActionStarted { id, action }
        };
        self.event(moment, &job, what);
        if let Err(hindrance) = moment.reality.begin(&job.rest.errand) {
            return self.end_job(moment, job, failure(hindrance));
        }
        let pace = match fault {
            Some(Fault::Slow { pace }) => pace,
            _ => 1.0,
        };
        let tempo = tempo / pace;
        let takes = Time::from_secs(job.rest.left_s * tempo);
        let errand_at = match fault {
            Some(Fault::Failure { fraction }) => {
                Some(moment.now + Time::from_secs(takes.secs() * fraction))
            }
            _ => None,
        };
        self.active = Some(Active {
            begun: Begun {
                job,
                suspendable,
                at: moment.now,
                end: moment.now + takes,
                tempo,
                run: Run::Going,
                rest_at: None,
                disowned: false,
            },
            fault,
            errand_at,
        });
    }

    /// Has what runs stop, if it can be suspended. Whether it can.
    pub(crate) fn try_to_stop(&mut self, moment: &mut Moment<'_>) -> bool {
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
        match late {
            Some(delay) => active.errand_at = Some(moment.now + delay),
            None => self.stop(moment),
        }
        true
    }

    fn do_fault(&mut self, moment: &mut Moment<'_>) {
        if let Some(active) = &mut self.active {
            active.errand_at = None;
            if active.begun.run == Run::Going {
                active.begun.run = Run::Failing;
            }
            self.stop(moment);
        }
    }

    /// Begins to come to rest.
    fn stop(&mut self, moment: &mut Moment<'_>) {
        let Some(active) = &mut self.active else {
            return;
        };
        active.errand_at = None;
        let begun = &mut active.begun;
        let whole_s = begun.end.since(begun.at).secs();
        let share = if whole_s > 0.0 {
            moment.now.since(begun.at).secs() / whole_s
        } else {
            1.0
        };
        begun
            .job
            .rest
            .leave(moment.now.since(begun.at), begun.tempo);
        let set_down_s = begun.job.rest.errand.set_down_s(share);
        begun.rest_at = Some(moment.now + Time::from_secs(set_down_s));
        if begun.run == Run::Stopping {
            let job = begun.job.clone();
            let (id, action) = (job.id.clone(), job.action.clone());
            self.event(moment, &job, Happening::ActionStopping { id, action });
        }
    }

    fn come_to_rest(&mut self, moment: &mut Moment<'_>) {
        let Some(Active { begun, .. }) = self.active.take() else {
            return;
        };
        moment.reality.let_go(&begun.job.rest.errand);
        match begun.run {
            Run::Failing => {
                let reason = format!("{} failed on the way", begun.job.action);
                let blocked_by = Vec::new();
                self.end(moment, begun, End::Failure { reason, blocked_by });
            }
            Run::Going | Run::Stopping if begun.disowned => {}
            Run::Going | Run::Stopping => self.keep(moment, begun.job),
        }
    }

    /// Keeps a record, and says so.
    pub(super) fn keep(&mut self, moment: &mut Moment<'_>, record: Record<Work>) {
        self.memory.keep(record.clone());
        let facts = Vec::new();
        Self::report(moment, &record, Report::Suspended { facts });
        let (id, action) = (record.id.clone(), record.action.clone());
        self.event(moment, &record, Happening::ActionSuspended { id, action });
    }

    fn end(&mut self, moment: &mut Moment<'_>, begun: Begun, end: End) {
        if !begun.disowned {
            self.end_job(moment, begun.job, end);
        }
    }

    fn end_job(&mut self, moment: &mut Moment<'_>, job: Record<Work>, end: End) {
        let (id, action) = (job.id.clone(), job.action.clone());
        let failure = match &end {
            End::Failure { reason, .. } | End::Unknown { reason } => Some(reason.clone()),
            End::Success | End::Cleared => None,
        };
        if let Some(report) = outcome(&end) {
            Self::report(moment, &job, report);
        }
        self.memory.end(&job, end);
        let what = Happening::ActionFinished {
            id,
            action,
            failure,
        };
        self.event(moment, &job, what);
    }

    /// The superior is there: what has waited for it is begun.
    pub(crate) fn begin_what_waits(&mut self, moment: &mut Moment<'_>) {
        if let Some(waiting) = self.waiting.take() {
            let Waiting {
                job,
                suspendable,
                tempo,
                resumed,
            } = waiting;
            self.begin(moment, job, suspendable, tempo, resumed);
        }
    }

    /// The superior has lost its memory: it will neither resume nor clear anything.
    pub(crate) fn forget(&mut self, moment: &mut Moment<'_>, superior: &Symbol) {
        for record in self.memory.forget(superior) {
            let (id, action) = (record.id.clone(), record.action.clone());
            self.event(moment, &record, Happening::RecordCleared { id, action });
        }
        self.waiting = None;
        let _ = self.try_to_stop(moment);
        if let Some(active) = &mut self.active {
            active.begun.disowned = true;
        }
    }

    /// It has just been recalled: what was under way has come to nothing, and nothing goes on by
    /// itself.
    pub(crate) fn settle(&mut self, moment: &mut Moment<'_>) {
        if let Some(mut active) = self.active.take() {
            let begun = &mut active.begun;
            if begun.rest_at.is_none() {
                begun
                    .job
                    .rest
                    .leave(moment.now.since(begun.at), begun.tempo);
            }
            moment.reality.let_go(&begun.job.rest.errand);
            let begun = active.begun;
            if begun.disowned {
                // Nobody knows of it any more.
            } else if begun.suspendable && begun.run != Run::Failing {
                self.keep(moment, begun.job);
            } else {
                let reason = "the vehicle was started anew before it was done".to_owned();
                let blocked_by = Vec::new();
                self.end(moment, begun, End::Failure { reason, blocked_by });
            }
        }
        // What was suspended once, and was asked for again before the start, is suspended until it is
        // asked for again.
        if let Some(waiting) = self.waiting.take_if(|waiting| waiting.resumed) {
            self.keep(moment, waiting.job);
        }
    }
}

fn failure(hindrance: Hindrance) -> End {
    End::Failure {
        reason: hindrance.reason,
        blocked_by: hindrance.blocked_by,
    }
}

impl Work {
    /// It stops after that long: what is left of it then.
    fn leave(&mut self, after: Time, tempo: f64) {
        if self.errand.begins_anew() {
            self.left_s = self.again_s;
        } else {
            self.left_s = (self.left_s - after.secs() / tempo).max(0.0);
        }
    }
}
