//! The one loop: the only code of this project that waits for what happens next.

use std::convert::Infallible;
use std::future::Future;
use std::pin::pin;
use std::time::Duration;

use agent_core::model::{Symbol, Time};
use agent_core::protocol::{Arrival, Durable, Input, Rows, Station};
use agent_core::service;
use agent_journal::Journal;
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use tokio::time::{Instant, Interval, MissedTickBehavior};
use zenoh::Session;

use crate::clock::Clock;
use crate::incoming::{ForAny, ReplyTo};
use crate::inspect::Inspect;
use crate::link::Link;
use crate::mailbox;
use crate::wire::{self, WireError};
pub use crate::wiring::{LinkError, Wiring};
use crate::writer::Writer;

/// What moves when a machine is to end comes to rest within this, in seconds of everybody.
const LAST_MOTIONS: Duration = Duration::from_secs(3);

/// The last commit may take this long.
const LAST_WORDS: Duration = Duration::from_secs(2);

/// A journal, and what was in it when it was opened. Without one, a machine forgets everything when
/// its process ends.
pub type Memory = Option<(Journal, Rows)>;

/// Drives `machine`, which has just been made, until `shutdown`, and gives it back. Before, it
/// recalls what one of its name has written down.
///
/// What has come in is taken before the machine thinks on: an emergency never waits for a plan.
///
/// # Errors
/// If what was written down does not fit the machine, or another process has taken its place.
pub async fn drive<M>(
    machine: M,
    memory: Memory,
    wiring: Wiring,
    session: &Session,
    clock: Clock,
    shutdown: impl Future<Output = ()>,
) -> Result<M, LinkError>
where
    M: Durable + Inspect,
    M::In: DeserializeOwned,
    M::Out: Serialize + Clone,
{
    let local = Local {
        read: |value| wire::body("message", value),
        write: wire::to_value,
        for_any: None,
    };
    run(machine, memory, wiring, session, clock, shutdown, local).await
}

/// As [`drive`], for an agent, which hears from and tells nobody but superiors and executors.
///
/// # Errors
/// As [`drive`].
pub async fn drive_agent<M>(
    machine: M,
    memory: Memory,
    wiring: Wiring,
    session: &Session,
    clock: Clock,
    shutdown: impl Future<Output = ()>,
) -> Result<M, LinkError>
where
    M: Durable<In = Infallible, Out = Infallible> + Inspect,
{
    let local = Local {
        read: |_| Err(WireError::malformed("message", "nothing is expected here")),
        write: |never: &Infallible| match *never {},
        for_any: None,
    };
    run(machine, memory, wiring, session, clock, shutdown, local).await
}

/// As [`drive`], for one of a team of vehicles.
///
/// # Errors
/// As [`drive`].
pub async fn drive_vehicle<M>(
    machine: M,
    memory: Memory,
    wiring: Wiring,
    session: &Session,
    clock: Clock,
    shutdown: impl Future<Output = ()>,
) -> Result<M, LinkError>
where
    M: Durable<In = service::Message, Out = service::Message> + Inspect,
{
    let local = Local {
        read: wire::service_from_wire,
        write: wire::service_to_wire,
        for_any: Some(|goal| service::Message {
            by: Symbol::from("user"),
            at: Time::ZERO,
            body: service::Body::Goal(goal),
        }),
    };
    run(machine, memory, wiring, session, clock, shutdown, local).await
}

/// How [`Input::Local`] and its counterpart travel.
struct Local<M: Durable> {
    read: fn(Value) -> Result<M::In, WireError>,
    write: fn(&M::Out) -> Result<Value, WireError>,
    /// How goals come in that are for nobody in particular, if not as others.
    for_any: Option<ForAny<M::In>>,
}

async fn run<M>(
    machine: M,
    memory: Memory,
    wiring: Wiring,
    session: &Session,
    clock: Clock,
    shutdown: impl Future<Output = ()>,
    local: Local<M>,
) -> Result<M, LinkError>
where
    M: Durable + Inspect,
    M::Out: Clone,
{
    let (mut station, mut writer) = recall(machine, memory, &wiring)?;
    let mut snapshots = wiring.snapshots_every.map(every);
    let waits_for_the_disk = wiring.waits_for_the_disk;
    let (mut link, mut arrivals) = Link::open(session, wiring, station.line()).await?;
    let mut shutdown = pin!(shutdown);
    // Once it is to end: when it does so at the latest.
    let mut last: Option<Instant> = None;
    let result = loop {
        // What stops something goes out before anything is made ready for the journal.
        if let Err(error) = send(&mut station, &mut link, local.write) {
            break Err(error);
        }
        write(&mut station, writer.as_mut(), &mut link, waits_for_the_disk);
        if let Err(error) = send(&mut station, &mut link, local.write) {
            break Err(error);
        }
        if snapshots.is_some() && station.machine().is_worth_showing() {
            link.snapshot(clock.now(), station.machine().snapshot());
        }
        if last.is_some() && station.machine().rests() {
            break Ok(());
        }
        let arrival = tokio::select! {
            biased;
            () = &mut shutdown, if last.is_none() => {
                last = Some(Instant::now() + LAST_MOTIONS);
                station.wind_down(clock.now());
                continue;
            }
            () = until(last) => {
                tracing::warn!("{} ends, and has not come to rest", link.wiring.name);
                break Ok(());
            }
            written = written(writer.as_mut()) => {
                match written {
                    Ok(()) => station.written(),
                    Err(error) => tracing::warn!("{error}"),
                }
                continue;
            }
            Some(arrival) = arrivals.recv() => Some(arrival),
            () = tick(snapshots.as_mut()) => {
                link.snapshot(clock.now(), station.machine().snapshot());
                continue;
            }
            () = wake(&clock, station.wake_at()) => None,
        };
        let (arrival, sender) = match arrival {
            None => (Arrival::Input(Input::Wake), None),
            Some(mailbox::Arrival::Look(view, question)) => {
                let journal = writer.as_ref().map(|writer| writer.view(station.held()));
                link.show(view, question, station.machine(), journal);
                continue;
            }
            Some(mailbox::Arrival::Superseded(key)) => {
                let name = link.wiring.name.clone();
                break Err(LinkError::Superseded { name, key });
            }
            Some(mailbox::Arrival::Outdated(key, seq)) => {
                let name = link.wiring.name.clone();
                break Err(LinkError::Outdated { name, key, seq });
            }
            // Nothing is begun any more; whoever asks is answered after the next start.
            Some(arrival) if last.is_some() && !matches!(arrival, mailbox::Arrival::Local(_)) => {
                continue;
            }
            Some(arrival) => match link.read(arrival, local.read, local.for_any) {
                Some(arrival) => arrival,
                None => continue,
            },
        };
        station.handle(clock.now(), arrival, sender);
    };
    link.close().await;
    if let Some(mut writer) = writer {
        let written = tokio::time::timeout(LAST_WORDS, write_last(&mut station, &mut writer));
        if written.await.is_err() {
            tracing::warn!("the journal could not be written within {LAST_WORDS:?}");
        }
        writer.finish().await;
    }
    result.map(|()| station.into_machine())
}

/// The machine as it was when it wrote last.
fn recall<M>(
    machine: M,
    memory: Memory,
    wiring: &Wiring,
) -> Result<(Station<M, ReplyTo>, Option<Writer>), LinkError>
where
    M: Durable,
    M::Out: Clone,
{
    let name = Symbol::from(wiring.name.as_str());
    let Some((journal, rows)) = memory else {
        return Ok((Station::new(name, wiring.epoch, machine), None));
    };
    let place = journal.name();
    let station = if wiring.waits_for_the_disk {
        Station::recall(name, wiring.epoch, machine, &rows)
    } else {
        // It has acknowledged what it had not written, so its mailboxes are not to be trusted:
        // neighbours are to see that it has begun anew.
        let mut machine = machine;
        machine
            .recall(&rows)
            .map(|()| Station::new(name, wiring.epoch, machine))
    };
    match station {
        Ok(station) => {
            let writer = Writer::start(journal).map_err(LinkError::Thread)?;
            Ok((station, Some(writer)))
        }
        Err(why) => Err(LinkError::Unreadable { place, why }),
    }
}

/// Has written down what is different, as soon as the last is on the disk.
fn write<M>(
    station: &mut Station<M, ReplyTo>,
    writer: Option<&mut Writer>,
    link: &mut Link,
    waits_for_the_disk: bool,
) where
    M: Durable,
    M::Out: Clone,
{
    if let Some(writer) = writer {
        if writer.is_idle()
            && station.wants_writing()
            && let Some(rows) = station.write_down()
        {
            writer.begin(rows);
        }
        link.trouble = writer.trouble().map(ToString::to_string);
        if waits_for_the_disk {
            if let Some(trouble) = &link.trouble {
                for sender in station.refuse_waiting() {
                    link.not_written(sender, trouble);
                }
            }
            return;
        }
    }
    station.release();
}

/// Has written down how things are at the end: what a machine does by itself is worth no commit while it
/// runs.
async fn write_last<M>(station: &mut Station<M, ReplyTo>, writer: &mut Writer)
where
    M: Durable,
    M::Out: Clone,
{
    if !writer.is_idle() {
        match writer.next().await {
            Ok(()) => station.written(),
            // It was said when it happened; the next start goes on from what was written before.
            Err(_) => return,
        }
    }
    if let Some(rows) = station.write_down() {
        writer.begin(rows);
        let _ = writer.next().await;
    }
}

/// Returns at that time; never, if there is none.
async fn until(at: Option<Instant>) {
    match at {
        None => std::future::pending().await,
        Some(at) => tokio::time::sleep_until(at).await,
    }
}

/// Sends all that may go out.
fn send<M>(
    station: &mut Station<M, ReplyTo>,
    link: &mut Link,
    local: fn(&M::Out) -> Result<Value, WireError>,
) -> Result<(), LinkError>
where
    M: Durable,
    M::Out: Clone,
{
    let line = station.line();
    while let Some(effect) = station.poll_effect() {
        link.send(line, effect, local)?;
    }
    Ok(())
}

/// Returns when the journal is written, or could not be.
async fn written(writer: Option<&mut Writer>) -> Result<(), agent_journal::CommitError> {
    match writer {
        None => std::future::pending().await,
        Some(writer) => writer.next().await,
    }
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
