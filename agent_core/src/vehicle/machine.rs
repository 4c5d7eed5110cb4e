//! The vehicle as a machine.

use super::{Mind, Vehicle};
use crate::model::Time;
use crate::planner::Planner;
use crate::protocol::{Input, Machine, Output, Reply};
use crate::service::{Body, Message};

/// So many rounds one input may cause before others are listened to.
const MOST_ROUNDS: usize = 64;

impl<A: Mind, P: Planner> Vehicle<A, P> {
    /// Lets the parts tell each other what they have to say, until there is nothing more.
    fn come_to_rest(&mut self) {
        for _ in 0..MOST_ROUNDS {
            self.tasks.set_digest(self.states.digest());
            self.tasks.settle(self.now);
            self.states.settle(self.now);
            let mut any = self.serve_tasks();
            any |= self.serve_states();
            any |= self.listen_to_mind();
            self.look_at_the_belief();
            if !any {
                break;
            }
        }
    }
}

impl<A: Mind, P: Planner> Machine for Vehicle<A, P> {
    type In = Message;
    type Out = Message;

    fn handle(&mut self, now: Time, input: Input<Message>) -> Option<Reply> {
        self.now = self.now.max(now);
        // What is not ours any more is given up before anything else.
        self.come_to_rest();
        let reply = match input {
            Input::Goal(request) => Some(self.goal(request, false)),
            Input::Command(command) => Some(self.command(command)),
            Input::Instruction { from, instruction } => {
                Some(Reply::Instruction(self.instructed(&from, instruction)))
            }
            Input::Answer { to, answer } => {
                if !self.task_answered(&to, &answer) {
                    self.tell_mind(Input::Answer { to, answer });
                }
                None
            }
            Input::Report { id, report } => {
                if self.tasks.is_own(&id) {
                    self.tasks.reported(&id, &report);
                } else {
                    self.tell_mind(Input::Report { id, report });
                }
                None
            }
            Input::Observation(facts) => self.tell_mind(Input::Observation(facts)),
            Input::Neighbour { name, there } => {
                if !there && self.tasks.is_there(&name) {
                    self.vehicle_lost(&name);
                }
                self.tasks.neighbour(&name, there);
                self.tell_mind(Input::Neighbour { name, there })
            }
            Input::Reborn { name } => {
                self.tasks.reborn(&name);
                self.tell_mind(Input::Reborn { name })
            }
            Input::Wake => self.tell_mind(Input::Wake),
            Input::Local(message) => match message.body {
                Body::Goal(request) => Some(self.goal(request, true)),
                _ => {
                    self.tasks.heard(&message);
                    self.states.heard(&message);
                    None
                }
            },
        };
        self.come_to_rest();
        let tasks = &self.tasks;
        self.assessments.keep_only(|id| tasks.is_offered(id));
        self.assess();
        self.withdraw_what_is_over();
        self.give_back_what_is_stuck();
        let needs = self.needs();
        self.states.need(needs);
        self.come_to_rest();
        reply
    }

    fn poll_output(&mut self) -> Option<Output<Message>> {
        self.outputs.pop_front()
    }

    fn wake_at(&self) -> Option<Time> {
        if self.assessments.is_thinking() {
            return Some(Time::ZERO);
        }
        let parts = [
            self.mind.wake_at(),
            self.tasks.wake_at(),
            self.states.wake_at(),
            self.stuck_until(),
        ];
        parts.into_iter().flatten().min()
    }

    fn wind_down(&mut self, now: Time) {
        self.mind.wind_down(now);
        self.listen_to_mind();
    }

    fn rests(&self) -> bool {
        self.mind.rests()
    }
}
