//! All that one machine is connected by, and what it sends. What it receives is in `incoming`.

use std::collections::BTreeMap;
use std::time::Instant;

use agent_core::model::{Symbol, Time};
use agent_core::protocol::{Effect, GoalRequest, Urgency};
use serde_json::{Value, json};
use zenoh::Session;

use crate::channel::{Delivery, Sender, send_ahead};
use crate::facts::{Board, Reader};
use crate::incoming::ReplyTo;
use crate::inspect::{Inspect, View};
use crate::keys::{AgentKeys, NameError};
use crate::mailbox::{Arrival, Mailbox, Told};
use crate::neighbours::Neighbours;
use crate::publisher::Publisher;
use crate::question::Question;
use crate::queue::Arrivals;
use crate::quota::Quota;
use crate::wire::{
    self, Acknowledgement, EventNumber, Instruction, Message, ReportBody, Text, VERSION, WireError,
};
use crate::wiring::{LinkError, Wiring};

/// All that one machine is connected by.
pub(crate) struct Link {
    pub(crate) wiring: Wiring,
    session: Session,
    pub(crate) mailbox: Mailbox,
    pub(crate) publisher: Publisher,
    to_executors: BTreeMap<Symbol, Sender>,
    to_superiors: BTreeMap<Symbol, Sender>,
    to_elsewhere: Option<Sender>,
    pub(crate) neighbours: Neighbours,
    /// Why the journal cannot be written at present.
    pub(crate) trouble: Option<String>,
    /// What it has told all its superiors.
    pub(crate) board: Board,
    /// What it has told each of them alone.
    pub(crate) boards: BTreeMap<Symbol, Board>,
    pub(crate) readers: BTreeMap<Told, Reader>,
    quota: Quota,
    opened: Instant,
}

impl Link {
    pub(crate) async fn open(
        session: &Session,
        wiring: Wiring,
        line: u64,
    ) -> Result<(Self, Arrivals), LinkError> {
        let (mailbox, arrivals) = Mailbox::open(session, &wiring, line).await?;
        let mut link = Self {
            session: session.clone(),
            mailbox,
            publisher: Publisher::new(session),
            neighbours: Neighbours::default(),
            trouble: None,
            to_executors: BTreeMap::new(),
            to_superiors: BTreeMap::new(),
            to_elsewhere: None,
            board: Board::new(wiring.epoch),
            boards: BTreeMap::new(),
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
        if let Some(trouble) = &self.trouble {
            // What cannot be written down is not promised.
            return Err(trouble.clone());
        }
        match goal.urgency {
            // Those that wait are counted by the machine.
            Urgency::Normal => Ok(()),
            Urgency::Emergency => self
                .quota
                .admit(self.opened.elapsed(), sender, goal.id.as_ref())
                .map_err(|error| error.to_string()),
        }
    }

    /// A sender to `key`; `applied` says what arrives when a message was.
    fn sender(
        &self,
        key: String,
        applied: impl Fn(u64, Acknowledgement) -> Option<Arrival> + Send + 'static,
    ) -> Sender {
        let receiver = key.clone();
        let deliver = move |delivery| match delivery {
            Delivery::Applied(seq, answer) => applied(seq, answer),
            Delivery::Superseded => Some(Arrival::Superseded(receiver.clone())),
        };
        Sender::spawn(&self.session, key, self.mailbox.arrivals(), deliver)
    }

    /// A sender of instructions to an executor.
    fn to_executor(&self, name: &Symbol, key: String) -> Sender {
        let (by, receiver) = (name.clone(), key.clone());
        self.sender(key, move |seq, acknowledgement| {
            let line = acknowledgement.line.unwrap_or_default();
            Some(match acknowledgement.answer {
                Some(answer) => Arrival::Answered(by.clone(), line, seq, answer.into()),
                None => Arrival::Outdated(receiver.clone(), seq),
            })
        })
    }

    /// A sender of reports to a superior.
    fn to_superior(&self, name: &Symbol, key: String) -> Sender {
        let by = name.clone();
        self.sender(key, move |seq, acknowledgement| {
            let line = acknowledgement.line.unwrap_or_default();
            Some(Arrival::Delivered(by.clone(), line, seq))
        })
    }

    /// Whoever has just appeared is sent at once what waits for it.
    pub(crate) fn hurry(&self, name: &str) {
        let senders = [self.to_executors.get(name), self.to_superiors.get(name)];
        // Whose key that is nobody has said.
        let senders = senders.into_iter().chain([self.to_elsewhere.as_ref()]);
        senders.flatten().for_each(Sender::hurry);
    }

    /// Sends what may go out, for a machine whose memory begins in the epoch `line`. Never waits.
    pub(crate) fn send<L>(
        &mut self,
        line: u64,
        effect: Effect<L, ReplyTo>,
        local_as_value: fn(&L) -> Result<Value, WireError>,
    ) -> Result<(), LinkError> {
        match effect {
            Effect::Instruct { to, message } => {
                if !self.to_executors.contains_key(&to) {
                    let key = self.signed(self.wiring.keys.agent(to.as_str())?.instruction())?;
                    let sender = self.to_executor(&to, key);
                    self.to_executors.insert(to.clone(), sender);
                }
                if let Some(sender) = self.to_executors.get(&to) {
                    let message = message.map(|body| Instruction::from(&body));
                    sender.send(message.seq, wire::write(&Message::from(&message))?);
                }
            }
            Effect::StopAhead { to, message } => {
                let key = self.signed(self.wiring.keys.agent(to.as_str())?.instruction())?;
                let message = message.map(|body| Instruction::from(&body));
                let text = wire::write(&Message::from(&message).ahead())?;
                send_ahead(&self.session, key, text);
            }
            Effect::Report { to, message } => {
                if !self.to_superiors.contains_key(&to) {
                    let key = self.signed(self.wiring.keys.agent(to.as_str())?.report())?;
                    let sender = self.to_superior(&to, key);
                    self.to_superiors.insert(to.clone(), sender);
                }
                if let Some(sender) = self.to_superiors.get(&to) {
                    let message = message.map(|body| ReportBody {
                        id: Text(body.id),
                        report: (&body.report).into(),
                    });
                    sender.send(message.seq, wire::write(&Message::from(&message))?);
                }
            }
            Effect::Observed { facts, reported_to } => {
                let message = self.board.tell(&facts, reported_to.as_ref());
                let key = self.wiring.keys.agent(&self.wiring.name)?.facts();
                self.publisher.urgent(key, wire::write(&message)?);
            }
            Effect::Seen {
                to,
                facts,
                reported,
            } => {
                let message = self
                    .board_for(&to)
                    .tell_anew(&facts, reported.then_some(&to));
                let own = self.wiring.keys.agent(&self.wiring.name)?;
                let key = own.facts_for(to.as_str())?;
                self.publisher.urgent(key, wire::write(&message)?);
            }
            Effect::Event { number, event } => {
                let number = EventNumber { line, n: number };
                let line = wire::numbered_event_to_line(&self.wiring.name, Some(number), &event)?;
                self.publisher.put(self.wiring.keys.event(), line);
            }
            Effect::Local(message) if self.wiring.in_team => {
                let said = local_as_value(&message.body)?;
                let key = self.wiring.keys.team(&self.wiring.name)?;
                self.publisher.urgent(key, said.to_string());
            }
            Effect::Local(message) => match &self.to_elsewhere {
                Some(sender) => {
                    let body = local_as_value(&message.body)?;
                    let message = message.map(|_| body);
                    sender.send(message.seq, wire::write(&Message::from(&message))?);
                }
                None => tracing::error!("the wiring has no way out for what the machine says"),
            },
            Effect::Respond { to, response, line } => self.respond(to, response, line),
        }
        Ok(())
    }

    /// That key, or what this machine says on it if its name has to stand there.
    fn signed(&self, key: String) -> Result<String, NameError> {
        match self.wiring.signs {
            true => AgentKeys::by(&key, &self.wiring.name),
            false => Ok(key),
        }
    }

    /// What this machine has told that superior alone.
    fn board_for(&mut self, superior: &Symbol) -> &mut Board {
        let epoch = self.wiring.epoch;
        let boards = self.boards.entry(superior.clone());
        boards.or_insert_with(|| Board::new(epoch))
    }

    /// Publishes a snapshot, unless the network is busy.
    pub(crate) fn snapshot(&self, now: Time, snapshot: Value) {
        let message = json!({
            "v": VERSION, "t_s": now.secs(), "agent": self.wiring.name, "snapshot": snapshot,
        });
        self.publisher
            .latest(self.wiring.keys.world_pose(), message.to_string());
    }

    /// Answers with one of the views into the machine. `journal`: what there is to say of that.
    pub(crate) fn show(
        &self,
        view: View,
        question: Question,
        machine: &impl Inspect,
        journal: Option<Value>,
    ) {
        let mut shown = match view {
            View::Journal => journal.unwrap_or_else(|| json!({})),
            View::Goals => asked_for(view.of(machine), question.text()),
            view => view.of(machine),
        };
        if let (View::Status, Some(trouble), Value::Object(status)) =
            (view, &self.trouble, &mut shown)
        {
            status.insert("journal_trouble".to_owned(), json!(trouble));
        }
        question.answer(wire::write(&json!({
            "v": VERSION, "agent": self.wiring.name, view.name(): shown,
        })));
    }
}

/// Of the goals that one; all of them if none is named.
fn asked_for(goals: Value, id: Option<String>) -> Value {
    match (goals, id) {
        (Value::Array(goals), Some(id)) => {
            let goals = goals.into_iter();
            goals.filter(|goal| goal["id"] == id.as_str()).collect()
        }
        (goals, _) => goals,
    }
}
