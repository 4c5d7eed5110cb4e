//! A reliable channel over queries: what is sent is applied once and in order.
//!
//! A query without an answer says nothing about whether it arrived. So the sender asks again, with
//! the same number, until it is answered; and the receiver applies a number once, and gives the
//! same answer again. Numbers, and what was received, are the business of the
//! [`Station`](agent_core::protocol::Station): they outlive the process.

use std::sync::Arc;
use std::time::Duration;

use tokio::sync::{Notify, mpsc};
use tokio::task::JoinHandle;
use zenoh::Session;
use zenoh::qos::{CongestionControl, Priority};
use zenoh::query::ConsolidationMode;

use crate::wire::{self, Acknowledgement};

/// After this long a query counts as unanswered.
const QUERY_TIMEOUT: Duration = Duration::from_secs(1);

/// Between two attempts, growing from the first to the second.
const BACK_OFF: (Duration, Duration) = (Duration::from_millis(50), Duration::from_millis(200));

/// After this many attempts people are told that a neighbour does not answer.
const ATTEMPTS_BEFORE_WARNING: u32 = 10;

/// What has become of a message that was sent.
#[derive(Debug)]
pub enum Delivery {
    /// That number was applied.
    Applied(u64, Acknowledgement),
    /// The receiver listens to a later start of this sender, which has to end.
    Superseded,
}

/// A numbered message, as it travels.
#[derive(Debug)]
struct Outgoing {
    seq: u64,
    text: String,
}

/// Sends to one receiver, in order, until each message is acknowledged.
pub struct Sender {
    queue: mpsc::UnboundedSender<Outgoing>,
    /// The receiver is there anew.
    appeared: Arc<Notify>,
    task: JoinHandle<()>,
}

impl Sender {
    /// Starts sending to `key`. `deliver` gets what has become of each message, in order; it is
    /// awaited, so that nothing is lost to a receiver that is busy.
    pub fn spawn<A: Send + 'static>(
        session: &Session,
        key: String,
        arrivals: mpsc::Sender<A>,
        deliver: impl Fn(Delivery) -> Option<A> + Send + 'static,
    ) -> Self {
        let (queue, mut incoming) = mpsc::unbounded_channel();
        let appeared = Arc::new(Notify::new());
        let work = Work {
            session: session.clone(),
            key,
            appeared: appeared.clone(),
        };
        let task = tokio::spawn(async move {
            while let Some(message) = incoming.recv().await {
                let delivery = work.deliver(message).await;
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
        Self {
            queue,
            appeared,
            task,
        }
    }

    /// The receiver has just appeared: whoever pauses before the next attempt pauses no longer.
    pub fn hurry(&self) {
        self.appeared.notify_one();
    }

    /// Sends a message after all that was sent before.
    pub fn send(&self, seq: u64, text: String) {
        // The task ends only when the sender is superseded or dropped; then nothing is to be sent.
        let _ = self.queue.send(Outgoing { seq, text });
    }
}

impl Drop for Sender {
    fn drop(&mut self) {
        self.task.abort();
    }
}

/// Sends a message once and at once, before all that waits. Nobody answers it.
pub fn send_ahead(session: &Session, key: String, text: String) {
    let session = session.clone();
    tokio::spawn(async move {
        let sent = session
            .get(&key)
            .payload(text)
            .congestion_control(CongestionControl::Block)
            .priority(Priority::RealTime)
            .consolidation(ConsolidationMode::None)
            .timeout(QUERY_TIMEOUT)
            .callback(|_| {})
            .await;
        if let Err(error) = sent {
            tracing::warn!("cannot send ahead to {key}: {error}");
        }
    });
}

/// The sending task.
struct Work {
    session: Session,
    key: String,
    appeared: Arc<Notify>,
}

impl Work {
    /// Gets a message through, however long that takes.
    async fn deliver(&self, Outgoing { seq, text }: Outgoing) -> Delivery {
        let mut attempts = 0;
        let mut back_off = BACK_OFF.0;
        loop {
            let trouble = match self.attempt(&text, seq).await {
                Ok(Some(answer)) => {
                    if attempts >= ATTEMPTS_BEFORE_WARNING {
                        tracing::info!("{} answers again", self.key);
                    }
                    return Delivery::Applied(seq, answer);
                }
                Ok(None) => return Delivery::Superseded,
                Err(trouble) => trouble,
            };
            attempts += 1;
            if attempts == ATTEMPTS_BEFORE_WARNING {
                tracing::warn!("{} does not take message {seq}: {trouble}", self.key);
            }
            back_off = pause(&self.appeared, back_off).await;
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

/// Lets `back_off` pass, unless the receiver appears before. Returns how long the next pause is.
async fn pause(appeared: &Notify, back_off: Duration) -> Duration {
    tokio::select! {
        () = tokio::time::sleep(back_off) => (back_off * 2).min(BACK_OFF.1),
        () = appeared.notified() => BACK_OFF.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_receiver_that_appears_ends_the_pause_also_if_that_has_not_begun() {
        let appeared = Notify::new();
        let hour = Duration::from_secs(3600);
        let patience = Duration::from_secs(30);
        appeared.notify_one();
        let next = tokio::time::timeout(patience, pause(&appeared, hour)).await;
        assert_eq!(next, Ok(BACK_OFF.0));
        let (next, ()) = tokio::join!(
            tokio::time::timeout(patience, pause(&appeared, hour)),
            async { appeared.notify_one() },
        );
        assert_eq!(next, Ok(BACK_OFF.0));
    }

    #[tokio::test]
    async fn pauses_grow_up_to_the_longest() {
        let nobody = Notify::new();
        let mut pauses = vec![BACK_OFF.0 / 50];
        for _ in 0..8 {
            pauses.push(pause(&nobody, pauses[pauses.len() - 1]).await);
        }
        assert!(
            pauses
                .windows(2)
                .all(|two| two[0] < two[1] || two[1] == BACK_OFF.1)
        );
        assert_eq!(pauses.last(), Some(&BACK_OFF.1));
    }
}
