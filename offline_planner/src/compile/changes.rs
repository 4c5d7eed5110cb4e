//! What a task may change, whichever way it is done.

use rustc_hash::FxHashSet;

use super::{Compiled, KindId, MethodId, PredicateId, Step, Subtask, Term};

/// An argument of a fact that may change.
#[derive(Clone, Copy, Debug, Eq, PartialEq, Hash)]
enum Argument {
    /// The action's or task's parameter of that number.
    Parameter(usize),
    /// Any object of a kind.
    Any(KindId),
}

/// Facts that may become true or false.
#[derive(Clone, Debug, Eq, PartialEq, Hash)]
struct Possible {
    adds: bool,
    predicate: PredicateId,
    args: Vec<Argument>,
}

/// More patterns of one predicate than this are put together as one.
const PATTERNS_A_PREDICATE: usize = 12;

/// For every action and task, what it may change.
#[derive(Debug)]
pub(super) struct PossibleChanges {
    actions: Vec<Vec<Possible>>,
    tasks: Vec<Vec<Possible>>,
}

impl PossibleChanges {
    pub fn of(compiled: &mut Compiled) -> Self {
        let mut changes = Self {
            actions: (0..compiled.actions.len())
                .map(|action| of_action(compiled, action))
                .collect(),
            tasks: vec![Vec::new(); compiled.tasks.len()],
        };
        let mut known: Vec<FxHashSet<Possible>> = vec![FxHashSet::default(); compiled.tasks.len()];
        loop {
            let mut grown = false;
            for index in 0..compiled.methods.len() {
                let task = compiled.methods[index].task.index();
                for possible in changes.of_method(compiled, MethodId::new(index)) {
                    if covered(compiled, &changes.tasks[task], &possible) {
                        continue;
                    }
                    let possible = changes.bounded(compiled, task, possible);
                    if known[task].insert(possible.clone()) {
                        changes.tasks[task].push(possible);
                        grown = true;
                    }
                }
            }
            if !grown {
                return changes;
            }
        }
    }

    /// If there are many patterns of that predicate already: the one that covers all.
    fn bounded(&self, compiled: &Compiled, task: usize, possible: Possible) -> Possible {
        let alike = self.tasks[task]
            .iter()
            .filter(|other| other.predicate == possible.predicate && other.adds == possible.adds);
        if alike.count() < PATTERNS_A_PREDICATE {
            return possible;
        }
        let kinds = &compiled.predicate(possible.predicate).kinds;
        Possible {
            args: kinds.iter().copied().map(Argument::Any).collect(),
            ..possible
        }
    }

    fn of_step(&self, step: Step) -> &[Possible] {
        match step {
            Step::Action(action) => &self.actions[action.index()],
            Step::Task(task) => &self.tasks[task.index()],
        }
    }

    /// What the method's subtasks may change, in terms of the task's parameters.
    fn of_method(&self, compiled: &mut Compiled, id: MethodId) -> Vec<Possible> {
        let method = compiled.method(id).clone();
        let mut found = Vec::new();
        for subtask in &method.subtasks {
            for possible in self.of_step(subtask.step) {
                let args = possible.args.iter().map(|arg| match arg {
                    Argument::Any(kind) => Argument::Any(*kind),
                    Argument::Parameter(place) => {
                        let term = subtask.args[*place];
                        if let Some(place) = method.head.iter().position(|head| *head == term) {
                            return Argument::Parameter(place);
                        }
                        Argument::Any(match term {
                            Term::Variable(variable) => method.kinds[variable],
                            Term::Object(object) => compiled.kinds.of(vec![object]),
                        })
                    }
                });
                found.push(Possible {
                    args: args.collect(),
                    ..possible.clone()
                });
            }
        }
        found
    }

    /// Whether `subtask`, with these kinds of variables, may make the fact true (`adds`) or false.
    ///
    /// `differ` says of two terms that they are known never to be the same object.
    pub fn may(
        &self,
        compiled: &Compiled,
        kinds: &[KindId],
        subtask: &Subtask,
        adds: bool,
        fact: &super::FactPattern,
        differ: &dyn Fn(Term, Term) -> bool,
    ) -> bool {
        self.of_step(subtask.step).iter().any(|possible| {
            possible.adds == adds
                && possible.predicate == fact.predicate
                && possible.args.iter().zip(&fact.args).all(|(arg, wanted)| {
                    let meets = |kind: KindId| match wanted {
                        Term::Object(object) => compiled.kind(kind).contains(*object),
                        Term::Variable(variable) => {
                            let wanted = compiled.kind(kinds[*variable]);
                            !compiled.kind(kind).is_disjoint(wanted)
                        }
                    };
                    match arg {
                        Argument::Any(kind) => meets(*kind),
                        Argument::Parameter(place) => match subtask.args[*place] {
                            term if term == *wanted => true,
                            term if differ(term, *wanted) => false,
                            Term::Variable(variable) => meets(kinds[variable]),
                            Term::Object(object) => match wanted {
                                Term::Object(wanted) => object == *wanted,
                                Term::Variable(variable) => {
                                    compiled.kind(kinds[*variable]).contains(object)
                                }
                            },
                        },
                    }
                })
        })
    }
}

/// Whether a pattern that is known already says as much.
fn covered(compiled: &Compiled, known: &[Possible], new: &Possible) -> bool {
    known.iter().any(|known| {
        known.predicate == new.predicate
            && known.adds == new.adds
            && known.args.iter().zip(&new.args).all(|(known, new)| {
                known == new
                    || match (known, new) {
                        (Argument::Any(wide), Argument::Any(narrow)) => {
                            let wide = compiled.kind(*wide);
                            let mut members = compiled.kind(*narrow).members.iter();
                            members.all(|member| wide.contains(*member))
                        }
                        _ => false,
                    }
            })
    })
}

fn of_action(compiled: &mut Compiled, index: usize) -> Vec<Possible> {
    let action = compiled.actions[index].clone();
    let parameters = action.kinds.len();
    let of_change = |change: &super::Change| Possible {
        adds: change.adds,
        predicate: change.fact.predicate,
        args: change
            .fact
            .args
            .iter()
            .map(|term| match term {
                Term::Variable(variable) if *variable < parameters => {
                    Argument::Parameter(*variable)
                }
                Term::Variable(variable) => Argument::Any(change.over[*variable - parameters]),
                Term::Object(object) => Argument::Any(compiled.kinds.of(vec![*object])),
            })
            .collect(),
    };
    action.effect.iter().map(of_change).collect()
}
