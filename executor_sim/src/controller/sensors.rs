//! What the sensors say, and what comes of it.

use agent_core::model::{Fact, Symbol, Time};
use agent_core::protocol::{Happening, Output};

use super::surroundings::fact;
use super::{Active, Controller, End, Run, Skill};
use crate::faults::Fault;
use crate::{Place, Sensor, Ticket};

impl Controller {
    pub(super) fn sensed(&mut self, now: Time, sensor: Sensor) {
        match sensor {
            Sensor::Underway { ticket, expected } => self.underway(now, ticket, expected),
            Sensor::Declined { ticket, reason } => {
                if let Some(active) = self.ended(ticket) {
                    self.fail(now, active, reason, Vec::new());
                }
            }
            Sensor::Arrived { ticket, node, .. } => {
                if let Some(active) = self.ended(ticket) {
                    self.surroundings.stands_at(Place::Node { node });
                    self.end(now, active.job, End::Success);
                }
            }
            Sensor::Stopped { ticket, place, .. } => {
                if let Some(active) = self.ended(ticket) {
                    self.surroundings.stands_at(place);
                    self.stopped(now, active);
                }
            }
            Sensor::Obstructed {
                ticket,
                door,
                place,
                ..
            } => {
                if let Some(active) = self.ended(ticket) {
                    self.surroundings.stands_at(place);
                    self.obstructed(now, active, &door);
                }
            }
            Sensor::SpeechEnded { ticket } => {
                if let Some(active) = self.ended(ticket) {
                    self.end(now, active.job, End::Success);
                }
            }
            Sensor::Hushed { ticket, spoken_s } => {
                if let Some(mut active) = self.ended(ticket) {
                    if let Skill::Speak { duration_s } = &mut active.job.rest {
                        *duration_s = (*duration_s - spoken_s * active.pace).max(0.0);
                    }
                    self.stopped(now, active);
                }
            }
            Sensor::DoorSet { ticket, door, open } => {
                self.surroundings.set_door(&door, open);
                if let Some(active) = self.ended(ticket) {
                    self.end(now, active.job, End::Success);
                }
            }
            Sensor::DoorChanged { door, open } => self.door_changed(&door, open),
            Sensor::Halted { place, doors } => {
                for (door, open) in doors {
                    self.surroundings.set_door(&door, open);
                }
                self.halted(now, place);
            }
            // For displays.
            Sensor::Pose(_) => {}
        }
    }

    /// The active action, if the sensor speaks of it: then it is active no more. Others speak of
    /// what was before the controller started.
    fn ended(&mut self, ticket: Ticket) -> Option<Active> {
        self.active.take_if(|active| active.ticket == ticket)
    }

    fn underway(&mut self, now: Time, ticket: Ticket, expected: Time) {
        let Some(active) = &mut self.active else {
            return;
        };
        if active.ticket != ticket {
            return;
        }
        active.expected_end = now + expected;
        if let Some(Fault::Failure { fraction }) = active.fault {
            active.errand_at = Some(now + Time::from_secs(expected.secs() * fraction));
        }
    }

    /// It stands still on our word.
    fn stopped(&mut self, now: Time, active: Active) {
        match active.run {
            Run::Stopping => self.suspended(now, active),
            Run::Failing => self.fail_by_itself(now, active),
            Run::Going => {
                let reason = "the robot was stopped, but not by its superior".to_owned();
                self.fail(now, active, reason, Vec::new());
            }
        }
    }

    fn suspended(&mut self, now: Time, active: Active) {
        let record = active.job;
        self.memory.keep(record.clone());
        self.report_suspended(&record);
        let (id, action) = (record.id.clone(), record.action.clone());
        self.event(now, &record, Happening::ActionSuspended { id, action });
    }

    fn obstructed(&mut self, now: Time, active: Active, door: &Symbol) {
        match active.run {
            // It stands, as it was asked to. Whether the door still matters is for whoever asked.
            Run::Stopping => self.suspended(now, active),
            Run::Failing => self.fail_by_itself(now, active),
            Run::Going => {
                let reason = format!("the door `{door}` is closed");
                self.fail(now, active, reason, vec![fact("open", [door])]);
            }
        }
    }

    fn fail_by_itself(&mut self, now: Time, active: Active) {
        let reason = format!("{} failed on the way", active.job.action);
        self.fail(now, active, reason, Vec::new());
    }

    fn fail(&mut self, now: Time, active: Active, reason: String, blocked_by: Vec<Fact>) {
        self.end(now, active.job, End::Failure { reason, blocked_by });
    }

    fn halted(&mut self, now: Time, place: Place) {
        self.surroundings.stands_at(place);
        if self.memory.running.is_none() && self.active.is_none() {
            // What superiors were told before this controller started is gone; they are taken to
            // know where the robot stands, or ask for an announcement.
            let _ = self.surroundings.tell(None);
        }
        if let Some(job) = self.memory.running.take() {
            let reason = "the robot's controller was started anew".to_owned();
            let blocked_by = Vec::new();
            self.end(now, job, End::Failure { reason, blocked_by });
        }
        if let Some(active) = self.active.take() {
            self.stopped(now, active);
        }
    }

    fn door_changed(&mut self, door: &Symbol, open: bool) {
        self.surroundings.set_door(door, open);
        let mut facts = vec![self.surroundings.door_fact(door)];
        if self.stands() && self.surroundings.stands_by(door) {
            facts.extend(self.surroundings.tell(None));
        }
        self.outputs.push_back(Output::Observed {
            facts,
            reported_to: None,
        });
    }
}
