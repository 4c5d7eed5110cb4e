//! Events in words.

use std::collections::BTreeSet;

use agent_core::model::{Action, Cost, FactChange, Symbol, Task};
use agent_core::protocol::{Happening, Resumption, Urgency};
use anstyle::Style;

use crate::robot::RoleNews;
use crate::style::{AGAIN, ASIDE, BAD, DIM, GOOD, URGENT};

/// A line about an event.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Line {
    /// One character that can be found at a glance.
    pub(super) sign: char,
    pub(super) style: Style,
    pub(super) text: String,
}

fn line(sign: char, style: Style, text: impl Into<String>) -> Line {
    Line {
        sign,
        style,
        text: text.into(),
    }
}

/// Which parts of the world people want to hear of: what nobody has to be told to change.
pub(super) type Observable = BTreeSet<Symbol>;

/// An event of the agent that takes the goals. `None` for what another event tells as well.
pub(super) fn of_parent(goal: &str, what: &Happening, observable: &Observable) -> Option<Line> {
    Some(match what {
        Happening::GoalAccepted {
            tasks,
            urgency,
            priority,
        } => {
            let tasks = texts(tasks);
            let priority = match priority {
                0 => String::new(),
                priority => format!(", priority {priority}"),
            };
            match urgency {
                Urgency::Normal => line('+', DIM, format!("{goal}: {tasks}{priority}")),
                Urgency::Emergency => {
                    line('!', URGENT, format!("{goal}: {tasks}, urgent{priority}"))
                }
            }
        }
        Happening::GoalRejected { reason } => line('✗', BAD, format!("refused: {reason}")),
        Happening::GoalStarted => line('▶', GOOD, format!("begins {goal}")),
        Happening::GoalSuspended { why, action } => line(
            '‖',
            ASIDE,
            match action {
                Some(action) => format!("sets {goal} aside in the middle of {action}: {why}"),
                None => format!("sets {goal} aside between two actions: {why}"),
            },
        ),
        Happening::GoalResumed { how, why, expanded } => line(
            '↩',
            AGAIN,
            format!(
                "takes up {goal} again, {}: {why} ({expanded} nodes expanded)",
                resumption(*how)
            ),
        ),
        Happening::GoalSucceeded => line('✓', GOOD, format!("{goal} is done")),
        Happening::GoalFailed { reason } => line('✗', BAD, format!("{goal} has failed: {reason}")),
        Happening::GoalUnknown { reason } => line(
            '?',
            BAD,
            format!("nobody knows whether {goal} is done: {reason}"),
        ),
        Happening::NeighbourLost { name } => line(
            '!',
            BAD,
            format!("the {name} is gone: all that needs it waits"),
        ),
        Happening::NeighbourBack { name } => line('i', ASIDE, format!("the {name} is there again")),
        Happening::GoalBlocked { blocked_by } => line(
            '■',
            ASIDE,
            format!("{goal} is blocked and waits for {}", texts(blocked_by)),
        ),
        Happening::PlanSelected {
            steps,
            cost,
            alternatives,
            why,
            ..
        } => line(' ', DIM, plan(steps, *cost, alternatives, why)),
        Happening::PlanRevised { why, kept } => line(
            '≠',
            ASIDE,
            format!(
                "the plan of {goal} no longer holds: {why}{}",
                match kept {
                    0 => String::new(),
                    1 => "; another one that is kept does".to_owned(),
                    kept => format!("; {kept} others that are kept do"),
                }
            ),
        ),
        Happening::ActionsCombined {
            actions,
            beside,
            after,
            why,
            ..
        } => line('∥', DIM, together(actions, beside, after, why)),
        Happening::TaskRepaired { task, levels, .. } => line('≠', AGAIN, repaired(task, *levels)),
        Happening::ActionStarted { action, .. } => line('·', Style::new(), action.to_string()),
        Happening::ActionResumed { action, .. } => line('·', AGAIN, action.to_string()),
        Happening::ActionRolledBack { action, .. } => {
            line('·', AGAIN, format!("{action} has undone it"))
        }
        Happening::ActionFinished {
            action,
            failure: Some(failure),
            ..
        } => line('✗', BAD, format!("{action} has failed: {failure}")),
        Happening::RecordCleared { action, .. } => {
            line('×', DIM, format!("will not resume {action}"))
        }
        Happening::TaskOffered { what, urgency } => {
            let urgent = match urgency {
                Urgency::Normal => "",
                Urgency::Emergency => ", urgent",
            };
            line('?', DIM, format!("who can do {what}{urgent}?"))
        }
        Happening::TaskGiven { what, to } => line('→', DIM, format!("{to} gets {what}")),
        Happening::TaskEnded { what, by, failure } => match (by, failure) {
            (Some(by), _) => line('✓', DIM, format!("{what} was done by {by}")),
            (None, Some(why)) => line('✗', BAD, format!("{what} was given up: {why}")),
            (None, None) => line('✓', DIM, format!("{what} needs no doing any more")),
        },
        Happening::VehicleLost { name, held, tasks } => {
            let held = match held.as_slice() {
                [] => String::new(),
                held => format!("; it has {}", texts(held)),
            };
            let tasks = match tasks.as_slice() {
                [] => String::new(),
                tasks => format!("; it was to do {}", texts(tasks)),
            };
            line('!', BAD, format!("{name} is gone{held}{tasks}"))
        }
        // What of it is worth telling is told as a change of the belief.
        Happening::FactsTold { .. } => return None,
        Happening::BeliefChanged { changes } => line('i', ASIDE, news(changes, observable)?),
        Happening::ActionStopping { .. }
        | Happening::ActionSuspended { .. }
        | Happening::ActionFinished { failure: None, .. } => return None,
    })
}

/// An event of an agent below. `task` is what its goal is in its superior's words; `spot` is where
/// the robot is.
pub(super) fn of_child(task: &str, what: &Happening, spot: &str) -> Option<Line> {
    Some(match what {
        Happening::PlanSelected {
            steps,
            cost,
            alternatives,
            why,
            ..
        } => line(' ', DIM, plan(steps, *cost, alternatives, why)),
        Happening::ActionSuspended { action, .. } => {
            line('‖', ASIDE, format!("stops in the middle of {action}{spot}"))
        }
        Happening::GoalSuspended { action: None, .. } => line(
            '‖',
            ASIDE,
            format!("stops between two actions of {task}{spot}"),
        ),
        Happening::GoalResumed { how, why, .. } => line(
            '↩',
            AGAIN,
            format!("takes up {task} again, {}: {why}", resumption(*how)),
        ),
        Happening::ActionResumed { action, .. } => line('·', AGAIN, action.to_string()),
        Happening::ActionRolledBack { action, .. } => {
            line('·', AGAIN, format!("{action} has undone it"))
        }
        Happening::PlanRevised { why, .. } => line(
            '≠',
            DIM,
            format!("the plan of {task} no longer holds: {why}"),
        ),
        Happening::TaskRepaired { task, levels, .. } => line('≠', AGAIN, repaired(task, *levels)),
        Happening::ActionFinished {
            action,
            failure: Some(failure),
            ..
        } => line('✗', BAD, format!("{action} has failed: {failure}")),
        Happening::GoalBlocked { blocked_by } => line(
            '■',
            ASIDE,
            format!("{task} is blocked and waits for {}", texts(blocked_by)),
        ),
        Happening::GoalRejected { reason } => line('✗', BAD, format!("refused: {reason}")),
        // Its superior tells the rest, and an action that just goes well needs no words.
        _ => return None,
    })
}

/// Actions of several goals that are done together.
fn together(
    actions: &[Action],
    beside: &[Action],
    after: &[(Action, Vec<Action>)],
    why: &str,
) -> String {
    let mut text = format!("together: {}", texts(actions));
    if !beside.is_empty() {
        text.push_str(&format!(", beside {}", texts(beside)));
    }
    for (action, before) in after {
        text.push_str(&format!("; {action} after {}", texts(before)));
    }
    format!("{text} ({why})")
}

fn repaired(task: &Task, levels: usize) -> String {
    let plural = if levels == 1 { "" } else { "s" };
    format!("does {task} otherwise, {levels} level{plural} above what has failed")
}

/// What has become of a role's process.
pub(super) fn of_role(news: &RoleNews) -> Line {
    match news {
        RoleNews::Said(role, words) => line(' ', DIM, format!("{role}: {words}")),
        RoleNews::Ready { role, after, .. } => match after {
            Some(after) => line(
                'i',
                AGAIN,
                format!(
                    "{} is there again after {:.1} s",
                    role.in_words(),
                    after.as_secs_f64()
                ),
            ),
            None => line('i', DIM, format!("{} is there", role.in_words())),
        },
        RoleNews::Ended {
            role, how, next_in, ..
        } => line(
            '!',
            BAD,
            format!(
                "{} has died ({how}); it is started again in {:.1} s",
                role.in_words(),
                next_in.as_secs_f64()
            ),
        ),
        RoleNews::Silent { role, pid } => line(
            '!',
            BAD,
            format!("{} does not answer (process {pid})", role.in_words()),
        ),
        RoleNews::Answers { role, .. } => {
            line('i', AGAIN, format!("{} answers again", role.in_words()))
        }
        RoleNews::Killed { role, pid, after } => line(
            '!',
            BAD,
            format!(
                "{} has not answered for {:.0} s: its process {pid} is killed",
                role.in_words(),
                after.as_secs_f64()
            ),
        ),
        RoleNews::GivenUp { role, .. } => line(
            '✗',
            BAD,
            format!(
                "{} ends whenever it is started, so everything is ended",
                role.in_words()
            ),
        ),
    }
}

/// The words of decision 12.
pub(crate) fn resumption(how: Resumption) -> &'static str {
    match how {
        Resumption::Continued => "continued",
        Resumption::Alternative => "alternative plan",
        Resumption::Repaired => "repaired",
        Resumption::Replanned => "replanned",
    }
}

fn plan(steps: &[Action], cost: Cost, alternatives: &[Cost], why: &str) -> String {
    let others = match alternatives.len() {
        0 => String::new(),
        1 => ", 1 other kept".to_owned(),
        others => format!(", {others} others kept"),
    };
    // That the cheapest one is taken goes without saying.
    let why = if why == "it is the cheapest" {
        String::new()
    } else {
        format!(", since {why}")
    };
    let steps: Vec<String> = steps.iter().map(ToString::to_string).collect();
    format!("plan {} (cost {cost}{others}{why})", steps.join(" "))
}

fn texts(atoms: &[Task]) -> String {
    let texts: Vec<String> = atoms.iter().map(ToString::to_string).collect();
    texts.join(" ")
}

fn news(changes: &[FactChange], observable: &Observable) -> Option<String> {
    let news: Vec<String> = changes
        .iter()
        .filter_map(|change| match change {
            FactChange::Add(fact) if observable.contains(&fact.name) => {
                Some(format!("{fact} holds now"))
            }
            FactChange::Remove(fact) if observable.contains(&fact.name) => {
                Some(format!("{fact} holds no longer"))
            }
            _ => None,
        })
        .collect();
    (!news.is_empty()).then(|| news.join("; "))
}
