//! What is told to whoever listens.

use std::time::Duration;

use tokio::sync::mpsc;
use tokio::task::JoinHandle;
use zenoh::Session;
use zenoh::qos::{CongestionControl, Priority};

/// What may wait for a slow network before something is dropped.
const CAPACITY: usize = 4096;

/// How long the last words may take.
const FINISH_TIMEOUT: Duration = Duration::from_millis(500);

/// Publishes in order, from a task of its own: a network that stands still holds up the task and
/// not the machine.
pub(crate) struct Publisher {
    queue: mpsc::Sender<Publication>,
    task: JoinHandle<()>,
}

struct Publication {
    key: String,
    text: String,
    priority: Priority,
    congestion: CongestionControl,
}

impl Publisher {
    pub(crate) fn new(session: &Session) -> Self {
        let (queue, mut publications) = mpsc::channel::<Publication>(CAPACITY);
        let session = session.clone();
        let task = tokio::spawn(async move {
            while let Some(publication) = publications.recv().await {
                let put = session
                    .put(&publication.key, publication.text)
                    .priority(publication.priority)
                    .congestion_control(publication.congestion)
                    .await;
                if let Err(error) = put {
                    tracing::warn!("cannot publish on {}: {error}", publication.key);
                }
            }
        });
        Self { queue, task }
    }

    /// For people: events, verdicts.
    pub(crate) fn put(&self, key: String, text: String) {
        self.publish(key, text, Priority::Data, CongestionControl::Block);
    }

    /// For machines: in order with what goes over the reliable channels.
    pub(crate) fn urgent(&self, key: String, text: String) {
        self.publish(key, text, Priority::RealTime, CongestionControl::Block);
    }

    /// For pictures: the next one makes good for one that is lost.
    pub(crate) fn latest(&self, key: String, text: String) {
        self.publish(key, text, Priority::Data, CongestionControl::Drop);
    }

    fn publish(
        &self,
        key: String,
        text: String,
        priority: Priority,
        congestion: CongestionControl,
    ) {
        let publication = Publication {
            key,
            text,
            priority,
            congestion,
        };
        if let Err(mpsc::error::TrySendError::Full(lost)) = self.queue.try_send(publication) {
            tracing::warn!(
                "the network is too slow; dropped on {}: {}",
                lost.key,
                lost.text
            );
        }
    }

    /// Publishes what is left.
    pub(crate) async fn finish(self) {
        drop(self.queue);
        if tokio::time::timeout(FINISH_TIMEOUT, self.task)
            .await
            .is_err()
        {
            tracing::warn!("the last events were not published within {FINISH_TIMEOUT:?}");
        }
    }
}
