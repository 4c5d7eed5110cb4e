//! Tasks that come up by themselves, and facts that have to be found out.

use std::collections::BTreeSet;

use super::{Mind, Vehicle};
use crate::model::{Domain, ExecutionModel, Fact, Symbol, Task, Time};
use crate::planner::{Arisen, Planner, arising};
use crate::protocol::Urgency;
use crate::service::{NewTask, Stage, TaskId};

/// What could not be found out is looked for again after this long, on the world's clock.
const LOOK_AGAIN: Time = Time(60_000_000);

impl<A: Mind, P: Planner> Vehicle<A, P> {
    /// The belief has changed: publishes what has come up by that. Only what this vehicle has seen or
    /// brought about itself: of what it was told, the one who has told it has seen to that, unless it is
    /// about this one's own body, too, which nobody else knows of.
    pub(super) fn look_what_has_come_up(&mut self) {
        let now = arising(&self.problem());
        let before = std::mem::replace(&mut self.arisen, now);
        let new = self.arisen.difference(&before);
        let new = new.filter(|it| !self.learning || self.own_rules.contains(&it.rule));
        let new: Vec<Arisen> = new.cloned().collect();
        for arisen in new {
            let own = self.tasks.published().values();
            let mut own = own.map(|published| &published.new.what);
            if !own.any(|what| *what == arisen.task) && !self.is_published_by_another(&arisen.task)
            {
                self.publish_normal(&arisen.task);
            }
        }
    }

    /// Withdraws what nobody has yet and what needs no doing any more, or is another's.
    pub(super) fn withdraw_what_is_over(&mut self) {
        let open = self.tasks.published().iter();
        let over: Vec<TaskId> = open
            .filter(|(id, task)| {
                task.stage == Stage::Open
                    && !self.for_users.contains(*id)
                    && !self.finds_out(&task.new.what)
                    && (!self.arisen.iter().any(|it| it.task == task.new.what)
                        || self.is_published_by_an_earlier(&task.new.what))
            })
            .map(|(id, _)| id.clone())
            .collect();
        for task in over {
            self.tasks.withdraw(&task, None);
        }
    }

    /// Somebody wants to know facts that nobody here knows: if this vehicle can find them out, that is
    /// a task.
    pub(super) fn find_out(&mut self, facts: &[Fact]) {
        for fact in facts {
            let Some(pattern) = self.equipment.provides.get(&fact.name) else {
                continue;
            };
            let objects: Vec<Option<Symbol>> = fact.args.iter().cloned().map(Some).collect();
            let Some(task) = pattern.ground(&objects) else {
                continue;
            };
            let last = self.found_out.get(&task);
            if last.is_some_and(|at| *at + LOOK_AGAIN > self.now)
                || self.is_published_by_another(&task)
            {
                continue;
            }
            self.found_out.insert(task.clone(), self.now);
            self.publish_normal(&task);
        }
    }

    fn finds_out(&self, what: &Task) -> bool {
        let mut patterns = self.equipment.provides.values();
        patterns.any(|pattern| pattern.name == what.name)
    }

    fn is_published_by_another(&self, what: &Task) -> bool {
        let mut all = self.tasks.heard_of().values();
        all.any(|heard| {
            heard.tasks.offers.iter().any(|it| it.what == *what)
                || heard.tasks.awards.iter().any(|it| it.what == *what)
        })
    }

    /// Two may have seen the same at the same moment; then the first by name sees to it.
    fn is_published_by_an_earlier(&self, what: &Task) -> bool {
        let earlier = self.tasks.heard_of().iter();
        let mut earlier = earlier.take_while(|(name, _)| **name < self.name);
        earlier.any(|(_, heard)| {
            heard.tasks.offers.iter().any(|it| it.what == *what)
                || heard.tasks.awards.iter().any(|it| it.what == *what)
        })
    }

    fn publish_normal(&mut self, what: &Task) {
        let words = std::iter::once(&what.name).chain(&what.args);
        let words: Vec<&str> = words.map(Symbol::as_str).collect();
        let new = NewTask {
            what: what.clone(),
            urgency: Urgency::Normal,
            priority: 0,
            deadline: None,
        };
        self.publish(Some(words.join("-").into()), new);
    }
}

/// The rules for tasks that come up in which there is something about a vehicle's own body: facts that
/// change and are not shared.
pub(super) fn own_rules(domain: &Domain, model: &ExecutionModel) -> BTreeSet<usize> {
    let effects = domain.operators.values().map(|operator| &operator.effect);
    let changes = effects.flat_map(|effect| effect.add.iter().chain(&effect.remove));
    let changing: BTreeSet<&Symbol> = changes.map(|change| &change.fact.name).collect();
    let is_own = |name: &Symbol| changing.contains(name) && !model.shared.contains(name);
    let rules = model.arising.iter().enumerate().filter(|(_, rule)| {
        let mut own = false;
        for clause in &rule.when {
            clause.each_pattern(&mut |pattern| own |= is_own(&pattern.name));
        }
        own
    });
    rules.map(|(place, _)| place).collect()
}
