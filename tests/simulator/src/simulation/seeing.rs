//! Who sees that whom is there or gone, and when.

use agent_core::model::Time;
use agent_core::protocol::{Arrival, Input};

use crate::process::{Role, name};
use crate::scenario::Who;

use super::{Due, LEASE, Simulation};

impl Simulation<'_> {
    pub(super) fn look_soon(&mut self, observer: Who, subject: Who) {
        if are_neighbours(observer, subject) {
            let delay = Time(1_000 + self.draw(8, 30_000));
            self.after(delay, Due::Look { observer, subject });
        }
    }

    pub(super) fn look_later(&mut self, observer: Who, subject: Who) {
        if are_neighbours(observer, subject) {
            let delay = Time(LEASE.0 + 1_000 + self.draw(9, 300_000));
            self.after(delay, Due::Look { observer, subject });
        }
    }

    pub(super) fn look(&mut self, observer: Who, subject: Who) {
        let node = &self.nodes[subject.index()];
        let lease_is_over = |since: Time| self.now.since(since) >= LEASE;
        let gone = node.role.is_none()
            || node.frozen.is_some_and(|(since, _)| lease_is_over(since))
            || self.cuts.iter().any(|cut| {
                cut.until > self.now
                    && lease_is_over(cut.since)
                    && [(cut.one, cut.other), (cut.other, cut.one)].contains(&(observer, subject))
            });
        let epoch = if gone { 0 } else { node.epoch };
        let looks = &mut self.nodes[observer.index()];
        if looks.role.is_none() || looks.frozen.is_some() {
            return;
        }
        let seen = std::mem::replace(&mut looks.seen[subject.index()], epoch);
        if seen == epoch {
            return;
        }
        let own = looks.epoch;
        let name = name(subject);
        if seen != 0 {
            self.tell(|| format!("{observer:<9} sees that {subject} is gone"));
            let there = false;
            let name = name.clone();
            self.law.sees(observer, name.clone(), there);
            let gone = Input::Neighbour { name, there };
            self.give(observer, Arrival::Input(gone), None);
        }
        if epoch != 0 {
            self.tell(|| format!("{observer:<9} sees that {subject} is there"));
            let line = self.nodes[subject.index()]
                .role
                .as_ref()
                .map_or(0, Role::line);
            self.law.sees(observer, name.clone(), true);
            self.give(observer, Arrival::Appeared { name, line }, None);
            if is_superior(observer, subject) {
                self.ask_what_holds(observer, own, subject, 0);
            }
        }
    }
}

pub(super) fn superiors(who: Who, two: bool) -> &'static [Who] {
    match who {
        Who::Child | Who::East => &[Who::Parent],
        Who::Executor if two => &[Who::Child, Who::East],
        Who::Executor => &[Who::Child],
        _ => &[],
    }
}

pub(super) fn is_superior(who: Who, of: Who) -> bool {
    superiors(of, true).contains(&who)
}

pub(super) fn are_neighbours(one: Who, other: Who) -> bool {
    is_superior(one, other) || is_superior(other, one)
}
