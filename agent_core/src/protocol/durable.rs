//! What a machine writes down, and how it is made again from that.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Display;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::{ActionId, Machine};
use crate::model::Symbol;

/// One row of a journal, as it is now.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Row {
    /// Which; parts are separated by `/`.
    pub key: String,
    /// Its content; `None` if it is no more.
    pub value: Option<Vec<u8>>,
}

/// All rows of a journal.
pub type Rows = BTreeMap<String, Vec<u8>>;

/// A row cannot be read: it was damaged, or written by something else.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
#[error("the row `{key}` cannot be read: {reason}")]
pub struct Unreadable {
    /// Which.
    pub key: String,
    /// In words.
    pub reason: String,
}

impl Unreadable {
    /// That row, for that reason.
    pub fn new(key: impl Into<String>, reason: impl Display) -> Self {
        Self {
            key: key.into(),
            reason: reason.to_string(),
        }
    }
}

/// A machine that survives its process.
///
/// Invariant (S10 of the reliability page): a machine that is made anew and recalls all rows that
/// another has written down behaves as that one did when it wrote them, but for what happens
/// only once at a start (a robot halts, an agent waits for its superiors to be seen).
pub trait Durable: Machine {
    /// The rows that are different from what the last call gave, between two inputs and with all
    /// outputs drained. The first call gives all of them. Keys begin with `m/`.
    fn write_down(&mut self) -> Vec<Row>;

    /// Makes a machine that has just been made what it was when it wrote the rows down.
    ///
    /// # Errors
    /// If a row cannot be read, or does not fit what the machine was made with. The machine is of
    /// no use then.
    fn recall(&mut self, rows: &Rows) -> Result<(), Unreadable>;

    /// Whether that execution is suspended on the word of that superior: then there is nothing to stop
    /// of it until it is resumed.
    fn is_suspended(&self, _superior: &Symbol, _id: &ActionId) -> bool {
        false
    }

    /// Whether a report on that execution counts if it is from `by`; one that does not is as if it had not
    /// come.
    fn believes(&self, _by: &Symbol, _id: &ActionId) -> bool {
        true
    }

    /// Whether an output to elsewhere stops something. Stopping never waits for the disk
    /// (decision 10).
    fn is_stop(_output: &Self::Out) -> bool {
        false
    }
}

/// Knows what was written down last, so that only differences are written.
#[derive(Clone, Debug, Default)]
pub struct Ledger {
    known: Rows,
    changed: BTreeSet<String>,
    /// Room to write a row in, to see whether it is different.
    draft: Vec<u8>,
}

impl Ledger {
    /// One that has written those rows, as far as their keys begin with `prefix`.
    pub fn of(rows: &Rows, prefix: &str) -> Self {
        let own = rows
            .range(prefix.to_owned()..)
            .take_while(|(key, _)| key.starts_with(prefix));
        Self {
            known: own
                .map(|(key, value)| (key.clone(), value.clone()))
                .collect(),
            ..Self::default()
        }
    }

    /// Whether there is a row of that key.
    pub fn has(&self, key: &str) -> bool {
        self.known.contains_key(key)
    }

    /// The row is this now.
    pub fn put<T: Serialize + ?Sized>(&mut self, key: String, value: &T) {
        // Everything that is put here is made of structs, enums, sequences with a length and
        // maps, all of which have a form in postcard.
        let mut draft = std::mem::take(&mut self.draft);
        draft.clear();
        let draft = postcard::to_extend(value, draft).expect("every row can be written");
        if self.known.get(&key) != Some(&draft) {
            self.known.insert(key.clone(), draft.clone());
            self.changed.insert(key);
        }
        self.draft = draft;
    }

    /// There is no such row any more.
    pub fn remove(&mut self, key: &str) {
        if self.known.remove(key).is_some() {
            self.changed.insert(key.to_owned());
        }
    }

    /// Of the rows whose keys begin with `prefix` only these stay.
    pub fn keep_only(&mut self, prefix: &str, keys: &BTreeSet<String>) {
        let own = self
            .known
            .range(prefix.to_owned()..)
            .map(|(key, _)| key)
            .take_while(|key| key.starts_with(prefix));
        let gone: Vec<String> = own.filter(|key| !keys.contains(*key)).cloned().collect();
        for key in gone {
            self.remove(&key);
        }
    }

    /// What is different since this was asked last.
    pub fn take(&mut self) -> Vec<Row> {
        let changed = std::mem::take(&mut self.changed);
        let rows = changed.into_iter().map(|key| Row {
            value: self.known.get(&key).cloned(),
            key,
        });
        rows.collect()
    }
}

/// The content of a row; `None` if there is none of that key.
///
/// # Errors
/// If it is not a `T`, or more than one.
pub fn read_row<T: DeserializeOwned>(rows: &Rows, key: &str) -> Result<Option<T>, Unreadable> {
    rows.get(key)
        .map(|bytes| read_bytes(key, bytes))
        .transpose()
}

/// The rows whose keys begin with `prefix`, with the rest of each key, in their order.
///
/// # Errors
/// If one of them is not a `T`.
pub fn read_rows<'a, T: DeserializeOwned>(
    rows: &'a Rows,
    prefix: &'a str,
) -> impl Iterator<Item = Result<(&'a str, T), Unreadable>> {
    rows.range(prefix.to_owned()..)
        .map_while(move |(key, bytes)| Some((key, key.strip_prefix(prefix)?, bytes)))
        .map(|(key, rest, bytes)| Ok((rest, read_bytes(key, bytes)?)))
}

fn read_bytes<T: DeserializeOwned>(key: &str, bytes: &[u8]) -> Result<T, Unreadable> {
    match postcard::take_from_bytes(bytes) {
        Ok((value, [])) => Ok(value),
        Ok((_, rest)) => Err(Unreadable::new(
            key,
            format_args!("{} byte(s) are left over", rest.len()),
        )),
        Err(error) => Err(Unreadable::new(key, error)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_different_is_written_again() {
        let mut ledger = Ledger::default();
        ledger.put("m/a".into(), &1_u64);
        ledger.put("m/b".into(), &2_u64);
        assert_eq!(ledger.take().len(), 2);
        ledger.put("m/a".into(), &1_u64);
        ledger.put("m/b".into(), &3_u64);
        let changed: Vec<String> = ledger.take().into_iter().map(|row| row.key).collect();
        assert_eq!(changed, ["m/b"]);
    }

    #[test]
    fn what_is_no_more_is_a_row_without_content() {
        let mut ledger = Ledger::default();
        ledger.put("m/goal/a".into(), "a");
        ledger.put("m/goal/b".into(), "b");
        ledger.put("m/other".into(), "c");
        ledger.take();
        ledger.keep_only("m/goal/", &BTreeSet::from(["m/goal/b".to_owned()]));
        let gone = Row {
            key: "m/goal/a".into(),
            value: None,
        };
        assert_eq!(ledger.take(), [gone]);
    }

    #[test]
    fn a_row_that_is_cut_short_or_too_long_is_named() {
        let whole = postcard::to_stdvec(&("text", 7_u64)).unwrap();
        for bytes in [&whole[..3], &[whole.clone(), vec![0]].concat()] {
            let rows = Rows::from([("m/x".to_owned(), bytes.to_vec())]);
            let read = read_row::<(String, u64)>(&rows, "m/x");
            assert_eq!(read.unwrap_err().key, "m/x");
        }
    }
}
