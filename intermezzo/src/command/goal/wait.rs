//! Waiting for the end of a goal, whatever becomes of the robot's processes meanwhile.

use std::collections::BTreeSet;
use std::time::Duration;

use agent_core::model::Time;
use agent_core::protocol::{Event, GoalRequest, Happening};
use agent_link::registry::Registry;
use agent_link::{ClientError, Events, Keys, wire};
use tokio::time::Instant;
use zenoh::handlers::FifoChannelHandler;
use zenoh::pubsub::Subscriber;
use zenoh::sample::{Sample, SampleKind};

use super::tell;
use crate::cli::GoalArgs;
use crate::exit::{Exit, Failure};
use crate::style::{AGAIN, ASIDE, BAD, DIM, GOOD};
use crate::target::{Connection, unanswered, unanswered_by};

/// A robot that is down may come back at another address: between two looks.
const RETRY: Duration = Duration::from_millis(200);

/// Asks for the goal, and returns when it has ended.
pub(super) async fn run(
    connection: Connection,
    goal: GoalRequest,
    args: &GoalArgs,
) -> Result<Exit, Failure> {
    // Listen first: a short goal may have ended before the verdict is here.
    let mut listening = match Listening::begin(connection).await {
        Ok(listening) => listening,
        Err((connection, failure)) => return connection.close(Err(failure)).await,
    };
    let client = &listening.connection.client;
    let asked = match &args.vehicle {
        Some(vehicle) => client.goal_to(vehicle, goal).await,
        None => client.goal(goal).await,
    };
    let asked = match (asked, &args.vehicle) {
        (Err(error), Some(vehicle)) => Err(unanswered_by(client, vehicle, error).await),
        (asked, _) => asked.map_err(unanswered),
    };
    let ended = match asked {
        Err(failure) => Err(failure),
        Ok(verdict) => match (tell(&verdict, args), &verdict.id) {
            (Exit::Done, Some(id)) => {
                let taker = verdict.by.as_deref().unwrap_or(parent_agent::NAME);
                let mut waiting = Waiting::new(id, taker, args);
                waiting.until_it_ends(&mut listening).await
            }
            (exit, _) => Ok(exit),
        },
    };
    listening.connection.close(ended).await
}

/// A connection, and what it tells.
struct Listening {
    events: Events,
    tokens: Subscriber<FifoChannelHandler<Sample>>,
    connection: Connection,
}

impl Listening {
    async fn begin(connection: Connection) -> Result<Self, (Connection, Failure)> {
        let begun = async {
            let events = connection.client.events().await.map_err(unanswered)?;
            let tokens = connection
                .session
                .liveliness()
                .declare_subscriber(connection.keys.alive_any())
                .history(true)
                .await
                .map_err(|error| {
                    Failure::failed(format_args!("cannot see who is there: {error}"))
                })?;
            Ok((events, tokens))
        };
        match begun.await {
            Ok((events, tokens)) => Ok(Self {
                events,
                tokens,
                connection,
            }),
            Err(failure) => Err((connection, failure)),
        }
    }
}

/// A goal that was accepted.
struct Waiting<'a> {
    id: &'a str,
    /// The agent that has the goal.
    taker: &'a str,
    args: &'a GoalArgs,
    /// The starts of the agent that has the goal which are there.
    there: BTreeSet<u64>,
    /// Since when there is none.
    gone: Option<Instant>,
    /// Whether the goal may have ended unheard: after a new start, and before somebody listened.
    unheard: bool,
}

impl<'a> Waiting<'a> {
    fn new(id: &'a str, taker: &'a str, args: &'a GoalArgs) -> Self {
        Self {
            id,
            taker,
            args,
            there: BTreeSet::new(),
            // Who is there is told at once.
            gone: None,
            // It may be the name of a goal that has ended.
            unheard: true,
        }
    }

    async fn until_it_ends(&mut self, listening: &mut Listening) -> Result<Exit, Failure> {
        let mut looks = tokio::time::interval(RETRY);
        looks.set_missed_tick_behavior(tokio::time::MissedTickBehavior::Delay);
        loop {
            tokio::select! {
                biased;
                Some(event) = listening.events.next() => {
                    if let Ok((agent, event)) = event
                        && agent == self.taker
                        && event.goal.as_ref().is_some_and(|goal| *goal == self.id)
                        && let Some(exit) = self.heard(&event)
                    {
                        return Ok(exit);
                    }
                }
                Ok(token) = listening.tokens.recv_async() => self.token(&token),
                _ = looks.tick() => {
                    if let Some(exit) = self.look(listening).await? {
                        return Ok(exit);
                    }
                }
            }
        }
    }

    /// The exit status, if that was the end.
    fn heard(&self, event: &Event) -> Option<Exit> {
        if self.args.json {
            if let Ok(line) = wire::event_to_line(self.taker, event) {
                anstream::println!("{line}");
            }
        } else if let Some(words) = words(event) {
            anstream::println!("{words}");
        }
        match event.what {
            Happening::GoalSucceeded => Some(Exit::Done),
            Happening::GoalFailed { .. } | Happening::GoalUnknown { .. } => Some(Exit::Failed),
            _ => None,
        }
    }

    /// Follows whether the agent that has the goal is there.
    fn token(&mut self, token: &Sample) {
        let Some((name, epoch)) = Keys::read_alive(token.key_expr().as_str()) else {
            return;
        };
        if name != self.taker {
            return;
        }
        if token.kind() == SampleKind::Put {
            self.there.insert(epoch);
            if self.gone.take().is_some() {
                self.say("the robot is there again");
                self.unheard = true;
            }
        } else {
            self.there.remove(&epoch);
            if self.there.is_empty() && self.gone.is_none() {
                self.say("the robot is down: waiting for it");
                self.gone = Some(Instant::now());
            }
        }
    }

    /// What tells of the goal may go to the standard output; this is about the waiting.
    fn say(&self, words: &str) {
        if !self.args.json {
            anstream::eprintln!("{DIM}{words}{DIM:#}");
        }
    }

    /// The exit status, if the goal is found to have ended.
    async fn look(&mut self, listening: &mut Listening) -> Result<Option<Exit>, Failure> {
        let Some(since) = self.gone else {
            return match self.unheard && !self.there.is_empty() {
                true => self.ask(listening).await,
                false => Ok(None),
            };
        };
        if since.elapsed() >= self.args.patience {
            return Err(Failure::nobody_there(format_args!(
                "the robot has been down for {:.0} s, and nobody knows how the goal has ended",
                self.args.patience.as_secs_f64()
            ))
            .advice(format_args!(
                "start it again with the same --state, then `intermezzo goal '{}' --id {} --wait`",
                self.args.task, self.id
            )));
        }
        if let Some(moved) = moved(&listening.connection).await {
            match Listening::begin(moved).await {
                Ok(now) => {
                    let before = std::mem::replace(listening, now);
                    self.there.clear();
                    before.connection.close(Ok(())).await?;
                }
                Err((connection, _)) => connection.close(Ok(())).await?,
            }
        }
        Ok(None)
    }

    /// Asks the agent that has the goal how it stands.
    async fn ask(&mut self, listening: &Listening) -> Result<Option<Exit>, Failure> {
        let client = &listening.connection.client;
        let goal = match client.goal_state(self.taker, self.id).await {
            Ok(Some(goal)) => goal,
            Ok(None) => {
                return Err(Failure::nobody_there(format_args!(
                    "the robot that is there does not know of the goal `{}`",
                    self.id
                ))
                .advice("a robot keeps its goals where `intermezzo up --state DIR` says"));
            }
            // It may be down again, which is told.
            Err(ClientError::NoAnswer { .. }) => return Ok(None),
            Err(error) => return Err(unanswered(error)),
        };
        self.unheard = false;
        if goal["state"] != "ended" {
            return Ok(None);
        }
        let at = Time::from_secs(goal["at_s"].as_f64().unwrap_or_default());
        let reason = || goal["reason"].as_str().unwrap_or_default().to_owned();
        let what = match goal["outcome"].as_str() {
            Some("succeeded") => Happening::GoalSucceeded,
            Some("failed") => Happening::GoalFailed { reason: reason() },
            _ => Happening::GoalUnknown { reason: reason() },
        };
        Ok(self.heard(&Event {
            at,
            goal: Some(self.id.into()),
            stack_depth: 0,
            what,
        }))
    }
}

/// A connection to where the robot is now, if that is elsewhere than before.
async fn moved(connection: &Connection) -> Option<Connection> {
    let robot = connection.keys.robot();
    let found = connection.found_at.as_ref()?;
    let running = Registry::of_user().ok()?.find(Some(robot)).ok()?;
    if running.endpoint == *found {
        return None;
    }
    Connection::to(running, &connection.identity).await.ok()
}

fn words(event: &Event) -> Option<String> {
    let at = event.at;
    Some(match &event.what {
        Happening::GoalStarted => format!("begun at {at}"),
        Happening::GoalSuspended { why, .. } => {
            format!("{ASIDE}set aside{ASIDE:#} at {at}: {why}")
        }
        Happening::GoalResumed { how, why, .. } => format!(
            "{AGAIN}taken up again{AGAIN:#} at {at}, {}: {why}",
            crate::show::resumption(*how)
        ),
        Happening::GoalBlocked { blocked_by } => {
            let facts: Vec<String> = blocked_by.iter().map(ToString::to_string).collect();
            format!(
                "{ASIDE}blocked{ASIDE:#} at {at}: waits for {}",
                facts.join(" ")
            )
        }
        Happening::GoalSucceeded => format!("{GOOD}done{GOOD:#} at {at}"),
        Happening::GoalFailed { reason } => format!("{BAD}failed{BAD:#} at {at}: {reason}"),
        Happening::GoalUnknown { reason } => {
            format!("{BAD}not known whether it is done{BAD:#} at {at}: {reason}")
        }
        _ => return None,
    })
}
