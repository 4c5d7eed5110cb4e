//! What a parallel agent writes down: the rows of each of its agents under a prefix of its own.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{ParallelAgent, Who};
use crate::model::{Action, Cost, FactChange, Symbol};
use crate::parallel::Footprint;
use crate::planner::{Item, Planner, Step, TaskList};
use crate::protocol::{ActionId, Durable, Input, Ledger, Machine, Row, Rows, Unreadable, read_row};

const OWN: &str = "m/parallel";

/// `m/parallel`: what belongs to none of the agents. The form is the journal's, as that of the rows of
/// an agent is.
#[derive(Debug, Serialize, Deserialize)]
struct ParallelRow {
    /// How many branches there are.
    branches: u64,
    /// What was done in the layer that was executed last.
    executed: Vec<Action>,
    /// How often in a row each branch was left out.
    left_out: BTreeMap<u64, u32>,
}

/// More branches than anybody has use for.
const MOST_BRANCHES: u64 = 1 << 10;

impl Who {
    fn prefix(self) -> String {
        match self {
            Self::List => "m/w/".to_owned(),
            Self::Foremost => "m/e/".to_owned(),
            Self::Branch(slot) => format!("m/b{slot:04}/"),
        }
    }
}

impl<P: Planner + Clone> Durable for ParallelAgent<P> {
    fn write_down(&mut self) -> Vec<Row> {
        let mut all = Vec::new();
        for who in self.everybody() {
            let rows = self.agent_mut(who).map(Durable::write_down);
            all.extend(rows.into_iter().flatten().map(|row| Row {
                key: row.key.replacen("m/", &who.prefix(), 1),
                value: row.value,
            }));
        }
        let executed = self.executed.iter().map(|(_, it)| it.action.clone());
        let left_out = self.left_out.iter();
        let row = ParallelRow {
            branches: self.branches.len() as u64,
            executed: executed.collect(),
            left_out: left_out
                .map(|(slot, times)| (*slot as u64, *times))
                .collect(),
        };
        self.ledger.put(OWN.to_owned(), &row);
        all.extend(self.ledger.take());
        all
    }

    fn recall(&mut self, rows: &Rows) -> Result<(), Unreadable> {
        let missing = || Unreadable::new(OWN, "it is missing");
        let own: ParallelRow = read_row(rows, OWN)?.ok_or_else(missing)?;
        if own.branches > MOST_BRANCHES || own.branches == 0 {
            return Err(Unreadable::new(OWN, "nobody has so many branches"));
        }
        // There may have been more of them, with goals that are not over.
        let pristine = self.branches.first().cloned();
        for slot in self.branches.len()..own.branches as usize {
            let name = self.branch_name(slot);
            self.branches
                .extend(pristine.clone().map(|it| it.named(name, true)));
        }
        let everybody = self.everybody();
        let mut known = 1;
        for who in &everybody {
            let prefix = who.prefix();
            let theirs: Rows = (rows.range(prefix.clone()..))
                .map_while(|(key, value)| {
                    let rest = key.strip_prefix(&prefix)?;
                    Some((format!("m/{rest}"), value.clone()))
                })
                .collect();
            known += theirs.len();
            if theirs.is_empty() {
                // A branch that there was none of before.
                if let Who::Branch(slot) = who
                    && *slot as u64 >= own.branches
                {
                    self.teach(*slot);
                    continue;
                }
                return Err(Unreadable::new(prefix, "these rows are missing"));
            }
            if let Some(agent) = self.agent_mut(*who) {
                let recalled = agent.recall(&theirs);
                recalled.map_err(|error| {
                    let key = error.key.replacen("m/", &prefix, 1);
                    Unreadable::new(key, error.reason)
                })?;
            }
        }
        let all = rows.range("m/".to_owned()..);
        if all.take_while(|(key, _)| key.starts_with("m/")).count() != known {
            return Err(Unreadable::new("m/", "there are rows of nobody's"));
        }
        self.take_up(own);
        self.ledger = Ledger::of(rows, OWN);
        match self.fault() {
            Some(fault) => Err(Unreadable::new(OWN, fault)),
            None => Ok(()),
        }
    }

    fn is_suspended(&self, superior: &Symbol, id: &ActionId) -> bool {
        self.agents().any(|agent| agent.is_suspended(superior, id))
    }
}

impl<P: Planner> ParallelAgent<P> {
    /// Has a branch believe what the list does.
    fn teach(&mut self, slot: usize) {
        let told = self.list.belief();
        let Some(branch) = self.branches.get_mut(slot) else {
            return;
        };
        let believed = branch.belief();
        let gone = believed.facts().filter(|fact| !told.holds(fact));
        let mut changes: Vec<FactChange> = gone.cloned().map(FactChange::Remove).collect();
        let new = told.facts().filter(|fact| !believed.holds(fact));
        changes.extend(new.cloned().map(FactChange::Add));
        let set = told
            .values()
            .map(|(of, value)| FactChange::Set(of.clone(), value));
        changes.extend(set);
        branch.handle(self.now, Input::Observation(changes));
        while branch.poll_output().is_some() {}
    }

    /// What follows from what was recalled.
    fn take_up(&mut self, own: ParallelRow) {
        let problem = self.list.present();
        let footprint = |action: Action| {
            let step = Step {
                item: Item::Task(action),
                cost: Cost::ZERO,
                frame: None,
                rest: TaskList::empty(),
            };
            (0, Footprint::of(&problem, &step))
        };
        self.executed = own.executed.into_iter().map(footprint).collect();
        let left_out = own.left_out.into_iter();
        self.left_out = left_out
            .map(|(slot, times)| (slot as usize, times))
            .collect();
        if self.foremost.is_busy() {
            let why = self.why_to_rest();
            for branch in &mut self.branches {
                branch.was_paused(Some(&why));
            }
            if self.branches.iter().all(|it| it.running().is_none()) {
                self.foremost.was_paused(None);
            }
        }
        self.restarted = true;
        self.unsettled = true;
    }
}
