//! For people: what the vehicles of a restaurant do, a line for each thing that matters.

use agent_core::model::{Symbol, Time};
use agent_core::protocol::{Event, Happening};
use executor_sim::ROOM;

use super::Screen;
use super::words::{Line, Observable, of_parent, of_role};
use crate::robot::RoleNews;
use crate::scenario::Told;
use crate::style::DIM;

/// A line for each thing that matters, with the vehicle that it is about.
pub(crate) struct ForTeam {
    zero: Time,
}

impl ForTeam {
    /// Counts the time from `zero`.
    pub(crate) fn new(zero: Time) -> Self {
        Self { zero }
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
        let goal = event.goal.as_ref().map_or("", Symbol::as_str);
        if let Some(line) = of_parent(goal, &event.what, &Observable::new()) {
            self.line(event.at, agent.as_str(), &line);
        }
    }

    fn told(&mut self, _: Time, _: &Told) {}

    fn role(&mut self, at: Time, news: &RoleNews) {
        self.line(at, "", &of_role(news));
    }
}
