//! Who can say what to whom, with the ready configurations: everybody tries everything, over real
//! zenoh, and what arrives is what is meant to.
#![allow(clippy::unwrap_used, clippy::panic)]

mod team;

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use agent_link::Session;
use agent_link::session::{self, Role};
use tempfile::TempDir;
use tokio::time::{sleep, timeout};
use zenoh::query::{ConsolidationMode, QueryTarget};

const PATIENCE: Duration = Duration::from_secs(60);

/// What may be said: the key, who may say it, and whom that reaches.
type Row = (
    &'static str,
    &'static [&'static str],
    &'static [&'static str],
);

/// Who can say what to whom.
struct Table {
    everybody: &'static [&'static str],
    /// What is asked.
    questions: &'static [Row],
    /// What is put.
    puts: &'static [Row],
}

/// One robot.
const ROBOT: Table = Table {
    everybody: &[
        "operator",
        "viewer",
        "supervisor",
        "parent",
        "child",
        "executor",
        "world",
    ],
    questions: &QUESTIONS,
    puts: &PUTS,
};

/// Who may ask a robot for something.
const ASK: &[&str] = &["operator", "supervisor"];

/// Who may look at it.
const LOOK: &[&str] = &["operator", "viewer", "supervisor"];

/// What may be asked of a robot.
const QUESTIONS: [Row; 30] = [
    ("goal/normal", ASK, &["parent"]),
    ("goal/normal/operator", &["operator"], &["parent"]),
    ("goal/normal/viewer", &[], &[]),
    ("goal/emergency", ASK, &["parent"]),
    ("goal/emergency/operator", &["operator"], &["parent"]),
    ("goal/emergency/child", &[], &[]),
    ("goal/command", ASK, &["parent"]),
    ("goal/answers", &[], &[]),
    ("facts", ASK, &["parent", "child", "world"]),
    ("parent/status", LOOK, &["parent"]),
    ("child/belief", LOOK, &["child"]),
    ("executor/stack", LOOK, &["executor"]),
    ("world/plans", LOOK, &["world"]),
    ("parent/goals", LOOK, &["parent"]),
    ("parent/journal", LOOK, &["parent"]),
    ("parent/instruction", &[], &[]),
    ("parent/report", &["child"], &["parent"]),
    ("parent/facts", &[], &[]),
    ("child/instruction", &["parent"], &["child"]),
    ("child/report", &["executor"], &["child"]),
    ("child/facts", &["parent"], &["child"]),
    ("executor/instruction", &["child"], &["executor"]),
    ("executor/report", &[], &[]),
    ("executor/sensor", &["world"], &["executor"]),
    ("executor/facts", &["child"], &["executor"]),
    ("world/command", &["executor"], &["world"]),
    ("world/instruction", &[], &[]),
    (
        "supervisor/status",
        &["operator", "viewer"],
        &["supervisor"],
    ),
    ("supervisor/instruction", &[], &[]),
    (
        "clock",
        &[
            "operator",
            "viewer",
            "supervisor",
            "parent",
            "child",
            "executor",
        ],
        &["world"],
    ),
];

/// The same for what is put.
const PUTS: [Row; 21] = [
    ("goal/normal", ASK, &["parent"]),
    ("goal/normal/operator", &["operator"], &["parent"]),
    ("goal/normal/viewer", &[], &[]),
    ("goal/emergency", ASK, &["parent"]),
    ("goal/emergency/operator", &["operator"], &["parent"]),
    ("goal/emergency/child", &[], &[]),
    ("goal/command", &[], &[]),
    ("goal/answers", &["parent"], LOOK),
    ("facts", ASK, &["parent", "child", "world"]),
    ("event", &["parent", "child", "executor", "world"], LOOK),
    ("parent/instruction", &[], &[]),
    ("parent/report", &[], &[]),
    ("child/instruction", &[], &[]),
    ("child/report", &[], &[]),
    ("child/facts", &["child"], &["parent"]),
    ("executor/instruction", &[], &[]),
    ("executor/facts", &["executor"], &["child"]),
    ("executor/sensor", &[], &[]),
    ("world/command", &[], &[]),
    ("world/pose", &["world"], LOOK),
    ("clock", &[], &[]),
];

/// What arrived: how it was said, on which key, by whom, and who heard it.
type Heard = BTreeSet<(&'static str, String, String, String)>;

impl Table {
    fn all(&self) -> [(&'static str, &'static [Row]); 2] {
        [("ask", self.questions), ("put", self.puts)]
    }

    /// What is meant to arrive.
    fn intended(&self) -> Heard {
        let mut heard = Heard::new();
        for (how, table) in self.all() {
            for (key, senders, receivers) in table {
                for sender in *senders {
                    for receiver in receivers.iter().filter(|receiver| *receiver != sender) {
                        let [key, sender, receiver] =
                            [key, sender, receiver].map(|s| (*s).to_owned());
                        heard.insert((how, key, sender, receiver));
                    }
                }
            }
        }
        heard
    }
}

fn make(way: &str, folder: &Path) {
    let made = Command::new(env!("CARGO_BIN_EXE_intermezzo"))
        .arg(way)
        .arg(folder)
        .output();
    assert!(made.unwrap().status.success());
}

/// Listens to everything, and answers whatever is asked.
async fn listen(session: &Session, own: &'static str, table: &Table, heard: &Arc<Mutex<Heard>>) {
    for (how, table) in table.all() {
        for (key, _, _) in table {
            let full = format!("intermezzo/r/{key}");
            let heard = heard.clone();
            let note = move |payload: Option<&zenoh::bytes::ZBytes>| {
                let sender = payload.unwrap().try_to_string().unwrap().into_owned();
                // What is said within a session passes no router.
                if sender != own {
                    let mut heard = heard.lock().unwrap();
                    heard.insert((how, (*key).to_owned(), sender, own.to_owned()));
                }
            };
            if how == "ask" {
                let queryable = session.declare_queryable(full).callback(move |query| {
                    note(query.payload());
                });
                queryable.background().await.unwrap();
            } else {
                let subscriber = session.declare_subscriber(full).callback(move |sample| {
                    note(Some(sample.payload()));
                });
                subscriber.background().await.unwrap();
            }
        }
    }
}

/// Says everything, once.
async fn say_everything(session: &Session, own: &str, table: &Table) {
    for (key, _, _) in table.puts {
        let put = session.put(format!("intermezzo/r/{key}"), own);
        put.await.unwrap();
    }
    let mut answers = Vec::new();
    for (key, _, _) in table.questions {
        let asked = session
            .get(format!("intermezzo/r/{key}"))
            .payload(own)
            .target(QueryTarget::All)
            .consolidation(ConsolidationMode::None)
            .timeout(Duration::from_secs(5));
        answers.push(asked.await.unwrap());
    }
    for answer in answers {
        // All have heard it, or nobody could.
        while answer.recv_async().await.is_ok() {}
    }
}

async fn everybody_tries_everything(way: &str, table: &Table) {
    let keys = TempDir::new().unwrap();
    make(way, keys.path());
    let file = |name: &str| keys.path().join(format!("{name}.json5"));
    let router = Role::Router { listen: Vec::new() };
    let router = session::open(&router, Some(&file("router"))).await.unwrap();
    let connect = session::endpoints(&router).await;
    let heard = Arc::new(Mutex::new(Heard::new()));
    let mut sessions = Vec::new();
    for name in table.everybody {
        let connect = connect.clone();
        let client = Role::Client { connect };
        let session = session::open(&client, Some(&file(name))).await.unwrap();
        listen(&session, name, table, &heard).await;
        sessions.push((name, session));
    }
    let intended = table.intended();
    let arrives = async {
        loop {
            for (name, session) in &sessions {
                say_everything(session, name, table).await;
            }
            if heard.lock().unwrap().is_superset(&intended) {
                return;
            }
            // Who listens is told with some delay.
            sleep(Duration::from_millis(50)).await;
        }
    };
    let arrived = timeout(PATIENCE, arrives).await;
    // Once more, now that everybody knows of everybody.
    for (name, session) in &sessions {
        say_everything(session, name, table).await;
    }
    let heard = heard.lock().unwrap().clone();
    let missing: Vec<_> = intended.difference(&heard).collect();
    assert!(arrived.is_ok(), "{way}: did not arrive: {missing:?}");
    let leaked: Vec<_> = heard.difference(&intended).collect();
    assert!(leaked.is_empty(), "{way}: arrived all the same: {leaked:?}");
    for (_, session) in sessions {
        session::close(session).await;
    }
    session::close(router).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn with_certificates_only_what_is_permitted_arrives() {
    everybody_tries_everything("certs", &ROBOT).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn with_passwords_only_what_is_permitted_arrives() {
    everybody_tries_everything("passwords", &ROBOT).await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn what_is_far_too_large_is_not_even_carried() {
    let keys = TempDir::new().unwrap();
    make("passwords", keys.path());
    let file = |name: &str| keys.path().join(format!("{name}.json5"));
    let router = Role::Router { listen: Vec::new() };
    let router = session::open(&router, Some(&file("router"))).await.unwrap();
    let connect = session::endpoints(&router).await;
    let parent = enter(&connect, Some(&file("parent"))).await.unwrap();
    let operator = enter(&connect, Some(&file("operator"))).await.unwrap();
    let sizes = Arc::new(Mutex::new(Vec::new()));
    let noted = sizes.clone();
    let key = "intermezzo/r/goal/normal";
    let queryable = parent.declare_queryable(key).callback(move |query| {
        let size = query.payload().unwrap().len();
        noted.lock().unwrap().push(size);
    });
    queryable.background().await.unwrap();
    let small_one_arrives = async {
        while sizes.lock().unwrap().is_empty() {
            for size in [2_000_000, 100_000] {
                let asked = operator.get(key).payload(vec![b'x'; size]);
                let answers = asked.timeout(Duration::from_secs(5)).await.unwrap();
                while answers.recv_async().await.is_ok() {}
            }
        }
    };
    timeout(PATIENCE, small_one_arrives).await.unwrap();
    assert_eq!(*sizes.lock().unwrap(), [100_000]);
    session::close(operator).await;
    session::close(parent).await;
    session::close(router).await;
}

/// Tries to get in. `None` if that is refused.
async fn enter(connect: &[String], file: Option<&Path>) -> Option<Session> {
    let connect = connect.to_vec();
    let client = Role::Client { connect };
    let session = timeout(PATIENCE, session::open(&client, file)).await;
    session.unwrap().ok()
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn who_proves_nothing_or_the_wrong_thing_gets_in_nowhere() {
    let folder = TempDir::new().unwrap();
    for way in ["certs", "passwords"] {
        let (own, other) = (
            folder.path().join(way),
            folder.path().join(format!("{way}-2")),
        );
        make(way, &own);
        make(way, &other);
        let router = Role::Router { listen: Vec::new() };
        let file = own.join("router.json5");
        let router = session::open(&router, Some(&file)).await.unwrap();
        let connect = session::endpoints(&router).await;
        // Somebody with no proof at all, and an operator of another authority, or with another's
        // password.
        let foreign = other.join("operator.json5");
        for file in [None, Some(foreign.as_path())] {
            assert!(enter(&connect, file).await.is_none(), "{way}: {file:?}");
        }
        let trusted = enter(&connect, Some(&own.join("operator.json5"))).await;
        session::close(trusted.unwrap()).await;
        session::close(router).await;
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn a_client_s_certificate_does_not_make_a_router() {
    let folder = TempDir::new().unwrap();
    let keys = folder.path().join("keys");
    make("certs", &keys);
    // The child listens with its own certificate as if it were the router.
    let text = std::fs::read_to_string(keys.join("router.json5")).unwrap();
    let posing = keys.join("posing.json5");
    let text = text.replace("router.pem", "child.pem");
    std::fs::write(&posing, text.replace("router-key.pem", "child-key.pem")).unwrap();
    let router = Role::Router { listen: Vec::new() };
    let router = session::open(&router, Some(&posing)).await.unwrap();
    let connect = session::endpoints(&router).await;
    let deceived = enter(&connect, Some(&keys.join("operator.json5"))).await;
    assert!(deceived.is_none(), "an operator talks to a child");
    session::close(router).await;
}
