//! The publisher's part: to offer, to decide, to offer again.

use std::collections::BTreeMap;

use super::{NewTask, Outcome, Published, Stage, TaskOutput, TaskService};
use crate::model::{Symbol, Time};
use crate::protocol::{ActionId, Answer, Report};
use crate::service::message::{Award, Bid, Offer, TaskId, Tasks};

/// Whoever has failed so often is not given the task again.
const MOST_FAILURES: u32 = 3;

impl TaskService {
    /// Publishes a task under that name, or one made up. One of that name that is not over is not
    /// published again.
    pub fn publish(&mut self, task: Option<TaskId>, new: NewTask) -> TaskId {
        let id = self.next_execution();
        let task = task.unwrap_or_else(|| format!("{}.{}", self.name, id.number).into());
        if self.published.contains_key(&task) {
            return task;
        }
        let published = Published {
            new,
            id,
            stage: Stage::Open,
            before: Vec::new(),
            failures: BTreeMap::new(),
            last_failure: String::new(),
            named: None,
            offered: None,
            bids: BTreeMap::new(),
        };
        self.published.insert(task.clone(), published);
        self.news = true;
        task
    }

    /// A task of ours is over for that reason: whoever has it is to stop. `None`: it is done, or needs
    /// no doing.
    pub fn withdraw(&mut self, task: &TaskId, reason: Option<String>) {
        let Some(published) = self.published.get(task) else {
            return;
        };
        if let Stage::Given { to, .. } = &published.stage {
            let (from, id) = (to.clone(), published.id.clone());
            self.outputs.push_back(TaskOutput::TakeBack { from, id });
        }
        self.end(
            &task.clone(),
            match reason {
                None => Outcome::Done { by: None },
                Some(reason) => Outcome::Failed { reason },
            },
        );
    }

    /// What the vehicle that was given a task has answered.
    pub fn answered(&mut self, id: &ActionId, answer: &Answer) {
        let reason = match answer {
            Answer::Rejected { reason } => reason,
            Answer::Finished { outcome } => {
                let outcome = outcome.clone();
                if let Some((_, published)) = self.task_of(id)
                    && let Stage::Given { to, .. } = &published.stage
                {
                    let to = to.clone();
                    self.over(&to, id, &outcome);
                }
                return;
            }
            _ => return,
        };
        let Some((task, published)) = self.task_of(id) else {
            return;
        };
        if matches!(published.stage, Stage::Given { .. }) {
            // It has not begun.
            published.last_failure.clone_from(reason);
            let task = task.clone();
            self.open_again(&task);
        }
    }

    /// Who has, or had, that execution of a task of ours that is not over.
    pub fn executor_of(&self, id: &ActionId) -> Option<&Symbol> {
        self.published.values().find_map(|task| match &task.stage {
            Stage::Given { to, .. } if task.id == *id => Some(to),
            _ => {
                let mut before = task.before.iter();
                before.find(|(had, _)| had == id).map(|(_, who)| who)
            }
        })
    }

    /// An execution has ended, or goes on.
    pub(super) fn over(&mut self, by: &Symbol, id: &ActionId, report: &Report) {
        let current = self.task_of(id).map(|(task, _)| task.clone());
        let Some(task) = current.clone().or_else(|| self.task_before(id)) else {
            return;
        };
        match report {
            Report::Started | Report::Progress { .. } => {}
            // It was given up, and has not failed: its vehicle was started again, or has not heard of
            // us for too long.
            Report::Suspended { .. } => {
                if current.is_some() {
                    self.open_again(&task);
                }
            }
            Report::Success { .. } => {
                self.take_back_from_others(&task, id);
                let by = Some(by.clone());
                self.end(&task, Outcome::Done { by });
            }
            Report::Unknown { reason, .. } => {
                self.take_back_from_others(&task, id);
                let reason = reason.clone();
                self.end(&task, Outcome::Unknown { reason });
            }
            Report::Failure { reason, .. } => {
                // That one who had it before has not done it was to be expected.
                if current.is_some() {
                    self.failed(&task, by, reason);
                }
            }
        }
    }

    fn failed(&mut self, task: &TaskId, by: &Symbol, reason: &str) {
        let Some(published) = self.published.get_mut(task) else {
            return;
        };
        let away = matches!(published.stage, Stage::Given { away: true, .. });
        if !away {
            let failures = published.failures.entry(by.clone()).or_default();
            *failures = failures.saturating_add(1);
        }
        published.last_failure = reason.to_owned();
        self.open_again(task);
    }

    fn take_back_from_others(&mut self, task: &TaskId, id: &ActionId) {
        if let Some(published) = self.published.get(task)
            && published.id != *id
            && let Stage::Given { to, .. } = &published.stage
        {
            let (from, id) = (to.clone(), published.id.clone());
            self.outputs.push_back(TaskOutput::TakeBack { from, id });
        }
    }

    fn task_of(&mut self, id: &ActionId) -> Option<(&TaskId, &mut Published)> {
        let mut all = self.published.iter_mut();
        all.find(|(_, published)| published.id == *id)
    }

    fn task_before(&self, id: &ActionId) -> Option<TaskId> {
        let mut all = self.published.iter();
        let found = all.find(|(_, task)| task.before.iter().any(|(before, _)| before == id));
        found.map(|(task, _)| task.clone())
    }

    fn end(&mut self, task: &TaskId, outcome: Outcome) {
        if let Some(published) = self.published.remove(task) {
            self.asked.remove(&published.id);
            self.news = true;
            self.outputs.push_back(TaskOutput::Ended {
                task: task.clone(),
                what: published.new.what,
                outcome,
            });
        }
    }

    fn next_execution(&mut self) -> ActionId {
        let number = self.next;
        self.next += 1;
        ActionId {
            agent: self.name.clone(),
            epoch: self.epoch,
            number,
        }
    }

    /// Nobody has it any more.
    fn open_again(&mut self, task: &TaskId) {
        let id = self.next_execution();
        let Some(published) = self.published.get_mut(task) else {
            return;
        };
        let before = std::mem::replace(&mut published.id, id);
        self.asked.remove(&before);
        if let Stage::Given { to, .. } = &published.stage {
            published.before.push((before, to.clone()));
        }
        published.stage = Stage::Open;
        published.named = None;
        published.offered = None;
        published.bids.clear();
        self.news = true;
    }

    /// A vehicle is not seen or heard any more. It is not named from now on, so that its lease runs out.
    pub(super) fn lost(&mut self, name: &Symbol) {
        for published in self.published.values_mut() {
            if let Stage::Given { to, away } = &mut published.stage
                && to == name
            {
                *away = true;
            }
            published.bids.remove(name);
        }
    }

    /// A vehicle does not know any more what it was given.
    pub(super) fn has_forgotten(&mut self, name: &Symbol) {
        let given: Vec<TaskId> = self
            .published
            .iter()
            .filter(|(_, it)| matches!(&it.stage, Stage::Given { to, .. } if to == name))
            .map(|(task, _)| task.clone())
            .collect();
        for task in given {
            self.open_again(&task);
        }
    }

    pub(super) fn heard_bid(&mut self, by: &Symbol, at: Time, bid: &Bid) {
        let Some((_, published)) = self.task_of(&bid.id) else {
            return;
        };
        let earlier = published.bids.get(by);
        if earlier.is_none_or(|(said, _)| *said <= at) {
            published.bids.insert(by.clone(), (at, bid.clone()));
        }
    }

    /// After a restart: what was named, and when, nobody knows.
    pub(super) fn take_up(&mut self) {
        if !std::mem::take(&mut self.recalled) {
            return;
        }
        for published in self.published.values_mut() {
            if let Stage::Given { to, away } = &mut published.stage
                && *to != self.name
            {
                published.named = Some(self.now);
                *away = true;
            }
        }
    }

    /// Gives tasks to those who can do them best, and takes them from those who are not there.
    pub(super) fn decide(&mut self) {
        let tasks: Vec<TaskId> = self.published.keys().cloned().collect();
        for task in tasks {
            let Some(published) = self.published.get(&task) else {
                continue;
            };
            if published.new.deadline.is_some_and(|at| at <= self.now) {
                self.withdraw(&task, Some("its deadline has passed".to_owned()));
                continue;
            }
            match &published.stage {
                Stage::Open => self.decide_on(&task),
                Stage::Given { to, .. } => {
                    let there = *to == self.name || self.vehicles.contains_key(to);
                    let (from, id) = (to.clone(), published.id.clone());
                    if !there && self.runs_out(published) <= self.now {
                        // If it still knows of it, it is to forget it.
                        self.outputs.push_back(TaskOutput::TakeBack { from, id });
                        self.open_again(&task);
                    }
                }
            }
        }
    }

    /// When whoever has the task has it no more for certain, and stands still.
    fn runs_out(&self, published: &Published) -> Time {
        let named = published.named.unwrap_or(self.now);
        named + self.times.lease + self.times.rest
    }

    fn decide_on(&mut self, task: &TaskId) {
        let own = self.name.clone();
        let Some(published) = self.published.get_mut(task) else {
            return;
        };
        let Some(offered) = published.offered else {
            // It is offered first.
            self.news = true;
            return;
        };
        let answered = |name: &Symbol| published.bids.contains_key(name);
        let all = answered(&own) && self.vehicles.keys().all(answered);
        let settled_in = self
            .began
            .is_some_and(|at| at + self.times.beat <= self.now);
        let over = offered + self.times.bid_window <= self.now;
        let able = published.bids.iter().filter_map(|(name, (_, bid))| {
            let there = *name == own || self.vehicles.contains_key(name);
            let failures = published.failures.get(name).copied().unwrap_or_default();
            bid.cost
                .filter(|_| there)
                .map(|cost| (failures, cost, name))
        });
        let Some((failures, _, to)) = able.min() else {
            return;
        };
        if !(over || all && settled_in) {
            return;
        }
        if failures >= MOST_FAILURES {
            // All who could do it have failed as often.
            let reason = published.last_failure.clone();
            self.end(task, Outcome::Failed { reason });
            return;
        }
        let to = to.clone();
        published.stage = Stage::Given {
            to: to.clone(),
            away: false,
        };
        let id = published.id.clone();
        let new = published.new.clone();
        self.news = true;
        if to == own {
            self.take_own(task, &id, &new);
        }
        self.outputs.push_back(TaskOutput::Give {
            to,
            id,
            what: new.what,
            urgency: new.urgency,
            priority: new.priority,
        });
    }

    /// When something is to be decided about a task.
    pub(super) fn due(&self, published: &Published) -> Option<Time> {
        let deadline = published.new.deadline;
        let decision = match &published.stage {
            Stage::Open => {
                let window = published.offered.map(|at| at + self.times.bid_window);
                // What has run out already waits for a bid, not for the time.
                window.filter(|at| *at > self.now)
            }
            Stage::Given { to, .. } => {
                let there = *to == self.name || self.vehicles.contains_key(to);
                (!there).then(|| self.runs_out(published))
            }
        };
        deadline.into_iter().chain(decision).min()
    }

    /// All of it, to be said to all.
    pub(super) fn how_tasks_stand(&mut self) -> Tasks {
        let mut tasks = Tasks {
            digest: self.digest,
            ..Tasks::default()
        };
        for (task, published) in &mut self.published {
            match &mut published.stage {
                Stage::Open => {
                    let offer = Offer {
                        task: task.clone(),
                        id: published.id.clone(),
                        what: published.new.what.clone(),
                        urgency: published.new.urgency,
                        priority: published.new.priority,
                        deadline: published.new.deadline,
                    };
                    published.named = Some(self.now);
                    published.offered.get_or_insert(self.now);
                    self.outputs.push_back(TaskOutput::Assess(offer.clone()));
                    tasks.offers.push(offer);
                }
                Stage::Given { to, .. } => {
                    if *to == self.name || self.vehicles.contains_key(to) {
                        published.named = Some(self.now);
                        tasks.awards.push(Award {
                            task: task.clone(),
                            id: published.id.clone(),
                            what: published.new.what.clone(),
                            to: to.clone(),
                        });
                    }
                }
            }
        }
        tasks
    }
}
