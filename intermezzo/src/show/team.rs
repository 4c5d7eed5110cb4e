//! For people: what each vehicle of a team does, side by side.

use std::collections::{BTreeMap, BTreeSet};

use agent_core::model::{Symbol, Time};
use agent_core::protocol::{Event, GoalId, Happening, Urgency};
use anstyle::Style;

use super::Screen;
use super::columns::Columns;
use super::people::width;
use super::summary::Ledger;
use super::words::{Line, Observable, of_parent, of_role};
use crate::robot::RoleNews;
use crate::scenario::{Told, What};
use crate::style::{BAD, BOLD, DIM, URGENT};

/// A timeline for each vehicle.
pub(crate) struct ForTeam {
    /// What counts as the beginning.
    zero: Time,
    columns: Columns,
    /// By vehicle.
    ledgers: BTreeMap<Symbol, Ledger>,
    /// Emergencies, by vehicle, from when they begin until they end.
    urgent: BTreeMap<Symbol, BTreeSet<GoalId>>,
    accepted_as_urgent: BTreeSet<(Symbol, GoalId)>,
    /// What tasks are that vehicles were given: their names say nothing to people.
    given: BTreeMap<GoalId, String>,
}

impl ForTeam {
    /// Empty timelines of these vehicles, which count from `zero`.
    pub(crate) fn new(zero: Time, vehicles: impl IntoIterator<Item = Symbol>) -> Self {
        let vehicles: Vec<Symbol> = vehicles.into_iter().collect();
        let names = vehicles.iter().map(ToString::to_string).collect();
        let team = Self {
            zero,
            columns: Columns::new(names, width()),
            ledgers: vehicles
                .into_iter()
                .map(|name| (name, Ledger::default()))
                .collect(),
            urgent: BTreeMap::new(),
            accepted_as_urgent: BTreeSet::new(),
            given: BTreeMap::new(),
        };
        anstream::println!("{}", team.columns.heading());
        team
    }

    /// What became of the goals of each vehicle that had any, as a table.
    pub(crate) fn summaries(&self) -> impl Iterator<Item = (&Symbol, String)> {
        let tables = self.ledgers.iter();
        tables.filter_map(|(vehicle, ledger)| Some((vehicle, ledger.table()?)))
    }

    /// Which vehicle is seeing to an emergency.
    fn follow(&mut self, agent: &Symbol, event: &Event) {
        let Some(goal) = &event.goal else { return };
        let key = (agent.clone(), goal.clone());
        match &event.what {
            Happening::GoalAccepted {
                urgency: Urgency::Emergency,
                ..
            } => {
                self.accepted_as_urgent.insert(key);
            }
            Happening::GoalStarted | Happening::GoalResumed { .. }
                if self.accepted_as_urgent.contains(&key) =>
            {
                self.urgent
                    .entry(agent.clone())
                    .or_default()
                    .insert(goal.clone());
            }
            Happening::GoalSuspended { .. }
            | Happening::GoalSucceeded
            | Happening::GoalFailed { .. }
            | Happening::GoalUnknown { .. }
            | Happening::GoalBlocked { .. } => {
                if let Some(urgent) = self.urgent.get_mut(agent) {
                    urgent.remove(goal);
                }
            }
            _ => {}
        }
    }

    fn bar(&self, vehicle: &str) -> (char, Style) {
        let urgent = self.urgent.get(vehicle);
        match urgent.is_some_and(|urgent| !urgent.is_empty()) {
            true => ('┃', URGENT),
            false => ('│', DIM),
        }
    }

    fn across(&self, at: Time, sign: char, style: Style, text: &str) {
        let at_s = at.since(self.zero).secs();
        anstream::println!("{}", self.columns.across(at_s, (sign, style), text));
    }
}

impl Screen for ForTeam {
    fn event(&mut self, agent: &Symbol, event: &Event) {
        let Some(ledger) = self.ledgers.get_mut(agent) else {
            return;
        };
        ledger.note(self.zero, event);
        self.follow(agent, event);
        // A plan is long, and its actions are told when they begin.
        if let Happening::PlanSelected { .. } | Happening::BeliefChanged { .. } = event.what {
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
        let named = event.goal.as_ref().map_or("", Symbol::as_str);
        let goal = words.map_or(named, String::as_str);
        let Some(line) = of_parent(goal, &event.what, &Observable::new()) else {
            return;
        };
        let Line { sign, style, text } = line;
        let at_s = event.at.since(self.zero).secs();
        let bar = |vehicle: &str| self.bar(vehicle);
        let shown = self
            .columns
            .line(at_s, agent.as_str(), (sign, style), &text, bar);
        if let Some(shown) = shown {
            anstream::println!("{shown}");
        }
    }

    fn told(&mut self, at: Time, told: &Told) {
        match told {
            Told::Said(event) => match (&event.say, &event.what) {
                (Some(say), _) => self.across(at, '»', BOLD, say),
                (None, Some(What::Fact(fact))) => self.across(at, '»', BOLD, &fact.to_string()),
                (None, _) => {}
            },
            Told::Refused(event, reason) => {
                let text = format!("line {} of the scenario: {reason}", event.line);
                self.across(at, '✗', BAD, &text);
            }
        }
    }

    fn role(&mut self, at: Time, news: &RoleNews) {
        let Line { sign, style, text } = of_role(news);
        self.across(at, sign, style, &text);
    }
}

/// Whether a goal is a task that somebody was given: `k2.3.17`.
fn is_execution(goal: &GoalId) -> bool {
    let mut parts = goal.as_str().rsplit('.');
    let mut number = || parts.next().is_some_and(|part| part.parse::<u64>().is_ok());
    number() && number()
}
