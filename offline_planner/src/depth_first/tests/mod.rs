//! Small problems written for the purpose, and random ones against an oracle.

mod against_oracle;
mod oracle;
mod random;
mod small;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64};

use agent_core::language::{parse_domain, parse_problem};
use agent_core::model::{Domain, Instance};

use super::{DepthFirst, Restarts};
use crate::compile::Compiled;
use crate::control::{Control, Outcome};
use crate::plan::Solution;

/// Both as the planner gets them; panics with the errors of what is not HDDL.
fn read(domain: &str, problem: &str) -> (Domain, Instance) {
    let read = parse_domain(domain).unwrap_or_else(|errors| panic!("{errors:?}\n{domain}"));
    let problem = parse_problem(problem, &read)
        .unwrap_or_else(|errors| panic!("{errors:?}\n{domain}\n{problem}"));
    (read, problem)
}

fn compiled(domain: &str, problem: &str) -> Arc<Compiled> {
    let (domain, problem) = read(domain, problem);
    Arc::new(Compiled::new(&domain, &problem).expect("what was read fits"))
}

/// Runs a search; it has no clock.
fn run(search: impl FnOnce(&Control<'_>) -> Outcome) -> Outcome {
    search(&Control {
        stop: &AtomicBool::new(false),
        deadline: None,
        memory_limit_bytes: 1 << 28,
        expanded: &AtomicU64::new(0),
        seed: 1,
    })
}

/// What the search comes to within so many dead ends.
fn depth_first(compiled: &Arc<Compiled>, patience: u64) -> Outcome {
    let mut search = DepthFirst::new(compiled);
    search.be_patient(patience);
    run(|control| search.run(control))
}

/// The plan as text, once the judge has found it right.
fn judged(domain: &str, problem: &str, compiled: &Arc<Compiled>, outcome: &Outcome) -> String {
    let Outcome::Found(choices) = outcome else {
        panic!("no plan but {outcome:?}\n{domain}\n{problem}");
    };
    let solution = Solution::new(compiled, choices).expect("choices make a plan");
    let mut text = Vec::new();
    solution.write(&mut text).expect("memory can be written to");
    let text = String::from_utf8(text).expect("names are text");
    if let Err(faults) = plan_checker::check(domain, problem, &text) {
        panic!("{faults:?}\n{domain}\n{problem}\n{text}");
    }
    text
}

/// A plan for what must have one, as text.
fn plan(domain: &str, problem: &str) -> String {
    let compiled = compiled(domain, problem);
    let outcome = depth_first(&compiled, u64::MAX);
    judged(domain, problem, &compiled, &outcome)
}

/// The names of the actions of a plan, in order.
fn actions(plan: &str) -> Vec<String> {
    let lines = plan
        .lines()
        .skip(1)
        .take_while(|line| !line.starts_with("root"));
    let actions = lines.filter_map(|line| line.split_once(' '));
    actions.map(|(_, action)| action.to_owned()).collect()
}
