//! For people: a line for each thing that matters, beside the stack of suspended goals.

use std::collections::BTreeMap;
use std::fmt::Write;

use agent_core::model::{Action, Symbol, Time};
use agent_core::protocol::{Event, GoalId, Happening};
use anstyle::{AnsiColor, Style};

use super::Screen;
use super::progress::Progress;
use super::summary::Ledger;
use super::words::{Line, Observable, of_child, of_parent, of_role};
use crate::robot::RoleNews;
use crate::scenario::{Told, What};
use crate::snapshot::Snapshot;
use crate::style::{BAD, BOLD, DIM};

/// Goals are told apart by these, in the order in which they come.
const COLOURS: [AnsiColor; 6] = [
    AnsiColor::Green,
    AnsiColor::Magenta,
    AnsiColor::Yellow,
    AnsiColor::Cyan,
    AnsiColor::Blue,
    AnsiColor::Red,
];
/// Before the bars: time and agent.
const MARGIN: usize = 18;
/// Narrower than this, lines are not broken.
const NARROWEST: usize = 60;
/// Without a terminal.
const USUAL_WIDTH: usize = 120;

/// A timeline.
pub(crate) struct ForPeople {
    /// What counts as the beginning.
    zero: Time,
    observable: Observable,
    /// Suspended goals, innermost last.
    stack: Vec<GoalId>,
    running: Option<GoalId>,
    colours: BTreeMap<GoalId, Style>,
    /// What the goals of agents below are in their superior's words.
    tasks: BTreeMap<String, Action>,
    ledger: Ledger,
    last: Option<Snapshot>,
    held: Vec<Held>,
    progress: Progress,
}

/// A line that waits, and with it all that follow: where a robot has stopped is known exactly from
/// the first picture after it has.
enum Held {
    Line(String),
    Stop {
        event: Event,
        agent: Symbol,
        bars: (String, usize),
    },
}

impl ForPeople {
    /// An empty timeline that counts from `zero`. Changes of facts in `observable` are told.
    pub(crate) fn new(zero: Time, observable: impl IntoIterator<Item = Symbol>) -> Self {
        Self {
            zero,
            observable: observable.into_iter().collect(),
            stack: Vec::new(),
            running: None,
            colours: BTreeMap::new(),
            tasks: BTreeMap::new(),
            ledger: Ledger::default(),
            last: None,
            held: Vec::new(),
            progress: Progress::new(),
        }
    }

    /// What became of the goals, as a table; `None` if there were none.
    pub(crate) fn summary(&mut self) -> Option<String> {
        self.end();
        self.ledger.table()
    }

    /// Leaves the terminal as it was.
    pub(crate) fn end(&mut self) {
        self.release();
        self.progress.end();
    }

    /// Above the progress line, if there is one.
    fn print(&mut self, line: String) {
        if self.held.is_empty() {
            self.progress.above(|| anstream::println!("{line}"));
        } else {
            self.held.push(Held::Line(line));
        }
    }

    /// Prints what was held.
    fn release(&mut self) {
        for held in std::mem::take(&mut self.held) {
            match held {
                Held::Line(line) => self.print(line),
                Held::Stop { event, agent, bars } => self.child(&agent, &event, &bars),
            }
        }
    }

    /// A line about an agent below.
    fn child(&mut self, agent: &Symbol, event: &Event, bars: &(String, usize)) {
        let goal = event.goal.as_ref().map_or("", Symbol::as_str);
        let task = self.tasks.get(goal).map(ToString::to_string);
        let spot = self.last.as_ref().map_or_else(String::new, |snapshot| {
            format!(", {}", snapshot.words_standing())
        });
        if let Some(line) = of_child(task.as_deref().unwrap_or(goal), &event.what, &spot) {
            self.line(event.at, agent.as_str(), bars, 4, &line);
        }
    }

    fn colour(&mut self, goal: &GoalId) -> Style {
        let next = COLOURS[self.colours.len() % COLOURS.len()].on_default();
        *self.colours.entry(goal.clone()).or_insert(next)
    }

    /// Follows which goals are suspended and which one runs, as far as the bars show it.
    fn follow(&mut self, event: &Event) {
        let Some(goal) = &event.goal else { return };
        match &event.what {
            Happening::GoalStarted | Happening::GoalResumed { .. } => {
                self.stack.retain(|suspended| suspended != goal);
                self.running = Some(goal.clone());
            }
            Happening::GoalSuspended { .. } => {
                self.stack.retain(|suspended| suspended != goal);
                if self.stack.len() < event.stack_depth {
                    self.stack.push(goal.clone());
                }
                // The user may have set aside a goal that did not run.
                if self.running.as_ref() == Some(goal) {
                    self.running = None;
                }
            }
            Happening::GoalSucceeded
            | Happening::GoalFailed { .. }
            | Happening::GoalUnknown { .. }
            | Happening::GoalBlocked { .. } => {
                self.stack.retain(|suspended| suspended != goal);
                if self.running.as_ref() == Some(goal) {
                    self.running = None;
                }
            }
            _ => {}
        }
    }

    /// A bar for every suspended goal, and a thin one for the goal that runs.
    fn bars(&self, depth: usize) -> (String, usize) {
        let style = |goal: Option<&GoalId>| goal.and_then(|goal| self.colours.get(goal)).copied();
        let mut bars = String::new();
        for place in 0..depth {
            // Goals that were suspended before anybody watched have no colour.
            let style = style(self.stack.get(place)).unwrap_or(DIM);
            let _ = write!(bars, "{style}┃{style:#} ");
        }
        if let Some(style) = style(self.running.as_ref()) {
            let _ = write!(bars, "{style}│{style:#} ");
        } else {
            bars.push_str("  ");
        }
        (bars, 2 * (depth + 1))
    }

    fn line(&mut self, at: Time, agent: &str, bars: &(String, usize), indent: usize, line: &Line) {
        let time = at.since(self.zero).secs();
        let Line { sign, style, text } = line;
        let taken = MARGIN + bars.1 + indent + 2;
        let mut rows = wrapped(text, width().saturating_sub(taken)).into_iter();
        let first = rows.next().unwrap_or_default();
        let mut shown = format!(
            "{time:>7.1} s  {DIM}{agent:<6}{DIM:#} {}{:indent$}{style}{sign} {first}{style:#}",
            bars.0, ""
        );
        for row in rows {
            let _ = write!(
                shown,
                "\n{:MARGIN$}{}{:indent$}  {style}{row}{style:#}",
                "", bars.0, ""
            );
        }
        self.print(shown);
    }
}

impl Screen for ForPeople {
    fn event(&mut self, agent: &Symbol, event: &Event) {
        let goal = event.goal.as_ref().map_or("", Symbol::as_str);
        if *agent == parent_agent::NAME {
            if let Some(goal) = &event.goal {
                self.colour(goal);
            }
            if let Happening::ActionStarted { id, action } = &event.what {
                self.tasks.insert(id.to_string(), action.clone());
            }
            let before = (self.running.clone(), self.bars(self.stack.len()));
            self.follow(event);
            self.ledger.note(self.zero, event);
            let bars = match &event.what {
                // The last line of a goal stands by its bar.
                Happening::GoalSucceeded
                | Happening::GoalFailed { .. }
                | Happening::GoalUnknown { .. }
                    if before.0.as_ref() == event.goal.as_ref() =>
                {
                    before.1
                }
                _ => self.bars(self.stack.len()),
            };
            if let Some(line) = of_parent(goal, &event.what, &self.observable) {
                self.line(event.at, agent.as_str(), &bars, 0, &line);
            }
            self.progress.goals(self.running.as_ref(), &self.stack);
        } else if *agent != executor_sim::program::EXECUTOR {
            let bars = self.bars(self.stack.len());
            let stops = matches!(
                event.what,
                Happening::ActionSuspended { .. } | Happening::GoalSuspended { action: None, .. }
            );
            let known = |last: &Snapshot| last.at >= event.at;
            // Where nobody sees the robot, nobody waits for a picture.
            if stops && self.last.as_ref().is_some_and(|last| !known(last)) {
                self.held.push(Held::Stop {
                    event: event.clone(),
                    agent: agent.clone(),
                    bars,
                });
            } else {
                self.child(agent, event, &bars);
            }
        }
    }

    fn told(&mut self, at: Time, told: &Told) {
        let line = match told {
            Told::Said(event) => match (&event.say, &event.what) {
                (Some(say), _) => Line {
                    sign: '»',
                    style: BOLD,
                    text: say.clone(),
                },
                (None, Some(What::Fact(fact))) => Line {
                    sign: '»',
                    style: BOLD,
                    text: format!("{fact}"),
                },
                // The robot's own words say it.
                (None, _) => return,
            },
            Told::Refused(event, reason) => Line {
                sign: '✗',
                style: BAD,
                text: format!("line {} of the scenario: {reason}", event.line),
            },
        };
        let bars = self.bars(self.stack.len());
        self.line(at, "", &bars, 0, &line);
    }

    fn saw(&mut self, snapshot: &Snapshot) {
        let since = snapshot.at.since(self.zero);
        let words = snapshot.words(self.last.as_ref());
        self.progress.place(since, &words, snapshot.odometer_m);
        self.last = Some(snapshot.clone());
        let stopped = self.held.iter().rev().find_map(|held| match held {
            Held::Stop { event, .. } => Some(event.at),
            Held::Line(_) => None,
        });
        if stopped.is_some_and(|stopped| snapshot.at >= stopped) {
            self.release();
        }
    }

    fn role(&mut self, at: Time, news: &RoleNews) {
        match news {
            RoleNews::Said(role, line) => self.print(format!("{DIM}{role}: {line}{DIM:#}")),
            news => {
                let bars = self.bars(self.stack.len());
                self.line(at, "", &bars, 0, &of_role(news));
            }
        }
    }
}

pub(super) fn width() -> usize {
    match console::Term::stdout().size_checked() {
        Some((_, columns)) => usize::from(columns),
        None => USUAL_WIDTH,
    }
}

/// Text in rows, broken between words: an HDDL expression without parts is one word.
pub(super) fn wrapped(text: &str, width: usize) -> Vec<String> {
    if width < NARROWEST - MARGIN {
        return vec![text.to_owned()];
    }
    rows(text, width)
}

/// The same, however narrow it is.
pub(super) fn rows(text: &str, width: usize) -> Vec<String> {
    let mut rows: Vec<String> = Vec::new();
    let mut length = 0;
    for word in words(text) {
        let word_length = word.chars().count();
        match rows.last_mut() {
            Some(row) if length + 1 + word_length <= width => {
                row.push(' ');
                row.push_str(word);
                length += 1 + word_length;
            }
            _ => {
                rows.push(word.to_owned());
                length = word_length;
            }
        }
    }
    rows
}

/// Words, parenthesised expressions kept whole.
pub(super) fn words(text: &str) -> impl Iterator<Item = &str> {
    let mut depth = 0_usize;
    text.split(move |c| {
        match c {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        c == ' ' && depth == 0
    })
    .filter(|word| !word.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_broken_between_expressions() {
        let text = "plan (enter area1 area3 door1_3) (approach n40 area8) (present n40) (cost 59.4, 2 others kept)";
        assert_eq!(
            wrapped(text, 60),
            [
                "plan (enter area1 area3 door1_3) (approach n40 area8)",
                "(present n40) (cost 59.4, 2 others kept)",
            ]
        );
        assert_eq!(wrapped(text, 10), [text]);
    }
}
