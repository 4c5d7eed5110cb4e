//! Domains and problems as text that the reader reads to the same thing.

mod expression;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use self::expression::{condition, effect, facts, pattern, typed};
use crate::model::{Domain, Instance, Method, Operator, Parameter, Pattern, Symbol};

/// Lines longer than this are broken where that is possible.
const WIDTH: usize = 100;

/// A domain in HDDL.
///
/// Reading it gives an equal domain, if this one was read, or could have been: its names are names
/// of the language, its numbers are finite, and nothing in it is nested nearly as deep as the
/// reader allows.
pub fn write_domain(domain: &Domain) -> String {
    let mut out = vec![requirements(domain)];
    out.extend(list(":types", typed_names(&domain.types)));
    out.extend(list(":constants", typed_names(&domain.constants)));
    out.extend(list(":predicates", declarations(&domain.predicates)));
    let functions = declarations(&domain.functions);
    let numbers = functions
        .into_iter()
        .map(|function| format!("{function} - number"));
    out.extend(list(":functions", numbers.collect()));
    for (name, parameters) in &domain.tasks {
        let parameters = parenthesised(typed(parameters));
        out.push(format!("(:task {name} :parameters {parameters})"));
    }
    out.extend(domain.methods.iter().map(method));
    out.extend(domain.operators.values().map(action));
    define(&format!("(domain {})", domain.name), out)
}

/// A problem in HDDL. As with [`write_domain`], reading it with its domain gives an equal one.
pub fn write_problem(instance: &Instance) -> String {
    let mut out = vec![format!("(:domain {})", instance.domain)];
    out.extend(list(":objects", typed_names(&instance.objects)));
    let mut network = vec![String::from("(:htn")];
    if !instance.parameters.is_empty() {
        let parameters = parenthesised(typed(&instance.parameters));
        network.push(format!(":parameters {parameters}"));
    }
    network.push(subtasks(&instance.tasks, &instance.parameters));
    if !instance.constraints.is_empty() {
        let constraints = condition(&instance.constraints, &instance.parameters);
        network.push(format!(":constraints {}", broken(constraints, 4)));
    }
    out.push(network.join("\n    ") + ")");
    out.extend(Some(section(":init", facts(&instance.init))));
    if !instance.goal.is_empty() {
        let goal = broken(condition(&instance.goal, &[]), 4);
        out.push(format!("(:goal {goal})"));
    }
    define(&format!("(problem {})", instance.name), out)
}

fn define(header: &str, sections: Vec<String>) -> String {
    format!("(define {header}\n  {})\n", sections.join("\n  "))
}

/// A section with one item a line.
fn section(keyword: &str, items: Vec<String>) -> String {
    let mut out = format!("({keyword}");
    for item in items {
        out.push_str("\n    ");
        out.push_str(&item);
    }
    out + ")"
}

fn list(keyword: &str, items: Vec<String>) -> Option<String> {
    (!items.is_empty()).then(|| section(keyword, items))
}

/// `room - place`
fn typed_names(names: &BTreeMap<Symbol, Symbol>) -> Vec<String> {
    let names = names.iter();
    names
        .map(|(name, kind)| format!("{name} - {kind}"))
        .collect()
}

/// `(at ?p - place)`
fn declarations(declared: &BTreeMap<Symbol, Vec<Parameter>>) -> Vec<String> {
    let declared = declared.iter();
    declared
        .map(|(name, parameters)| match typed(parameters) {
            none if none.is_empty() => format!("({name})"),
            typed => format!("({name} {typed})"),
        })
        .collect()
}

fn parenthesised(inner: String) -> String {
    format!("({inner})")
}

fn method(method: &Method) -> String {
    let scope = &method.parameters;
    let mut lines = vec![
        format!("(:method {}", method.name),
        format!(":parameters {}", parenthesised(typed(scope))),
        format!(":task {}", pattern(&method.task, scope)),
    ];
    if !method.precondition.is_empty() {
        let precondition = broken(condition(&method.precondition, scope), 4);
        lines.push(format!(":precondition {precondition}"));
    }
    lines.push(subtasks(&method.subtasks, scope));
    lines.join("\n    ") + ")"
}

fn action(operator: &Operator) -> String {
    let scope = &operator.parameters;
    let mut lines = vec![
        format!("(:action {}", operator.name),
        format!(":parameters {}", parenthesised(typed(scope))),
    ];
    if !operator.precondition.is_empty() {
        let precondition = broken(condition(&operator.precondition, scope), 4);
        lines.push(format!(":precondition {precondition}"));
    }
    let effect = broken(effect(operator), 4);
    lines.push(format!(":effect {effect}"));
    lines.join("\n    ") + ")"
}

fn subtasks(tasks: &[Pattern], scope: &[Parameter]) -> String {
    let tasks = tasks.iter().map(|task| pattern(task, scope)).collect();
    format!(":ordered-subtasks {}", broken(tasks, 4))
}

/// All parts, joined by `and`: on one line if there is room, or else one a line.
fn broken(parts: Vec<String>, indent: usize) -> String {
    let length: usize = parts.iter().map(|part| part.len() + 1).sum();
    match parts.as_slice() {
        [] => String::from("()"),
        [only] => only.clone(),
        _ if length + indent + 24 < WIDTH => format!("(and {})", parts.join(" ")),
        _ => {
            let separator = format!("\n{}", " ".repeat(indent + 2));
            format!("(and{separator}{})", parts.join(&separator))
        }
    }
}

/// What is used, for those who ask for it.
fn requirements(domain: &Domain) -> String {
    let mut found = expression::Features::default();
    found.domain(domain);
    format!("(:requirements {})", found.words().join(" "))
}
