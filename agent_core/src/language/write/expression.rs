//! Conditions, effects and numbers as text.

use crate::model::{
    Belief, Change, Clause, Condition, Domain, Number, Operator, Parameter, Pattern, Symbol, Term,
};

/// `?a ?b - room ?d - door`
pub(super) fn typed(parameters: &[Parameter]) -> String {
    let mut out = String::new();
    let mut parameters = parameters.iter().peekable();
    while let Some(parameter) = parameters.next() {
        if !out.is_empty() {
            out.push(' ');
        }
        out.push_str(parameter.name.as_str());
        if parameters
            .peek()
            .is_none_or(|next| next.kind != parameter.kind)
        {
            out.push_str(" - ");
            out.push_str(parameter.kind.as_str());
        }
    }
    out
}

/// `(at ?n)`
pub(super) fn pattern(pattern: &Pattern, scope: &[Parameter]) -> String {
    let mut out = format!("({}", pattern.name);
    for argument in &pattern.args {
        out.push(' ');
        out.push_str(term(argument, scope));
    }
    out + ")"
}

fn term<'a>(term: &'a Term, scope: &'a [Parameter]) -> &'a str {
    match term {
        Term::Variable(index) => scope
            .get(*index)
            .map_or("?undeclared", |parameter| parameter.name.as_str()),
        Term::Constant(name) => name.as_str(),
    }
}

/// All parts of a condition.
pub(super) fn condition(clauses: &[Clause], scope: &[Parameter]) -> Vec<String> {
    clauses.iter().map(|part| clause(part, scope)).collect()
}

/// A condition within another.
fn inner(clauses: &[Clause], scope: &[Parameter]) -> String {
    let parts = condition(clauses, scope);
    match parts.as_slice() {
        [] => String::from("()"),
        [only] => only.clone(),
        _ => format!("(and {})", parts.join(" ")),
    }
}

fn clause(clause: &Clause, scope: &[Parameter]) -> String {
    let signed = |holds: bool, text: String| match holds {
        true => text,
        false => format!("(not {text})"),
    };
    match clause {
        Clause::Fact(holds, fact) => signed(*holds, pattern(fact, scope)),
        Clause::Equal(holds, left, right) => {
            let (left, right) = (term(left, scope), term(right, scope));
            signed(*holds, format!("(= {left} {right})"))
        }
        Clause::Any(choices) => {
            let choices = choices
                .iter()
                .map(|choice| format!(" {}", inner(choice, scope)));
            format!("(or{})", choices.collect::<String>())
        }
        Clause::Every(variables, body) => quantified("forall", variables, body, scope),
        Clause::Exists(variables, body) => quantified("exists", variables, body, scope),
    }
}

fn quantified(word: &str, variables: &[Parameter], body: &[Clause], scope: &[Parameter]) -> String {
    let mentioned = |index| body.iter().any(|clause| mentions(clause, index));
    let variables = unshadowing(variables, scope, &mentioned);
    let scope = [scope, &variables].concat();
    format!("({word} ({}) {})", typed(&variables), inner(body, &scope))
}

/// The variables of a quantifier, so that none has the name of an outer one which is spoken of
/// within. Nobody can write such a thing; programs can make it.
fn unshadowing(
    variables: &[Parameter],
    scope: &[Parameter],
    mentioned: &dyn Fn(usize) -> bool,
) -> Vec<Parameter> {
    let mut out: Vec<Parameter> = Vec::new();
    for variable in variables {
        let mut name = variable.name.clone();
        let hides = |name: &Symbol| {
            let mut outer = scope.iter().enumerate();
            outer.any(|(index, outer)| outer.name == *name && mentioned(index))
        };
        let mut number = 2;
        while hides(&name) || out.iter().any(|other| other.name == name) {
            name = Symbol::from(format!("{}-{number}", variable.name));
            number += 1;
        }
        let kind = variable.kind.clone();
        out.push(Parameter { name, kind });
    }
    out
}

fn mentions(clause: &Clause, index: usize) -> bool {
    let is = |term: &Term| *term == Term::Variable(index);
    match clause {
        Clause::Fact(_, pattern) => pattern.args.iter().any(is),
        Clause::Equal(_, left, right) => is(left) || is(right),
        Clause::Any(choices) => choices.iter().flatten().any(|inner| mentions(inner, index)),
        Clause::Every(_, inner) | Clause::Exists(_, inner) => {
            inner.iter().any(|inner| mentions(inner, index))
        }
    }
}

/// What an action makes true or false, and what it costs.
pub(super) fn effect(operator: &Operator) -> Vec<String> {
    let scope = &operator.parameters;
    let remove = operator.effect.remove.iter();
    let remove = remove.map(|change| changed(change, scope, |fact| format!("(not {fact})")));
    let add = operator.effect.add.iter();
    let add = add.map(|change| changed(change, scope, |fact| fact));
    let cost = match &operator.cost {
        Number::Constant(nothing) if *nothing == 0.0 => None,
        cost => Some(format!("(increase (total-cost) {})", number(cost, scope))),
    };
    remove.chain(add).chain(cost).collect()
}

fn changed(change: &Change, scope: &[Parameter], sign: impl Fn(String) -> String) -> String {
    let mentioned = |index| {
        let fact = Clause::Fact(true, change.fact.clone());
        change
            .when
            .iter()
            .chain([&fact])
            .any(|clause| mentions(clause, index))
    };
    let over = unshadowing(&change.over, scope, &mentioned);
    let scope = [scope, &over].concat();
    let mut out = sign(pattern(&change.fact, &scope));
    if !change.when.is_empty() {
        out = format!("(when {} {out})", inner(&change.when, &scope));
    }
    if !over.is_empty() {
        out = format!("(forall ({}) {out})", typed(&over));
    }
    out
}

fn number(value: &Number, scope: &[Parameter]) -> String {
    let all = |sign: &str, parts: &[&Number]| {
        let parts = parts.iter().map(|part| format!(" {}", number(part, scope)));
        format!("({sign}{})", parts.collect::<String>())
    };
    let each = |parts: &[Number]| -> Vec<String> {
        parts.iter().map(|part| number(part, scope)).collect()
    };
    match value {
        Number::Constant(value) => value.to_string(),
        Number::Function(function) => pattern(function, scope),
        Number::Sum(parts) => format!("(+ {})", each(parts).join(" ")),
        Number::Product(parts) => format!("(* {})", each(parts).join(" ")),
        Number::Difference(left, right) => all("-", &[left, right]),
        Number::Quotient(left, right) => all("/", &[left, right]),
    }
}

/// Facts and values of functions.
pub(super) fn facts(belief: &Belief) -> Vec<String> {
    let facts = belief.facts().map(ToString::to_string);
    let values = belief.values();
    facts
        .chain(values.map(|(function, value)| format!("(= {function} {value})")))
        .collect()
}

/// What of the language a domain uses.
#[derive(Default)]
pub(super) struct Features {
    negative: bool,
    equality: bool,
    disjunctive: bool,
    universal: bool,
    existential: bool,
    conditional: bool,
    costs: bool,
}

impl Features {
    pub(super) fn domain(&mut self, domain: &Domain) {
        for method in &domain.methods {
            self.condition(&method.precondition);
        }
        for operator in domain.operators.values() {
            self.condition(&operator.precondition);
            self.costs |= operator.cost != Number::Constant(0.0);
            for change in operator.effect.remove.iter().chain(&operator.effect.add) {
                self.conditional |= !change.when.is_empty();
                self.universal |= !change.over.is_empty();
                self.condition(&change.when);
            }
        }
    }

    fn condition(&mut self, condition: &Condition) {
        for clause in condition {
            match clause {
                Clause::Fact(holds, _) => self.negative |= !holds,
                Clause::Equal(..) => self.equality = true,
                Clause::Any(choices) => {
                    self.disjunctive = true;
                    choices.iter().for_each(|choice| self.condition(choice));
                }
                Clause::Every(_, inner) => {
                    self.universal = true;
                    self.condition(inner);
                }
                Clause::Exists(_, inner) => {
                    self.existential = true;
                    self.condition(inner);
                }
            }
        }
    }

    pub(super) fn words(&self) -> Vec<&'static str> {
        let of = [
            (true, ":typing"),
            (true, ":hierarchy"),
            (true, ":method-preconditions"),
            (self.negative, ":negative-preconditions"),
            (self.equality, ":equality"),
            (self.disjunctive, ":disjunctive-preconditions"),
            (self.universal, ":universal-preconditions"),
            (self.existential, ":existential-preconditions"),
            (self.conditional, ":conditional-effects"),
            (self.costs, ":action-costs"),
        ];
        let used = of.into_iter().filter(|(used, _)| *used);
        used.map(|(_, word)| word).collect()
    }
}
