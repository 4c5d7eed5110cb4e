//! The part of those who do a task: to bid, to begin what was bid for, and to let go of it in time.

use super::{NewTask, Promise, Taken, TaskOutput, TaskService, Unwilling};
use crate::model::{Symbol, Time};
use crate::protocol::ActionId;
use crate::service::message::{Bid, Body, Offer, TaskId, Tasks};

/// So many offers are looked at, of all that are heard of: whoever offers more is not in its senses.
const MOST_OFFERS: usize = 256;

impl TaskService {
    pub(super) fn heard_tasks(&mut self, by: &Symbol, at: Time, tasks: &Tasks) {
        // What has been said for good, a late message included: the lease counts from when it was said.
        for award in tasks.awards.iter().filter(|award| award.id.agent == *by) {
            if award.to == self.name
                && let Some(taken) = self.taken.get_mut(&award.id)
            {
                taken.named = taken.named.max(at);
            }
            if let Some(made) = self.promises.get_mut(&award.id) {
                made.named = made.named.max(at);
            }
        }
        let last = self.heard.get(by).map(|heard| heard.at);
        if last.is_some_and(|last| at < last) {
            return;
        }
        for offer in tasks.offers.iter().take(MOST_OFFERS) {
            if offer.id.agent != *by {
                continue;
            }
            // Once for each time that it is said: things may have changed.
            if self.asked.insert(offer.id.clone(), at) != Some(at) {
                self.outputs.push_back(TaskOutput::Assess(offer.clone()));
            }
        }
        let named = |id: &ActionId| {
            tasks.offers.iter().any(|offer| offer.id == *id)
                || tasks.awards.iter().any(|award| award.id == *id)
        };
        self.asked.retain(|id, _| id.agent != *by || named(id));
        // What is offered no more, and was given to somebody else, is not for us.
        let lease = self.times.lease;
        let now = self.now;
        self.promises
            .retain(|id, made| made.publisher != *by || named(id) || made.named + lease > now);
        let tasks = tasks.clone();
        let heard = super::Heard { at, tasks };
        self.heard.insert(by.clone(), heard);
    }

    /// Tells the publisher of an offer what it would cost us. If we could do it, that is a promise.
    pub(super) fn bid(&mut self, offer: &Offer, bid: Bid) {
        let Some(named) = self.asked.get(&offer.id).copied() else {
            // It was withdrawn meanwhile.
            return;
        };
        if bid.cost.is_some() {
            let promise = Promise {
                offer: offer.clone(),
                publisher: offer.id.agent.clone(),
                named,
            };
            self.promises.insert(offer.id.clone(), promise);
        } else {
            self.promises.remove(&offer.id);
        }
        self.say(Body::Bid(bid));
    }

    /// Whether a task that somebody gives us is one that we have said we would do, and is ours from
    /// now on.
    ///
    /// # Errors
    /// If it was not bid for since we were started, or if that is too long ago.
    pub fn take(&mut self, now: Time, id: &ActionId) -> Result<&Taken, Unwilling> {
        self.now = self.now.max(now);
        if !self.taken.contains_key(id) {
            let Some(made) = self.promises.remove(id) else {
                return Err(Unwilling::NotBidFor(self.name.clone(), id.clone()));
            };
            if made.named + self.times.lease <= self.now {
                return Err(Unwilling::TooLate(id.clone()));
            }
            let taken = Taken {
                publisher: made.publisher,
                task: made.offer.task,
                what: made.offer.what,
                urgency: made.offer.urgency,
                priority: made.offer.priority,
                named: made.named,
                given_up: false,
            };
            self.taken.insert(id.clone(), taken);
        }
        match self.taken.get(id) {
            Some(taken) if !taken.given_up => Ok(taken),
            _ => Err(Unwilling::TooLate(id.clone())),
        }
    }

    /// A task of our own that we do ourselves.
    pub(super) fn take_own(&mut self, task: &TaskId, id: &ActionId, new: &NewTask) {
        let taken = Taken {
            publisher: self.name.clone(),
            task: task.clone(),
            what: new.what.clone(),
            urgency: new.urgency,
            priority: new.priority,
            named: self.now,
            given_up: false,
        };
        self.taken.insert(id.clone(), taken);
    }

    /// A task that was given to us is given back: it is let go of when what was begun has come to rest,
    /// and has not failed.
    pub fn give_up(&mut self, id: &ActionId) {
        if let Some(taken) = self.taken.get_mut(id) {
            taken.given_up = true;
        }
    }

    /// A task that was given to us has ended, or is forgotten here.
    pub fn let_go(&mut self, id: &ActionId) {
        self.taken.remove(id);
    }

    /// Gives up what is not ours any more.
    pub(super) fn let_leases_run_out(&mut self) {
        for (id, taken) in &mut self.taken {
            let is_own = taken.publisher == self.name;
            if is_own || taken.given_up || taken.named + self.times.lease > self.now {
                continue;
            }
            taken.given_up = true;
            self.outputs.push_back(TaskOutput::GiveUp {
                publisher: taken.publisher.clone(),
                id: id.clone(),
                reason: format!("{} was not heard of for too long", taken.publisher),
            });
        }
    }
}
