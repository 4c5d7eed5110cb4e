//! What the sensors say, and what comes of it.

use std::collections::BTreeMap;

use agent_core::model::{Fact, Symbol, Time};
use agent_core::protocol::{Happening, Output};

use super::active::{Active, Begun, Run};
use super::restart::Account;
use super::{Controller, End, Skill};
use crate::faults::Fault;
use crate::memory::Record;
use crate::{Place, Sensor, Ticket};

impl Controller {
    pub(super) fn sensed(&mut self, now: Time, sensor: Sensor) {
        match sensor {
            Sensor::Underway { ticket, expected } => self.underway(now, ticket, expected),
            Sensor::Declined { ticket, reason } => {
                if let Some(active) = self.ended(ticket) {
                    self.fail(now, active.begun, reason, Vec::new());
                }
            }
            Sensor::Arrived { ticket, node, .. } => {
                if let Some(active) = self.ended(ticket) {
                    self.surroundings.stands_at(Place::Node { node });
                    self.end(now, active.begun, End::Success);
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
            Sensor::SpeechEnded { ticket } | Sensor::DeedDone { ticket } => {
                if let Some(active) = self.ended(ticket) {
                    self.end(now, active.begun, End::Success);
                }
            }
            Sensor::Hushed { ticket, spoken_s } => self.hushed(now, ticket, spoken_s),
            Sensor::DoorSet { ticket, door, open } => {
                self.surroundings.set_door(&door, open);
                if let Some(active) = self.ended(ticket) {
                    self.end(now, active.begun, End::Success);
                }
            }
            Sensor::DoorChanged { door, open } => self.door_changed(&door, open),
            Sensor::Halted {
                ticket,
                place,
                doors,
                heard,
                done,
            } => {
                if self.halt.take_if(|halt| *halt == ticket).is_some() {
                    self.all_doors(doors);
                    self.halted(now, place, &Account { heard, done });
                }
            }
            // For displays.
            Sensor::Pose(_) => {}
        }
    }

    /// The active action, if the sensor speaks of it: then it is active no more. Others speak of
    /// what is over.
    fn ended(&mut self, ticket: Ticket) -> Option<Active> {
        self.active.take_if(|active| active.begun.ticket == ticket)
    }

    fn underway(&mut self, now: Time, ticket: Ticket, expected: Time) {
        let Some(active) = &mut self.active else {
            return;
        };
        if active.begun.ticket != ticket {
            return;
        }
        active.expected_end = now + expected;
        if active.begun.cut.is_none()
            && let Some(Fault::Failure { fraction }) = active.fault
        {
            active.errand_at = Some(now + Time::from_secs(expected.secs() * fraction));
        }
    }

    fn hushed(&mut self, now: Time, ticket: Ticket, spoken_s: f64) {
        let Some(mut active) = self.ended(ticket) else {
            return;
        };
        let begun = &mut active.begun;
        if let Skill::Speak { duration_s } = &mut begun.job.rest {
            *duration_s = (*duration_s - spoken_s * begun.pace).max(0.0);
        }
        if begun.cut.is_some() {
            // Where the robot stands is still to come.
            self.active = Some(active);
        } else {
            self.stopped(now, active);
        }
    }

    /// It stands still on our word.
    pub(super) fn stopped(&mut self, now: Time, active: Active) {
        let begun = active.begun;
        match begun.run {
            Run::Stopping => self.suspended(now, begun),
            Run::Failing => self.fail_by_itself(now, begun),
            // Stopping never waits for the disk: that it was asked to may have been forgotten.
            Run::Going if begun.cut.is_some() && begun.suspendable => self.suspended(now, begun),
            Run::Going => {
                let reason = "the robot was stopped, but not by its superior".to_owned();
                self.fail(now, begun, reason, Vec::new());
            }
        }
    }

    pub(super) fn suspended(&mut self, now: Time, begun: Begun) {
        if begun.disowned {
            self.drop_disowned(&begun.job);
        } else {
            self.keep(now, begun.job);
        }
    }

    /// Keeps a record, and says so.
    pub(super) fn keep(&mut self, now: Time, record: Record) {
        self.memory.keep(record.clone());
        self.report_suspended(&record);
        let (id, action) = (record.id.clone(), record.action.clone());
        self.event(now, &record, Happening::ActionSuspended { id, action });
    }

    pub(super) fn fail_by_itself(&mut self, now: Time, begun: Begun) {
        let reason = format!("{} failed on the way", begun.job.action);
        self.fail(now, begun, reason, Vec::new());
    }

    pub(super) fn fail(&mut self, now: Time, begun: Begun, reason: String, blocked_by: Vec<Fact>) {
        self.end(now, begun, End::Failure { reason, blocked_by });
    }

    /// How all doors are, after a time in which some may have moved unseen.
    fn all_doors(&mut self, doors: BTreeMap<Symbol, bool>) {
        let mut facts = Vec::new();
        for (door, open) in doors {
            if self.surroundings.set_door(&door, open) {
                facts.push(self.surroundings.door_fact(&door));
            }
        }
        if !facts.is_empty() {
            self.outputs.push_back(Output::Observed {
                facts,
                reported_to: None,
            });
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
