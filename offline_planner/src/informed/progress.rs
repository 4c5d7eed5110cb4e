//! Going on through a problem as long as there is no choice.

use super::store::{EMPTY, Stacks};
use crate::ground::Model;
use crate::ground::model::{NONE, Task};

/// Where a search is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// Tasks left.
    pub stack: u32,
    /// The last method used, in [`Trace`].
    pub trace: u32,
    /// What the actions have cost.
    pub cost: u64,
    /// How many actions were executed.
    pub length: u32,
}

/// The methods used on the way to each place, each with the one before it.
#[derive(Default)]
pub(super) struct Trace {
    steps: Vec<(u32, u32)>,
}

impl Trace {
    /// One more method.
    pub fn push(&mut self, before: u32, method: u32) -> u32 {
        self.steps.push((before, method));
        self.steps.len() as u32 - 1
    }

    /// All methods up to there, the first first.
    pub fn methods(&self, mut last: u32) -> Vec<u32> {
        let mut all = Vec::new();
        while let Some((before, method)) = self.steps.get(last as usize) {
            all.push(*method);
            last = *before;
        }
        all.reverse();
        all
    }

    /// About how much memory this takes.
    pub fn bytes(&self) -> usize {
        self.steps.len() * 8
    }
}

/// How going on ended.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Ended {
    /// Nothing is left to be done.
    Done,
    /// The first task cannot be done.
    Dead,
    /// There are several methods for the first task (or this went on for very long).
    Choice,
}

/// At most this many methods are used without a look at whether the search has been here before.
const FORCED: usize = 256;

/// Walks through the problem, one place at a time.
pub(super) struct Walker<'m> {
    model: &'m Model,
    /// All stacks met.
    pub stacks: Stacks,
    /// All methods used.
    pub trace: Trace,
    /// Where it is.
    pub place: Place,
    /// What holds there.
    pub state: Vec<u64>,
    /// The methods to choose from there.
    pub methods: Vec<u32>,
    /// Actions executed since this was last emptied.
    pub executed: Vec<u32>,
    spare: Vec<u64>,
}

impl<'m> Walker<'m> {
    /// At the beginning.
    pub fn new(model: &'m Model) -> Self {
        let mut stacks = Stacks::new();
        let stack = stacks.push(model.top, EMPTY);
        Self {
            model,
            stacks,
            trace: Trace::default(),
            place: Place {
                stack,
                trace: NONE,
                cost: 0,
                length: 0,
            },
            state: model.init.clone(),
            methods: Vec::new(),
            executed: Vec::new(),
            spare: vec![0; model.init.len()],
        }
    }

    /// Goes elsewhere.
    pub fn jump(&mut self, place: Place, state: &[u64]) {
        self.place = place;
        self.state.copy_from_slice(state);
    }

    /// Executes actions and uses methods that are the only ones, until there is a choice.
    pub fn go_on(&mut self) -> Ended {
        for _ in 0..FORCED {
            loop {
                let Some((task, below)) = self.stacks.pop(self.place.stack) else {
                    return Ended::Done;
                };
                let Task::Action(number) = self.model.tasks[task as usize] else {
                    self.list_methods(task);
                    break;
                };
                if !self.execute(number) {
                    return Ended::Dead;
                }
                self.place.stack = below;
            }
            match self.methods[..] {
                [] => return Ended::Dead,
                [method] => self.use_method(method),
                _ => return Ended::Choice,
            }
        }
        Ended::Choice
    }

    fn list_methods(&mut self, task: u32) {
        let (model, state) = (self.model, &self.state);
        self.methods.clear();
        self.methods.extend(
            model
                .methods_of(task)
                .filter(|method| {
                    let method = &model.methods[*method];
                    model.possible(state, method.pre, method.check)
                })
                .map(|method| method as u32),
        );
    }

    fn execute(&mut self, number: u32) -> bool {
        let action = &self.model.actions[number as usize];
        if !self.model.possible(&self.state, action.pre, action.check) {
            return false;
        }
        self.model.apply(action, &self.state, &mut self.spare);
        std::mem::swap(&mut self.state, &mut self.spare);
        self.place.cost = self.place.cost.saturating_add(action.cost);
        self.place.length += u32::from(action.origin != NONE);
        self.executed.push(number);
        true
    }

    /// Puts the subtasks of `method` in the place of the first task.
    pub fn use_method(&mut self, method: u32) {
        let Some((_, mut stack)) = self.stacks.pop(self.place.stack) else {
            return;
        };
        let subs = self.model.methods[method as usize].subs;
        for sub in self.model.get(subs).iter().rev() {
            stack = self.stacks.push(*sub, stack);
        }
        self.place.stack = stack;
        self.place.trace = self.trace.push(self.place.trace, method);
    }

    /// About how much memory this takes.
    pub fn bytes(&self) -> usize {
        self.stacks.bytes() + self.trace.bytes()
    }
}
