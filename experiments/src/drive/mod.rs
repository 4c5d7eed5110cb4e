//! A whole robot, parent, child and simulated mover, in virtual time: one clock, and messages that
//! take a millisecond. What its agents do is the code of the product; only waiting is left out.

mod interruption;
mod metered;

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::sync::Arc;
use std::time::{Duration, Instant};

use agent_core::agent::Agent;
use agent_core::language::parse_tasks;
use agent_core::model::{Action, FactChange, Symbol, Time};
use agent_core::planner::{AnyPlanner, PlannerKind, Settings};
use agent_core::protocol::{
    ActionId, Answer, GoalRequest, Input, Instruction, Machine, Output, Reply, Report, Urgency,
};
use executor_sim::{Faults, Floor, MoverSpec, Place as Stand, SimulatedRobot};
use maps::{Level, Site};
use nix::sys::resource::{UsageWho, getrusage};

use crate::ExperimentError;
pub(crate) use interruption::{Sample, Situation, Spent, interrupt};
pub(crate) use metered::Meter;
use metered::Metered;

const CHILD: &str = "child";
const EXECUTOR: &str = "executor";
/// What a message takes.
const ON_THE_WAY: Time = Time(1_000);
/// Nothing that is measured here takes longer, in virtual time.
const AT_MOST: Time = Time(24 * 3_600_000_000);

/// Who takes part.
#[derive(Clone, Copy, Debug, Eq, PartialEq, Ord, PartialOrd)]
pub(crate) enum Who {
    /// The area level.
    Parent,
    /// The node level.
    Child,
    /// Controller and world.
    Robot,
}

/// A place to drive about in, read once.
#[derive(Clone, Debug)]
pub(crate) struct Ground {
    pub site: Arc<Site>,
    pub area: Level,
    pub node: Level,
    floor: Floor,
}

impl Ground {
    /// The museum's levels on a map.
    pub fn new(site: Arc<Site>) -> Result<Self, ExperimentError> {
        let place = maps::Place::museum();
        Ok(Self {
            floor: Floor::try_from(&*site).map_err(ExperimentError::setup)?,
            area: place.area().clone(),
            node: place.node().clone(),
            site,
        })
    }

    /// The museum of the paper.
    pub fn museum() -> Result<Self, ExperimentError> {
        Self::new(maps::Place::museum().site().clone())
    }

    /// After so long on a passage the robot is well on it, and far from its end.
    pub fn half_way(&self, passage: &str) -> Option<Time> {
        let length_m = self.site.passage(passage)?.length_m();
        let seconds = length_m / MoverSpec::default().max_speed_m_s;
        Some(Time::from_secs(seconds / 2.0))
    }

    /// How long the passages are that actions lead along.
    pub fn length_m(&self, actions: &[Action]) -> f64 {
        let passages = actions.iter().flat_map(|action| &action.args);
        let passages = passages.filter_map(|arg| self.site.passage(arg.as_str()));
        passages.map(maps::Passage::length_m).sum()
    }
}

/// What an agent was given, and what came of it.
#[derive(Debug)]
pub(crate) struct Call<'a> {
    pub who: Who,
    pub input: &'a Input<Infallible>,
    /// What it said, in order, and how long after it was given the input.
    pub outputs: &'a [(Duration, Output<Infallible>)],
    /// Until it had nothing more to say.
    pub spent: Duration,
    /// What its planner did of that.
    pub planning: Meter,
    /// Whether something else was given the processor meanwhile, so that the clock says nothing.
    pub is_disturbed: bool,
}

/// Sees every call of an agent.
pub(crate) trait Observer {
    fn call(&mut self, call: &Call<'_>);
}

#[derive(Clone, Debug)]
enum Message {
    Instruction(Instruction),
    Answer(Instruction, Answer),
    Report(ActionId, Report),
    Facts(Vec<FactChange>),
}

/// A robot with its agents.
#[derive(Clone, Debug)]
pub(crate) struct Drive {
    pub now: Time,
    parent: Agent<Metered>,
    child: Agent<Metered>,
    robot: SimulatedRobot,
    on_the_way: BTreeMap<(Time, u64), (Who, Who, Message)>,
    sent: u64,
}

impl Drive {
    /// A robot that stands at a node and has nothing to do.
    pub fn new(ground: &Ground, start: &str, kind: PlannerKind) -> Result<Self, ExperimentError> {
        let planner = || Metered::new(AnyPlanner::new(kind, Settings::default()));
        let mut parent = parent_agent::configuration(
            &ground.site,
            &ground.area,
            start,
            CHILD,
            BTreeMap::new(),
            1,
        )
        .map_err(ExperimentError::setup)?;
        let mut child =
            child_agent::configuration(&ground.site, &ground.node, start, EXECUTOR, CHILD, 1)
                .map_err(ExperimentError::setup)?;
        // As in the paper: decision 8 is off.
        parent.policy.keep_what_helps = false;
        child.policy.keep_what_helps = false;
        let robot = SimulatedRobot::new(
            &ground.node.domain,
            &ground.node.model,
            ground.floor.clone(),
            MoverSpec::default(),
            Stand::at(start),
            Faults::none(),
        )
        .map_err(ExperimentError::setup)?;
        Ok(Self {
            now: Time::ZERO,
            parent: Agent::new(parent, planner()),
            child: Agent::new(child, planner()),
            robot,
            on_the_way: BTreeMap::new(),
            sent: 0,
        })
    }

    /// A user's goal for the parent.
    pub fn ask(
        &mut self,
        name: &str,
        task: &str,
        urgency: Urgency,
        observer: &mut dyn Observer,
    ) -> Result<(), ExperimentError> {
        let tasks = parse_tasks(task).map_err(|_| ExperimentError::course(name, "is no task"))?;
        let request = GoalRequest {
            id: Some(name.into()),
            tasks,
            urgency,
            priority: 0,
            deadline: None,
        };
        match self.tell(Who::Parent, Input::Goal(request), observer) {
            Some(Reply::Goal(Ok(_))) => Ok(()),
            other => Err(ExperimentError::course(
                name,
                format_args!("is not accepted: {other:?}"),
            )),
        }
    }

    /// Something changes, and everybody sees it at once.
    pub fn change(&mut self, change: &FactChange, observer: &mut dyn Observer) {
        for who in [Who::Robot, Who::Child, Who::Parent] {
            self.tell(who, Input::Observation(vec![change.clone()]), observer);
        }
    }

    /// Lets the next thing happen, if there is one.
    pub fn step(&mut self, observer: &mut dyn Observer) -> bool {
        self.step_until(AT_MOST, observer)
    }

    /// Lets time pass until then.
    pub fn run_until(&mut self, until: Time, observer: &mut dyn Observer) {
        while self.step_until(until, observer) {}
        self.now = self.now.max(until);
    }

    fn step_until(&mut self, until: Time, observer: &mut dyn Observer) -> bool {
        let wake = [
            (self.parent.wake_at(), Who::Parent),
            (self.child.wake_at(), Who::Child),
            (self.robot.wake_at(), Who::Robot),
        ];
        let wake = wake.into_iter().filter_map(|(at, who)| Some((at?, who)));
        let wake = wake.min().map(|(at, who)| (at.max(self.now), who));
        let message = self.on_the_way.keys().next().map(|(at, _)| *at);
        let Some(next) = wake.map(|(at, _)| at).into_iter().chain(message).min() else {
            return false;
        };
        if next > until {
            return false;
        }
        self.now = next;
        if message == Some(next)
            && let Some((_, (from, to, what))) = self.on_the_way.pop_first()
        {
            self.deliver(from, to, what, observer);
        } else if let Some((_, who)) = wake {
            self.tell(who, Input::Wake, observer);
        }
        true
    }

    fn deliver(&mut self, from: Who, to: Who, what: Message, observer: &mut dyn Observer) {
        let input = match what {
            Message::Instruction(instruction) => Input::Instruction {
                from: name(from),
                instruction,
            },
            Message::Answer(to, answer) => Input::Answer { to, answer },
            Message::Report(id, report) => Input::Report { id, report },
            Message::Facts(facts) => Input::Observation(facts),
        };
        let instruction = match &input {
            Input::Instruction { instruction, .. } => Some(instruction.clone()),
            _ => None,
        };
        let reply = self.tell(to, input, observer);
        if let (Some(instruction), Some(Reply::Instruction(answer))) = (instruction, reply) {
            self.send(to, from, Message::Answer(instruction, answer));
        }
    }

    fn tell(
        &mut self,
        who: Who,
        input: Input<Infallible>,
        observer: &mut dyn Observer,
    ) -> Option<Reply> {
        let now = self.now;
        let (reply, outputs) = match who {
            Who::Parent => call(who, &mut self.parent, now, input, observer),
            Who::Child => call(who, &mut self.child, now, input, observer),
            Who::Robot => {
                let reply = self.robot.handle(now, input);
                let outputs = std::iter::from_fn(|| self.robot.poll_output());
                (reply, outputs.collect())
            }
        };
        for output in outputs {
            match output {
                Output::Instruct { instruction, .. } => {
                    let below = match who {
                        Who::Parent => Who::Child,
                        Who::Child | Who::Robot => Who::Robot,
                    };
                    self.send(who, below, Message::Instruction(instruction));
                }
                Output::Report { id, report, .. } => {
                    self.send(who, above(who), Message::Report(id, report));
                }
                Output::Observed { facts, reported_to } => {
                    if who != Who::Parent && reported_to != Some(name(above(who))) {
                        self.send(who, above(who), Message::Facts(facts));
                    }
                }
                // Nobody here is the body of several.
                Output::Seen { .. } | Output::Event(_) => {}
                Output::Local(never) => match never {},
            }
        }
        reply
    }

    fn send(&mut self, from: Who, to: Who, what: Message) {
        self.sent += 1;
        let arrival = (self.now + ON_THE_WAY, self.sent);
        self.on_the_way.insert(arrival, (from, to, what));
    }
}

/// Gives an agent an input and takes what it says, looking at the clock.
fn call(
    who: Who,
    agent: &mut Agent<Metered>,
    now: Time,
    input: Input<Infallible>,
    observer: &mut dyn Observer,
) -> (Option<Reply>, Vec<Output<Infallible>>) {
    let before = agent.planner().meter();
    let kept = input.clone();
    let switches = switches();
    let mut outputs = Vec::with_capacity(16);
    let begun = Instant::now();
    let reply = agent.handle(now, input);
    while let Some(output) = agent.poll_output() {
        outputs.push((begun.elapsed(), output));
    }
    let spent = begun.elapsed();
    observer.call(&Call {
        who,
        input: &kept,
        outputs: &outputs,
        spent,
        planning: agent.planner().meter().since(before),
        is_disturbed: switches != self::switches(),
    });
    let outputs = outputs.into_iter().map(|(_, output)| output);
    (reply, outputs.collect())
}

/// How often something else was given the processor while this thread had something to do; nothing if
/// the system does not say.
fn switches() -> i64 {
    let usage = getrusage(UsageWho::RUSAGE_THREAD);
    usage.map_or(0, |usage| usage.involuntary_context_switches())
}

fn above(who: Who) -> Who {
    match who {
        Who::Parent | Who::Child => Who::Parent,
        Who::Robot => Who::Child,
    }
}

fn name(who: Who) -> Symbol {
    Symbol::from(match who {
        Who::Parent => parent_agent::NAME,
        Who::Child => CHILD,
        Who::Robot => EXECUTOR,
    })
}
