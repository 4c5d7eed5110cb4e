//! What users do: ask for goals, look inside, watch.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use agent_core::model::Symbol;
use agent_core::protocol::{Command, Event, GoalId, GoalRequest, Urgency};
use serde::de::DeserializeOwned;
use serde_json::Value;
use tokio::sync::mpsc;
use zenoh::Session;
use zenoh::pubsub::Subscriber;
use zenoh::query::{ConsolidationMode, QueryTarget};

use crate::clock::epoch_now;
use crate::inspect::View;
use crate::keys::{Keys, NameError};
use crate::wire::{self, CommandVerdict, EventNumber, FactsVerdict, Verdict, WireError};

/// A question is asked again for this long before nobody counts as there: right after a
/// connection is made, or made again, questions may go nowhere.
const PATIENCE: Duration = Duration::from_secs(3);

/// One attempt.
const QUERY_TIMEOUT: Duration = Duration::from_secs(1);

/// Between attempts.
const RETRY: Duration = Duration::from_millis(100);

/// Events that may wait for a watcher who is slow.
const EVENTS_WAITING: usize = 16 * 1024;

/// Why a question has no answer.
#[derive(Debug, thiserror::Error)]
pub enum ClientError {
    /// zenoh does not say which.
    #[error("no answer: not reachable or not permitted (robot `{robot}`, {key})")]
    NoAnswer {
        /// Whose.
        robot: String,
        /// Where it was asked.
        key: String,
    },
    /// The other side speaks otherwise.
    #[error(transparent)]
    Wire(#[from] WireError),
    /// Not a name.
    #[error(transparent)]
    Name(#[from] NameError),
    /// zenoh.
    #[error("the network does not do what is asked of it: {0}")]
    Zenoh(zenoh::Error),
}

/// A user of one robot.
#[derive(Clone, Debug)]
pub struct Client {
    session: Session,
    keys: Keys,
    name: Option<String>,
}

impl Client {
    /// Over an open session.
    pub fn new(session: &Session, keys: &Keys) -> Self {
        Self {
            session: session.clone(),
            keys: keys.clone(),
            name: None,
        }
    }

    /// The same, as a user of this name, who asks for goals under it. Where there is access
    /// control, users may ask under their own names only.
    #[must_use]
    pub fn named(self, name: &str) -> Self {
        Self {
            name: Some(name.to_owned()),
            ..self
        }
    }

    /// Asks for a goal. One without a name is given one: a lost answer is asked for again, and only
    /// a name tells the agent that it is the same goal.
    pub async fn goal(&self, mut goal: GoalRequest) -> Result<Verdict, ClientError> {
        if goal.id.is_none() {
            goal.id = Some(new_id(&goal));
        }
        let key = match (goal.urgency, &self.name) {
            (Urgency::Normal, None) => self.keys.goal_normal(),
            (Urgency::Emergency, None) => self.keys.goal_emergency(),
            (Urgency::Normal, Some(name)) => self.keys.goal_normal_by(name)?,
            (Urgency::Emergency, Some(name)) => self.keys.goal_emergency_by(name)?,
        };
        self.ask("verdict", &key, &wire::goal_to_wire(&goal)?).await
    }

    /// Asks one agent in particular for a goal, as [`goal`](Self::goal) asks whoever takes goals.
    pub async fn goal_to(
        &self,
        agent: &str,
        mut goal: GoalRequest,
    ) -> Result<Verdict, ClientError> {
        if goal.id.is_none() {
            goal.id = Some(new_id(&goal));
        }
        let keys = self.keys.agent(agent)?;
        let key = match goal.urgency {
            Urgency::Normal => keys.goal_normal(),
            Urgency::Emergency => keys.goal_emergency(),
        };
        self.ask("verdict", &key, &wire::goal_to_wire(&goal)?).await
    }

    /// Suspends, resumes or cancels a goal of one agent in particular.
    pub async fn command_to(
        &self,
        agent: &str,
        command: &Command,
    ) -> Result<CommandVerdict, ClientError> {
        let text = wire::command_to_wire(command)?;
        let key = self.keys.agent(agent)?.goal_command();
        self.ask("verdict", &key, &text).await
    }

    /// Suspends, resumes or cancels a goal.
    pub async fn command(&self, command: &Command) -> Result<CommandVerdict, ClientError> {
        let text = wire::command_to_wire(command)?;
        self.ask("verdict", &self.keys.goal_command(), &text).await
    }

    /// Tells what is different in the world, as people type it: `(not (open door3_5))`.
    pub async fn facts(&self, text: &str) -> Result<FactsVerdict, ClientError> {
        self.ask("verdict", &self.keys.facts(), text).await
    }

    /// Looks inside one agent.
    pub async fn look(&self, agent: &str, view: View) -> Result<Value, ClientError> {
        let key = self.keys.agent(agent)?.view(view.name());
        let mut answer: Value = self.ask("view", &key, "").await?;
        Ok(answer[view.name()].take())
    }

    /// How the processes of the roles are. `None` where nobody looks after them, or nobody answers.
    pub async fn supervisor(&self) -> Result<Option<Value>, ClientError> {
        let replies = self
            .session
            .get(self.keys.supervisor_status())
            .timeout(QUERY_TIMEOUT)
            .await
            .map_err(ClientError::Zenoh)?;
        match replies.recv_async().await {
            Ok(reply) => match reply.result() {
                Ok(sample) => {
                    let mut answer: Value = wire::read("status", &sample.payload().to_bytes())?;
                    Ok(Some(answer["status"].take()))
                }
                Err(_) => Ok(None),
            },
            Err(_) => Ok(None),
        }
    }

    /// How a goal stands with an agent, as [`Inspect::goals`](crate::Inspect::goals) says; `None` if
    /// the agent knows of no goal of that name, or no longer.
    ///
    /// # Errors
    /// If nobody answers.
    pub async fn goal_state(&self, agent: &str, id: &str) -> Result<Option<Value>, ClientError> {
        let key = self.keys.agent(agent)?.view(View::Goals.name());
        let mut answer: Value = self.ask("view", &key, id).await?;
        let goals = answer[View::Goals.name()].as_array_mut();
        // The same name may have been used before; the first is the one that counts.
        Ok(goals.and_then(|goals| goals.drain(..).next()))
    }

    /// The agents that are alive, and the epochs of their starts. One that hangs counts for two
    /// seconds more.
    pub async fn alive(&self) -> Result<Vec<(String, u64)>, ClientError> {
        let tokens = self
            .session
            .liveliness()
            .get(self.keys.alive_any())
            .timeout(QUERY_TIMEOUT)
            .await
            .map_err(ClientError::Zenoh)?;
        let mut alive = Vec::new();
        while let Ok(reply) = tokens.recv_async().await {
            if let Ok(sample) = reply.result()
                && let Some((agent, epoch)) = Keys::read_alive(sample.key_expr().as_str())
            {
                alive.push((agent.to_owned(), epoch));
            }
        }
        alive.sort();
        Ok(alive)
    }

    /// All events from now on. Those that a watcher is too slow for are lost to it.
    pub async fn events(&self) -> Result<Events, ClientError> {
        let (events, queue) = mpsc::channel(EVENTS_WAITING);
        let subscriber = self
            .session
            .declare_subscriber(self.keys.event())
            .callback(move |sample| {
                let line = sample.payload().to_bytes();
                if events
                    .try_send(wire::numbered_event_from_line(&line))
                    .is_err()
                {
                    tracing::warn!("an event is lost: more than {EVENTS_WAITING} wait");
                }
            })
            .await
            .map_err(ClientError::Zenoh)?;
        Ok(Events {
            queue,
            seen: Seen::default(),
            _subscriber: subscriber,
        })
    }

    async fn ask<T: DeserializeOwned>(
        &self,
        what: &'static str,
        key: &str,
        text: &str,
    ) -> Result<T, ClientError> {
        let asked = std::time::Instant::now();
        loop {
            let replies = self
                .session
                .get(key)
                .payload(text)
                .target(QueryTarget::All)
                .consolidation(ConsolidationMode::None)
                .timeout(QUERY_TIMEOUT)
                .await
                .map_err(ClientError::Zenoh)?;
            if let Ok(reply) = replies.recv_async().await
                && let Ok(sample) = reply.result()
            {
                return Ok(wire::read(what, &sample.payload().to_bytes())?);
            }
            if asked.elapsed() >= PATIENCE {
                return Err(ClientError::NoAnswer {
                    robot: self.keys.robot().to_owned(),
                    key: key.to_owned(),
                });
            }
            tokio::time::sleep(RETRY).await;
        }
    }
}

/// Short enough to be typed, and new: the task, and the time in the digits of base 36.
fn new_id(goal: &GoalRequest) -> GoalId {
    const DIGITS: &[u8; 36] = b"0123456789abcdefghijklmnopqrstuvwxyz";
    /// They come round again after 16 hours.
    const LENGTH: u32 = 5;
    let task = goal.tasks.first().map_or("goal", |task| task.name.as_str());
    let mut id: String = task.chars().take(24).chain(['-']).collect();
    let time_ms = epoch_now();
    for place in (0..LENGTH).rev() {
        id.push(char::from(
            DIGITS[(time_ms / 36_u64.pow(place) % 36) as usize],
        ));
    }
    id.into()
}

/// A stream of events, in the order in which they came.
pub struct Events {
    queue: mpsc::Receiver<Result<Numbered, WireError>>,
    seen: Seen,
    _subscriber: Subscriber<()>,
}

impl Events {
    /// The next event and the agent that tells it. `None` once there can be no more. What an agent
    /// tells again after a restart is left out.
    pub async fn next(&mut self) -> Option<Result<(Symbol, Event), WireError>> {
        loop {
            return Some(match self.queue.recv().await? {
                Ok((agent, number, event)) => {
                    if number.is_some_and(|number| !self.seen.is_new(&agent, number)) {
                        continue;
                    }
                    Ok((agent, event))
                }
                Err(error) => Err(error),
            });
        }
    }
}

/// An event, the agent that tells it, and its number.
type Numbered = (Symbol, Option<EventNumber>, Event);

/// The latest events that were seen, by agent.
#[derive(Debug, Default)]
struct Seen(BTreeMap<Symbol, BTreeSet<EventNumber>>);

impl Seen {
    /// So many are known again; agents tell fewer again.
    const KEPT: usize = 1024;

    fn is_new(&mut self, agent: &Symbol, number: EventNumber) -> bool {
        let seen = self.0.entry(agent.clone()).or_default();
        let new = seen.insert(number);
        if seen.len() > Self::KEPT {
            seen.pop_first();
        }
        new
    }
}
