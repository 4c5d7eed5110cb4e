//! Which goal is with which agent, and who rests.

use std::cmp::Reverse;

use super::{ParallelAgent, ROUNDS_PER_INPUT, Who};
use crate::agent::Intention;
use crate::planner::Planner;
use crate::protocol::{GoalId, Input};

impl<P: Planner> ParallelAgent<P> {
    /// Brings all agents to rest: goals go to whoever pursues them, and actions get leave, until there is
    /// only waiting.
    pub(super) fn take_turns(&mut self) {
        self.unsettled = false;
        for _ in 0..ROUNDS_PER_INPUT {
            let moved = self.take_back() | self.bring_emergencies();
            let turned = self.let_the_foremost_go_first() | self.hand_out();
            if !(self.next_layer() | moved | turned) {
                return;
            }
        }
        self.unsettled = true;
    }

    /// Moves a goal that does not run. Both agents then do what follows.
    fn carry(&mut self, goal: &GoalId, from: Who, to: Who) -> bool {
        let moved = self.agent_mut(from).and_then(|agent| agent.give_away(goal));
        let Some(moved) = moved else {
            return false;
        };
        if let Some(agent) = self.agent_mut(to) {
            agent.take_over(moved);
        }
        self.tell(from, Input::Wake);
        self.tell(to, Input::Wake);
        true
    }

    /// Goals that were set aside or are blocked leave their branch to others.
    fn take_back(&mut self) -> bool {
        let mut aside: Vec<(usize, GoalId)> = Vec::new();
        for (slot, branch) in self.branches.iter().enumerate() {
            let goals = branch.aside().goals().iter();
            aside.extend(goals.map(|(intention, _)| (slot, intention.goal.id.clone())));
        }
        aside.iter().fold(false, |moved, (slot, goal)| {
            self.carry(goal, Who::Branch(*slot), Who::List) | moved
        })
    }

    fn bring_emergencies(&mut self) -> bool {
        let goals: Vec<GoalId> = self.list.emergencies().cloned().collect();
        goals.iter().fold(false, |moved, goal| {
            self.carry(goal, Who::List, Who::Foremost) | moved
        })
    }

    /// As long as the foremost agent has something to do, the branches rest, and only when all of them do
    /// it begins.
    fn let_the_foremost_go_first(&mut self) -> bool {
        let mut turned = false;
        if !self.foremost.is_busy() {
            turned |= self.pause(Who::Foremost, Some("there is no emergency"));
            for slot in 0..self.branches.len() {
                turned |= self.pause(Who::Branch(slot), None);
            }
            return turned;
        }
        let why = self.why_to_rest();
        for slot in 0..self.branches.len() {
            turned |= self.pause(Who::Branch(slot), Some(&why));
        }
        let rest = self.branches.iter().all(|it| it.running().is_none());
        if rest {
            // The world will be another one.
            self.executed.clear();
            turned |= self.pause(Who::Foremost, None);
        }
        turned
    }

    pub(super) fn why_to_rest(&self) -> String {
        let urgent = self.foremost.waiting().most_urgent().map(|goal| &goal.id);
        let running = self.foremost.running().map(|it| &it.goal.id);
        match urgent.or(running) {
            Some(goal) => format!("{goal} goes first"),
            None => String::from("an emergency goes first"),
        }
    }

    /// Has one of the agents rest or go on. Returns whether that is news to it.
    fn pause(&mut self, who: Who, why: Option<&str>) -> bool {
        let now = self.now;
        let Some(agent) = self.agent_mut(who) else {
            return false;
        };
        if agent.is_to_rest() == why.is_some() {
            return false;
        }
        agent.pause(now, why);
        self.pass_on(who, None);
        true
    }

    /// Gives goals that wait to branches that have none.
    fn hand_out(&mut self) -> bool {
        if self.foremost.is_busy() {
            return false;
        }
        let absent = self.list.absent();
        let mut waiting: Vec<&Intention> = (self.list.startable())
            .filter(|it| {
                let superior = it.goal.superior.as_ref();
                superior.is_none_or(|(name, _)| !absent.contains(name))
            })
            .collect();
        waiting.sort_by_key(|it| rank(it));
        let goals: Vec<GoalId> = waiting.iter().map(|it| it.goal.id.clone()).collect();
        let free = self.branches.iter().take(self.together.get());
        let free: Vec<usize> = (free.enumerate())
            .filter(|(_, branch)| branch.is_empty())
            .map(|(slot, _)| slot)
            .collect();
        let mut moved = false;
        for (goal, slot) in goals.iter().zip(free) {
            moved |= self.carry(goal, Who::List, Who::Branch(slot));
        }
        moved
    }
}

/// Lower goes first: the higher priority, then the older goal. What a superior has instructed ranks as
/// a goal without a priority of its own.
pub(super) fn rank(intention: &Intention) -> (Reverse<i32>, u64) {
    let goal = &intention.goal;
    let priority = match goal.superior {
        Some(_) => 0,
        None => goal.priority,
    };
    (Reverse(priority), goal.number)
}
