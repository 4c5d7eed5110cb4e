//! Somebody who only listens, and keeps the books.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::{Arc, Mutex, MutexGuard};
use std::time::Duration;

use agent_link::{Keys, Session};
use serde_json::Value;
use tokio::sync::watch;
use tokio::time::Instant;
use zenoh::sample::SampleKind;

/// What was heard of the robot.
#[derive(Debug, Default)]
pub struct Books {
    /// Every event once, by agent and number.
    events: BTreeMap<(String, u64), Value>,
    /// When the memory of each agent began.
    lines: BTreeMap<String, u64>,
    /// What was done to the world. A world that was killed may have forgotten the last of it, and count
    /// on from before that: so not by number.
    done: BTreeMap<String, Value>,
    /// The ends of each goal of the parent, by the numbers of the events.
    pub ends: BTreeMap<String, BTreeMap<u64, String>>,
    /// The starts of each role that are there.
    alive: BTreeMap<String, BTreeSet<u64>>,
    /// What no listener should ever hear.
    pub faults: Vec<String>,
    /// How often each event was heard, repetitions left out.
    pub counts: BTreeMap<String, u64>,
    /// As the world tells it.
    pub odometer_m: f64,
    /// When the robot was last seen to move.
    pub moved: Option<Instant>,
    heard: u64,
    /// The latest event, for whoever waits for one.
    pub last: Option<(u64, Value)>,
}

impl Books {
    fn event(&mut self, event: Value) {
        let agent = event["agent"].as_str().unwrap().to_owned();
        let line = event["line"].as_u64().unwrap();
        let n = event["n"].as_u64().unwrap();
        // An agent whose memory begins anew would have lost what was accepted.
        let first = *self.lines.entry(agent.clone()).or_insert(line);
        if first != line {
            let fault = format!("the {agent} has lost its memory: {first}, then {line}");
            self.faults.push(fault);
        }
        let key = (agent.clone(), n);
        if let Some(before) = self.events.get(&key) {
            if *before != event {
                let fault = format!("number {n} of the {agent} is two events:\n{before}\n{event}");
                self.faults.push(fault);
            }
            return;
        }
        let what = event["event"].as_str().unwrap().to_owned();
        let ended = ["goal_succeeded", "goal_failed", "goal_unknown"];
        if agent == "parent" && ended.contains(&what.as_str()) {
            let goal = event["goal"].as_str().unwrap().to_owned();
            let ends = self.ends.entry(goal.clone()).or_default();
            ends.insert(n, what.clone());
            if ends.len() > 1 {
                let fault = format!("the goal {goal} has ended more than once: {ends:?}");
                self.faults.push(fault);
            }
        }
        *self.counts.entry(format!("{agent} {what}")).or_default() += 1;
        self.heard += 1;
        self.last = Some((self.heard, event.clone()));
        self.events.insert(key, event);
    }

    fn token(&mut self, name: &str, epoch: u64, there: bool) {
        let epochs = self.alive.entry(name.to_owned()).or_default();
        if there {
            epochs.insert(epoch);
        } else {
            epochs.remove(&epoch);
        }
    }

    fn seen(&mut self, odometer_m: f64) {
        // One that was killed may have forgotten some of the way.
        if odometer_m.to_bits() != self.odometer_m.to_bits() {
            self.moved = Some(Instant::now());
        }
        self.odometer_m = odometer_m;
    }

    /// The latest start of a role that is there.
    pub fn epoch(&self, role: &str) -> Option<u64> {
        self.alive.get(role)?.last().copied()
    }

    /// The world's own books, which go back only so far.
    pub fn world(&mut self, done: &[Value]) {
        for one in done {
            self.done.insert(one.to_string(), one.clone());
        }
    }

    /// How often that was done to its end.
    pub fn times(&self, deed: &str) -> usize {
        let done = self.done.values();
        done.filter(|one| one["to_the_end"] == true && one["what"] == deed)
            .count()
    }

    /// All that was told, agent by agent, for people who look for a fault.
    pub fn told(&self) -> String {
        let lines: Vec<String> = self.events.values().map(ToString::to_string).collect();
        lines.join("\n")
    }
}

/// Listens as long as it lives.
pub struct Observer {
    books: Arc<Mutex<Books>>,
    changed: watch::Receiver<()>,
    /// Their callbacks write the books.
    _listening: Box<dyn std::any::Any + Send + Sync>,
}

impl Observer {
    /// Begins to listen, over an open session.
    pub async fn new(session: &Session, keys: &Keys) -> Self {
        let books = Arc::new(Mutex::new(Books::default()));
        let (tell, changed) = watch::channel(());
        let tell = Arc::new(tell);
        let note = |books: &Arc<Mutex<Books>>| (books.clone(), tell.clone());
        let (noted, told) = note(&books);
        let events = session
            .declare_subscriber(keys.event())
            .callback(move |sample| {
                let event = serde_json::from_slice(&sample.payload().to_bytes()).unwrap();
                noted.lock().unwrap().event(event);
                told.send_replace(());
            })
            .await
            .unwrap();
        let (noted, told) = note(&books);
        let tokens = session
            .liveliness()
            .declare_subscriber(keys.alive_any())
            .history(true)
            .callback(move |sample| {
                if let Some((name, epoch)) = Keys::read_alive(sample.key_expr().as_str()) {
                    let there = sample.kind() == SampleKind::Put;
                    noted.lock().unwrap().token(name, epoch, there);
                    told.send_replace(());
                }
            })
            .await
            .unwrap();
        let (noted, told) = note(&books);
        let poses = session
            .declare_subscriber(keys.world_pose())
            .callback(move |sample| {
                let pose: Value = serde_json::from_slice(&sample.payload().to_bytes()).unwrap();
                let odometer_m = pose["snapshot"]["odometer_m"].as_f64().unwrap();
                noted.lock().unwrap().seen(odometer_m);
                told.send_replace(());
            })
            .await
            .unwrap();
        Self {
            books,
            changed,
            _listening: Box::new((events, tokens, poses)),
        }
    }

    /// What was heard so far.
    pub fn books(&self) -> MutexGuard<'_, Books> {
        self.books.lock().unwrap()
    }

    /// Returns what `wanted` finds in the books, as soon as it does; `None` after `patience`.
    pub async fn until<T>(
        &self,
        patience: Duration,
        mut wanted: impl FnMut(&Books) -> Option<T>,
    ) -> Option<T> {
        let mut changed = self.changed.clone();
        let looking = async {
            loop {
                changed.mark_unchanged();
                if let Some(found) = wanted(&self.books()) {
                    return found;
                }
                // The sender lives as long as the callbacks.
                changed.changed().await.unwrap();
            }
        };
        tokio::time::timeout(patience, looking).await.ok()
    }
}
