//! Superiors and executors that vanish, come back, or have lost their memory.

use std::collections::{BTreeMap, BTreeSet};

use super::{Agent, Phase, Running};
use crate::model::Symbol;
use crate::planner::Planner;
use crate::protocol::{ActionId, GoalId, Happening};

/// Who is not there.
#[derive(Clone, Debug, Default)]
pub(super) struct Neighbours {
    /// Who is gone, and whether that was said.
    gone: BTreeMap<Symbol, bool>,
    /// Superiors of goals that were recalled, until they are seen.
    unseen: BTreeSet<Symbol>,
}

impl Neighbours {
    /// Whether nothing is known against its being there.
    pub fn has(&self, name: &Symbol) -> bool {
        !self.gone.contains_key(name) && !self.unseen.contains(name)
    }

    /// A superior that has to be seen before anything is begun for it.
    pub fn expect(&mut self, superior: Symbol) {
        self.unseen.insert(superior);
    }
}

impl<P: Planner> Agent<P> {
    /// Superiors and executors that are gone, and after a restart superiors that were not seen since.
    pub fn absent(&self) -> BTreeSet<&Symbol> {
        let gone = self.neighbours.gone.keys();
        gone.chain(&self.neighbours.unseen).collect()
    }

    /// Whether the agent stands still because the superior of a goal of its own is absent: the running
    /// action is suspended, and nothing is started or resumed until the superior is back, as a robot
    /// that cannot be interrupted must not move.
    ///
    /// It does not matter where that goal stands. What runs above it is held with it: it was begun
    /// while there was somebody to stop it. A goal that no superior's goal is under runs on.
    pub fn holds(&self) -> bool {
        let absent = &self.neighbours;
        if absent.gone.is_empty() && absent.unseen.is_empty() {
            return false;
        }
        let mut superiors = self
            .all_intentions()
            .filter_map(|i| i.goal.superior.as_ref());
        superiors.any(|(name, _)| !absent.has(name))
    }

    /// Somebody has appeared or vanished.
    pub(super) fn neighbour(&mut self, name: Symbol, there: bool) {
        if there {
            self.neighbours.unseen.remove(&name);
            let told = self.neighbours.gone.remove(&name);
            if told == Some(true) {
                let name = name.clone();
                self.emit(None, Happening::NeighbourBack { name });
            }
            if told.is_some() {
                self.time_action_of(&name);
            }
        } else if !self.neighbours.gone.contains_key(&name) {
            self.neighbours.unseen.remove(&name);
            let matters = self.commands_here(&name) || self.executes_for_us(&name);
            self.neighbours.gone.insert(name.clone(), matters);
            self.time_action_of(&name);
            if matters {
                self.emit(None, Happening::NeighbourLost { name });
            }
        }
    }

    fn commands_here(&self, name: &Symbol) -> bool {
        let mut superiors = self
            .all_intentions()
            .filter_map(|i| i.goal.superior.as_ref());
        superiors.any(|(superior, _)| superior == name)
    }

    fn executes_for_us(&self, name: &Symbol) -> bool {
        let executors = &self.configuration.executors;
        executors.default == *name || executors.of_place.values().any(|other| other == name)
    }

    fn time_action_of(&mut self, executor: &Symbol) {
        let execution = self.running.as_ref().and_then(Running::execution);
        if execution.is_some_and(|execution| execution.executor == *executor) {
            self.time_action();
        }
    }

    /// Measures the running action's time from now on, and not at all while its executor is gone: how
    /// much of the time was spent on the action before one of the two was away, nobody knows, and an
    /// action has not failed because somebody was away. A deadline of the goal goes on.
    pub(super) fn time_action(&mut self) {
        let Some(Running {
            phase: Phase::Executing(execution),
            ..
        }) = &self.running
        else {
            return;
        };
        let due = self.due(&execution.executor, &execution.step);
        if let Some(Running {
            phase: Phase::Executing(execution),
            ..
        }) = &mut self.running
        {
            execution.due = due;
        }
    }

    /// Somebody has lost its memory.
    pub(super) fn reborn(&mut self, name: &Symbol) {
        let reason = format!("{name} has lost its memory");
        self.drop_goals_of(name, &reason);
        self.lose_records_of(name, &reason);
        let execution = self.running.as_ref().and_then(Running::execution);
        let under_way = execution.filter(|it| it.executor == *name && it.done.is_none());
        if let Some(execution) = under_way.cloned() {
            self.uncertain(execution, &reason, &[]);
        }
    }

    /// A superior will neither resume nor clear what it has instructed.
    fn drop_goals_of(&mut self, superior: &Symbol, reason: &str) {
        if self.hold.as_ref().is_some_and(|(who, _)| who == superior) {
            self.hold = None;
        }
        if let Some(running) = &mut self.running
            && let Some((who, _)) = &running.intention.goal.superior
            && who == superior
        {
            // `settle` stops its action first.
            running.intention.cancelled = Some(reason.to_owned());
            running.intention.orphaned = true;
        }
        let others = self.stack.entries().iter().map(|entry| &entry.intention);
        let others = others.chain(self.waiting.intentions());
        let theirs: Vec<GoalId> = others
            .filter(|i| {
                i.goal
                    .superior
                    .as_ref()
                    .is_some_and(|(who, _)| who == superior)
            })
            .map(|i| i.goal.id.clone())
            .collect();
        for goal in theirs {
            let found = self.take_from_stack(&goal);
            if let Some(intention) = found.or_else(|| self.waiting.remove(&goal)) {
                self.drop_goal(&intention, reason);
            }
        }
    }

    /// What an executor kept is gone. What it was to take up is begun anew.
    fn lose_records_of(&mut self, executor: &Symbol, reason: &str) {
        let mut revised = Vec::new();
        let lose = |intention: &mut super::Intention| {
            let kept = intention.records.iter();
            let lost: Vec<ActionId> = kept
                .filter(|record| record.executor == *executor)
                .map(|record| record.id.clone())
                .collect();
            for id in &lost {
                intention.lose(id);
            }
            if !lost.is_empty() {
                revised.push((intention.goal.id.clone(), intention.plans.len()));
            }
        };
        self.running
            .iter_mut()
            .map(|running| &mut running.intention)
            .chain(self.stack.intentions_mut())
            .chain(self.aside.intentions_mut())
            .chain(self.waiting.intentions_mut())
            .for_each(lose);
        for (goal, kept) in revised {
            let why = format!("{reason}, and with it where it had stopped");
            self.emit(Some(&goal), Happening::PlanRevised { why, kept });
        }
        for entry in self.stack.entries() {
            let intention = &entry.intention;
            self.planner.keep(&intention.goal.id, &intention.agendas);
        }
        // What was begun to be planned may be about what is gone.
        if let Some(running) = &mut self.running
            && let Phase::Planning | Phase::Ready(_) = running.phase
        {
            running.phase = Phase::Planning;
            self.planner.stop();
        }
    }
}
