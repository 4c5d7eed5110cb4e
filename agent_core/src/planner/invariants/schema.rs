//! Everything that changes the world as an agent knows it: actions, and their suspensions.

use super::unify::Unifier;
use crate::model::{
    Change, Clause, Domain, Effect, ExecutionModel, Operator, Parameter, Pattern, Suspension, Term,
};

/// A precondition and an effect over the same variables.
#[derive(Clone, Debug)]
pub(super) struct Schema {
    /// Variables that the schema has; those of `forall` are numbered on from here.
    pub parameters: Vec<Parameter>,
    /// Facts that hold, or do not, wherever it happens, and inequalities. What else the condition
    /// says is left out.
    pub known: Vec<Clause>,
    /// Facts that no object in the place of the variables has, wherever it happens.
    pub absent: Vec<(Vec<Parameter>, Pattern)>,
    /// What it brings about.
    pub effect: Effect,
}

impl Schema {
    fn new(parameters: &[Parameter], conditions: &[Clause], effect: &Effect) -> Self {
        // What is equal is written as the same term, so that it is seen to be.
        let mut same = Unifier::default();
        for clause in conditions {
            if let Clause::Equal(true, a, b) = clause {
                // If two constants are said to be equal, it never happens.
                same.unify(a, b);
            }
        }
        let mut schema = Self {
            parameters: parameters.to_vec(),
            known: Vec::new(),
            absent: Vec::new(),
            effect: Effect {
                remove: each(&effect.remove, &same),
                add: each(&effect.add, &same),
            },
        };
        for clause in conditions {
            match renamed(clause, &same) {
                Some(clause) => schema.known.push(clause),
                None => schema.absent.extend(absences(clause, &same)),
            }
        }
        schema
    }
}

/// All schemata of a domain with an execution model.
///
/// A suspension happens while its action runs, or while the action runs that resumes it: in either case
/// from where that one began, since an action changes nothing before it ends. If something else has
/// changed the belief meanwhile, that was nothing that a planner predicted.
pub(super) fn schemata(domain: &Domain, model: &ExecutionModel) -> Vec<Schema> {
    let mut found = Vec::new();
    for operator in domain.operators.values() {
        let Operator {
            parameters,
            precondition,
            effect,
            ..
        } = operator;
        found.push(Schema::new(parameters, precondition, effect));
        let Some(suspension) = model
            .actions
            .get(&operator.name)
            .and_then(|model| model.suspension.as_ref())
        else {
            continue;
        };
        found.push(Schema::new(parameters, precondition, &suspension.effect));
        let resuming = precondition_of_resuming(domain, suspension, parameters.len());
        found.push(Schema::new(parameters, &resuming, &suspension.effect));
    }
    found
}

/// The plain part of the resuming action's precondition, in the words of the action that it resumes.
fn precondition_of_resuming(domain: &Domain, of: &Suspension, variables: usize) -> Vec<Clause> {
    let Some(operator) = domain.operators.get(&of.resume.name) else {
        return Vec::new();
    };
    let term = |term: &Term| match term {
        Term::Variable(index) => of.resume.args.get(*index).cloned(),
        Term::Constant(_) => Some(term.clone()),
    };
    let own = |term: &Term| match term {
        Term::Variable(index) => *index < variables,
        Term::Constant(_) => true,
    };
    let mut found = Vec::new();
    for clause in &operator.precondition {
        let clause = match clause {
            Clause::Fact(holds, pattern) => {
                let args: Option<Vec<Term>> = pattern.args.iter().map(term).collect();
                args.filter(|args| args.iter().all(own)).map(|args| {
                    let name = pattern.name.clone();
                    Clause::Fact(*holds, Pattern { name, args })
                })
            }
            Clause::Equal(holds, a, b) => {
                (term(a).zip(term(b))).map(|(a, b)| Clause::Equal(*holds, a, b))
            }
            _ => None,
        };
        found.extend(clause);
    }
    found
}

fn each(changes: &[Change], same: &Unifier) -> Vec<Change> {
    let rename = |change: &Change| Change {
        over: change.over.clone(),
        // Conditions with variables of their own stay as they are: they are compared as a whole.
        when: (change.when.iter())
            .map(|clause| renamed(clause, same).unwrap_or_else(|| clause.clone()))
            .collect(),
        fact: pattern(&change.fact, same),
    };
    changes.iter().map(rename).collect()
}

/// A plain clause with the terms that stand for its own; `None` if it is not plain.
fn renamed(clause: &Clause, same: &Unifier) -> Option<Clause> {
    match clause {
        Clause::Fact(holds, fact) => Some(Clause::Fact(*holds, pattern(fact, same))),
        Clause::Equal(holds, a, b) => Some(Clause::Equal(*holds, same.find(a), same.find(b))),
        Clause::Any(_) | Clause::Every(..) | Clause::Exists(..) => None,
    }
}

fn pattern(of: &Pattern, same: &Unifier) -> Pattern {
    Pattern {
        name: of.name.clone(),
        args: of.args.iter().map(|term| same.find(term)).collect(),
    }
}

/// `(forall (?x - node) (not (at ?x)))` as a condition.
fn absences(clause: &Clause, same: &Unifier) -> Vec<(Vec<Parameter>, Pattern)> {
    let Clause::Every(over, inner) = clause else {
        return Vec::new();
    };
    let absent = |clause: &Clause| match clause {
        Clause::Fact(false, fact) => Some((over.clone(), pattern(fact, same))),
        _ => None,
    };
    inner.iter().filter_map(absent).collect()
}
