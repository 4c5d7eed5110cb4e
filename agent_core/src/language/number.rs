//! Numbers that may depend on functions.

use super::error::Faults;
use super::expression::Scope;
use super::fit::Sort;
use super::tree::{Kind, Tree};
use crate::model::Number;

impl Scope<'_> {
    /// A number: as written, a function, or reckoned from others.
    pub(super) fn number(&self, tree: &Tree, faults: &mut Faults) -> Option<Number> {
        let items = match &tree.kind {
            Kind::Word(word) => {
                let number = decimal(word);
                if number.is_none() {
                    faults.add(
                        tree.at,
                        format!(
                            "expected a number such as `2.5` or a function such as `(length \
                             ?arc)`, found `{word}`"
                        ),
                    );
                }
                return number.map(Number::Constant);
            }
            Kind::List(items) => items,
        };
        let sign = match tree.head() {
            Some(sign @ ("+" | "*" | "-" | "/")) => sign,
            _ => {
                let function = self.pattern(tree, Sort::Function, faults)?;
                return Some(Number::Function(function));
            }
        };
        let parts: Vec<Option<Number>> = items[1..]
            .iter()
            .map(|part| self.number(part, faults))
            .collect();
        let parts: Vec<Number> = parts.into_iter().collect::<Option<_>>()?;
        let wanted = match sign {
            "+" | "*" if parts.is_empty() => "at least one number",
            "-" | "/" if parts.len() != 2 => "two numbers",
            _ => "",
        };
        if !wanted.is_empty() {
            faults.add(tree.at, format!("`{sign}` takes {wanted}: `{tree}`"));
            return None;
        }
        let mut rest = parts.into_iter();
        match (sign, rest.next(), rest.next()) {
            ("+", Some(first), second) => Some(Number::Sum(chain(first, second, rest))),
            ("*", Some(first), second) => Some(Number::Product(chain(first, second, rest))),
            ("-", Some(left), Some(right)) => {
                Some(Number::Difference(Box::new(left), Box::new(right)))
            }
            (_, _, Some(Number::Constant(0.0))) => {
                faults.add(tree.at, format!("this divides by zero: `{tree}`"));
                None
            }
            (_, Some(left), Some(right)) => Some(Number::Quotient(Box::new(left), Box::new(right))),
            _ => None,
        }
    }
}

fn chain(first: Number, second: Option<Number>, rest: impl Iterator<Item = Number>) -> Vec<Number> {
    std::iter::once(first).chain(second).chain(rest).collect()
}

/// A finite number in the usual notation. Rust would also read `inf` and `nan`.
pub(super) fn decimal(word: &str) -> Option<f64> {
    let digits = word.strip_prefix(['-', '+']).unwrap_or(word);
    if !digits.starts_with(|first: char| first.is_ascii_digit() || first == '.') {
        return None;
    }
    word.parse().ok().filter(|number: &f64| number.is_finite())
}
