//! From rows to an agent. A journal is a file, and files are damaged: whatever the rows are, the
//! result is an agent whose invariants hold, or an error that names the row.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::super::stack::SuspendedGoalStack;
use super::super::{
    Agent, Ended, Execution, Goal, GoalsAside, Intention, Phase, Record, ResumedBy, Running,
    WaitingGoals, WaitsFor,
};
use super::network::{HIGHEST, Reader, understood};
use super::rows::{
    AgentRow, EndedRow, ExecutionRow, FactRow, GoalRow, MapRow, OriginRow, PhaseRow, RecordRow,
    RunningRow, ToldRow, ValueRow,
};
use super::same::Written;
use super::{AGENT, ENDED, FACT, GOAL, MAP, Memory, TOLD, VALUE, key_of, numbered};
use crate::model::{Belief, FactChange, Map, Symbol};
use crate::planner::{Agenda, Origin, Plan, Planner};
use crate::protocol::{Ledger, Rows, Unreadable, read_row, read_rows};

/// A goal as it was read.
struct Recalled {
    intention: Intention,
    running: Option<Running>,
    map: Option<u64>,
}

impl<P: Planner> Agent<P> {
    pub(super) fn remember_all(&mut self, rows: &Rows) -> Result<(), Unreadable> {
        all_known(rows)?;
        let head: AgentRow = needed(rows, AGENT)?;
        let told: ToldRow = needed(rows, TOLD)?;
        let counted = [head.next_action, head.next_goal, head.next_ended];
        if counted.iter().any(|number| *number >= HIGHEST) {
            return Err(Unreadable::new(AGENT, "nobody has counted that far"));
        }
        let executors: BTreeSet<Symbol> = self.configuration.executors.all().into_iter().collect();
        known_executor(&executors, &head.last_executor)
            .map_err(|reason| Unreadable::new(AGENT, reason))?;
        self.recall_belief(rows)?;
        let mut memory = std::mem::take(&mut self.memory);
        memory.ledger = Ledger::of(rows, "m/");
        memory.recall_maps(rows)?;
        self.recall_ended(rows, head.next_ended)?;
        memory.ended = head.next_ended - self.ended.len() as u64..head.next_ended;
        self.told = told.facts.into_iter().collect();
        self.new_values = told.new_values;
        let map = |number: Option<u64>| match number {
            None => Ok(self.own_map.clone()),
            Some(number) => memory.map(number),
        };
        self.map = map(head.map).map_err(|reason| Unreadable::new(AGENT, reason))?;
        let (mut goals, mut next_frame) = (BTreeMap::new(), 0);
        for row in read_rows::<GoalRow>(rows, GOAL) {
            let (key, row) = row?;
            let key = format!("{GOAL}{key}");
            let unreadable = |reason: String| Unreadable::new(&key, reason);
            if key != numbered(GOAL, row.number) || row.number >= head.next_goal {
                return Err(unreadable("it is another goal's".to_owned()));
            }
            let on = map(row.map).map_err(unreadable)?;
            let goal = self.goal(row, on, &executors, &mut next_frame);
            let goal = goal.map_err(unreadable)?;
            goals.insert(goal.intention.goal.number, goal);
        }
        for (number, goal) in &goals {
            let written = Written::new(&goal.intention, goal.running.as_ref(), goal.map);
            memory.goals.insert(*number, written);
        }
        self.place(&head, goals)
            .map_err(|reason| Unreadable::new(AGENT, reason))?;
        self.next_action = head.next_action;
        self.next_goal = head.next_goal;
        self.last_executor = head.last_executor;
        self.hold = head.hold;
        self.memory = memory;
        if let Some(fault) = self.fault() {
            return Err(Unreadable::new(AGENT, fault));
        }
        self.take_up(next_frame);
        Ok(())
    }

    /// What the planner has to be told, and what has to be done next.
    fn take_up(&mut self, next_frame: u64) {
        self.planner.number_frames_from(next_frame);
        let problem = self.problem();
        self.planner.prepare(&problem);
        for entry in self.stack.entries() {
            let intention = &entry.intention;
            self.planner.keep(&intention.goal.id, &intention.agendas);
        }
        let goals = self.all_intentions();
        let superiors = goals.filter_map(|i| i.goal.superior.as_ref());
        let superiors: BTreeSet<Symbol> = superiors.map(|(name, _)| name.clone()).collect();
        for superior in superiors {
            self.neighbours.expect(superior);
        }
        self.restarted = true;
        self.unsettled = true;
    }

    fn recall_belief(&mut self, rows: &Rows) -> Result<(), Unreadable> {
        let mut changes = Vec::new();
        for row in read_rows::<FactRow>(rows, FACT) {
            let (key, FactRow { fact, holds }) = row?;
            let key = format!("{FACT}{key}");
            if key != key_of(FACT, &fact) {
                return Err(Unreadable::new(key, "it is about another fact"));
            }
            changes.push((
                key,
                match holds {
                    true => FactChange::Add(fact),
                    false => FactChange::Remove(fact),
                },
            ));
        }
        for row in read_rows::<ValueRow>(rows, VALUE) {
            let (key, ValueRow { function, value }) = row?;
            let key = format!("{VALUE}{key}");
            if key != key_of(VALUE, &function) {
                return Err(Unreadable::new(key, "it is about another function"));
            }
            changes.push((key, FactChange::Set(function, value)));
        }
        for (key, change) in &changes {
            if !self.is_known(change) {
                let reason = format!("{change} is not in the words of the domain");
                return Err(Unreadable::new(key, reason));
            }
        }
        let changes: Vec<FactChange> = changes.into_iter().map(|(_, change)| change).collect();
        let changes = self.belief.apply_all(&changes);
        self.planner.observe(&changes);
        Ok(())
    }

    fn recall_ended(&mut self, rows: &Rows, next: u64) -> Result<(), Unreadable> {
        self.next_ended = next;
        self.ended.clear();
        let mut due = None;
        for row in read_rows::<EndedRow>(rows, ENDED) {
            let (key, row) = row?;
            let key = format!("{ENDED}{key}");
            let number = due.unwrap_or_else(|| first_number(rows, ENDED));
            if key != numbered(ENDED, number) || number >= next {
                return Err(Unreadable::new(key, "one before it is missing"));
            }
            if !row.outcome.is_end() {
                return Err(Unreadable::new(key, "that is no end"));
            }
            due = Some(number + 1);
            let EndedRow {
                id,
                tasks,
                superior,
                outcome,
                at,
            } = row;
            self.ended.push_back(Ended {
                id,
                tasks,
                superior,
                outcome,
                at,
            });
        }
        match due {
            Some(due) if due != next => Err(Unreadable::new(ENDED, "the last one is missing")),
            _ => Ok(()),
        }
    }

    fn goal(
        &self,
        row: GoalRow,
        map: Arc<Map>,
        executors: &BTreeSet<Symbol>,
        next_frame: &mut u64,
    ) -> Result<Recalled, String> {
        let domain = &self.configuration.domain;
        if row.tasks.is_empty() {
            return Err("it has no task".to_owned());
        }
        for task in &row.tasks {
            understood(domain, task)?;
        }
        let mut reader = Reader::new(domain, row.network)?;
        let mut done_once = BTreeSet::new();
        for frame in row.done_once {
            done_once.insert(reader.number_of_frame(frame)?);
        }
        *next_frame = reader.next_frame.max(*next_frame);
        let agendas = row.agendas.into_iter().map(|agenda| {
            Ok(Agenda {
                tasks: reader.list(agenda.tasks)?,
                origin: origin(agenda.origin),
            })
        });
        let agendas = agendas.collect::<Result<_, String>>()?;
        let plans = row.plans.into_iter().map(|plan| {
            let steps = plan.steps.into_iter().map(|step| reader.step(step));
            Ok(Plan {
                steps: steps.collect::<Result<_, String>>()?,
                rest: reader.list(plan.rest)?,
                cost: crate::model::Cost(plan.cost),
            })
        });
        let plans = plans.collect::<Result<_, String>>()?;
        let records = row.records.into_iter().map(|record| {
            let RecordRow { id, executor, step } = record;
            known_executor(executors, &executor)?;
            let step = reader.step(step)?;
            Ok(Record { id, executor, step })
        });
        let records = records.collect::<Result<_, String>>()?;
        let intention = Intention {
            goal: Goal {
                id: row.id,
                tasks: row.tasks,
                urgency: row.urgency,
                priority: row.priority,
                deadline: row.deadline,
                number: row.number,
                superior: row.superior,
                map,
            },
            agendas,
            plans,
            records,
            started: row.started,
            cancelled: row.cancelled,
            orphaned: row.orphaned,
            fits: row.fits,
            blocked_by: row.blocked_by.into_iter().collect(),
            failures: row.failures.into_iter().collect(),
            failed: row.failed,
            last_failure: row.last_failure,
            lost: row.lost.into_iter().collect(),
            done_once,
        };
        let running = row.running.map(|row| {
            let RunningRow {
                phase,
                resumed,
                set_aside,
                broken,
                surprised,
            } = row;
            let execution = |row| execution(row, &reader, executors);
            Ok::<_, String>(Running {
                intention: intention.clone(),
                phase: match phase {
                    PhaseRow::Planning => Phase::Planning,
                    PhaseRow::Executing(row) => Phase::Executing(execution(row)?),
                    PhaseRow::Stopping(row) => Phase::Stopping(execution(row)?),
                },
                resumed,
                set_aside,
                broken,
                surprised,
                stage: Default::default(),
            })
        });
        Ok(Recalled {
            running: running.transpose()?,
            intention,
            map: row.map,
        })
    }

    /// Puts every goal where it was.
    fn place(&mut self, head: &AgentRow, mut goals: BTreeMap<u64, Recalled>) -> Result<(), String> {
        self.running = None;
        self.stack = SuspendedGoalStack::default();
        self.waiting = WaitingGoals::default();
        self.aside = GoalsAside::default();
        let mut take = |number: u64| {
            let goal = goals.remove(&number);
            goal.ok_or_else(|| format!("goal number {number} is missing"))
        };
        let idle = |goal: Recalled| match goal.running {
            None => Ok(goal.intention),
            Some(running) => {
                let id = running.intention.goal.id;
                Err(format!("{id} is pursued and is not"))
            }
        };
        if let Some(number) = head.running {
            let goal = take(number)?;
            let missing = || format!("how far goal number {number} is, is missing");
            self.running = Some(goal.running.ok_or_else(missing)?);
        }
        for (number, held) in &head.stack {
            let resumed_by = match held {
                true => ResumedBy::Superior,
                false => ResumedBy::Agent,
            };
            self.stack.push(idle(take(*number)?)?, resumed_by);
        }
        for number in &head.waiting {
            self.waiting.add(idle(take(*number)?)?);
        }
        for (number, facts) in &head.aside {
            let waits_for = match facts {
                None => WaitsFor::User,
                Some(facts) => WaitsFor::Facts(facts.iter().cloned().collect()),
            };
            self.aside.add(idle(take(*number)?)?, waits_for);
        }
        match goals.keys().next() {
            None => Ok(()),
            Some(number) => Err(format!("where goal number {number} is, is missing")),
        }
    }
}

impl Memory {
    fn recall_maps(&mut self, rows: &Rows) -> Result<(), Unreadable> {
        for row in read_rows::<MapRow>(rows, MAP) {
            let (key, row) = row?;
            let number = key.parse().ok().filter(|number| *number < HIGHEST);
            let key = format!("{MAP}{key}");
            let Some(number) = number.filter(|number| key == numbered(MAP, *number)) else {
                return Err(Unreadable::new(key, "maps have numbers"));
            };
            self.next_map = self.next_map.max(number + 1);
            self.maps.push((number, Arc::new(map(row))));
        }
        Ok(())
    }

    fn map(&self, number: u64) -> Result<Arc<Map>, String> {
        let found = self.maps.iter().find(|(known, _)| *known == number);
        let found = found.map(|(_, map)| map.clone());
        found.ok_or_else(|| format!("map number {number} is missing"))
    }
}

fn map(row: MapRow) -> Map {
    let facts = row.facts.into_iter().map(FactChange::Add);
    let values = row.values.into_iter();
    let values = values.map(|(function, value)| FactChange::Set(function, value));
    let mut facts: Belief = facts.chain(values).collect();
    for landmarks in row.landmarks {
        facts.add_landmarks(landmarks);
    }
    Map {
        objects: row.objects.into_iter().collect(),
        facts,
        news: row.news,
    }
}

fn execution(
    row: ExecutionRow,
    reader: &Reader<'_>,
    executors: &BTreeSet<Symbol>,
) -> Result<Execution, String> {
    known_executor(executors, &row.executor)?;
    Ok(Execution {
        id: row.id,
        executor: row.executor,
        step: reader.step(row.step)?,
        due: row.due,
        done: row.done,
    })
}

fn known_executor(executors: &BTreeSet<Symbol>, executor: &Symbol) -> Result<(), String> {
    match executors.contains(executor) {
        true => Ok(()),
        false => Err(format!("`{executor}` executes nothing for this agent")),
    }
}

fn origin(row: OriginRow) -> Origin {
    match row {
        OriginRow::Goal => Origin::Goal,
        OriginRow::Tail => Origin::Tail,
        OriginRow::Again => Origin::Again,
        OriginRow::Ancestor => Origin::Ancestor,
        OriginRow::Resume => Origin::Resume,
        OriginRow::Reach => Origin::Reach,
        OriginRow::RollBack => Origin::RollBack,
    }
}

fn needed<T: serde::de::DeserializeOwned>(rows: &Rows, key: &str) -> Result<T, Unreadable> {
    read_row(rows, key)?.ok_or_else(|| Unreadable::new(key, "it is missing"))
}

/// What is not ours was written by something else.
fn all_known(rows: &Rows) -> Result<(), Unreadable> {
    let own = rows.range("m/".to_owned()..).map(|(key, _)| key);
    for key in own.take_while(|key| key.starts_with("m/")) {
        let one = [AGENT, TOLD].contains(&key.as_str());
        let many = [FACT, VALUE, MAP, GOAL, ENDED];
        if !one && !many.iter().any(|prefix| key.starts_with(prefix)) {
            return Err(Unreadable::new(key, "an agent writes no such row"));
        }
    }
    Ok(())
}

/// The number of the first of numbered rows; 0 if there is none.
fn first_number(rows: &Rows, prefix: &str) -> u64 {
    let first = rows.range(prefix.to_owned()..).next();
    let number = first.and_then(|(key, _)| key.strip_prefix(prefix)?.parse().ok());
    number.unwrap_or_default()
}
