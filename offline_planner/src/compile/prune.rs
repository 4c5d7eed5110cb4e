//! Leaving out what can never be used.

use super::{
    Clause, Compiled, Condition, FactPattern, KindId, MethodId, Predicate, Step, Subtask, Term,
};

/// Narrows what variables range over, drops methods that can never be used and whatever nothing
/// reaches any more, and tells which predicates change.
///
/// Numbers of objects, predicates, actions and tasks stay; what is dropped of the actions and tasks
/// is only that no method leads there.
pub(super) fn prune(compiled: &mut Compiled) {
    loop {
        narrow(compiled);
        mark_changes(compiled);
        if !drop_methods(compiled) {
            break;
        }
    }
    renumber_methods(compiled);
}

/// A variable can only be what the task at the head and all subtasks accept, and what facts and
/// equations that must hold leave it.
fn narrow(compiled: &mut Compiled) {
    for index in 0..compiled.methods.len() {
        let method = &compiled.methods[index];
        let mut limits: Vec<(usize, KindId)> = Vec::new();
        let mut limit = |terms: &[Term], kinds: &[KindId]| {
            for (term, kind) in terms.iter().zip(kinds) {
                if let Term::Variable(variable) = term {
                    limits.push((*variable, *kind));
                }
            }
        };
        limit(&method.head, &compiled.task(method.task).kinds);
        for subtask in &method.subtasks {
            limit(&subtask.args, kinds_of(compiled, subtask.step));
        }
        for clause in &method.precondition {
            if let Clause::Fact(true, fact) = clause {
                limit(&fact.args, &compiled.predicate(fact.predicate).kinds);
            }
        }
        for (variable, kind) in limits {
            let now = compiled.methods[index].kinds[variable];
            compiled.methods[index].kinds[variable] = compiled.kinds.both(now, kind);
        }
    }
    for index in 0..compiled.actions.len() {
        let mut limits: Vec<(usize, KindId)> = Vec::new();
        for clause in &compiled.actions[index].precondition {
            if let Clause::Fact(true, fact) = clause {
                let kinds = &compiled.predicate(fact.predicate).kinds;
                let variables = fact.args.iter().zip(kinds);
                limits.extend(variables.filter_map(|(term, kind)| Some((term.variable()?, *kind))));
            }
        }
        for (variable, kind) in limits {
            let now = compiled.actions[index].kinds[variable];
            compiled.actions[index].kinds[variable] = compiled.kinds.both(now, kind);
        }
    }
}

fn kinds_of(compiled: &Compiled, step: Step) -> &[KindId] {
    match step {
        Step::Action(action) => &compiled.action(action).kinds,
        Step::Task(task) => &compiled.task(task).kinds,
    }
}

/// Actions and tasks that some chain of methods leads to from the top.
fn reached(compiled: &Compiled) -> (Vec<bool>, Vec<bool>) {
    let mut actions = vec![false; compiled.actions.len()];
    let mut tasks = vec![false; compiled.tasks.len()];
    let mut open = vec![compiled.top];
    tasks[compiled.top.index()] = true;
    while let Some(task) = open.pop() {
        for method in &compiled.task(task).methods {
            for subtask in &compiled.method(*method).subtasks {
                match subtask.step {
                    Step::Action(action) => actions[action.index()] = true,
                    Step::Task(task) => {
                        if !tasks[task.index()] {
                            tasks[task.index()] = true;
                            open.push(task);
                        }
                    }
                }
            }
        }
    }
    (actions, tasks)
}

/// Only what can be executed changes anything.
fn mark_changes(compiled: &mut Compiled) {
    let (actions, _) = reached(compiled);
    for predicate in &mut compiled.predicates {
        predicate.added = false;
        predicate.removed = false;
    }
    let reached = compiled.actions.iter().zip(actions).filter(|(_, on)| *on);
    for change in reached.flat_map(|(action, _)| &action.effect) {
        let predicate = &mut compiled.predicates[change.fact.predicate.index()];
        if change.adds {
            predicate.added = true;
        } else {
            predicate.removed = true;
        }
    }
}

/// Whether any method was dropped.
fn drop_methods(compiled: &mut Compiled) -> bool {
    let (_, tasks) = reached(compiled);
    let useful = |method: &MethodId| {
        let method = compiled.method(*method);
        tasks[method.task.index()]
            && !has_empty(compiled, &method.kinds)
            && !never(compiled, &method.precondition)
            && head_fits(compiled, &method.head, method.task)
            && method.subtasks.iter().all(|step| possible(compiled, step))
    };
    let kept: Vec<Vec<MethodId>> = compiled
        .tasks
        .iter()
        .map(|task| task.methods.iter().copied().filter(useful).collect())
        .collect();
    let mut changed = false;
    for (task, kept) in compiled.tasks.iter_mut().zip(kept) {
        changed |= task.methods.len() != kept.len();
        task.methods = kept;
    }
    changed
}

fn has_empty(compiled: &Compiled, kinds: &[KindId]) -> bool {
    let mut kinds = kinds.iter();
    kinds.any(|kind| compiled.kind(*kind).members.is_empty())
}

fn head_fits(compiled: &Compiled, head: &[Term], task: super::TaskId) -> bool {
    constants_fit(compiled, head, &compiled.task(task).kinds)
}

fn constants_fit(compiled: &Compiled, terms: &[Term], kinds: &[KindId]) -> bool {
    terms.iter().zip(kinds).all(|(term, kind)| match term {
        Term::Variable(_) => true,
        Term::Object(object) => compiled.kind(*kind).contains(*object),
    })
}

fn possible(compiled: &Compiled, subtask: &Subtask) -> bool {
    constants_fit(compiled, &subtask.args, kinds_of(compiled, subtask.step))
        && match subtask.step {
            Step::Task(task) => !compiled.task(task).methods.is_empty(),
            Step::Action(action) => {
                let action = compiled.action(action);
                !has_empty(compiled, &action.kinds) && !never(compiled, &action.precondition)
            }
        }
}

/// Whether the condition can be seen never to hold.
fn never(compiled: &Compiled, condition: &Condition) -> bool {
    condition.iter().any(|clause| match clause {
        Clause::Fact(true, fact) => {
            let predicate = compiled.predicate(fact.predicate);
            !predicate.added && !among_first(compiled, predicate, fact)
        }
        Clause::Fact(false, fact) => {
            let predicate = compiled.predicate(fact.predicate);
            // Without variables it is one fact, and it holds for ever.
            !predicate.removed
                && fact.args.iter().all(|term| term.variable().is_none())
                && among_first(compiled, predicate, fact)
        }
        Clause::Equal(true, Term::Object(one), Term::Object(other)) => one != other,
        Clause::Equal(false, one, other) => one == other,
        Clause::Any(choices) => choices.iter().all(|choice| never(compiled, choice)),
        Clause::Equal(..) | Clause::Every(_) | Clause::Exists(_) => false,
    })
}

/// Whether some fact that matches holds at first.
fn among_first(compiled: &Compiled, predicate: &Predicate, fact: &FactPattern) -> bool {
    debug_assert_eq!(predicate.kinds.len(), fact.args.len());
    compiled.init_of(fact.predicate).any(|tuple| {
        tuple.iter().zip(&fact.args).all(|(object, term)| {
            matches!(term, Term::Variable(_)) || *term == Term::Object(*object)
        })
    })
}

/// Methods that belong to no task any more go; numbers close up.
fn renumber_methods(compiled: &mut Compiled) {
    let mut used = vec![false; compiled.methods.len()];
    for method in compiled.tasks.iter().flat_map(|task| &task.methods) {
        used[method.index()] = true;
    }
    let mut numbers = vec![MethodId(0); used.len()];
    let mut kept = 0;
    for (number, used) in numbers.iter_mut().zip(&used) {
        *number = MethodId::new(kept);
        kept += usize::from(*used);
    }
    let mut keep = used.iter();
    compiled
        .methods
        .retain(|_| keep.next().copied().unwrap_or(false));
    for method in compiled.tasks.iter_mut().flat_map(|task| &mut task.methods) {
        *method = numbers[method.index()];
    }
}
