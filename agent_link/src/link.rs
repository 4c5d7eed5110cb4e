//! All that one machine is connected by, and what it sends. What it receives is in `incoming`.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use agent_core::model::{Symbol, Time};
use agent_core::protocol::{self, GoalRequest, Output, Urgency};
use serde::Serialize;
use serde_json::{Value, json};
use zenoh::Session;

use crate::channel::{Delivery, Receiver, Sender};
use crate::facts::{Board, Reader};
use crate::inspect::{Inspect, View};
use crate::mailbox::{Arrival, Mailbox};
use crate::publisher::Publisher;
use crate::queue::Arrivals;
use crate::quota::Quota;
use crate::wire::{self, Answer, Instruction, ReportBody, Text, VERSION, WireError};
use crate::wiring::{LinkError, Wiring};

/// All that one machine is connected by.
pub(crate) struct Link {
    pub(crate) wiring: Wiring,
    session: Session,
    pub(crate) mailbox: Mailbox,
    pub(crate) publisher: Publisher,
    pub(crate) instructions: Receiver,
    pub(crate) reports: Receiver,
    pub(crate) local: Receiver,
    to_executors: BTreeMap<Symbol, Sender<Instruction>>,
    to_superiors: BTreeMap<Symbol, Sender<ReportBody>>,
    to_elsewhere: Option<Sender<Value>>,
    pub(crate) board: Board,
    pub(crate) readers: BTreeMap<Arc<str>, Reader>,
    quota: Quota,
    opened: Instant,
}

impl Link {
    pub(crate) async fn open(
        session: &Session,
        wiring: Wiring,
    ) -> Result<(Self, Arrivals), LinkError> {
        let (mailbox, arrivals) = Mailbox::open(session, &wiring).await?;
        let mut link = Self {
            session: session.clone(),
            mailbox,
            publisher: Publisher::new(session),
            instructions: Receiver::default(),
            reports: Receiver::default(),
            local: Receiver::default(),
            to_executors: BTreeMap::new(),
            to_superiors: BTreeMap::new(),
            to_elsewhere: None,
            board: Board::new(wiring.epoch),
            readers: BTreeMap::new(),
            quota: Quota::new(wiring.limits),
            opened: Instant::now(),
            wiring,
        };
        if let Some(key) = link.wiring.local_out.clone() {
            link.to_elsewhere = Some(link.sender(key, |_, _| None));
        }
        Ok((link, arrivals))
    }

    pub(crate) async fn close(self) {
        // Whoever ends says no more; what was not acknowledged is said again after the next start.
        drop((self.to_executors, self.to_superiors, self.to_elsewhere));
        self.publisher.finish().await;
        self.mailbox.close().await;
    }

    /// Whether a goal of a user's may reach the machine, and else why not.
    pub(crate) fn admit(&mut self, sender: Option<&str>, goal: &GoalRequest) -> Result<(), String> {
        match goal.urgency {
            // Those that wait are counted by the machine.
            Urgency::Normal => Ok(()),
            Urgency::Emergency => self
                .quota
                .admit(self.opened.elapsed(), sender, goal.id.as_ref())
                .map_err(|error| error.to_string()),
        }
    }

    /// A sender to `key`; `answered` says what arrives when a message was applied.
    fn sender<T: Clone + Serialize + Send + Sync + 'static>(
        &self,
        key: String,
        answered: impl Fn(T, Option<Answer>) -> Option<Arrival> + Send + 'static,
    ) -> Sender<T> {
        let receiver = key.clone();
        let deliver = move |delivery| match delivery {
            Delivery::Applied(body, answer) => answered(body, answer),
            Delivery::Superseded => Some(Arrival::Superseded(receiver.clone())),
        };
        let from = self.wiring.name.as_str().into();
        let arrivals = self.mailbox.arrivals();
        Sender::spawn(
            &self.session,
            key,
            from,
            self.wiring.epoch,
            arrivals,
            deliver,
        )
    }

    /// Sends what a machine has decided. Never waits.
    pub(crate) fn send<L>(
        &mut self,
        output: Output<L>,
        local_as_value: fn(&L) -> Result<Value, WireError>,
    ) -> Result<(), LinkError> {
        match output {
            Output::Instruct { to, instruction } => {
                if !self.to_executors.contains_key(&to) {
                    let key = self.wiring.keys.agent(to.as_str())?.instruction();
                    let sender = self.sender(key, |instruction: Instruction, answer| {
                        let instruction: protocol::Instruction = instruction.into();
                        match answer {
                            Some(answer) => Some(Arrival::Answered(instruction, answer.into())),
                            None => {
                                tracing::error!("{instruction:?} was applied without an answer");
                                None
                            }
                        }
                    });
                    self.to_executors.insert(to.clone(), sender);
                }
                if let Some(sender) = self.to_executors.get(&to) {
                    sender.send(Instruction::from(&instruction));
                }
            }
            Output::Report { to, id, report } => {
                if !self.to_superiors.contains_key(&to) {
                    let key = self.wiring.keys.agent(to.as_str())?.report();
                    let sender = self.sender(key, |_, _| None);
                    self.to_superiors.insert(to.clone(), sender);
                }
                if let Some(sender) = self.to_superiors.get(&to) {
                    sender.send(ReportBody {
                        id: Text(id),
                        report: (&report).into(),
                    });
                }
            }
            Output::Observed { facts, reported_to } => {
                let message = self.board.tell(&facts, reported_to.as_ref());
                let key = self.wiring.keys.agent(&self.wiring.name)?.facts();
                self.publisher.urgent(key, wire::write(&message)?);
            }
            Output::Event(event) => {
                let line = wire::event_to_line(&self.wiring.name, &event)?;
                self.publisher.put(self.wiring.keys.event(), line);
            }
            Output::Local(local) => match &self.to_elsewhere {
                Some(sender) => sender.send(local_as_value(&local)?),
                None => tracing::error!("the wiring has no way out for what the machine says"),
            },
        }
        Ok(())
    }

    /// Publishes a snapshot, unless the network is busy.
    pub(crate) fn snapshot(&self, now: Time, snapshot: Value) {
        let message = json!({
            "v": VERSION, "t_s": now.secs(), "agent": self.wiring.name, "snapshot": snapshot,
        });
        self.publisher
            .latest(self.wiring.keys.world_pose(), message.to_string());
    }

    /// One of the views into the machine, for whoever asked.
    pub(crate) fn view(&self, view: View, machine: &impl Inspect) -> Result<String, WireError> {
        wire::write(&json!({
            "v": VERSION, "agent": self.wiring.name, view.name(): view.of(machine),
        }))
    }
}
