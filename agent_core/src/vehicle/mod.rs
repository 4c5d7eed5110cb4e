//! A vehicle: an agent that shares tasks and facts with others of its team.
//!
//! One machine, made of the agent that plans and acts ([`Mind`]), the
//! [`TaskService`] and the [`StateService`].
//! What the vehicles say to each other comes and goes as [`Message`]s; a task that one of them gets is
//! an instruction of the one that has published it, and becomes a goal of its own.

mod arise;
mod assess;
mod goals;
mod machine;
mod memory;
mod mind;
mod state;
mod stuck;
mod tasks;

pub use mind::Mind;

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;

use crate::agent::Configuration;
use crate::model::{Domain, ExecutionModel, Fact, Map, Pattern, Symbol, Task, Time};
use crate::planner::{Arisen, Planner, Problem};
use crate::protocol::{ActionId, Event, GoalId, Happening, Ledger, Output};
use crate::service::{Message, Outcome, StateService, TaskId, TaskService, Times};
use assess::Assessments;

/// What a vehicle is beside its agent.
#[derive(Clone, Debug, Default)]
pub struct Equipment {
    /// By predicate: the task that finds out such a fact. Variables are the predicate's parameters.
    pub provides: BTreeMap<Symbol, Pattern>,
    /// How long the vehicles wait for each other.
    pub times: Times,
}

/// A goal of a user's that was published as a task and is over.
#[derive(Clone, Debug, PartialEq)]
pub struct EndedTask {
    /// Its name.
    pub id: TaskId,
    /// What was to be done.
    pub what: Task,
    /// How it has ended.
    pub outcome: Outcome,
    /// When.
    pub at: Time,
}

/// A vehicle of a team.
#[derive(Clone, Debug)]
pub struct Vehicle<A, P> {
    name: Symbol,
    /// Who executes what the agent does.
    executors: BTreeSet<Symbol>,
    mind: A,
    tasks: TaskService,
    states: StateService,
    assessments: Assessments<P>,
    domain: Arc<Domain>,
    model: Arc<ExecutionModel>,
    map: Arc<Map>,
    equipment: Equipment,
    /// What was to be done by the rules for what comes up, when that was looked at last.
    arisen: BTreeSet<Arisen>,
    /// Rules for what comes up that no other vehicle could see to: they are about the own body, too.
    own_rules: BTreeSet<usize>,
    /// Tasks that were published since a user wants them done.
    for_users: BTreeSet<TaskId>,
    ended: VecDeque<EndedTask>,
    /// Tasks that were given to us and that we cannot go on with, and since when.
    stuck: BTreeMap<ActionId, Time>,
    /// When a task that finds out something was begun last.
    found_out: BTreeMap<Task, Time>,
    now: Time,
    /// What comes in now was told, not seen.
    learning: bool,
    believes_otherwise: bool,
    outputs: VecDeque<Output<Message>>,
    ledger: Ledger,
}

impl<A: Mind, P: Planner> Vehicle<A, P> {
    /// A vehicle with the agent `mind`, which was made with that configuration. `planner` is for
    /// finding out what tasks would cost that others offer.
    pub fn new(configuration: &Configuration, equipment: Equipment, mind: A, planner: P) -> Self {
        let name = configuration.name.clone();
        let model = configuration.model.clone();
        let mut map = configuration.map.clone();
        map.take_changing(&model.observable);
        let tasks = TaskService::new(name.clone(), configuration.epoch, equipment.times);
        let states = StateService::new(
            name.clone(),
            equipment.times.beat,
            model.shared.iter().cloned(),
            model.asked.iter().cloned(),
        );
        let mut vehicle = Self {
            name,
            executors: configuration.executors.all().into_iter().collect(),
            mind,
            tasks,
            states,
            assessments: Assessments::new(planner),
            domain: configuration.domain.clone(),
            model,
            map: Arc::new(map),
            equipment,
            arisen: BTreeSet::new(),
            own_rules: BTreeSet::new(),
            for_users: BTreeSet::new(),
            ended: VecDeque::new(),
            stuck: BTreeMap::new(),
            found_out: BTreeMap::new(),
            now: Time::ZERO,
            learning: false,
            believes_otherwise: false,
            outputs: VecDeque::new(),
            ledger: Ledger::default(),
        };
        vehicle.own_rules = arise::own_rules(&vehicle.domain, &vehicle.model);
        vehicle.arisen = crate::planner::arising(&vehicle.problem());
        vehicle
    }

    /// Its name.
    pub fn name(&self) -> &Symbol {
        &self.name
    }

    /// The agent that plans and acts.
    pub fn mind(&self) -> &A {
        &self.mind
    }

    /// Who does what.
    pub fn tasks(&self) -> &TaskService {
        &self.tasks
    }

    /// What all know.
    pub fn states(&self) -> &StateService {
        &self.states
    }

    /// Goals of users that were published as tasks and are over, the latest last, as far as they are
    /// remembered.
    pub fn ended(&self) -> impl DoubleEndedIterator<Item = &EndedTask> {
        self.ended.iter()
    }

    /// Tasks that were published since a user wants them done.
    pub fn for_users(&self) -> &BTreeSet<TaskId> {
        &self.for_users
    }

    /// What is planned from.
    fn problem(&self) -> Problem {
        Problem {
            domain: self.domain.clone(),
            model: self.model.clone(),
            map: self.map.clone(),
            belief: Arc::new(self.mind.belief().clone()),
            forbidden: BTreeSet::new(),
        }
    }

    fn emit(&mut self, goal: Option<GoalId>, what: Happening) {
        self.outputs.push_back(Output::Event(Event {
            at: self.now,
            goal,
            stack_depth: 0,
            what,
        }));
    }

    /// What has to be known to go on: what the agent's goals want, and what is lacking to tell whether
    /// a task can be done.
    fn needs(&self) -> BTreeSet<Fact> {
        let wanted = self.mind.wanted();
        let wanted = wanted
            .into_iter()
            .filter(|fact| self.states.is_unknown(fact));
        wanted.chain(self.assessments.lacking()).collect()
    }
}
