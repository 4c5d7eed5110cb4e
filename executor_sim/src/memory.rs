//! What the robot remembers of actions that do not run.

use std::collections::{BTreeMap, BTreeSet};

use agent_core::model::{Action, Fact, Symbol};
use agent_core::protocol::ActionId;
use agent_core::protocol::{Ledger, Rows, Unreadable, read_rows};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::Skill;

/// How many actions that are over are remembered. A superior asks again after seconds, not after
/// a thousand actions.
const REMEMBERED: usize = 1000;

const RECORD: &str = "m/record/";
const OVER: &str = "m/over/";

/// What is needed to resume an action (the paper, section 4: the action executor's record). `S` is
/// what an action is to whoever does it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Record<S = Skill> {
    pub(crate) id: ActionId,
    /// To whom the reports go.
    pub(crate) superior: Symbol,
    pub(crate) action: Action,
    /// What is left to be done: of a speech the rest; of a drive the same drive, since that can
    /// begin anywhere on its arc.
    pub(crate) rest: S,
}

/// How an action is over.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) enum End {
    Success,
    Failure {
        reason: String,
        blocked_by: Vec<Fact>,
    },
    /// It must not be done twice, and nobody can tell whether it was done.
    Unknown {
        reason: String,
    },
    /// The superior has dropped it.
    Cleared,
}

/// An action that is over.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Over<S = Skill> {
    pub(crate) id: ActionId,
    pub(crate) superior: Symbol,
    pub(crate) skill: S,
    pub(crate) end: End,
}

/// Suspended actions, and how others have ended. Both are written down entry by entry.
#[derive(Clone, Debug)]
pub(crate) struct Memory<S = Skill> {
    /// In the order of suspension.
    records: Numbered<Record<S>>,
    /// Oldest first.
    over: Numbered<Over<S>>,
}

impl<S> Default for Memory<S> {
    fn default() -> Self {
        Self {
            records: Numbered::default(),
            over: Numbered::default(),
        }
    }
}

impl<S: Clone + Serialize + DeserializeOwned> Memory<S> {
    /// How many suspended actions can be resumed.
    pub(crate) fn depth(&self) -> usize {
        self.records.entries.len()
    }

    /// Suspended actions, the latest last.
    pub(crate) fn records(&self) -> impl Iterator<Item = &Record<S>> {
        self.records.entries.values()
    }

    pub(crate) fn keep(&mut self, record: Record<S>) {
        self.records.push(record);
    }

    pub(crate) fn record(&self, id: &ActionId) -> Option<&Record<S>> {
        self.records().find(|record| record.id == *id)
    }

    pub(crate) fn take(&mut self, id: &ActionId) -> Option<Record<S>> {
        let mut numbered = self.records.entries.iter();
        let number = *numbered.find(|(_, record)| record.id == *id)?.0;
        self.records.remove(number)
    }

    pub(crate) fn end(&mut self, job: &Record<S>, end: End) {
        if self.over.entries.len() >= REMEMBERED
            && let Some((&oldest, _)) = self.over.entries.first_key_value()
        {
            self.over.remove(oldest);
        }
        self.over.push(Over {
            id: job.id.clone(),
            superior: job.superior.clone(),
            skill: job.rest.clone(),
            end,
        });
    }

    /// How the action is over; `None` if it is not, or if that was long ago.
    pub(crate) fn over(&self, id: &ActionId) -> Option<&Over<S>> {
        // From the back: who asks, asks about what has just ended.
        let mut latest_first = self.over.entries.values().rev();
        latest_first.find(|over| over.id == *id)
    }

    /// Whoever had those begun will not ask for them again. Gives back what was suspended.
    pub(crate) fn forget(&mut self, superior: &Symbol) -> Vec<Record<S>> {
        self.over.extract(|over| over.superior == *superior);
        self.records.extract(|record| record.superior == *superior)
    }

    pub(crate) fn write_down(&mut self, ledger: &mut Ledger) {
        self.records.write_down(RECORD, ledger);
        self.over.write_down(OVER, ledger);
    }

    pub(crate) fn recall(rows: &Rows) -> Result<Self, Unreadable> {
        Ok(Self {
            records: Numbered::recall(RECORD, rows)?,
            over: Numbered::recall(OVER, rows)?,
        })
    }
}

/// Entries in their order, of which only what is different is written again.
#[derive(Clone, Debug)]
struct Numbered<T> {
    entries: BTreeMap<u64, T>,
    next: u64,
    /// Come or gone since it was written down.
    touched: BTreeSet<u64>,
}

impl<T> Default for Numbered<T> {
    fn default() -> Self {
        Self {
            entries: BTreeMap::new(),
            next: 1,
            touched: BTreeSet::new(),
        }
    }
}

impl<T: Serialize + DeserializeOwned> Numbered<T> {
    fn push(&mut self, entry: T) {
        self.entries.insert(self.next, entry);
        self.touched.insert(self.next);
        self.next = self.next.saturating_add(1);
    }

    fn remove(&mut self, number: u64) -> Option<T> {
        self.touched.insert(number);
        self.entries.remove(&number)
    }

    fn extract(&mut self, which: impl Fn(&T) -> bool) -> Vec<T> {
        let numbered = self.entries.iter();
        let numbers: Vec<u64> = numbered
            .filter(|(_, entry)| which(entry))
            .map(|(number, _)| *number)
            .collect();
        let taken = numbers.into_iter();
        taken.filter_map(|number| self.remove(number)).collect()
    }

    fn write_down(&mut self, prefix: &str, ledger: &mut Ledger) {
        for number in std::mem::take(&mut self.touched) {
            let key = format!("{prefix}{number:020}");
            match self.entries.get(&number) {
                Some(entry) => ledger.put(key, entry),
                None => ledger.remove(&key),
            }
        }
    }

    fn recall(prefix: &str, rows: &Rows) -> Result<Self, Unreadable> {
        let mut numbered = Self::default();
        for row in read_rows(rows, prefix) {
            let (number, entry) = row?;
            let number: u64 = number
                .parse()
                .map_err(|error| Unreadable::new(format!("{prefix}{number}"), error))?;
            numbered.entries.insert(number, entry);
            numbered.next = numbered.next.max(number.saturating_add(1));
        }
        Ok(numbered)
    }
}
