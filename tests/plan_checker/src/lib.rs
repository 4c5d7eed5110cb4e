//! Judges plans in the format of the planning competition of 2020, and shares no code with what
//! makes them.
//!
//! [`check`] takes a plan with its decompositions and says what is wrong with it; it holds plans
//! to what the competition's own verifier (pandaPI's) holds them to. [`check_sequence`] takes the
//! actions alone and looks for decompositions that give them.

mod fault;
mod instance;
mod load;
mod model;
mod plan;
mod sequence;
mod sexpr;
mod solve;
mod state;
mod tree;
mod walk;

pub use fault::{Fault, Kind};

/// What is known of a plan that is right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Report {
    /// How many actions it has.
    pub actions: usize,
    /// How many decompositions; zero if it came without them.
    pub decompositions: usize,
    /// What its actions cost: what the domain adds to a cost, otherwise one for each action.
    pub cost: f64,
}

/// Checks a plan with its decompositions, given as the texts of domain, problem and plan. Of the
/// plan's text only the part from `==>` to `<==` counts.
///
/// # Errors
/// What is wrong with the plan, or with domain or problem.
pub fn check(domain: &str, problem: &str, plan: &str) -> Result<Report, Vec<Fault>> {
    let model = load::load(domain, problem).map_err(|fault| vec![fault])?;
    let plan = plan::read(plan, &model)?;
    let tree = tree::tree(&plan)?;
    let instances = instance::instances(&model, &plan, tree)?;
    walk::walk(&model, &plan, &instances).map_err(|fault| vec![fault])
}

/// Checks a plan of which only the actions are known: whether they can be done one after the
/// other, lead to the problem's goal, and are a decomposition of its tasks. Methods have to be
/// totally ordered. The actions stand one on a line, with or without parentheses and ids; of a text
/// with `==>` only the part to `<==` counts.
///
/// # Errors
/// What is wrong with the plan, or with domain or problem.
pub fn check_sequence(domain: &str, problem: &str, actions: &str) -> Result<Report, Vec<Fault>> {
    let model = load::load(domain, problem).map_err(|fault| vec![fault])?;
    sequence::check(&model, actions).map_err(|fault| vec![fault])
}
