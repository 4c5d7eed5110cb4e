//! YAML as a tree in which everything knows its line.

use std::fmt;

use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};
use serde_saphyr::Spanned;

/// The longest text that is read, in bytes. A hundred thousand vertices with their lanes are less.
const MOST_BYTES: usize = 64 << 20;
/// Of anything in anything. A navigation graph has five.
const MOST_DEPTH: usize = 64;
const MOST_PARTS: usize = 16_000_000;

/// A part of the text, and the line it begins in.
#[derive(Debug)]
pub(super) struct Tree {
    pub(super) line: usize,
    pub(super) value: Value,
}

#[derive(Debug)]
pub(super) enum Value {
    Null,
    Bool(bool),
    Number(f64),
    Text(String),
    List(Vec<Tree>),
    /// In the order of the text. No key occurs twice.
    Table(Vec<(String, Tree)>),
}

/// Reads a text. What is wrong with it is said with its line.
pub(super) fn parse(text: &str) -> Result<Tree, (usize, String)> {
    if text.len() > MOST_BYTES {
        let message = format!("is too long: {} bytes, of at most {MOST_BYTES}", text.len());
        return Err((0, message));
    }
    let mut options = serde_saphyr::Options::default();
    options.budget = serde_saphyr::budget! {
        max_events: MOST_PARTS,
        max_nodes: MOST_PARTS,
        max_depth: MOST_DEPTH,
        flow_nesting_limit: MOST_DEPTH,
        max_total_scalar_bytes: MOST_BYTES,
    };
    serde_saphyr::from_str_with_options::<Spanned<Value>>(text, options)
        .map(Tree::from)
        .map_err(|error| {
            let line = error.location().map_or(0, |location| location.line());
            let said = error.without_snippet().to_string();
            let first = said.lines().next().unwrap_or_default();
            let reason = first.split(" at line ").next().unwrap_or_default();
            (
                usize::try_from(line).unwrap_or(0),
                format!("is not YAML: {reason}"),
            )
        })
}

impl Tree {
    /// A member of a table. `None` if this is none, or has none of that name.
    pub(super) fn get(&self, key: &str) -> Option<&Tree> {
        let found = self.members()?.iter().find(|(known, _)| known == key);
        found.map(|(_, tree)| tree)
    }

    pub(super) fn members(&self) -> Option<&[(String, Tree)]> {
        match &self.value {
            Value::Table(members) => Some(members),
            _ => None,
        }
    }

    pub(super) fn list(&self) -> Option<&[Tree]> {
        match &self.value {
            Value::List(list) => Some(list),
            _ => None,
        }
    }

    pub(super) fn number(&self) -> Option<f64> {
        match self.value {
            Value::Number(number) if number.is_finite() => Some(number),
            _ => None,
        }
    }

    /// A whole number that counts something.
    pub(super) fn index(&self) -> Option<usize> {
        let number = self.number().filter(|number| number.fract() == 0.0)?;
        (0.0..=1e9).contains(&number).then_some(number as usize)
    }

    /// Text, and numbers too: a room may be called 101.
    pub(super) fn text(&self) -> Option<String> {
        match &self.value {
            Value::Text(text) => Some(text.clone()),
            Value::Number(number) => Some(number.to_string()),
            _ => None,
        }
    }
}

impl From<Spanned<Value>> for Tree {
    fn from(spanned: Spanned<Value>) -> Self {
        Self {
            line: usize::try_from(spanned.referenced.line()).unwrap_or(0),
            value: spanned.value,
        }
    }
}

impl<'de> Deserialize<'de> for Value {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(Anything)
    }
}

struct Anything;

impl<'de> Visitor<'de> for Anything {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("anything")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_none<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_some<D: Deserializer<'de>>(self, deserializer: D) -> Result<Value, D::Error> {
        Value::deserialize(deserializer)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(Value::Bool(value))
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(Value::Number(value as f64))
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(Value::Number(value as f64))
    }

    fn visit_i128<E>(self, value: i128) -> Result<Value, E> {
        Ok(Value::Number(value as f64))
    }

    fn visit_u128<E>(self, value: u128) -> Result<Value, E> {
        Ok(Value::Number(value as f64))
    }

    fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
        Ok(Value::Number(value))
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(Value::Text(value.to_owned()))
    }

    fn visit_string<E>(self, value: String) -> Result<Value, E> {
        Ok(Value::Text(value))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut parts: A) -> Result<Value, A::Error> {
        let mut list = Vec::new();
        while let Some(part) = parts.next_element::<Spanned<Value>>()? {
            list.push(Tree::from(part));
        }
        Ok(Value::List(list))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut parts: A) -> Result<Value, A::Error> {
        let mut members = Vec::new();
        while let Some((key, part)) = parts.next_entry::<String, Spanned<Value>>()? {
            members.push((key, Tree::from(part)));
        }
        Ok(Value::Table(members))
    }
}
