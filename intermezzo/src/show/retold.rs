//! What a vehicle has done, and why it was interrupted, in a few lines.

use std::collections::BTreeMap;
use std::fmt::Write;

use agent_core::model::{Task, Time};
use agent_core::protocol::{Event, GoalId, Happening, Urgency};
use anstyle::Style;

use super::people::rows;
use super::words::resumption;
use crate::style::{AGAIN, ASIDE, BAD, BOLD, DIM, GOOD, URGENT};

/// Further to the right than the vehicle's name.
const GOALS: usize = 2;
/// Further to the right than a goal.
const TURNS: usize = 4;

/// The goals of one vehicle, in the order in which they came.
#[derive(Debug, Default)]
pub(super) struct Retold {
    goals: Vec<Life>,
    /// Ends of goals whose beginning was not heard: after a new start what was said before may be repeated
    /// later.
    ends: BTreeMap<GoalId, (f64, End)>,
}

/// What became of one.
#[derive(Debug)]
struct Life {
    goal: GoalId,
    words: String,
    urgent: bool,
    accepted_s: f64,
    turns: Vec<Turn>,
    ended: Option<(f64, End)>,
}

#[derive(Debug)]
enum End {
    Done,
    Failed(String),
    Unknown(String),
}

/// What happened to a goal on the way.
#[derive(Debug)]
struct Turn {
    at_s: f64,
    sign: char,
    style: Style,
    words: String,
}

impl Retold {
    /// Takes note of an event of the vehicle. `given` is what the goal is to somebody to whom its name
    /// says nothing.
    pub(super) fn note(&mut self, zero: Time, event: &Event, given: bool) {
        let Some(goal) = &event.goal else { return };
        let at_s = event.at.since(zero).secs();
        if let Happening::GoalAccepted { tasks, urgency, .. } = &event.what {
            if self.goals.iter().any(|life| life.goal == *goal) {
                return;
            }
            self.goals.push(Life {
                goal: goal.clone(),
                words: words(goal, tasks, given),
                urgent: *urgency == Urgency::Emergency,
                accepted_s: at_s,
                turns: Vec::new(),
                ended: self.ends.remove(goal),
            });
            return;
        }
        let life = self.goals.iter_mut().find(|life| life.goal == *goal);
        if let Some(end) = end(&event.what) {
            match life {
                Some(life) => life.ended = Some((at_s, end)),
                None => {
                    self.ends.insert(goal.clone(), (at_s, end));
                }
            }
            return;
        }
        let Some(life) = life else { return };
        let (sign, style, words) = match &event.what {
            Happening::GoalSuspended { why, action } => {
                let middle = match action {
                    Some(action) => format!("in the middle of {action}"),
                    None => "between two actions".to_owned(),
                };
                ('‖', ASIDE, format!("set aside {middle}: {why}"))
            }
            Happening::GoalResumed { how, why, .. } => {
                let how = resumption(*how);
                ('↩', AGAIN, format!("taken up again, {how}: {why}"))
            }
            Happening::GoalBlocked { blocked_by } => {
                let facts: Vec<String> = blocked_by.iter().map(ToString::to_string).collect();
                ('■', ASIDE, format!("waits for {}", facts.join(" ")))
            }
            Happening::TaskRepaired { task, .. } => ('≠', AGAIN, format!("does {task} otherwise")),
            Happening::ActionFinished {
                action,
                failure: Some(failure),
                ..
            } => ('✗', BAD, format!("{action} has failed: {failure}")),
            _ => return,
        };
        life.turns.push(Turn {
            at_s,
            sign,
            style,
            words,
        });
    }

    /// All of it, in lines that are no wider than that. `None` if there were no goals.
    pub(super) fn lines(&self, vehicle: &str, width: usize) -> Option<String> {
        if self.goals.is_empty() {
            return None;
        }
        let mut lines = format!("{BOLD}{vehicle}{BOLD:#}{}", self.in_short());
        for life in &self.goals {
            let (sign, style, end) = match &life.ended {
                Some((at_s, End::Done)) => ('✓', GOOD, format!("to {at_s:.1} s")),
                Some((at_s, End::Failed(why))) => {
                    ('✗', BAD, format!("to {at_s:.1} s, failed: {why}"))
                }
                Some((at_s, End::Unknown(why))) => {
                    ('?', BAD, format!("to {at_s:.1} s, nobody knows: {why}"))
                }
                None => (' ', DIM, "and not done yet".to_owned()),
            };
            let urgent = if life.urgent { ", urgent" } else { "" };
            let text = format!("{}{urgent}, {:.1} s {end}", life.words, life.accepted_s);
            let style = if life.urgent && style == GOOD {
                URGENT
            } else {
                style
            };
            put(&mut lines, GOALS, (sign, style), &text, width);
            for turn in &life.turns {
                let text = format!("{:.1} s {}", turn.at_s, turn.words);
                put(&mut lines, TURNS, (turn.sign, turn.style), &text, width);
            }
        }
        Some(lines)
    }

    /// How many of what.
    fn in_short(&self) -> String {
        let done = self.count(|life| matches!(life.ended, Some((_, End::Done))));
        let ended = self.count(|life| life.ended.is_some());
        let aside = self.count(|life| life.turns.iter().any(|turn| turn.sign == '‖'));
        let all = self.goals.len();
        let mut text = match (done, all) {
            (1, 1) => " did what it had to do".to_owned(),
            (done, all) if done == all => format!(" did all {all} that it had to do"),
            (done, all) => format!(" did {done} of {all}"),
        };
        if ended > done {
            let _ = write!(text, ", {} failed", ended - done);
        }
        match aside {
            0 => {}
            1 => text.push_str("; one of them was interrupted"),
            aside => {
                let _ = write!(text, "; {aside} of them were interrupted");
            }
        }
        text
    }

    fn count(&self, which: impl Fn(&Life) -> bool) -> usize {
        self.goals.iter().filter(|life| which(life)).count()
    }
}

/// How a goal has ended, if that is what has happened.
fn end(what: &Happening) -> Option<End> {
    Some(match what {
        Happening::GoalSucceeded => End::Done,
        Happening::GoalFailed { reason } => End::Failed(reason.clone()),
        Happening::GoalUnknown { reason } => End::Unknown(reason.clone()),
        _ => return None,
    })
}

/// What a goal is called.
fn words(goal: &GoalId, tasks: &[Task], given: bool) -> String {
    let tasks: Vec<String> = tasks.iter().map(ToString::to_string).collect();
    let tasks = tasks.join(" ");
    match given {
        true => tasks,
        false => format!("{goal} {tasks}"),
    }
}

/// A sign and words that begin so far to the right, in rows that stay there.
fn put(lines: &mut String, indent: usize, (sign, style): (char, Style), text: &str, width: usize) {
    let room = width.saturating_sub(indent + 2);
    for (index, row) in rows(text, room).into_iter().enumerate() {
        let sign = if index == 0 { sign } else { ' ' };
        let _ = write!(lines, "\n{:indent$}{style}{sign}{style:#} {row}", "");
    }
}

#[cfg(test)]
mod tests {
    use agent_core::model::Atom;
    use agent_core::protocol::Resumption;

    use super::*;

    fn note(retold: &mut Retold, at_s: f64, goal: &str, what: Happening) {
        let event = Event {
            at: Time::from_secs(at_s),
            goal: Some(goal.into()),
            stack_depth: 0,
            what,
        };
        retold.note(Time::ZERO, &event, goal.contains('.'));
    }

    fn task(name: &str, args: &[&str]) -> Task {
        Atom::new(name, args.iter().copied())
    }

    fn accepted(tasks: Task, urgency: Urgency) -> Happening {
        Happening::GoalAccepted {
            tasks: vec![tasks],
            urgency,
            priority: 0,
        }
    }

    fn evening() -> Retold {
        let mut retold = Retold::default();
        let serve = accepted(task("serve", &["cola", "ann"]), Urgency::Normal);
        note(&mut retold, 1.0, "k2.1.1", serve);
        let why = "spill goes first".to_owned();
        let action = Some(task("grasp", &["cola1", "ann", "kitchen"]));
        let aside = Happening::GoalSuspended { why, action };
        note(&mut retold, 5.0, "k2.1.1", aside);
        let clean = accepted(task("clean", &["table3"]), Urgency::Emergency);
        note(&mut retold, 5.0, "spill", clean);
        note(&mut retold, 9.0, "spill", Happening::GoalSucceeded);
        let resumed = Happening::GoalResumed {
            how: Resumption::Continued,
            why: "the suspended plan still holds".to_owned(),
            expanded: 2,
        };
        note(&mut retold, 9.0, "k2.1.1", resumed);
        note(&mut retold, 12.5, "k2.1.1", Happening::GoalSucceeded);
        retold
    }

    fn plain(text: &str) -> String {
        anstream::adapter::strip_str(text).to_string()
    }

    #[test]
    fn an_evening_is_retold_with_what_interrupted_it_and_how_it_went_on() {
        let told = evening().lines("k3", 200).expect("there were goals");
        let wanted = "\
k3 did all 2 that it had to do; one of them was interrupted
  ✓ (serve cola ann), 1.0 s to 12.5 s
    ‖ 5.0 s set aside in the middle of (grasp cola1 ann kitchen): spill goes first
    ↩ 9.0 s taken up again, continued: the suspended plan still holds
  ✓ spill (clean table3), urgent, 5.0 s to 9.0 s";
        assert_eq!(plain(&told), wanted);
    }

    #[test]
    fn what_is_repeated_late_changes_nothing() {
        let mut retold = evening();
        let serve = accepted(task("serve", &["cola", "ann"]), Urgency::Normal);
        note(&mut retold, 1.0, "k2.1.1", serve);
        let told = |retold: &Retold| retold.lines("k3", 200).map(|told| plain(&told));
        assert_eq!(told(&retold), told(&evening()));
        // An end may be heard before its beginning.
        note(&mut retold, 20.0, "cola", Happening::GoalSucceeded);
        let cola = accepted(task("serve", &["cola", "ben"]), Urgency::Normal);
        note(&mut retold, 14.0, "cola", cola);
        let words = "✓ cola (serve cola ben), 14.0 s to 20.0 s";
        assert!(told(&retold).is_some_and(|told| told.contains(words)));
    }

    #[test]
    fn no_line_is_wider_than_the_terminal() {
        let told = evening().lines("k3", 60).expect("there were goals");
        for row in plain(&told).lines() {
            assert!(row.chars().count() <= 60, "{row}");
        }
    }

    #[test]
    fn of_a_vehicle_without_goals_there_is_nothing_to_tell() {
        assert_eq!(Retold::default().lines("k3", 80), None);
    }
}
