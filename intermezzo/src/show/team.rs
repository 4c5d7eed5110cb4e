//! For people: what each vehicle of a team does, side by side.

use std::collections::{BTreeMap, BTreeSet};

use agent_core::model::{Action, Symbol, Time};
use agent_core::protocol::{ActionId, Event, GoalId, Happening, Urgency};
use anstyle::Style;

use super::Screen;
use super::columns::Columns;
use super::people::width;
use super::retold::Retold;
use super::words::{Line, Observable, of_parent, of_role, resumption};
use crate::robot::RoleNews;
use crate::scenario::{Told, What};
use crate::style::{AGAIN, BAD, BOLD, DIM, URGENT};

/// A timeline for each vehicle.
pub(crate) struct ForTeam {
    /// What counts as the beginning.
    zero: Time,
    columns: Columns,
    /// Of the terminal.
    width: usize,
    /// By vehicle.
    retold: BTreeMap<Symbol, Retold>,
    /// What each vehicle is in the middle of.
    running: BTreeMap<Symbol, BTreeMap<ActionId, Action>>,
    /// The last words about that.
    meanwhile: Option<String>,
    /// The goals that are set aside, by vehicle.
    aside: BTreeSet<(Symbol, GoalId)>,
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
        let width = width();
        let team = Self {
            zero,
            columns: Columns::new(names, width),
            width,
            retold: vehicles
                .into_iter()
                .map(|name| (name, Retold::default()))
                .collect(),
            running: BTreeMap::new(),
            meanwhile: None,
            aside: BTreeSet::new(),
            urgent: BTreeMap::new(),
            accepted_as_urgent: BTreeSet::new(),
            given: BTreeMap::new(),
        };
        anstream::println!("{}", team.columns.heading());
        team
    }

    /// Somebody was given these tasks as that goal before this was there to see it.
    pub(crate) fn knows(&mut self, goal: GoalId, tasks: String) {
        if is_execution(&goal) {
            self.given.insert(goal, tasks);
        }
    }

    /// What each vehicle has done, if it has done anything, and what interrupted it.
    pub(crate) fn retold(&self) -> impl Iterator<Item = String> {
        let all = self.retold.iter();
        all.filter_map(|(vehicle, retold)| retold.lines(vehicle.as_str(), self.width))
    }

    /// What each vehicle is in the middle of.
    fn keep_up(&mut self, agent: &Symbol, event: &Event) {
        let running = self.running.entry(agent.clone()).or_default();
        match &event.what {
            Happening::ActionStarted { id, action } | Happening::ActionResumed { id, action } => {
                running.insert(id.clone(), action.clone());
            }
            Happening::ActionFinished { id, .. }
            | Happening::ActionSuspended { id, .. }
            | Happening::ActionRolledBack { id, .. }
            | Happening::RecordCleared { id, .. } => {
                running.remove(id);
            }
            _ => {}
        }
        let Some(goal) = &event.goal else { return };
        match &event.what {
            Happening::GoalSuspended { .. } => {
                self.aside.insert((agent.clone(), goal.clone()));
            }
            Happening::GoalResumed { .. }
            | Happening::GoalSucceeded
            | Happening::GoalFailed { .. }
            | Happening::GoalUnknown { .. } => {
                self.aside.remove(&(agent.clone(), goal.clone()));
            }
            _ => {}
        }
    }

    /// What all are in the middle of, in words.
    fn meanwhile(&self) -> Option<String> {
        let all = self.running.iter().flat_map(|(vehicle, actions)| {
            let words = move |action| format!("{vehicle} {action}");
            actions.values().map(words)
        });
        let all: Vec<String> = all.collect();
        (!all.is_empty()).then(|| format!("meanwhile {}", all.join(", ")))
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

    fn is_aside(&self, agent: &Symbol, event: &Event) -> bool {
        let goal = event.goal.as_ref();
        goal.is_some_and(|goal| self.aside.contains(&(agent.clone(), goal.clone())))
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
        let Some(retold) = self.retold.get_mut(agent) else {
            return;
        };
        retold.note(
            self.zero,
            event,
            event.goal.as_ref().is_some_and(is_execution),
        );
        self.keep_up(agent, event);
        self.follow(agent, event);
        match &event.what {
            // A plan is long, and its actions are told when they begin.
            Happening::PlanSelected { .. } | Happening::BeliefChanged { .. } => return,
            // That it is elsewhere now is no news; how it goes on is told when it does.
            Happening::PlanRevised { .. } if self.is_aside(agent, event) => return,
            _ => {}
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
        let said = words.and_then(|_| of_a_given_one(&event.what));
        let Some(line) = in_words(goal, said.as_ref().unwrap_or(&event.what)) else {
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
                (Some(say), _) => {
                    self.across(at, '»', BOLD, say);
                    let meanwhile = self.meanwhile();
                    if meanwhile != self.meanwhile
                        && let Some(words) = &meanwhile
                    {
                        anstream::println!("{}", self.columns.below(DIM, words));
                    }
                    self.meanwhile = meanwhile;
                }
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

/// An event of a vehicle. Of how it goes on the reason is enough.
fn in_words(goal: &str, what: &Happening) -> Option<Line> {
    match what {
        Happening::GoalResumed { how, why, .. } => Some(Line {
            sign: '↩',
            style: AGAIN,
            text: format!("takes up {goal} again, {}: {why}", resumption(*how)),
        }),
        what => of_parent(goal, what, &Observable::new()),
    }
}

/// An end of a task that was given. Users do not speak to whom it was given, but to whoever has given it: to
/// them it was not the user who called it off, and after a new start of theirs nobody was.
fn of_a_given_one(what: &Happening) -> Option<Happening> {
    match what {
        Happening::GoalFailed { reason } if reason == "the user has cancelled it" => {
            let reason = "it was called off, or is given back after a new start".to_owned();
            Some(Happening::GoalFailed { reason })
        }
        _ => None,
    }
}

/// Whether a goal is a task that somebody was given: `k2.3.17`.
fn is_execution(goal: &GoalId) -> bool {
    let mut parts = goal.as_str().rsplit('.');
    let mut number = || parts.next().is_some_and(|part| part.parse::<u64>().is_ok());
    number() && number()
}
