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
    /// What the actions have cost, and how many they are.
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

/// Executes actions and uses methods that are the only ones, until there is a choice.
///
/// `state` is changed in place; `methods` is filled with those to choose from.
pub(super) fn go_on(
    model: &Model,
    stacks: &mut Stacks,
    trace: &mut Trace,
    place: &mut Place,
    state: &mut Vec<u64>,
    spare: &mut Vec<u64>,
    methods: &mut Vec<u32>,
) -> Ended {
    for _ in 0..FORCED {
        loop {
            let Some((task, below)) = stacks.pop(place.stack) else {
                return Ended::Done;
            };
            let Task::Action(action) = model.tasks[task as usize] else {
                break;
            };
            let action = &model.actions[action as usize];
            if !model.possible(state, action.pre, action.check) {
                return Ended::Dead;
            }
            spare.resize(state.len(), 0);
            model.apply(action, state, spare);
            std::mem::swap(state, spare);
            place.stack = below;
            place.cost = place.cost.saturating_add(action.cost);
            place.length += u32::from(action.origin != NONE);
        }
        debug_assert_ne!(place.stack, EMPTY);
        let Some((task, _)) = stacks.pop(place.stack) else {
            return Ended::Done;
        };
        methods.clear();
        methods.extend(
            model
                .methods_of(task)
                .filter(|method| {
                    let method = &model.methods[*method];
                    model.possible(state, method.pre, method.check)
                })
                .map(|method| method as u32),
        );
        match methods[..] {
            [] => return Ended::Dead,
            [method] => use_method(model, stacks, trace, place, method),
            _ => return Ended::Choice,
        }
    }
    Ended::Choice
}

/// Puts the subtasks of `method` in the place of the first task.
pub(super) fn use_method(
    model: &Model,
    stacks: &mut Stacks,
    trace: &mut Trace,
    place: &mut Place,
    method: u32,
) {
    let Some((_, mut stack)) = stacks.pop(place.stack) else {
        return;
    };
    for sub in model.get(model.methods[method as usize].subs).iter().rev() {
        stack = stacks.push(*sub, stack);
    }
    place.stack = stack;
    place.trace = trace.push(place.trace, method);
}
