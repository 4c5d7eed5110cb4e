//! One agent on the bench: the test is its executor, its superior and its user.

use std::convert::Infallible;

use agent_core::agent::{Agent, Configuration};
use agent_core::language::{parse_atom, parse_fact_change, parse_tasks};
use agent_core::model::{Action, FactChange, Map, Symbol, Time};
use agent_core::protocol::{
    ActionId, Answer, Command, Event, GoalRequest, Happening, Input, Instruction, Machine, Output,
    Rejection, Reply, Report, Urgency,
};

use crate::{TestPlanner, agent};

/// One agent, with everything it has said.
pub struct Bench {
    /// The agent.
    pub agent: Agent<TestPlanner>,
    /// The time that inputs are given at.
    pub now: Time,
    /// All events.
    pub events: Vec<Event>,
    told: Vec<String>,
    ids: Vec<ActionId>,
    reported: Vec<String>,
}

impl Bench {
    /// An agent made of that.
    pub fn new(configuration: Configuration) -> Self {
        Self {
            agent: agent(configuration),
            now: Time::ZERO,
            events: Vec::new(),
            told: Vec::new(),
            ids: Vec::new(),
            reported: Vec::new(),
        }
    }

    /// Gives the agent an input and lets it think to its end.
    pub fn tell(&mut self, input: Input<Infallible>) -> Option<Reply> {
        let reply = self.agent.handle(self.now, input);
        self.drain();
        while self.agent.wake_at().is_some_and(|at| at <= self.now) {
            self.agent.handle(self.now, Input::Wake);
            self.drain();
        }
        reply
    }

    /// Gives the agent an input and no time to think any further.
    pub fn tell_only(&mut self, input: Input<Infallible>) -> Option<Reply> {
        let reply = self.agent.handle(self.now, input);
        self.drain();
        reply
    }

    fn drain(&mut self) {
        while let Some(output) = self.agent.poll_output() {
            match output {
                Output::Instruct { instruction, .. } => {
                    let (verb, what) = match &instruction {
                        Instruction::Execute { action, id, .. } => {
                            self.ids.push(id.clone());
                            ("execute", action.to_string())
                        }
                        Instruction::Suspend { .. } => ("suspend", String::new()),
                        Instruction::Resume { .. } => ("resume", String::new()),
                        Instruction::Clear { .. } => ("clear", String::new()),
                    };
                    let number = instruction.id().number;
                    let line = format!("{verb} #{number} {what}");
                    self.told.push(line.trim_end().to_owned());
                }
                Output::Report { id, report, .. } => {
                    let what = match report {
                        Report::Started => "started".to_owned(),
                        Report::Progress { .. } => "progress".to_owned(),
                        Report::Success { .. } => "success".to_owned(),
                        Report::Failure { blocked_by, .. } => format!("failure {blocked_by:?}"),
                        Report::Unknown { .. } => "unknown".to_owned(),
                        Report::Suspended { .. } => "suspended".to_owned(),
                    };
                    self.reported.push(format!("#{} {what}", id.number));
                }
                Output::Event(event) => self.events.push(event),
                Output::Observed { .. } | Output::Seen { .. } => {}
                Output::Local(never) => match never {},
            }
        }
        self.agent.check();
    }

    /// What the executor was told since this was last asked.
    pub fn told(&mut self) -> Vec<String> {
        std::mem::take(&mut self.told)
    }

    /// What the superior was told since this was last asked, `started` and `progress` apart.
    pub fn reported(&mut self) -> Vec<String> {
        let all = std::mem::take(&mut self.reported);
        all.into_iter()
            .filter(|line| !line.ends_with("started"))
            .collect()
    }

    /// A goal of the user.
    pub fn ask(
        &mut self,
        id: &str,
        tasks: &str,
        urgency: Urgency,
        priority: i32,
    ) -> Result<Symbol, Rejection> {
        let request = GoalRequest {
            id: Some(id.into()),
            tasks: parse_tasks(tasks).expect("a test writes its tasks in HDDL"),
            urgency,
            priority,
            deadline: None,
        };
        match self.tell(Input::Goal(request)) {
            Some(Reply::Goal(verdict)) => verdict,
            other => panic!("a goal is answered by a verdict, not by {other:?}"),
        }
    }

    /// A normal goal that is accepted.
    pub fn goal(&mut self, id: &str, tasks: &str) {
        assert_eq!(self.ask(id, tasks, Urgency::Normal, 0), Ok(id.into()));
    }

    /// An emergency that is accepted.
    pub fn emergency(&mut self, id: &str, tasks: &str) {
        assert_eq!(self.ask(id, tasks, Urgency::Emergency, 0), Ok(id.into()));
    }

    /// A user's wish about a goal.
    pub fn command(&mut self, command: Command) -> Result<(), Rejection> {
        match self.tell(Input::Command(command)) {
            Some(Reply::Command(verdict)) => verdict,
            other => panic!("a command is answered by a verdict, not by {other:?}"),
        }
    }

    fn id(&self, number: u64) -> ActionId {
        let known = self.ids.iter().find(|id| id.number == number);
        known.expect("the action was begun").clone()
    }

    /// The executor has done it.
    pub fn success(&mut self, number: u64, facts: &[&str]) {
        let facts = changes(facts);
        self.report(number, Report::Success { facts });
    }

    /// The executor has failed.
    pub fn failure(&mut self, number: u64, facts: &[&str], blocked_by: &[&str]) {
        let report = Report::Failure {
            reason: "it did not work".to_owned(),
            facts: changes(facts),
            blocked_by: blocked_by
                .iter()
                .map(|fact| parse_atom(fact).expect("a test writes its facts in HDDL"))
                .collect(),
        };
        self.report(number, report);
    }

    /// The executor stands still.
    pub fn suspended(&mut self, number: u64, facts: &[&str]) {
        let facts = changes(facts);
        self.report(number, Report::Suspended { facts });
    }

    /// A report about an action.
    pub fn report(&mut self, number: u64, report: Report) {
        let id = self.id(number);
        self.tell(Input::Report { id, report });
    }

    /// The executor's answer to `Suspend`.
    pub fn answer_to_suspend(&mut self, number: u64, answer: Answer) {
        let to = Instruction::Suspend {
            id: self.id(number),
        };
        self.tell(Input::Answer { to, answer });
    }

    /// Facts that turn out otherwise.
    pub fn observe(&mut self, facts: &[&str]) {
        self.tell(Input::Observation(changes(facts)));
    }

    /// An instruction of the superior, named by number.
    pub fn instruct(&mut self, instruction: Instruction) -> Answer {
        let input = Input::Instruction {
            from: "superior".into(),
            instruction,
        };
        match self.tell(input) {
            Some(Reply::Instruction(answer)) => answer,
            other => panic!("an instruction is answered, not by {other:?}"),
        }
    }

    /// The superior has something done.
    pub fn execute(&mut self, number: u64, action: &str, map: Option<&Map>) -> Answer {
        self.instruct(Instruction::Execute {
            id: of_superior(number),
            action: parse_atom(action).expect("a test writes its actions in HDDL"),
            map: map.cloned(),
        })
    }

    /// Plans that are kept for a goal, as lists of actions.
    pub fn plans(&self, goal: &str) -> Vec<Vec<String>> {
        let stacked = self.agent.stack().entries().iter().map(|e| &e.intention);
        let intention = self
            .agent
            .running()
            .into_iter()
            .chain(stacked)
            .find(|intention| intention.goal.id == goal)
            .expect("the goal is pursued or suspended");
        let actions = |plan: &agent_core::planner::Plan| {
            plan.actions().iter().map(Action::to_string).collect()
        };
        intention.plans.iter().map(actions).collect()
    }

    /// The goals on the stack, innermost last.
    pub fn stacked(&self) -> Vec<String> {
        let entries = self.agent.stack().entries().iter();
        entries.map(|e| e.intention.goal.id.to_string()).collect()
    }

    /// The goal that runs.
    pub fn running(&self) -> Option<String> {
        self.agent
            .running()
            .map(|intention| intention.goal.id.to_string())
    }

    /// Whether something was said about a goal.
    pub fn said(&self, goal: &str, what: impl Fn(&Happening) -> bool) -> bool {
        let mut about = self
            .events
            .iter()
            .filter(|event| event.goal.as_ref().is_some_and(|id| *id == goal));
        about.any(|event| what(&event.what))
    }
}

/// The name of the superior's execution of that number.
pub fn of_superior(number: u64) -> ActionId {
    ActionId {
        agent: "superior".into(),
        epoch: 1,
        number,
    }
}

fn changes(facts: &[&str]) -> Vec<FactChange> {
    facts
        .iter()
        .map(|fact| parse_fact_change(fact).expect("a test writes its facts in HDDL"))
        .collect()
}
