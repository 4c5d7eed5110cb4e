//! What a robot does not take, and that nothing is disturbed by it.

use std::time::Duration;

use agent_link::session::{self, Role};
use agent_link::{Keys, Session};
use serde_json::Value;
use tokio::time::timeout;

use crate::harness::{PATIENCE, User};

/// The answer to a query, as any zenoh client sees it.
async fn ask(session: &Session, key: &str, payload: impl Into<Vec<u8>>) -> Value {
    let replies = session.get(key).payload(payload.into()).await.unwrap();
    let reply = timeout(PATIENCE, replies.recv_async())
        .await
        .unwrap()
        .unwrap();
    let sample = reply.into_result().unwrap();
    serde_json::from_slice(&sample.payload().to_bytes()).unwrap()
}

#[tokio::test(flavor = "multi_thread")]
async fn nonsense_is_refused_in_words_and_disturbs_nothing() {
    let user = User::new().await;
    let mut up = user.up(&[]).await;
    user.ok(&["goal", "(go n12)", "--id", "work"]).await;
    up.until_doing("arc5").await;

    for (task, words) in [
        ("(go n99)", "unknown object `n99`"),
        ("(fly n4)", "unknown task `fly`"),
        ("(go n4 n5)", "takes 1 argument"),
        ("(go door1_3)", "is of type door, but node is wanted"),
    ] {
        let said = user.run(&["goal", task]).await;
        assert_eq!(said.code, Some(1), "{task}: {said:?}");
        assert!(said.err.contains(words), "{task}: {said:?}");
    }

    for (fact, words) in [
        ("(opne door3_5)", "did you mean `open`"),
        ("(open door3_5 door3_4)", "`open` takes 1 argument"),
    ] {
        let said = user.run(&["fact", fact]).await;
        assert_eq!(said.code, Some(2), "{fact}: {said:?}");
        assert!(said.err.contains(words), "{fact}: {said:?}");
    }
    user.ok(&["fact", "(not (open door5_7))"]).await;

    let keys = Keys::new("robot").unwrap();
    let connect = vec![up.endpoint.clone()];
    let session = session::open(&Role::Client { connect }, None)
        .await
        .unwrap();
    for (payload, words) in [
        (r#"{"task":"(go n4)""#.to_owned(), "cannot read the goal"),
        (
            r#"{"task":"(go n4)","prioritiy":1}"#.to_owned(),
            "prioritiy",
        ),
        ("x".repeat(1_000_000), "1000000 bytes"),
        ("(".repeat(10_000), "cannot read the goal"),
    ] {
        let verdict = ask(&session, &keys.goal_emergency(), payload).await;
        assert_eq!(verdict["accepted"], false, "{verdict}");
        let reason = verdict["reason"].as_str().unwrap();
        assert!(reason.contains(words), "{words}: {reason}");
    }

    // A put has no answer of its own; its verdict is published.
    let answers = session
        .declare_subscriber(keys.goal_answers())
        .await
        .unwrap();
    let mut verdicts = Vec::new();
    for payload in ["{", r#"{"task":"(go n12)","id":"put"}"#] {
        let verdict = loop {
            session.put(keys.goal_normal(), payload).await.unwrap();
            // Right after a subscription is made, something may be told before it is known.
            if let Ok(sample) = timeout(Duration::from_secs(1), answers.recv_async()).await {
                let bytes = sample.unwrap().payload().to_bytes().into_owned();
                let verdict: Value = serde_json::from_slice(&bytes).unwrap();
                if verdict["accepted"] == (payload != "{") {
                    break verdict;
                }
            }
        };
        verdicts.push(verdict);
    }
    assert!(
        verdicts[0]["reason"]
            .as_str()
            .unwrap()
            .contains("cannot read the goal")
    );
    assert_eq!(verdicts[1]["id"], "put");
    session::close(session).await;

    up.until_goal("work", "goal_succeeded").await;
    assert_eq!(
        up.of_goal("work"),
        ["goal_accepted", "goal_started", "goal_succeeded"]
    );
}
