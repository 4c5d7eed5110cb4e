//! Looks after the roles of a robot: one that has died, or does not answer, is started again.

use std::collections::BTreeMap;
use std::future::pending;

use agent_link::{Keys, Session, epoch_now, wire};
use serde_json::{Value, json};
use tokio::sync::{mpsc, oneshot};
use tokio::task::JoinHandle;
use tokio::time::Instant;
use zenoh::handlers::FifoChannelHandler;
use zenoh::pubsub::Subscriber;
use zenoh::query::{Query, Queryable};
use zenoh::sample::{Sample, SampleKind};

use super::back_off::{End, Verdict};
use super::role_process::{ProcessNews, RoleKind, RoleProcess};
use super::state_dir::StateDir;
use super::watched::{Due, Phase, Watched};
use super::{RoleNews, Setup};
use crate::exit::Failure;

/// Looks after roles, until it is told to end them.
#[derive(Debug)]
pub(super) struct Supervisor {
    end: oneshot::Sender<()>,
    task: JoinHandle<()>,
}

impl Supervisor {
    /// Starts all roles and looks after them.
    ///
    /// # Errors
    /// If a process cannot be started, or zenoh refuses.
    pub(super) async fn start(
        setup: &Setup,
        state: StateDir,
        session: &Session,
        keys: &Keys,
        endpoints: Vec<String>,
        news: mpsc::UnboundedSender<RoleNews>,
    ) -> Result<Self, Failure> {
        let network = |error| Failure::failed(format_args!("cannot see who is there: {error}"));
        let tokens = session
            .liveliness()
            .declare_subscriber(keys.alive_any())
            .history(true)
            .await
            .map_err(network)?;
        let questions = session
            .declare_queryable(keys.supervisor_status())
            .complete(true)
            .await
            .map_err(network)?;
        let (tell, process_news) = mpsc::unbounded_channel();
        let kinds = setup.roles().into_iter();
        let mut work = Work {
            roles: kinds.map(|kind| (kind, Watched::new())).collect(),
            setup: setup.clone(),
            state,
            session: session.clone(),
            endpoints,
            tell,
            process_news,
            tokens,
            questions,
            news,
        };
        let kinds: Vec<RoleKind> = work.roles.keys().cloned().collect();
        for kind in kinds {
            if let Err(failure) = work.spawn(&kind) {
                work.end_all().await;
                return Err(failure);
            }
        }
        let (end, ended) = oneshot::channel();
        let task = tokio::spawn(work.run(ended));
        Ok(Self { end, task })
    }

    /// Ends all roles, and returns when they have ended: the world last, since it notes where the robot
    /// stands when the others have stopped it.
    pub(super) async fn end(self) {
        let _ = self.end.send(());
        if let Err(error) = self.task.await {
            tracing::error!("the supervisor has a fault: {error}");
        }
    }
}

/// The task.
struct Work {
    roles: BTreeMap<RoleKind, Watched>,
    setup: Setup,
    state: StateDir,
    session: Session,
    endpoints: Vec<String>,
    /// For the tasks that watch processes.
    tell: mpsc::UnboundedSender<ProcessNews>,
    process_news: mpsc::UnboundedReceiver<ProcessNews>,
    tokens: Subscriber<FifoChannelHandler<Sample>>,
    questions: Queryable<FifoChannelHandler<Query>>,
    news: mpsc::UnboundedSender<RoleNews>,
}

impl Work {
    async fn run(mut self, mut end: oneshot::Receiver<()>) {
        loop {
            let next = self.roles.iter().filter_map(|(kind, role)| {
                let (at, due) = role.due(self.setup.hang_limit)?;
                Some((at, kind.clone(), due))
            });
            let next = next.min_by(|(one, ..), (other, ..)| one.cmp(other));
            tokio::select! {
                biased;
                // A sender that is dropped wants the end just as well.
                _ = &mut end => break,
                // This holds a sender itself.
                Some(news) = self.process_news.recv() => self.process(news),
                Ok(token) = self.tokens.recv_async() => self.token(&token),
                Ok(question) = self.questions.recv_async() => self.answer(question).await,
                (kind, due) = until(next) => self.do_due(&kind, due).await,
            }
        }
        self.end_all().await;
    }

    /// Nobody listens any more once all is over.
    fn tell(&self, news: RoleNews) {
        let _ = self.news.send(news);
    }

    fn spawn(&mut self, kind: &RoleKind) -> Result<(), Failure> {
        let Some(role) = self.roles.get_mut(kind) else {
            return Ok(());
        };
        // Before the process is there, so that whatever it says is later.
        let now_ms = epoch_now();
        let process = RoleProcess::start(
            kind,
            &self.setup,
            &self.state.path,
            &self.endpoints,
            &self.tell,
        )?;
        role.spawned(process, now_ms);
        let processes = self.roles.iter().filter_map(|(kind, role)| {
            let process = role.process.as_ref()?;
            Some(format!("{kind} {}\n", process.pid))
        });
        let processes: String = processes.collect();
        self.state.note(&processes);
        Ok(())
    }

    fn process(&mut self, news: ProcessNews) {
        match news {
            ProcessNews::Said(kind, line) => {
                if let Some(role) = self.roles.get_mut(&kind) {
                    role.said(&line);
                }
                self.tell(RoleNews::Said(kind, line));
            }
            ProcessNews::Ended(kind, end, how) => self.ended(&kind, end, how),
        }
    }

    fn ended(&mut self, kind: &RoleKind, end: End, how: String) {
        let Some(role) = self.roles.get_mut(kind) else {
            return;
        };
        let pid = role.pid();
        let told = match role.ended(end, &how) {
            Verdict::Again(next_in) => RoleNews::Ended {
                role: kind.clone(),
                pid,
                how,
                next_in,
            },
            Verdict::GiveUp => RoleNews::GivenUp {
                role: kind.clone(),
                how: role.last_words(&how),
            },
        };
        self.tell(told);
    }

    fn token(&mut self, token: &Sample) {
        let read = Keys::read_alive(token.key_expr().as_str());
        let Some((name, epoch)) = read else { return };
        let mut roles = self.roles.iter_mut();
        let Some((kind, role)) = roles.find(|(kind, _)| kind.name() == name) else {
            return;
        };
        let kind = kind.clone();
        role.token(epoch, token.kind() == SampleKind::Put);
        let pid = role.pid();
        match role.phase {
            Phase::Starting if role.answers() => {
                let after = role.ready();
                let restarts = role.restarts;
                self.tell(RoleNews::Ready {
                    role: kind,
                    pid,
                    restarts,
                    after,
                });
            }
            Phase::Silent { told, .. } if role.answers() => {
                role.phase = Phase::Ready;
                if told {
                    self.tell(RoleNews::Answers { role: kind, pid });
                }
            }
            Phase::Ready if !role.answers() => {
                role.phase = Phase::Silent {
                    since: Instant::now(),
                    told: false,
                };
            }
            _ => {}
        }
    }

    async fn do_due(&mut self, kind: &RoleKind, due: Due) {
        match due {
            Due::Start => {
                if let Err(failure) = self.spawn(kind) {
                    self.ended(kind, End::Own, failure.what);
                }
            }
            Due::TellSilence => {
                let cut_off = self.cut_off().await;
                let Some(role) = self.roles.get_mut(kind) else {
                    return;
                };
                let since = Instant::now();
                let told = !cut_off;
                role.phase = Phase::Silent { since, told };
                let pid = role.pid();
                if told {
                    self.tell(RoleNews::Silent {
                        role: kind.clone(),
                        pid,
                    });
                }
            }
            Due::Kill => {
                let cut_off = self.cut_off().await;
                let Some(role) = self.roles.get_mut(kind) else {
                    return;
                };
                if cut_off {
                    role.wait_longer();
                    return;
                }
                let pid = role.pid();
                let after = role.kill();
                self.tell(RoleNews::Killed {
                    role: kind.clone(),
                    pid,
                    after,
                });
            }
        }
    }

    /// Whether it is this process whom nobody hears: with a router elsewhere, all roles vanish when that
    /// is gone.
    async fn cut_off(&self) -> bool {
        !self.setup.connect.is_empty() && self.session.info().routers_zid().await.count() == 0
    }

    async fn answer(&self, question: Query) {
        let roles = self.roles.iter();
        let roles = roles.map(|(kind, role)| (kind.to_string(), role.status()));
        let answer = json!({
            "v": wire::VERSION,
            "agent": "supervisor",
            "status": {
                "process": std::process::id(),
                "roles": Value::Object(roles.collect()),
            },
        });
        let key = question.key_expr().clone();
        if let Err(error) = question.reply(key, answer.to_string()).await {
            tracing::warn!("cannot say how the roles are: {error}");
        }
    }

    /// Ends all of them, and returns when they have ended.
    async fn end_all(mut self) {
        let roles = std::mem::take(&mut self.roles).into_iter();
        let (reality, others): (Vec<_>, Vec<_>) = roles.partition(|(kind, _)| kind.is_reality());
        for roles in [others, reality] {
            end(roles.into_iter().map(|(_, role)| role)).await;
        }
    }
}

async fn end(roles: impl Iterator<Item = Watched>) {
    let processes: Vec<RoleProcess> = roles.filter_map(|role| role.process).collect();
    let ending: Vec<_> = processes
        .into_iter()
        .map(|mut process| {
            process.tell_to_end();
            process.ended()
        })
        .collect();
    for ended in ending {
        ended.await;
    }
}

/// Returns what is due, when it is.
async fn until(next: Option<(Instant, RoleKind, Due)>) -> (RoleKind, Due) {
    match next {
        None => pending().await,
        Some((at, kind, due)) => {
            tokio::time::sleep_until(at).await;
            (kind, due)
        }
    }
}
