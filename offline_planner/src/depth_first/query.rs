//! Conditions as small programs that list their bindings one after another.

use super::facts::Facts;
use super::hash::spread;
use crate::compile::{Compiled, KindId, ObjectId, PredicateId, Term};

/// One step of a query: either binds variables, in several ways one after another, or tests.
#[derive(Debug)]
pub(super) enum Step {
    /// Some fact that holds and fits what is bound; binds the rest.
    Match {
        predicate: PredicateId,
        index: usize,
        key: Vec<Term>,
        /// Argument places and the variables that take what stands there.
        binds: Vec<(usize, usize)>,
        /// Argument places where a variable must stand that an earlier place has just bound.
        again: Vec<(usize, usize)>,
        /// Variables whose kind is narrower than what can stand there.
        kinds: Vec<(usize, KindId)>,
    },
    /// Any object of a kind.
    Range { variable: usize, kind: KindId },
    /// The variable is what the term is.
    Assign { variable: usize, term: Term },
    /// The fact holds, or does not.
    Holds(bool, PredicateId, Vec<Term>),
    /// The terms are the same, or are not.
    Equal(bool, Term, Term),
    /// The object is of the kind.
    Of(usize, KindId),
    /// Some of these queries has an answer (`true`), or none has.
    Some(bool, Vec<Query>),
}

/// What queries are asked of.
#[derive(Clone, Copy, Debug)]
pub struct AtHand<'a> {
    pub facts: &'a Facts,
    pub compiled: &'a Compiled,
    /// If given, choices are not tried from the first on, but from one that depends on this number
    /// and on the state.
    pub chance: Option<u64>,
}

impl<'a> AtHand<'a> {
    /// Without chance.
    pub fn plain(facts: &'a Facts, compiled: &'a Compiled) -> Self {
        Self {
            facts,
            compiled,
            chance: None,
        }
    }

    /// Which of so many choices comes first.
    fn first_of(&self, choices: usize) -> usize {
        match self.chance {
            Some(seed) if choices > 1 => {
                (spread(seed ^ self.facts.hash()) % choices as u64) as usize
            }
            _ => 0,
        }
    }
}

impl Step {
    fn has_choices(&self) -> bool {
        matches!(self, Self::Match { .. } | Self::Range { .. })
    }
}

/// A condition, once it is decided in which order its variables are bound.
#[derive(Debug, Default)]
pub struct Query {
    pub(super) steps: Vec<Step>,
    /// For each step the number of steps with choices before it.
    choices_before: Vec<usize>,
    choices: usize,
    /// How many variables it knows, those of its own `exists` included.
    pub width: usize,
}

impl Query {
    pub(super) fn new(steps: Vec<Step>, width: usize) -> Self {
        let mut choices = 0;
        let mut choices_before = Vec::new();
        for step in &steps {
            choices_before.push(choices);
            choices += usize::from(step.has_choices());
        }
        Self {
            steps,
            choices_before,
            choices,
            width,
        }
    }

    /// How many cursors are needed to go on with it.
    pub fn choices(&self) -> usize {
        self.choices
    }

    /// The first answer: binds what is unbound, and leaves in `cursors` where each choice stands.
    pub fn first(
        &self,
        at_hand: AtHand<'_>,
        bindings: &mut [ObjectId],
        cursors: &mut [u32],
    ) -> bool {
        self.run(at_hand, bindings, cursors, 0, true)
    }

    /// The next answer after that to which bindings and cursors belong.
    pub fn next(
        &self,
        at_hand: AtHand<'_>,
        bindings: &mut [ObjectId],
        cursors: &mut [u32],
    ) -> bool {
        self.run(at_hand, bindings, cursors, self.steps.len(), false)
    }

    fn run(
        &self,
        at_hand: AtHand<'_>,
        bindings: &mut [ObjectId],
        cursors: &mut [u32],
        mut at: usize,
        mut forward: bool,
    ) -> bool {
        loop {
            if forward {
                let Some(step) = self.steps.get(at) else {
                    return true;
                };
                if step.has_choices() {
                    cursors[self.choices_before[at]] = 0;
                }
            } else {
                // Back to the last step that has another choice.
                loop {
                    if at == 0 {
                        return false;
                    }
                    at -= 1;
                    if self.steps[at].has_choices() {
                        break;
                    }
                }
            }
            let cursor = cursors.get_mut(self.choices_before[at]);
            forward = take(&self.steps[at], at_hand, bindings, cursor);
            if forward {
                at += 1;
            }
        }
    }

    /// Binds again what the cursors stand for. The facts must be those of then.
    pub fn rebind(&self, at_hand: AtHand<'_>, bindings: &mut [ObjectId], cursors: &[u32]) {
        for (step, before) in self.steps.iter().zip(&self.choices_before) {
            let mut cursor = cursors
                .get(*before)
                .map_or(0, |cursor| cursor.saturating_sub(1));
            if matches!(
                step,
                Step::Match { .. } | Step::Range { .. } | Step::Assign { .. }
            ) {
                take(step, at_hand, bindings, Some(&mut cursor));
            }
        }
    }

    /// Whether another answer may follow. `false` is certain.
    pub fn may_have_more(
        &self,
        at_hand: AtHand<'_>,
        bindings: &[ObjectId],
        cursors: &[u32],
    ) -> bool {
        self.steps
            .iter()
            .zip(&self.choices_before)
            .any(|(step, before)| {
                let total = match step {
                    Step::Match {
                        predicate,
                        index,
                        key,
                        ..
                    } => {
                        let key = key.iter().map(|term| term.value(bindings));
                        let table = at_hand.facts.table(*predicate);
                        table.matching(*index, key).len()
                    }
                    Step::Range { kind, .. } => at_hand.compiled.kind(*kind).members.len(),
                    _ => return false,
                };
                (cursors[*before] as usize) < total
            })
    }
}

/// Takes the step's next choice that fits; for a test, says whether it holds.
fn take(
    step: &Step,
    at_hand: AtHand<'_>,
    bindings: &mut [ObjectId],
    cursor: Option<&mut u32>,
) -> bool {
    let AtHand {
        facts, compiled, ..
    } = at_hand;
    match step {
        Step::Match {
            predicate,
            index,
            key,
            binds,
            again,
            kinds,
        } => {
            let Some(cursor) = cursor else {
                return false;
            };
            let table = facts.table(*predicate);
            let key = key.iter().map(|term| term.value(bindings));
            let found = table.matching(*index, key);
            let shift = at_hand.first_of(found.len());
            while (*cursor as usize) < found.len() {
                let at = *cursor as usize + shift;
                let place = &found[if at < found.len() {
                    at
                } else {
                    at - found.len()
                }];
                *cursor += 1;
                let args = table.args(*place);
                for (place, variable) in binds {
                    bindings[*variable] = args[*place];
                }
                if again
                    .iter()
                    .all(|(place, variable)| bindings[*variable] == args[*place])
                    && kinds
                        .iter()
                        .all(|(variable, kind)| compiled.kind(*kind).contains(bindings[*variable]))
                {
                    return true;
                }
            }
            false
        }
        Step::Range { variable, kind } => {
            let Some(cursor) = cursor else {
                return false;
            };
            let member = compiled.kind(*kind).members.get(*cursor as usize);
            *cursor += 1;
            member
                .inspect(|member| bindings[*variable] = **member)
                .is_some()
        }
        Step::Assign { variable, term } => {
            bindings[*variable] = term.value(bindings);
            true
        }
        Step::Holds(positive, predicate, terms) => {
            facts.holds(*predicate, terms.iter().map(|term| term.value(bindings))) == *positive
        }
        Step::Equal(positive, one, other) => {
            (one.value(bindings) == other.value(bindings)) == *positive
        }
        Step::Of(variable, kind) => compiled.kind(*kind).contains(bindings[*variable]),
        Step::Some(positive, queries) => {
            queries
                .iter()
                .any(|query| query.has_answer(at_hand, bindings))
                == *positive
        }
    }
}

impl Query {
    /// Whether there is an answer. Variables of its own are bound in what lies behind those that
    /// are bound already.
    fn has_answer(&self, at_hand: AtHand<'_>, bindings: &mut [ObjectId]) -> bool {
        let mut few = [0; 8];
        if self.choices <= few.len() {
            self.first(at_hand, bindings, &mut few)
        } else {
            self.first(at_hand, bindings, &mut vec![0; self.choices])
        }
    }
}
