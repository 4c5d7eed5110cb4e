//! The world's end of the line to the controller.

use agent_core::protocol::{Envelope, Input, Machine, Output, Receipt, Response};
use executor_sim::Sensor;

use crate::process::{Kind, name};
use crate::scenario::Who;
use crate::wire::Message;

use super::Simulation;

impl Simulation<'_> {
    pub(super) fn deliver_to_world(&mut self, message: Message) {
        match message {
            Message::Command(envelope) => {
                let (epoch, seq) = (envelope.epoch, envelope.seq);
                let response = match self.world_hears.receive(&envelope) {
                    Receipt::New { .. } => {
                        self.world_hears.applied(&envelope, None);
                        self.world_epoch = envelope.epoch;
                        self.tell(|| format!("world     is told {:?}", envelope.body));
                        self.world.handle(self.now, Input::Local(envelope.body));
                        self.hear_the_world();
                        Response::Applied { seq, answer: None }
                    }
                    Receipt::Again(_) => Response::Applied { seq, answer: None },
                    Receipt::Old => Response::Superseded { seq },
                    Receipt::Gap { due } => Response::Gap { seq, due },
                };
                let message = Message::Response {
                    epoch,
                    kind: Kind::Local,
                    response,
                    line: 1,
                };
                self.send(Who::World, Who::Executor, message);
            }
            Message::Response {
                response: Response::Applied { seq, .. },
                ..
            } if self.world_says.is_first(seq) => {
                self.world_says.queue.pop_front();
                self.world_says.attempts = 0;
                self.attempt(Who::World, Kind::Local, Who::Executor);
            }
            Message::Door(change) => {
                self.world
                    .handle(self.now, Input::Observation(vec![change]));
                self.hear_the_world();
            }
            _ => {}
        }
    }

    /// Takes what the sensors say.
    pub(super) fn hear_the_world(&mut self) {
        while let Some(output) = self.world.poll_output() {
            let Output::Local(sensor) = output else {
                continue;
            };
            if matches!(sensor, Sensor::Pose(_)) {
                // For displays.
                continue;
            }
            let epoch = self.world_epoch;
            // What a process has commanded that is no more may still come before the halt of the next.
            let node = &self.nodes[Who::Executor.index()];
            let instructed = node.instructed || epoch != node.epoch;
            self.tell(|| format!("world     says {sensor:?}"));
            self.law.sensed(self.now, epoch, &sensor, instructed);
            self.world_seq += 1;
            let seq = self.world_seq;
            let message = Message::Sensor(Envelope {
                from: name(Who::World),
                line: 1,
                epoch: 1,
                seq,
                settled: seq - 1,
                to_line: 0,
                body: sensor,
            });
            self.world_says.queue.push_back((seq, message));
            if self.world_says.queue.len() == 1 {
                self.world_says.attempts = 0;
                self.attempt(Who::World, Kind::Local, Who::Executor);
            }
        }
    }
}
