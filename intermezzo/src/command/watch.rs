//! `intermezzo watch`: what happens from now on.

use std::collections::BTreeSet;
use std::pin::pin;

use agent_core::model::{Symbol, Time};
use agent_link::Events;
use executor_sim::ROOM;

use super::team::goals_of;
use crate::cli::WatchArgs;
use crate::exit::{Exit, Failure};
use crate::show::{ForPeople, ForTeam, JsonLines, Screen};
use crate::target::{Connection, nobody, unanswered};

/// What changes by itself in every place that we know of; a watcher is not told the place.
const OBSERVABLE: &str = "open";

pub(crate) async fn run(args: WatchArgs) -> Result<Exit, Failure> {
    let connection = Connection::open(&args.target).await?;
    let result = watch_as_asked(&connection, args.json).await;
    connection.close(result).await
}

async fn watch_as_asked(connection: &Connection, json: bool) -> Result<Exit, Failure> {
    let client = &connection.client;
    let mut events = client.events().await.map_err(unanswered)?;
    let alive = client.alive().await.map_err(unanswered)?;
    // Whoever watches nothing should know that at once.
    if alive.is_empty() {
        return Err(nobody(&connection.keys));
    }
    if json {
        return watch(&mut events, &mut JsonLines).await;
    }
    let mut others: BTreeSet<Symbol> = alive
        .into_iter()
        .map(|(name, _)| name.as_str().into())
        .collect();
    if others.remove(ROOM) {
        let mut team = ForTeam::new(Time::ZERO, others.clone());
        for (goal, tasks) in goals_of(client, &others).await {
            team.knows(goal, tasks);
        }
        return watch(&mut events, &mut team).await;
    }
    let mut people = ForPeople::new(Time::ZERO, [Symbol::from(OBSERVABLE)]);
    let result = watch(&mut events, &mut people).await;
    people.end();
    result
}

async fn watch(events: &mut Events, screen: &mut impl Screen) -> Result<Exit, Failure> {
    let mut interrupted = pin!(agent_link::interrupted());
    loop {
        let event = tokio::select! {
            event = events.next() => event,
            () = &mut interrupted => return Ok(Exit::Done),
        };
        match event {
            Some(Ok((agent, event))) => screen.event(&agent, &event),
            Some(Err(error)) => tracing::warn!("an event cannot be read: {error}"),
            None => return Ok(Exit::Done),
        }
    }
}
