//! Random domains and problems, small enough for the oracle, with everything the language has.

use super::super::hash::spread;

/// Numbers from a seed: the same seed, the same numbers.
pub struct Chance(u64);

impl Chance {
    pub fn new(seed: u64) -> Self {
        Self(spread(seed))
    }

    /// Less than `end`.
    pub fn below(&mut self, end: usize) -> usize {
        self.0 = spread(self.0);
        (self.0 % end as u64) as usize
    }

    fn of<'a, T>(&mut self, choices: &'a [T]) -> &'a T {
        &choices[self.below(choices.len())]
    }

    fn one_in(&mut self, count: usize) -> bool {
        self.below(count) == 0
    }
}

const PREDICATES: &[(&str, &[&str])] = &[
    ("p", &[]),
    ("q", &[]),
    ("r", &["a"]),
    ("s", &["a", "b"]),
    ("t", &["b"]),
    ("u", &["c"]),
];
const TASKS: &[(&str, &[&str])] = &[("t0", &[]), ("t1", &["a"]), ("t2", &["c", "b"])];
const OBJECTS: &[(&str, &str)] = &[("a1", "a"), ("a2", "a"), ("b1", "b"), ("b2", "b")];

/// Names with their types: the variables in scope.
type Scope = Vec<(String, &'static str)>;

/// Texts of a domain and a problem.
pub fn problem(seed: u64) -> (String, String) {
    let mut chance = Chance::new(seed);
    let mut domain = String::from(
        "(define (domain random) (:requirements :hierarchy :typing :adl)\n\
         (:types a b - c)\n(:constants",
    );
    for (name, kind) in OBJECTS {
        domain += &format!(" {name} - {kind}");
    }
    domain += ")\n(:predicates";
    for (name, kinds) in PREDICATES {
        domain += &format!(" ({name}{})", parameters(&scope(kinds)));
    }
    domain += ")\n";
    for (name, kinds) in TASKS {
        domain += &format!(
            "(:task {name} :parameters ({}))\n",
            parameters(&scope(kinds))
        );
    }
    let mut steps: Vec<(String, Vec<&str>)> = TASKS
        .iter()
        .map(|(name, kinds)| ((*name).to_owned(), kinds.to_vec()))
        .collect();
    for number in 0..4 {
        let kinds: Vec<&str> = (0..chance.below(3))
            .map(|_| *chance.of(&["a", "b", "c"]))
            .collect();
        let own = scope(&kinds);
        let condition = condition(&mut chance, &own, 2, 0);
        let effect = effect(&mut chance, &own);
        domain += &format!(
            "(:action act{number} :parameters ({}) :precondition {condition} :effect {effect})\n",
            parameters(&own)
        );
        // Actions are more frequent than tasks, so that not everything goes on for ever.
        for _ in 0..2 {
            steps.push((format!("act{number}"), kinds.clone()));
        }
    }
    let mut number = 0;
    for (task, kinds) in TASKS {
        for _ in 0..2 + chance.below(2) {
            let mut own = scope(kinds);
            let mut head: Vec<String> = own.iter().map(|(name, _)| name.clone()).collect();
            if head.len() == 2 && chance.one_in(6) {
                // One variable twice, or an object.
                head[0] = if chance.one_in(2) {
                    "?x1".into()
                } else {
                    "a1".into()
                };
            }
            for extra in 0..chance.below(3) {
                own.push((format!("?y{extra}"), *chance.of(&["a", "b", "c"])));
            }
            let condition = condition(&mut chance, &own, 2, 0);
            let subtasks = subtasks(&mut chance, &own, &steps, 3);
            domain += &format!(
                "(:method m{number} :parameters ({}) :task ({task} {}) :precondition {condition} \
                 :ordered-subtasks (and {subtasks}))\n",
                parameters(&own),
                head.join(" ")
            );
            number += 1;
        }
    }
    domain += ")\n";
    (domain, instance(&mut chance, &steps))
}

fn instance(chance: &mut Chance, steps: &[(String, Vec<&str>)]) -> String {
    let mut text = String::from("(define (problem one) (:domain random)\n");
    let own: Scope = if chance.one_in(2) {
        vec![("?z".to_owned(), *chance.of(&["a", "b", "c"]))]
    } else {
        Vec::new()
    };
    let tasks = subtasks(chance, &own, &steps[..TASKS.len()], 2);
    text += &format!(
        "(:htn :parameters ({}) :ordered-subtasks (and (t0) {tasks}))\n(:init",
        parameters(&own)
    );
    for (name, kinds) in PREDICATES {
        for _ in 0..2 {
            if chance.one_in(2) {
                text += &format!(" ({name}{})", terms(chance, &Vec::new(), kinds));
            }
        }
    }
    text += ")\n";
    if chance.one_in(2) {
        text += &format!("(:goal {})", condition(chance, &Vec::new(), 2, 0));
    }
    text + ")\n"
}

fn scope(kinds: &[&'static str]) -> Scope {
    let numbered = kinds.iter().enumerate();
    numbered
        .map(|(place, kind)| (format!("?x{place}"), *kind))
        .collect()
}

fn parameters(scope: &Scope) -> String {
    scope
        .iter()
        .map(|(name, kind)| format!(" {name} - {kind}"))
        .collect()
}

/// Variables in scope of fitting types, or objects.
fn terms(chance: &mut Chance, scope: &Scope, kinds: &[&str]) -> String {
    let mut text = String::new();
    for wanted in kinds {
        let fits = |kind: &str| *wanted == "c" || kind == *wanted;
        let mut choices: Vec<&str> = scope
            .iter()
            .filter(|(_, kind)| fits(kind))
            .flat_map(|(name, _)| [name.as_str(), name.as_str()])
            .collect();
        choices.extend(
            OBJECTS
                .iter()
                .filter(|(_, kind)| fits(kind))
                .map(|(name, _)| name),
        );
        text += &format!(" {}", chance.of(&choices));
    }
    text
}

fn fact(chance: &mut Chance, scope: &Scope) -> String {
    let (name, kinds) = chance.of(PREDICATES);
    format!("({name}{})", terms(chance, scope, kinds))
}

fn literal(chance: &mut Chance, scope: &Scope) -> String {
    let fact = fact(chance, scope);
    if chance.one_in(3) {
        format!("(not {fact})")
    } else {
        fact
    }
}

fn condition(chance: &mut Chance, scope: &Scope, most: usize, depth: usize) -> String {
    let mut text = String::from("(and");
    for _ in 0..chance.below(most + 1) {
        text.push(' ');
        text += &clause(chance, scope, depth);
    }
    text + ")"
}

fn clause(chance: &mut Chance, scope: &Scope, depth: usize) -> String {
    if depth > 1 || !chance.one_in(4) {
        return literal(chance, scope);
    }
    match chance.below(5) {
        0 => format!(
            "(or {} {})",
            clause(chance, scope, depth + 1),
            condition(chance, scope, 2, depth + 1)
        ),
        1 => format!(
            "(imply {} {})",
            clause(chance, scope, depth + 1),
            clause(chance, scope, depth + 1)
        ),
        2 => {
            let (one, other) = (terms(chance, scope, &["c"]), terms(chance, scope, &["c"]));
            let equal = format!("(={one}{other})");
            if chance.one_in(2) {
                equal
            } else {
                format!("(not {equal})")
            }
        }
        quantifier => {
            let name = format!("?w{depth}");
            let kind = *chance.of(&["a", "b", "c"]);
            let inner = [&scope[..], &[(name.clone(), kind)]].concat();
            let word = if quantifier == 3 { "forall" } else { "exists" };
            format!(
                "({word} ({name} - {kind}) {})",
                condition(chance, &inner, 2, depth + 1)
            )
        }
    }
}

fn effect(chance: &mut Chance, scope: &Scope) -> String {
    let mut text = String::from("(and");
    for _ in 0..1 + chance.below(2) {
        text.push(' ');
        text += &match chance.below(6) {
            0 => format!(
                "(when {} {})",
                literal(chance, scope),
                literal(chance, scope)
            ),
            1 => {
                let kind = *chance.of(&["a", "b", "c"]);
                let inner = [&scope[..], &[("?v".to_owned(), kind)]].concat();
                let literal = literal(chance, &inner);
                if chance.one_in(2) {
                    format!("(forall (?v - {kind}) {literal})")
                } else {
                    let when = condition(chance, &inner, 1, 2);
                    format!("(forall (?v - {kind}) (when {when} {literal}))")
                }
            }
            _ => literal(chance, scope),
        };
    }
    text + ")"
}

fn subtasks(
    chance: &mut Chance,
    scope: &Scope,
    steps: &[(String, Vec<&str>)],
    most: usize,
) -> String {
    let mut text = String::new();
    for _ in 0..chance.below(most + 1) {
        let (name, kinds) = chance.of(steps).clone();
        text += &format!(" ({name}{})", terms(chance, scope, &kinds));
    }
    text
}
