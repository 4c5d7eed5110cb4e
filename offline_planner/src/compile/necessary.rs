//! Conditions of later steps that must hold from the beginning.
//!
//! A step asks for a fact; nothing before it in the method can make that fact true: then the fact
//! must hold when the method is chosen. To know this early spares a search everything in between.
//! (HyperTensioN's "pullup" takes conditions up from the first subtask; this takes them over
//! subtasks that cannot help, by what tasks may change at all.)

use super::changes::PossibleChanges;
use super::{
    Clause, Compiled, Condition, FactPattern, Goal, Method, MethodId, Step, Subtask, Term,
};

/// Rounds after which everything should long have settled.
const ROUNDS: usize = 200;

/// Fills in [`Method::necessary`], [`Task::necessary`](super::Task::necessary) and
/// [`Compiled::goals`].
pub(super) fn find(compiled: &mut Compiled) {
    let changes = PossibleChanges::of(compiled);
    compiled.goals = goals(compiled, &changes);
    // What each task asks for, in terms of its parameters; nothing known yet is "everything",
    // which only shrinks: what all finite decompositions share.
    let mut tasks: Vec<Option<Condition>> = vec![None; compiled.tasks.len()];
    let mut settled = false;
    for _ in 0..ROUNDS {
        settled = true;
        for index in 0..compiled.tasks.len() {
            let mut shared: Option<Condition> = None;
            for id in &compiled.tasks[index].methods {
                let Some(asked) = of_method(compiled, &changes, &tasks, *id) else {
                    continue;
                };
                let asked = in_parameters(compiled.method(*id), &asked);
                shared = Some(match shared {
                    None => asked,
                    Some(shared) => shared.into_iter().filter(|c| asked.contains(c)).collect(),
                });
            }
            if shared != tasks[index] {
                tasks[index] = shared;
                settled = false;
            }
        }
        if settled {
            break;
        }
    }
    if !settled {
        // What has not settled may still be too much. The preconditions alone are safe.
        tasks = vec![Some(Condition::new()); compiled.tasks.len()];
    }
    for (task, necessary) in compiled.tasks.iter_mut().zip(&tasks) {
        // A task that is never carried through asks for what never holds.
        let never = || vec![Clause::Any(Vec::new())];
        task.necessary = necessary.clone().unwrap_or_else(never);
    }
    for index in 0..compiled.methods.len() {
        let id = MethodId::new(index);
        let asked = of_method(compiled, &changes, &tasks, id);
        let method = &mut compiled.methods[index];
        let Some(asked) = asked else {
            // No finite decomposition begins with it.
            method.necessary = vec![Clause::Any(Vec::new())];
            continue;
        };
        method.necessary = asked
            .into_iter()
            .filter(|clause| !method.precondition.contains(clause))
            .collect();
    }
}

/// Which tasks of the problem can still help which goal.
fn goals(compiled: &Compiled, changes: &PossibleChanges) -> Vec<Goal> {
    let methods = &compiled.task(compiled.top).methods;
    let (Some(goal), Some(top)) = (compiled.goal, methods.first()) else {
        return Vec::new();
    };
    let top = compiled.method(*top);
    let mut goals = Vec::new();
    for clause in &compiled.action(goal).precondition {
        if let Clause::Fact(positive, fact) = clause {
            let helps = |subtask: &Subtask| {
                changes.may(compiled, &top.kinds, subtask, *positive, fact, &|_, _| {
                    false
                })
            };
            goals.push(Goal {
                holds: *positive,
                fact: fact.clone(),
                last_help: top.subtasks.iter().rposition(helps),
            });
        }
    }
    goals
}

/// What must hold when the method is chosen; `None`: more than can be said as yet.
fn of_method(
    compiled: &Compiled,
    changes: &PossibleChanges,
    tasks: &[Option<Condition>],
    id: MethodId,
) -> Option<Condition> {
    let method = compiled.method(id);
    let mut asked: Condition = Vec::new();
    let mut add = |clause: Clause| {
        if !trivial(&clause) && !asked.contains(&clause) {
            asked.push(clause);
        }
    };
    for clause in &method.precondition {
        if matches!(clause, Clause::Fact(..) | Clause::Equal(..)) {
            add(clause.clone());
        }
    }
    let differ = |one: Term, other: Term| {
        method.precondition.iter().any(|clause| {
            *clause == Clause::Equal(false, one, other)
                || *clause == Clause::Equal(false, other, one)
        })
    };
    for (place, subtask) in method.subtasks.iter().enumerate() {
        let wanted = match subtask.step {
            Step::Action(action) => &compiled.action(action).precondition,
            Step::Task(task) => tasks[task.index()].as_ref()?,
        };
        for clause in wanted {
            let Some(clause) = substituted(clause, subtask) else {
                continue;
            };
            let helped = match &clause {
                Clause::Fact(positive, fact) => method.subtasks[..place].iter().any(|before| {
                    changes.may(compiled, &method.kinds, before, *positive, fact, &differ)
                }),
                _ => false,
            };
            if !helped {
                add(clause);
            }
        }
    }
    Some(asked)
}

fn trivial(clause: &Clause) -> bool {
    matches!(clause, Clause::Equal(true, one, other) if one == other)
}

/// The clause of a step in terms of the method that the step is part of; only plain clauses.
fn substituted(clause: &Clause, subtask: &Subtask) -> Option<Clause> {
    let put = |term: &Term| match term {
        Term::Variable(variable) => subtask.args.get(*variable).copied(),
        Term::Object(_) => Some(*term),
    };
    Some(match clause {
        Clause::Fact(positive, fact) => Clause::Fact(
            *positive,
            FactPattern {
                predicate: fact.predicate,
                args: fact.args.iter().map(put).collect::<Option<_>>()?,
            },
        ),
        Clause::Equal(positive, one, other) => Clause::Equal(*positive, put(one)?, put(other)?),
        _ => return None,
    })
}

/// Those clauses that speak of the task's parameters alone, and what the head itself asks for.
fn in_parameters(method: &Method, asked: &[Clause]) -> Condition {
    let parameter = |term: &Term| match term {
        Term::Object(_) => Some(*term),
        Term::Variable(_) => {
            let place = method.head.iter().position(|head| head == term);
            place.map(Term::Variable)
        }
    };
    let mut found: Condition = Vec::new();
    for (place, term) in method.head.iter().enumerate() {
        let here = Term::Variable(place);
        if let Some(there) = parameter(term)
            && there != here
        {
            found.push(Clause::Equal(true, there, here));
        }
    }
    for clause in asked {
        let clause = match clause {
            Clause::Fact(positive, fact) => fact
                .args
                .iter()
                .map(parameter)
                .collect::<Option<_>>()
                .map(|args| {
                    let predicate = fact.predicate;
                    Clause::Fact(*positive, FactPattern { predicate, args })
                }),
            Clause::Equal(positive, one, other) => parameter(one)
                .zip(parameter(other))
                .map(|(one, other)| Clause::Equal(*positive, one, other)),
            _ => None,
        };
        if let Some(clause) = clause
            && !trivial(&clause)
            && !found.contains(&clause)
        {
            found.push(clause);
        }
    }
    found
}
