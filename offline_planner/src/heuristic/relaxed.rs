//! The relaxed problem: what was once true stays true, and tasks are facts.
//!
//! A task is reached by its action, or by a method whose subtasks are all reached. So the
//! hierarchy becomes part of an ordinary relaxed problem in which the tasks that are left are the
//! goal (the composition of Höller, Bercher, Behnke and Biundo, *HTN Planning as Heuristic
//! Progression Search*, 2020).

use crate::ground::model::{Check, Literal, Model, NONE, Span, Task};

/// A literal or a task.
pub(crate) type Proposition = u32;

/// Lists of numbers, one for each number.
#[derive(Debug, Default)]
pub(crate) struct Lists {
    start: Vec<u32>,
    all: Vec<u32>,
}

impl Lists {
    /// Turns lists around: for each `number < count`, the places of the lists that have it.
    pub fn inverse(count: usize, lists: &Lists) -> Self {
        let mut start = vec![0_u32; count + 1];
        for number in &lists.all {
            start[*number as usize + 1] += 1;
        }
        for place in 0..count {
            start[place + 1] += start[place];
        }
        let mut next = start.clone();
        let mut all = vec![0; lists.all.len()];
        for place in 0..lists.len() {
            for number in lists.get(place) {
                let slot = &mut next[*number as usize];
                all[*slot as usize] = place as u32;
                *slot += 1;
            }
        }
        Self { start, all }
    }

    /// Appends a list.
    pub fn push(&mut self, numbers: impl IntoIterator<Item = u32>) {
        if self.start.is_empty() {
            self.start.push(0);
        }
        self.all.extend(numbers);
        self.start.push(self.all.len() as u32);
    }

    /// How many lists there are.
    pub fn len(&self) -> usize {
        self.start.len().saturating_sub(1)
    }

    /// The list at that place.
    pub fn get(&self, place: usize) -> &[u32] {
        &self.all[self.start[place] as usize..self.start[place + 1] as usize]
    }
}

/// The relaxed problem's operators: actions, their effects under conditions, and methods.
#[derive(Debug)]
pub(crate) struct Relaxed {
    /// Literals come first, then tasks.
    pub first_task: u32,
    /// How many propositions there are.
    pub propositions: usize,
    /// What each operator needs, each once.
    pub pre: Lists,
    /// What it brings about.
    pub add: Lists,
    /// By proposition, the operators that need it.
    pub needed_by: Lists,
    /// What each operator counts: actions their cost, the others nothing.
    pub cost: Vec<u64>,
    /// The task, as a proposition, that each operator serves; none for actions of no task.
    pub serves: Vec<Proposition>,
    /// Operators from here on are methods.
    pub first_method: usize,
    /// Operators from here on are effects under conditions; each with its action.
    first_conditional: usize,
    conditional_of: Vec<u32>,
}

impl Relaxed {
    /// Of a ground problem.
    pub fn new(model: &Model) -> Self {
        let first_task = 2 * model.facts as u32;
        let mut task_of = vec![NONE; model.actions.len()];
        for (task, what) in model.tasks.iter().enumerate() {
            if let Task::Action(action) = what {
                task_of[*action as usize] = first_task + task as u32;
            }
        }
        let (mut pre, mut add, mut cost) = (Lists::default(), Lists::default(), Vec::new());
        let mut serves = Vec::new();
        let never = first_task + model.tasks.len() as u32;
        let condition = |span: Span, check: u32| {
            let mut all: Vec<u32> = model.get(span).to_vec();
            if check != NONE {
                needed(&model.checks[check as usize], never, &mut all);
            }
            all
        };
        let set = |mut all: Vec<u32>| {
            all.sort_unstable();
            all.dedup();
            all
        };
        for (index, action) in model.actions.iter().enumerate() {
            pre.push(set(condition(action.pre, action.check)));
            let mut effects: Vec<u32> = model.get(action.add).iter().map(|f| f * 2).collect();
            effects.extend(model.get(action.del).iter().map(|f| f * 2 + 1));
            if task_of[index] != NONE {
                effects.push(task_of[index]);
            }
            add.push(effects);
            cost.push(action.cost);
            serves.push(task_of[index]);
        }
        let first_method = cost.len();
        for method in &model.methods {
            let mut all = condition(method.pre, method.check);
            all.extend(model.get(method.subs).iter().map(|sub| first_task + sub));
            pre.push(set(all));
            add.push([first_task + method.task]);
            cost.push(0);
            serves.push(first_task + method.task);
        }
        let first_conditional = cost.len();
        let mut conditional_of = Vec::new();
        for (index, action) in model.actions.iter().enumerate() {
            for effect in model.conditionals_of(action) {
                let mut all = condition(effect.when, effect.check);
                if task_of[index] == NONE {
                    all.extend(condition(action.pre, action.check));
                } else {
                    all.push(task_of[index]);
                }
                pre.push(set(all));
                add.push([effect.fact * 2 + u32::from(!effect.add)]);
                cost.push(0);
                conditional_of.push(index as u32);
                serves.push(task_of[index]);
            }
        }
        let propositions = never as usize + 1;
        let needed_by = Lists::inverse(propositions, &pre);
        Self {
            first_task,
            propositions,
            pre,
            add,
            needed_by,
            cost,
            serves,
            first_method,
            first_conditional,
            conditional_of,
        }
    }

    /// The action or, if it is a method, nothing.
    pub fn action_of(&self, operator: usize) -> Option<usize> {
        if operator < self.first_method {
            Some(operator)
        } else {
            let place = operator.checked_sub(self.first_conditional)?;
            Some(self.conditional_of[place] as usize)
        }
    }

    /// Calls `found` with every literal that holds in `state`.
    pub fn literals(&self, state: &[u64], mut found: impl FnMut(Literal)) {
        for fact in 0..self.first_task / 2 {
            found(fact * 2 + u32::from(!crate::ground::model::has(state, fact)));
        }
    }

    /// Everything that can be reached from `state`, whichever tasks are left.
    pub fn explore(&self, state: &[u64]) -> Exploration {
        let mut reached = vec![false; self.propositions];
        let mut missing: Vec<u32> = (0..self.cost.len())
            .map(|operator| self.pre.get(operator).len() as u32)
            .collect();
        let mut open: Vec<Proposition> = Vec::new();
        self.literals(state, |literal| {
            reached[literal as usize] = true;
            open.push(literal);
        });
        let fire = |operator: usize, reached: &mut Vec<bool>, open: &mut Vec<u32>| {
            for effect in self.add.get(operator) {
                if !std::mem::replace(&mut reached[*effect as usize], true) {
                    open.push(*effect);
                }
            }
        };
        for operator in (0..self.cost.len()).filter(|operator| missing[*operator] == 0) {
            fire(operator, &mut reached, &mut open);
        }
        while let Some(proposition) = open.pop() {
            for operator in self.needed_by.get(proposition as usize) {
                let missing = &mut missing[*operator as usize];
                *missing -= 1;
                if *missing == 0 {
                    fire(*operator as usize, &mut reached, &mut open);
                }
            }
        }
        Exploration { reached, missing }
    }
}

/// Literals that a check cannot do without; `never` if it never holds.
fn needed(check: &Check, never: Proposition, into: &mut Vec<Literal>) {
    match check {
        Check::Literal(literal) => into.push(*literal),
        Check::All(parts) => {
            for part in parts {
                needed(part, never, into);
            }
        }
        Check::Any(_) => {}
        Check::Never => into.push(never),
    }
}

/// What can be reached.
pub(crate) struct Exploration {
    reached: Vec<bool>,
    missing: Vec<u32>,
}

impl Exploration {
    /// Whether the literal can come to hold.
    pub fn literal(&self, literal: Literal) -> bool {
        self.reached[literal as usize]
    }

    /// Whether the task can be done.
    pub fn task(&self, relaxed: &Relaxed, task: u32) -> bool {
        self.reached[(relaxed.first_task + task) as usize]
    }

    /// Whether the method can be used.
    pub fn method(&self, relaxed: &Relaxed, method: usize) -> bool {
        self.missing[relaxed.first_method + method] == 0
    }
}
