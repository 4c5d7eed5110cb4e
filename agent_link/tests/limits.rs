//! What is too much is refused in words, and reaches no machine.
#![allow(clippy::unwrap_used, clippy::panic, missing_docs, dead_code)]

mod toys;

use agent_core::model::Atom;
use agent_core::protocol::{GoalRequest, Input, Urgency};
use agent_link::{Client, Limits, Rate};
use serde_json::Value;

use toys::{Robot, Toy, within};

/// One emergency a minute, five at once; two of that in all.
fn hardly_any() -> Limits {
    Limits {
        of_sender: Rate::per_second(1.0 / 60.0).unwrap(),
        in_total: Rate::per_second(2.0 / 5.0).unwrap(),
    }
}

fn emergency(id: &str) -> GoalRequest {
    GoalRequest {
        id: Some(id.into()),
        tasks: vec![Atom::new("go", ["n4"])],
        urgency: Urgency::Emergency,
        priority: 0,
        deadline: None,
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn emergencies_beyond_a_sender_s_rate_are_refused_in_words_and_others_are_not() {
    let robot = Robot::start().await;
    let (agent, _) = robot
        .drive(Toy::new("parent"), |w| {
            w.takes_goals = true;
            w.limits = hardly_any();
        })
        .await;
    let session = robot.client().await;
    let unnamed = Client::new(&session, &robot.keys);
    let anna = unnamed.clone().named("anna");
    let ask = async |who: &Client, id: &str| within(who.goal(emergency(id))).await.unwrap();

    assert!(ask(&anna, "first").await.accepted);
    let second = ask(&anna, "second").await;
    let reason = second.reason.unwrap();
    assert!(reason.contains("too many emergencies"), "{reason}");
    assert!(reason.contains("from `anna`"), "{reason}");
    assert_eq!(second.id.as_deref(), Some("second"));
    assert!(ask(&anna, "first").await.accepted, "its answer may be lost");
    let calm = GoalRequest {
        urgency: Urgency::Normal,
        ..emergency("calm")
    };
    assert!(within(anna.goal(calm)).await.unwrap().accepted);

    // A put is answered to all.
    let mut verdicts = robot.listen(&session, &robot.keys.goal_answers()).await;
    for (key, accepted) in [
        (robot.keys.goal_emergency(), true),
        (robot.keys.goal_emergency(), false),
        (robot.keys.goal_emergency_by("anna").unwrap(), false),
    ] {
        within(robot.put(&session, &key, "(go n5)")).await;
        let verdict: Value = within(verdicts.recv()).await.unwrap();
        assert_eq!(verdict["accepted"], accepted, "{key}: {verdict}");
    }
    // Two were taken: for all others together there is no more.
    let ben = unnamed.named("ben");
    let reason = ask(&ben, "third").await.reason.unwrap();
    assert!(reason.contains("in total"), "{reason}");

    let agent = agent.stop().await.unwrap();
    let goals: Vec<_> = agent.seen.iter().filter_map(goal).collect();
    assert_eq!(goals, ["first", "first", "calm", ""]);
    agent_link::session::close(session).await;
    robot.stop().await;
}

fn goal(input: &Input<Value>) -> Option<&str> {
    match input {
        Input::Goal(goal) => Some(goal.id.as_ref().map_or("", |id| id.as_str())),
        _ => None,
    }
}

#[tokio::test(flavor = "multi_thread", worker_threads = 4)]
async fn what_is_nested_without_end_is_refused_and_nothing_breaks() {
    let robot = Robot::start().await;
    let (agent, _) = robot
        .drive(Toy::new("parent"), |w| {
            w.takes_goals = true;
            w.takes_facts = true;
        })
        .await;
    let session = robot.client().await;
    let keys = &robot.keys;
    let deep = |open: &str, close: &str| format!("{}{}", open.repeat(10_000), close.repeat(10_000));
    let json = deep("[", "]");
    for (key, text) in [
        (keys.goal_normal(), deep("(", ")")),
        (keys.goal_normal(), json.clone()),
        (keys.goal_normal(), format!(r#"{{"task":{json}}}"#)),
        (
            keys.goal_normal(),
            format!(r#"{{"task":"{}"}}"#, deep("(", ")")),
        ),
        (
            keys.goal_emergency_by("anna").unwrap(),
            deep(r#"{"v":"#, "}"),
        ),
        (keys.goal_command(), deep(r#"{"goal":"#, "}")),
        (keys.facts(), deep("(not ", ")")),
        (keys.facts(), format!(r#"{{"facts":{json}}}"#)),
    ] {
        let answer = within(robot.ask(&session, &key, &text)).await;
        let verdict: Value = serde_json::from_str(&answer).unwrap();
        assert_eq!(verdict["accepted"], false, "{key}: {verdict}");
        assert!(
            answer.len() < 1000,
            "{key}: an answer of {} bytes",
            answer.len()
        );
    }
    // Between agents the same holds; they are told, and go on.
    let instruction = keys.agent("parent").unwrap().instruction();
    let answer = within(robot.ask(&session, &instruction, &deep(r#"{"v":"#, "}"))).await;
    assert!(answer.contains("refused"), "{answer}");
    let verdict = within(robot.ask(&session, &keys.goal_normal(), "(go n4)")).await;
    assert!(verdict.contains(r#""accepted":true"#), "{verdict}");
    assert_eq!(agent.stop().await.unwrap().seen.len(), 1);
    agent_link::session::close(session).await;
    robot.stop().await;
}
