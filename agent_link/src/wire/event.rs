//! Events: one flat JSON object a line.

use agent_core::model::{Action, Atom, Cost, Fact, FactChange, Symbol, Task, Time};
use agent_core::protocol::{self, ActionId, Event, Urgency};
use serde::{Deserialize, Serialize};

use super::text::{changes_to_text, from_text, to_text};
use super::{Text, VERSION, WireError};

/// An event as it travels.
#[derive(Debug, Serialize, Deserialize)]
struct Line {
    v: u32,
    t_s: f64,
    agent: String,
    #[serde(flatten, default, skip_serializing_if = "Option::is_none")]
    number: Option<EventNumber>,
    /// `null` where the event is about no goal.
    #[serde(default)]
    goal: Option<String>,
    stack_depth: usize,
    #[serde(flatten)]
    what: What,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(tag = "event", rename_all = "snake_case")]
enum What {
    GoalAccepted {
        tasks: Vec<Text<Atom>>,
        urgency: UrgencyWord,
        priority: i32,
    },
    GoalRejected {
        reason: String,
    },
    GoalStarted,
    GoalSuspended {
        why: String,
        action: Option<Text<Action>>,
    },
    GoalResumed {
        how: ResumptionWord,
        why: String,
        expanded: u64,
    },
    GoalSucceeded,
    GoalFailed {
        reason: String,
    },
    GoalUnknown {
        reason: String,
    },
    GoalBlocked {
        blocked_by: Vec<Text<Atom>>,
    },
    PlanSelected {
        steps: Vec<Text<Action>>,
        cost: f64,
        alternatives: Vec<f64>,
        why: String,
        expanded: u64,
    },
    PlanRevised {
        why: String,
        kept: usize,
    },
    ActionsCombined {
        actions: Vec<Text<Action>>,
        beside: Vec<Text<Action>>,
        after: Vec<(Text<Action>, Vec<Text<Action>>)>,
        saving_s: f64,
        why: String,
    },
    TaskRepaired {
        task: Text<Atom>,
        levels: usize,
        failed: Text<Action>,
    },
    ActionStarted {
        action_id: Text<ActionId>,
        action: Text<Action>,
    },
    ActionStopping {
        action_id: Text<ActionId>,
        action: Text<Action>,
    },
    ActionSuspended {
        action_id: Text<ActionId>,
        action: Text<Action>,
    },
    ActionResumed {
        action_id: Text<ActionId>,
        action: Text<Action>,
    },
    ActionRolledBack {
        action_id: Text<ActionId>,
        action: Text<Action>,
    },
    ActionFinished {
        action_id: Text<ActionId>,
        action: Text<Action>,
        failure: Option<String>,
    },
    RecordCleared {
        action_id: Text<ActionId>,
        action: Text<Action>,
    },
    NeighbourLost {
        name: String,
    },
    NeighbourBack {
        name: String,
    },
    TaskOffered {
        what: Text<Task>,
        urgency: UrgencyWord,
    },
    TaskGiven {
        what: Text<Task>,
        to: String,
    },
    TaskEnded {
        what: Text<Task>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        by: Option<String>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        failure: Option<String>,
    },
    VehicleLost {
        name: String,
        held: Vec<Text<Fact>>,
        tasks: Vec<Text<Task>>,
    },
    FactsTold {
        by: String,
        changes: Vec<Text<FactChange>>,
    },
    BeliefChanged {
        changes: Vec<Text<FactChange>>,
    },
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum UrgencyWord {
    Normal,
    Emergency,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum ResumptionWord {
    Continued,
    Alternative,
    Repaired,
    Replanned,
}

/// Which of an agent's events it is. One that is told again, after a restart, has the same number.
#[derive(Clone, Copy, Debug, Eq, PartialEq, Ord, PartialOrd, Serialize, Deserialize)]
pub struct EventNumber {
    /// The epoch in which the agent's memory, and its counting, begins.
    pub line: u64,
    /// Counts from 1.
    pub n: u64,
}

/// An event of `agent` as a line, without a line break.
pub fn event_to_line(agent: &str, event: &Event) -> Result<String, WireError> {
    numbered_event_to_line(agent, None, event)
}

/// The line that is published for an event of `agent`, without a line break.
pub fn numbered_event_to_line(
    agent: &str,
    number: Option<EventNumber>,
    event: &Event,
) -> Result<String, WireError> {
    super::write(&Line {
        v: VERSION,
        t_s: event.at.secs(),
        agent: agent.to_owned(),
        number,
        goal: event.goal.as_ref().map(ToString::to_string),
        stack_depth: event.stack_depth,
        what: to_wire(&event.what),
    })
}

/// The agent and the event that a line tells of.
pub fn event_from_line(line: &[u8]) -> Result<(Symbol, Event), WireError> {
    let (agent, _, event) = numbered_event_from_line(line)?;
    Ok((agent, event))
}

/// The same, with its number, if it has one.
pub fn numbered_event_from_line(
    line: &[u8],
) -> Result<(Symbol, Option<EventNumber>, Event), WireError> {
    let line: Line = super::read("event", line)?;
    let number = line.number;
    let event = Event {
        at: Time::from_secs(line.t_s),
        goal: line.goal.map(Into::into),
        stack_depth: line.stack_depth,
        what: from_wire(line.what),
    };
    Ok((line.agent.into(), number, event))
}

/// Identifier and action of an execution, as they travel.
fn pair(id: &ActionId, action: &Action) -> (Text<ActionId>, Text<Action>) {
    (Text(id.clone()), Text(action.clone()))
}

fn to_wire(what: &protocol::Happening) -> What {
    use protocol::{Happening as Core, Resumption};
    match what {
        Core::GoalAccepted {
            tasks,
            urgency,
            priority,
        } => What::GoalAccepted {
            tasks: to_text(tasks),
            urgency: match urgency {
                Urgency::Normal => UrgencyWord::Normal,
                Urgency::Emergency => UrgencyWord::Emergency,
            },
            priority: *priority,
        },
        Core::GoalRejected { reason } => What::GoalRejected {
            reason: reason.clone(),
        },
        Core::GoalStarted => What::GoalStarted,
        Core::GoalSuspended { why, action } => What::GoalSuspended {
            why: why.clone(),
            action: action.clone().map(Text),
        },
        Core::GoalResumed { how, why, expanded } => What::GoalResumed {
            how: match how {
                Resumption::Continued => ResumptionWord::Continued,
                Resumption::Alternative => ResumptionWord::Alternative,
                Resumption::Repaired => ResumptionWord::Repaired,
                Resumption::Replanned => ResumptionWord::Replanned,
            },
            why: why.clone(),
            expanded: *expanded,
        },
        Core::GoalSucceeded => What::GoalSucceeded,
        Core::GoalFailed { reason } => What::GoalFailed {
            reason: reason.clone(),
        },
        Core::GoalUnknown { reason } => What::GoalUnknown {
            reason: reason.clone(),
        },
        Core::GoalBlocked { blocked_by } => What::GoalBlocked {
            blocked_by: to_text(blocked_by),
        },
        Core::PlanSelected {
            steps,
            cost,
            alternatives,
            why,
            expanded,
        } => What::PlanSelected {
            steps: to_text(steps),
            cost: cost.units(),
            alternatives: alternatives.iter().map(|cost| cost.units()).collect(),
            why: why.clone(),
            expanded: *expanded,
        },
        Core::PlanRevised { why, kept } => What::PlanRevised {
            why: why.clone(),
            kept: *kept,
        },
        Core::ActionsCombined {
            actions,
            beside,
            after,
            saving_s,
            why,
        } => What::ActionsCombined {
            actions: to_text(actions),
            beside: to_text(beside),
            after: (after.iter())
                .map(|(action, before)| (Text(action.clone()), to_text(before)))
                .collect(),
            saving_s: *saving_s,
            why: why.clone(),
        },
        Core::TaskRepaired {
            task,
            levels,
            failed,
        } => What::TaskRepaired {
            task: Text(task.clone()),
            levels: *levels,
            failed: Text(failed.clone()),
        },
        Core::ActionStarted { id, action } => {
            let (action_id, action) = pair(id, action);
            What::ActionStarted { action_id, action }
        }
        Core::ActionStopping { id, action } => {
            let (action_id, action) = pair(id, action);
            What::ActionStopping { action_id, action }
        }
        Core::ActionSuspended { id, action } => {
            let (action_id, action) = pair(id, action);
            What::ActionSuspended { action_id, action }
        }
        Core::ActionResumed { id, action } => {
            let (action_id, action) = pair(id, action);
            What::ActionResumed { action_id, action }
        }
        Core::ActionRolledBack { id, action } => {
            let (action_id, action) = pair(id, action);
            What::ActionRolledBack { action_id, action }
        }
        Core::ActionFinished {
            id,
            action,
            failure,
        } => {
            let (action_id, action) = pair(id, action);
            What::ActionFinished {
                action_id,
                action,
                failure: failure.clone(),
            }
        }
        Core::RecordCleared { id, action } => {
            let (action_id, action) = pair(id, action);
            What::RecordCleared { action_id, action }
        }
        Core::NeighbourLost { name } => What::NeighbourLost {
            name: name.to_string(),
        },
        Core::NeighbourBack { name } => What::NeighbourBack {
            name: name.to_string(),
        },
        Core::TaskOffered { what, urgency } => What::TaskOffered {
            what: Text(what.clone()),
            urgency: match urgency {
                Urgency::Normal => UrgencyWord::Normal,
                Urgency::Emergency => UrgencyWord::Emergency,
            },
        },
        Core::TaskGiven { what, to } => What::TaskGiven {
            what: Text(what.clone()),
            to: to.to_string(),
        },
        Core::TaskEnded { what, by, failure } => What::TaskEnded {
            what: Text(what.clone()),
            by: by.as_ref().map(ToString::to_string),
            failure: failure.clone(),
        },
        Core::VehicleLost { name, held, tasks } => What::VehicleLost {
            name: name.to_string(),
            held: to_text(held),
            tasks: to_text(tasks),
        },
        Core::FactsTold { by, changes } => What::FactsTold {
            by: by.to_string(),
            changes: changes_to_text(changes),
        },
        Core::BeliefChanged { changes } => What::BeliefChanged {
            changes: changes_to_text(changes),
        },
    }
}

fn from_wire(what: What) -> protocol::Happening {
    use protocol::{Happening as Core, Resumption};
    match what {
        What::GoalAccepted {
            tasks,
            urgency,
            priority,
        } => Core::GoalAccepted {
            tasks: from_text(tasks),
            urgency: match urgency {
                UrgencyWord::Normal => Urgency::Normal,
                UrgencyWord::Emergency => Urgency::Emergency,
            },
            priority,
        },
        What::GoalRejected { reason } => Core::GoalRejected { reason },
        What::GoalStarted => Core::GoalStarted,
        What::GoalSuspended { why, action } => Core::GoalSuspended {
            why,
            action: action.map(|Text(action)| action),
        },
        What::GoalResumed { how, why, expanded } => Core::GoalResumed {
            how: match how {
                ResumptionWord::Continued => Resumption::Continued,
                ResumptionWord::Alternative => Resumption::Alternative,
                ResumptionWord::Repaired => Resumption::Repaired,
                ResumptionWord::Replanned => Resumption::Replanned,
            },
            why,
            expanded,
        },
        What::GoalSucceeded => Core::GoalSucceeded,
        What::GoalFailed { reason } => Core::GoalFailed { reason },
        What::GoalUnknown { reason } => Core::GoalUnknown { reason },
        What::GoalBlocked { blocked_by } => Core::GoalBlocked {
            blocked_by: from_text(blocked_by),
        },
        What::PlanSelected {
            steps,
            cost,
            alternatives,
            why,
            expanded,
        } => Core::PlanSelected {
            steps: from_text(steps),
            cost: Cost::from_units(cost),
            alternatives: alternatives.into_iter().map(Cost::from_units).collect(),
            why,
            expanded,
        },
        What::PlanRevised { why, kept } => Core::PlanRevised { why, kept },
        What::ActionsCombined {
            actions,
            beside,
            after,
            saving_s,
            why,
        } => Core::ActionsCombined {
            actions: from_text(actions),
            beside: from_text(beside),
            after: (after.into_iter())
                .map(|(action, before)| (action.0, from_text(before)))
                .collect(),
            saving_s,
            why,
        },
        What::TaskRepaired {
            task,
            levels,
            failed,
        } => Core::TaskRepaired {
            task: task.0,
            levels,
            failed: failed.0,
        },
        What::ActionStarted { action_id, action } => Core::ActionStarted {
            id: action_id.0,
            action: action.0,
        },
        What::ActionStopping { action_id, action } => Core::ActionStopping {
            id: action_id.0,
            action: action.0,
        },
        What::ActionSuspended { action_id, action } => Core::ActionSuspended {
            id: action_id.0,
            action: action.0,
        },
        What::ActionResumed { action_id, action } => Core::ActionResumed {
            id: action_id.0,
            action: action.0,
        },
        What::ActionRolledBack { action_id, action } => Core::ActionRolledBack {
            id: action_id.0,
            action: action.0,
        },
        What::ActionFinished {
            action_id,
            action,
            failure,
        } => Core::ActionFinished {
            id: action_id.0,
            action: action.0,
            failure,
        },
        What::RecordCleared { action_id, action } => Core::RecordCleared {
            id: action_id.0,
            action: action.0,
        },
        What::NeighbourLost { name } => Core::NeighbourLost { name: name.into() },
        What::NeighbourBack { name } => Core::NeighbourBack { name: name.into() },
        What::TaskOffered { what, urgency } => Core::TaskOffered {
            what: what.0,
            urgency: match urgency {
                UrgencyWord::Normal => Urgency::Normal,
                UrgencyWord::Emergency => Urgency::Emergency,
            },
        },
        What::TaskGiven { what, to } => Core::TaskGiven {
            what: what.0,
            to: to.into(),
        },
        What::TaskEnded { what, by, failure } => Core::TaskEnded {
            what: what.0,
            by: by.map(Into::into),
            failure,
        },
        What::VehicleLost { name, held, tasks } => Core::VehicleLost {
            name: name.into(),
            held: from_text(held),
            tasks: from_text(tasks),
        },
        What::FactsTold { by, changes } => Core::FactsTold {
            by: by.into(),
            changes: from_text(changes),
        },
        What::BeliefChanged { changes } => Core::BeliefChanged {
            changes: from_text(changes),
        },
    }
}
