//! Additive costs of the relaxed problem, and the relaxed plan that they suggest.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::relaxed::{Lists, Proposition, Relaxed};
use crate::ground::model::NONE;

/// What cannot be reached.
pub(crate) const NEVER: u32 = u32::MAX;
/// Sums beyond this are all the same.
const MUCH: u32 = 1 << 30;

/// Reckons costs; keeps its lists from one state to the next.
pub(crate) struct Additive<'r> {
    relaxed: &'r Relaxed,
    /// How many propositions each operator needs.
    needs: Vec<u32>,
    /// What each operator counts.
    weight: Vec<u32>,
    /// Tasks below each task: of a method, its subtasks.
    allowed: Vec<bool>,
    stack: Vec<u32>,
    missing: Vec<u32>,
    /// By operator: what it and all that it needs cost.
    pub operator_cost: Vec<u32>,
    /// By proposition.
    pub cost: Vec<u32>,
    supporter: Vec<u32>,
    heap: BinaryHeap<(Reverse<u32>, Proposition)>,
    marked: Vec<bool>,
    trail: Vec<u32>,
}

/// What a state and the tasks left are worth.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) struct Estimate {
    /// Weights in the relaxed plan.
    pub plan: u32,
    /// The sum of what the tasks left cost.
    pub sum: u32,
}

impl<'r> Additive<'r> {
    /// With a weight for actions and one for methods.
    pub fn new(relaxed: &'r Relaxed, action: u32, method: u32) -> Self {
        let operators = relaxed.cost.len();
        Self {
            relaxed,
            needs: (0..operators)
                .map(|operator| relaxed.pre.get(operator).len() as u32)
                .collect(),
            weight: (0..operators)
                .map(|operator| match relaxed.action_of(operator) {
                    Some(own) if own == operator => action,
                    Some(_) => 0,
                    None => method,
                })
                .collect(),
            allowed: vec![false; relaxed.propositions],
            stack: Vec::new(),
            missing: Vec::new(),
            operator_cost: Vec::new(),
            cost: Vec::new(),
            supporter: Vec::new(),
            heap: BinaryHeap::new(),
            marked: vec![false; operators],
            trail: Vec::new(),
        }
    }

    /// Reckons for `state` and the tasks left. `None` if they cannot all be done.
    ///
    /// `below` has the tasks into which each task can be decomposed: only what is below the tasks
    /// left takes part.
    pub fn evaluate(&mut self, state: &[u64], tasks: &[u32], below: &Lists) -> Option<Estimate> {
        let relaxed = self.relaxed;
        self.allow(tasks, below);
        self.missing.clone_from(&self.needs);
        self.operator_cost.clone_from(&self.weight);
        self.cost.clear();
        self.cost.resize(relaxed.propositions, NEVER);
        self.supporter.clear();
        self.supporter.resize(relaxed.propositions, NONE);
        self.heap.clear();
        for operator in 0..self.needs.len() {
            if self.needs[operator] == 0 && self.is_allowed(operator) {
                self.fire(operator);
            }
        }
        let mut literals = std::mem::take(&mut self.stack);
        literals.clear();
        relaxed.literals(state, |literal| literals.push(literal));
        for literal in &literals {
            self.cost[*literal as usize] = 0;
            self.settle(*literal, 0);
        }
        self.stack = literals;
        while let Some((Reverse(cost), proposition)) = self.heap.pop() {
            if self.cost[proposition as usize] == cost {
                self.settle(proposition, cost);
            }
        }
        let mut sum = 0_u32;
        for task in tasks {
            let cost = self.cost[(relaxed.first_task + task) as usize];
            if cost == NEVER {
                return None;
            }
            sum = sum.saturating_add(cost).min(MUCH);
        }
        Some(Estimate {
            plan: self.relaxed_plan(tasks),
            sum,
        })
    }

    fn allow(&mut self, tasks: &[u32], below: &Lists) {
        self.allowed.fill(false);
        let first = self.relaxed.first_task;
        let mut open = std::mem::take(&mut self.stack);
        open.clear();
        for task in tasks {
            if !std::mem::replace(&mut self.allowed[(first + task) as usize], true) {
                open.push(*task);
            }
        }
        while let Some(task) = open.pop() {
            for sub in below.get(task as usize) {
                if !std::mem::replace(&mut self.allowed[(first + sub) as usize], true) {
                    open.push(*sub);
                }
            }
        }
        self.stack = open;
    }

    /// Whether the task that the operator is or serves may come up.
    fn is_allowed(&self, operator: usize) -> bool {
        let serves = self.relaxed.serves[operator];
        serves == NONE || self.allowed[serves as usize]
    }

    fn settle(&mut self, proposition: Proposition, cost: u32) {
        let relaxed = self.relaxed;
        for operator in relaxed.needed_by.get(proposition as usize) {
            let operator = *operator as usize;
            self.operator_cost[operator] =
                self.operator_cost[operator].saturating_add(cost).min(MUCH);
            self.missing[operator] -= 1;
            if self.missing[operator] == 0 && self.is_allowed(operator) {
                self.fire(operator);
            }
        }
    }

    fn fire(&mut self, operator: usize) {
        let relaxed = self.relaxed;
        let cost = self.operator_cost[operator];
        for effect in relaxed.add.get(operator) {
            if cost < self.cost[*effect as usize] {
                self.cost[*effect as usize] = cost;
                self.supporter[*effect as usize] = operator as u32;
                self.heap.push((Reverse(cost), *effect));
            }
        }
    }

    fn relaxed_plan(&mut self, tasks: &[u32]) -> u32 {
        let relaxed = self.relaxed;
        let mut open = std::mem::take(&mut self.stack);
        open.clear();
        open.extend(tasks.iter().map(|task| relaxed.first_task + task));
        let mut plan = 0;
        while let Some(proposition) = open.pop() {
            let operator = self.supporter[proposition as usize];
            if operator == NONE || std::mem::replace(&mut self.marked[operator as usize], true) {
                continue;
            }
            self.trail.push(operator);
            plan += self.weight[operator as usize];
            open.extend_from_slice(relaxed.pre.get(operator as usize));
        }
        for operator in self.trail.drain(..) {
            self.marked[operator as usize] = false;
        }
        self.stack = open;
        plan
    }

    /// What doing a task by this method costs; [`NEVER`] if it cannot be.
    pub fn method_cost(&self, method: usize) -> u32 {
        let operator = self.relaxed.first_method + method;
        if self.missing[operator] == 0 {
            self.operator_cost[operator]
        } else {
            NEVER
        }
    }
}
