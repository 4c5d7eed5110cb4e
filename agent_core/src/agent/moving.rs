//! Goals that go from one agent of a robot to another, with all that is kept for them.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::{Agent, Intention, ResumedBy, WaitsFor};
use crate::model::{Symbol, Time};
use crate::planner::{Frame, Planner, TaskList};
use crate::protocol::{ActionId, GoalId, GoalRequest, Input, Machine, Rejection, Urgency};

/// A goal that one agent has given away and no other has taken over yet.
#[derive(Debug)]
pub(crate) struct Moved {
    intention: Intention,
    waits_for: Option<WaitsFor>,
}

impl<P: Planner> Agent<P> {
    /// The same agent under another name, which must have done nothing yet.
    pub(crate) fn named(mut self, name: Symbol, asks_leave: bool) -> Self {
        self.configuration.name = name;
        self.configuration.policy.asks_leave = asks_leave;
        self
    }

    /// Takes on a user's goal, if so many of its urgency wait elsewhere, under that name if it has none.
    pub(crate) fn take_goal(
        &mut self,
        now: Time,
        mut request: GoalRequest,
        elsewhere: usize,
        free_name: Option<GoalId>,
    ) -> Result<GoalId, Rejection> {
        self.now = self.now.max(now);
        if request.id.is_none() && self.consider(&request, elsewhere).is_ok() {
            request.id = free_name;
        }
        let taken = self.accept_beside(request, elsewhere);
        self.handle(now, Input::Wake);
        taken
    }

    /// The number that the next goal gets.
    pub(crate) fn next_number(&self) -> u64 {
        self.next_goal
    }

    /// A goal that does not run here, without what it was last told to wait for; `None` if it runs, is
    /// held by a superior, or is not here.
    pub(crate) fn give_away(&mut self, goal: &GoalId) -> Option<Moved> {
        let aside = self.aside.goals().iter();
        let mut waits_for = aside
            .filter(|(intention, _)| intention.goal.id == *goal)
            .map(|(_, waits_for)| waits_for.clone());
        let waits_for = waits_for.next();
        let own =
            self.stack.entries().iter().any(|entry| {
                entry.intention.goal.id == *goal && entry.resumed_by == ResumedBy::Agent
            });
        let stacked = match own {
            true => self.take_from_stack(goal),
            false => None,
        };
        let found = stacked.or_else(|| self.waiting.remove(goal));
        let intention = found.or_else(|| self.aside.remove(goal))?;
        self.planner.release(goal);
        Some(Moved {
            intention,
            waits_for,
        })
    }

    /// Takes over what another agent of the same robot has given away.
    pub(crate) fn take_over(&mut self, moved: Moved) {
        let Moved {
            intention,
            waits_for,
        } = moved;
        self.next_goal = self.next_goal.max(intention.goal.number + 1);
        if let Some(highest) = highest_frame(&intention) {
            self.planner.number_frames_from(highest + 1);
        }
        match waits_for {
            Some(waits_for) => self.aside.add(intention, waits_for),
            None => self.waiting.add(intention),
        }
    }

    /// Whether that instruction of a superior's is known, be it over or not.
    pub(crate) fn knows_instruction(&self, superior: &Symbol, id: &ActionId) -> bool {
        self.goal_of(superior, id) || self.outcome_of(superior, id).is_some()
    }

    /// All goals that are not over.
    pub(crate) fn goals(&self) -> impl Iterator<Item = &Intention> {
        self.all_intentions()
    }

    /// Goals that would be started or resumed next if nothing else ran.
    pub(crate) fn startable(&self) -> impl Iterator<Item = &Intention> {
        let own = |entry: &&super::SuspendedGoal| entry.resumed_by == ResumedBy::Agent;
        let stacked = self.stack.entries().iter().filter(own);
        let stacked = stacked.map(|entry| &entry.intention);
        stacked.chain(self.waiting.intentions())
    }

    /// Whether there is no goal here, of whatever kind.
    pub(crate) fn is_empty(&self) -> bool {
        self.all_intentions().next().is_none()
    }

    /// Whether a goal is pursued here, or will be as soon as it may.
    pub(crate) fn is_busy(&self) -> bool {
        self.running.is_some() || self.startable().next().is_some()
    }

    /// Whether there are emergencies of users among the goals that wait.
    pub(crate) fn emergencies(&self) -> impl Iterator<Item = &GoalId> {
        let urgent = |intention: &&Intention| {
            intention.goal.superior.is_none() && intention.goal.urgency == Urgency::Emergency
        };
        let waiting = self.waiting.intentions().iter().filter(urgent);
        waiting.map(|intention| &intention.goal.id)
    }
}

/// The highest number of a frame of which the goal's plans are parts.
fn highest_frame(intention: &Intention) -> Option<u64> {
    let mut lists: Vec<TaskList> = Vec::new();
    let mut frames: Vec<Arc<Frame>> = Vec::new();
    lists.extend(intention.agendas.iter().map(|agenda| agenda.tasks.clone()));
    lists.extend(intention.plans.iter().map(|plan| plan.rest.clone()));
    let steps = intention.plans.iter().flat_map(|plan| &plan.steps);
    for step in steps.chain(intention.records.iter().map(|record| &record.step)) {
        lists.push(step.rest.clone());
        frames.extend(step.frame.clone());
    }
    let mut numbers: BTreeSet<u64> = BTreeSet::new();
    loop {
        while let Some(list) = lists.pop() {
            let mut at = &list;
            while let Some((_, frame, rest)) = at.first() {
                frames.extend(frame.cloned());
                at = rest;
            }
        }
        let Some(frame) = frames.pop() else {
            break;
        };
        if numbers.insert(frame.id) {
            lists.push(frame.rest.clone());
            frames.extend(frame.parent.clone());
        }
    }
    numbers.extend(intention.done_once.iter().copied());
    numbers.pop_last()
}
