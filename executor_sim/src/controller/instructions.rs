//! What superiors say, and what they are answered.

use agent_core::model::{Action, Symbol, Time};
use agent_core::protocol::{ActionId, Answer, Happening, Instruction, Report};

use super::waiting::Waiting;
use super::{Controller, End, Record, Skill};
use crate::{Place, WORLD};

impl Controller {
    pub(super) fn instructed(
        &mut self,
        now: Time,
        from: Symbol,
        instruction: Instruction,
    ) -> Answer {
        match instruction {
            Instruction::Execute { id, action, .. } => self.execute(now, from, id, action),
            Instruction::Suspend { id } => self.suspend(now, &id),
            Instruction::Resume { id, .. } => self.resume(now, &from, &id),
            Instruction::Clear { id } => self.clear(now, &id),
        }
    }

    fn execute(&mut self, now: Time, superior: Symbol, id: ActionId, action: Action) -> Answer {
        if self.active(&id).is_some() || self.waits(&id).is_some() {
            return Answer::Accepted;
        }
        if self.memory.record(&id).is_some() {
            return rejected(format!("{id} is suspended: resume it or clear it"));
        }
        // An identity is used once: this is the same instruction again, and has been followed.
        match self.over(&id) {
            Some(Some(outcome)) => return Answer::Finished { outcome },
            Some(None) => return rejected(format!("{id} was cleared")),
            None => {}
        }
        let skill = match self.fitting(&action) {
            Ok(skill) => skill,
            Err(reason) => return rejected(reason),
        };
        let (rest, suspendable, stands) = skill;
        // Nobody could stop it now.
        let gone = self.gone.contains(&superior);
        let job = Record {
            id: id.clone(),
            superior,
            action,
            rest,
        };
        if gone || !stands {
            self.waiting = Some(Waiting {
                job,
                suspendable,
                resumed: false,
            });
            return Answer::Accepted;
        }
        let fault = self.faults.next_action();
        self.begin(now, job, suspendable, false, fault);
        Answer::Accepted
    }

    /// What the robot can begin, whether that can be suspended, and whether the robot stands already;
    /// or why it cannot.
    fn fitting(&self, action: &Action) -> Result<(Skill, bool, bool), String> {
        let (skill, suspendable) = self.vocabulary.skill(action)?;
        if self.is_only_halting() {
            return Ok((skill, suspendable, false));
        }
        self.free_to_begin()?;
        self.fits_here(&skill)?;
        Ok((skill, suspendable, true))
    }

    /// Whether that can be done from where the robot stands.
    pub(super) fn fits_here(&self, skill: &Skill) -> Result<(), String> {
        match (skill, self.surroundings.place()) {
            (Skill::Drive { arc, to }, Some(place)) => self.fits(arc, to, place),
            (Skill::SetDoor { door, .. }, _) => {
                let doors = self.surroundings.floor().doors();
                if doors.contains_key(door) {
                    Ok(())
                } else {
                    Err(format!("there is no door `{door}`"))
                }
            }
            _ => Ok(()),
        }
    }

    fn free_to_begin(&self) -> Result<&Place, String> {
        let waiting = self.waiting.as_ref().map(|waiting| &waiting.job);
        let active = self.active.as_ref().map(|active| &active.begun.job);
        if let Some(job) = waiting.or(active.filter(|_| self.halt.is_none())) {
            return Err(format!("the robot is busy with {}", job.action));
        }
        if self.gone.contains(WORLD) {
            return Err("the robot's motors and sensors cannot be reached".to_owned());
        }
        let place = self.surroundings.place();
        place
            .filter(|_| self.halt.is_none())
            .ok_or_else(|| "the robot has not said yet where it stands".to_owned())
    }

    /// Whether one can drive along `arc` to `to` from that place.
    fn fits(&self, arc: &Symbol, to: &Symbol, place: &Place) -> Result<(), String> {
        let floor = self.surroundings.floor();
        let passage = floor
            .passage(arc)
            .ok_or_else(|| format!("there is no arc `{arc}`"))?;
        if passage.offset_of(to).is_none() {
            return Err(format!("`{to}` is not an end of `{arc}`"));
        }
        if floor.offset_on(arc, place).is_none() {
            return Err(format!("the robot stands {place}, not on `{arc}`"));
        }
        Ok(())
    }

    fn suspend(&mut self, now: Time, id: &ActionId) -> Answer {
        if let Some(active) = self.active(id) {
            let finishes_in = active.expected_end.since(now);
            if self.try_to_stop(now) {
                return Answer::Suspending;
            }
            return Answer::Refused { finishes_in };
        }
        if self.waits(id).is_some() {
            if self.set_waiting_aside(now) {
                return Answer::Suspending;
            }
            let finishes_in = Time::ZERO;
            return Answer::Refused { finishes_in };
        }
        if self.memory.record(id).is_some() {
            // It was reported that it is, once: a second report might be taken for one of a later
            // suspension.
            return Answer::Suspending;
        }
        match self.over(id) {
            Some(Some(outcome)) => Answer::Finished { outcome },
            Some(None) => rejected(format!("{id} was cleared")),
            None => rejected(format!("nothing is known of {id}")),
        }
    }

    fn resume(&mut self, now: Time, from: &Symbol, id: &ActionId) -> Answer {
        if let Some(active) = self.active(id) {
            return if active.is_stopping() {
                rejected(format!("{id} has not stopped yet"))
            } else {
                Answer::Accepted
            };
        }
        if self.waits(id).is_some() {
            return Answer::Accepted;
        }
        if self.memory.record(id).is_none() {
            return match self.over(id) {
                Some(Some(outcome)) => Answer::Finished { outcome },
                Some(None) => rejected(format!("{id} was cleared")),
                None => rejected(format!("nothing is known of {id}")),
            };
        }
        let place = match self.free_to_begin() {
            // If it is gone, nobody could stop it now.
            Ok(place) if !self.gone.contains(from) => place.clone(),
            Err(reason) if !self.is_only_halting() => return rejected(reason),
            Ok(_) | Err(_) => {
                self.waiting = self.memory.take(id).map(|job| Waiting {
                    job,
                    suspendable: true,
                    resumed: true,
                });
                return Answer::Accepted;
            }
        };
        let Some(job) = self.memory.take(id) else {
            return rejected(format!("nothing is known of {id}"));
        };
        if let Skill::Drive { arc, to } = &job.rest
            && self.fits(arc, to, &place).is_err()
        {
            let reason = format!("the record does not fit: the robot stands {place}");
            let blocked_by = Vec::new();
            self.end_job(now, job, End::Failure { reason, blocked_by });
            return Answer::Accepted;
        }
        // It has been suspended, so it can be.
        self.begin(now, job, true, true, None);
        Answer::Accepted
    }

    fn clear(&mut self, now: Time, id: &ActionId) -> Answer {
        if let Some(active) = self.active(id) {
            return rejected(if active.is_stopping() {
                format!("{id} has not stopped yet")
            } else {
                format!("{id} is running: suspend it first")
            });
        }
        if self.waits(id).is_some() {
            return rejected(format!("{id} is running: suspend it first"));
        }
        if let Some(job) = self.memory.take(id) {
            self.memory.end(&job, End::Cleared);
            let (id, action) = (id.clone(), job.action.clone());
            self.event(now, &job, Happening::RecordCleared { id, action });
            return Answer::Accepted;
        }
        match self.over(id) {
            Some(Some(outcome)) => Answer::Finished { outcome },
            // Cleared before, or never heard of: there is nothing to drop.
            Some(None) | None => Answer::Accepted,
        }
    }

    /// The outcome of an action that is over; `Some(None)` if it was cleared.
    fn over(&mut self, id: &ActionId) -> Option<Option<Report>> {
        let over = self.memory.over(id)?;
        if over.end == End::Cleared {
            return Some(None);
        }
        let (skill, end) = (over.skill.clone(), over.end.clone());
        Some(Some(self.outcome(&skill, &end)))
    }

    pub(super) fn report_suspended(&mut self, record: &Record) {
        let facts = if self.stands() {
            self.surroundings.tell(record.rest.arc())
        } else {
            Vec::new()
        };
        self.report(record, Report::Suspended { facts });
    }
}

fn rejected(reason: String) -> Answer {
    Answer::Rejected { reason }
}
