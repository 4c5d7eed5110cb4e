//! Values that travel as text that people read and type.

use std::fmt;

use agent_core::language::{parse_atom, parse_fact_change};
use agent_core::model::{Atom, FactChange};
use agent_core::protocol::ActionId;
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// A value that travels as its text: `"(at n1)"`, `"(not (open d))"`, `"parent.3.17"`.
#[derive(Clone, Debug, Eq, PartialEq, Ord, PartialOrd)]
pub struct Text<T>(pub T);

/// What can be read back from the text that it prints as.
pub trait FromText: Sized {
    /// The value, or what is wrong with the text.
    fn from_text(text: &str) -> Result<Self, String>;
}

impl<T: fmt::Display> Serialize for Text<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(&self.0)
    }
}

impl<'de, T: FromText> Deserialize<'de> for Text<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        T::from_text(&text).map(Self).map_err(D::Error::custom)
    }
}

impl FromText for Atom {
    fn from_text(text: &str) -> Result<Self, String> {
        parse_atom(text).map_err(|error| error.to_string())
    }
}

impl FromText for FactChange {
    fn from_text(text: &str) -> Result<Self, String> {
        parse_fact_change(text).map_err(|error| error.to_string())
    }
}

impl FromText for ActionId {
    fn from_text(text: &str) -> Result<Self, String> {
        // From the right: names may have dots in them.
        let mut parts = text.rsplitn(3, '.');
        let number = parts.next().and_then(|part| part.parse().ok());
        let epoch = parts.next().and_then(|part| part.parse().ok());
        let agent = parts.next().filter(|agent| !agent.is_empty());
        match (agent, epoch, number) {
            (Some(agent), Some(epoch), Some(number)) => Ok(Self {
                agent: agent.into(),
                epoch,
                number,
            }),
            _ => Err(format!(
                "`{text}` names no execution; they look like `parent.3.17`"
            )),
        }
    }
}

/// As they travel.
pub(super) fn to_text<T: Clone>(values: &[T]) -> Vec<Text<T>> {
    values.iter().cloned().map(Text).collect()
}

/// As the core has them.
pub(super) fn from_text<T>(values: Vec<Text<T>>) -> Vec<T> {
    values.into_iter().map(|Text(value)| value).collect()
}

/// Changes as they travel. A value that is not a number says nothing and has no text; it stays
/// here rather than hold up all that was to be sent with it.
pub(super) fn changes_to_text(changes: &[FactChange]) -> Vec<Text<FactChange>> {
    changes
        .iter()
        .filter(|change| match change {
            FactChange::Set(function, value) if !value.is_finite() => {
                tracing::error!("the value of {function} is {value}, which is not sent");
                false
            }
            _ => true,
        })
        .cloned()
        .map(Text)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_execution_is_named_in_three_parts_and_an_agent_may_have_dots() {
        let id = ActionId {
            agent: "area.one".into(),
            epoch: 3,
            number: 17,
        };
        assert_eq!(ActionId::from_text("area.one.3.17"), Ok(id));
        for wrong in ["", "3.17", ".3.17", "parent.x.1", "parent.1.-1", "parent"] {
            assert!(ActionId::from_text(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_value_that_is_not_a_number_is_not_sent() {
        let changes = [
            FactChange::Set(Atom::new("gap", ["a"]), f64::NAN),
            FactChange::Add(Atom::new("at", ["n1"])),
        ];
        assert_eq!(changes_to_text(&changes).len(), 1);
    }
}
