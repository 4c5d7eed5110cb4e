//! A reliable channel over queries: what is sent is applied once and in order.
//!
//! A query without an answer says nothing about whether it arrived. So the sender asks again, with
//! the same number, until it is answered; and the receiver applies a number once, and gives the
//! same answer again.

use std::time::Duration;

use agent_core::model::Symbol;
use agent_core::protocol::{Envelope, Inbox, Outbox, Receipt};
use serde::Serialize;
use serde_json::Value;
use tokio::sync::mpsc;
use tokio::task::JoinHandle;
use zenoh::Session;
use zenoh::qos::{CongestionControl, Priority};
use zenoh::query::ConsolidationMode;

use crate::question::Question;
use crate::wire::{self, Acknowledgement, Answer, Message, WireError};

/// After this long a query counts as unanswered.
const QUERY_TIMEOUT: Duration = Duration::from_secs(1);

/// Between two attempts, growing from the first to the second.
const BACK_OFF: (Duration, Duration) = (Duration::from_millis(50), Duration::from_millis(200));

/// After this many attempts people are told that a neighbour does not answer.
const ATTEMPTS_BEFORE_WARNING: u32 = 10;

/// What has become of a message that was sent.
#[derive(Debug)]
pub enum Delivery<T> {
    /// It was applied; an instruction, with this answer.
    Applied(T, Option<Answer>),
    /// The receiver listens to a later start of this sender, which has to end.
    Superseded,
}

/// Sends to one receiver, oldest first, until each message is acknowledged.
pub struct Sender<T> {
    queue: mpsc::UnboundedSender<T>,
    task: JoinHandle<()>,
}

impl<T: Clone + Serialize + Send + Sync + 'static> Sender<T> {
    /// Starts sending to `key`. `deliver` gets what has become of each message, in order; it is
    /// awaited, so that nothing is lost to a receiver that is busy.
    pub fn spawn<A: Send + 'static>(
        session: &Session,
        key: String,
        from: Symbol,
        epoch: u64,
        arrivals: mpsc::Sender<A>,
        deliver: impl Fn(Delivery<T>) -> Option<A> + Send + 'static,
    ) -> Self {
        let (queue, incoming) = mpsc::unbounded_channel();
        let work = Work {
            session: session.clone(),
            key,
            from,
            epoch,
            outbox: Outbox::default(),
            incoming,
        };
        let task = tokio::spawn(async move {
            let mut work = work;
            while let Some(delivery) = work.next_delivery().await {
                let over = matches!(delivery, Delivery::Superseded);
                if let Some(arrival) = deliver(delivery)
                    && arrivals.send(arrival).await.is_err()
                {
                    return;
                }
                if over {
                    return;
                }
            }
        });
        Self { queue, task }
    }

    /// Sends `body` after all that was sent before.
    pub fn send(&self, body: T) {
        // The task ends only when the sender is superseded or dropped; then nothing is to be sent.
        let _ = self.queue.send(body);
    }
}

impl<T> Drop for Sender<T> {
    fn drop(&mut self) {
        self.task.abort();
    }
}

/// The sending task.
struct Work<T> {
    session: Session,
    key: String,
    from: Symbol,
    epoch: u64,
    outbox: Outbox<T>,
    incoming: mpsc::UnboundedReceiver<T>,
}

impl<T: Clone + Serialize> Work<T> {
    /// Gets the oldest message through. `None` once nothing more can come.
    async fn next_delivery(&mut self) -> Option<Delivery<T>> {
        if self.outbox.waiting().next().is_none() {
            self.outbox.push(self.incoming.recv().await?);
        }
        while let Ok(body) = self.incoming.try_recv() {
            self.outbox.push(body);
        }
        let (seq, body) = self.outbox.waiting().next()?;
        let envelope = Envelope {
            from: self.from.clone(),
            line: self.epoch,
            epoch: self.epoch,
            seq,
            settled: seq - 1,
            body: body.clone(),
        };
        let text = match wire::write(&Message::from(&envelope)) {
            Ok(text) => text,
            Err(error) => {
                // The wire types have no value that cannot be written.
                tracing::error!("cannot write a message to {}: {error}", self.key);
                return None;
            }
        };
        let mut attempts = 0;
        let mut back_off = BACK_OFF.0;
        loop {
            let trouble = match self.attempt(&text, seq).await {
                Ok(Some(answer)) => {
                    if attempts >= ATTEMPTS_BEFORE_WARNING {
                        tracing::info!("{} answers again", self.key);
                    }
                    let body = self.outbox.acknowledge(seq)?;
                    return Some(Delivery::Applied(body, answer.answer));
                }
                Ok(None) => return Some(Delivery::Superseded),
                Err(trouble) => trouble,
            };
            attempts += 1;
            if attempts == ATTEMPTS_BEFORE_WARNING {
                tracing::warn!("{} does not take message {seq}: {trouble}", self.key);
            }
            tokio::time::sleep(back_off).await;
            back_off = (back_off * 2).min(BACK_OFF.1);
        }
    }

    /// Asks once. `Ok(None)`: this sender is superseded. `Err`: nobody knows, or not yet.
    async fn attempt(&self, text: &str, seq: u64) -> Result<Option<Acknowledgement>, String> {
        let replies = self
            .session
            .get(&self.key)
            .payload(text)
            .congestion_control(CongestionControl::Block)
            .priority(Priority::RealTime)
            .consolidation(ConsolidationMode::None)
            .timeout(QUERY_TIMEOUT)
            .await
            .map_err(|error| error.to_string())?;
        let Ok(reply) = replies.recv_async().await else {
            return Err("no answer".to_owned());
        };
        let sample = reply
            .result()
            .map_err(|error| String::from_utf8_lossy(&error.payload().to_bytes()).into_owned())?;
        let answer: Acknowledgement = wire::read("answer", &sample.payload().to_bytes())
            .map_err(|error| error.to_string())?;
        match &answer.refused {
            Some(refusal) if refusal.superseded => Ok(None),
            Some(refusal) => Err(refusal.reason.clone()),
            None if answer.seq == Some(seq) => Ok(Some(answer)),
            None => Err("an answer to another message".to_owned()),
        }
    }
}

/// A message that is to be applied, and the way back to whoever sent it.
#[derive(Debug)]
pub struct Received {
    /// Sender and number, without the content.
    head: Envelope<()>,
    /// The way back.
    question: Question,
}

impl Received {
    /// Who sent it.
    pub fn from(&self) -> &Symbol {
        &self.head.from
    }
}

/// Receives from any number of senders.
#[derive(Default)]
pub struct Receiver {
    inbox: Inbox<Answer>,
}

impl Receiver {
    /// The content of a message that is to be applied now; then call [`applied`](Self::applied).
    /// `None`: it was seen to here, applied before or refused.
    pub fn open(&self, what: &'static str, question: Question) -> Option<(Value, Received)> {
        let message: Message<Value> = match question
            .content(what, wire::AGENT_LIMIT_BYTES)
            .and_then(|bytes| wire::read(what, &bytes))
        {
            Ok(message) => message,
            Err(error) => {
                tracing::warn!("{error}");
                acknowledge(question, &Acknowledgement::refused(None, error));
                return None;
            }
        };
        let envelope = Envelope::from(message);
        let seq = envelope.seq;
        match self.inbox.receive(&envelope) {
            Receipt::New { .. } => {}
            Receipt::Again(answer) => {
                acknowledge(question, &Acknowledgement::applied(seq, answer));
                return None;
            }
            Receipt::Old => {
                acknowledge(question, &Acknowledgement::superseded(seq));
                return None;
            }
            Receipt::Gap { due } => {
                let reason = format_args!("message {due} is due, not {seq}");
                acknowledge(question, &Acknowledgement::refused(Some(seq), reason));
                return None;
            }
        }
        let Envelope {
            from,
            line,
            epoch,
            settled,
            body,
            ..
        } = envelope;
        let head = Envelope {
            from,
            line,
            epoch,
            seq,
            settled,
            body: (),
        };
        Some((body, Received { head, question }))
    }

    /// As [`open`](Self::open), with the content as what `read` makes of it. What makes no sense here is
    /// refused, and will come again: nothing that a sender says may be lost.
    pub fn open_as<T>(
        &self,
        what: &'static str,
        question: Question,
        read: impl FnOnce(Value) -> Result<T, WireError>,
    ) -> Option<(T, Received)> {
        let (content, received) = self.open(what, question)?;
        match read(content) {
            Ok(content) => Some((content, received)),
            Err(error) => {
                tracing::warn!("from {}: {error}", received.head.from);
                let seq = Some(received.head.seq);
                acknowledge(received.question, &Acknowledgement::refused(seq, error));
                None
            }
        }
    }

    /// The message was applied; to an instruction this is the answer.
    pub fn applied(&mut self, received: Received, answer: Option<Answer>) {
        self.inbox.applied(&received.head, answer.clone());
        let seq = received.head.seq;
        acknowledge(received.question, &Acknowledgement::applied(seq, answer));
    }
}

fn acknowledge(question: Question, answer: &Acknowledgement) {
    question.answer(wire::write(answer));
}
