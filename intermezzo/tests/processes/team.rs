//! A restaurant: a room and its vehicles as processes, of which one is killed.

use std::fs;

use nix::sys::signal::Signal;
use serde_json::Value;
use tempfile::TempDir;
use tokio::io::{AsyncBufReadExt, BufReader, Lines};
use tokio::process::ChildStdout;
use tokio::time::timeout;

use crate::harness::{PATIENCE, Up, User};

/// The restaurant of the paper with a second carrier.
pub fn restaurant() -> TempDir {
    let dir = TempDir::new().unwrap();
    let second = "\n[vehicle.k4]\nstart = \"kitchen\"\ncan = [\"carry\"]\n\
        parts = [\"base\", \"arm\", \"tray\", \"eyes\", \"voice\"]\n";
    let room = maps::restaurant::ROOM.replace("\n[bottle]", &format!("{second}\n[bottle]"));
    for (file, text) in [
        ("map.geojson", maps::restaurant::MAP),
        ("node.hddl", maps::restaurant::DOMAIN),
        ("node.toml", maps::restaurant::MODEL),
        ("room.toml", &room),
    ] {
        fs::write(dir.path().join(file), text).unwrap();
    }
    dir
}

/// Reads on until a vehicle tells that.
async fn until_vehicle(up: &mut Up, what: &str, wanted: impl Fn(&Value) -> bool) -> Value {
    up.until(what, |told| told["agent"] != "room" && wanted(told))
        .await
}

pub async fn until_done(up: &mut Up, goals: &[&str]) {
    for goal in goals {
        let done = |told: &Value| told["goal"] == *goal && told["event"] == "goal_succeeded";
        if !up.story.iter().any(done) {
            up.until(&format!("the end of {goal}"), done).await;
        }
    }
}

/// What was handed over in reality: guest by guest.
pub async fn served(user: &User, who: &[&str]) -> Vec<String> {
    let said = user.ok(&[&["status", "--json"], who].concat()).await;
    let status: Value = serde_json::from_str(&said.out).unwrap();
    let done = status["agents"]["room"]["status"]["done"]
        .as_array()
        .unwrap();
    let served = done.iter().filter_map(|deed| {
        let guest = deed["what"]["served"]["guest"].as_str()?;
        Some(guest.to_owned())
    });
    served.collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn a_carrier_is_killed_with_a_drink_on_it_and_every_guest_is_served_once() {
    let user = User::new().await;
    let dir = restaurant();
    let place = dir.path().to_str().unwrap();
    let mut up = user.story(&["up", place, "--json", "--speed", "20"]).await;
    assert_eq!(up.processes.len(), 5, "{:?}", up.processes);
    for (guest, table, kind) in [("ann", "table1", "cola"), ("ben", "table2", "juice")] {
        let seated = format!("(seated {guest} {table})");
        user.ok(&["fact", &seated]).await;
        let goal = format!("(serve {kind} {guest})");
        user.ok(&["goal", &goal, "--id", guest]).await;
    }
    let stowed = until_vehicle(&mut up, "a bottle on a tray", |told| {
        told["event"] == "action_finished"
            && told["action"].as_str().unwrap().starts_with("(put-on-tray")
    })
    .await;
    let carrier = stowed["agent"].as_str().unwrap().to_owned();
    let before = up.story.len();
    up.signal(&carrier, Signal::SIGKILL);
    up.until_role(&carrier, "role_ended").await;
    let lost = |told: &Value| told["event"] == "vehicle_lost" && told["name"] == carrier;
    let lost = match up.story[before..].iter().find(|told| lost(told)) {
        Some(told) => told.clone(),
        None => until_vehicle(&mut up, "that it is missed", lost).await,
    };
    let held = lost["held"].as_array().unwrap();
    assert!(
        held.iter().any(|fact| {
            let fact = fact.as_str().unwrap();
            fact.starts_with("(with ") && fact.ends_with(&format!(" {carrier})"))
        }),
        "{lost}"
    );
    let tasks = lost["tasks"].as_array().unwrap();
    assert!(!tasks.is_empty(), "{lost}");
    until_done(&mut up, &["ann", "ben"]).await;
    // What it had to do was given to somebody again.
    for task in tasks {
        let mut given = up.story[before..]
            .iter()
            .filter(|told| told["event"] == "task_given" && told["what"] == *task);
        assert!(given.next().is_some(), "{task}");
    }
    let mut guests = served(&user, &[]).await;
    guests.sort();
    assert_eq!(guests, ["ann", "ben"]);
    let status = up.end_by(Signal::SIGINT).await;
    assert_eq!(status.code(), Some(0));
    up.assert_nobody_is_left().await;
}

async fn next_line(shown: &mut Lines<BufReader<ChildStdout>>) -> String {
    let line = timeout(PATIENCE, shown.next_line()).await;
    let line = line.expect("something more is shown").unwrap();
    line.expect("it goes on")
}

#[tokio::test(flavor = "multi_thread")]
async fn a_goal_can_be_for_one_vehicle_and_status_tells_of_all() {
    let user = User::new().await;
    let mut up = user
        .story(&["up", "restaurant", "--json", "--speed", "20"])
        .await;
    let mut watching = user.start(&["watch"]);
    let shown = watching.stdout.take().unwrap();
    let mut shown = BufReader::new(shown).lines();
    let heading = next_line(&mut shown).await;
    for name in ["k1", "k2", "k3"] {
        assert!(heading.contains(name), "{heading}");
    }
    user.ok(&["fact", "(spill kitchen)"]).await;
    let said = user
        .ok(&["goal", "(clean kitchen)", "--vehicle", "k3", "--wait"])
        .await;
    assert!(said.out.contains("done"), "{}", said.out);
    // Who watches sees it in the column of k3.
    while !next_line(&mut shown).await.contains("· (wipe kitchen)") {}
    watching.kill().await.unwrap();
    let said = user.ok(&["status"]).await;
    for name in ["room", "k1", "k2", "k3"] {
        assert!(said.out.contains(name), "{}", said.out);
    }
    // What nobody can do waits until somebody can.
    let said = user.ok(&["goal", "(greet ann)", "--id", "hello"]).await;
    assert!(said.out.contains("accepted"), "{}", said.out);
    user.ok(&["fact", "(arrived ann)"]).await;
    let done = user
        .ok(&["goal", "(greet ann)", "--id", "hello", "--wait"])
        .await;
    assert!(done.out.contains("done"), "{}", done.out);
    let wrong = user.run(&["goal", "(serve cola nobody)"]).await;
    assert_eq!(wrong.code, Some(1), "{wrong:?}");
    // What is said of nothing that is there, or what vehicles have to find out, is refused.
    for (fact, words) in [
        ("(spill table9)", "there is no place `table9`"),
        ("(seated anna table1)", "did you mean `ann`?"),
        ("(wants ann tea)", "one of cola, juice, water"),
        ("(greeted ben)", "not for users to say"),
    ] {
        let wrong = user.run(&["fact", fact]).await;
        assert_eq!(wrong.code, Some(2), "{wrong:?}");
        assert!(wrong.err.contains(words), "{wrong:?}");
    }
    for command in [
        ["goal", "(reach table1)", "--vehicle", "k9"],
        ["cancel", "hello", "--vehicle", "k9"],
    ] {
        let wrong = user.run(&command).await;
        assert_eq!(wrong.code, Some(3), "{wrong:?}");
        let words = "there is no `k9` here: there are k1, k2, k3, room";
        assert!(wrong.err.contains(words), "{wrong:?}");
    }
    let status = up.end_by(Signal::SIGINT).await;
    assert_eq!(status.code(), Some(0));
    up.assert_nobody_is_left().await;
}
