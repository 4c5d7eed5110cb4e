//! What users ask for, until they are answered.

use agent_core::language::parse_tasks;
use agent_core::model::Symbol;
use agent_core::protocol::{Arrival, Command, GoalRequest, Input};

use crate::process::Way;
use crate::scenario::{Scenario, What, Who, Wish};
use crate::wire::Message;

use super::{Due, PATIENCE, Request, Simulation};

impl Simulation<'_> {
    pub(super) fn request(&mut self, goal: usize, wish: Option<Wish>, insists: bool) {
        let number = self.requests.len() as u32;
        self.requests.push(Request {
            goal,
            wish,
            answered: false,
            insists,
        });
        self.user_asks(number);
    }

    pub(super) fn user_asks(&mut self, number: u32) {
        let request = &self.requests[number as usize];
        if request.answered {
            return;
        }
        let insists = request.insists;
        self.send(Who::User, Who::Parent, Message::Request(number));
        if insists {
            self.after(PATIENCE, Due::UserAsks(number));
        }
    }

    pub(super) fn requested(&mut self, to: Who, number: u32) {
        let request = &self.requests[number as usize];
        let (id, _, goal) = &self.goals[request.goal];
        let input = match request.wish {
            None => {
                if self.nodes[to.index()].full_until > self.now {
                    // Refused by the driver: the user asks again.
                    return;
                }
                Input::Goal(goal.clone())
            }
            Some(Wish::Suspend) => Input::Command(Command::Suspend(id.clone())),
            Some(Wish::Resume) => Input::Command(Command::Resume(id.clone())),
            Some(Wish::Cancel) => Input::Command(Command::Cancel(id.clone())),
        };
        self.give(to, Arrival::Input(input), Some(Way::User(number)));
    }
}

pub(super) fn goals(scenario: &Scenario) -> Vec<(Symbol, String, GoalRequest)> {
    let mut goals: Vec<Option<(Symbol, String, GoalRequest)>> = Vec::new();
    for (_, what) in &scenario.happenings {
        let What::Goal {
            goal,
            task,
            urgency,
            priority,
        } = what
        else {
            continue;
        };
        if goals.len() <= *goal {
            goals.resize(goal + 1, None);
        }
        let id = Symbol::from(format!("goal{goal}").as_str());
        let request = GoalRequest {
            id: Some(id.clone()),
            tasks: parse_tasks(task).unwrap_or_default(),
            urgency: *urgency,
            priority: *priority,
            deadline: None,
        };
        goals[*goal] = Some((id, task.clone(), request));
    }
    // Nobody asks for what is not among the happenings, but somebody may want it cancelled.
    let missing = |n: usize| {
        let id = Symbol::from(format!("goal{n}").as_str());
        let request = GoalRequest {
            id: Some(id.clone()),
            tasks: Vec::new(),
            urgency: agent_core::protocol::Urgency::Normal,
            priority: 0,
            deadline: None,
        };
        (id, String::new(), request)
    };
    let most = scenario
        .happenings
        .iter()
        .filter_map(|(_, what)| match what {
            What::Goal { goal, .. } | What::Again { goal } | What::Wish { goal, .. } => {
                Some(goal + 1)
            }
            _ => None,
        });
    let most = most.max().unwrap_or_default();
    goals.resize(most.max(goals.len()), None);
    let named = goals.into_iter().enumerate();
    named
        .map(|(n, goal)| goal.unwrap_or_else(|| missing(n)))
        .collect()
}
