//! What may happen to an agent, at random, from a seed: a superior, users, two executors and a
//! world that are made up as it goes along, in ways that may occur.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::convert::Infallible;

use super::toy::{self, spot};
use crate::model::{Fact, FactChange, Symbol, Task, Time};
use crate::protocol::{
    ActionId, Answer, Command, GoalId, GoalRequest, Input, Instruction, Output, Report, Urgency,
};

/// The same numbers for the same seed, everywhere (S. Vigna's splitmix64).
#[derive(Clone, Debug)]
pub struct Dice(u64);

impl Dice {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// Less than `sides`.
    pub fn roll(&mut self, sides: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % sides.max(1) as u64) as usize
    }

    /// True in so many of a hundred cases.
    pub fn chance(&mut self, percent: usize) -> bool {
        self.roll(100) < percent
    }

    /// One of several.
    pub fn pick<'a, T>(&mut self, from: &'a [T]) -> &'a T {
        &from[self.roll(from.len())]
    }
}

/// What a superior knows of an instruction of its own.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Given {
    Running,
    Stopping,
    Suspended,
}

/// What happens next depends on what the agent has said.
#[derive(Clone, Debug)]
pub struct History {
    dice: Dice,
    pub now: Time,
    /// What is on the way to each executor.
    down: BTreeMap<Symbol, VecDeque<Instruction>>,
    /// What each executor does; whether it is stopping.
    acting: BTreeMap<Symbol, (ActionId, Task, bool)>,
    /// What executors keep.
    records: BTreeMap<ActionId, Task>,
    given: BTreeMap<ActionId, Given>,
    next_given: u64,
    goals: Vec<GoalId>,
    gone: BTreeSet<Symbol>,
}

const NEIGHBOURS: [&str; 3] = ["boss", "left", "right"];

impl History {
    pub fn new(seed: u64) -> Self {
        Self {
            dice: Dice::new(seed),
            now: Time::ZERO,
            down: BTreeMap::new(),
            acting: BTreeMap::new(),
            records: BTreeMap::new(),
            given: BTreeMap::new(),
            next_given: 1,
            goals: Vec::new(),
            gone: BTreeSet::new(),
        }
    }

    /// What the agent has said.
    pub fn hear(&mut self, outputs: &[Output<Infallible>]) {
        for output in outputs {
            match output {
                Output::Instruct { to, instruction } => {
                    let down = self.down.entry(to.clone()).or_default();
                    down.push_back(instruction.clone());
                }
                Output::Report { id, report, .. } => match report {
                    Report::Suspended { .. } => {
                        self.given.insert(id.clone(), Given::Suspended);
                    }
                    report if report.is_end() => {
                        self.given.remove(id);
                    }
                    _ => {}
                },
                Output::Observed { .. } | Output::Seen { .. } | Output::Event(_) => {}
                Output::Local(never) => match *never {},
            }
        }
    }

    /// What somebody who has just begun is told of the others.
    pub fn neighbours(&self) -> Vec<Input<Infallible>> {
        let neighbours = NEIGHBOURS.map(|name| {
            let name = Symbol::from(name);
            let there = !self.gone.contains(&name);
            Input::Neighbour { name, there }
        });
        neighbours.into()
    }

    /// What happens next.
    pub fn next(&mut self) -> Input<Infallible> {
        let passes = [0, 0, 1, 1, 10, 100][self.dice.roll(6)];
        self.now = self.now + Time::from_secs(passes as f64);
        loop {
            let input = match self.dice.roll(100) {
                0..=29 => self.delivered(),
                30..=54 => self.reported(),
                55..=66 => Some(self.asked()),
                67..=78 => Some(self.instructed()),
                79..=83 => self.commanded(),
                84..=92 => Some(self.observed()),
                93..=96 => Some(self.neighbour()),
                97 => Some(self.reborn()),
                _ => Some(Input::Wake),
            };
            if let Some(input) = input {
                return input;
            }
        }
    }

    fn delivered(&mut self) -> Option<Input<Infallible>> {
        let waiting: Vec<Symbol> = self.down.keys().cloned().collect();
        if waiting.is_empty() {
            return None;
        }
        let executor = self.dice.pick(&waiting).clone();
        let to = self.down.get_mut(&executor)?.pop_front();
        let Some(to) = to else {
            self.down.remove(&executor);
            return None;
        };
        let answer = match &to {
            Instruction::Execute { id, action, .. } => {
                let doing = (id.clone(), action.clone(), false);
                self.acting.insert(executor, doing);
                match self.dice.chance(4) {
                    true => Answer::Rejected {
                        reason: "not now".to_owned(),
                    },
                    false => Answer::Accepted,
                }
            }
            Instruction::Resume { id, .. } => match self.records.remove(id) {
                Some(task) => {
                    self.acting.insert(executor, (id.clone(), task, false));
                    Answer::Accepted
                }
                None => Answer::Rejected {
                    reason: "there is no record".to_owned(),
                },
            },
            Instruction::Suspend { id } => match self.acting.get_mut(&executor) {
                Some((acting, _, stopping)) if acting == id => {
                    *stopping = true;
                    match self.dice.chance(10) {
                        true => Answer::Refused {
                            finishes_in: Time::from_secs(3.0),
                        },
                        false => Answer::Suspending,
                    }
                }
                _ => Answer::Finished {
                    outcome: Report::Success { facts: Vec::new() },
                },
            },
            Instruction::Clear { id } => {
                self.records.remove(id);
                Answer::Accepted
            }
        };
        Some(Input::Answer { to, answer })
    }

    fn reported(&mut self) -> Option<Input<Infallible>> {
        let executors: Vec<Symbol> = self.acting.keys().cloned().collect();
        if executors.is_empty() {
            return None;
        }
        let executor = self.dice.pick(&executors).clone();
        let (id, task, stopping) = self.acting.get(&executor)?.clone();
        let facts = self.facts();
        let reason = "something was in the way".to_owned();
        let report = match self.dice.roll(20) {
            0 => Report::Started,
            1 => Report::Failure {
                reason,
                facts,
                blocked_by: self.blocked(),
            },
            2 => Report::Unknown { reason, facts },
            3 => Report::Suspended { facts },
            4 => Report::Progress { fraction: 0.5 },
            _ if stopping && self.dice.chance(70) => Report::Suspended { facts },
            _ => Report::Success { facts },
        };
        if let Report::Suspended { .. } = report {
            self.records.insert(id.clone(), task);
        }
        if report.is_end() || matches!(report, Report::Suspended { .. }) {
            self.acting.remove(&executor);
        }
        Some(Input::Report { id, report })
    }

    /// Mostly nothing but what was expected.
    fn facts(&mut self) -> Vec<FactChange> {
        match self.dice.roll(8) {
            0 => vec![FactChange::Set(self.fact("far"), self.dice.roll(4) as f64)],
            1 => vec![self.door()],
            2 => vec![FactChange::Add(Fact::new("strange", ["s1"]))],
            _ => Vec::new(),
        }
    }

    fn blocked(&mut self) -> Vec<Fact> {
        match self.dice.chance(50) {
            true => vec![self.door_fact()],
            false => Vec::new(),
        }
    }

    fn fact(&mut self, name: &str) -> Fact {
        Fact::new(name, [spot(self.dice.roll(9)).as_str()])
    }

    fn task(&mut self) -> Task {
        let (a, b) = (spot(self.dice.roll(9)), spot(self.dice.roll(9)));
        match self.dice.roll(5) {
            0 | 1 => Task::new("go", [a.as_str()]),
            2 | 3 => Task::new("tell", [a.as_str()]),
            _ => Task::new("tour", [a.as_str(), b.as_str()]),
        }
    }

    fn asked(&mut self) -> Input<Infallible> {
        let named = self.dice.chance(70);
        let id: GoalId = format!("goal{}", self.dice.roll(40)).into();
        if named {
            self.goals.push(id.clone());
        }
        let tasks = (0..1 + self.dice.roll(2)).map(|_| self.task()).collect();
        Input::Goal(GoalRequest {
            id: named.then_some(id),
            tasks,
            urgency: match self.dice.chance(50) {
                true => Urgency::Normal,
                false => Urgency::Emergency,
            },
            priority: self.dice.roll(3) as i32,
            deadline: match self.dice.chance(15) {
                true => Some(Time::from_secs(50.0)),
                false => None,
            },
        })
    }

    fn instructed(&mut self) -> Input<Infallible> {
        let known: Vec<(ActionId, Given)> =
            self.given.iter().map(|(id, g)| (id.clone(), *g)).collect();
        let new = known.is_empty() || self.dice.chance(40);
        let map = match self.dice.roll(3) {
            0 => None,
            1 => Some(toy::map(false)),
            _ => Some(toy::map(true)),
        };
        let instruction = match new {
            true => {
                let id = ActionId {
                    agent: "boss".into(),
                    epoch: 7,
                    number: self.next_given,
                };
                self.next_given += 1;
                self.given.insert(id.clone(), Given::Running);
                Instruction::Execute {
                    id,
                    action: self.task(),
                    map,
                }
            }
            false => {
                let (id, given) = self.dice.pick(&known).clone();
                match given {
                    Given::Running => {
                        self.given.insert(id.clone(), Given::Stopping);
                        Instruction::Suspend { id }
                    }
                    Given::Stopping => Instruction::Suspend { id },
                    Given::Suspended if self.dice.chance(30) => {
                        self.given.remove(&id);
                        Instruction::Clear { id }
                    }
                    Given::Suspended => {
                        self.given.insert(id.clone(), Given::Running);
                        Instruction::Resume { id, map }
                    }
                }
            }
        };
        Input::Instruction {
            from: "boss".into(),
            instruction,
        }
    }

    fn commanded(&mut self) -> Option<Input<Infallible>> {
        if self.goals.is_empty() {
            return None;
        }
        let goal = self.dice.pick(&self.goals).clone();
        Some(Input::Command(match self.dice.roll(5) {
            0 | 1 => Command::Suspend(goal),
            2 | 3 => Command::Resume(goal),
            _ => Command::Cancel(goal),
        }))
    }

    fn door_fact(&mut self) -> Fact {
        let at = self.dice.roll(toy::SPOTS - 1);
        let (a, b) = (spot(at), spot(at + 1));
        match self.dice.chance(50) {
            true => Fact::new("open", [a.as_str(), &b]),
            false => Fact::new("open", [b.as_str(), &a]),
        }
    }

    fn door(&mut self) -> FactChange {
        let door = self.door_fact();
        match self.dice.chance(60) {
            true => FactChange::Add(door),
            false => FactChange::Remove(door),
        }
    }

    fn observed(&mut self) -> Input<Infallible> {
        Input::Observation(match self.dice.roll(4) {
            0 => vec![FactChange::Set(self.fact("far"), self.dice.roll(3) as f64)],
            _ => vec![self.door()],
        })
    }

    fn neighbour(&mut self) -> Input<Infallible> {
        let name: Symbol = (*self.dice.pick(&NEIGHBOURS)).into();
        let there = self.gone.remove(&name);
        if !there {
            self.gone.insert(name.clone());
        }
        Input::Neighbour { name, there }
    }

    fn reborn(&mut self) -> Input<Infallible> {
        let name: Symbol = (*self.dice.pick(&NEIGHBOURS)).into();
        match name.as_str() {
            "boss" => self.given.clear(),
            _ => {
                self.acting.remove(&name);
                self.down.remove(&name);
                // Whose records they are is not known here: those of the other are missed too.
                self.records.clear();
            }
        }
        Input::Reborn { name }
    }
}
