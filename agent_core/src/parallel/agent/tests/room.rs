//! The bistro in virtual time: what really is, and the carrier's parts, which do what they are told.

use std::collections::{BTreeMap, BTreeSet};
use std::convert::Infallible;
use std::sync::Arc;

use super::bistro;
use crate::language::{parse_atom, parse_tasks};
use crate::model::{Action, Belief, FactChange, Symbol, Time};
use crate::planner::{
    self, AnyPlanner, Item, PlannerKind, Problem, Settings, Step, TaskList, simulate,
};
use crate::protocol::{
    ActionId, Answer, Command, Durable, Event, GoalRequest, Happening, Input, Instruction, Machine,
    Output, Reply, Report, Row, Rows, Urgency,
};

/// A machine that drives the carrier.
pub trait Driver: Machine<In = Infallible, Out = Infallible> + Durable {
    fn check_all(&self);
}

pub fn planner(kind: PlannerKind) -> AnyPlanner {
    AnyPlanner::new(kind, Settings::default())
}

struct Job {
    step: Step,
    ends: Time,
}

/// What is to happen when.
#[derive(Clone, Debug)]
pub enum Plot {
    Goal(&'static str, String, Urgency, i32),
    Fact(FactChange),
    Command(Command),
    Restart,
}

pub struct Room<M> {
    pub machine: M,
    make: Box<dyn Fn(u64) -> M>,
    pub now: Time,
    epoch: u64,
    rows: Rows,
    problem: Problem,
    jobs: BTreeMap<ActionId, Job>,
    records: BTreeMap<ActionId, Action>,
    /// How much longer everything takes than it says, in per cent: one after another.
    pub tempo: Vec<u64>,
    begun: usize,
    plot: Vec<(Time, Plot)>,
    /// What was begun and suspended, with the time.
    pub log: Vec<String>,
    pub events: Vec<Event>,
    pub reports: Vec<(Symbol, ActionId, Report)>,
    pub replies: Vec<Reply>,
    to_deliver: Vec<Input<Infallible>>,
}

impl<M: Driver> Room<M> {
    pub fn new(make: impl Fn(u64) -> M + 'static) -> Self {
        let configuration = bistro::configuration(1);
        let belief: Belief = configuration.facts.iter().cloned().collect();
        Self {
            machine: make(1),
            make: Box::new(make),
            now: Time::ZERO,
            epoch: 1,
            rows: Rows::new(),
            problem: Problem {
                domain: configuration.domain,
                model: configuration.model,
                map: Arc::new(configuration.map),
                belief: Arc::new(belief),
                forbidden: BTreeSet::new(),
            },
            jobs: BTreeMap::new(),
            records: BTreeMap::new(),
            tempo: vec![100],
            begun: 0,
            plot: Vec::new(),
            log: Vec::new(),
            events: Vec::new(),
            reports: Vec::new(),
            replies: Vec::new(),
            to_deliver: Vec::new(),
        }
    }

    pub fn at(&mut self, seconds: f64, plot: Plot) {
        self.plot.push((Time::from_secs(seconds), plot));
        self.plot.sort_by_key(|(at, _)| *at);
    }

    pub fn goal_at(&mut self, seconds: f64, name: &'static str, task: &str, urgency: Urgency) {
        self.at(seconds, Plot::Goal(name, task.to_owned(), urgency, 0));
    }

    pub fn holds(&self, text: &str) -> bool {
        self.problem.belief.holds(&bistro::fact(text))
    }

    /// Everything that happens until nothing does any more, or that time has come.
    pub fn play(&mut self, until: f64) {
        self.give(Input::Wake);
        let until = Time::from_secs(until);
        loop {
            let job = self.jobs.values().map(|job| job.ends).min();
            let plot = self.plot.first().map(|(at, _)| *at);
            let wake = self.machine.wake_at();
            let Some(next) = [job, plot, wake].into_iter().flatten().min() else {
                return;
            };
            if next > until {
                return;
            }
            self.now = self.now.max(next);
            if plot == Some(next) {
                let (_, plot) = self.plot.remove(0);
                self.happen(plot);
            } else if job == Some(next) {
                self.finish();
            } else {
                self.give(Input::Wake);
            }
        }
    }

    fn happen(&mut self, plot: Plot) {
        match plot {
            Plot::Goal(name, task, urgency, priority) => {
                let reply = self.give(Input::Goal(GoalRequest {
                    id: Some(name.into()),
                    tasks: parse_tasks(&task).expect("tasks"),
                    urgency,
                    priority,
                    deadline: None,
                }));
                self.replies.extend(reply);
            }
            Plot::Fact(change) => {
                Arc::make_mut(&mut self.problem.belief).apply(&change);
                self.give(Input::Observation(vec![change]));
            }
            Plot::Command(command) => {
                let reply = self.give(Input::Command(command));
                self.replies.extend(reply);
            }
            Plot::Restart => self.restart(),
        }
    }

    /// The process dies and is started again; the carrier's parts go on.
    pub fn restart(&mut self) {
        self.epoch += 1;
        self.machine = (self.make)(self.epoch);
        let recalled = self.machine.recall(&self.rows);
        recalled.expect("what was written down can be read");
        self.machine.check_all();
        self.give(Input::Wake);
    }

    /// What was written down.
    pub fn rows(&self) -> &Rows {
        &self.rows
    }

    /// A machine that remembers nothing.
    pub fn made(&self) -> M {
        (self.make)(self.epoch + 1)
    }

    /// Another machine goes on where that of another room was.
    pub fn go_on_from(&mut self, other: Self, machine: M) {
        let make = std::mem::replace(&mut self.make, Box::new(|_| unreachable!("it is replaced")));
        *self = Self {
            machine,
            make,
            epoch: other.epoch + 1,
            ..other
        };
    }

    /// The job that ends first, the oldest among several.
    fn finish(&mut self) {
        let ending = self
            .jobs
            .iter()
            .min_by_key(|(id, job)| (job.ends, id.number));
        let id = ending.map(|(id, _)| id.clone()).expect("something ends");
        let job = self.jobs.remove(&id).expect("it is there");
        let broken = planner::broken_protection(&self.problem, &job.step);
        let action = job.step.action();
        assert_eq!(broken, None, "{}: {action} was spoilt", self.now);
        let facts = planner::effect_of(&self.problem, action);
        Arc::make_mut(&mut self.problem.belief).apply_all(&facts);
        self.log
            .push(format!("{:.0} done {action}", self.now.secs()));
        self.give(Input::Report {
            id,
            report: Report::Success { facts },
        });
    }

    pub fn give(&mut self, input: Input<Infallible>) -> Option<Reply> {
        let reply = self.tell(input);
        while !self.to_deliver.is_empty() {
            let next = self.to_deliver.remove(0);
            self.tell(next);
        }
        reply
    }

    fn tell(&mut self, input: Input<Infallible>) -> Option<Reply> {
        let reply = self.machine.handle(self.now, input);
        let mut rounds = 0;
        while self.machine.wake_at() == Some(Time::ZERO) {
            self.machine.handle(self.now, Input::Wake);
            rounds += 1;
            assert!(rounds < 10_000, "{}: it never comes to rest", self.now);
        }
        self.machine.check_all();
        while let Some(output) = self.machine.poll_output() {
            match output {
                Output::Instruct { to, instruction } => {
                    assert_eq!(to, "room");
                    let (answer, report) = self.obey(&instruction);
                    let id = instruction.id().clone();
                    self.to_deliver.push(Input::Answer {
                        to: instruction,
                        answer,
                    });
                    if let Some(report) = report {
                        self.to_deliver.push(Input::Report { id, report });
                    }
                }
                Output::Report { to, id, report } => self.reports.push((to, id, report)),
                Output::Event(event) => self.events.push(event),
                Output::Seen { .. } | Output::Observed { .. } => {}
                Output::Local(never) => match never {},
            }
        }
        for Row { key, value } in self.machine.write_down() {
            match value {
                Some(value) => self.rows.insert(key, value),
                None => self.rows.remove(&key),
            };
        }
        reply
    }

    fn obey(&mut self, instruction: &Instruction) -> (Answer, Option<Report>) {
        let id = instruction.id().clone();
        match instruction {
            Instruction::Execute { action, .. } => {
                self.begin(id, Item::Task(action.clone()));
                (Answer::Accepted, None)
            }
            Instruction::Resume { .. } => {
                let purpose = self.records.remove(&id).expect("there is a record of it");
                let model = &self.problem.model.actions[&purpose.name];
                let suspension = model.suspension.as_ref().expect("it was suspended");
                let resume = planner::instance(&suspension.resume, &purpose);
                let item = Item::Resume {
                    id: id.clone(),
                    action: resume.expect("it is bound"),
                    original: purpose,
                };
                self.begin(id, item);
                (Answer::Accepted, None)
            }
            Instruction::Suspend { .. } => {
                let job = self.jobs.remove(&id).expect("it runs");
                self.log
                    .push(format!("{:.0} stop {}", self.now.secs(), job.step.action()));
                let purpose = job.step.purpose();
                let facts = planner::effect_of_suspension(&self.problem, purpose);
                Arc::make_mut(&mut self.problem.belief).apply_all(&facts);
                self.records.insert(id, purpose.clone());
                (Answer::Suspending, Some(Report::Suspended { facts }))
            }
            Instruction::Clear { .. } => {
                self.records.remove(&id);
                (Answer::Accepted, None)
            }
        }
    }

    fn begin(&mut self, id: ActionId, item: Item) {
        let action = item.atom().clone();
        let step = Step {
            item,
            cost: crate::model::Cost::ZERO,
            frame: None,
            rest: TaskList::empty(),
        };
        let possible = simulate(&self.problem, std::slice::from_ref(&step), false);
        assert!(possible.is_ok(), "{}: {action}: {possible:?}", self.now);
        let model = |action: &Action| self.problem.model.actions[&action.name].clone();
        let needed: BTreeSet<Symbol> = model(&action).resources.into_iter().collect();
        for job in self.jobs.values() {
            let taken = model(job.step.action()).resources;
            let free = taken.iter().all(|it| !needed.contains(it));
            assert!(free, "{}: {action} while {:?} runs", self.now, job.step);
        }
        let duration = model(&action).duration_s.expect("it says how long");
        let seconds = planner::number_of(&self.problem, &duration, &action).expect("a number");
        let tempo = self.tempo[self.begun % self.tempo.len()];
        self.begun += 1;
        let takes = Time((seconds * 1e4) as u64 * tempo);
        self.log.push(format!("{:.0} {action}", self.now.secs()));
        self.jobs.insert(
            id,
            Job {
                step,
                ends: self.now + takes,
            },
        );
    }

    /// The actions in the order in which they were begun, without times.
    pub fn begun(&self) -> Vec<String> {
        let lines = self.log.iter().filter_map(|line| line.split_once(" ("));
        let begun = lines.filter(|(time, _)| !time.contains(' '));
        begun.map(|(_, action)| format!("({action}")).collect()
    }

    /// When each of the goals was reached, in seconds.
    pub fn succeeded(&self) -> BTreeMap<String, u64> {
        let ends = self.events.iter().filter_map(|event| {
            let reached = matches!(event.what, Happening::GoalSucceeded);
            reached.then(|| (event.goal.clone(), event.at.secs().round() as u64))
        });
        ends.filter_map(|(goal, at)| Some((goal?.to_string(), at)))
            .collect()
    }

    /// How often something happened.
    pub fn count(&self, is: impl Fn(&Happening) -> bool) -> usize {
        self.events.iter().filter(|event| is(&event.what)).count()
    }
}

/// An instruction of the waiter's.
pub fn execute(number: u64, task: &str) -> Input<Infallible> {
    Input::Instruction {
        from: "k2".into(),
        instruction: Instruction::Execute {
            id: order(number),
            action: parse_atom(task).expect("a task"),
            map: None,
        },
    }
}

pub fn order(number: u64) -> ActionId {
    ActionId {
        agent: "k2".into(),
        epoch: 7,
        number,
    }
}
