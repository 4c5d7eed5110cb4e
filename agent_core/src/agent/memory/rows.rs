//! The form in which an agent is written down.
//!
//! These types are the journal's format, and nothing else is: changing one of them, or one of the
//! protocol's that they contain, needs a new format version of the journal. The values are not
//! self-describing: no field may be left out, renamed or moved.

use serde::{Deserialize, Serialize};

use crate::model::{Action, Fact, FactChange, Landmarks, Symbol, Task, Time};
use crate::protocol::{ActionId, GoalId, Report, Urgency};

/// `m/agent`: what goals there are and where, and what belongs to none of them. Goals go by their
/// numbers.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct AgentRow {
    pub next_action: u64,
    pub next_goal: u64,
    pub next_ended: u64,
    pub last_executor: Symbol,
    pub hold: Option<(Symbol, ActionId)>,
    pub map: Option<u64>,
    pub running: Option<u64>,
    /// Innermost last, and whether a superior holds it.
    pub stack: Vec<(u64, bool)>,
    pub waiting: Vec<u64>,
    /// With the facts that they wait for; none for those that wait for the user.
    pub aside: Vec<(u64, Option<Vec<Fact>>)>,
}

/// `m/told`: what superiors were last told, and the values that they have not been told.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct ToldRow {
    pub facts: Vec<Fact>,
    pub new_values: Vec<FactChange>,
}

/// `m/fact/…`: a fact that is believed otherwise than at the start.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct FactRow {
    pub fact: Fact,
    pub holds: bool,
}

/// `m/value/…`: a function that has another value than at the start.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct ValueRow {
    pub function: Fact,
    pub value: f64,
}

/// `m/map/…`: a map that came with an instruction.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct MapRow {
    pub objects: Vec<(Symbol, Symbol)>,
    pub facts: Vec<Fact>,
    pub values: Vec<(Fact, f64)>,
    pub landmarks: Vec<Landmarks>,
    pub news: Vec<FactChange>,
}

/// `m/ended/…`: a goal that is over.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct EndedRow {
    pub id: GoalId,
    pub tasks: Vec<Task>,
    pub superior: Option<(Symbol, ActionId)>,
    pub outcome: Report,
    pub at: Time,
}

/// `m/goal/…`: a goal that is not over, with all that is kept for it.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct GoalRow {
    pub number: u64,
    pub id: GoalId,
    pub tasks: Vec<Task>,
    pub urgency: Urgency,
    pub priority: i32,
    pub deadline: Option<Time>,
    pub superior: Option<(Symbol, ActionId)>,
    /// None: the agent's own.
    pub map: Option<u64>,
    pub started: bool,
    pub cancelled: Option<String>,
    pub orphaned: bool,
    pub fits: bool,
    pub blocked_by: Vec<Fact>,
    pub failures: Vec<(Action, u32)>,
    pub failed: Option<(Action, bool)>,
    pub last_failure: Option<String>,
    pub lost: Vec<ActionId>,
    pub done_once: Vec<u64>,
    pub network: NetworkRow,
    pub agendas: Vec<AgendaRow>,
    pub plans: Vec<PlanRow>,
    pub records: Vec<RecordRow>,
    pub running: Option<RunningRow>,
}

/// What is only known of the goal that is pursued.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct RunningRow {
    pub phase: PhaseRow,
    pub resumed: bool,
    pub set_aside: bool,
    pub broken: Option<String>,
    pub surprised: bool,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) enum PhaseRow {
    Planning,
    Executing(ExecutionRow),
    Stopping(ExecutionRow),
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct ExecutionRow {
    pub id: ActionId,
    pub executor: Symbol,
    pub step: StepRow,
    pub due: Option<Time>,
    pub done: Option<Vec<FactChange>>,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct RecordRow {
    pub id: ActionId,
    pub executor: Symbol,
    pub step: StepRow,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct AgendaRow {
    pub tasks: ListRow,
    pub origin: OriginRow,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) enum OriginRow {
    Goal,
    Tail,
    Again,
    Ancestor,
    Resume,
    Reach,
    RollBack,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct PlanRow {
    pub steps: Vec<StepRow>,
    pub rest: ListRow,
    pub cost: u64,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct StepRow {
    pub item: ItemRow,
    pub cost: u64,
    pub frame: FrameRow,
    pub rest: ListRow,
}

/// The place of a list's first cell in the network; none if the list is empty.
pub(super) type ListRow = Option<u32>;
/// The place of a frame in the network, if there is one.
pub(super) type FrameRow = Option<u32>;

/// The lists and frames of a goal, each once however often it is shared.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct NetworkRow {
    /// Names go by their places in here.
    pub names: Vec<Symbol>,
    /// Each is made of nodes before it, so there can be no circles.
    pub nodes: Vec<NodeRow>,
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) enum NodeRow {
    Cell {
        item: ItemRow,
        frame: FrameRow,
        rest: ListRow,
    },
    Frame {
        id: u64,
        task: ItemRow,
        rest: ListRow,
        parent: FrameRow,
    },
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) enum ItemRow {
    Task(AtomRow),
    Resume {
        id: ActionId,
        original: AtomRow,
        action: AtomRow,
    },
    RollBack {
        id: ActionId,
        action: AtomRow,
    },
}

/// A name and its arguments.
pub(super) type AtomRow = Vec<u32>;
