//! The task service: who does what.
//!
//! A task has one *publisher*, and the publisher alone decides who does it: that is why it is done
//! once. It offers the task to all, vehicles bid, and the cheapest gets it as an instruction, which
//! is delivered and reported on as any other. What could still go wrong is that a vehicle which was
//! given up goes on. Two fences stand against that:
//!
//! - Each offer names an execution, and a vehicle begins none that it has not bid for since it was
//!   started. So an instruction that comes late begins nothing.
//! - A vehicle has a task for a *lease* only, from the last time that the publisher was heard to say
//!   that it has it. Whoever is not heard of is no longer named, and when its lease has run out for
//!   certain the task is offered again. A vehicle that is cut off, or was frozen, finds its lease run
//!   out before it does anything else.
//!
//! Tasks of a publisher that is gone stay with it: it takes them up when it is started again.

mod memory;
mod publisher;
#[cfg(test)]
mod tests;
mod worker;

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use serde::{Deserialize, Serialize};

use super::message::{Bid, Body, Message, Offer, TaskId, Tasks};
use crate::model::{Fact, Symbol, Task, Time};
use crate::protocol::{ActionId, Ledger, Report, Urgency};

/// Spans of time, on the world's clock.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Times {
    /// Between two times that a vehicle says how its tasks stand.
    pub beat: Time,
    /// Bids are waited for this long, unless all have come.
    pub bid_window: Time,
    /// How long a task that was given is one's own after the publisher has said so last.
    pub lease: Time,
    /// How long something may take to come to rest. So long after a lease has run out the task is
    /// offered again.
    pub rest: Time,
}

impl Times {
    /// For a world that runs so many times as fast as the vehicles' own time: messages take as long as
    /// they take, whatever the world does.
    pub fn at_speed(speed: f64) -> Self {
        let times = Self::default();
        let scale = |time: Time| Time::from_secs(time.secs() * speed.max(1.0));
        Self {
            beat: scale(times.beat),
            bid_window: scale(times.bid_window),
            lease: scale(times.lease),
            // The world's own business.
            rest: times.rest,
        }
    }
}

impl Default for Times {
    fn default() -> Self {
        Self {
            beat: Time(1_000_000),
            bid_window: Time(300_000),
            lease: Time(4_000_000),
            rest: Time(3_000_000),
        }
    }
}

/// A task to be done.
#[derive(Clone, Debug, Eq, PartialEq, Serialize, Deserialize)]
pub struct NewTask {
    /// What.
    pub what: Task,
    /// Normal or emergency.
    pub urgency: Urgency,
    /// As of a goal.
    pub priority: i32,
    /// When it has failed, on the world's clock.
    pub deadline: Option<Time>,
}

/// A task of ours.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Published {
    /// What is to be done.
    pub new: NewTask,
    /// The execution that is offered or given at present.
    pub id: ActionId,
    /// Whether somebody has it.
    pub stage: Stage,
    /// Those who had it before, and as which execution.
    pub before: Vec<(ActionId, Symbol)>,
    /// How often it has failed, by whom.
    pub failures: BTreeMap<Symbol, u32>,
    /// Why it has failed last.
    pub last_failure: String,
    /// When the execution was named last.
    #[serde(skip)]
    named: Option<Time>,
    /// When it was offered first.
    #[serde(skip)]
    offered: Option<Time>,
    #[serde(skip)]
    bids: BTreeMap<Symbol, (Time, Bid)>,
}

/// How far a task of ours is.
#[derive(Clone, Debug, Eq, PartialEq, Serialize, Deserialize)]
pub enum Stage {
    /// Nobody has it.
    Open,
    /// Somebody has it.
    Given {
        /// Who.
        to: Symbol,
        /// Whether that one was lost sight of, or we were away, since: then it has not failed if it
        /// gives the task back.
        away: bool,
    },
}

/// A task that was given to us.
#[derive(Clone, Debug, Eq, PartialEq, Serialize, Deserialize)]
pub struct Taken {
    /// By whom.
    pub publisher: Symbol,
    /// Its name.
    pub task: TaskId,
    /// What is to be done.
    pub what: Task,
    /// Normal or emergency.
    pub urgency: Urgency,
    /// As of a goal.
    pub priority: i32,
    /// When the publisher was heard last to say that it is ours.
    #[serde(skip)]
    pub named: Time,
    /// It is being given up.
    pub given_up: bool,
}

/// How the tasks of another stand, as far as was heard.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Heard {
    /// When it was said.
    pub at: Time,
    /// What was said.
    pub tasks: Tasks,
}

/// How a task has ended.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Outcome {
    /// It is done.
    Done {
        /// Who has done it; `None` if it needed no doing any more.
        by: Option<Symbol>,
    },
    /// It was given up.
    Failed {
        /// In words.
        reason: String,
    },
    /// Nobody knows whether it was done, and it must not be done twice.
    Unknown {
        /// In words.
        reason: String,
    },
}

/// Why an execution is not begun.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
pub enum Unwilling {
    /// It was not bid for since the start.
    #[error("{0} has not bid for {1} since it was started")]
    NotBidFor(Symbol, ActionId),
    /// It comes too late.
    #[error("{0} comes too late: it may have been given to somebody else since")]
    TooLate(ActionId),
}

/// What the service wants done.
#[derive(Clone, Debug, PartialEq)]
pub enum TaskOutput {
    /// Say it to all.
    Say(Message),
    /// Find out what it would take to do this, and answer with [`TaskService::assessed`].
    Assess(Offer),
    /// Instruct that vehicle, perhaps ourselves, to execute the task.
    Give {
        /// Whom.
        to: Symbol,
        /// As which execution.
        id: ActionId,
        /// What.
        what: Task,
        /// Normal or emergency.
        urgency: Urgency,
        /// As of a goal.
        priority: i32,
    },
    /// Have that vehicle, perhaps ourselves, stop that execution and forget it, if it still knows of it.
    TakeBack {
        /// Whom.
        from: Symbol,
        /// Which.
        id: ActionId,
    },
    /// Stop that execution, which is not ours any more, forget it, and report so
    /// ([`Report::Suspended`]: it has not failed).
    GiveUp {
        /// Who has given it.
        publisher: Symbol,
        /// Which.
        id: ActionId,
        /// In words.
        reason: String,
    },
    /// A task of ours is over.
    Ended {
        /// Which.
        task: TaskId,
        /// What was to be done.
        what: Task,
        /// How.
        outcome: Outcome,
    },
}

/// Who does what, as one vehicle sees and decides it.
#[derive(Clone, Debug)]
pub struct TaskService {
    name: Symbol,
    epoch: u64,
    times: Times,
    next: u64,
    published: BTreeMap<TaskId, Published>,
    taken: BTreeMap<ActionId, Taken>,
    /// What we have bid for since we were started: the offer, and when it was last heard.
    promises: BTreeMap<ActionId, Promise>,
    /// The other vehicles that are there, and when they were heard last.
    vehicles: BTreeMap<Symbol, Time>,
    heard: BTreeMap<Symbol, Heard>,
    /// Whoever is in here has been asked what an offer would cost us, for a time.
    asked: BTreeMap<ActionId, Time>,
    digest: u64,
    now: Time,
    began: Option<Time>,
    said: Option<Time>,
    /// Something is different from what was said last.
    news: bool,
    recalled: bool,
    outputs: VecDeque<TaskOutput>,
    ledger: Ledger,
}

/// What we have said that we would do.
#[derive(Clone, Debug)]
struct Promise {
    offer: Offer,
    publisher: Symbol,
    named: Time,
}

impl TaskService {
    /// The service of the vehicle of that name, for a start of that epoch.
    pub fn new(name: Symbol, epoch: u64, times: Times) -> Self {
        Self {
            name,
            epoch,
            times,
            next: 1,
            published: BTreeMap::new(),
            taken: BTreeMap::new(),
            promises: BTreeMap::new(),
            vehicles: BTreeMap::new(),
            heard: BTreeMap::new(),
            asked: BTreeMap::new(),
            digest: 0,
            now: Time::ZERO,
            began: None,
            said: None,
            news: true,
            recalled: false,
            outputs: VecDeque::new(),
            ledger: Ledger::default(),
        }
    }

    /// The tasks that we have published and that are not over.
    pub fn published(&self) -> &BTreeMap<TaskId, Published> {
        &self.published
    }

    /// The tasks that were given to us.
    pub fn taken(&self) -> &BTreeMap<ActionId, Taken> {
        &self.taken
    }

    /// How the tasks of the others stand, as far as was heard.
    pub fn heard_of(&self) -> &BTreeMap<Symbol, Heard> {
        &self.heard
    }

    /// The other vehicles that are there.
    pub fn vehicles(&self) -> impl Iterator<Item = &Symbol> {
        self.vehicles.keys()
    }

    /// Whether that vehicle is there.
    pub fn is_there(&self, name: &Symbol) -> bool {
        self.vehicles.contains_key(name)
    }

    /// Whether an execution is one of a task that we have published, be that over or not.
    pub fn is_own(&self, id: &ActionId) -> bool {
        id.agent == self.name
    }

    /// The task of ours that this execution is one of.
    pub fn task_of_execution(&self, id: &ActionId) -> Option<&TaskId> {
        let mut all = self.published.iter();
        all.find(|(_, task)| task.id == *id).map(|(task, _)| task)
    }

    /// The tasks of ours that somebody has.
    pub fn given_to(&self, name: &Symbol) -> impl Iterator<Item = &Published> {
        let has =
            move |task: &&Published| matches!(&task.stage, Stage::Given { to, .. } if to == name);
        self.published.values().filter(has)
    }

    /// Whether it is still of interest what that execution would cost.
    pub fn is_offered(&self, id: &ActionId) -> bool {
        let own = self.published.values();
        let mut own = own.filter(|task| task.stage == Stage::Open);
        own.any(|task| task.id == *id) || self.asked.contains_key(id)
    }

    /// A name that no task of ours has.
    pub fn free_name(&self) -> TaskId {
        let mut names = (self.next..).map(|number| TaskId::from(format!("{}.{number}", self.name)));
        let free = names.find(|name| !self.published.contains_key(name));
        // Numbers do not run out.
        free.unwrap_or_default()
    }

    /// What the service wants done next.
    pub fn poll_output(&mut self) -> Option<TaskOutput> {
        self.outputs.pop_front()
    }

    /// The sum over the facts that we know is this now: it is said with our tasks.
    pub fn set_digest(&mut self, digest: u64) {
        self.digest = digest;
    }

    /// It is `now`. Does what is due, which is also to be called after everything that was told.
    pub fn settle(&mut self, now: Time) {
        self.now = self.now.max(now);
        let now = self.now;
        self.began.get_or_insert(now);
        self.take_up();
        self.lose_the_silent();
        self.let_leases_run_out();
        self.decide();
        let due = self.said.is_none_or(|said| said + self.times.beat <= now);
        if due || self.news {
            self.say_how_tasks_stand();
        }
    }

    /// When [`settle`](Self::settle) is due.
    pub fn wake_at(&self) -> Option<Time> {
        let beat = self.said.map_or(Time::ZERO, |said| said + self.times.beat);
        let leases = self.taken.values().filter(|taken| !taken.given_up);
        let leases = leases
            .filter(|taken| taken.publisher != self.name)
            .map(|taken| taken.named + self.times.lease);
        let own = self.published.values().filter_map(|task| self.due(task));
        leases.chain(own).chain([beat]).min()
    }

    /// Another vehicle has said something about tasks.
    pub fn heard(&mut self, message: &Message) {
        let Message { by, at, body } = message;
        if *by == self.name {
            return;
        }
        match body {
            Body::Tasks(tasks) => {
                self.seen(by, *at);
                self.heard_tasks(by, *at, tasks);
            }
            Body::Bid(bid) => self.heard_bid(by, *at, bid),
            Body::Told(_) | Body::Need(_) | Body::Goal(_) => {}
        }
    }

    /// A vehicle has said at that time that it lives.
    fn seen(&mut self, name: &Symbol, at: Time) {
        let at = at.min(self.now);
        if at + self.times.lease < self.now {
            return;
        }
        match self.vehicles.get_mut(name) {
            Some(heard) => *heard = at.max(*heard),
            None => {
                self.vehicles.insert(name.clone(), at);
                // It is to know how things stand.
                self.news = true;
            }
        }
    }

    /// A vehicle, or somebody else, has appeared or vanished.
    pub fn neighbour(&mut self, name: &Symbol, there: bool) {
        if there {
            // That it is a vehicle it says itself; it is to know how things stand.
            self.news = true;
        } else if self.vehicles.remove(name).is_some() {
            self.lost(name);
        }
    }

    /// Somebody has lost its memory.
    pub fn reborn(&mut self, name: &Symbol) {
        // What it had, the one who bears its name now has not.
        self.has_forgotten(name);
        self.taken.retain(|_, taken| taken.publisher != *name);
        self.promises.retain(|_, made| made.publisher != *name);
        self.heard.remove(name);
    }

    /// The other vehicles have not said anything for so long that they count as gone.
    fn lose_the_silent(&mut self) {
        let patience = self.times.lease;
        let silent: Vec<Symbol> = self
            .vehicles
            .iter()
            .filter(|(_, heard)| **heard + patience < self.now)
            .map(|(name, _)| name.clone())
            .collect();
        for name in silent {
            self.vehicles.remove(&name);
            self.lost(&name);
        }
    }

    fn say_how_tasks_stand(&mut self) {
        self.news = false;
        self.said = Some(self.now);
        let tasks = self.how_tasks_stand();
        self.say(Body::Tasks(tasks));
    }

    fn say(&mut self, body: Body) {
        self.outputs.push_back(TaskOutput::Say(Message {
            by: self.name.clone(),
            at: self.now,
            body,
        }));
    }

    /// What the vehicle has found out about an offer: how long until it would have done it, or that
    /// it cannot, and what it would have to know to tell.
    pub fn assessed(&mut self, offer: &Offer, cost: Option<Time>, lacks: BTreeSet<Fact>) {
        let bid = Bid {
            id: offer.id.clone(),
            cost,
            lacks: lacks.into_iter().collect(),
        };
        if offer.id.agent == self.name {
            let (name, now) = (self.name.clone(), self.now);
            self.heard_bid(&name, now, &bid);
        } else {
            self.bid(offer, bid);
        }
    }

    /// How a task of ours that somebody has goes on. `false`: it is none of ours.
    pub fn reported(&mut self, id: &ActionId, report: &Report) -> bool {
        let Some(by) = self.executor_of(id).cloned() else {
            return false;
        };
        self.over(&by, id, report);
        true
    }
}
