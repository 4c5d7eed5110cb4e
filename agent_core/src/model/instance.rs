//! A planning problem as its author wrote it in HDDL.

use std::collections::BTreeMap;

use super::{Belief, Condition, Parameter, Pattern, Symbol};

/// `(define (problem …))`: objects, what holds at first, and what is to be done.
///
/// It belongs to a [`Domain`](super::Domain), against which whoever makes one has checked every
/// name (`language`).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Instance {
    /// `(define (problem NAME)`.
    pub name: Symbol,
    /// `(:domain NAME)`.
    pub domain: Symbol,
    /// Objects beside the constants of the domain, and their types.
    pub objects: BTreeMap<Symbol, Symbol>,
    /// `:init`: facts and values of functions.
    pub init: Belief,
    /// Variables of the initial tasks (`:htn :parameters`): some objects of their types are to be
    /// chosen for them.
    pub parameters: Vec<Parameter>,
    /// What the choice of objects must fulfil (`:constraints`).
    pub constraints: Condition,
    /// What is to be done, in this order, with variables.
    pub tasks: Vec<Pattern>,
    /// `:goal`: what must hold in the end. Empty: anything may.
    pub goal: Condition,
}
