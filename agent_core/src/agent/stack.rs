//! The stack for suspended goals (the paper, section 5 and figure 5).

use super::intention::Intention;
use crate::model::Symbol;
use crate::protocol::{ActionId, GoalId};

/// Who takes a suspended goal up again (decision 1).
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum ResumedBy {
    /// The agent itself, when what runs above is done (Algorithm 3, step 3g).
    Agent,
    /// The superior who had it suspended (Algorithm 5, step 9): a *held* goal.
    Superior,
}

/// A goal set aside for a more urgent one, with its plans and its suspended actions.
#[derive(Clone, Debug, PartialEq)]
pub struct SuspendedGoal {
    /// Goal, plans, and what the executor can pick up again: no record if the action ended before
    /// the request to suspend reached it, which is an ordinary race and not a fault.
    pub intention: Intention,
    /// Who resumes it.
    pub resumed_by: ResumedBy,
}

/// Goals set aside, innermost last.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SuspendedGoalStack {
    entries: Vec<SuspendedGoal>,
}

impl SuspendedGoalStack {
    /// On top of the others (Algorithm 3, step 3d; Algorithm 5, step 5).
    pub fn push(&mut self, intention: Intention, resumed_by: ResumedBy) {
        self.entries.push(SuspendedGoal {
            intention,
            resumed_by,
        });
    }

    /// The top, if the agent itself may resume it.
    pub fn resumable(&self) -> Option<&Intention> {
        let top = self.entries.last()?;
        (top.resumed_by == ResumedBy::Agent).then_some(&top.intention)
    }

    /// Takes the top off (Algorithm 3, step 3f; Algorithm 5, step 7).
    pub fn pop(&mut self) -> Option<Intention> {
        self.entries.pop().map(|entry| entry.intention)
    }

    /// Takes an entry out wherever it stands (decision 6).
    pub fn remove(&mut self, goal: &GoalId) -> Option<Intention> {
        let place = self
            .entries
            .iter()
            .position(|e| e.intention.goal.id == *goal)?;
        Some(self.entries.remove(place).intention)
    }

    /// Where the goal of a superior's instruction stands, counted from the bottom.
    pub fn place_of(&self, superior: &Symbol, id: &ActionId) -> Option<usize> {
        self.entries.iter().position(|entry| {
            let goal = &entry.intention.goal;
            goal.superior
                .as_ref()
                .is_some_and(|(who, what)| who == superior && what == id)
        })
    }

    /// Says who resumes the entries from `place` up (decision 6).
    pub fn set_resumed_by(&mut self, place: usize, resumed_by: ResumedBy) {
        for entry in self.entries.iter_mut().skip(place) {
            entry.resumed_by = resumed_by;
        }
    }

    /// Takes a superior's goal to the top, with the agent's own goals that were suspended with it
    /// above it, and leaves them to the agent (Algorithm 5, step 9; decision 6). Other goals that
    /// a superior holds stay where they are and stay held.
    pub fn release(&mut self, place: usize) {
        let own = |entry: &&SuspendedGoal| entry.intention.goal.superior.is_none();
        let above = self.entries.iter().skip(place + 1).take_while(own).count();
        let released: Vec<_> = self.entries.drain(place..=place + above).collect();
        let first = self.entries.len();
        self.entries.extend(released);
        self.set_resumed_by(first, ResumedBy::Agent);
    }

    /// How many goals are suspended.
    pub fn depth(&self) -> usize {
        self.entries.len()
    }

    /// The entries, innermost last.
    pub fn entries(&self) -> &[SuspendedGoal] {
        &self.entries
    }

    pub(super) fn intentions_mut(&mut self) -> impl Iterator<Item = &mut Intention> {
        self.entries.iter_mut().map(|entry| &mut entry.intention)
    }
}
