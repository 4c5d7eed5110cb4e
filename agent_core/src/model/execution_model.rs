//! What HDDL cannot say of an action: how long it takes, and how it is suspended and resumed.

use std::collections::BTreeMap;

use super::{Clause, Condition, Effect, Number, Parameter, Pattern, Symbol};

/// The side file of a domain, by name of action and task.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ExecutionModel {
    /// An action that has no entry takes no known time, cannot be suspended and may be repeated.
    pub actions: BTreeMap<Symbol, ActionModel>,
    /// A task without an entry is estimated at nothing.
    pub tasks: BTreeMap<Symbol, TaskModel>,
    /// Predicates that change without any action of this agent: a door that someone closes. A plan
    /// that fails for want of such a fact waits for it.
    pub observable: Vec<Symbol>,
    /// How facts of this level look one level up.
    pub projections: Vec<Projection>,
    /// Predicates about what all vehicles of a team share: a change is told to the others. All other
    /// facts are an agent's own, such as where it is.
    pub shared: Vec<Symbol>,
    /// Predicates of which what nobody has told is unknown, not false: whoever needs such a fact
    /// asks for it.
    pub asked: Vec<Symbol>,
    /// Tasks that come up by themselves when something becomes so.
    pub arising: Vec<Arising>,
}

/// What an action is to whoever executes it. Variables are the operator's parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct ActionModel {
    /// How long it takes if nothing is in the way, in seconds.
    pub duration_s: Option<Number>,
    /// After how long it is stopped and counts as failed, in seconds.
    pub timeout_s: Option<Number>,
    /// Whether it may be done again when nobody knows if it was done (`repeatable`), or not
    /// (`once`: an explanation that was given is not given again).
    pub repeatable: bool,
    /// Whether its point is the state it leads to, as with a move: then an emergency that happens
    /// to do it has done it for every suspended plan that begins with it.
    pub achieves_state: bool,
    /// What must hold as long as it runs.
    pub protected: Vec<Clause>,
    /// What must be confirmed by sensors before it counts as done, within its time-out. Empty: the
    /// executor's word is enough.
    pub goal_states: Vec<Clause>,
    /// What it needs for itself alone as long as it runs, such as `arm` or `base`, for agents that do
    /// several things at once.
    pub resources: Vec<Symbol>,
    /// How it is suspended. `None`: it cannot be, and runs to its end.
    pub suspension: Option<Suspension>,
    /// What the robot is to do, in the executor's own words: `(drive ?arc ?to)`. Only for actions
    /// that a robot executes and no child agent.
    pub perform: Option<Pattern>,
    /// The parameter that names the place whose map the executor needs.
    pub map_of: Option<usize>,
    /// What it costs, where that depends on more than its arguments. The first rule that matches
    /// counts; if none does, the operator's own cost.
    pub costs: Vec<CostRule>,
}

impl Default for ActionModel {
    fn default() -> Self {
        Self {
            duration_s: None,
            timeout_s: None,
            repeatable: true,
            achieves_state: false,
            protected: Vec::new(),
            goal_states: Vec::new(),
            resources: Vec::new(),
            suspension: None,
            perform: None,
            map_of: None,
            costs: Vec::new(),
        }
    }
}

/// What an action costs in some states: a rough plan names areas, but how far it is through an area
/// depends on where the robot has come in.
#[derive(Clone, Debug, PartialEq)]
pub struct CostRule {
    /// The action's parameters, then the variables that `given` binds.
    pub parameters: Vec<Parameter>,
    /// Evaluated in the state before the action.
    pub given: Condition,
    /// The cost; of several matches the least.
    pub cost: Number,
}

/// How an action is suspended, and what may follow (the paper, section 4).
#[derive(Clone, Debug, PartialEq)]
pub struct Suspension {
    /// What is different once the executor has stopped.
    pub effect: Effect,
    /// The action that ends where the suspended one would have ended.
    pub resume: Pattern,
    /// The action that undoes what was half done, if there is one.
    pub rollback: Option<Pattern>,
    /// The task that reaches the place from where the action can be resumed, for a robot that was
    /// led away meanwhile.
    pub reach: Option<Pattern>,
}

/// A lower bound of what a task costs, to search the likely plans first.
///
/// `given` binds variables from the present state; `establishes` is what the task leaves true, so
/// that the estimate of the next task starts from there.
#[derive(Clone, Debug, PartialEq)]
pub struct TaskModel {
    /// The task's parameters, then the variables that `given` binds.
    pub parameters: Vec<Parameter>,
    /// Evaluated in the state before the task. If nothing matches, the estimate is zero.
    pub given: Condition,
    /// Never more than the task really costs.
    pub estimate: Number,
    /// What holds after the task; other facts of the same predicates no longer do.
    pub establishes: Vec<Pattern>,
}

/// `then` holds one level up wherever `when` holds here.
#[derive(Clone, Debug, PartialEq)]
pub struct Projection {
    /// The variables of the rule; `object` as type means any.
    pub parameters: Vec<Parameter>,
    /// In this level's words.
    pub when: Condition,
    /// In the words of the level above.
    pub then: Pattern,
}

/// A task that comes up whenever `when` becomes so: a guest has arrived and is to be shown to a table.
/// Once for each way in which it becomes so.
#[derive(Clone, Debug, PartialEq)]
pub struct Arising {
    /// The variables of the rule.
    pub parameters: Vec<Parameter>,
    /// In this level's words.
    pub when: Condition,
    /// What is to be done then.
    pub task: Pattern,
}
