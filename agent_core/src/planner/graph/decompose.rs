//! What may come next, and what is left to do at least: [`crate::planner::decompose`] and
//! [`crate::planner::estimate`], asked of a world that remembers the questions.

use super::code::{Arg, Method};
use super::eval::{Eval, bind, ground};
use super::intern::{NONE, Words};
use super::key::Key;
use super::lists::NIL;
use super::world::World;
use crate::model::Cost;

/// One way on.
#[derive(Debug)]
pub(super) struct Way {
    pub list: u32,
    pub delta: u32,
    /// Of the action; zero for a decomposition.
    pub cost: u64,
}

/// All ways on, and what was asked to find them.
#[derive(Debug, Default)]
pub(super) struct Ways {
    pub ways: Vec<Way>,
    pub reads: Vec<Key>,
    pub wanted: Vec<u32>,
}

/// All that may come of doing the first of a list in a state.
pub(super) fn ways(world: &mut World, list: u32, delta: u32) -> Ways {
    let Some((entry, rest)) = world.lists.first(list) else {
        return Ways::default();
    };
    let code = world.code.clone();
    let entry = world.lists.entry(entry);
    let (atom, purpose) = (entry.atom, entry.purpose);
    let name = world.facts.name(atom);
    let args = Words::from_slice(world.facts.args(atom));
    let mut found = Vec::new();
    let mut eval = Eval::new(world, delta);
    if let Some(operator) = code.operators.get(&name) {
        eval.reads.push(Key::Action(purpose));
        if !eval.world.is_forbidden(purpose) && eval.world.fit(&args, &operator.kinds) {
            let bindings = bind(&args, &operator.kinds);
            if !eval
                .solve(&operator.kinds, &operator.precondition, bindings)
                .is_empty()
            {
                let wanted = eval.wanted.len();
                let Cost(cost) = eval.cost_of(operator, &args);
                eval.wanted.truncate(wanted);
                let matters = eval.world.lists.reads(rest);
                eval.act(operator, &args, matters);
                let delta = eval.projected(matters);
                found.push(Way {
                    list: rest,
                    delta,
                    cost,
                });
            }
        }
    } else if code
        .tasks
        .get(&name)
        .is_none_or(|kinds| eval.world.fit(&args, kinds))
    {
        for method in code.methods.get(&name).into_iter().flatten() {
            let Some(bindings) = head(eval.world, method, &args) else {
                continue;
            };
            for bindings in eval.solve(&method.kinds, &method.precondition, bindings) {
                let subtasks = method.subtasks.iter().rev();
                let list = subtasks
                    .filter_map(|subtask| ground(subtask, &bindings))
                    .fold(rest, |rest, words| {
                        let atom = eval.world.facts.atom(&words);
                        let entry = eval.world.lists.task(atom);
                        eval.world.prepend(entry, rest)
                    });
                let matters = eval.world.lists.reads(list);
                let delta = eval.projected(matters);
                found.push(Way {
                    list,
                    delta,
                    cost: 0,
                });
            }
        }
    }
    let (reads, mut wanted) = (eval.reads, eval.wanted);
    wanted.sort_unstable();
    wanted.dedup();
    Ways {
        ways: found,
        reads,
        wanted,
    }
}

/// The method's variables as far as the task's arguments bind them; `None` if the method does not
/// do this task: one whose variables are of narrower types than the task's is for these only.
fn head(world: &mut World, method: &Method, args: &[u32]) -> Option<Words> {
    if method.head.len() != args.len() {
        return None;
    }
    let mut bindings = Words::from_elem(NONE, method.kinds.len());
    for (term, arg) in method.head.iter().zip(args) {
        match term {
            Arg::Object(object) if object != arg => return None,
            Arg::Object(_) => {}
            Arg::Variable(index) => match bindings[*index] {
                NONE if !world.fits(*arg, method.kinds[*index]) => return None,
                NONE => bindings[*index] = *arg,
                bound if bound != *arg => return None,
                _ => {}
            },
        }
    }
    Some(bindings)
}

/// A lower bound of what a list costs from a state, and what was asked to find it.
pub(super) fn estimate(world: &mut World, list: u32, delta: u32) -> (u64, Vec<Key>) {
    let code = world.code.clone();
    let mut eval = Eval::new(world, delta);
    let mut total = Cost::ZERO;
    let mut left = list;
    let mut known = true;
    while let Some((entry, rest)) = eval.world.lists.first(left) {
        left = rest;
        let atom = eval.world.lists.entry(entry).atom;
        let name = eval.world.facts.name(atom);
        let args = Words::from_slice(eval.world.facts.args(atom));
        let matters = eval.world.lists.reads(rest);
        if let Some(operator) = code.operators.get(&name) {
            if known {
                total = total + eval.cost_of(operator, &args);
                if rest != NIL {
                    eval.act(operator, &args, matters);
                }
            } else if operator.rules.is_empty() {
                total = total + eval.cost_of(operator, &args);
            }
            continue;
        }
        if !std::mem::take(&mut known) {
            continue;
        }
        let Some(rule) = code.estimates.get(&name) else {
            continue;
        };
        let found = eval.solve(&rule.kinds, &rule.given, bind(&args, &rule.kinds));
        let mut best: Option<(Cost, &Words)> = None;
        for bindings in &found {
            let units = eval.number(&rule.value, bindings);
            let cost = units.map_or(Cost::ZERO, Cost::from_units);
            if best.is_none_or(|(least, _)| cost < least) {
                best = Some((cost, bindings));
            }
        }
        if let Some((cost, bindings)) = best {
            known = true;
            total = total + cost;
            if rest != NIL {
                eval.establish(&rule.establishes, bindings, matters);
            }
        }
    }
    (total.0, eval.reads)
}
