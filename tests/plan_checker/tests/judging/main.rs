//! The judge, judged: right plans pass, and every kind of wrong plan is refused for what is wrong
//! with it.

mod actions_only;
mod faults;
mod language;
mod mutations;
mod size;

/// A domain in which letters are delivered along one-way roads.
const POST: &str = include_str!("post.hddl");
const LETTER: &str = include_str!("letter.hddl");
/// The only plan for it.
const DELIVERY: &str = include_str!("delivery.plan");

/// The kinds of faults that are found, or none.
fn kinds(domain: &str, problem: &str, plan: &str) -> Vec<plan_checker::Kind> {
    match plan_checker::check(domain, problem, plan) {
        Ok(_) => Vec::new(),
        Err(faults) => faults.into_iter().map(|fault| fault.kind).collect(),
    }
}

/// A text with one of its parts replaced; the part has to be there.
fn with(text: &str, part: &str, other: &str) -> String {
    assert!(text.contains(part), "`{part}` is there to be replaced");
    text.replacen(part, other, 1)
}
