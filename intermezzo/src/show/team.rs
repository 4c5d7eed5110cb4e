//! For people: what the vehicles of a restaurant do, a line for each thing that matters.

use std::collections::BTreeMap;

use agent_core::model::{Symbol, Time};
use agent_core::protocol::{Event, GoalId, Happening};
use executor_sim::ROOM;

use super::Screen;
use super::words::{Line, Observable, of_parent, of_role};
use crate::robot::RoleNews;
use crate::scenario::Told;
use crate::style::DIM;

/// A line for each thing that matters, with the vehicle that it is about.
pub(crate) struct ForTeam {
    zero: Time,
    /// What tasks are that vehicles were given: their names say nothing to people.
    given: BTreeMap<GoalId, String>,
}

impl ForTeam {
    /// Counts the time from `zero`.
    pub(crate) fn new(zero: Time) -> Self {
        Self {
            zero,
            given: BTreeMap::new(),
        }
    }

    fn line(&self, at: Time, who: &str, line: &Line) {
        let time = at.since(self.zero).secs();
        let Line { sign, style, text } = line;
        anstream::println!("{time:>7.1} s  {DIM}{who:<6}{DIM:#} {style}{sign} {text}{style:#}");
    }
}

impl Screen for ForTeam {
    fn event(&mut self, agent: &Symbol, event: &Event) {
        // The room tells the same as the vehicles; and what a vehicle has in mind is told by what it does.
        let silent = *agent == ROOM
            || matches!(
                event.what,
                Happening::PlanSelected { .. } | Happening::BeliefChanged { .. }
            );
        if silent {
            return;
        }
        if let (Some(goal), Happening::GoalAccepted { tasks, .. }) = (&event.goal, &event.what)
            && is_execution(goal)
        {
            // That it was given is told by whoever has given it.
            let tasks: Vec<String> = tasks.iter().map(ToString::to_string).collect();
            self.given.insert(goal.clone(), tasks.join(" "));
            return;
        }
        let words = event.goal.as_ref().and_then(|goal| self.given.get(goal));
        let words = words.map(String::as_str);
        let goal = words
            .or(event.goal.as_ref().map(Symbol::as_str))
            .unwrap_or("");
        if let Some(line) = of_parent(goal, &event.what, &Observable::new()) {
            self.line(event.at, agent.as_str(), &line);
        }
    }

    fn told(&mut self, _: Time, _: &Told) {}

    fn role(&mut self, at: Time, news: &RoleNews) {
        self.line(at, "", &of_role(news));
    }
}

/// Whether a goal is a task that somebody was given: `k2.3.17`.
fn is_execution(goal: &GoalId) -> bool {
    let mut parts = goal.as_str().rsplit('.');
    let mut number = || parts.next().is_some_and(|part| part.parse::<u64>().is_ok());
    number() && number()
}
