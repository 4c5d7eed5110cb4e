//! Greedy best-first search over states and task stacks.
//!
//! A place is evaluated when it is left, once for all its ways on: the costs of the relaxed
//! problem tell them apart. From there the relaxed plan is followed as far as it goes, without
//! evaluating anything between (an idea of Vidal's, *A Lookahead Strategy for Heuristic Search
//! Planning*, 2004).
//!
//! Mostly the search goes on from where it is and turns back only where it must: tasks are done one
//! after another, and places differ more by what was done incidentally than by how far they are.
//! Now and then it takes the best of all places instead, so that it does not stay for ever where
//! an early choice was wrong.

use std::collections::BTreeMap;
use std::sync::atomic::Ordering;

use rustc_hash::FxHashSet;

use super::progress::{Ended, Place, Walker};
use super::store::States;
use crate::control::{Control, Halt};
use crate::ground::Model;
use crate::heuristic::additive::{Additive, NEVER};
use crate::heuristic::closure::Closures;
use crate::heuristic::conflict::Conflicts;
use crate::heuristic::relaxed::Relaxed;

/// One turn in so many takes the best of all places.
const DEEP_TURNS: u64 = 4;
/// At most so many choices are made by one relaxed plan.
const LONGEST_WAY: usize = 100_000;

/// How a search over the ground problem ended.
pub(crate) enum Found {
    /// With these methods, in order.
    Plan(Vec<u32>),
    /// With nothing left to be searched.
    Nothing,
    /// Early.
    Stopped(Halt),
}

/// Somewhere to go: from a place by a method.
#[derive(Clone, Copy)]
struct Successor {
    place: Place,
    state: u32,
    method: u32,
}

/// The search so far.
struct Greedy<'m> {
    model: &'m Model,
    walker: Walker<'m>,
    additive: Additive<'m>,
    closures: Closures<'m>,
    conflicts: Conflicts<'m>,
    only_now: Vec<u32>,
    states: States,
    seen: FxHashSet<(u32, u32)>,
    open: BTreeMap<u32, Vec<Successor>>,
    waiting: usize,
    /// The same ways on once more: the last found are the last here, the best of them behind.
    deep: Vec<Successor>,
    turn: u64,
    tasks: Vec<u32>,
    expanded: u64,
}

/// Searches.
pub(crate) fn greedy(model: &Model, control: &Control<'_>) -> Found {
    let relaxed = Relaxed::new(model);
    let mut search = Greedy {
        model,
        walker: Walker::new(model),
        additive: Additive::new(model, &relaxed, 1, 1),
        closures: Closures::new(model),
        conflicts: Conflicts::new(model),
        only_now: Vec::new(),
        states: States::new(model.init.len()),
        seen: FxHashSet::default(),
        open: BTreeMap::new(),
        waiting: 0,
        deep: Vec::new(),
        turn: 0,
        tasks: Vec::new(),
        expanded: 0,
    };
    loop {
        if let Some(methods) = search.follow(control) {
            return Found::Plan(methods);
        }
        if let Err(halt) = search.check(control) {
            return Found::Stopped(halt);
        }
        if !search.next() {
            return Found::Nothing;
        }
    }
}

impl Greedy<'_> {
    /// Goes on from where the walker is, evaluates, and follows the relaxed plans until they lead
    /// no further. The methods of the plan, if it gets to the end.
    fn follow(&mut self, control: &Control<'_>) -> Option<Vec<u32>> {
        loop {
            match self.walker.go_on() {
                Ended::Done => return Some(self.walker.trace.methods(self.walker.place.trace)),
                Ended::Dead => return None,
                Ended::Choice => {}
            }
            if !self.expand(control) {
                return None;
            }
            let mut ahead = 0;
            while let Some(method) = self.best_ahead() {
                self.walker.executed.clear();
                self.walker.use_method(method);
                let ended = self.walker.go_on();
                for action in &self.walker.executed {
                    self.additive.executed(*action);
                }
                match ended {
                    Ended::Done => return Some(self.walker.trace.methods(self.walker.place.trace)),
                    Ended::Dead => return None,
                    Ended::Choice => {}
                }
                ahead += 1;
                if ahead > LONGEST_WAY {
                    break;
                }
            }
            if ahead == 0 || self.check(control).is_err() {
                return None;
            }
        }
    }

    /// Evaluates the place and notes its ways on; `false` if it leads nowhere or was met before.
    fn expand(&mut self, control: &Control<'_>) -> bool {
        let place = self.walker.place;
        let number = self.states.insert(&self.walker.state);
        if !self.seen.insert((number, place.stack)) {
            return false;
        }
        self.expanded += 1;
        control.expanded.fetch_add(1, Ordering::Relaxed);
        self.tasks.clear();
        self.tasks.extend(self.walker.stacks.tasks(place.stack));
        if self.conflicts.hopeless(&self.tasks) {
            return false;
        }
        let Some(whole) = self.additive.evaluate(&self.walker.state, &self.tasks) else {
            return false;
        };
        let costs: Vec<u32> = self
            .walker
            .methods
            .iter()
            .map(|method| self.additive.method_cost(*method))
            .collect();
        let mut fresh: Vec<(u32, Successor)> = Vec::new();
        let methods = std::mem::take(&mut self.walker.methods);
        self.additive.only_now(&self.tasks[1..], &mut self.only_now);
        let least = costs.iter().min().copied().unwrap_or(NEVER);
        for (method, cost) in methods.iter().zip(costs).rev() {
            if cost != NEVER {
                let helps = self.additive.helps(self.model, *method);
                let lost = self.lost(*method);
                let key = whole
                    .saturating_add(cost - least)
                    .saturating_add(lost)
                    .saturating_add(u32::from(!helps));
                let successor = Successor {
                    place,
                    state: number,
                    method: *method,
                };
                fresh.push((key, successor));
                self.open.entry(key).or_default().push(successor);
                self.waiting += 1;
            }
        }
        self.walker.methods = methods;
        // The best last, so that it is the next to be taken.
        fresh.sort_by_key(|(key, _)| std::cmp::Reverse(*key));
        self.deep
            .extend(fresh.into_iter().map(|(_, successor)| successor));
        true
    }

    /// The way on that the relaxed plan takes.
    fn best_ahead(&mut self) -> Option<u32> {
        let mut best = None;
        for place in 0..self.walker.methods.len() {
            let method = self.walker.methods[place];
            let cost = self.additive.method_cost(method);
            if cost != NEVER {
                let helps = self.additive.helps(self.model, method);
                let key = (self.lost(method), !helps, cost, method);
                if best.is_none_or(|best| key < best) {
                    best = Some(key);
                }
            }
        }
        let (_, idle, _, method) = best?;
        (!idle).then_some(method)
    }

    /// How much of what only the first task can do is out of reach once this method is used.
    fn lost(&mut self, method: u32) -> u32 {
        let subs = self.model.get(self.model.methods[method as usize].subs);
        let closures = &mut self.closures;
        let lost = self
            .only_now
            .iter()
            .filter(|action| !subs.iter().any(|sub| closures.has(*sub, **action)));
        lost.count() as u32
    }

    fn check(&self, control: &Control<'_>) -> Result<(), Halt> {
        if control.is_over() {
            return Err(Halt::Told);
        }
        let bytes = self.states.bytes()
            + self.walker.bytes()
            + self.seen.capacity() * 9
            + self.waiting * 2 * size_of::<Successor>();
        if bytes as u64 > control.memory_limit_bytes {
            return Err(Halt::Memory);
        }
        Ok(())
    }

    /// Takes the most promising way on, of all or mostly of those last found; `false` if there is
    /// none.
    fn next(&mut self) -> bool {
        self.turn += 1;
        if !self.turn.is_multiple_of(DEEP_TURNS) {
            let Some(next) = self.deep.pop() else {
                return false;
            };
            self.walker.jump(next.place, self.states.get(next.state));
            self.walker.use_method(next.method);
            return true;
        }
        let Some(mut entry) = self.open.first_entry() else {
            return false;
        };
        let next = entry.get_mut().pop();
        if entry.get().is_empty() {
            entry.remove();
        }
        let Some(next) = next else {
            return false;
        };
        self.waiting -= 1;
        self.walker.jump(next.place, self.states.get(next.state));
        self.walker.use_method(next.method);
        true
    }
}
