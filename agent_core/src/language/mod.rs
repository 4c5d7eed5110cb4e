//! The reader and the writer of HDDL, and the checks that a domain must pass before an agent acts on it.
//!
//! The language is total-order HDDL, domains and problems. What goes beyond is refused by name and
//! place rather than misread.

mod action;
mod check;
mod condition;
mod domain;
mod effect;
mod error;
mod excerpt;
mod expression;
mod fields;
mod fit;
mod fragment;
mod lexer;
mod method;
mod near;
mod number;
mod problem;
mod section;
mod spelling;
mod subtasks;
mod tree;
mod typed_list;
mod types;
mod write;

#[cfg(test)]
mod hostile_text;
#[cfg(test)]
mod tests;

pub use check::{DomainError, Truth, check_model};
pub use domain::{parse_domain, parse_domain_strictly};
pub use error::LanguageError;
pub use excerpt::{excerpt, report};
pub use fit::{Misfit, Sort};
pub use fragment::{
    parse_atom, parse_effects, parse_fact_change, parse_literal, parse_number, parse_parameter,
    parse_pattern, parse_tasks,
};
pub use near::nearest;
pub use problem::parse_problem;
pub use spelling::Spelling;
pub use write::{write_domain, write_problem};
