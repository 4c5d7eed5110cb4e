//! What an action costs, once its arguments are known.

use std::sync::Arc;

use agent_core::model::{Cost, Number, Pattern, Symbol, Term};
use rustc_hash::FxHashMap;

use super::ObjectId;

/// Values of functions; no action changes them.
pub(super) type Values = FxHashMap<(Symbol, Vec<ObjectId>), f64>;

/// An expression over the action's arguments.
#[derive(Clone, Debug)]
pub struct CostRule {
    // In postfix notation: no recursion, however deeply the expression was nested.
    program: Vec<Operation>,
    values: Arc<Values>,
}

#[derive(Clone, Debug)]
enum Operation {
    Push(f64),
    Look(Symbol, Vec<super::Term>),
    Sum(usize),
    Product(usize),
    Minus,
    Divide,
}

impl CostRule {
    pub(super) fn new(
        number: &Number,
        values: &Arc<Values>,
        object: &dyn Fn(&Symbol) -> Option<ObjectId>,
    ) -> Self {
        let mut program = Vec::new();
        let mut open = vec![number];
        // Read from the root and turned around: operands then come before what joins them.
        while let Some(number) = open.pop() {
            match number {
                Number::Constant(value) => program.push(Operation::Push(*value)),
                Number::Function(pattern) => program.push(look(pattern, object)),
                Number::Sum(parts) => {
                    program.push(Operation::Sum(parts.len()));
                    open.extend(parts);
                }
                Number::Product(parts) => {
                    program.push(Operation::Product(parts.len()));
                    open.extend(parts);
                }
                Number::Difference(from, what) => {
                    program.push(Operation::Minus);
                    open.extend([&**from, &**what]);
                }
                Number::Quotient(what, by) => {
                    program.push(Operation::Divide);
                    open.extend([&**what, &**by]);
                }
            }
        }
        program.reverse();
        Self {
            program,
            values: Arc::clone(values),
        }
    }

    /// What has no value costs nothing.
    pub fn of(&self, args: &[ObjectId]) -> Cost {
        let mut stack: Vec<f64> = Vec::new();
        for operation in &self.program {
            let value = match operation {
                Operation::Push(value) => *value,
                Operation::Look(function, terms) => {
                    let key = terms.iter().map(|term| term.value(args)).collect();
                    match self.values.get(&(function.clone(), key)) {
                        Some(value) => *value,
                        None => return Cost::ZERO,
                    }
                }
                Operation::Sum(count) => {
                    let from = stack.len().saturating_sub(*count);
                    stack.drain(from..).sum()
                }
                Operation::Product(count) => {
                    let from = stack.len().saturating_sub(*count);
                    stack.drain(from..).product()
                }
                Operation::Minus => {
                    let (second, first) = (stack.pop(), stack.pop());
                    first.unwrap_or(0.0) - second.unwrap_or(0.0)
                }
                Operation::Divide => {
                    let (second, first) = (stack.pop(), stack.pop());
                    first.unwrap_or(0.0) / second.unwrap_or(1.0)
                }
            };
            stack.push(value);
        }
        Cost::from_units(stack.pop().unwrap_or(0.0))
    }
}

fn look(pattern: &Pattern, object: &dyn Fn(&Symbol) -> Option<ObjectId>) -> Operation {
    let args = pattern.args.iter().map(|term| match term {
        Term::Variable(index) => Some(super::Term::Variable(*index)),
        Term::Constant(name) => object(name).map(super::Term::Object),
    });
    match args.collect() {
        Some(args) => Operation::Look(pattern.name.clone(), args),
        None => Operation::Push(0.0),
    }
}
