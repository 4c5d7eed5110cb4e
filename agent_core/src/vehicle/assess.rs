//! What a task that is offered would cost this vehicle.

use std::collections::{BTreeMap, VecDeque};

use super::{Mind, Vehicle};
use crate::model::{Fact, Task, Time};
use crate::planner::{Agenda, Origin, Planner, TaskList, asks_for};
use crate::protocol::ActionId;
use crate::service::Offer;

/// So many expansions are made between two looks at what has come in.
const SLICE: u64 = 200;

/// A task that takes longer to plan than so many expansions is not for this vehicle, as far as it can
/// tell. The plan graph knows some plan before that, if there is one.
const LONGEST: u64 = 60_000;

/// So much is kept of what was found out.
const MOST_KNOWN: usize = 64;

/// Offers that wait to be looked at.
#[derive(Clone, Debug)]
pub(super) struct Assessments<P> {
    planner: P,
    queue: VecDeque<Offer>,
    /// What is being planned for at present, and for how many expansions.
    current: Option<(Offer, u64)>,
    /// What was found lacking, by offer.
    lacks: BTreeMap<ActionId, Vec<Fact>>,
    /// What tasks cost, in seconds, as things were when the belief had that fingerprint.
    known: BTreeMap<Task, (u64, Option<f64>)>,
}

impl<P: Planner> Assessments<P> {
    pub fn new(planner: P) -> Self {
        Self {
            planner,
            queue: VecDeque::new(),
            current: None,
            lacks: BTreeMap::new(),
            known: BTreeMap::new(),
        }
    }

    /// The latest word about an offer counts.
    pub fn add(&mut self, offer: Offer) {
        if self
            .current
            .as_ref()
            .is_some_and(|(current, _)| current.id == offer.id)
        {
            return;
        }
        self.queue.retain(|waits| waits.id != offer.id);
        self.queue.push_back(offer);
    }

    /// What would have to be known to tell what can be done.
    pub fn lacking(&self) -> impl Iterator<Item = Fact> {
        self.lacks.values().flatten().cloned()
    }

    pub fn is_thinking(&self) -> bool {
        self.current.is_some() || !self.queue.is_empty()
    }

    /// What is offered no more lacks nothing.
    pub fn keep_only(&mut self, stays: impl Fn(&ActionId) -> bool) {
        self.lacks.retain(|id, _| stays(id));
        self.queue.retain(|offer| stays(&offer.id));
    }
}

impl<A: Mind, P: Planner> Vehicle<A, P> {
    /// Goes on looking at offers, for about as long as others can wait.
    pub(super) fn assess(&mut self) {
        if self.assessments.current.is_none() {
            let Some(offer) = self.assessments.queue.pop_front() else {
                return;
            };
            let known = self.assessments.known.get(&offer.what);
            if let Some((fingerprint, cost)) = known
                && *fingerprint == self.mind.belief().fingerprint()
            {
                let cost = *cost;
                return self.weigh(&offer, cost);
            }
            self.begin_to_plan(&offer.what.clone());
            self.assessments.current = Some((offer, 0));
        }
        let Some((offer, spent)) = self.assessments.current.take() else {
            return;
        };
        let Some(outcome) = self.assessments.planner.think(SLICE) else {
            let spent = spent + SLICE;
            if spent < LONGEST && self.assessments.planner.is_thinking() {
                self.assessments.current = Some((offer, spent));
            } else {
                self.assessments.planner.stop();
                self.found(&offer, None);
            }
            return;
        };
        let cost = outcome.plans.first().map(|plan| plan.cost.units());
        self.found(&offer, cost);
    }

    fn found(&mut self, offer: &Offer, cost: Option<f64>) {
        let fingerprint = self.mind.belief().fingerprint();
        let known = &mut self.assessments.known;
        if known.len() >= MOST_KNOWN {
            known.clear();
        }
        known.insert(offer.what.clone(), (fingerprint, cost));
        self.weigh(offer, cost);
    }

    /// What there is to do already comes first.
    fn weigh(&mut self, offer: &Offer, cost: Option<f64>) {
        let lacks = match cost {
            Some(_) => Vec::new(),
            None => self.lacking_for(&offer.what),
        };
        let busy = self.load();
        let cost = cost.map(|cost| Time::from_secs(cost) + busy);
        self.assessed(offer, cost, lacks);
    }

    fn assessed(&mut self, offer: &Offer, cost: Option<Time>, lacks: Vec<Fact>) {
        if lacks.is_empty() {
            self.assessments.lacks.remove(&offer.id);
        } else {
            let known = &mut self.assessments.lacks;
            known.insert(offer.id.clone(), lacks.clone());
        }
        self.tasks
            .assessed(offer, cost, lacks.into_iter().collect());
    }

    fn begin_to_plan(&mut self, what: &Task) {
        let agenda = Agenda {
            tasks: TaskList::of_tasks([what.clone()].into_iter()),
            origin: Origin::Goal,
        };
        let problem = self.problem();
        self.assessments.planner.begin(problem, &[agenda]);
    }

    /// Facts that nobody has told and without which the task cannot be decomposed.
    pub(super) fn lacking_for(&self, what: &Task) -> Vec<Fact> {
        let asked = asks_for(&self.problem(), what).into_iter();
        asked.filter(|fact| self.states.is_unknown(fact)).collect()
    }

    /// Whether there is a plan for a task as things are: found out at once, within limits.
    pub(super) fn can_do(&mut self, what: &Task) -> bool {
        // What was being looked at is looked at again.
        if let Some((offer, _)) = self.assessments.current.take() {
            self.assessments.queue.push_front(offer);
        }
        self.begin_to_plan(what);
        let outcome = self.assessments.planner.think(LONGEST);
        self.assessments.planner.stop();
        outcome.is_some_and(|outcome| !outcome.plans.is_empty())
    }

    /// How long what there is to do will take, as far as it is planned.
    fn load(&self) -> Time {
        let intentions = self.mind.intentions();
        let plans = intentions.iter().filter_map(|it| it.plans.first());
        let seconds: f64 = plans.map(|plan| plan.cost.units()).sum();
        Time::from_secs(seconds)
    }
}
