//! Machines on one wire and one clock.

use std::collections::BTreeMap;
use std::convert::Infallible;

use agent_core::agent::Agent;
use agent_core::language::{parse_atom, parse_fact_change, parse_tasks};
use agent_core::model::{Action, FactChange, Symbol, Time};
use agent_core::protocol::{
    ActionId, Answer, Command, Event, GoalId, GoalRequest, Happening, Input, Instruction, Machine,
    Output, Rejection, Reply, Report, Urgency,
};
use executor_sim::SimulatedRobot;

use crate::{TestPlanner, Wire};

type AnyMachine = dyn Machine<In = Infallible, Out = Infallible>;

enum Node {
    Agent(Box<Agent<TestPlanner>>),
    Robot(Box<SimulatedRobot>),
    Other(Box<AnyMachine>),
}

impl Node {
    fn machine(&mut self) -> &mut AnyMachine {
        match self {
            Self::Agent(agent) => &mut **agent,
            Self::Robot(robot) => &mut **robot,
            Self::Other(machine) => &mut **machine,
        }
    }
}

/// Something on the wire.
#[derive(Clone, Debug, PartialEq)]
pub enum Heard {
    /// Down.
    Instruction(Instruction),
    /// Back.
    Answer(Instruction, Answer),
    /// Up.
    Report(ActionId, Report),
    /// Facts.
    Facts(Vec<FactChange>),
}

/// Nothing takes so many steps without taking time.
const STEPS_AT_ONE_TIME: u32 = 10_000;

/// A robot with its agents, of any number of storeys.
pub struct Stack {
    now: Time,
    nodes: BTreeMap<Symbol, Node>,
    /// Executor and those who want to know its facts.
    superiors: BTreeMap<Symbol, Vec<Symbol>>,
    wire: Wire,
    on_the_way: BTreeMap<(Time, u64), (Symbol, Symbol, Heard)>,
    sent: u64,
    /// Steps that took no time.
    steps_now: u32,
    /// Everything that was said: when, by whom.
    pub events: Vec<(Symbol, Event)>,
    /// Everything that was delivered: when, from, to.
    pub heard: Vec<(Time, Symbol, Symbol, Heard)>,
}

impl Stack {
    /// Nobody yet.
    pub fn new(wire: Wire) -> Self {
        Self {
            now: Time::ZERO,
            nodes: BTreeMap::new(),
            superiors: BTreeMap::new(),
            wire,
            on_the_way: BTreeMap::new(),
            sent: 0,
            steps_now: 0,
            events: Vec::new(),
            heard: Vec::new(),
        }
    }

    /// Adds an agent; `executors` are those whose facts it wants to know.
    pub fn add_agent(&mut self, agent: Agent<TestPlanner>, executors: &[&str]) {
        let name = agent.name().clone();
        for executor in executors {
            self.superiors
                .entry(Symbol::from(*executor))
                .or_default()
                .push(name.clone());
        }
        self.nodes.insert(name, Node::Agent(Box::new(agent)));
    }

    /// Adds a robot.
    pub fn add_robot(&mut self, name: &str, robot: SimulatedRobot) {
        self.nodes.insert(name.into(), Node::Robot(Box::new(robot)));
    }

    /// Adds any other machine.
    pub fn add_machine(&mut self, name: &str, machine: Box<AnyMachine>) {
        self.nodes.insert(name.into(), Node::Other(machine));
    }

    /// An agent.
    pub fn agent(&self, name: &str) -> &Agent<TestPlanner> {
        match self.nodes.get(name) {
            Some(Node::Agent(agent)) => agent,
            _ => panic!("there is no agent named {name}"),
        }
    }

    /// A robot.
    pub fn robot(&self, name: &str) -> &SimulatedRobot {
        match self.nodes.get(name) {
            Some(Node::Robot(robot)) => robot,
            _ => panic!("there is no robot named {name}"),
        }
    }

    /// Where the robot really is, in words.
    pub fn place(&self) -> String {
        let world = self.robot("executor").world();
        world.place(self.now).to_string()
    }

    /// The time.
    pub fn now(&self) -> Time {
        self.now
    }

    /// A user's goal, in HDDL.
    pub fn ask(
        &mut self,
        agent: &str,
        id: &str,
        tasks: &str,
        urgency: Urgency,
        priority: i32,
    ) -> Result<GoalId, Rejection> {
        let request = GoalRequest {
            id: Some(id.into()),
            tasks: parse_tasks(tasks).expect("a test writes its tasks in HDDL"),
            urgency,
            priority,
            deadline: None,
        };
        self.request(agent, request)
    }

    /// A user's goal.
    pub fn request(&mut self, agent: &str, request: GoalRequest) -> Result<GoalId, Rejection> {
        match self.tell(agent, Input::Goal(request)) {
            Some(Reply::Goal(verdict)) => verdict,
            other => panic!("a goal is answered by a verdict, not by {other:?}"),
        }
    }

    /// A normal goal that is accepted.
    pub fn goal(&mut self, id: &str, tasks: &str) {
        let verdict = self.ask("parent", id, tasks, Urgency::Normal, 0);
        assert_eq!(verdict, Ok(id.into()));
    }

    /// An emergency that is accepted.
    pub fn emergency(&mut self, id: &str, tasks: &str) {
        let verdict = self.ask("parent", id, tasks, Urgency::Emergency, 0);
        assert_eq!(verdict, Ok(id.into()));
    }

    /// A user's wish about a goal.
    pub fn command(&mut self, command: Command) -> Result<(), Rejection> {
        match self.tell("parent", Input::Command(command)) {
            Some(Reply::Command(verdict)) => verdict,
            other => panic!("a command is answered by a verdict, not by {other:?}"),
        }
    }

    /// Something changes in the world, and everyone is told of it.
    pub fn world(&mut self, fact: &str) {
        let change = parse_fact_change(fact).expect("a test writes its facts in HDDL");
        let names: Vec<Symbol> = self.nodes.keys().cloned().collect();
        for name in names {
            self.tell(name.as_str(), Input::Observation(vec![change.clone()]));
        }
    }

    /// Gives a machine an input.
    pub fn tell(&mut self, name: &str, input: Input<Infallible>) -> Option<Reply> {
        let now = self.now;
        let node = self.nodes.get_mut(name).expect("the machine is there");
        let reply = node.machine().handle(now, input);
        self.drain(name);
        reply
    }

    fn drain(&mut self, name: &str) {
        let from = Symbol::from(name);
        while let Some(output) = self
            .nodes
            .get_mut(name)
            .and_then(|node| node.machine().poll_output())
        {
            match output {
                Output::Instruct { to, instruction } => {
                    self.send(&from, &to, "instruction", Heard::Instruction(instruction));
                }
                Output::Report { to, id, report } => {
                    self.send(&from, &to, "report", Heard::Report(id, report));
                }
                Output::Observed { facts, reported_to } => {
                    let superiors = self.superiors.get(name).cloned().unwrap_or_default();
                    for to in superiors {
                        if reported_to.as_ref() != Some(&to) {
                            self.send(&from, &to, "facts", Heard::Facts(facts.clone()));
                        }
                    }
                }
                Output::Seen {
                    to,
                    facts,
                    reported,
                } => {
                    if !reported {
                        self.send(&from, &to, "facts", Heard::Facts(facts));
                    }
                }
                Output::Event(event) => self.events.push((from.clone(), event)),
                Output::Local(never) => match never {},
            }
        }
        if let Some(Node::Agent(agent)) = self.nodes.get(name) {
            agent.check();
        }
    }

    fn send(&mut self, from: &Symbol, to: &Symbol, kind: &'static str, what: Heard) {
        let at = self.wire.arrival(self.now, from, to, kind);
        self.sent += 1;
        self.on_the_way
            .insert((at, self.sent), (from.clone(), to.clone(), what));
    }

    /// Lets the next thing happen, at the latest at `until`. Returns whether something did.
    pub fn step(&mut self, until: Time) -> bool {
        let wake = self
            .nodes
            .iter_mut()
            .filter_map(|(name, node)| Some((node.machine().wake_at()?, name.clone())))
            .min();
        let message = self.on_the_way.keys().next().copied();
        let wake_at = wake.as_ref().map(|(at, _)| (*at).max(self.now));
        let message_at = message.map(|(at, _)| at);
        let Some(next) = wake_at.into_iter().chain(message_at).min() else {
            self.now = until;
            return false;
        };
        if next > until {
            self.now = until;
            return false;
        }
        self.steps_now = if next > self.now {
            0
        } else {
            self.steps_now + 1
        };
        assert!(
            self.steps_now < STEPS_AT_ONE_TIME,
            "it goes round in circles:\n{}",
            self.story()
        );
        self.now = next;
        if message_at == Some(next)
            && let Some((_, (from, to, what))) = self.on_the_way.pop_first()
        {
            self.deliver(from, to, what);
        } else if let Some((_, name)) = wake {
            self.tell(name.as_str(), Input::Wake);
        }
        true
    }

    fn deliver(&mut self, from: Symbol, to: Symbol, what: Heard) {
        self.heard
            .push((self.now, from.clone(), to.clone(), what.clone()));
        let input = match what {
            Heard::Instruction(instruction) => Input::Instruction {
                from: from.clone(),
                instruction,
            },
            Heard::Answer(to, answer) => Input::Answer { to, answer },
            Heard::Report(id, report) => Input::Report { id, report },
            Heard::Facts(facts) => Input::Observation(facts),
        };
        let instruction = match &input {
            Input::Instruction { instruction, .. } => Some(instruction.clone()),
            _ => None,
        };
        let reply = self.tell(to.as_str(), input);
        if let (Some(instruction), Some(Reply::Instruction(answer))) = (instruction, reply) {
            self.send(&to, &from, "answer", Heard::Answer(instruction, answer));
        }
    }

    /// Runs until `time`.
    pub fn run_until(&mut self, time: f64) {
        let until = Time::from_secs(time);
        while self.step(until) {}
    }

    /// Runs until nothing more happens by itself.
    ///
    /// # Panics
    ///
    /// If things go on for more than an hour of virtual time.
    pub fn run(&mut self) {
        let until = self.now + Time::from_secs(3600.0);
        while self.step(until) {}
        assert!(
            self.on_the_way.is_empty(),
            "things still go on after an hour"
        );
    }

    /// Runs until an event that is looked for has happened from now on.
    ///
    /// # Panics
    ///
    /// If it has not within an hour of virtual time.
    pub fn run_to(&mut self, agent: &str, wanted: impl Fn(&Event) -> bool) {
        let until = self.now + Time::from_secs(3600.0);
        let mut seen = self.events.len();
        loop {
            if self.events[seen..]
                .iter()
                .any(|(who, event)| *who == agent && wanted(event))
            {
                return;
            }
            seen = self.events.len();
            assert!(
                self.step(until),
                "it did not come to that:\n{}",
                self.story()
            );
        }
    }

    /// Runs until the robot begins an action, as the agent that gives it names it, and then for so
    /// many seconds more.
    pub fn run_into(&mut self, agent: &str, action: &str, seconds: f64) {
        let action = parse_atom(action).expect("a test writes its actions in HDDL");
        self.run_to(agent, |event| {
            matches!(&event.what, Happening::ActionStarted { action: a, .. } if *a == action)
        });
        let until = self.now + Time::from_secs(seconds);
        while self.step(until) {}
    }

    /// The actions that an agent's executor has finished, in order; those resumed are listed by
    /// what ended them.
    pub fn done(&self, agent: &str) -> Vec<String> {
        self.of(agent)
            .filter_map(|event| match &event.what {
                Happening::ActionFinished {
                    action,
                    failure: None,
                    ..
                }
                | Happening::ActionRolledBack { action, .. } => Some(action.to_string()),
                _ => None,
            })
            .collect()
    }

    /// The events of an agent.
    pub fn of(&self, agent: &str) -> impl Iterator<Item = &Event> {
        self.events
            .iter()
            .filter(move |(who, _)| *who == agent)
            .map(|(_, event)| event)
    }

    /// The events of an agent about one goal.
    pub fn about<'a>(&'a self, agent: &'a str, goal: &'a str) -> impl Iterator<Item = &'a Event> {
        self.of(agent)
            .filter(move |event| event.goal.as_ref().is_some_and(|id| *id == goal))
    }

    /// How a goal was last resumed.
    pub fn resumption(&self, agent: &str, goal: &str) -> Option<agent_core::protocol::Resumption> {
        self.about(agent, goal)
            .filter_map(|event| match &event.what {
                Happening::GoalResumed { how, .. } => Some(*how),
                _ => None,
            })
            .last()
    }

    /// Whether a goal was reached.
    pub fn succeeded(&self, goal: &str) -> bool {
        self.about("parent", goal)
            .any(|event| event.what == Happening::GoalSucceeded)
    }

    /// Instructions that were delivered to a machine, in order, as text without numbers.
    pub fn instructions_to(&self, name: &str) -> Vec<String> {
        let mut actions: BTreeMap<&ActionId, &Action> = BTreeMap::new();
        let mut told = Vec::new();
        for (_, _, to, what) in &self.heard {
            let Heard::Instruction(instruction) = what else {
                continue;
            };
            if *to != name {
                continue;
            }
            if let Instruction::Execute { id, action, .. } = instruction {
                actions.insert(id, action);
            }
            let action = actions
                .get(instruction.id())
                .map_or_else(String::new, |action| action.to_string());
            let verb = match instruction {
                Instruction::Execute { .. } => "execute",
                Instruction::Suspend { .. } => "suspend",
                Instruction::Resume { .. } => "resume",
                Instruction::Clear { .. } => "clear",
            };
            told.push(format!("{verb} {action}"));
        }
        told
    }

    /// Everything that was said, a line each: what a failing test prints.
    pub fn story(&self) -> String {
        let lines = self.events.iter().map(|(who, event)| {
            let goal = event.goal.as_ref().map_or("", Symbol::as_str);
            format!(
                "{:>8.2} {who:<9} {goal:<14} [{}] {:?}",
                event.at.secs(),
                event.stack_depth,
                event.what
            )
        });
        lines.collect::<Vec<_>>().join("\n")
    }
}
