//! What the task service writes down.

use std::collections::BTreeSet;

use super::{Published, Stage, Taken, TaskOutput, TaskService};
use crate::protocol::{ActionId, Ledger, Row, Rows, Unreadable, read_row, read_rows};

const PREFIX: &str = "m/task";
const NEXT: &str = "m/task/next";
const PUBLISHED: &str = "m/task/published/";
const TAKEN: &str = "m/task/taken/";

impl TaskService {
    /// The rows that are different from what the last call gave. Keys begin with `m/task/`.
    pub fn write_down(&mut self) -> Vec<Row> {
        let ledger = &mut self.ledger;
        ledger.put(NEXT.to_owned(), &self.next);
        let mut keys = BTreeSet::new();
        for (task, published) in &self.published {
            let key = format!("{PUBLISHED}{task}");
            ledger.put(key.clone(), published);
            keys.insert(key);
        }
        ledger.keep_only(PUBLISHED, &keys);
        let mut keys = BTreeSet::new();
        for (id, taken) in &self.taken {
            let key = format!("{TAKEN}{id}");
            ledger.put(key.clone(), &(id, taken));
            keys.insert(key);
        }
        ledger.keep_only(TAKEN, &keys);
        ledger.take()
    }

    /// Makes a service that has just been made what it was when it wrote the rows down, but for what
    /// others have given it: that was given to the one who was started then, and is given up
    /// ([`TaskOutput::GiveUp`]).
    ///
    /// # Errors
    /// If a row cannot be read.
    pub fn recall(&mut self, rows: &Rows) -> Result<(), Unreadable> {
        self.next = read_row(rows, NEXT)?.unwrap_or(self.next);
        for row in read_rows::<Published>(rows, PUBLISHED) {
            let (task, published) = row?;
            self.published.insert(task.into(), published);
        }
        for row in read_rows::<(ActionId, Taken)>(rows, TAKEN) {
            let (_, (id, mut taken)) = row?;
            if taken.publisher == self.name {
                // Nobody else can have it: that is for us to decide.
                let ours = self.published.values();
                let mut ours = ours.filter(|it| matches!(it.stage, Stage::Given { .. }));
                if ours.any(|published| published.id == id) {
                    self.taken.insert(id, taken);
                }
                continue;
            }
            taken.given_up = true;
            self.outputs.push_back(TaskOutput::GiveUp {
                publisher: taken.publisher.clone(),
                id: id.clone(),
                reason: format!("{} was started again", self.name),
            });
            self.taken.insert(id, taken);
        }
        self.ledger = Ledger::of(rows, PREFIX);
        self.recalled = true;
        Ok(())
    }
}
