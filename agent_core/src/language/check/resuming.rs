//! The proof that an action, suspended and resumed, comes to the same as without interruption.

use std::collections::BTreeSet;

use super::beyond::{renamed, unproved};
use super::cases::{Grouping, Things};
use super::state::{Argument, Ground, GroundEffect, Known};
use super::{DomainError, Truth};
use crate::model::{Clause, Domain, ExecutionModel, Operator, Pattern, Suspension, Symbol, Term};

/// Proves for all arguments that the resuming action can be executed once `operator` has been
/// suspended, and that it ends where `operator` would have ended.
///
/// Of what the arguments have in common nothing is known but their types, so every way in which
/// some are the same object is a case of its own. Only the first case that fails is reported:
/// what fails while all differ fails in the others too.
pub(super) fn check_resuming(
    domain: &Domain,
    model: &ExecutionModel,
    operator: &Operator,
    suspension: &Suspension,
    errors: &mut Vec<DomainError>,
) {
    let Some(resuming) = domain.operators.get(&suspension.resume.name) else {
        return; // reported with the other names
    };
    if resuming.parameters.len() != suspension.resume.args.len() {
        return; // likewise
    }
    let unproved = unproved(domain, operator, suspension, resuming);
    if !unproved.is_empty() {
        errors.extend(unproved);
        return;
    }
    let constants = constants_of(operator, suspension, resuming);
    let proof = Proof {
        model,
        operator,
        suspension,
        resuming,
        things: Things::new(&operator.parameters, constants),
    };
    let groupings = proof.things.groupings(domain);
    for check in [Proof::can_be_resumed, Proof::ends_where_it_would] {
        let found = groupings
            .iter()
            .map(|grouping| check(&proof, grouping))
            .find(|found| !found.is_empty());
        errors.extend(found.unwrap_or_default());
    }
}

struct Proof<'a> {
    model: &'a ExecutionModel,
    operator: &'a Operator,
    suspension: &'a Suspension,
    resuming: &'a Operator,
    things: Things<'a>,
}

impl Proof<'_> {
    /// After the suspension the resuming action's precondition holds.
    fn can_be_resumed(&self, grouping: &Grouping) -> Vec<DomainError> {
        let (Some(known), Some(suspending)) = (self.known(grouping), self.suspending(grouping))
        else {
            return Vec::new();
        };
        let mut errors = Vec::new();
        for literal in &self.resuming.precondition {
            let (proved, words) = match literal {
                Clause::Fact(wanted, pattern) => {
                    let Some(fact) = self.ground(pattern, |term| self.resumed(grouping, term))
                    else {
                        continue; // a fault among the names
                    };
                    let before = known.get(&fact).copied();
                    let words = format!("`{}` is {}", self.words(&fact), truth(Some(*wanted)));
                    (suspending.after(&fact, before) == Some(*wanted), words)
                }
                Clause::Equal(wanted, left, right) => {
                    let left = self.resumed(grouping, left);
                    let right = self.resumed(grouping, right);
                    let (Some(Argument::Object(left)), Some(Argument::Object(right))) =
                        (left, right)
                    else {
                        continue;
                    };
                    let words = format!(
                        "`{}` and `{}` {}",
                        self.things.name(left),
                        self.things.name(right),
                        if *wanted { "are the same" } else { "differ" }
                    );
                    ((left == right) == *wanted, words)
                }
                Clause::Any(_) | Clause::Every(..) | Clause::Exists(..) => {
                    let words = format!(
                        "its `or`, `forall` or `exists` holds (that is proved only if `{}` needs \
                         the same, and the suspension changes nothing in it)",
                        self.operator.name
                    );
                    (self.is_kept(literal), words)
                }
            };
            if !proved {
                errors.push(DomainError::CannotResume {
                    key: self.key("resume"),
                    action: self.operator.name.clone(),
                    resuming: self.resuming_words(),
                    condition: words,
                    case: self.things.describe(grouping),
                });
            }
        }
        errors
    }

    /// Whether the suspended action needs just this too, and the suspension leaves it alone.
    fn is_kept(&self, clause: &Clause) -> bool {
        let wanted = renamed(
            clause,
            &self.suspension.resume.args,
            self.resuming,
            self.operator,
        );
        let own = self.operator.parameters.len();
        let same: Vec<Term> = (0..own).map(Term::Variable).collect();
        let known = |clause| renamed(clause, &same, self.operator, self.operator) == wanted;
        let effect = &self.suspension.effect;
        let changes = || effect.remove.iter().chain(&effect.add);
        let mut touched = false;
        clause.each_pattern(&mut |pattern| {
            touched |= changes().any(|change| change.fact.name == pattern.name);
        });
        !touched && self.operator.precondition.iter().any(known)
    }

    /// Every fact is the same in the end, interrupted or not.
    fn ends_where_it_would(&self, grouping: &Grouping) -> Vec<DomainError> {
        let executing = GroundEffect::new(&self.operator.effect, |term| self.own(grouping, term));
        let resuming =
            GroundEffect::new(&self.resuming.effect, |term| self.resumed(grouping, term));
        let (Some(known), Some(executing), Some(suspending), Some(resuming)) = (
            self.known(grouping),
            executing,
            self.suspending(grouping),
            resuming,
        ) else {
            return Vec::new();
        };
        // Of anything else that a quantified effect removes no more is known than of the one fact
        // that stands for it, so that it fares the same.
        let facts: BTreeSet<Ground> = [&executing, &suspending, &resuming]
            .iter()
            .flat_map(|effect| effect.touched(grouping.len()))
            .chain(known.keys().cloned())
            .collect();
        let mut errors = Vec::new();
        for fact in &facts {
            let before = known.get(fact).copied();
            let wanted = executing.after(fact, before);
            let found = resuming.after(fact, suspending.after(fact, before));
            // What only the suspension brings about is a note that the action was broken off, and
            // observable facts are found out anew: to take either back restores what was before.
            let forgotten = wanted.is_none()
                && found == Some(false)
                && (suspending.adds(fact) || self.model.observable.contains(&fact.0));
            if wanted != found && !forgotten {
                errors.push(DomainError::EndsElsewhere {
                    key: self.key("resume"),
                    action: self.operator.name.clone(),
                    resuming: self.resuming_words(),
                    fact: self.words(fact),
                    after_action: truth(wanted),
                    after_resuming: truth(found),
                    case: self.things.describe(grouping),
                });
            }
        }
        errors
    }

    /// What the action's precondition says. `None` if it excludes the case.
    fn known(&self, grouping: &Grouping) -> Option<Known> {
        let mut known = Known::new();
        for literal in &self.operator.precondition {
            match literal {
                Clause::Fact(holds, pattern) => {
                    let fact = self.ground(pattern, |term| self.own(grouping, term))?;
                    if known
                        .insert(fact, *holds)
                        .is_some_and(|before| before != *holds)
                    {
                        return None;
                    }
                }
                Clause::Equal(holds, left, right) => {
                    let (left, right) = (self.own(grouping, left)?, self.own(grouping, right)?);
                    if (left == right) != *holds {
                        return None;
                    }
                }
                Clause::Any(_) | Clause::Every(..) | Clause::Exists(..) => {}
            }
        }
        Some(known)
    }

    fn suspending(&self, grouping: &Grouping) -> Option<GroundEffect> {
        GroundEffect::new(&self.suspension.effect, |term| self.own(grouping, term))
    }

    /// What a term of the suspended action stands for.
    fn own(&self, grouping: &Grouping, term: &Term) -> Option<Argument> {
        match (self.things.index(term), term) {
            (Some(thing), _) => Some(Argument::Object(grouping[thing])),
            (None, Term::Variable(quantified)) => Some(Argument::Any(*quantified)),
            (None, Term::Constant(_)) => None,
        }
    }

    /// What a term of the resuming action stands for.
    fn resumed(&self, grouping: &Grouping, term: &Term) -> Option<Argument> {
        match term {
            Term::Variable(index) => match self.suspension.resume.args.get(*index) {
                Some(argument) => self.own(grouping, argument),
                None => Some(Argument::Any(*index)),
            },
            Term::Constant(_) => self.own(grouping, term),
        }
    }

    fn ground(
        &self,
        pattern: &Pattern,
        argument: impl Fn(&Term) -> Option<Argument>,
    ) -> Option<Ground> {
        let args = pattern
            .args
            .iter()
            .map(|term| match argument(term)? {
                Argument::Object(object) => Some(object),
                Argument::Any(_) => None,
            })
            .collect::<Option<_>>()?;
        Some((pattern.name.clone(), args))
    }

    fn key(&self, rest: &str) -> String {
        format!("action.{}.suspension.{rest}", self.operator.name)
    }

    fn words(&self, (name, objects): &Ground) -> String {
        let mut out = format!("({name}");
        for object in objects {
            out.push(' ');
            out.push_str(self.things.name(*object));
        }
        out + ")"
    }

    fn resuming_words(&self) -> String {
        let mut out = format!("({}", self.resuming.name);
        for argument in &self.suspension.resume.args {
            let name = self
                .things
                .index(argument)
                .map_or("?", |thing| self.things.name(thing));
            out.push(' ');
            out.push_str(name);
        }
        out + ")"
    }
}

fn truth(value: Option<bool>) -> Truth {
    match value {
        Some(true) => Truth::True,
        Some(false) => Truth::False,
        None => Truth::AsBefore,
    }
}

/// All constants that the proof will meet.
fn constants_of(operator: &Operator, suspension: &Suspension, resuming: &Operator) -> Vec<Symbol> {
    let mut found = BTreeSet::new();
    let mut term = |term: &Term| {
        if let Term::Constant(name) = term {
            found.insert(name.clone());
        }
    };
    let literals = operator.precondition.iter().chain(&resuming.precondition);
    let effects = [&operator.effect, &suspension.effect, &resuming.effect];
    for literal in literals {
        match literal {
            Clause::Fact(_, pattern) => pattern.args.iter().for_each(&mut term),
            Clause::Equal(_, left, right) => [left, right].into_iter().for_each(&mut term),
            Clause::Any(_) | Clause::Every(..) | Clause::Exists(..) => {}
        }
    }
    for effect in effects {
        for change in effect.remove.iter().chain(&effect.add) {
            change.fact.args.iter().for_each(&mut term);
        }
    }
    suspension.resume.args.iter().for_each(&mut term);
    found.into_iter().collect()
}
