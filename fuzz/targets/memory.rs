//! What an agent and a robot's journal make of memories that are not as they were written. The corpus is tried in
//! the same way in the ordinary tests.

use std::io;
use std::sync::Arc;

use agent_core::agent::{Agent, Configuration, Executors, Policy};
use agent_core::language::{parse_fact_change, parse_tasks};
use agent_core::model::{Map, Time};
use agent_core::planner::{NaivePlanner, Settings};
use agent_core::protocol::{
    Answer, Arrival, Effect, GoalRequest, Input, Report, Rows, Station, Urgency,
};
use agent_journal::{Disk, Identity, Journal, JournalError, Medium};

use crate::level;

/// How the level's one action is suspended.
const MODEL: &str = r#"
observable = ["in"]
[action.switch]
duration_s = 3
[action.switch.suspension]
effect = ["(hand-on ?l)"]
resume = "(resume-switch ?l)"
"#;

type Desk = Station<Agent<NaivePlanner>, ()>;

fn agent(epoch: u64) -> Agent<NaivePlanner> {
    let names = ["lamps.hddl", "lamps.toml"];
    let level = maps::level_from_texts(level::LEVEL, MODEL, names).expect("it is in order");
    let mut map = Map::default();
    for lamp in ["l1", "l2"] {
        map.objects.insert(lamp.into(), "lamp".into());
        let place = parse_fact_change(&format!("(in {lamp} hall)")).expect("it is a fact");
        map.news.push(place);
        let watts = parse_fact_change(&format!("(= (watts {lamp}) 5)")).expect("it is a value");
        map.news.push(watts);
    }
    let configuration = Configuration {
        name: "keeper".into(),
        epoch,
        domain: Arc::new(level.domain),
        model: Arc::new(level.model),
        map,
        maps_below: Arc::new(()),
        facts: Vec::new(),
        executors: Executors::one("hand"),
        policy: Policy::default(),
    };
    Agent::new(configuration, NaivePlanner::new(Settings::default()))
}

/// What an agent has written that is in the middle of an emergency, above a goal that it has set aside.
pub fn written() -> Rows {
    let mut desk = Desk::new("keeper".into(), 1, agent(1));
    let mut rows = Rows::new();
    let mut now = 0.0;
    let mut goals = [
        ("light l1", Urgency::Normal),
        ("light l2", Urgency::Emergency),
    ]
    .into_iter();
    for _ in 0..40 {
        now += 0.1;
        let at = Time::from_secs(now);
        if let Some(changed) = desk.write_down() {
            for row in changed {
                match row.value {
                    Some(value) => rows.insert(row.key, value),
                    None => rows.remove(&row.key),
                };
            }
            desk.written();
        }
        let mut said = Vec::new();
        while let Some(effect) = desk.poll_effect() {
            said.push(effect);
        }
        let mut quiet = true;
        for effect in said {
            if let Effect::Instruct { to, message } = effect {
                quiet = false;
                let suspends = matches!(
                    message.body,
                    agent_core::protocol::Instruction::Suspend { .. }
                );
                let answer = if suspends {
                    Answer::Suspending
                } else {
                    Answer::Accepted
                };
                let (line, seq) = (1, message.seq);
                desk.handle(
                    at,
                    Arrival::Answered {
                        by: to,
                        line,
                        seq,
                        answer,
                    },
                    None,
                );
                if suspends {
                    let id = message.body.id().clone();
                    let report = Report::Suspended { facts: Vec::new() };
                    desk.handle(at, Arrival::Input(Input::Report { id, report }), None);
                }
            }
        }
        if quiet && let Some((task, urgency)) = goals.next() {
            let goal = GoalRequest {
                id: None,
                tasks: parse_tasks(&format!("({task})")).expect("it is a task"),
                urgency,
                priority: 0,
                deadline: None,
            };
            desk.handle(at, Arrival::Input(Input::Goal(goal)), None);
        } else {
            desk.handle(at, Arrival::Input(Input::Wake), None);
        }
    }
    rows
}

/// One row is what the input says instead of what was written. The agent refuses, or is one that can go on. Returns
/// whether it goes on.
pub fn recall(written: &Rows, input: &[u8]) -> bool {
    let Some((which, value)) = input.split_first() else {
        return false;
    };
    let mut rows = written.clone();
    let place = usize::from(*which) % rows.len().max(1);
    if let Some(row) = rows.values_mut().nth(place) {
        *row = value.to_vec();
    }
    match Desk::recall("keeper".into(), 2, agent(2), &rows) {
        Ok(mut desk) => {
            desk.machine().check();
            desk.handle(Time::from_secs(10.0), Arrival::Input(Input::Wake), None);
            desk.machine().check();
            true
        }
        Err(unreadable) => {
            assert!(!unreadable.key.is_empty(), "a row is named");
            false
        }
    }
}

/// A disk with a file on it that nobody may write to.
#[derive(Debug)]
struct Found(Arc<[u8]>);

impl agent_journal::StorageBackend for Found {
    fn len(&self) -> io::Result<u64> {
        Ok(self.0.len() as u64)
    }

    fn read(&self, offset: u64, out: &mut [u8]) -> io::Result<()> {
        let begin = usize::try_from(offset).map_err(io::Error::other)?;
        let end = begin.checked_add(out.len());
        let bytes = end.and_then(|end| self.0.get(begin..end));
        out.copy_from_slice(bytes.ok_or(io::ErrorKind::UnexpectedEof)?);
        Ok(())
    }

    fn set_len(&self, _: u64) -> io::Result<()> {
        unreachable!("a journal that is only looked at is not written to");
    }

    fn sync_data(&self) -> io::Result<()> {
        unreachable!("a journal that is only looked at is not written to");
    }

    fn write(&self, _: u64, _: &[u8]) -> io::Result<()> {
        unreachable!("a journal that is only looked at is not written to");
    }
}

impl Disk for Found {
    fn name(&self) -> String {
        "found".to_owned()
    }

    fn look(&self) -> io::Result<Option<Medium>> {
        Ok(Some(Box::new(Self(self.0.clone()))))
    }

    fn open(&self) -> io::Result<Medium> {
        Err(io::ErrorKind::PermissionDenied.into())
    }

    fn begin_anew(&self) -> io::Result<Medium> {
        Err(io::ErrorKind::PermissionDenied.into())
    }

    fn put_in_place(&self) -> io::Result<()> {
        Err(io::ErrorKind::PermissionDenied.into())
    }
}

/// Whose journal is looked for.
pub fn identity() -> Identity {
    let [robot, role, place] = ["robot", "parent", "here"].map(str::to_owned);
    Identity { robot, role, place }
}

/// A file that is said to be a journal. Returns whether it is one.
pub fn open(file: &[u8]) -> bool {
    match Journal::on(Found(file.into()), identity()) {
        Ok(_) => true,
        Err(JournalError::Io { .. }) => false,
        Err(refused) => {
            assert!(
                refused.to_string().contains("found"),
                "it says which file: {refused}"
            );
            false
        }
    }
}
