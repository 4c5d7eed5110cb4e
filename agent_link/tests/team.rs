//! Machines that sign what they say: their names stand in the keys.
#![allow(clippy::unwrap_used, clippy::panic, missing_docs)]

mod toys;

use std::time::Duration;

use agent_core::model::{Atom, FactChange};
use agent_core::protocol::Input;
use serde_json::{Value, json};

use toys::{Robot, Toy, execute, within};

fn at(node: &str) -> Vec<FactChange> {
    vec![FactChange::Add(Atom::new("at", [node]))]
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn what_is_signed_arrives_and_facts_for_one_reach_that_one_alone() {
    let robot = Robot::start().await;
    let room = Toy::new("room").executing();
    let room = room.showing("k1", at("n1")).showing("k2", at("n2"));
    let (room, _) = robot.drive(room, |w| w.signs = true).await;
    let mut vehicles = Vec::new();
    for name in ["k1", "k2"] {
        let vehicle = Toy::new(name).instructing("room", vec![execute(1)]);
        let wire = |w: &mut agent_link::Wiring| {
            w.signs = true;
            w.executors.push("room".into());
        };
        vehicles.push((name, robot.drive(vehicle, wire).await));
    }
    for (name, (vehicle, done)) in vehicles {
        let told = |input: &Input<Value>| matches!(input, Input::Observation(_));
        // Answer, the start, the end, and what the room sees for it.
        within(done.until(|seen| seen.len() >= 4 && seen.iter().any(told))).await;
        let seen = vehicle.stop().await.unwrap().seen;
        let reports = seen.iter().filter(|it| matches!(it, Input::Report { .. }));
        assert_eq!(reports.count(), 2, "{seen:?}");
        let facts = seen.into_iter().filter(told).collect::<Vec<_>>();
        let own = if name == "k1" { "n1" } else { "n2" };
        assert_eq!(facts, [Input::Observation(at(own))], "{name}");
    }
    room.stop().await.unwrap();
    robot.stop().await;
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn who_says_to_be_another_than_the_key_says_is_refused_and_not_heard() {
    let robot = Robot::start().await;
    let wire = |w: &mut agent_link::Wiring| {
        w.signs = true;
        w.in_team = true;
    };
    let (vehicle, done) = robot.drive(Toy::new("k2").executing(), wire).await;
    let session = robot.client().await;
    let keys = robot.keys.agent("k2").unwrap();
    let order = |from: &str| {
        json!({
            "v": 1, "from": from, "line": 5, "epoch": 5, "seq": 1,
            "body": { "verb": "suspend", "id": "k1.5.1" },
        })
        .to_string()
    };
    for (from, key, words) in [
        ("k1", "k3", "it is from `k1`, and its key from `k3`"),
        ("k1", "k1", "suspending"),
    ] {
        let key = format!("{}/{key}", keys.instruction());
        let answer = within(robot.ask(&session, &key, &order(from))).await;
        assert!(answer.contains(words), "{answer}");
    }
    // Without a name, or with any, nobody listens.
    for key in [keys.instruction(), format!("{}/*", keys.instruction())] {
        let asked = session.get(&key).payload(order("k1"));
        let answers = asked.timeout(Duration::from_millis(500)).await.unwrap();
        while let Ok(answer) = within(answers.recv_async()).await {
            assert!(answer.result().is_err(), "{key}: {answer:?}");
        }
    }
    let said = |by: &str| json!({ "v": 1, "by": by, "t_s": 1.0, "need": [] }).to_string();
    let heard = |input: &Input<Value>| matches!(input, Input::Local(_));
    let key = robot.keys.team("k1").unwrap();
    let say = async {
        loop {
            robot.put(&session, &key, &said("k3")).await;
            robot.put(&session, &key, "{}").await;
            robot.put(&session, &key, &said("k1")).await;
            tokio::time::sleep(Duration::from_millis(20)).await;
        }
    };
    tokio::select! {
        () = within(done.until(|seen| seen.iter().any(heard))) => {}
        () = say => {}
    }
    let seen = vehicle.stop().await.unwrap().seen;
    for input in &seen {
        if let Input::Local(message) = input {
            assert_eq!(message["by"], "k1");
        }
    }
    let orders = seen.iter();
    let orders = orders.filter(|input| matches!(input, Input::Instruction { .. }));
    assert_eq!(orders.count(), 1);
    agent_link::session::close(session).await;
    robot.stop().await;
}
