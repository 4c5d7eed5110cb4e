//! Additive costs of the relaxed problem, and the relaxed plan that they suggest.

use super::queue::Queue;
use super::relaxed::{Lists, Proposition, Relaxed};
use crate::ground::Model;
use crate::ground::model::{NONE, Task};

/// What cannot be reached.
pub(crate) const NEVER: u32 = u32::MAX;
/// Sums beyond this are all the same.
const MUCH: u32 = 1 << 30;

/// Reckons costs; keeps its lists from one state to the next.
///
/// The tasks left are gone through in their order. What is below a task takes part only from its
/// turn on, and it must be possible by then: so a state is seen to be hopeless in which the next
/// action's precondition is gone and only tasks behind it could restore it.
pub(crate) struct Additive<'r> {
    relaxed: &'r Relaxed,
    /// By task, what its methods decompose it into.
    below: Lists,
    /// By task, its operators.
    operators: Lists,
    /// How many propositions each operator needs.
    needs: Vec<u32>,
    /// What each operator counts.
    weight: Vec<u32>,
    allowed: Vec<bool>,
    later: Vec<bool>,
    open: Vec<u32>,
    missing: Vec<u32>,
    /// By operator: what it and all that it needs cost.
    operator_cost: Vec<u32>,
    /// By proposition.
    cost: Vec<u32>,
    /// By proposition: no longer to be improved.
    fixed: Vec<bool>,
    reached: Vec<Proposition>,
    supporter: Vec<u32>,
    queue: Queue,
    in_plan: Vec<bool>,
    plan: Vec<u32>,
}

impl<'r> Additive<'r> {
    /// With a weight for actions and one for methods.
    pub fn new(model: &Model, relaxed: &'r Relaxed, action: u32, method: u32) -> Self {
        let count = relaxed.cost.len();
        let mut serves = Lists::default();
        for task in &relaxed.serves {
            serves.push((*task != NONE).then(|| task - relaxed.first_task));
        }
        Self {
            relaxed,
            below: below(model),
            operators: Lists::inverse(model.tasks.len(), &serves),
            needs: (0..count)
                .map(|operator| relaxed.pre.get(operator).len() as u32)
                .collect(),
            weight: (0..count)
                .map(|operator| match relaxed.action_of(operator) {
                    Some(own) if own == operator => action,
                    Some(_) => 0,
                    None => method,
                })
                .collect(),
            allowed: Vec::new(),
            later: Vec::new(),
            open: Vec::new(),
            missing: Vec::new(),
            operator_cost: Vec::new(),
            cost: Vec::new(),
            fixed: Vec::new(),
            reached: Vec::new(),
            supporter: vec![NONE; relaxed.propositions],
            queue: Queue::new(),
            in_plan: vec![false; count],
            plan: Vec::new(),
        }
    }

    /// Reckons for `state` and the tasks left: how much there is in the relaxed plan. `None` if
    /// the tasks cannot all be done.
    pub fn evaluate(&mut self, state: &[u64], tasks: &[u32]) -> Option<u32> {
        let relaxed = self.relaxed;
        self.missing.clone_from(&self.needs);
        self.operator_cost.clone_from(&self.weight);
        self.cost.clear();
        self.cost.resize(relaxed.propositions, NEVER);
        self.fixed.clear();
        self.fixed.resize(relaxed.propositions, false);
        self.allowed.clear();
        self.allowed.resize(self.below.len(), false);
        self.queue.clear();
        self.reached.clear();
        let mut literals = std::mem::take(&mut self.open);
        literals.clear();
        relaxed.literals(state, |literal| literals.push(literal));
        for literal in &literals {
            self.cost[*literal as usize] = 0;
            self.fixed[*literal as usize] = true;
            self.supporter[*literal as usize] = NONE;
            self.settle(*literal, 0);
        }
        self.open = literals;
        for task in tasks {
            self.allow(*task);
            while let Some((cost, proposition)) = self.queue.pop() {
                if self.cost[proposition as usize] == cost && !self.fixed[proposition as usize] {
                    self.fixed[proposition as usize] = true;
                    self.settle(proposition, cost);
                }
            }
            if self.cost[(relaxed.first_task + task) as usize] == NEVER {
                return None;
            }
        }
        Some(self.relaxed_plan(tasks))
    }

    /// Lets everything below `task` take part.
    fn allow(&mut self, task: u32) {
        if std::mem::replace(&mut self.allowed[task as usize], true) {
            return;
        }
        let mut open = std::mem::take(&mut self.open);
        open.clear();
        open.push(task);
        while let Some(task) = open.pop() {
            for place in 0..self.operators.get(task as usize).len() {
                let operator = self.operators.get(task as usize)[place] as usize;
                if self.missing[operator] == 0 {
                    self.fire(operator);
                }
            }
            for sub in self.below.get(task as usize) {
                if !std::mem::replace(&mut self.allowed[*sub as usize], true) {
                    open.push(*sub);
                }
            }
        }
        self.open = open;
    }

    fn is_allowed(&self, operator: usize) -> bool {
        let serves = self.relaxed.serves[operator];
        serves == NONE || self.allowed[(serves - self.relaxed.first_task) as usize]
    }

    fn settle(&mut self, proposition: Proposition, cost: u32) {
        let relaxed = self.relaxed;
        for operator in relaxed.needed_by.get(proposition as usize) {
            let operator = *operator as usize;
            self.operator_cost[operator] = (self.operator_cost[operator] + cost).min(MUCH);
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
            let place = *effect as usize;
            if cost < self.cost[place] && !self.fixed[place] {
                self.cost[place] = cost;
                self.supporter[place] = operator as u32;
                self.queue.push(cost, *effect);
            }
        }
    }

    fn relaxed_plan(&mut self, tasks: &[u32]) -> u32 {
        let relaxed = self.relaxed;
        for operator in self.plan.drain(..) {
            self.in_plan[operator as usize] = false;
        }
        let mut open = std::mem::take(&mut self.open);
        open.clear();
        open.extend(tasks.iter().map(|task| relaxed.first_task + task));
        let mut plan = 0;
        while let Some(proposition) = open.pop() {
            let operator = self.supporter[proposition as usize];
            if operator == NONE || std::mem::replace(&mut self.in_plan[operator as usize], true) {
                continue;
            }
            self.plan.push(operator);
            plan += self.weight[operator as usize];
            open.extend_from_slice(relaxed.pre.get(operator as usize));
        }
        self.open = open;
        plan
    }

    /// What doing a task by this method costs; [`NEVER`] if it cannot be.
    pub fn method_cost(&self, method: u32) -> u32 {
        let operator = self.relaxed.first_method + method as usize;
        if self.missing[operator] == 0 {
            self.operator_cost[operator]
        } else {
            NEVER
        }
    }

    /// Whether the relaxed plan has the method, or an action that is one of its subtasks.
    pub fn helps(&self, model: &Model, method: u32) -> bool {
        self.in_plan[self.relaxed.first_method + method as usize]
            || model
                .get(model.methods[method as usize].subs)
                .iter()
                .any(|sub| match model.tasks[*sub as usize] {
                    Task::Action(action) => self.in_plan[action as usize],
                    Task::Methods(..) => false,
                })
    }

    /// Those actions of the relaxed plan that cannot come up below `rest`, the tasks behind the
    /// first: whoever decomposes the first task must not lose them.
    pub fn only_now(&mut self, rest: &[u32], into: &mut Vec<u32>) {
        into.clear();
        let mut open = std::mem::take(&mut self.open);
        open.clear();
        self.later.clear();
        self.later.resize(self.below.len(), false);
        for task in rest {
            if !std::mem::replace(&mut self.later[*task as usize], true) {
                open.push(*task);
            }
        }
        while let Some(task) = open.pop() {
            for sub in self.below.get(task as usize) {
                if !std::mem::replace(&mut self.later[*sub as usize], true) {
                    open.push(*sub);
                }
            }
        }
        self.open = open;
        let relaxed = self.relaxed;
        for operator in &self.plan {
            let serves = relaxed.serves[*operator as usize];
            let action = (*operator as usize) < relaxed.first_method && serves != NONE;
            if action && !self.later[(serves - relaxed.first_task) as usize] {
                into.push(*operator);
            }
        }
    }

    /// Takes an action out of the relaxed plan, as it was executed.
    pub fn executed(&mut self, action: u32) {
        self.in_plan[action as usize] = false;
    }
}

/// Tasks below each task.
fn below(model: &Model) -> Lists {
    let mut lists = Lists::default();
    for task in 0..model.tasks.len() {
        let mut subs: Vec<u32> = model
            .methods_of(task as u32)
            .flat_map(|method| model.get(model.methods[method].subs))
            .copied()
            .collect();
        subs.sort_unstable();
        subs.dedup();
        lists.push(subs);
    }
    lists
}
