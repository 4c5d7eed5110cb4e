//! Domains that nobody would write, for tests of what has to be so in all of them.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::{Item, Problem, Step, TaskList, simulate};
use crate::model::{
    Action, ActionModel, Belief, Change, Clause, Cost, Domain, Effect, ExecutionModel, Fact, Map,
    Number, Operator, Parameter, Pattern, Suspension, Symbol, Term,
};

/// Numbers that decide whatever is to be decided; when they are used up, the first choice.
pub(super) struct Choices<'t> {
    left: std::slice::Iter<'t, u16>,
}

impl<'t> Choices<'t> {
    /// The numbers of `tape`, one after the other.
    pub fn new(tape: &'t [u16]) -> Self {
        Self { left: tape.iter() }
    }

    pub fn below(&mut self, count: usize) -> usize {
        usize::from(self.left.next().copied().unwrap_or(0)) % count.max(1)
    }

    pub fn percent(&mut self, percent: usize) -> bool {
        self.below(100) >= 100 - percent
    }

    pub fn one_of<'a, T>(&mut self, of: &'a [T]) -> Option<&'a T> {
        of.get(self.below(of.len()))
    }
}

const TYPES: [&str; 3] = ["a", "b", "object"];
const OBJECTS: [(&str, &str); 4] = [("a1", "a"), ("a2", "a"), ("b1", "b"), ("b2", "b")];

fn parameter(index: usize, kind: &str) -> Parameter {
    Parameter {
        name: Symbol::from(format!("?v{index}")),
        kind: Symbol::from(kind),
    }
}

fn some_parameters(choices: &mut Choices<'_>, at_most: usize) -> Vec<Parameter> {
    let count = choices.below(at_most + 1);
    (0..count)
        .map(|index| parameter(index, TYPES[choices.below(3)]))
        .collect()
}

/// A fact over `scope`, as its predicate is declared; `None` if nothing fits.
fn some_fact(choices: &mut Choices<'_>, domain: &Domain, scope: &[Parameter]) -> Option<Pattern> {
    let predicates: Vec<_> = domain.predicates.iter().collect();
    let (name, declared) = choices.one_of(&predicates)?;
    let mut args = Vec::new();
    for wanted in declared.iter() {
        let mut fitting: Vec<Term> = (0..scope.len())
            .filter(|index| domain.is_a(&scope[*index].kind, &wanted.kind))
            .map(Term::Variable)
            .collect();
        if fitting.is_empty() || choices.percent(5) {
            let constants = domain.constants.iter();
            let of_kind = constants.filter(|(_, kind)| domain.is_a(kind, &wanted.kind));
            fitting = of_kind
                .map(|(name, _)| Term::Constant(name.clone()))
                .collect();
        }
        args.push(choices.one_of(&fitting)?.clone());
    }
    Some(Pattern {
        name: (*name).clone(),
        args,
    })
}

fn some_clause(choices: &mut Choices<'_>, domain: &Domain, scope: &[Parameter]) -> Option<Clause> {
    match choices.below(20) {
        0..=11 => Some(Clause::Fact(true, some_fact(choices, domain, scope)?)),
        12..=15 => Some(Clause::Fact(false, some_fact(choices, domain, scope)?)),
        16 | 17 if !scope.is_empty() => Some(Clause::Equal(
            choices.percent(30),
            Term::Variable(choices.below(scope.len())),
            Term::Variable(choices.below(scope.len())),
        )),
        18 => {
            let over = vec![parameter(scope.len(), TYPES[choices.below(3)])];
            let inner = [scope, &over].concat();
            let fact = some_fact(choices, domain, &inner)?;
            Some(Clause::Every(over, vec![Clause::Fact(false, fact)]))
        }
        _ => Some(Clause::Any(vec![
            vec![Clause::Fact(true, some_fact(choices, domain, scope)?)],
            vec![Clause::Fact(false, some_fact(choices, domain, scope)?)],
        ])),
    }
}

fn some_change(choices: &mut Choices<'_>, domain: &Domain, own: &[Parameter]) -> Option<Change> {
    let over = match choices.percent(35) {
        true => vec![parameter(own.len(), TYPES[choices.below(3)])],
        false => Vec::new(),
    };
    let scope = [own, &over].concat();
    let when = match choices.percent(20) {
        true => some_clause(choices, domain, &scope).into_iter().collect(),
        false => Vec::new(),
    };
    Some(Change {
        when,
        fact: some_fact(choices, domain, &scope)?,
        over,
    })
}

/// Mostly takes away what the condition wants, as the actions of real domains do.
fn some_effect(
    choices: &mut Choices<'_>,
    domain: &Domain,
    own: &[Parameter],
    condition: &[Clause],
) -> Effect {
    let mut effect = Effect::default();
    for clause in condition {
        if let Clause::Fact(true, fact) = clause
            && choices.percent(60)
        {
            effect.remove.push(Change::from(fact.clone()));
        }
    }
    for _ in 0..choices.below(3) {
        effect.remove.extend(some_change(choices, domain, own));
    }
    for _ in 0..=choices.below(2) {
        let mut add = some_change(choices, domain, own);
        // Things that are taken away and added under the same condition.
        if let (Some(add), Some(remove)) = (&mut add, effect.remove.last())
            && choices.percent(15)
        {
            let scope = [own, &remove.over].concat();
            if let Some(fact) = some_fact(choices, domain, &scope) {
                *add = Change {
                    fact,
                    ..remove.clone()
                };
            }
        }
        effect.add.extend(add);
    }
    effect
}

/// Some predicates, actions and suspensions over a handful of objects, which are its constants.
pub(super) fn some_domain(choices: &mut Choices<'_>) -> (Domain, ExecutionModel) {
    let object = Symbol::from("object");
    let mut domain = Domain {
        types: ["a", "b"]
            .map(|kind| (Symbol::from(kind), object.clone()))
            .into(),
        constants: OBJECTS
            .map(|(name, kind)| (Symbol::from(name), Symbol::from(kind)))
            .into(),
        ..Domain::default()
    };
    for index in 0..2 + choices.below(3) {
        let parameters = some_parameters(choices, 2);
        let name = Symbol::from(format!("p{index}"));
        domain.predicates.insert(name, parameters);
    }
    let mut model = ExecutionModel::default();
    for index in 0..1 + choices.below(3) {
        let parameters = some_parameters(choices, 3);
        let mut precondition = Vec::new();
        for _ in 0..choices.below(4) {
            precondition.extend(some_clause(choices, &domain, &parameters));
        }
        let effect = some_effect(choices, &domain, &parameters, &precondition);
        let name = Symbol::from(format!("act{index}"));
        let operator = Operator {
            name: name.clone(),
            cost: Number::Constant(1.0),
            parameters,
            precondition,
            effect,
        };
        domain.operators.insert(name, operator);
    }
    for operator in domain.operators.values() {
        if choices.percent(40)
            && let Some(suspension) = some_suspension(choices, &domain, operator)
        {
            let entry = ActionModel {
                suspension: Some(suspension),
                ..ActionModel::default()
            };
            model.actions.insert(operator.name.clone(), entry);
        }
    }
    (domain, model)
}

fn some_suspension(
    choices: &mut Choices<'_>,
    domain: &Domain,
    of: &Operator,
) -> Option<Suspension> {
    let all: Vec<&Operator> = domain.operators.values().collect();
    let resuming = choices.one_of(&all)?;
    let mut args = Vec::new();
    for wanted in &resuming.parameters {
        let fitting: Vec<usize> = (0..of.parameters.len())
            .filter(|index| domain.is_a(&of.parameters[*index].kind, &wanted.kind))
            .collect();
        args.push(Term::Variable(*choices.one_of(&fitting)?));
    }
    Some(Suspension {
        effect: some_effect(choices, domain, &of.parameters, &of.precondition),
        resume: Pattern {
            name: resuming.name.clone(),
            args,
        },
        rollback: None,
        reach: None,
    })
}

/// All ways to put objects of their types in the places of `parameters`.
pub(super) fn ground(domain: &Domain, parameters: &[Parameter]) -> Vec<Vec<Symbol>> {
    let mut found: Vec<Vec<Symbol>> = vec![Vec::new()];
    for parameter in parameters {
        let objects: Vec<&Symbol> = (domain.constants.iter())
            .filter(|(_, kind)| domain.is_a(kind, &parameter.kind))
            .map(|(object, _)| object)
            .collect();
        found = (found.iter())
            .flat_map(|args| {
                let with = |object: &&Symbol| [args.as_slice(), &[(*object).clone()]].concat();
                objects.iter().map(with).collect::<Vec<_>>()
            })
            .collect();
    }
    found
}

pub(super) fn all_facts(domain: &Domain) -> Vec<Fact> {
    let of = |(name, parameters): (&Symbol, &Vec<Parameter>)| {
        let fact = |args| Fact {
            name: name.clone(),
            args,
        };
        ground(domain, parameters)
            .into_iter()
            .map(fact)
            .collect::<Vec<_>>()
    };
    domain.predicates.iter().flat_map(of).collect()
}

/// The problem of acting in a belief, without a map.
pub(super) fn problem(
    domain: &Arc<Domain>,
    model: &Arc<ExecutionModel>,
    belief: &Belief,
) -> Problem {
    Problem {
        domain: domain.clone(),
        model: model.clone(),
        map: Arc::new(Map::default()),
        belief: Arc::new(belief.clone()),
        forbidden: BTreeSet::new(),
    }
}

/// A step that does just this.
pub(super) fn step(action: &Action) -> Step {
    Step {
        item: Item::Task(action.clone()),
        cost: Cost::ZERO,
        frame: None,
        rest: TaskList::empty(),
    }
}

/// Everything that can be done in a belief.
pub(super) fn possible(problem: &Problem) -> Vec<Action> {
    let mut found = Vec::new();
    for operator in problem.domain.operators.values() {
        let action = |args| Action {
            name: operator.name.clone(),
            args,
        };
        let actions = ground(&problem.domain, &operator.parameters)
            .into_iter()
            .map(action);
        found.extend(actions.filter(|action| can(problem, action)));
    }
    found
}

/// Whether the precondition holds.
pub(super) fn can(problem: &Problem, action: &Action) -> bool {
    simulate(problem, &[step(action)], false).is_ok()
}
