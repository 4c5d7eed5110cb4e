//! What happens to a mover: instructions, time, users, and superiors that come and go.

use agent_core::model::{FactChange, Symbol};
use agent_core::protocol::{Answer, Input, Instruction, Machine, Output, Reply, Report};

use super::mover::wake_at;
use super::reach::{Reach, fact};
use super::{Room, rejected, users};
use crate::MoverSpec;
use crate::parts::{Job, Moment, Order, PartName, Said};

impl Room {
    pub(super) fn instruct_base(
        &mut self,
        vehicle: &Symbol,
        instruction: Instruction,
        to: Option<Symbol>,
    ) -> Answer {
        let now = self.now;
        let Some(mover) = self.movers.get_mut(vehicle) else {
            return rejected(format!("there is no vehicle {vehicle}"));
        };
        let Some(base) = &mut mover.base else {
            return rejected(format!("{vehicle} has no base"));
        };
        let id = instruction.id().clone();
        let sets_off = matches!(
            instruction,
            Instruction::Execute { .. } | Instruction::Resume { .. }
        );
        let is_new = !base.knows(&id);
        if sets_off
            && (is_new || base.is_suspended(vehicle, &id))
            && let Some(place) = &to
        {
            if self.things.blocked.contains(place) && base.world().stands() {
                // Whoever wants to set off looks ahead.
                mover.ahead = Some(place.clone());
                mover.told_of = None;
                return rejected(format!("{place} is blocked: nobody can drive there"));
            }
            if base.world().stands() {
                let action = match &instruction {
                    Instruction::Execute { action, .. } => action.clone(),
                    _ => fact("resume", &[place]),
                };
                let tempo = self.tempo.of(vehicle, &action);
                base.set_spec(MoverSpec {
                    max_speed_m_s: self.spec.max_speed_m_s / tempo,
                    ..self.spec
                });
            }
            mover.ways.insert(id.clone(), place.clone());
        }
        let cleared = matches!(instruction, Instruction::Clear { .. });
        let from = vehicle.clone();
        let reply = base.handle(now, Input::Instruction { from, instruction });
        let answer = match reply {
            Some(Reply::Instruction(answer)) => answer,
            _ => rejected("the base gave no answer, which is a fault in it".to_owned()),
        };
        if matches!(answer, Answer::Rejected { .. }) && is_new
            || cleared && answer == Answer::Accepted
        {
            mover.ways.remove(&id);
        }
        self.take_from_base(vehicle);
        self.with_facts(vehicle, answer, None)
    }

    pub(super) fn instruct_part(
        &mut self,
        vehicle: &Symbol,
        name: PartName,
        instruction: Instruction,
    ) -> Answer {
        let id = instruction.id().clone();
        let tempo = self.tempo_of(vehicle, name, &instruction);
        let order = match instruction {
            Instruction::Execute { id, action, .. } => match self.vocabulary.job(&action) {
                Ok(Job::Part { work, suspendable }) => Ok(Order {
                    id,
                    superior: vehicle.clone(),
                    action,
                    work,
                    suspendable,
                    tempo,
                }),
                Ok(Job::Base { .. }) => return rejected(format!("{action} is for the base")),
                Err(reason) => return rejected(reason),
            },
            other => Err(other),
        };
        let answer = self.with_part(vehicle, name, |part, moment| match order {
            Ok(order) => part.execute(moment, order),
            Err(Instruction::Suspend { id }) => part.suspend(moment, &id),
            Err(Instruction::Resume { id, .. }) => part.resume(moment, &id, tempo),
            Err(Instruction::Clear { id } | Instruction::Execute { id, .. }) => {
                part.clear(moment, &id)
            }
        });
        let answer = answer.unwrap_or_else(|| rejected(format!("{vehicle} has no {name}")));
        let mover = self.movers.get(vehicle);
        let part = mover.and_then(|mover| mover.parts.get(&name));
        let errand = part.and_then(|part| part.errand(&id)).cloned();
        self.with_facts(vehicle, answer, errand.as_ref())
    }

    /// How many seconds it takes for one of the model's, if it is begun now.
    fn tempo_of(&mut self, vehicle: &Symbol, name: PartName, instruction: &Instruction) -> f64 {
        let mover = self.movers.get(vehicle);
        let part = mover.and_then(|mover| mover.parts.get(&name));
        let begun = match (part, instruction) {
            (Some(part), Instruction::Execute { id, action, .. }) if !part.knows(id) => {
                Some(action.clone())
            }
            (Some(part), Instruction::Resume { id, .. }) => part.suspended_action(id).cloned(),
            _ => None,
        };
        begun.map_or(1.0, |action| self.tempo.of(vehicle, &action))
    }

    /// Has a part do something, with all that it can reach, and passes on what it says.
    fn with_part<T>(
        &mut self,
        vehicle: &Symbol,
        name: PartName,
        act: impl FnOnce(&mut crate::parts::Part, &mut Moment<'_>) -> T,
    ) -> Option<T> {
        let mut said = Vec::new();
        let now = self.now;
        let result = {
            let mover = self.movers.get_mut(vehicle)?;
            let place = mover.stands_at(now);
            let superior_gone = mover.gone;
            let part = mover.parts.get_mut(&name)?;
            let mut reach = Reach {
                now,
                vehicle,
                place: place.as_ref(),
                slots: &mover.slots,
                things: &mut self.things,
                chronicle: &mut self.chronicle,
            };
            let mut moment = Moment {
                now,
                reality: &mut reach,
                superior_gone,
                said: &mut said,
            };
            act(part, &mut moment)
        };
        for said in said {
            match said {
                Said::Event(event) => self.outputs.push_back(Output::Event(event)),
                Said::Report {
                    to,
                    id,
                    report,
                    errand,
                } => {
                    let truth = self.truth(vehicle);
                    let report = self.with_truth(report, &truth, Some(&errand));
                    self.pass_on(vehicle, (to, id, report), truth);
                }
            }
        }
        Some(result)
    }

    /// What is due in the parts of a mover happens.
    pub(super) fn wake(&mut self, vehicle: &Symbol) {
        let now = self.now;
        let Some(mover) = self.movers.get_mut(vehicle) else {
            return;
        };
        let parts: Vec<PartName> = mover.parts.keys().copied().collect();
        if let Some(base) = &mut mover.base
            && wake_at(base).is_some_and(|time| time <= now)
        {
            let _ = base.handle(now, Input::Wake);
            self.take_from_base(vehicle);
        }
        for part in parts {
            self.with_part(vehicle, part, |part, moment| part.advance(moment));
        }
    }

    /// Passes on what the base says, with the facts of the whole vehicle.
    pub(super) fn take_from_base(&mut self, vehicle: &Symbol) {
        loop {
            let mover = self.movers.get_mut(vehicle);
            let Some(base) = mover.and_then(|mover| mover.base.as_mut()) else {
                return;
            };
            let Some(output) = base.poll_output() else {
                return;
            };
            match output {
                Output::Report { to, id, report } => {
                    if let Some(mover) = self.movers.get_mut(vehicle) {
                        if report == Report::Started {
                            mover.ahead = mover.ways.get(&id).cloned();
                        } else {
                            mover.ahead = None;
                        }
                        if report.is_end() {
                            mover.ways.remove(&id);
                        }
                    }
                    let truth = self.truth(vehicle);
                    let report = self.with_truth(report, &truth, None);
                    self.pass_on(vehicle, (to, id, report), truth);
                }
                // Said with everything else that the vehicle sees.
                Output::Observed { .. } | Output::Seen { .. } => {
                    if let Some(mover) = self.movers.get_mut(vehicle) {
                        mover.told_of = None;
                    }
                }
                Output::Event(event) => self.outputs.push_back(Output::Event(event)),
                Output::Instruct { to, instruction } => {
                    self.outputs.push_back(Output::Instruct { to, instruction });
                }
                Output::Local(never) => match never {},
            }
        }
    }

    /// What has happened may have stopped what goes on, and may be seen.
    pub(super) fn after(&mut self) {
        for vehicle in self.names.vehicles.clone() {
            let Some(mover) = self.movers.get(&vehicle) else {
                continue;
            };
            let parts: Vec<PartName> = mover.parts.keys().copied().collect();
            for part in parts {
                self.with_part(&vehicle, part, |part, moment| part.check(moment));
            }
        }
        for vehicle in self.names.vehicles.clone() {
            self.tell_what_is_seen(&vehicle);
        }
    }

    pub(super) fn somebody_changes(&mut self, changes: &[FactChange]) {
        for change in changes {
            users::follow(&mut self.things, change);
        }
        // Doors are the floor's.
        let now = self.now;
        for vehicle in self.names.vehicles.clone() {
            let mover = self.movers.get_mut(&vehicle);
            if let Some(base) = mover.and_then(|mover| mover.base.as_mut()) {
                let _ = base.handle(now, Input::Observation(changes.to_vec()));
                self.take_from_base(&vehicle);
            }
        }
    }

    /// Whoever drives a vehicle has come or gone.
    pub(super) fn neighbour(&mut self, name: &Symbol, there: bool) {
        let now = self.now;
        let Some(mover) = self.movers.get_mut(name) else {
            return;
        };
        mover.gone = !there;
        if let Some(base) = &mut mover.base {
            let name = name.clone();
            let _ = base.handle(now, Input::Neighbour { name, there });
        }
        self.take_from_base(name);
        for part in self.part_names(name) {
            self.with_part(name, part, |part, moment| {
                if there {
                    part.begin_what_waits(moment);
                } else {
                    // Who cannot be stopped must not move. What cannot be stopped runs to its end.
                    let _ = part.try_to_stop(moment);
                }
            });
        }
        if there {
            self.tell_everything(name);
        }
    }

    /// Whoever drives a vehicle has lost its memory.
    pub(super) fn reborn(&mut self, name: &Symbol) {
        let now = self.now;
        let Some(mover) = self.movers.get_mut(name) else {
            return;
        };
        if let Some(base) = &mut mover.base {
            let name = name.clone();
            let _ = base.handle(now, Input::Reborn { name });
        }
        self.take_from_base(name);
        for part in self.part_names(name) {
            self.with_part(name, part, |part, moment| part.forget(moment, name));
        }
        self.tell_everything(name);
    }

    pub(super) fn stop_what_can_be(&mut self, vehicle: &Symbol) {
        let now = self.now;
        let mover = self.movers.get_mut(vehicle);
        if let Some(base) = mover.and_then(|mover| mover.base.as_mut()) {
            base.wind_down(now);
        }
        self.take_from_base(vehicle);
        for part in self.part_names(vehicle) {
            self.with_part(vehicle, part, |part, moment| {
                let _ = part.try_to_stop(moment);
            });
        }
    }

    pub(super) fn part_names(&self, vehicle: &Symbol) -> Vec<PartName> {
        let mover = self.movers.get(vehicle);
        mover.map_or_else(Vec::new, |mover| mover.parts.keys().copied().collect())
    }

    /// Parts that have just been recalled come to rest.
    pub(super) fn settle(&mut self) {
        for vehicle in self.names.vehicles.clone() {
            self.take_from_base(&vehicle);
            for part in self.part_names(&vehicle) {
                self.with_part(&vehicle, part, |part, moment| part.settle(moment));
            }
        }
    }
}
