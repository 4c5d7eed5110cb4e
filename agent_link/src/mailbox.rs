//! Everything that can come in, in one queue of two lanes.
//!
//! zenoh calls back on the threads that read from the network. Nothing is done there but to put
//! what has come into the queue; what finds it full is dropped, and whoever counts on an answer
//! asks again.

use std::sync::Arc;
use std::time::Duration;

use agent_core::model::Symbol;
use agent_core::protocol::{Answer, Urgency};
use tokio::runtime::Handle;
use tokio::sync::mpsc;
use zenoh::Session;
use zenoh::bytes::ZBytes;
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Subscriber;
use zenoh::qos::{CongestionControl, Priority};
use zenoh::query::{ConsolidationMode, Queryable};
use zenoh::sample::SampleKind;

use crate::inspect::View;
use crate::keys::{AgentKeys, Keys};
use crate::question::Question;
use crate::queue::{Arrivals, Lane, lanes};
use crate::wiring::{LinkError, Wiring};

/// How long handing back what was declared may take at the end.
const UNDECLARE_TIMEOUT: Duration = Duration::from_secs(2);

/// How often, and how long each time, an executor is asked for all its facts.
const FACTS_ATTEMPTS: u32 = 10;
const FACTS_TIMEOUT: Duration = Duration::from_secs(1);
const FACTS_RETRY: Duration = Duration::from_millis(100);

/// Something came in.
#[derive(Debug)]
pub(crate) enum Arrival {
    /// From a superior.
    Instruction(Question),
    /// From an executor.
    Report(Question),
    /// From elsewhere.
    Local(Question),
    /// From a user, who may have said who that is.
    Goal(Urgency, Option<Arc<str>>, Asked),
    /// From a user, for this machine in particular.
    OwnGoal(Urgency, Asked),
    /// From one of the team, which the key names, to all.
    Said(Arc<str>, ZBytes),
    /// From a user.
    Command(Question),
    /// From a user or a sensor.
    Facts(Asked),
    /// Somebody wants to look inside.
    Look(View, Question),
    /// A superior wants to know all that was told; or what was told it alone, if the key names it.
    WhatHolds(Question),
    /// Told by an executor.
    Observed(Told, ZBytes),
    /// All that was told by an executor.
    AllObserved(Told, ZBytes),
    /// Somebody has appeared (`true`) or vanished, in this epoch.
    Neighbour {
        name: String,
        epoch: u64,
        /// The epoch in which its memory begins.
        line: u64,
        appeared: bool,
    },
    /// This executor, of that line, has applied the instruction of that number, with this answer.
    Answered(Symbol, u64, u64, Answer),
    /// This superior, of that line, has applied the report of that number.
    Delivered(Symbol, u64, u64),
    /// The receiver on this key has dealt with the message of that number long since, though this
    /// machine does not know.
    Outdated(String, u64),
    /// The receiver on this key listens to a later start of this machine.
    Superseded(String),
}

/// What can be put, or asked for an answer.
#[derive(Debug)]
pub(crate) enum Asked {
    Put(ZBytes),
    Query(Question),
}

/// Whose facts those are, and whom they were told.
#[derive(Clone, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub(crate) struct Told {
    pub(crate) executor: Arc<str>,
    /// This machine alone.
    pub(crate) alone: bool,
}

/// All that is declared for one machine, as long as it lives.
pub(crate) struct Mailbox {
    session: Session,
    runtime: Handle,
    agents: Lane,
    users: Lane,
    queryables: Vec<Queryable<()>>,
    subscribers: Vec<Subscriber<()>>,
    token: Option<LivelinessToken>,
}

impl Mailbox {
    /// Declares what the wiring asks for, for a machine whose memory begins in the epoch `line`. The liveliness token comes last, so that whoever is seen
    /// to be alive listens already.
    pub(crate) async fn open(
        session: &Session,
        wiring: &Wiring,
        line: u64,
    ) -> Result<(Self, Arrivals), LinkError> {
        let (agents, users, arrivals) = lanes();
        let mut mailbox = Self {
            session: session.clone(),
            runtime: Handle::current(),
            agents,
            users,
            queryables: Vec::new(),
            subscribers: Vec::new(),
            token: None,
        };
        let keys = &wiring.keys;
        let own = keys.agent(&wiring.name)?;
        let (agents, users) = (mailbox.agents.clone(), mailbox.users.clone());
        for (key, arrival) in [
            (own.instruction(), Arrival::Instruction as fn(_) -> _),
            (own.report(), Arrival::Report),
        ] {
            match wiring.signs {
                true => mailbox.signed(&key, agents.clone(), arrival).await?,
                false => mailbox.asked(key, agents.clone(), arrival).await?,
            }
        }
        let facts = own.facts();
        mailbox
            .asked(facts.clone(), agents.clone(), Arrival::WhatHolds)
            .await?;
        if wiring.signs {
            let what_holds = Arrival::WhatHolds;
            mailbox.signed(&facts, agents.clone(), what_holds).await?;
        }
        for view in View::ALL {
            let look = move |question| Arrival::Look(view, question);
            let key = own.view(view.name());
            mailbox.asked(key, users.clone(), look).await?;
        }
        if let Some(key) = &wiring.local_in {
            let key = key.clone();
            mailbox.asked(key, agents.clone(), Arrival::Local).await?;
        }
        if wiring.takes_goals {
            for (key, urgency) in [
                (keys.goal_normal(), Urgency::Normal),
                (keys.goal_emergency(), Urgency::Emergency),
            ] {
                mailbox.goals(key.clone(), key.clone(), urgency).await?;
                // With the name of whoever asks.
                let of_anyone = format!("{key}/anyone");
                mailbox
                    .goals(format!("{key}/*"), of_anyone, urgency)
                    .await?;
            }
            let key = keys.goal_command();
            mailbox.asked(key, users.clone(), Arrival::Command).await?;
        }
        if wiring.takes_own_goals {
            for (key, urgency) in [
                (own.goal_normal(), Urgency::Normal),
                (own.goal_emergency(), Urgency::Emergency),
            ] {
                let put = move |put| Arrival::OwnGoal(urgency, Asked::Put(put));
                mailbox.put(key.clone(), users.clone(), put).await?;
                let query = move |query| Arrival::OwnGoal(urgency, Asked::Query(query));
                mailbox.asked(key, users.clone(), query).await?;
            }
            let key = own.goal_command();
            mailbox.asked(key, users.clone(), Arrival::Command).await?;
        }
        if wiring.in_team {
            mailbox.said(keys.team_any(), agents.clone()).await?;
        }
        if wiring.takes_facts {
            let put = |put| Arrival::Facts(Asked::Put(put));
            mailbox.put(keys.facts(), users.clone(), put).await?;
            let query = |query| Arrival::Facts(Asked::Query(query));
            mailbox.asked(keys.facts(), users, query).await?;
        }
        for executor in &wiring.executors {
            let its = keys.agent(executor)?;
            let mut facts = vec![(its.facts(), false)];
            if wiring.signs {
                facts.push((its.facts_for(&wiring.name)?, true));
            }
            for (key, alone) in facts {
                let executor = Arc::from(executor.as_str());
                let told = Told { executor, alone };
                let told = move |put| Arrival::Observed(told.clone(), put);
                mailbox.put(key, agents.clone(), told).await?;
            }
        }
        mailbox.watch_neighbours(wiring).await?;
        let token = session.liveliness().declare_token(keys.alive_remembering(
            &wiring.name,
            wiring.epoch,
            line,
        )?);
        mailbox.token = Some(token.await.map_err(LinkError::Zenoh)?);
        Ok((mailbox, arrivals))
    }

    /// Goals that are put or asked for on `key` come in. Where a query names more than one key, the
    /// answer is given on `answer_key`.
    async fn goals(
        &mut self,
        key: String,
        answer_key: String,
        urgency: Urgency,
    ) -> Result<(), LinkError> {
        let users = self.users.clone();
        let subscriber = self.session.declare_subscriber(key.clone());
        let subscriber = subscriber.callback(move |sample| {
            if sample.kind() == SampleKind::Put {
                let sender = Keys::read_sender(sample.key_expr()).map(Arc::from);
                let put = Asked::Put(sample.payload().clone());
                users.deliver(Arrival::Goal(urgency, sender, put));
            }
        });
        self.subscribers
            .push(subscriber.await.map_err(LinkError::Zenoh)?);
        let (users, runtime) = (self.users.clone(), self.runtime.clone());
        let nobody: Arc<str> = Arc::from(answer_key);
        let queryable = self.session.declare_queryable(key).complete(true);
        let queryable = queryable.callback(move |query| {
            let sender = Keys::read_sender(query.key_expr()).map(Arc::from);
            let key = match &sender {
                Some(_) => Arc::from(query.key_expr().as_str()),
                None => nobody.clone(),
            };
            let asked = Asked::Query(Question::new(query, &runtime, key));
            users.deliver(Arrival::Goal(urgency, sender, asked));
        });
        self.queryables
            .push(queryable.await.map_err(LinkError::Zenoh)?);
        Ok(())
    }

    /// Queries on `key` come in as `arrival`.
    async fn asked(
        &mut self,
        key: String,
        lane: Lane,
        arrival: impl Fn(Question) -> Arrival + Send + Sync + 'static,
    ) -> Result<(), LinkError> {
        let runtime = self.runtime.clone();
        let own_key: Arc<str> = Arc::from(key.as_str());
        let queryable = self
            .session
            .declare_queryable(key)
            .complete(true)
            .callback(move |query| {
                let question = Question::new(query, &runtime, own_key.clone());
                lane.deliver(arrival(question));
            })
            .await
            .map_err(LinkError::Zenoh)?;
        self.queryables.push(queryable);
        Ok(())
    }

    /// Queries on `key` with the name of whoever asks come in as `arrival`. One that names nobody is
    /// not answered.
    async fn signed(
        &mut self,
        key: &str,
        lane: Lane,
        arrival: impl Fn(Question) -> Arrival + Send + Sync + 'static,
    ) -> Result<(), LinkError> {
        let runtime = self.runtime.clone();
        let queryable = self.session.declare_queryable(AgentKeys::by_any(key));
        let queryable = queryable.complete(true).callback(move |query| {
            if let Some(question) = Question::signed(query, &runtime) {
                lane.deliver(arrival(question));
            }
        });
        self.queryables
            .push(queryable.await.map_err(LinkError::Zenoh)?);
        Ok(())
    }

    /// What the others of the team say to all comes in, from whom the key names.
    async fn said(&mut self, key: String, lane: Lane) -> Result<(), LinkError> {
        let subscriber = self.session.declare_subscriber(key);
        let subscriber = subscriber.callback(move |sample| {
            if sample.kind() == SampleKind::Put
                && let Some(by) = Keys::read_last(sample.key_expr())
            {
                lane.deliver(Arrival::Said(Arc::from(by), sample.payload().clone()));
            }
        });
        self.subscribers
            .push(subscriber.await.map_err(LinkError::Zenoh)?);
        Ok(())
    }

    /// Puts on `key` come in as `arrival`.
    async fn put(
        &mut self,
        key: String,
        lane: Lane,
        arrival: impl Fn(ZBytes) -> Arrival + Send + Sync + 'static,
    ) -> Result<(), LinkError> {
        let subscriber = self
            .session
            .declare_subscriber(key)
            .callback(move |sample| {
                if sample.kind() == SampleKind::Put {
                    lane.deliver(arrival(sample.payload().clone()));
                }
            })
            .await
            .map_err(LinkError::Zenoh)?;
        self.subscribers.push(subscriber);
        Ok(())
    }

    /// Who else of this robot comes and goes, and who is there.
    async fn watch_neighbours(&mut self, wiring: &Wiring) -> Result<(), LinkError> {
        let agents = self.agents.clone();
        let (own, own_epoch) = (wiring.name.clone(), wiring.epoch);
        let subscriber = self
            .session
            .liveliness()
            .declare_subscriber(wiring.keys.alive_any())
            .history(true)
            .callback(move |sample| {
                let token = sample.key_expr().as_str();
                let Some((name, epoch, line)) = Keys::read_remembering(token) else {
                    return;
                };
                if (name, epoch) != (own.as_str(), own_epoch) {
                    agents.deliver(Arrival::Neighbour {
                        name: name.to_owned(),
                        epoch,
                        line,
                        appeared: sample.kind() == SampleKind::Put,
                    });
                }
            })
            .await
            .map_err(LinkError::Zenoh)?;
        self.subscribers.push(subscriber);
        Ok(())
    }

    /// Where arrivals from agents go.
    pub(crate) fn arrivals(&self) -> mpsc::Sender<Arrival> {
        self.agents.sender()
    }

    /// Asks an executor for all it has told so far; the answer arrives by itself.
    pub(crate) fn ask_what_holds(&self, told: Told, key: String) {
        let (session, agents) = (self.session.clone(), self.agents.clone());
        self.runtime.spawn(async move {
            for _ in 0..FACTS_ATTEMPTS {
                let (agents, told) = (agents.clone(), told.clone());
                let (answered, mut answer) = mpsc::unbounded_channel();
                // Into the queue right where it is read from the network, and with the priority of
                // reports: a later report must not be overtaken by what it has outdated.
                let asked = session
                    .get(&key)
                    .priority(Priority::RealTime)
                    .congestion_control(CongestionControl::Block)
                    .consolidation(ConsolidationMode::None)
                    .timeout(FACTS_TIMEOUT)
                    .callback(move |reply| {
                        if let Ok(sample) = reply.into_result() {
                            let payload = sample.payload().clone();
                            agents.deliver(Arrival::AllObserved(told.clone(), payload));
                            let _ = answered.send(());
                        }
                    })
                    .await;
                if asked.is_ok() && answer.recv().await.is_some() {
                    return;
                }
                tokio::time::sleep(FACTS_RETRY).await;
            }
            tracing::warn!("no answer on {key}: what holds there is not known");
        });
    }

    /// Hands back all that was declared, but waits no longer than is decent.
    pub(crate) async fn close(self) {
        let (done, wait) = tokio::sync::oneshot::channel();
        // Its own thread: a runtime waits for its own without end.
        std::thread::spawn(move || {
            drop(self);
            let _ = done.send(());
        });
        if tokio::time::timeout(UNDECLARE_TIMEOUT, wait).await.is_err() {
            tracing::warn!("the network did not let go within {UNDECLARE_TIMEOUT:?}");
        }
    }
}
