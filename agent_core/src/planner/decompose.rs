//! One step of forward-chaining decomposition: from a state and what is to be done to all that may
//! come next.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::Problem;
use super::cost::cost_of;
use super::matching::for_each_binding;
use super::network::{Frame, Item, TaskList};
use super::plan::Step;
use super::state::{Bindings, Delta, View, bind_arguments};
use crate::model::{Fact, Method, Parameter, Task, Term};

/// What may come next.
pub(super) struct Successor {
    pub delta: Delta,
    pub tasks: TaskList,
    /// The action that leads there; `None` if a task was decomposed.
    pub step: Option<Step>,
}

/// All successors of doing the first of `tasks` in the state `delta`, in the order in which the
/// domain writes its methods. `next_frame` numbers the tasks that are decomposed.
pub(super) fn successors(
    problem: &Problem,
    delta: &Delta,
    tasks: &TaskList,
    next_frame: &mut u64,
    wanted: &mut BTreeSet<Fact>,
) -> Vec<Successor> {
    let view = View { problem, delta };
    let Some((item, parent, rest)) = tasks.first() else {
        return Vec::new();
    };
    let task = item.atom();
    if problem.domain.operators.contains_key(&task.name) {
        return act(view, item, parent, rest, wanted).into_iter().collect();
    }
    let mut found = Vec::new();
    if !fits(problem, task, problem.domain.tasks.get(&task.name)) {
        return found;
    }
    for method in &problem.domain.methods {
        let Some(bindings) = bind_head(problem, method, task) else {
            continue;
        };
        let frame = Arc::new(Frame {
            id: *next_frame,
            task: item.clone(),
            rest: rest.clone(),
            parent: parent.cloned(),
        });
        *next_frame += 1;
        for_each_binding(
            view,
            &method.parameters,
            &method.precondition,
            bindings,
            wanted,
            &mut |bindings| {
                // Every variable is bound here, so every subtask grounds.
                let subtasks = method.subtasks.iter().rev();
                let tasks = subtasks
                    .filter_map(|subtask| subtask.ground(bindings))
                    .fold(rest.clone(), |rest, task| {
                        rest.prepend(Item::Task(task), Some(frame.clone()))
                    });
                found.push(Successor {
                    delta: delta.clone(),
                    tasks,
                    step: None,
                });
            },
        );
    }
    found
}

/// The method's parameters as far as the task's arguments bind them; `None` if the method does
/// not do this task: one whose variables are of narrower types than the task's is for these only.
fn bind_head(problem: &Problem, method: &Method, task: &Task) -> Option<Bindings> {
    if method.task.name != task.name || method.task.args.len() != task.args.len() {
        return None;
    }
    let mut bindings: Bindings = vec![None; method.parameters.len()];
    for (term, arg) in method.task.args.iter().zip(&task.args) {
        match term {
            Term::Constant(object) if object != arg => return None,
            Term::Constant(_) => {}
            Term::Variable(index) => match &bindings[*index] {
                Some(bound) if bound != arg => return None,
                Some(_) => {}
                None if !problem.fits(arg, &method.parameters[*index].kind) => return None,
                None => bindings[*index] = Some(arg.clone()),
            },
        }
    }
    Some(bindings)
}

/// Whether the arguments are of the types declared: a variable of a wider type may have been bound
/// to anything.
fn fits(problem: &Problem, atom: &Task, declared: Option<&Vec<Parameter>>) -> bool {
    declared.is_none_or(|parameters| {
        let pairs = atom.args.iter().zip(parameters);
        atom.args.len() == parameters.len()
            && pairs
                .into_iter()
                .all(|(arg, parameter)| problem.fits(arg, &parameter.kind))
    })
}

/// The one successor of an action, if its precondition holds.
fn act(
    view: View<'_>,
    item: &Item,
    frame: Option<&Arc<Frame>>,
    rest: &TaskList,
    wanted: &mut BTreeSet<Fact>,
) -> Option<Successor> {
    let action = item.atom();
    if view.problem.forbidden.contains(item.purpose()) {
        return None;
    }
    let operator = view.problem.domain.operators.get(&action.name)?;
    if !fits(view.problem, action, Some(&operator.parameters)) {
        return None;
    }
    let bindings = bind_arguments(&action.args, &operator.parameters);
    let mut holds = false;
    for_each_binding(
        view,
        &operator.parameters,
        &operator.precondition,
        bindings.clone(),
        wanted,
        &mut |_| holds = true,
    );
    holds.then(|| Successor {
        delta: view.after(&operator.effect, &bindings),
        tasks: rest.clone(),
        step: Some(Step {
            item: item.clone(),
            cost: cost_of(view, action),
            frame: frame.cloned(),
            rest: rest.clone(),
        }),
    })
}
