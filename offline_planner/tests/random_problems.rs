//! Random small problems: what the planner says is held against the judge of plans, and against
//! plans that are found by trying all sequences of actions, shortest first.
#![allow(clippy::panic, reason = "a test that cannot go on has failed")]

use std::fmt::Write;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use agent_core::language::{parse_domain, parse_problem};
use offline_planner::{Options, Solution, Verdict, solve};
use plan_checker::{Kind, check, check_sequence};

/// Small, repeatable chance.
struct Chance(u64);

impl Chance {
    fn below(&mut self, limit: usize) -> usize {
        // Steele and Vigna's splitmix64.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        usize::try_from((mixed ^ (mixed >> 31)) % limit as u64).unwrap_or(0)
    }

    fn one_in(&mut self, many: usize) -> bool {
        self.below(many) == 0
    }

    fn among<'a>(&mut self, things: &[&'a str]) -> &'a str {
        things[self.below(things.len())]
    }
}

const OBJECTS: [&str; 3] = ["a", "b", "c"];

/// A domain and a problem; and the names of the actions with how many arguments each takes.
struct Problem {
    domain: String,
    problem: String,
    actions: Vec<(String, usize)>,
}

impl Problem {
    fn random(seed: u64) -> Self {
        let mut chance = Chance(seed);
        let actions: Vec<(String, usize)> = (0..2 + chance.below(3))
            .map(|index| (format!("act{index}"), chance.below(3)))
            .collect();
        let tasks: Vec<(String, usize)> = (0..1 + chance.below(3))
            .map(|index| (format!("task{index}"), chance.below(3)))
            .collect();
        let mut domain = "(define (domain random)
  (:types thing - object special - thing)
  (:constants a - thing)
  (:predicates (p ?x - thing) (q ?x ?y - thing) (r))
"
        .to_owned();
        for (name, parameters) in &tasks {
            let parameters = typed(&variables(*parameters));
            domain += &format!("  (:task {name} :parameters ({parameters}))\n");
        }
        for (task, arity) in &tasks {
            for index in 0..1 + chance.below(3) {
                domain += &method(&mut chance, task, *arity, index, &tasks, &actions);
            }
        }
        for (name, arity) in &actions {
            let scope = variables(*arity);
            let condition = conjunction(&mut chance, &scope, 3);
            let effect = effect(&mut chance, &scope);
            let _ = write!(
                domain,
                "  (:action {name} :parameters ({})\n    :precondition {condition}\n    :effect {effect})\n",
                typed(&scope)
            );
        }
        domain += ")\n";
        let mut problem = "(define (problem random-one) (:domain random)
  (:objects b - thing c - special)\n"
            .to_owned();
        let calls: String = (0..1 + chance.below(2))
            .map(|_| call(&mut chance, &tasks, &OBJECTS))
            .collect();
        let _ = write!(
            problem,
            "  (:htn :ordered-subtasks (and {calls}))\n  (:init"
        );
        for fact in [
            "(r)", "(p a)", "(p b)", "(p c)", "(q a b)", "(q b c)", "(q c a)", "(q b b)",
        ] {
            if chance.one_in(2) {
                problem += &format!(" {fact}");
            }
        }
        problem += ")\n";
        if chance.one_in(2) {
            let goal = literal(&mut chance, &OBJECTS);
            problem += &format!("  (:goal {goal})");
        }
        problem += ")\n";
        Self {
            domain,
            problem,
            actions,
        }
    }

    fn text(&self) -> String {
        format!("{}\n{}", self.domain, self.problem)
    }

    /// The fewest actions that make a plan, if that many or fewer do.
    fn shortest(&self, most: usize) -> Option<usize> {
        let ground = self.ground();
        let mut prefixes = vec![String::new()];
        for length in 0..=most {
            let mut longer = Vec::new();
            for prefix in prefixes {
                match check_sequence(&self.domain, &self.problem, &prefix) {
                    Ok(_) => return Some(length),
                    // No continuation can mend this.
                    Err(faults) if faults[0].kind == Kind::Precondition => continue,
                    Err(faults) if faults[0].kind == Kind::WrongArguments => continue,
                    Err(_) => longer.extend(ground.iter().map(|each| format!("{prefix}{each}\n"))),
                }
            }
            prefixes = longer;
        }
        None
    }

    fn ground(&self) -> Vec<String> {
        let mut ground = Vec::new();
        for (name, arity) in &self.actions {
            for number in 0..OBJECTS.len().pow(u32::try_from(*arity).unwrap_or(0)) {
                let mut text = format!("({name}");
                let mut rest = number;
                for _ in 0..*arity {
                    text += &format!(" {}", OBJECTS[rest % OBJECTS.len()]);
                    rest /= OBJECTS.len();
                }
                ground.push(text + ")");
            }
        }
        ground
    }
}

fn variables(count: usize) -> Vec<&'static str> {
    ["?x", "?y", "?z"][..count].to_vec()
}

fn typed(variables: &[&str]) -> String {
    let each = variables
        .iter()
        .map(|variable| format!("{variable} - thing "));
    each.collect()
}

/// A method that may have one variable more than its task.
fn method(
    chance: &mut Chance,
    task: &str,
    arity: usize,
    index: usize,
    tasks: &[(String, usize)],
    actions: &[(String, usize)],
) -> String {
    let scope = variables(arity + chance.below(2));
    let condition = conjunction(chance, &scope, 2);
    let mut terms = scope.clone();
    terms.push("a");
    let mut subtasks = String::new();
    for _ in 0..chance.below(4) {
        let among = if chance.one_in(3) { tasks } else { actions };
        subtasks += &call(chance, among, &terms);
    }
    let special = if chance.one_in(4) { "special" } else { "thing" };
    let parameters = typed(&scope);
    let parameters = match parameters.rfind("thing") {
        Some(place) => format!("{}{special}", &parameters[..place]),
        None => parameters,
    };
    format!(
        "  (:method {task}-{index} :parameters ({parameters}) :task ({task} {})\n    \
         :precondition {condition}\n    :ordered-subtasks (and {subtasks}))\n",
        scope[..arity].join(" ")
    )
}

fn call(chance: &mut Chance, among: &[(String, usize)], terms: &[&str]) -> String {
    let (name, arity) = &among[chance.below(among.len())];
    let arguments: Vec<&str> = (0..*arity).map(|_| chance.among(terms)).collect();
    format!("({name} {})", arguments.join(" "))
}

fn fact(chance: &mut Chance, terms: &[&str]) -> String {
    match chance.below(if terms.is_empty() { 1 } else { 3 }) {
        0 => "(r)".to_owned(),
        1 => format!("(p {})", chance.among(terms)),
        _ => format!("(q {} {})", chance.among(terms), chance.among(terms)),
    }
}

fn literal(chance: &mut Chance, terms: &[&str]) -> String {
    let fact = fact(chance, terms);
    if chance.one_in(3) {
        format!("(not {fact})")
    } else {
        fact
    }
}

fn conjunction(chance: &mut Chance, terms: &[&str], most: usize) -> String {
    let mut text = "(and".to_owned();
    for _ in 0..chance.below(most) {
        let part = literal(chance, terms);
        let other = literal(chance, terms);
        let mut inner = terms.to_vec();
        inner.push("?w");
        text += &match chance.below(8) {
            0 => format!(" (or {part} {other})"),
            1 => format!(" (imply {part} {other})"),
            2 => format!(" (forall (?w - thing) {})", literal(chance, &inner)),
            3 => format!(" (exists (?w - special) {})", literal(chance, &inner)),
            4 if terms.len() > 1 => format!(" (not (= {} {}))", terms[0], terms[1]),
            _ => format!(" {part}"),
        };
    }
    text + ")"
}

fn effect(chance: &mut Chance, terms: &[&str]) -> String {
    let mut text = "(and".to_owned();
    for _ in 0..1 + chance.below(2) {
        let change = literal(chance, terms);
        let mut inner = terms.to_vec();
        inner.push("?w");
        text += &match chance.below(6) {
            0 => format!(" (when {} {change})", literal(chance, terms)),
            1 => format!(" (forall (?w - thing) {})", literal(chance, &inner)),
            _ => format!(" {change}"),
        };
    }
    text + ")"
}

fn planned(problem: &Problem, optimal: bool) -> Verdict {
    let domain = parse_domain(&problem.domain);
    let domain = domain.unwrap_or_else(|errors| panic!("{errors:?}\n{}", problem.text()));
    let instance = parse_problem(&problem.problem, &domain);
    let instance = instance.unwrap_or_else(|errors| panic!("{errors:?}\n{}", problem.text()));
    let options = Options {
        time_limit: Some(Duration::from_millis(50)),
        optimal,
        ..Options::default()
    };
    let stop = AtomicBool::new(false);
    solve(&domain, &instance, &options, &stop, &mut |_| ()).expect("what was read from text fits")
}

fn judged(problem: &Problem, solution: &Solution, seed: u64) {
    let mut plan = Vec::new();
    solution.write(&mut plan).expect("memory takes all");
    let plan = String::from_utf8(plan).expect("plans are text");
    let report = check(&problem.domain, &problem.problem, &plan).unwrap_or_else(|faults| {
        panic!("seed {seed}: {faults:?}\n{plan}\n{}", problem.text());
    });
    assert_eq!(report.actions, solution.length(), "seed {seed}");
    let sequence = check_sequence(&problem.domain, &problem.problem, &plan);
    assert!(sequence.is_ok(), "seed {seed}: {sequence:?}\n{plan}");
}

#[test]
fn what_the_planner_says_of_random_problems_is_true() {
    let mut plans = 0;
    let mut unsolvable = 0;
    let mut optimal_plans = 0;
    for seed in 0..seeds() {
        let problem = Problem::random(seed);
        for optimal in [false, true] {
            match planned(&problem, optimal) {
                Verdict::Plan(solution) => {
                    plans += 1;
                    optimal_plans += u64::from(solution.optimal);
                    judged(&problem, &solution, seed);
                    if solution.optimal
                        && let Some(shortest) = problem.shortest(2)
                    {
                        let length = solution.length();
                        assert_eq!(length, shortest, "seed {seed}\n{}", problem.text());
                    }
                }
                Verdict::Unsolvable(why) => {
                    unsolvable += 1;
                    let shortest = problem.shortest(2);
                    assert_eq!(shortest, None, "seed {seed}: {why}\n{}", problem.text());
                }
                // Some of these problems go on for ever.
                Verdict::Unknown(_) => (),
            }
        }
    }
    let counts = format!("{plans} plans, {optimal_plans} optimal, {unsolvable} unsolvable");
    assert!(plans > seeds() / 4 && unsolvable > seeds() / 4, "{counts}");
    assert!(optimal_plans > seeds() / 8, "{counts}");
}

/// How many problems; `RANDOM_PROBLEMS` asks for another number.
fn seeds() -> u64 {
    let wanted = std::env::var("RANDOM_PROBLEMS").ok();
    wanted.and_then(|number| number.parse().ok()).unwrap_or(120)
}
