//! To whom what comes in goes, and what of theirs goes out.

use std::convert::Infallible;

use super::{ParallelAgent, Who};
use crate::agent::Agent;
use crate::model::FactChange;
use crate::planner::Planner;
use crate::protocol::{
    ActionId, Command, Event, GoalId, GoalRequest, Happening, Input, Machine, Output, Reply,
};

/// What is said once of what all agents are told.
#[derive(Debug, Default)]
pub(super) struct Said {
    what: Vec<Happening>,
    /// Whether they are told facts, so that nobody need be told of what one makes of them.
    facts: bool,
}

impl<P: Planner> ParallelAgent<P> {
    /// Gives an input to whom it is for.
    pub(super) fn dispatch(&mut self, input: Input<Infallible>) -> Option<Reply> {
        match input {
            Input::Goal(request) => Some(self.goal(request)),
            Input::Command(command) => {
                let (Command::Suspend(goal) | Command::Resume(goal) | Command::Cancel(goal)) =
                    &command;
                let here = |agent: &Agent<P>| agent.tasks_of(goal).is_some();
                let who = self.whoever(here).unwrap_or(Who::List);
                self.tell(who, Input::Command(command))
            }
            Input::Instruction { from, instruction } => {
                let known = |agent: &Agent<P>| agent.knows_instruction(&from, instruction.id());
                let who = self.whoever(known).unwrap_or(Who::List);
                self.tell(who, Input::Instruction { from, instruction })
            }
            Input::Answer { to, answer } => {
                let who = self.executor_of(to.id())?;
                self.tell(who, Input::Answer { to, answer })
            }
            Input::Report { id, report } => {
                let who = self.executor_of(&id)?;
                self.tell(who, Input::Report { id, report })
            }
            Input::Observation(_) | Input::Neighbour { .. } | Input::Reborn { .. } => {
                self.tell_all(&input);
                None
            }
            Input::Wake => {
                for who in self.everybody() {
                    let wake_at = self.agent(who).and_then(Machine::wake_at);
                    if wake_at.is_some_and(|at| at <= self.now) {
                        self.tell(who, Input::Wake);
                    }
                }
                None
            }
            Input::Local(never) => match never {},
        }
    }

    /// The agent of which that is so.
    fn whoever(&self, is_so: impl Fn(&Agent<P>) -> bool) -> Option<Who> {
        let mut everybody = self.everybody().into_iter();
        everybody.find(|who| self.agent(*who).is_some_and(&is_so))
    }

    /// Who has an action executed. What nobody has executed any more is old.
    fn executor_of(&self, id: &ActionId) -> Option<Who> {
        self.whoever(|agent| {
            agent
                .executing()
                .is_some_and(|(running, _, _)| running == id)
        })
    }

    fn goal(&mut self, request: GoalRequest) -> Reply {
        let named = request.id.as_ref();
        let known = named.and_then(|id| self.whoever(|agent| agent.tasks_of(id).is_some()));
        if let Some(who) = known
            && let Some(reply) = self.tell(who, Input::Goal(request.clone()))
        {
            return reply;
        }
        let others = std::iter::once(&self.foremost).chain(&self.branches);
        let elsewhere = others.map(|agent| agent.waiting_of(request.urgency)).sum();
        let names = (self.list.next_number()..).map(|number| GoalId::from(format!("g{number}")));
        let is_free = |name: &GoalId| self.agents().all(|agent| agent.tasks_of(name).is_none());
        let free = names.into_iter().find(is_free);
        let reply = self.list.take_goal(self.now, request, elsewhere, free);
        self.pass_on(Who::List, None);
        Reply::Goal(reply)
    }

    /// Gives an input to one of the agents.
    pub(super) fn tell(&mut self, who: Who, input: Input<Infallible>) -> Option<Reply> {
        let now = self.now;
        let reply = self.agent_mut(who)?.handle(now, input);
        self.pass_on(who, None);
        reply
    }

    /// Gives an input to all agents. What they all say of it is said once.
    pub(super) fn tell_all(&mut self, input: &Input<Infallible>) {
        let mut said = Said {
            what: Vec::new(),
            facts: matches!(input, Input::Observation(_)),
        };
        for who in self.everybody() {
            let now = self.now;
            if let Some(agent) = self.agent_mut(who) {
                agent.handle(now, input.clone());
            }
            self.pass_on(who, Some(&mut said));
        }
    }

    /// Passes on what one of the agents has to say. What it has learned by itself is told to the others,
    /// unless `said` says that they are being told.
    pub(super) fn pass_on(&mut self, who: Who, mut said: Option<&mut Said>) {
        let mut news: Vec<Vec<FactChange>> = Vec::new();
        let others = self
            .agents()
            .map(|agent| agent.stack().depth())
            .sum::<usize>()
            - self.agent(who).map_or(0, |agent| agent.stack().depth());
        while let Some(output) = self.agent_mut(who).and_then(Machine::poll_output) {
            match output {
                Output::Event(event) => {
                    let told = said.as_ref().is_some_and(|said| said.facts);
                    if let Happening::BeliefChanged { changes } = &event.what
                        && !told
                    {
                        news.push(changes.clone());
                    } else if let Some(said) = &mut said
                        && event.goal.is_none()
                    {
                        if said.what.contains(&event.what) {
                            continue;
                        }
                        said.what.push(event.what.clone());
                    }
                    self.note(who, &event.what);
                    self.outputs.push_back(Output::Event(Event {
                        stack_depth: event.stack_depth + others,
                        ..event
                    }));
                }
                // All of them would say the same, and the list always does.
                Output::Observed { .. } if who != Who::List => {}
                output => self.outputs.push_back(output),
            }
        }
        for changes in news {
            let mut said = Said {
                what: vec![Happening::BeliefChanged {
                    changes: changes.clone(),
                }],
                facts: true,
            };
            for other in self.everybody().into_iter().filter(|other| *other != who) {
                let now = self.now;
                if let Some(agent) = self.agent_mut(other) {
                    agent.handle(now, Input::Observation(changes.clone()));
                }
                self.pass_on(other, Some(&mut said));
            }
        }
    }

    /// Keeps count of what is executed.
    fn note(&mut self, who: Who, what: &Happening) {
        let Who::Branch(slot) = who else {
            return;
        };
        match what {
            Happening::ActionFinished { failure, .. } => {
                if let Some(begun) = self.underway.remove(&slot)
                    && failure.is_none()
                {
                    self.executed.push((begun.layer, begun.footprint));
                }
            }
            Happening::ActionRolledBack { .. } | Happening::ActionSuspended { .. } => {
                self.underway.remove(&slot);
            }
            _ => {}
        }
    }
}
