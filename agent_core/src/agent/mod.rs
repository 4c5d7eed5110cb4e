//! The agent: Algorithms 1 to 5 of the paper as one state machine without input or output.
//!
//! Each *wait till* of the paper is a state here, and its second thread is only another input. One
//! goal runs at a time. The same machine serves at every level.

mod accept;
mod alternatives;
mod aside;
mod check;
mod command;
mod configuration;
mod confirm;
mod emergency;
mod ended;
mod excerpts;
mod execution;
mod goal;
mod instruct;
mod intention;
mod leave;
mod memory;
mod monitor;
mod moving;
mod neighbour;
mod planning;
mod repair;
mod stack;
mod subplan;
mod suspension;
#[cfg(test)]
mod tests;
mod uncertain;
mod waiting;

pub use alternatives::{Against, Alternative, Alternatives, Choice, GoalPlace};
pub use aside::{GoalsAside, WaitsFor};
pub use configuration::{Configuration, Executors, MapsBelow, Policy};
pub use ended::Ended;
pub use goal::Goal;
pub use intention::{Intention, Record};
pub use leave::Proposal;
pub use repair::Repair;
pub use stack::{ResumedBy, SuspendedGoal, SuspendedGoalStack};
pub use waiting::WaitingGoals;

use std::collections::{BTreeMap, VecDeque};
use std::convert::Infallible;
use std::sync::Arc;

use crate::model::{Belief, Domain, FactChange, Map, Symbol, Task, Time};
use crate::planner::{Planner, Step};
use crate::protocol::{ActionId, GoalId, Happening, Input, Machine, Output, Reply};
use excerpts::Excerpts;
use leave::Ready;
use memory::Memory;
use neighbour::Neighbours;

/// How many goals one input may carry to an end before others are listened to.
const ROUNDS_PER_INPUT: usize = 8;

/// A planning agent.
///
/// Invariants ([`check`](Self::check) asserts them): a goal is in one place only, be it running,
/// suspended, waiting or aside; at most one action is being executed; every record belongs to one
/// intention; the planner thinks only for the running goal.
#[derive(Clone, Debug)]
pub struct Agent<P> {
    configuration: Configuration,
    planner: P,
    belief: Belief,
    /// The map that the running goal is pursued on, or the last one was.
    map: Arc<Map>,
    /// The map that it was made with.
    own_map: Arc<Map>,
    running: Option<Running>,
    stack: SuspendedGoalStack,
    waiting: WaitingGoals,
    aside: GoalsAside,
    ended: VecDeque<Ended>,
    next_ended: u64,
    /// A superior wants this goal, and what runs above it, suspended.
    hold: Option<(Symbol, ActionId)>,
    /// In words, why nothing is to run here at present, whatever the goals.
    paused: Option<String>,
    /// What superiors were last told, in their words.
    told: Belief,
    /// Values that executors have named since.
    new_values: Vec<FactChange>,
    last_executor: Symbol,
    next_action: u64,
    next_goal: u64,
    now: Time,
    outputs: VecDeque<Output<Infallible>>,
    /// There may be more to do than waiting.
    unsettled: bool,
    /// The belief has changed, and plans of goals that do not run were not looked at since.
    believes_otherwise: bool,
    excerpts: Excerpts,
    neighbours: Neighbours,
    /// It has been restarted, and nothing has come in since.
    restarted: bool,
    memory: Memory,
}

/// The goal that is pursued at present.
#[derive(Clone, Debug)]
struct Running {
    intention: Intention,
    phase: Phase,
    /// Taken from the stack or from aside, and not planned for since.
    resumed: bool,
    /// The user wants it set aside.
    set_aside: bool,
    /// In words, why the action must stop although the goal goes on.
    broken: Option<String>,
    /// Facts have changed that no action of ours was to change: plan again when this action ends.
    surprised: bool,
    /// How far planning is. Not written down: whoever plans again begins at the first stage.
    stage: repair::Reached,
}

/// What is being waited for.
#[derive(Clone, Debug)]
enum Phase {
    /// For the planner.
    Planning,
    /// For leave to go on ([`Policy::asks_leave`]).
    Ready(Ready),
    /// For the end of an action (Algorithm 2, step 7a).
    Executing(Execution),
    /// For an action to be suspended or to end (Algorithm 3, step 3c; Algorithm 5, step 4).
    Stopping(Execution),
}

/// An action that an executor was told to do.
#[derive(Clone, Debug, PartialEq)]
struct Execution {
    id: ActionId,
    executor: Symbol,
    step: Step,
    /// When it has taken too long.
    due: Option<Time>,
    /// The executor says that it is done, and sensors have not confirmed it yet: what was told with
    /// that word and since.
    done: Option<Vec<FactChange>>,
}

impl<P: Planner> Agent<P> {
    /// An agent that has nothing to do.
    pub fn new(mut configuration: Configuration, planner: P) -> Self {
        let mut map = std::mem::take(&mut configuration.map);
        let mut belief = Belief::default();
        belief.apply_all(&map.take_changing(&configuration.model.observable));
        belief.apply_all(&std::mem::take(&mut configuration.facts));
        let map = Arc::new(map);
        let mut agent = Self {
            last_executor: configuration.executors.default.clone(),
            configuration,
            planner,
            memory: Memory::new(belief.clone()),
            belief,
            own_map: map.clone(),
            map,
            running: None,
            stack: SuspendedGoalStack::default(),
            waiting: WaitingGoals::default(),
            aside: GoalsAside::default(),
            ended: VecDeque::new(),
            next_ended: 0,
            hold: None,
            paused: None,
            told: Belief::default(),
            new_values: Vec::new(),
            next_action: 1,
            next_goal: 1,
            now: Time::ZERO,
            outputs: VecDeque::new(),
            unsettled: false,
            believes_otherwise: false,
            excerpts: Excerpts::default(),
            neighbours: Neighbours::default(),
            restarted: false,
        };
        let problem = agent.problem();
        agent.told = crate::planner::project(&problem);
        agent.planner.prepare(&problem);
        agent
    }

    /// The same agent, which must have done nothing yet, for a start of that epoch: to start many
    /// alike, one is made and copied, as a planner reads its domain for longer than a copy takes.
    pub fn for_epoch(mut self, epoch: u64) -> Self {
        self.configuration.epoch = epoch;
        self
    }

    /// Its name.
    pub fn name(&self) -> &Symbol {
        &self.configuration.name
    }

    /// The domain of its level.
    pub fn domain(&self) -> &Domain {
        &self.configuration.domain
    }

    /// What it holds to be true.
    pub fn belief(&self) -> &Belief {
        &self.belief
    }

    /// What it plans with.
    pub fn planner(&self) -> &P {
        &self.planner
    }

    /// The suspended goals.
    pub fn stack(&self) -> &SuspendedGoalStack {
        &self.stack
    }

    /// The goals that wait for their turn.
    pub fn waiting(&self) -> &WaitingGoals {
        &self.waiting
    }

    /// The goals that wait for something else.
    pub fn aside(&self) -> &GoalsAside {
        &self.aside
    }

    /// The goal that is pursued at present.
    pub fn running(&self) -> Option<&Intention> {
        self.running.as_ref().map(|running| &running.intention)
    }

    /// The action that is being executed, and whether it is to stop.
    pub fn executing(&self) -> Option<(&ActionId, &Task, bool)> {
        match &self.running.as_ref()?.phase {
            Phase::Planning | Phase::Ready(_) => None,
            Phase::Executing(execution) => Some((&execution.id, execution.step.action(), false)),
            Phase::Stopping(execution) => Some((&execution.id, execution.step.action(), true)),
        }
    }

    /// Brings the machine to rest: starts, stops and resumes goals until there is only waiting.
    fn settle(&mut self) {
        self.unsettled = false;
        for _ in 0..ROUNDS_PER_INPUT {
            while self.start_next() {}
            let Some(running) = &self.running else {
                return;
            };
            match running.phase {
                Phase::Stopping(_) => return,
                Phase::Executing(_) => {
                    if self.takes_the_executors_word() {
                        continue;
                    }
                    self.stop_if_due();
                    return;
                }
                Phase::Ready(_) => {
                    if !self.yields_now() || self.is_paused() {
                        return;
                    }
                }
                Phase::Planning => {
                    if self.yields_now() {
                        if self.is_paused() {
                            return;
                        }
                        continue;
                    }
                    if !self.planner.is_thinking() {
                        self.plan();
                    }
                    if self.continues() {
                        continue;
                    }
                    let slice = self.configuration.policy.expansions_per_slice;
                    let Some(outcome) = self.planner.think(slice) else {
                        return;
                    };
                    self.planned(outcome);
                }
            }
        }
        self.unsettled = true;
    }

    fn emit(&mut self, goal: Option<&GoalId>, what: Happening) {
        self.outputs
            .push_back(Output::Event(crate::protocol::Event {
                at: self.now,
                goal: goal.cloned(),
                stack_depth: self.stack.depth(),
                what,
            }));
    }

    fn all_intentions(&self) -> impl Iterator<Item = &Intention> {
        let running = self.running.iter().map(|running| &running.intention);
        let stacked = self.stack.entries().iter().map(|entry| &entry.intention);
        let aside = self.aside.goals().iter().map(|(intention, _)| intention);
        running
            .chain(stacked)
            .chain(aside)
            .chain(self.waiting.intentions())
    }

    /// Counts of goals by where they are: running, suspended, waiting, aside.
    pub fn counts(&self) -> BTreeMap<&'static str, usize> {
        BTreeMap::from([
            ("running", usize::from(self.running.is_some())),
            ("suspended", self.stack.depth()),
            ("waiting", self.waiting.intentions().len()),
            ("aside", self.aside.goals().len()),
        ])
    }
}

impl<P: Planner> Machine for Agent<P> {
    type In = Infallible;
    type Out = Infallible;

    fn handle(&mut self, now: Time, input: Input<Infallible>) -> Option<Reply> {
        self.now = self.now.max(now);
        self.forget_ended();
        if std::mem::take(&mut self.restarted) {
            self.time_action();
        }
        let reply = match input {
            Input::Goal(request) => Some(Reply::Goal(self.accept(request))),
            Input::Command(command) => Some(Reply::Command(self.command(&command))),
            Input::Instruction { from, instruction } => {
                Some(Reply::Instruction(self.instructed(&from, instruction)))
            }
            Input::Answer { to, answer } => {
                self.answered(&to, answer);
                None
            }
            Input::Report { id, report } => {
                self.reported(&id, report);
                None
            }
            Input::Observation(facts) => {
                self.observed(&facts);
                None
            }
            Input::Neighbour { name, there } => {
                self.neighbour(name, there);
                None
            }
            Input::Reborn { name } => {
                self.reborn(&name);
                None
            }
            Input::Wake => None,
            Input::Local(never) => match never {},
        };
        self.watch_the_clock();
        self.settle();
        if std::mem::take(&mut self.believes_otherwise) {
            self.review_plans();
        }
        reply
    }

    fn poll_output(&mut self) -> Option<Output<Infallible>> {
        self.outputs.pop_front()
    }

    fn wake_at(&self) -> Option<Time> {
        if self.unsettled || self.planner.is_thinking() {
            return Some(Time::ZERO);
        }
        // A goal that is being cancelled has no deadline any more.
        let pursued = self.all_intentions().filter(|i| i.cancelled.is_none());
        let deadlines = pursued.filter_map(|i| i.goal.deadline);
        let due = self.running.as_ref().and_then(Running::due);
        deadlines.chain(due).min()
    }
}
