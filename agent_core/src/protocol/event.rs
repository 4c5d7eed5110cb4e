//! What an agent says about what it does, for people, logs and experiments.

use serde::{Deserialize, Serialize};

use super::{ActionId, GoalId, Urgency};
use crate::model::{Action, Cost, Fact, FactChange, Symbol, Task, Time};

/// Something happened.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Event {
    /// On the world's clock.
    pub at: Time,
    /// The goal that it is about; `None` for a change of belief.
    pub goal: Option<GoalId>,
    /// Entries on the suspended-goal stack when it had happened.
    pub stack_depth: usize,
    /// What.
    pub what: Happening,
}

/// How a suspended goal was taken up again (decision 12).
#[derive(Clone, Copy, Debug, Eq, PartialEq, Serialize, Deserialize)]
pub enum Resumption {
    /// What was left of the suspended plan is followed, beginning with the suspended action if
    /// nobody else has done that meanwhile.
    Continued,
    /// Another plan that was kept.
    Alternative,
    /// A plan that ends as a kept one does and begins otherwise.
    Repaired,
    /// A plan that has no end in common with a kept one.
    Replanned,
}

/// What happened. The names are those of the JSON events, in other letters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Happening {
    /// A goal was acknowledged.
    GoalAccepted {
        /// What is to be done.
        tasks: Vec<Task>,
        /// Normal or emergency.
        urgency: Urgency,
        /// As given.
        priority: i32,
    },
    /// A goal was refused.
    GoalRejected {
        /// In words.
        reason: String,
    },
    /// Work on it has begun.
    GoalStarted,
    /// It was set aside.
    GoalSuspended {
        /// In words: for which goal, by whom.
        why: String,
        /// What the executor can pick up again.
        action: Option<Action>,
    },
    /// It was taken up again.
    GoalResumed {
        /// Decision 12.
        how: Resumption,
        /// In words.
        why: String,
        /// Nodes that the planner expanded until it knew the plan; looking for others to keep beside
        /// it is not counted.
        expanded: u64,
    },
    /// It was reached.
    GoalSucceeded,
    /// It was given up.
    GoalFailed {
        /// In words.
        reason: String,
    },
    /// It has ended, and nobody can tell whether it was reached: something in it must not be done
    /// twice, and whether it was done is not known (decision 11).
    GoalUnknown {
        /// In words.
        reason: String,
    },
    /// There is no plan at present; it waits for one of these facts.
    GoalBlocked {
        /// What would have to hold.
        blocked_by: Vec<Fact>,
    },
    /// A plan was chosen.
    PlanSelected {
        /// First action first.
        steps: Vec<Action>,
        /// In the domain's unit.
        cost: Cost,
        /// Costs of the plans that were kept beside it.
        alternatives: Vec<Cost>,
        /// In words.
        why: String,
        /// Nodes that the planner expanded until it knew the plan; looking for others to keep beside
        /// it is not counted.
        expanded: u64,
    },
    /// A kept or followed plan no longer fits the belief.
    PlanRevised {
        /// In words.
        why: String,
        /// What is left of the plans that were kept.
        kept: usize,
    },
    /// Actions of several goals were chosen to be done together.
    ActionsCombined {
        /// Which, the oldest goal's first.
        actions: Vec<Action>,
        /// What is executed meanwhile.
        beside: Vec<Action>,
        /// Which of them wait for the end of which others.
        after: Vec<(Action, Vec<Action>)>,
        /// What is saved against one after the other, in seconds.
        saving_s: f64,
        /// In words.
        why: String,
    },
    /// An action has failed, and the nearest task above it that can be done otherwise is decomposed
    /// anew; what was done before that task and what follows it stays as it is.
    TaskRepaired {
        /// Which.
        task: Task,
        /// How far it is above the action that has failed: one for the task that it was a part of.
        levels: usize,
        /// That action.
        failed: Action,
    },
    /// An executor was told to begin.
    ActionStarted {
        /// Which execution.
        id: ActionId,
        /// What.
        action: Action,
    },
    /// The executor has told its motors to stop: from then on a robot brakes, or falls silent.
    ActionStopping {
        /// Which execution.
        id: ActionId,
        /// What.
        action: Action,
    },
    /// The executor has stopped.
    ActionSuspended {
        /// Which execution.
        id: ActionId,
        /// What.
        action: Action,
    },
    /// The executor was told to take up its record.
    ActionResumed {
        /// Which execution.
        id: ActionId,
        /// What.
        action: Action,
    },
    /// A half-done action was undone.
    ActionRolledBack {
        /// The execution that undid it.
        id: ActionId,
        /// The rollback action.
        action: Action,
    },
    /// It ended.
    ActionFinished {
        /// Which execution.
        id: ActionId,
        /// What.
        action: Action,
        /// Why not, if it failed.
        failure: Option<String>,
    },
    /// The executor was told to drop a record, or a superior has had the goal itself dropped: then
    /// the execution is the superior's.
    RecordCleared {
        /// Which execution.
        id: ActionId,
        /// What.
        action: Action,
    },
    /// A superior or an executor is gone: its process has died, is frozen, or cannot be reached.
    NeighbourLost {
        /// Who.
        name: Symbol,
    },
    /// It is there again.
    NeighbourBack {
        /// Who.
        name: Symbol,
    },
    /// A task was published: somebody is wanted who does it.
    TaskOffered {
        /// What is to be done.
        what: Task,
        /// Normal or emergency.
        urgency: Urgency,
    },
    /// A task was given to somebody.
    TaskGiven {
        /// What is to be done.
        what: Task,
        /// Whom.
        to: Symbol,
    },
    /// A task that was published is over.
    TaskEnded {
        /// What was to be done.
        what: Task,
        /// Who has done it; `None` if it was not done, or needed no doing.
        by: Option<Symbol>,
        /// Why not, if it failed.
        failure: Option<String>,
    },
    /// A vehicle is gone.
    VehicleLost {
        /// Who.
        name: Symbol,
        /// What it had with it, as far as it has said so.
        held: Vec<Fact>,
        /// What it had to do, as far as was heard.
        tasks: Vec<Task>,
    },
    /// Another vehicle has seen how things are.
    FactsTold {
        /// Who.
        by: Symbol,
        /// What is so.
        changes: Vec<FactChange>,
    },
    /// The belief is different.
    BeliefChanged {
        /// How.
        changes: Vec<FactChange>,
    },
}
