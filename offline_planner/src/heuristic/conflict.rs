//! Tasks left that get in each other's way.
//!
//! An action that stands in the list of tasks left will be executed, so what it removes is gone
//! for a later action in the list, unless something between them can bring it back. Where nothing
//! can, the list is hopeless, long before the search would come to that action: two factories
//! about to be built on one site, or one part promised to two machines.

use super::closure::Closures;
use super::relaxed::Lists;
use crate::ground::Model;
use crate::ground::model::{Literal, Task};

/// Finds lists of tasks that cannot be done for such a reason.
pub(crate) struct Conflicts<'m> {
    model: &'m Model,
    closures: Closures<'m>,
    /// By literal, the actions after which it can hold.
    makers: Lists,
    gone: Vec<bool>,
    listed: Vec<Literal>,
}

impl<'m> Conflicts<'m> {
    /// For a ground problem.
    pub fn new(model: &'m Model) -> Self {
        let mut makes = Lists::default();
        for action in &model.actions {
            let add = model.get(action.add).iter().map(|fact| fact * 2);
            let del = model.get(action.del).iter().map(|fact| fact * 2 + 1);
            let effects = model.conditionals_of(action).iter();
            let perhaps = effects.map(|effect| effect.fact * 2 + u32::from(!effect.add));
            makes.push(add.chain(del).chain(perhaps));
        }
        Self {
            model,
            closures: Closures::new(model),
            makers: Lists::inverse(model.facts * 2, &makes),
            gone: vec![false; model.facts * 2],
            listed: Vec::new(),
        }
    }

    /// Whether the tasks, in this order, cannot all be done in any state.
    pub fn hopeless(&mut self, tasks: &[u32]) -> bool {
        for literal in self.listed.drain(..) {
            self.gone[literal as usize] = false;
        }
        tasks
            .iter()
            .any(|task| match self.model.tasks[*task as usize] {
                Task::Action(action) => self.execute(action),
                Task::Methods(..) => {
                    self.decompose(*task);
                    false
                }
            })
    }

    /// Notes what the action makes impossible; `true` if it is impossible itself.
    fn execute(&mut self, action: u32) -> bool {
        let model = self.model;
        let action = &model.actions[action as usize];
        if model
            .get(action.pre)
            .iter()
            .any(|literal| self.gone[*literal as usize])
        {
            return true;
        }
        for fact in model.get(action.del) {
            self.end(fact * 2);
            self.gone[(fact * 2 + 1) as usize] = false;
        }
        for fact in model.get(action.add) {
            self.end(fact * 2 + 1);
            self.gone[(fact * 2) as usize] = false;
        }
        for effect in model.conditionals_of(action) {
            self.gone[(effect.fact * 2) as usize] = false;
            self.gone[(effect.fact * 2 + 1) as usize] = false;
        }
        false
    }

    fn end(&mut self, literal: Literal) {
        if !std::mem::replace(&mut self.gone[literal as usize], true) {
            self.listed.push(literal);
        }
    }

    /// Takes back what may come to hold again while `task` is done.
    fn decompose(&mut self, task: u32) {
        for place in 0..self.listed.len() {
            let literal = self.listed[place] as usize;
            if self.gone[literal] {
                let closures = &mut self.closures;
                let makers = self.makers.get(literal).iter();
                self.gone[literal] = !makers.copied().any(|action| closures.has(task, action));
            }
        }
    }
}
