//! What goes beyond facts that are added and removed in any case: how far the proof of resuming
//! goes there.

use super::DomainError;
use crate::model::{
    Change, Clause, Domain, Operator, Parameter, Pattern, Suspension, Symbol, Term,
};

/// A clause about the parameters of `resuming` as one about those of `operator`, whose quantified
/// variables have no names.
pub(super) fn renamed(
    clause: &Clause,
    args: &[Term],
    resuming: &Operator,
    operator: &Operator,
) -> Clause {
    let term = |term: &Term| match term {
        Term::Variable(index) => args.get(*index).cloned().unwrap_or_else(|| {
            let quantified = index - resuming.parameters.len().min(*index);
            Term::Variable(operator.parameters.len() + quantified)
        }),
        Term::Constant(_) => term.clone(),
    };
    let all = |inner: &[Clause]| -> Vec<Clause> {
        let inner = inner.iter();
        inner
            .map(|clause| renamed(clause, args, resuming, operator))
            .collect()
    };
    let nameless = |variables: &[Parameter]| -> Vec<Parameter> {
        let variables = variables.iter();
        variables
            .map(|variable| Parameter {
                name: Symbol::from(""),
                kind: variable.kind.clone(),
            })
            .collect()
    };
    match clause {
        Clause::Fact(holds, pattern) => Clause::Fact(
            *holds,
            Pattern {
                name: pattern.name.clone(),
                args: pattern.args.iter().map(term).collect(),
            },
        ),
        Clause::Equal(holds, left, right) => Clause::Equal(*holds, term(left), term(right)),
        Clause::Any(choices) => Clause::Any(choices.iter().map(|choice| all(choice)).collect()),
        Clause::Every(variables, inner) => Clause::Every(nameless(variables), all(inner)),
        Clause::Exists(variables, inner) => Clause::Exists(nameless(variables), all(inner)),
    }
}

/// Effects of which nothing can be proved here: those that depend on the state, and those that
/// range over some objects of a predicate and not over all.
pub(super) fn unproved(
    domain: &Domain,
    operator: &Operator,
    suspension: &Suspension,
    resuming: &Operator,
) -> Vec<DomainError> {
    let own = operator.parameters.len();
    let parts = [
        (format!("`{}`", operator.name), &operator.effect, own),
        (String::from("the suspension"), &suspension.effect, own),
        (
            format!("`{}`", resuming.name),
            &resuming.effect,
            resuming.parameters.len(),
        ),
    ];
    let unproved = parts.into_iter().filter(|(_, effect, own)| {
        let add = effect.add.iter();
        let mut add = add.map(|change| change.when.is_empty() && change.over.is_empty());
        let mut remove = effect.remove.iter();
        !add.all(|plain| plain) || !remove.all(|change| removes_all(domain, change, *own))
    });
    unproved
        .map(|(whose, _, _)| DomainError::Unproved {
            key: format!("action.{}.suspension", operator.name),
            action: operator.name.clone(),
            whose,
        })
        .collect()
}

/// Whether a change depends on nothing, and its quantified variables range over all that can stand
/// in their places.
fn removes_all(domain: &Domain, change: &Change, own: usize) -> bool {
    let declared = domain.predicates.get(&change.fact.name);
    let covers = |(variable, index): (&Parameter, usize)| {
        let places = change.fact.args.iter().enumerate();
        let mut places = places.filter(|(_, term)| **term == Term::Variable(index));
        let (Some((place, _)), None) = (places.next(), places.next()) else {
            return false;
        };
        let wanted = declared.and_then(|declared| declared.get(place));
        wanted.is_some_and(|wanted| domain.is_a(&wanted.kind, &variable.kind))
    };
    change.when.is_empty() && change.over.iter().zip(own..).all(covers)
}
