//! What a plan hangs on: the facts that it takes as they are now.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::plan::Step;
use super::state::{Bindings, Delta, View, bind_arguments};
use super::{Problem, protected_by, simulate};
use crate::model::{Belief, Clause, Effect, Fact, FactChange, Symbol};

/// Of facts of which it can only be told by trying whether the plan hangs on them, so many are tried.
const TRIED: usize = 64;

/// A fact that a plan takes as it is: if it were otherwise, the plan would not hold.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Reliance {
    /// The fact.
    pub fact: Fact,
    /// Whether it has to hold, or has not to.
    pub wanted: bool,
    /// Whether it is as it has to be.
    pub given: bool,
    /// Whether it can change without the agent doing anything (`observable`).
    pub changes_alone: bool,
    /// The first step that needs it, counted from zero.
    pub step: usize,
}

/// What carrying out `steps` from the present belief hangs on, in the order of the steps.
///
/// A condition that an earlier step has brought about does not count: only what is read from the
/// belief does, and only what can change at all. If the first step is `running`, its precondition was
/// true when it began and need not be now; what is protected while it runs still counts.
///
/// Conditions with `or`, `forall` and `exists`, and those of effects, are tried out fact by fact, the first
/// few dozen of the facts that they speak of; of protected states only plain facts count.
pub fn hangs_on(problem: &Problem, steps: &[Step], running: bool) -> Vec<Reliance> {
    let mut reader = Reader {
        problem,
        changing: changing(problem),
        delta: Delta::new(),
        set: BTreeSet::new(),
        ranged: false,
        depended: false,
        sure: BTreeMap::new(),
        to_try: BTreeMap::new(),
    };
    for (index, step) in steps.iter().enumerate() {
        reader.step(index, step, running && index == 0);
    }
    let mut found = reader.sure;
    if !reader.to_try.is_empty() && simulate(problem, steps, running).is_ok() {
        for (fact, step) in reader.to_try {
            let holds = problem.belief.holds(&fact);
            let otherwise = with_changes(problem, [(&fact, !holds)]);
            if !found.contains_key(&fact) && simulate(&otherwise, steps, running).is_err() {
                found.insert(fact, (holds, step));
            }
        }
    }
    let mut found: Vec<Reliance> = (found.into_iter())
        .map(|(fact, (wanted, step))| Reliance {
            given: problem.belief.holds(&fact) == wanted,
            changes_alone: problem.model.observable.contains(&fact.name),
            fact,
            wanted,
            step,
        })
        .collect();
    found.sort_by_key(|reliance| reliance.step);
    found
}

/// The problem if some facts held, or did not.
pub(crate) fn with_changes<'f>(
    problem: &Problem,
    changes: impl IntoIterator<Item = (&'f Fact, bool)>,
) -> Problem {
    let mut belief = Belief::clone(&problem.belief);
    for (fact, holds) in changes {
        belief.apply(&match holds {
            true => FactChange::Add(fact.clone()),
            false => FactChange::Remove(fact.clone()),
        });
    }
    Problem {
        belief: Arc::new(belief),
        ..problem.clone()
    }
}

/// Predicates whose facts can change: of themselves, by actions, or by suspensions.
fn changing(problem: &Problem) -> BTreeSet<Symbol> {
    let operators = problem.domain.operators.values();
    let suspensions =
        (problem.model.actions.values()).filter_map(|action| action.suspension.as_ref());
    let effects = operators
        .map(|operator| &operator.effect)
        .chain(suspensions.map(|suspension| &suspension.effect));
    let changes = effects.flat_map(|effect| effect.add.iter().chain(&effect.remove));
    changes
        .map(|change| change.fact.name.clone())
        .chain(problem.model.observable.iter().cloned())
        .collect()
}

struct Reader<'a> {
    problem: &'a Problem,
    changing: BTreeSet<Symbol>,
    delta: Delta,
    /// Facts that steps have set, to whatever it was.
    set: BTreeSet<Fact>,
    /// Whether effects had a `forall`: they may have cleared what was not there.
    ranged: bool,
    /// Whether effects had a `when`: they might have been others.
    depended: bool,
    sure: BTreeMap<Fact, (bool, usize)>,
    to_try: BTreeMap<Fact, usize>,
}

impl Reader<'_> {
    fn step(&mut self, index: usize, step: &Step, running: bool) {
        let problem = self.problem;
        let action = step.action();
        let Some(operator) = problem.domain.operators.get(&action.name) else {
            return;
        };
        let bindings = bind_arguments(&action.args, &operator.parameters);
        if !running {
            for clause in &operator.precondition {
                self.read(clause, &bindings, index);
            }
        }
        // What has to hold while it runs is that of the action that it stands for.
        let purpose = step.purpose();
        for clause in protected_by(problem, step) {
            if let Clause::Fact(..) = clause {
                self.read(clause, &bind_arguments(&purpose.args, &[]), index);
            }
        }
        self.happen(&operator.effect, &bindings, index);
    }

    fn read(&mut self, clause: &Clause, bindings: &Bindings, index: usize) {
        match clause {
            Clause::Equal(..) => {}
            Clause::Fact(wanted, pattern) => {
                let Some(fact) = pattern.ground(bindings).filter(|fact| self.counts(fact)) else {
                    return;
                };
                if self.depended || (self.ranged && !wanted) {
                    self.to_try.entry(fact).or_insert(index);
                } else {
                    self.sure.entry(fact).or_insert((*wanted, index));
                }
            }
            Clause::Any(_) | Clause::Every(..) | Clause::Exists(..) => {
                self.try_all_of(clause, bindings, index);
            }
        }
    }

    /// Whether a plan can hang on a fact, as it is now.
    fn counts(&self, fact: &Fact) -> bool {
        self.changing.contains(&fact.name)
            && !self.problem.map.facts.holds(fact)
            && !self.set.contains(fact)
    }

    fn try_all_of(&mut self, clause: &Clause, bindings: &Bindings, index: usize) {
        let mut facts = Vec::new();
        self.facts_in(clause, bindings, &mut facts);
        for fact in facts {
            self.to_try.entry(fact).or_insert(index);
        }
    }

    /// The first facts that a condition speaks of.
    fn facts_in(&self, clause: &Clause, bindings: &Bindings, found: &mut Vec<Fact>) {
        if self.to_try.len() + found.len() >= TRIED {
            return;
        }
        match clause {
            Clause::Equal(..) => {}
            Clause::Fact(_, pattern) => {
                let fact = pattern.ground(bindings);
                found.extend(fact.filter(|fact| self.counts(fact)));
            }
            Clause::Any(choices) => {
                for clause in choices.iter().flatten() {
                    self.facts_in(clause, bindings, found);
                }
            }
            Clause::Every(over, inner) | Clause::Exists(over, inner) => {
                let Some((first, others)) = over.split_first() else {
                    for clause in inner {
                        self.facts_in(clause, bindings, found);
                    }
                    return;
                };
                let inner = Clause::Exists(others.to_vec(), inner.clone());
                for object in self.problem.objects_of(&first.kind) {
                    let mut bindings = bindings.clone();
                    bindings.push(Some(object));
                    self.facts_in(&inner, &bindings, found);
                }
            }
        }
    }

    fn happen(&mut self, effect: &Effect, bindings: &Bindings, index: usize) {
        for change in effect.remove.iter().chain(&effect.add) {
            if !change.when.is_empty() {
                let when = Clause::Exists(change.over.clone(), change.when.clone());
                self.try_all_of(&when, bindings, index);
            }
        }
        let view = View {
            problem: self.problem,
            delta: &self.delta,
        };
        for (changes, holds) in [(&effect.remove, false), (&effect.add, true)] {
            for change in changes {
                self.ranged |= !change.over.is_empty();
                self.depended |= !change.when.is_empty();
                view.each_fact(change, holds, bindings, &mut |fact| {
                    self.set.insert(fact);
                });
            }
        }
        self.delta = view.after(effect, bindings);
    }
}

#[cfg(test)]
mod tests;
