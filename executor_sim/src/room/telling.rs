//! What the superior of a vehicle is told: the truth of all that the vehicle knows by itself.

use agent_core::model::{FactChange, Symbol};
use agent_core::protocol::{ActionId, Answer, Output, Report};

use super::Room;
use super::reach::fact;
use super::sight::{Looker, sight};
use crate::parts::Errand;

impl Room {
    pub(super) fn tell_what_is_seen(&mut self, vehicle: &Symbol) {
        let version = self.things.version;
        let now = self.now;
        let Some(mover) = self.movers.get_mut(vehicle) else {
            return;
        };
        let of = Some((version, mover.stands_at(now), mover.ahead.clone()));
        if mover.told_of == of {
            return;
        }
        mover.told_of = of;
        let facts = self.truth(vehicle);
        let Some(mover) = self.movers.get_mut(vehicle) else {
            return;
        };
        if mover.told != facts {
            mover.told.clone_from(&facts);
            self.outputs.push_back(Output::Seen {
                to: vehicle.clone(),
                facts,
                reported: false,
            });
        }
    }

    /// Passes on a report. What is in it its superior needs not be told again.
    pub(super) fn pass_on(
        &mut self,
        vehicle: &Symbol,
        (to, id, report): (Symbol, ActionId, Report),
        truth: Vec<FactChange>,
    ) {
        let with_facts = report.is_end() || matches!(report, Report::Suspended { .. });
        self.outputs.push_back(Output::Report { to, id, report });
        let (version, now) = (self.things.version, self.now);
        if let Some(mover) = self.movers.get_mut(vehicle).filter(|_| with_facts) {
            mover.told_of = Some((version, mover.stands_at(now), mover.ahead.clone()));
            mover.told.clone_from(&truth);
            self.outputs.push_back(Output::Seen {
                to: vehicle.clone(),
                facts: truth,
                reported: true,
            });
        }
    }

    pub(super) fn with_facts(
        &mut self,
        vehicle: &Symbol,
        answer: Answer,
        errand: Option<&Errand>,
    ) -> Answer {
        match answer {
            Answer::Finished { outcome } => {
                let truth = self.truth(vehicle);
                let outcome = self.with_truth(outcome, &truth, errand);
                Answer::Finished { outcome }
            }
            other => other,
        }
    }

    /// With everything that the vehicle knows. The base says more of the way that it was on.
    pub(super) fn with_truth(
        &self,
        mut report: Report,
        truth: &[FactChange],
        errand: Option<&Errand>,
    ) -> Report {
        let said = match &report {
            Report::Success { .. } => self.said_by(errand),
            _ => Vec::new(),
        };
        if let Report::Success { facts }
        | Report::Failure { facts, .. }
        | Report::Unknown { facts, .. }
        | Report::Suspended { facts } = &mut report
        {
            facts.extend_from_slice(truth);
            facts.extend(said);
        }
        report
    }

    /// What a guest who was asked has said.
    fn said_by(&self, errand: Option<&Errand>) -> Vec<FactChange> {
        let Some(Errand::Ask { guest: name }) = errand else {
            return Vec::new();
        };
        let Some(guest) = self.things.guests.get(name) else {
            return Vec::new();
        };
        let kinds = self.names.kinds.iter();
        kinds
            .map(|kind| {
                let wants = fact("wants", &[name, kind]);
                if *kind == guest.wants {
                    FactChange::Add(wants)
                } else {
                    FactChange::Remove(wants)
                }
            })
            .collect()
    }

    /// Everything that the vehicle knows by itself, what is so and what is not.
    pub(super) fn truth(&mut self, vehicle: &Symbol) -> Vec<FactChange> {
        let now = self.now;
        let names = &self.names;
        let Some(mover) = self.movers.get_mut(vehicle) else {
            return Vec::new();
        };
        let mut facts = match &mut mover.base {
            Some(base) => base.announcement(),
            None => {
                let places = self.things.places.iter();
                let at = |place: &Symbol| fact("at", &[place]);
                places
                    .map(|place| match *place == mover.start {
                        true => FactChange::Add(at(place)),
                        false => FactChange::Remove(at(place)),
                    })
                    .collect()
            }
        };
        let place = mover.stands_at(now);
        facts.extend(sight(
            &self.things,
            &Looker {
                name: vehicle,
                vehicles: &names.vehicles,
                kinds: &names.kinds,
                has_arm: mover.has_arm(),
                has_eyes: mover.has_eyes(),
                slots: &mover.slots,
                place: place.as_ref(),
                ahead: mover.ahead.as_ref(),
                entrance: &names.entrance,
                tables: &names.tables,
            },
        ));
        facts
    }

    /// Tells a vehicle once more all that it knows, whatever it was told before.
    pub fn tell_everything(&mut self, vehicle: &Symbol) {
        let facts = self.truth(vehicle);
        if let Some(mover) = self.movers.get_mut(vehicle) {
            mover.told.clone_from(&facts);
        }
        self.outputs.push_back(Output::Seen {
            to: vehicle.clone(),
            facts,
            reported: false,
        });
    }
}
