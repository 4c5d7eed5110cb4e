//! A compiled problem, made ready for running: a query for every condition.

use rustc_hash::FxHashMap;

use super::facts::Facts;
use super::order::{Planner, Scope};
use super::query::Query;
use crate::compile::{
    Change, Clause, Compiled, KindId, Method, MethodId, ObjectId, PredicateId, Step, TaskId, Term,
};

/// Queries of all actions and methods.
#[derive(Debug)]
pub struct Program {
    /// By number of the action.
    pub actions: Vec<ActionProgram>,
    /// By number of the method.
    pub methods: Vec<MethodProgram>,
    /// What actions and tasks that are still to come need, and can never be had again once lost.
    pub action_needs: Vec<Vec<Need>>,
    pub task_needs: Vec<Vec<Need>>,
    /// For each task, whether a task list can grow while it is decomposed into itself.
    pub growing: Vec<bool>,
    /// The most variables and cursors that anything needs.
    pub width: usize,
    pub cursors: usize,
}

/// A fact of which no action can bring about that it is as it must be.
#[derive(Debug)]
pub struct Need {
    /// Whether it must hold.
    pub holds: bool,
    pub predicate: PredicateId,
    /// In terms of the parameters of the action or task.
    pub args: Vec<Term>,
}

#[derive(Debug)]
pub struct ActionProgram {
    pub precondition: Query,
    pub effect: Vec<ChangeProgram>,
}

#[derive(Debug)]
pub struct ChangeProgram {
    pub adds: bool,
    pub predicate: PredicateId,
    pub args: Vec<Term>,
    /// For what it ranges over and when; none if it is in any case.
    pub when: Option<Query>,
}

#[derive(Debug)]
pub struct MethodProgram {
    /// How the task's arguments bind variables.
    pub head: Vec<HeadStep>,
    pub query: Query,
}

impl MethodProgram {
    /// Binds the method's variables to the task's arguments; `false` if they do not fit.
    pub fn bind_head(
        &self,
        compiled: &Compiled,
        args: &[ObjectId],
        bindings: &mut [ObjectId],
    ) -> bool {
        self.head.iter().zip(args).all(|(step, arg)| match step {
            HeadStep::Bind(variable, kind) => {
                bindings[*variable] = *arg;
                compiled.kind(*kind).contains(*arg)
            }
            HeadStep::Is(term) => term.value(bindings) == *arg,
        })
    }
}

/// What is done with one argument of the task.
#[derive(Clone, Copy, Debug)]
pub enum HeadStep {
    /// The variable becomes the argument, if that is of its kind.
    Bind(usize, KindId),
    /// The argument must be this.
    Is(Term),
}

impl Program {
    /// All queries; `facts` gets the indexes they need and must be filled afterwards.
    pub fn new(compiled: &Compiled, facts: &mut Facts) -> Self {
        let mut planner = Planner {
            compiled,
            facts,
            fits: FxHashMap::default(),
        };
        let actions: Vec<ActionProgram> = compiled
            .actions
            .iter()
            .map(|action| {
                let scope = Scope {
                    kinds: action.kinds.clone(),
                    bound: vec![true; action.kinds.len()],
                };
                ActionProgram {
                    precondition: planner.query(&action.precondition, &scope),
                    effect: (action.effect.iter())
                        .map(|change| planner.change(change, &scope))
                        .collect(),
                }
            })
            .collect();
        let methods: Vec<MethodProgram> = compiled
            .methods
            .iter()
            .map(|method| planner.method(method))
            .collect();
        let conditions = actions
            .iter()
            .flat_map(|action| {
                let changes = action.effect.iter();
                changes
                    .filter_map(|change| change.when.as_ref())
                    .chain([&action.precondition])
            })
            .chain(methods.iter().map(|method| &method.query));
        let (mut width, mut cursors) = (1, 1);
        for query in conditions {
            width = width.max(query.width);
            cursors = cursors.max(query.choices());
        }
        let most = compiled.actions.iter().map(|action| action.kinds.len());
        Self {
            width: most.fold(width, usize::max),
            cursors,
            action_needs: (compiled.actions.iter())
                .map(|action| needs(compiled, &action.precondition))
                .collect(),
            task_needs: (compiled.tasks.iter())
                .map(|task| needs(compiled, &task.necessary))
                .collect(),
            growing: growing(compiled),
            actions,
            methods,
        }
    }
}

impl Planner<'_> {
    fn change(&mut self, change: &Change, scope: &Scope) -> ChangeProgram {
        let plain = change.over.is_empty() && change.when.is_empty();
        ChangeProgram {
            adds: change.adds,
            predicate: change.fact.predicate,
            args: change.fact.args.clone(),
            when: (!plain).then(|| {
                let mut scope = scope.clone();
                scope.kinds.extend(&change.over);
                scope.bound.resize(scope.kinds.len(), false);
                self.query(&change.when, &scope)
            }),
        }
    }

    fn method(&mut self, method: &Method) -> MethodProgram {
        let mut scope = Scope {
            kinds: method.kinds.clone(),
            bound: vec![false; method.kinds.len()],
        };
        let mut head = Vec::new();
        for term in &method.head {
            head.push(match *term {
                Term::Variable(variable) if !scope.bound[variable] => {
                    scope.bound[variable] = true;
                    HeadStep::Bind(variable, method.kinds[variable])
                }
                term => HeadStep::Is(term),
            });
        }
        let clauses = [&method.precondition[..], &method.necessary].concat();
        MethodProgram {
            head,
            query: self.query(&clauses, &scope),
        }
    }
}

/// Those facts of a condition that can be lost and never be had again.
fn needs(compiled: &Compiled, condition: &[Clause]) -> Vec<Need> {
    let facts = condition.iter().filter_map(|clause| match clause {
        Clause::Fact(holds, fact) => {
            let predicate = compiled.predicate(fact.predicate);
            let (gained, lost) = if *holds {
                (predicate.added, predicate.removed)
            } else {
                (predicate.removed, predicate.added)
            };
            (lost && !gained).then(|| Need {
                holds: *holds,
                predicate: fact.predicate,
                args: fact.args.clone(),
            })
        }
        _ => None,
    });
    facts.collect()
}

/// Tasks that can occur in what they are decomposed into, with something left to do after them: to
/// decompose them again and again makes the task list longer without end.
fn growing(compiled: &Compiled) -> Vec<bool> {
    let component = components(compiled);
    let mut growing = vec![false; compiled.tasks.len()];
    for method in &compiled.methods {
        let own = component[method.task.index()];
        let before_last = method.subtasks.len().saturating_sub(1);
        for subtask in &method.subtasks[..before_last] {
            if let Step::Task(task) = subtask.step
                && component[task.index()] == own
            {
                // Marks the component; spread to all its tasks below.
                growing[own] = true;
            }
        }
    }
    component.iter().map(|own| growing[*own]).collect()
}

/// For each task a number that it shares with exactly those that lead to it and that it leads to.
fn components(compiled: &Compiled) -> Vec<usize> {
    let next = |task: usize| {
        let methods = compiled.task(TaskId::new(task)).methods.iter();
        let subtasks = methods.flat_map(|method: &MethodId| &compiled.method(*method).subtasks);
        subtasks.filter_map(|subtask| match subtask.step {
            Step::Task(task) => Some(task.index()),
            Step::Action(_) => None,
        })
    };
    // Tasks are few: from each of them, what it reaches.
    let count = compiled.tasks.len();
    let reach: Vec<Vec<bool>> = (0..count)
        .map(|from| {
            let mut seen = vec![false; count];
            let mut open = vec![from];
            while let Some(task) = open.pop() {
                for next in next(task) {
                    if !seen[next] {
                        seen[next] = true;
                        open.push(next);
                    }
                }
            }
            seen
        })
        .collect();
    (0..count)
        .map(|task| {
            let shared = |other: &usize| reach[task][*other] && reach[*other][task];
            (0..task).find(shared).unwrap_or(task)
        })
        .collect()
}
