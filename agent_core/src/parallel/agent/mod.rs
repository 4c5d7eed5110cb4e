//! An agent that works on several goals at once, composed of ordinary ones.
//!
//! One ordinary agent for each goal that is worked on (a *branch*), one for emergencies (the *foremost*),
//! and one that never starts anything and keeps the goals that wait (the *list*). All of them have the
//! same configuration and believe the same: what one learns the others observe. A branch asks leave
//! before each action; which actions get it is decided layer by layer. While there is an emergency the
//! branches rest: what they were doing is suspended, resumed and rolled back by the machinery that
//! every agent has.

mod check;
mod inputs;
mod layers;
mod memory;
#[cfg(test)]
mod tests;
mod turns;

use std::collections::{BTreeMap, VecDeque};
use std::convert::Infallible;
use std::num::NonZeroUsize;

use super::Footprint;
use crate::agent::{Agent, Configuration, Ended, Intention, Proposal, WaitsFor};
use crate::model::{Action, Belief, Domain, Fact, Symbol, Time};
use crate::planner::Planner;
use crate::protocol::{Event, GoalId, Happening, Input, Ledger, Machine, Output, Reply};

/// How often one input may have goals begin or end before others are listened to.
const ROUNDS_PER_INPUT: usize = 16;

/// An agent that works on several goals at once.
///
/// Invariants ([`check`](Self::check) asserts them): all its agents believe the same; a goal is with one
/// of them only; each branch has one goal at most; no two actions that are executed at the same time
/// need the same resource; while the foremost agent runs something, no branch does.
#[derive(Clone, Debug)]
pub struct ParallelAgent<P> {
    name: Symbol,
    together: NonZeroUsize,
    list: Agent<P>,
    foremost: Agent<P>,
    branches: Vec<Agent<P>>,
    /// What each branch executes.
    underway: BTreeMap<usize, Begun>,
    /// What was done in the layer that was executed last.
    executed: Vec<(u64, Footprint)>,
    /// How often in a row each branch was left out.
    left_out: BTreeMap<usize, u32>,
    /// Counts layers.
    layer: u64,
    /// The state of things in which the last layer was chosen, and nothing came of it.
    considered: Option<Standing>,
    now: Time,
    outputs: VecDeque<Output<Infallible>>,
    /// There may be more to do than waiting.
    unsettled: bool,
    /// It has been restarted, and nothing has come in since.
    restarted: bool,
    ledger: Ledger,
}

/// An action that a branch executes.
#[derive(Clone, Debug)]
struct Begun {
    footprint: Footprint,
    at: Time,
    /// Which layer it belongs to.
    layer: u64,
}

/// All that the choice of a layer depends on.
#[derive(Clone, Debug, Eq, PartialEq)]
struct Standing {
    belief: u64,
    branches: Vec<(u8, Option<Action>)>,
}

/// One of the agents that a parallel agent is composed of.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
enum Who {
    List,
    Foremost,
    Branch(usize),
}

impl<P: Planner + Clone> ParallelAgent<P> {
    /// An agent that works on up to `together` goals at once; one after another, as the interruption
    /// paper's waiting list has it, if that is one.
    pub fn new(configuration: Configuration, together: NonZeroUsize, planner: P) -> Self {
        let name = configuration.name.clone();
        let one = Agent::new(configuration, planner);
        let mut parallel = Self {
            list: one.clone().named(format!("{name}.w").into(), false),
            foremost: one.clone().named(format!("{name}.e").into(), false),
            branches: Vec::new(),
            name,
            together,
            underway: BTreeMap::new(),
            executed: Vec::new(),
            left_out: BTreeMap::new(),
            layer: 0,
            considered: None,
            now: Time::ZERO,
            outputs: VecDeque::new(),
            unsettled: false,
            restarted: false,
            ledger: Ledger::default(),
        };
        for slot in 0..together.get() {
            let branch = one.clone().named(parallel.branch_name(slot), true);
            parallel.branches.push(branch);
        }
        parallel
            .list
            .was_paused(Some("it keeps the goals that wait"));
        parallel.foremost.was_paused(Some("there is no emergency"));
        parallel
    }

    /// The same agent, which must have done nothing yet, for a start of that epoch.
    pub fn for_epoch(mut self, epoch: u64) -> Self {
        self.list = self.list.for_epoch(epoch);
        self.foremost = self.foremost.for_epoch(epoch);
        let branches = self.branches.into_iter();
        self.branches = branches.map(|it| it.for_epoch(epoch)).collect();
        self
    }
}

impl<P: Planner> ParallelAgent<P> {
    /// Its name.
    pub fn name(&self) -> &Symbol {
        &self.name
    }

    /// How many goals it works on at once.
    pub fn together(&self) -> NonZeroUsize {
        self.together
    }

    /// The domain of its level.
    pub fn domain(&self) -> &Domain {
        self.list.domain()
    }

    /// What it holds to be true.
    pub fn belief(&self) -> &Belief {
        self.list.belief()
    }

    /// The agents that work on a goal each, or on none.
    pub fn branches(&self) -> &[Agent<P>] {
        &self.branches
    }

    /// The agent for emergencies.
    pub fn foremost(&self) -> &Agent<P> {
        &self.foremost
    }

    /// The agent that starts nothing: goals that wait for their turn, for a fact or for the user are
    /// here.
    pub fn list(&self) -> &Agent<P> {
        &self.list
    }

    /// All agents that it is composed of: the foremost, the branches, the list.
    pub fn agents(&self) -> impl Iterator<Item = &Agent<P>> {
        std::iter::once(&self.foremost)
            .chain(&self.branches)
            .chain([&self.list])
    }

    /// All goals that are not over.
    pub fn intentions(&self) -> impl Iterator<Item = &Intention> {
        self.agents().flat_map(Agent::goals)
    }

    /// A goal that is over, by its name; `None` if it is not, was forgotten or never was.
    pub fn ended_goal(&self, id: &GoalId) -> Option<&Ended> {
        self.agents().find_map(|agent| agent.ended_goal(id))
    }

    /// Goals for which there is no plan at present, and the facts that would help: those that are
    /// blocked, and those that wait for what other branches do.
    pub fn wanted(&self) -> Vec<(GoalId, Vec<Fact>)> {
        let mut wanted = Vec::new();
        for agent in self.agents() {
            if let (Some(running), Some(Proposal::NoPlan(facts))) =
                (agent.running(), agent.proposal())
            {
                wanted.push((running.goal.id.clone(), facts.to_vec()));
            }
            for (intention, waits_for) in agent.aside().goals() {
                if let WaitsFor::Facts(facts) = waits_for {
                    let facts = facts.iter().cloned().collect();
                    wanted.push((intention.goal.id.clone(), facts));
                }
            }
        }
        wanted
    }

    fn branch_name(&self, slot: usize) -> Symbol {
        format!("{}.{slot}", self.name).into()
    }

    fn everybody(&self) -> Vec<Who> {
        let branches = (0..self.branches.len()).map(Who::Branch);
        [Who::List, Who::Foremost]
            .into_iter()
            .chain(branches)
            .collect()
    }

    fn agent(&self, who: Who) -> Option<&Agent<P>> {
        match who {
            Who::List => Some(&self.list),
            Who::Foremost => Some(&self.foremost),
            Who::Branch(slot) => self.branches.get(slot),
        }
    }

    fn agent_mut(&mut self, who: Who) -> Option<&mut Agent<P>> {
        match who {
            Who::List => Some(&mut self.list),
            Who::Foremost => Some(&mut self.foremost),
            Who::Branch(slot) => self.branches.get_mut(slot),
        }
    }

    fn emit(&mut self, what: Happening) {
        let depths = self.agents().map(|agent| agent.stack().depth());
        let event = Event {
            at: self.now,
            goal: None,
            stack_depth: depths.sum(),
            what,
        };
        self.outputs.push_back(Output::Event(event));
    }
}

impl<P: Planner> Machine for ParallelAgent<P> {
    type In = Infallible;
    type Out = Infallible;

    fn handle(&mut self, now: Time, input: Input<Infallible>) -> Option<Reply> {
        self.now = self.now.max(now);
        if std::mem::take(&mut self.restarted) {
            self.tell_all(&Input::Wake);
        }
        let reply = self.dispatch(input);
        self.take_turns();
        reply
    }

    fn poll_output(&mut self) -> Option<Output<Infallible>> {
        self.outputs.pop_front()
    }

    fn wake_at(&self) -> Option<Time> {
        if self.unsettled {
            return Some(Time::ZERO);
        }
        self.agents().filter_map(Agent::wake_at).min()
    }
}
