//! Showing what a robot does, while it does it.

mod alternatives;
mod columns;
mod json;
mod people;
mod progress;
mod retold;
mod summary;
mod team;
mod words;

use std::pin::Pin;

use agent_core::model::{Symbol, Time};
use agent_core::protocol::Event;
use agent_link::{Client, Clock};
use maps::Site;

use crate::exit::Failure;
use crate::robot::{Robot, RoleKind, RoleNews};
use crate::scenario::{Player, Told};
use crate::snapshot::Snapshot;

pub(crate) use alternatives::alternatives;
pub(crate) use json::JsonLines;
pub(crate) use people::ForPeople;
pub(crate) use team::ForTeam;
pub(crate) use words::resumption;

/// When a story is over, what is nearly done is shown to its end, if that comes within this.
const LAST_WORDS: Time = Time(5_000_000);

/// Where it is shown.
pub(crate) trait Screen {
    /// An agent has told something.
    fn event(&mut self, agent: &Symbol, event: &Event);
    /// A story goes on.
    fn told(&mut self, at: Time, told: &Told);
    /// The robot was seen.
    fn saw(&mut self, _snapshot: &Snapshot) {}
    /// Something has become of a role's process.
    fn role(&mut self, at: Time, news: &RoleNews);
}

/// Why there is nothing more to show.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Ending {
    /// Somebody has pressed Ctrl-C.
    Interrupted,
    /// The story is over; what went otherwise than it should.
    Over(Vec<String>),
    /// A role ends whenever it is started: how, and what it says.
    GivenUp(RoleKind, String),
}

/// What else there is to a show.
pub(crate) struct Programme<'a> {
    /// The map, for words about where the robot is.
    pub(crate) site: &'a Site,
    /// A story that is played.
    pub(crate) player: Option<Player>,
    /// Whether the show ends with the story.
    pub(crate) until_done: bool,
}

/// Shows what the robot does until there is a reason to end.
pub(crate) async fn show(
    robot: &mut Robot,
    programme: Programme<'_>,
    interrupted: &mut Pin<&mut impl Future<Output = ()>>,
    screen: &mut impl Screen,
) -> Result<Ending, Failure> {
    let Programme {
        site,
        mut player,
        until_done,
    } = programme;
    let client = Client::new(&robot.session, &robot.keys);
    let mut events = client.events().await.map_err(Failure::failed)?;
    let poses = robot
        .session
        .declare_subscriber(robot.keys.world_pose())
        .await
        .map_err(Failure::failed)?;
    let mut over_at = None;
    loop {
        if until_done
            && let Some(player) = &mut player
            && (over_at.is_some() || player.is_over())
        {
            let end = *over_at.get_or_insert_with(|| robot.clock.now() + LAST_WORDS);
            if !player.is_at_work() || robot.clock.now() >= end {
                return Ok(Ending::Over(player.failed().to_vec()));
            }
        }
        let told = tokio::select! {
            biased;
            () = &mut *interrupted => return Ok(Ending::Interrupted),
            Some(news) = robot.news.next() => {
                screen.role(robot.clock.now(), &news);
                if let RoleNews::GivenUp { role, how } = news {
                    return Ok(Ending::GivenUp(role, how));
                }
                None
            }
            Some(event) = events.next() => {
                match event {
                    Ok((agent, event)) => {
                        screen.event(&agent, &event);
                        if let Some(player) = &mut player {
                            player.heard(&agent, &event);
                        }
                    }
                    Err(error) => tracing::warn!("an event cannot be read: {error}"),
                }
                None
            }
            told = next(player.as_mut(), &robot.clock) => Some(told),
            () = end(over_at, &robot.clock) => None,
            Ok(sample) = poses.recv_async() => {
                let snapshot = Snapshot::read(&sample.payload().to_bytes(), site);
                snapshot.and_then(|snapshot| {
                    screen.saw(&snapshot);
                    player.as_mut()?.saw(&snapshot)
                })
            }
        };
        if let Some(told) = told {
            screen.told(robot.clock.now(), &told);
        }
    }
}

async fn end(at: Option<Time>, clock: &Clock) {
    match at {
        Some(at) => clock.sleep_until(at).await,
        None => std::future::pending().await,
    }
}

async fn next(player: Option<&mut Player>, clock: &Clock) -> Told {
    match player {
        Some(player) => player.next(clock).await,
        None => std::future::pending().await,
    }
}
