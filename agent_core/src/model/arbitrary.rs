//! Random domains and instances, for property tests.
//!
//! Everything in them is declared, and is written as the reader of the language leaves it. Nobody
//! has made sure that they can be solved.

use std::collections::BTreeMap;

use super::{
    Atom, Change, Clause, Condition, Domain, Effect, FactChange, Instance, Method, Number,
    Operator, Parameter, Pattern, Symbol, Term,
};

/// A stream of choices, so that a failing case shrinks to few and small ones. At its end every
/// choice is the first.
pub(crate) struct Choices<'a>(std::slice::Iter<'a, u16>);

impl<'a> Choices<'a> {
    pub(crate) fn new(from: &'a [u16]) -> Self {
        Self(from.iter())
    }

    /// One of `0..count`.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        let choice = self.0.next().copied().unwrap_or_default();
        usize::from(choice) % count.max(1)
    }

    fn one<'t, T>(&mut self, of: &'t [T]) -> Option<&'t T> {
        of.get(self.below(of.len()))
    }
}

fn names(prefix: &str, count: usize) -> impl Iterator<Item = Symbol> + use<> {
    let prefix = prefix.to_owned();
    (0..count).map(move |index| Symbol::from(format!("{prefix}{index}")))
}

/// A domain in which every sort of thing may occur.
pub(crate) fn domain(choices: &mut Choices<'_>) -> Domain {
    let mut domain = Domain {
        name: Symbol::from("random"),
        ..Domain::default()
    };
    let mut above = vec![Symbol::from("object")];
    for kind in names("kind", 1 + choices.below(4)) {
        let over = above[choices.below(above.len())].clone();
        domain.types.insert(kind.clone(), over);
        above.push(kind);
    }
    for constant in names("constant", choices.below(3)) {
        let kind = kind(&mut domain, choices);
        domain.constants.insert(constant, kind);
    }
    for predicate in names("predicate", 1 + choices.below(4)) {
        let parameters = parameters("?p", choices.below(4), &mut domain, choices);
        domain.predicates.insert(predicate, parameters);
    }
    for function in names("function", choices.below(3)) {
        let parameters = parameters("?f", choices.below(3), &mut domain, choices);
        domain.functions.insert(function, parameters);
    }
    for task in names("task", 1 + choices.below(3)) {
        let parameters = parameters("?t", choices.below(3), &mut domain, choices);
        domain.tasks.insert(task, parameters);
    }
    let actions: Vec<Symbol> = names("action", 1 + choices.below(3)).collect();
    for name in &actions {
        let parameters = parameters("?a", choices.below(4), &mut domain, choices);
        let operator = Operator {
            name: name.clone(),
            parameters,
            precondition: Condition::new(),
            effect: Effect::default(),
            cost: Number::Constant(0.0),
        };
        domain.operators.insert(name.clone(), operator);
    }
    for name in &actions {
        let Some(mut operator) = domain.operators.remove(name) else {
            continue;
        };
        let own = operator.parameters.clone();
        operator.precondition = condition(&mut domain, &own, 2, choices);
        operator.effect = effect(&mut domain, &own, choices);
        if choices.below(2) == 1 {
            operator.cost = number(&domain, &own, 2, choices);
        }
        domain.operators.insert(name.clone(), operator);
    }
    for name in names("method", choices.below(5)) {
        domain
            .methods
            .extend(method(name, &mut domain.clone(), choices));
    }
    // Of methods it is a copy that has noted their unions.
    note_unions(&mut domain);
    domain
}

/// An instance of `domain`.
pub(crate) fn instance(domain: &Domain, choices: &mut Choices<'_>) -> Instance {
    let mut all = domain.clone();
    let mut instance = Instance {
        name: Symbol::from("some"),
        domain: domain.name.clone(),
        ..Instance::default()
    };
    let kinds: Vec<Symbol> = domain.types.keys().cloned().collect();
    for object in names("object", choices.below(5)) {
        let kind = choices
            .one(&kinds)
            .cloned()
            .unwrap_or_else(|| Symbol::from("object"));
        instance.objects.insert(object.clone(), kind.clone());
        all.constants.insert(object, kind);
    }
    for _ in 0..choices.below(12) {
        if let Some(fact) = fact(&all, &all.predicates, choices) {
            instance.init.apply(&FactChange::Add(fact));
        }
    }
    for _ in 0..choices.below(4) {
        if let Some(function) = fact(&all, &all.functions, choices) {
            let value = decimal(choices);
            instance.init.apply(&FactChange::Set(function, value));
        }
    }
    instance.parameters = names("?h", choices.below(3))
        .map(|name| Parameter {
            name,
            kind: choices
                .one(&kinds)
                .cloned()
                .unwrap_or_else(|| Symbol::from("object")),
        })
        .collect();
    // Unions that the domain has not are none that a problem may have.
    let mut plain = Domain {
        types: all.types.clone(),
        constants: all.constants.clone(),
        predicates: all.predicates.clone(),
        ..Domain::default()
    };
    let own = instance.parameters.clone();
    instance.constraints = without_unions(condition(&mut plain, &own, 1, choices));
    instance.goal = without_unions(condition(&mut plain, &[], 2, choices));
    instance.tasks = steps(&all, &own, choices);
    instance
}

fn without_unions(condition: Condition) -> Condition {
    let mut plain = true;
    for clause in &condition {
        clause.each_quantified(&mut |variable| {
            plain &= !variable.kind.as_str().starts_with('(');
        });
    }
    if plain { condition } else { Condition::new() }
}

/// Keeps the unions that occur, since the reader knows of no others.
fn note_unions(domain: &mut Domain) {
    let mut found: Vec<Symbol> = domain.constants.values().cloned().collect();
    let mut note = |parameter: &Parameter| found.push(parameter.kind.clone());
    let lists = [&domain.predicates, &domain.functions, &domain.tasks];
    lists
        .into_iter()
        .flat_map(BTreeMap::values)
        .flatten()
        .for_each(&mut note);
    for operator in domain.operators.values() {
        operator.parameters.iter().for_each(&mut note);
        for change in operator.effect.remove.iter().chain(&operator.effect.add) {
            change.over.iter().for_each(&mut note);
            change
                .when
                .iter()
                .for_each(|clause| clause.each_quantified(&mut note));
        }
        operator
            .precondition
            .iter()
            .for_each(|clause| clause.each_quantified(&mut note));
    }
    for method in &domain.methods {
        method.parameters.iter().for_each(&mut note);
        method
            .precondition
            .iter()
            .for_each(|clause| clause.each_quantified(&mut note));
    }
    domain.unions = found
        .into_iter()
        .filter_map(|kind| {
            let members = kind.as_str().strip_prefix("(either ")?.strip_suffix(')')?;
            let members = members.split(' ').map(Symbol::from).collect();
            Some((kind, members))
        })
        .collect();
}

fn kind(domain: &mut Domain, choices: &mut Choices<'_>) -> Symbol {
    let kinds: Vec<Symbol> = domain.types.keys().cloned().collect();
    match choices.below(8) {
        0 => Symbol::from("object"),
        7 if kinds.len() > 1 => {
            let name = Symbol::from(format!("(either {} {})", kinds[0], kinds[1]));
            domain.unions.insert(name.clone(), kinds[..2].to_vec());
            name
        }
        _ => kinds[choices.below(kinds.len())].clone(),
    }
}

fn parameters(
    prefix: &str,
    count: usize,
    domain: &mut Domain,
    choices: &mut Choices<'_>,
) -> Vec<Parameter> {
    let mut out = Vec::new();
    for name in names(prefix, count) {
        let kind = kind(domain, choices);
        out.push(Parameter { name, kind });
    }
    out
}

/// Variables for a quantifier, with names that nobody in scope has.
fn inner(domain: &mut Domain, scope: &[Parameter], choices: &mut Choices<'_>) -> Vec<Parameter> {
    let mut out = Vec::new();
    for index in 0..1 + choices.below(2) {
        let name = Symbol::from(format!("?q{}", scope.len() + index));
        let kind = kind(domain, choices);
        out.push(Parameter { name, kind });
    }
    out
}

/// A condition as the reader leaves it: no choice with a single alternative, no quantifier over
/// nothing.
pub(crate) fn condition(
    domain: &mut Domain,
    scope: &[Parameter],
    depth: usize,
    choices: &mut Choices<'_>,
) -> Condition {
    let count = choices.below(3);
    (0..count)
        .filter_map(|_| clause(domain, scope, depth, choices))
        .collect()
}

fn some_condition(
    domain: &mut Domain,
    scope: &[Parameter],
    depth: usize,
    choices: &mut Choices<'_>,
) -> Condition {
    let mut found = condition(domain, scope, depth, choices);
    if found.is_empty() {
        found.extend(clause(domain, scope, 0, choices));
    }
    found
}

fn clause(
    domain: &mut Domain,
    scope: &[Parameter],
    depth: usize,
    choices: &mut Choices<'_>,
) -> Option<Clause> {
    let holds = choices.below(2) == 0;
    match choices.below(if depth == 0 { 6 } else { 9 }) {
        0..=4 => Some(Clause::Fact(
            holds,
            pattern(domain, &domain.predicates, scope, choices)?,
        )),
        5 => {
            let (left, right) = (term(domain, scope, choices)?, term(domain, scope, choices)?);
            Some(Clause::Equal(holds, left, right))
        }
        6 => {
            let alternatives: Vec<Condition> = (0..choices.below(3))
                .map(|_| some_condition(domain, scope, depth - 1, choices))
                .filter(|alternative| !alternative.is_empty())
                .collect();
            (alternatives.len() != 1).then_some(Clause::Any(alternatives))
        }
        which => {
            let variables = inner(domain, scope, choices);
            let scope = [scope, &variables].concat();
            let body = some_condition(domain, &scope, depth - 1, choices);
            Some(match which {
                7 if !body.is_empty() => Clause::Every(variables, body),
                _ => Clause::Exists(variables, body),
            })
        }
    }
}

fn term(domain: &Domain, scope: &[Parameter], choices: &mut Choices<'_>) -> Option<Term> {
    let constants: Vec<&Symbol> = domain.constants.keys().collect();
    let choice = choices.below(scope.len() + constants.len());
    match choice.checked_sub(scope.len()) {
        None => Some(Term::Variable(choice)),
        Some(constant) => Some(Term::Constant((*constants.get(constant)?).clone())),
    }
}

fn pattern(
    domain: &Domain,
    among: &BTreeMap<Symbol, Vec<Parameter>>,
    scope: &[Parameter],
    choices: &mut Choices<'_>,
) -> Option<Pattern> {
    let (name, declared) = among.iter().nth(choices.below(among.len()))?;
    let args = declared
        .iter()
        .map(|_| term(domain, scope, choices))
        .collect::<Option<_>>()?;
    Some(Pattern {
        name: name.clone(),
        args,
    })
}

fn fact(
    domain: &Domain,
    among: &BTreeMap<Symbol, Vec<Parameter>>,
    choices: &mut Choices<'_>,
) -> Option<Atom> {
    pattern(domain, among, &[], choices)?.ground(&[])
}

/// An effect that adds and removes, in any case or not, one fact or many.
pub(crate) fn effect(
    domain: &mut Domain,
    scope: &[Parameter],
    choices: &mut Choices<'_>,
) -> Effect {
    let mut effect = Effect::default();
    for _ in 0..choices.below(4) {
        let over = match choices.below(3) {
            2 => inner(domain, scope, choices),
            _ => Vec::new(),
        };
        let scope = [scope, &over].concat();
        let when = match choices.below(3) {
            2 => condition(domain, &scope, 1, choices),
            _ => Condition::new(),
        };
        let Some(fact) = pattern(domain, &domain.predicates, &scope, choices) else {
            continue;
        };
        let change = Change { over, when, fact };
        match choices.below(2) {
            0 => effect.add.push(change),
            _ => effect.remove.push(change),
        }
    }
    effect
}

fn decimal(choices: &mut Choices<'_>) -> f64 {
    let digits = u32::try_from(choices.below(10_000)).unwrap_or_default();
    f64::from(digits) / [1.0, 8.0, 10.0, 3.0][choices.below(4)]
}

fn number(domain: &Domain, scope: &[Parameter], depth: usize, choices: &mut Choices<'_>) -> Number {
    let function = pattern(domain, &domain.functions, scope, choices);
    let part = |choices: &mut Choices<'_>| number(domain, scope, depth - 1, choices);
    match (choices.below(if depth == 0 { 2 } else { 6 }), function) {
        (1, Some(function)) => Number::Function(function),
        (2, _) => Number::Sum((0..1 + choices.below(3)).map(|_| part(choices)).collect()),
        (3, _) => Number::Product((0..1 + choices.below(3)).map(|_| part(choices)).collect()),
        (4, _) => Number::Difference(Box::new(part(choices)), Box::new(part(choices))),
        (5, _) => Number::Quotient(
            Box::new(part(choices)),
            Box::new(Number::Constant(1.0 + decimal(choices))),
        ),
        _ => Number::Constant(decimal(choices)),
    }
}

fn steps(domain: &Domain, scope: &[Parameter], choices: &mut Choices<'_>) -> Vec<Pattern> {
    let operators = domain.operators.iter();
    let actions = operators.map(|(name, operator)| (name.clone(), operator.parameters.clone()));
    let tasks = domain.tasks.clone().into_iter();
    let all: BTreeMap<Symbol, Vec<Parameter>> = tasks.chain(actions).collect();
    let count = choices.below(4);
    (0..count)
        .filter_map(|_| pattern(domain, &all, scope, choices))
        .collect()
}

fn method(name: Symbol, domain: &mut Domain, choices: &mut Choices<'_>) -> Option<Method> {
    let parameters = parameters("?m", choices.below(4), domain, choices);
    Some(Method {
        name,
        task: pattern(domain, &domain.tasks, &parameters, choices)?,
        precondition: condition(domain, &parameters, 2, choices),
        subtasks: steps(domain, &parameters, choices),
        parameters,
    })
}
