//! What has come in and was not looked at yet, in two lanes.
//!
//! What agents say to each other must not be crowded out by what users ask for, however much that
//! is: an instruction to stop waits behind no flood. And a machine that answers users all the time
//! would never come to think.

use std::time::{Duration, Instant};

use tokio::sync::mpsc::{self, Receiver, Sender};

use crate::mailbox::{Arrival, Asked};
use crate::quota::{Meter, Rate};
use crate::wire::{self, CommandVerdict};

/// What may wait to be seen to. A machine sees to thousands in a second.
const FROM_AGENTS: usize = 1024;

/// Users get an answer rather than a long wait.
const FROM_USERS: usize = 256;

/// So much of what users ask for is looked at in a second.
const USERS_PER_S: f64 = 500.0;

/// What falls due in this time may come at once: so long a machine may be kept from thinking.
const BURST: Duration = Duration::from_millis(200);

/// Where arrivals are put.
#[derive(Clone, Debug)]
pub(crate) struct Lane(Sender<Arrival>);

/// Where arrivals are taken from.
pub(crate) struct Arrivals {
    agents: Receiver<Arrival>,
    users: Receiver<Arrival>,
    meter: Meter,
    rate: Option<Rate>,
    opened: Instant,
}

/// The lane of the agents, that of the users, and both from the other end.
pub(crate) fn lanes() -> (Lane, Lane, Arrivals) {
    let (from_agents, agents) = mpsc::channel(FROM_AGENTS);
    let (from_users, users) = mpsc::channel(FROM_USERS);
    let arrivals = Arrivals {
        agents,
        users,
        meter: Meter::default(),
        rate: Rate::per_second(USERS_PER_S).map(|rate| rate.at_once(BURST)),
        opened: Instant::now(),
    };
    (Lane(from_agents), Lane(from_users), arrivals)
}

impl Lane {
    /// Puts an arrival at the end. Where there is no room it is dropped: agents say what counts
    /// until it is acknowledged, and users who wait for an answer are told.
    pub(crate) fn deliver(&self, arrival: Arrival) {
        // A closed queue is that of a machine that has ended.
        let Err(mpsc::error::TrySendError::Full(arrival)) = self.0.try_send(arrival) else {
            return;
        };
        match arrival {
            Arrival::Goal(_, _, Asked::Query(question))
            | Arrival::Command(question)
            | Arrival::Facts(Asked::Query(question)) => {
                let busy = format_args!(
                    "more than {FROM_USERS} messages wait to be looked at; ask again later"
                );
                question.answer(wire::write(&CommandVerdict::new(&Err(busy))));
            }
            Arrival::Goal(..) | Arrival::Facts(_) | Arrival::Look(..) => {
                tracing::debug!("more than {FROM_USERS} messages of users wait; one is dropped");
            }
            other => {
                tracing::warn!("more than {FROM_AGENTS} messages wait; one is dropped: {other:?}");
            }
        }
    }

    /// The end of this lane, for whoever may wait until there is room.
    pub(crate) fn sender(&self) -> Sender<Arrival> {
        self.0.clone()
    }
}

impl Arrivals {
    /// The next arrival, of the agents if there is one. `None` once there can be no more.
    pub(crate) async fn recv(&mut self) -> Option<Arrival> {
        let now = self.opened.elapsed();
        let wait = self.rate.map(|rate| self.meter.wait(now, rate));
        let of_user = async {
            // Some senders are asked for nothing for a while when they have asked for very much.
            if let Some(wait) = wait.filter(|wait| !wait.is_zero()) {
                tokio::time::sleep(wait + Duration::from_millis(1)).await;
            }
            self.users.recv().await
        };
        tokio::select! {
            biased;
            Some(arrival) = self.agents.recv() => Some(arrival),
            Some(arrival) = of_user => {
                if let Some(rate) = self.rate {
                    self.meter.take(self.opened.elapsed(), rate);
                }
                Some(arrival)
            }
            else => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use zenoh::bytes::ZBytes;

    fn fact() -> Arrival {
        Arrival::Facts(Asked::Put(ZBytes::from("(open door3_5)")))
    }

    #[tokio::test]
    async fn what_agents_say_goes_before_any_flood_of_users() {
        let (agents, users, mut arrivals) = lanes();
        for _ in 0..10 * FROM_USERS {
            users.deliver(fact());
        }
        for epoch in 0..3 {
            agents.deliver(Arrival::Neighbour {
                name: "child".to_owned(),
                epoch,
                line: epoch,
                appeared: true,
            });
        }
        for expected in 0..3 {
            let first = arrivals.recv().await;
            assert!(
                matches!(first, Some(Arrival::Neighbour { epoch, .. }) if epoch == expected),
                "{first:?}"
            );
        }
        drop((agents, users));
        let mut of_users = 0;
        while let Some(arrival) = arrivals.recv().await {
            assert!(matches!(arrival, Arrival::Facts(_)));
            of_users += 1;
        }
        assert_eq!(of_users, FROM_USERS);
    }
}
