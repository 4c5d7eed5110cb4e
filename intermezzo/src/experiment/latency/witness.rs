//! What a client hears of a robot, with the time at which it was heard.

use agent_core::model::{Symbol, Time};
use agent_core::protocol::Event;
use agent_link::{Clock, Keys, Session, wire};
use executor_sim::Motion;
use serde::Deserialize;
use tokio::sync::mpsc;
use zenoh::pubsub::Subscriber;

use crate::exit::Failure;

/// Something was heard.
#[derive(Clone, Debug)]
pub(super) enum Heard {
    /// An agent has told that.
    Event(Symbol, Event),
    /// The world has shown a body that does this since then.
    Seen { motion: Motion, since: Time },
}

/// Hears all that a robot tells.
pub(super) struct Witness {
    heard: mpsc::UnboundedReceiver<(Time, Heard)>,
    _subscribers: [Subscriber<()>; 2],
}

#[derive(Deserialize)]
struct Picture {
    snapshot: Shown,
}

/// What the world shows of itself, as far as it is needed here.
#[derive(Deserialize)]
struct Shown {
    motion: Motion,
    motion_since_t_s: f64,
}

impl Witness {
    /// From now on.
    pub(super) async fn of(session: &Session, keys: &Keys, clock: Clock) -> Result<Self, Failure> {
        let (tell, heard) = mpsc::unbounded_channel();
        let tell_event = tell.clone();
        let events = session
            .declare_subscriber(keys.event())
            .callback(move |sample| {
                let at = clock.now();
                if let Ok((agent, _, event)) =
                    wire::numbered_event_from_line(&sample.payload().to_bytes())
                {
                    let _ = tell_event.send((at, Heard::Event(agent, event)));
                }
            })
            .await
            .map_err(Failure::failed)?;
        let pictures = session
            .declare_subscriber(keys.world_pose())
            .callback(move |sample| {
                let at = clock.now();
                if let Ok(picture) = serde_json::from_slice::<Picture>(&sample.payload().to_bytes())
                {
                    let Shown {
                        motion,
                        motion_since_t_s,
                    } = picture.snapshot;
                    let since = Time::from_secs(motion_since_t_s);
                    let _ = tell.send((at, Heard::Seen { motion, since }));
                }
            })
            .await
            .map_err(Failure::failed)?;
        Ok(Self {
            heard,
            _subscribers: [events, pictures],
        })
    }

    /// The next, and when it was heard. `None` once there can be no more.
    pub(super) async fn next(&mut self) -> Option<(Time, Heard)> {
        self.heard.recv().await
    }
}
