//! The one loop: the only code of this project that waits for what happens next.

use std::convert::Infallible;
use std::future::Future;
use std::pin::pin;
use std::time::Duration;

use agent_core::model::Time;
use agent_core::protocol::{Input, Machine};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use tokio::time::{Interval, MissedTickBehavior};
use zenoh::Session;

use crate::clock::Clock;
use crate::incoming::ReplyTo;
use crate::inspect::Inspect;
use crate::link::Link;
use crate::mailbox::Arrival;
use crate::wire::{self, WireError};
pub use crate::wiring::{LinkError, Wiring};

/// Drives `machine` until `shutdown`, and gives it back.
///
/// What has come in is taken before the machine thinks on: an emergency never waits for a plan.
pub async fn drive<M>(
    machine: M,
    wiring: Wiring,
    session: &Session,
    clock: Clock,
    shutdown: impl Future<Output = ()>,
) -> Result<M, LinkError>
where
    M: Machine + Inspect,
    M::In: DeserializeOwned,
    M::Out: Serialize,
{
    let local = Local {
        read: |value| wire::body("message", value),
        write: wire::to_value,
    };
    run(machine, wiring, session, clock, shutdown, local).await
}

/// As [`drive`], for an agent, which hears from and tells nobody but superiors and executors.
pub async fn drive_agent<M>(
    machine: M,
    wiring: Wiring,
    session: &Session,
    clock: Clock,
    shutdown: impl Future<Output = ()>,
) -> Result<M, LinkError>
where
    M: Machine<In = Infallible, Out = Infallible> + Inspect,
{
    let local = Local {
        read: |_| Err(WireError::malformed("message", "nothing is expected here")),
        write: |never: &Infallible| match *never {},
    };
    run(machine, wiring, session, clock, shutdown, local).await
}

/// How [`Input::Local`] and its counterpart travel.
struct Local<M: Machine> {
    read: fn(Value) -> Result<M::In, WireError>,
    write: fn(&M::Out) -> Result<Value, WireError>,
}

async fn run<M: Machine + Inspect>(
    mut machine: M,
    wiring: Wiring,
    session: &Session,
    clock: Clock,
    shutdown: impl Future<Output = ()>,
    local: Local<M>,
) -> Result<M, LinkError> {
    let mut snapshots = wiring.snapshots_every.map(every);
    let (mut link, mut arrivals) = Link::open(session, wiring).await?;
    let mut shutdown = pin!(shutdown);
    let result = loop {
        if let Err(error) = drain(&mut machine, &mut link, local.write) {
            break Err(error);
        }
        let arrival = tokio::select! {
            biased;
            () = &mut shutdown => break Ok(()),
            Some(arrival) = arrivals.recv() => Some(arrival),
            () = tick(snapshots.as_mut()) => {
                link.snapshot(clock.now(), machine.snapshot());
                continue;
            }
            () = wake(&clock, machine.wake_at()) => None,
        };
        let (input, sender) = match arrival {
            None => (Input::Wake, ReplyTo::Nobody),
            Some(Arrival::Look(view, question)) => {
                question.answer(link.view(view, &machine));
                continue;
            }
            Some(Arrival::Superseded(key)) => {
                let name = link.wiring.name.clone();
                break Err(LinkError::Superseded { name, key });
            }
            Some(arrival) => match link.read(arrival, local.read) {
                Some(input) => input,
                None => continue,
            },
        };
        let reply = machine.handle(clock.now(), input);
        link.reply(sender, reply);
    };
    link.close().await;
    result.map(|()| machine)
}

/// Sends all that the machine has decided.
fn drain<M: Machine>(
    machine: &mut M,
    link: &mut Link,
    local: fn(&M::Out) -> Result<Value, WireError>,
) -> Result<(), LinkError> {
    while let Some(output) = machine.poll_output() {
        link.send(output, local)?;
    }
    Ok(())
}

/// When the machine is to be woken. Never, if it has no wish; if the time has passed already, as
/// soon as everything else had its chance.
async fn wake(clock: &Clock, at: Option<Time>) {
    match at {
        None => std::future::pending().await,
        Some(at) if at <= clock.now() => tokio::task::yield_now().await,
        Some(at) => clock.sleep_until(at).await,
    }
}

/// A period of nothing would never let anything else happen.
const SHORTEST_PERIOD: Duration = Duration::from_millis(1);

fn every(period: Duration) -> Interval {
    let mut interval = tokio::time::interval(period.max(SHORTEST_PERIOD));
    interval.set_missed_tick_behavior(MissedTickBehavior::Skip);
    interval
}

async fn tick(interval: Option<&mut Interval>) {
    match interval {
        None => std::future::pending().await,
        Some(interval) => {
            interval.tick().await;
        }
    }
}
