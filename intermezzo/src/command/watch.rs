//! `intermezzo watch`: what happens from now on.

use std::pin::pin;

use agent_core::model::{Symbol, Time};

use crate::cli::WatchArgs;
use crate::exit::{Exit, Failure};
use crate::show::{ForPeople, JsonLines, Screen};
use crate::target::{Connection, nobody, unanswered};

/// What changes by itself in every place that we know of; a watcher is not told the place.
const OBSERVABLE: &str = "open";

pub(crate) async fn run(args: WatchArgs) -> Result<Exit, Failure> {
    let connection = Connection::open(&args.target).await?;
    let result = if args.json {
        watch(&connection, &mut JsonLines).await
    } else {
        let mut people = ForPeople::new(Time::ZERO, [Symbol::from(OBSERVABLE)]);
        let result = watch(&connection, &mut people).await;
        people.end();
        result
    };
    connection.close(result).await
}

async fn watch(connection: &Connection, screen: &mut impl Screen) -> Result<Exit, Failure> {
    let mut events = connection.client.events().await.map_err(unanswered)?;
    // Whoever watches nothing should know that at once.
    if connection
        .client
        .alive()
        .await
        .map_err(unanswered)?
        .is_empty()
    {
        return Err(nobody(&connection.keys));
    }
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
