//! The bare round trip: a message to another client and back, through the router, and nothing else.

use std::time::{Duration, Instant};

use agent_link::Session;
use tokio::sync::mpsc;
use zenoh::Wait;
use zenoh::pubsub::Subscriber;

use crate::exit::Failure;

/// Longer, and the message was lost.
const PATIENCE: Duration = Duration::from_secs(5);

/// A client with another one that sends back whatever it is sent.
pub(super) struct Bare {
    session: Session,
    there: String,
    back: mpsc::UnboundedReceiver<(Instant, Vec<u8>)>,
    sent: u64,
    _subscribers: [Subscriber<()>; 2],
}

impl Bare {
    /// Between two sessions that are clients of the same router, on keys under `prefix`.
    pub(super) async fn between(
        session: &Session,
        other: &Session,
        prefix: &str,
    ) -> Result<Self, Failure> {
        let (there, back_key) = (format!("{prefix}/there"), format!("{prefix}/back"));
        let answering = other.clone();
        let key = back_key.clone();
        let echo = other
            .declare_subscriber(&there)
            .callback(move |sample| {
                // As zenoh's own ping-pong does it: right where it was received.
                let _ = answering.put(&key, sample.payload().clone()).wait();
            })
            .await
            .map_err(Failure::failed)?;
        let (tell, back) = mpsc::unbounded_channel();
        let listening = session
            .declare_subscriber(&back_key)
            .callback(move |sample| {
                let _ = tell.send((Instant::now(), sample.payload().to_bytes().into_owned()));
            })
            .await
            .map_err(Failure::failed)?;
        let mut bare = Self {
            session: session.clone(),
            there,
            back,
            sent: 0,
            _subscribers: [echo, listening],
        };
        // The router has heard of both subscribers when the first one comes back.
        let first = tokio::time::timeout(PATIENCE, async {
            while bare.once(Duration::from_millis(100)).await.is_none() {}
        });
        first
            .await
            .map_err(|_| Failure::failed("no message comes back from the router"))?;
        Ok(bare)
    }

    /// One round trip, of a message as large as an emergency. `None` if nothing came back.
    pub(super) async fn round_trip(&mut self) -> Option<Duration> {
        self.once(PATIENCE).await
    }

    async fn once(&mut self, patience: Duration) -> Option<Duration> {
        self.sent += 1;
        let text = format!("{:096}", self.sent);
        let begun = Instant::now();
        self.session
            .put(&self.there, text.clone().into_bytes())
            .await
            .ok()?;
        let back = async {
            while let Some((at, echoed)) = self.back.recv().await {
                if echoed == text.as_bytes() {
                    return Some(at.duration_since(begun));
                }
            }
            None
        };
        tokio::time::timeout(patience, back).await.ok().flatten()
    }
}
