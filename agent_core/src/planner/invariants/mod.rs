//! Facts of which at most one holds at a time, found in the domain: a robot is at one place.
//!
//! In the manner of Helmert's *Concise finite-domain representations for PDDL planning tasks*
//! (Artificial Intelligence 173, 2009): a candidate is a set of predicates, in each of which some
//! argument positions are the candidate's parameters and at most one is counted over. A candidate
//! that no action lets grow beyond one fact is a group; one that an action unbalances is refined by
//! what that action takes away. Two things differ from there. Here it is enough that one fact
//! *at most* holds, since `(forall (?x - node) (not (at ?x)))` empties a group without asking
//! whether anything was in it. And to be suspended is something that happens to an action as well:
//! a robot that stands on an arc is at no node.
//!
//! # What a group promises, and what it does not
//!
//! * If at most one fact of a group holds for some values of its parameters, at most one holds after
//!   any action and any suspension. Whether one or none: a group does not say. Each choice of
//!   parameters stands for itself; a fault in one does not spread to another.
//! * It says nothing about a belief. Reports and observations put there what they like. Whoever relies
//!   on a group asks [`Variables::broken`] after every change of the belief that the planner did not
//!   predict, and as long as a variable is broken takes each of its facts for a variable of its own,
//!   which is always right and only merges less. Then the effects of actions apply fact by fact,
//!   as the domain writes them.
//! * Observable predicates are in no group: what changes without the agent is not bound to what its
//!   actions keep in order, and would break a group most days. Each such fact is on its own.
//! * Facts have to fit the types of their declarations: `forall` clears what fits.
//! * A group is found if it can be proved from effects and the plain parts of conditions. `or`, `exists`
//!   and most of `forall` in conditions are left out of account, which finds fewer groups and
//!   never a wrong one.

mod balance;
mod group;
mod schema;
mod synthesis;
mod unify;
mod variables;

#[cfg(test)]
mod property;
#[cfg(test)]
mod tests;

pub use group::{Group, Part, Role};
pub use synthesis::mutex_groups;
pub use variables::{Variable, Variables};
