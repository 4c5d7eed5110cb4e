//! Machines that do little, a robot to put them in, and a wire that loses answers.

#![allow(dead_code, clippy::unwrap_used, missing_docs)]

pub mod disk;

use std::collections::{BTreeSet, VecDeque};
use std::future::Future;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use agent_core::model::{Atom, FactChange, Time};
use agent_core::protocol::{
    ActionId, Answer, Command, Durable, Event, Happening, Input, Instruction, Ledger, Machine,
    Output, Rejection, Reply, Report, Row, Rows, Unreadable, read_row,
};
use agent_link::session::{self, Role, Session};
use agent_link::{Clock, Inspect, Keys, LinkError, Memory, Wiring, drive};
use serde_json::{Value, json};
use tokio::sync::{Mutex, mpsc, oneshot, watch};
use tokio::task::JoinHandle;

/// Long enough for a machine that has other things to do, short enough to notice.
const PATIENCE: Duration = Duration::from_secs(60);

pub async fn within<T>(future: impl Future<Output = T>) -> T {
    tokio::time::timeout(PATIENCE, future)
        .await
        .expect("a test does not take a minute")
}

pub fn id(number: u64) -> ActionId {
    ActionId {
        agent: "child".into(),
        epoch: 1,
        number,
    }
}

pub fn execute(number: u64) -> Instruction {
    Instruction::Execute {
        id: id(number),
        action: Atom::new("go", ["n1"]),
        map: None,
    }
}

/// Notes what it hears, and says what it was made to say.
#[derive(Debug)]
pub struct Toy {
    name: &'static str,
    executes: bool,
    thinks: bool,
    commands: Option<&'static str>,
    tells_of_goals: bool,
    outputs: VecDeque<Output<Value>>,
    pub seen: Vec<Input<Value>>,
    heard_before: Vec<String>,
    ledger: Ledger,
    tell: watch::Sender<Vec<Input<Value>>>,
}

impl Toy {
    pub fn new(name: &'static str) -> Self {
        Self {
            name,
            executes: false,
            thinks: false,
            commands: None,
            tells_of_goals: false,
            outputs: VecDeque::new(),
            seen: Vec::new(),
            heard_before: Vec::new(),
            ledger: Ledger::default(),
            tell: watch::Sender::new(Vec::new()),
        }
    }

    /// Reports that each execution has begun, and then that it was a success.
    pub fn executing(mut self) -> Self {
        self.executes = true;
        self
    }

    /// Always has more to think about, and never comes to an end.
    pub fn thinking(mut self) -> Self {
        self.thinks = true;
        self
    }

    /// Passes a command to suspend on to this executor.
    pub fn commanding(mut self, executor: &'static str) -> Self {
        self.commands = Some(executor);
        self
    }

    /// Says of each goal at once that it was reached.
    pub fn telling_of_goals(mut self) -> Self {
        self.tells_of_goals = true;
        self
    }

    pub fn instructing(mut self, to: &str, instructions: Vec<Instruction>) -> Self {
        let outputs = instructions
            .into_iter()
            .map(|instruction| Output::Instruct {
                to: to.into(),
                instruction,
            });
        self.outputs.extend(outputs);
        self
    }

    /// Tells that superior alone.
    pub fn showing(mut self, to: &str, facts: Vec<FactChange>) -> Self {
        self.outputs.push_back(Output::Seen {
            to: to.into(),
            facts,
            reported: false,
        });
        self
    }

    pub fn telling(mut self, facts: Vec<FactChange>) -> Self {
        let event = Event {
            at: Time::ZERO,
            goal: None,
            stack_depth: 0,
            what: Happening::BeliefChanged {
                changes: facts.clone(),
            },
        };
        self.outputs.push_back(Output::Observed {
            facts,
            reported_to: None,
        });
        self.outputs.push_back(Output::Event(event));
        self
    }
}

impl Machine for Toy {
    type In = Value;
    type Out = Value;

    fn handle(&mut self, _now: Time, input: Input<Value>) -> Option<Reply> {
        if matches!(input, Input::Wake | Input::Neighbour { .. }) {
            return None;
        }
        self.seen.push(input.clone());
        self.tell.send_replace(self.seen.clone());
        match input {
            Input::Instruction { from, instruction } => Some(Reply::Instruction({
                if let (true, Instruction::Execute { id, .. }) = (self.executes, &instruction) {
                    let success = Report::Success { facts: Vec::new() };
                    for report in [Report::Started, success] {
                        self.outputs.push_back(Output::Report {
                            to: from.clone(),
                            id: id.clone(),
                            report,
                        });
                    }
                }
                match instruction {
                    Instruction::Suspend { .. } => Answer::Suspending,
                    _ => Answer::Accepted,
                }
            })),
            Input::Goal(goal) => Some(Reply::Goal(match goal.tasks[0].name.as_str() {
                "go" => {
                    let id = goal.id.unwrap_or_else(|| "unnamed".into());
                    if self.tells_of_goals {
                        self.outputs.push_back(Output::Event(Event {
                            at: Time::ZERO,
                            goal: Some(id.clone()),
                            stack_depth: 0,
                            what: Happening::GoalSucceeded,
                        }));
                    }
                    Ok(id)
                }
                _ => Err(Rejection::NoTask),
            })),
            Input::Command(command) => {
                if let (Some(executor), Command::Suspend(_)) = (self.commands, command) {
                    self.outputs.push_back(Output::Instruct {
                        to: executor.into(),
                        instruction: Instruction::Suspend { id: id(1) },
                    });
                }
                Some(Reply::Command(Ok(())))
            }
            _ => None,
        }
    }

    fn poll_output(&mut self) -> Option<Output<Value>> {
        self.outputs.pop_front()
    }

    fn wake_at(&self) -> Option<Time> {
        self.thinks.then_some(Time::ZERO)
    }
}

impl Durable for Toy {
    fn write_down(&mut self) -> Vec<Row> {
        self.ledger.put("m/heard".to_owned(), &self.heard());
        self.ledger.take()
    }

    fn recall(&mut self, rows: &Rows) -> Result<(), Unreadable> {
        self.ledger = Ledger::of(rows, "m/");
        self.heard_before = read_row(rows, "m/heard")?.unwrap_or_default();
        // What it was made to say it has said.
        self.outputs.clear();
        Ok(())
    }
}

impl Toy {
    /// What it has heard in this life and those before, in words.
    pub fn heard(&self) -> Vec<String> {
        let seen = self.seen.iter().map(|input| format!("{input:?}"));
        self.heard_before.iter().cloned().chain(seen).collect()
    }
}

impl Inspect for Toy {
    fn status(&self) -> Value {
        json!({ "name": self.name })
    }
}

/// A router, and who is connected to it.
pub struct Robot {
    pub keys: Keys,
    router: Arc<Session>,
    endpoints: Vec<String>,
    clock: Clock,
}

impl Robot {
    pub async fn start() -> Self {
        let router = Role::Router { listen: Vec::new() };
        let router = within(session::open(&router, None)).await.unwrap();
        let endpoints = session::endpoints(&router).await;
        assert!(endpoints[0].starts_with("tcp/127.0.0.1:"), "{endpoints:?}");
        Self {
            keys: Keys::new("near").unwrap(),
            router: Arc::new(router),
            endpoints,
            clock: Clock::start(1.0).unwrap(),
        }
    }

    /// Another robot on the same router.
    pub fn other(&self, name: &str) -> Self {
        Self {
            keys: Keys::new(name).unwrap(),
            router: self.router.clone(),
            endpoints: self.endpoints.clone(),
            clock: self.clock,
        }
    }

    pub async fn client(&self) -> Session {
        let connect = self.endpoints.clone();
        within(session::open(&Role::Client { connect }, None))
            .await
            .unwrap()
    }

    /// Drives a toy in a session of its own. Returns once it listens.
    pub async fn drive(&self, toy: Toy, wire: impl FnOnce(&mut Wiring)) -> (Driven, Seen) {
        self.drive_with(toy, None, wire).await
    }

    /// As [`drive`](Self::drive), with a journal.
    pub async fn drive_with(
        &self,
        toy: Toy,
        memory: Memory,
        wire: impl FnOnce(&mut Wiring),
    ) -> (Driven, Seen) {
        let session = self.client().await;
        let seen = Seen(toy.tell.subscribe());
        let name = toy.name;
        let mut wiring = Wiring::new(&self.keys, name, 1);
        wire(&mut wiring);
        let alive = self.wait_until_alive(name, wiring.epoch).await;
        let (stop, stopped) = oneshot::channel::<()>();
        let clock = self.clock;
        let task = tokio::spawn(async move {
            let stopped = async {
                let _ = stopped.await;
            };
            let result = drive(toy, memory, wiring, &session, clock, stopped).await;
            session::close(session).await;
            result
        });
        within(alive).await;
        (Driven { stop, task }, seen)
    }

    /// From now on, waits for an agent to appear.
    async fn wait_until_alive(&self, name: &str, epoch: u64) -> impl Future<Output = ()> + use<> {
        let (appeared, mut wait) = mpsc::unbounded_channel();
        let subscriber = self
            .router
            .liveliness()
            // With whatever memory.
            .declare_subscriber(format!("{}$*", self.keys.alive(name, epoch).unwrap()))
            .callback(move |_| {
                let _ = appeared.send(());
            })
            .await
            .unwrap();
        async move {
            wait.recv().await;
            drop(subscriber);
        }
    }

    /// A plain put, as any zenoh client does it.
    pub async fn put(&self, session: &Session, key: &str, text: &str) {
        session.put(key, text).await.unwrap();
    }

    /// A plain query, as any zenoh client does it.
    pub async fn ask(&self, session: &Session, key: &str, text: &str) -> String {
        let replies = session.get(key).payload(text).await.unwrap();
        let reply = replies.recv_async().await.unwrap();
        let sample = reply.result().unwrap();
        sample.payload().try_to_string().unwrap().into_owned()
    }

    /// Answers all queries on a key, until the session is closed.
    pub async fn answer(&self, session: &Session, key: &str, text: String) {
        let (queries, mut queue) = mpsc::unbounded_channel::<zenoh::query::Query>();
        session
            .declare_queryable(key)
            .complete(true)
            .callback(move |query| {
                let _ = queries.send(query);
            })
            .background()
            .await
            .unwrap();
        let key = key.to_owned();
        tokio::spawn(async move {
            while let Some(query) = queue.recv().await {
                query.reply(&key, text.clone()).await.unwrap();
            }
        });
    }

    /// What is published on a key, as JSON. Returns once the subscription has reached the others.
    pub async fn listen(&self, session: &Session, key: &str) -> mpsc::UnboundedReceiver<Value> {
        let (heard, queue) = mpsc::unbounded_channel();
        session
            .declare_subscriber(key)
            .callback(move |sample| {
                let text = sample.payload().to_bytes();
                let _ = heard.send(serde_json::from_slice(&text).unwrap());
            })
            .background()
            .await
            .unwrap();
        queue
    }

    /// Carries queries on `rest` of this robot to `to`, and loses the first answer to each.
    pub async fn courier(&self, rest: &str, to: &Self) -> Courier {
        let session = self.client().await;
        let own = format!("intermezzo/{}/{rest}", self.keys.robot());
        let other = format!("intermezzo/{}/{rest}", to.keys.robot());
        let (queries, mut queue) = mpsc::unbounded_channel();
        let queryable = session
            .declare_queryable(own.clone())
            .complete(true)
            .callback(move |query| {
                let _ = queries.send(query);
            })
            .await
            .unwrap();
        let lost = Arc::new(AtomicUsize::new(0));
        let count = lost.clone();
        tokio::spawn(async move {
            let _queryable = queryable;
            let carried = Mutex::new(BTreeSet::new());
            while let Some(query) = queue.recv().await {
                let text = query.payload().unwrap().try_to_string().unwrap();
                let replies = session.get(&other).payload(text.as_ref()).await.unwrap();
                let Ok(reply) = replies.recv_async().await else {
                    continue;
                };
                let answer = reply.result().unwrap().payload().clone();
                if carried.lock().await.insert(text.to_string()) {
                    count.fetch_add(1, Ordering::SeqCst);
                } else {
                    query.reply(&own, answer).await.unwrap();
                }
            }
        });
        Courier { lost }
    }

    pub async fn stop(self) {
        let router = Arc::into_inner(self.router);
        if let Some(router) = router {
            session::close(router).await;
        }
    }
}

/// Counts the answers that it lost.
pub struct Courier {
    lost: Arc<AtomicUsize>,
}

impl Courier {
    pub fn lost(&self) -> usize {
        self.lost.load(Ordering::SeqCst)
    }
}

/// What a toy has heard.
pub struct Seen(watch::Receiver<Vec<Input<Value>>>);

impl Seen {
    pub async fn until(mut self, enough: impl Fn(&[Input<Value>]) -> bool) {
        self.0.wait_for(|seen| enough(seen)).await.unwrap();
    }
}

/// A toy that is being driven.
pub struct Driven {
    stop: oneshot::Sender<()>,
    task: JoinHandle<Result<Toy, LinkError>>,
}

impl Driven {
    pub async fn stop(self) -> Result<Toy, LinkError> {
        let _ = self.stop.send(());
        within(self.task).await.unwrap()
    }

    /// Ends it as a kill does: nothing more is said or written.
    pub fn kill(self) {
        self.task.abort();
    }

    /// Waits for an end that comes by itself.
    pub async fn ended(self) -> Result<Toy, LinkError> {
        let result = within(self.task).await.unwrap();
        drop(self.stop);
        result
    }
}
