//! Whether something that happens leaves at most one fact of a group.
//!
//! By induction: before it happens, at most one fact holds for the same values of the parameters.

use super::group::{Group, Role};
use super::schema::Schema;
use super::unify::Unifier;
use crate::model::{Change, Clause, Domain, Parameter, Pattern, Symbol, Term};

/// A schema and one of the facts that it adds, seen from the group that the fact is in.
pub(super) struct Addition<'a> {
    domain: &'a Domain,
    schema: &'a Schema,
    add: &'a Change,
    /// All that holds, or does not, wherever the fact is added.
    known: Vec<Clause>,
    /// The terms in the places of the group's parameters.
    terms: Vec<Term>,
}

/// Every addition to the group that a schema makes.
pub(super) fn additions<'a>(
    domain: &'a Domain,
    schema: &'a Schema,
    group: &Group,
) -> Vec<Addition<'a>> {
    let addition = |add: &'a Change| {
        let part = group.part(&add.fact.name)?;
        let mut known = schema.known.clone();
        known.extend(add.when.iter().filter(|clause| is_plain(clause)).cloned());
        Some(Addition {
            domain,
            schema,
            add,
            known,
            terms: part.parameters_in(&add.fact.args)?,
        })
    };
    schema.effect.add.iter().filter_map(addition).collect()
}

/// Whether the two add different facts for the same values of the parameters, as far as can be told
/// (Helmert: the schema is *too heavy*). `b` may be `a`.
pub(super) fn too_heavy(group: &Group, a: &Addition<'_>, b: &Addition<'_>) -> bool {
    let mut same = Unifier::default();
    // The variables of `b`'s own `forall` are others than those of `a`'s.
    let (own, shift) = (b.schema.parameters.len(), a.add.over.len());
    let other = |term: &Term| match term {
        Term::Variable(index) if *index >= own => Term::Variable(index + shift),
        _ => term.clone(),
    };
    let b_terms: Vec<Term> = b.terms.iter().map(other).collect();
    if !same.unify_all(&a.terms, &b_terms) {
        return false;
    }
    let mut known = a.known.clone();
    for clause in &b.known {
        known.push(match clause {
            Clause::Fact(holds, fact) => Clause::Fact(*holds, with_terms(fact, other)),
            Clause::Equal(equal, x, y) => Clause::Equal(*equal, other(x), other(y)),
            _ => continue,
        });
    }
    // What holds of the group beforehand is one fact.
    let before: Vec<(&Pattern, Vec<Term>)> = (known.iter())
        .filter_map(|clause| match clause {
            Clause::Fact(true, fact) => {
                Some((fact, group.part(&fact.name)?.parameters_in(&fact.args)?))
            }
            _ => None,
        })
        .filter(|(_, terms)| same.all_equal(terms, &a.terms))
        .collect();
    if let Some(((first, _), others)) = before.split_first() {
        for (other, _) in others {
            if first.name != other.name || !same.unify_all(&first.args, &other.args) {
                return false;
            }
        }
    }
    for clause in &known {
        if let Clause::Equal(true, x, y) = clause
            && !same.unify(x, y)
        {
            return false;
        }
    }
    !same.equal(&a.add.fact, &with_terms(&b.add.fact, other)) && !contradictory(&known, &same)
}

/// Whether both of two additions that are taken for the same can happen at all.
fn contradictory(known: &[Clause], same: &Unifier) -> bool {
    known.iter().any(|clause| match clause {
        Clause::Equal(false, x, y) => same.find(x) == same.find(y),
        Clause::Fact(false, absent) => known
            .iter()
            .any(|other| matches!(other, Clause::Fact(true, fact) if same.equal(fact, absent))),
        _ => false,
    })
}

impl Addition<'_> {
    /// Whether every other fact of the group, for the same values of the parameters, is gone
    /// afterwards.
    pub fn is_balanced(&self, group: &Group) -> bool {
        // If one is known to hold, there is no other: either it is the one that is added …
        let mut one_that_holds = self.facts_that_hold().filter(|fact| {
            let part = group.part(&fact.name);
            part.and_then(|part| part.parameters_in(&fact.args))
                .as_ref()
                == Some(&self.terms)
        });
        if one_that_holds.any(|fact| *fact == self.add.fact || self.takes_away(fact)) {
            return true;
        }
        // … or all are taken away that might be there, as far as they are not this very fact.
        group.parts().iter().all(|part| {
            let any = self.any_fact_of(group, &part.predicate);
            any == self.add.fact || self.takes_away(&any) || self.is_absent(&any)
        })
    }

    /// Facts that hold wherever this is added.
    fn facts_that_hold(&self) -> impl Iterator<Item = &Pattern> {
        self.known.iter().filter_map(|clause| match clause {
            Clause::Fact(true, fact) => Some(fact),
            _ => None,
        })
    }

    /// Facts that hold wherever this is added, and are taken away then: what may balance it.
    pub fn taken_away(&self) -> impl Iterator<Item = &Pattern> {
        self.facts_that_hold().filter(|fact| self.takes_away(fact))
    }

    /// Whether it is added in any case.
    pub fn always_comes(&self) -> bool {
        self.add.over.is_empty() && self.add.when.is_empty()
    }

    /// The terms in the places of the group's parameters.
    pub fn terms(&self) -> &[Term] {
        &self.terms
    }

    /// Any fact of a predicate for the same values of the parameters. For the counted argument stands
    /// a variable that nothing else has.
    fn any_fact_of(&self, group: &Group, predicate: &Symbol) -> Pattern {
        let roles = group.part(predicate).map_or(&[][..], |part| &part.args);
        let args = roles.iter().map(|role| match role {
            Role::Parameter(index) => self.terms[*index].clone(),
            Role::Counted => Term::Variable(usize::MAX),
        });
        Pattern {
            name: predicate.clone(),
            args: args.collect(),
        }
    }

    /// The type of the objects that a term of `fact` may stand for.
    fn kind<'a>(&'a self, term: &'a Term, fact: &Pattern, place: usize) -> Option<&'a Symbol> {
        let own = self.schema.parameters.len();
        match term {
            Term::Constant(object) => self.domain.constants.get(object),
            Term::Variable(usize::MAX) => {
                let declared = self.domain.predicates.get(&fact.name)?.get(place);
                declared.map(|parameter| &parameter.kind)
            }
            Term::Variable(index) => {
                let all = self.schema.parameters.get(*index);
                let parameter = all.or_else(|| self.add.over.get(index.checked_sub(own)?));
                parameter.map(|parameter| &parameter.kind)
            }
        }
    }

    /// Whether `fact`, if it holds, is removed whenever this is added.
    fn takes_away(&self, fact: &Pattern) -> bool {
        self.schema.effect.remove.iter().any(|remove| {
            // Both under the same `forall` and the same `when`: they come together.
            if remove.over == self.add.over && remove.when == self.add.when && remove.fact == *fact
            {
                return true;
            }
            let Some(objects) = self.fits(&remove.fact, &remove.over, fact) else {
                return false;
            };
            let own = self.schema.parameters.len();
            let term = |term: &Term| match term {
                Term::Variable(index) if *index >= own => objects.get(index - own).cloned(),
                _ => Some(term.clone()),
            };
            remove.when.iter().all(|clause| {
                let clause = match clause {
                    Clause::Fact(holds, pattern) => {
                        let args: Option<_> = pattern.args.iter().map(term).collect();
                        let name = pattern.name.clone();
                        args.map(|args| Clause::Fact(*holds, Pattern { name, args }))
                    }
                    Clause::Equal(equal, x, y) => {
                        (term(x).zip(term(y))).map(|(x, y)| Clause::Equal(*equal, x, y))
                    }
                    _ => None,
                };
                clause.is_some_and(|clause| {
                    self.known.contains(&clause) || clause == Clause::Fact(true, fact.clone())
                })
            })
        })
    }

    /// Whether `fact` is known not to hold.
    fn is_absent(&self, fact: &Pattern) -> bool {
        self.known.contains(&Clause::Fact(false, fact.clone()))
            || (self.schema.absent.iter())
                .any(|(over, pattern)| self.fits(pattern, over, fact).is_some())
    }

    /// What `pattern`'s quantified variables stand for, so that it is `fact`; `None` if it need not
    /// be.
    fn fits(&self, pattern: &Pattern, over: &[Parameter], fact: &Pattern) -> Option<Vec<Term>> {
        if pattern.name != fact.name || pattern.args.len() != fact.args.len() {
            return None;
        }
        let own = self.schema.parameters.len();
        let mut objects: Vec<Option<Term>> = vec![None; over.len()];
        for (place, (term, wanted)) in pattern.args.iter().zip(&fact.args).enumerate() {
            match term {
                Term::Variable(index) if *index >= own => {
                    let object = objects.get_mut(index - own)?;
                    let kind = &over.get(index - own)?.kind;
                    match object {
                        Some(object) if object != wanted => return None,
                        Some(_) => {}
                        None if self
                            .kind(wanted, fact, place)
                            .is_some_and(|given| self.domain.is_a(given, kind)) =>
                        {
                            *object = Some(wanted.clone());
                        }
                        None => return None,
                    }
                }
                _ if term == wanted => {}
                _ => return None,
            }
        }
        // A variable that the fact does not bind might range over nothing.
        objects.into_iter().collect()
    }
}

fn is_plain(clause: &Clause) -> bool {
    matches!(clause, Clause::Fact(..) | Clause::Equal(..))
}

fn with_terms(pattern: &Pattern, term: impl Fn(&Term) -> Term) -> Pattern {
    Pattern {
        name: pattern.name.clone(),
        args: pattern.args.iter().map(term).collect(),
    }
}
