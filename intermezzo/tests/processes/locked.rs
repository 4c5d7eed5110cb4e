//! A robot with locked doors, as its users meet it.

use std::path::Path;
use std::time::Duration;

use agent_link::Keys;
use agent_link::session::{self, Role};
use serde_json::json;
use tokio::time::timeout;

use crate::harness::{PATIENCE, Said, User};

/// What somebody is told whom nobody answers.
pub fn assert_told_nothing(said: &Said) {
    assert_eq!(said.code, Some(3), "{said:?}");
    let words = "no answer: not reachable or not permitted";
    assert!(said.err.contains(words), "{said:?}");
}

/// A forged goal of the child, and an operator's instruction, by query and by put: no answer, and
/// afterwards nothing has come of it.
async fn forge(connect: &[String], keys: &Path) {
    let robot = Keys::new("robot").unwrap();
    let instruction = robot.agent("child").unwrap().instruction();
    let goal = json!({ "v": 1, "task": "(go n12)", "id": "forged" }).to_string();
    let order = json!({
        "v": 1, "from": "parent", "line": u64::MAX, "epoch": u64::MAX, "seq": 1, "settled": 0,
        "body": { "verb": "execute", "id": format!("parent.{}.1", u64::MAX), "action": "(go n12)" },
    });
    let order = order.to_string();
    for (who, key, text) in [
        ("child", robot.goal_normal(), &goal),
        ("child", robot.goal_emergency(), &goal),
        ("child", robot.goal_emergency_by("operator").unwrap(), &goal),
        ("operator", instruction.clone(), &order),
        ("viewer", instruction, &order),
    ] {
        try_in_vain(connect, keys, who, &key, text).await;
    }
}

/// Puts a text on a key and asks with it, as somebody whose configuration is in `keys`: nobody answers.
pub async fn try_in_vain(connect: &[String], keys: &Path, who: &str, key: &str, text: &str) {
    let file = keys.join(format!("{who}.json5"));
    let connect = connect.to_vec();
    let client = Role::Client { connect };
    let session = session::open(&client, Some(&file)).await.unwrap();
    session.put(key, text).await.unwrap();
    let asked = session.get(key).payload(text);
    let asked = asked.timeout(Duration::from_secs(2));
    let answers = asked.await.unwrap();
    while let Ok(answer) = timeout(PATIENCE, answers.recv_async()).await.unwrap() {
        // One that says that nobody has answered in time is no answer.
        assert!(answer.result().is_err(), "{who} on {key}: {answer:?}");
    }
    session::close(session).await;
}

async fn locked(way: &str) {
    let user = User::new().await;
    let keys = user.path().join("keys");
    let keys = keys.to_str().unwrap();
    user.ok(&[way, keys]).await;
    let mut up = user.up(&["--security", keys]).await;
    let operator = ["--security", keys];
    let viewer = ["--security", keys, "--as", "viewer"];

    let with = |who: &[&str], args: &[&str]| -> Vec<String> {
        args.iter()
            .chain(who)
            .map(|arg| (*arg).to_owned())
            .collect()
    };
    let run = async |who: &[&str], args: &[&str]| {
        let args = with(who, args);
        let args: Vec<&str> = args.iter().map(String::as_str).collect();
        user.run(&args).await
    };

    // A viewer looks, and that is all.
    let status = run(&viewer, &["status"]).await;
    assert_eq!(status.code, Some(0), "{status:?}");
    assert!(status.out.contains("parent"), "{status:?}");
    for args in [
        ["goal", "(go n4)"].as_slice(),
        &["goal", "(go n4)", "--emergency"],
        &["door", "door3_5", "closed"],
        &["fact", "(not (open door3_5))"],
        &["suspend", "tour"],
        &["resume", "tour"],
        &["cancel", "tour"],
    ] {
        assert_told_nothing(&run(&viewer, args).await);
    }
    // A stranger does not even look.
    for args in [["status"].as_slice(), &["goal", "(go n4)"]] {
        assert_told_nothing(&run(&["--connect", &up.endpoint], args).await);
    }
    forge(&[up.endpoint.clone()], Path::new(keys)).await;

    // An operator is answered, whether it is accepted or not.
    let refused = run(&operator, &["goal", "(go n99)"]).await;
    assert_eq!(refused.code, Some(1), "{refused:?}");
    assert!(refused.err.contains("unknown object `n99`"), "{refused:?}");
    let nothing = run(&operator, &["suspend", "tour"]).await;
    assert_eq!(nothing.code, Some(1), "{nothing:?}");
    let goal = ["goal", "(go n4)", "--emergency", "--id", "honest", "--wait"];
    let done = run(&operator, &goal).await;
    assert_eq!(done.code, Some(0), "{done:?}");
    let shut = run(&operator, &["door", "door3_5", "closed"]).await;
    assert_eq!(shut.code, Some(0), "{shut:?}");

    up.until_goal("honest", "goal_succeeded").await;
    let asked: Vec<_> = up
        .story
        .iter()
        .filter(|told| told["event"] == "goal_accepted" && told["agent"] == "parent")
        .map(|told| told["goal"].clone())
        .collect();
    assert_eq!(asked, ["honest"]);
    let forged = up.story.iter().any(|told| {
        let text = told.to_string();
        text.contains("forged") || text.contains(&u64::MAX.to_string())
    });
    assert!(!forged, "{:?}", up.story);
}

#[tokio::test(flavor = "multi_thread")]
async fn with_certificates_everybody_does_what_they_may_and_is_told_what_they_may_not() {
    locked("certs").await;
}

#[tokio::test(flavor = "multi_thread")]
async fn with_passwords_everybody_does_what_they_may_and_is_told_what_they_may_not() {
    locked("passwords").await;
}

#[tokio::test(flavor = "multi_thread")]
async fn one_user_more_is_let_in_and_may_do_what_the_router_is_told() {
    let user = User::new().await;
    for (way, kind) in [("certs", "cert_common_names"), ("passwords", "usernames")] {
        let folder = user.path().join(way);
        let keys = folder.to_str().unwrap();
        user.ok(&[way, keys]).await;
        assert_eq!(
            user.run(&[way, keys]).await.code,
            Some(2),
            "nothing is replaced"
        );
        user.ok(&[way, keys, "--add", "anna"]).await;
        for taken in ["anna", "router", "child", "a/b"] {
            let again = user.run(&[way, keys, "--add", taken]).await;
            assert_eq!(again.code, Some(2), "{taken}: {again:?}");
        }
        // As the command says.
        let router = folder.join("router.json5");
        let text = std::fs::read_to_string(&router).unwrap();
        let subjects = "subjects: [\n      { id: \"operator\"";
        assert!(text.contains(subjects));
        let anna = format!("subjects: [\n      {{ id: \"anna\", {kind}: [\"anna\"] }},");
        let text = text.replace("subjects: [\n", &format!("{anna}\n"));
        let (rules, policies) = text.split_once("policies: [").unwrap();
        let (_, rule) = rules.split_once("{ id: \"operator's name\"").unwrap();
        let (rule, _) = rule.split_once("},\n").unwrap();
        let rule = rule.replace("operator", "anna");
        let rules = rules.replace(
            "{ id: \"operator's name\"",
            &format!("{{ id: \"anna's name\"{rule}}},\n{{ id: \"operator's name\""),
        );
        let policies = policies.replace("[\"operator\"", "[\"operator\", \"anna\"");
        let policies = policies.replace(
            "[\"operator\", \"anna\"], rules: [\"operator's name\"] },",
            "[\"operator\"], rules: [\"operator's name\"] },
             { subjects: [\"anna\"], rules: [\"anna's name\"] },",
        );
        let text = format!("{rules}policies: [{policies}");
        std::fs::write(&router, text).unwrap();

        let mut up = user.up(&["--robot", way, "--security", keys]).await;
        let anna = ["--robot", way, "--security", keys, "--as", "anna"];
        user.ok(&[["goal", "(go n4)", "--id", "hers"].as_slice(), &anna].concat())
            .await;
        user.ok(&[["status"].as_slice(), &anna].concat()).await;
        up.until_goal("hers", "goal_accepted").await;
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn more_than_a_robot_keeps_or_takes_is_rejected_in_words() {
    let user = User::new().await;
    let few = ["--most-waiting", "2", "--emergencies-per-second", "0.01"];
    // Slow enough that nothing ends meanwhile.
    let slow = ["up", "--json", "--speed", "0.5"];
    let mut up = user.story(&[slow.as_slice(), &few].concat()).await;
    // Of these one runs and two wait.
    for id in ["a", "b", "c"] {
        user.ok(&["goal", "(go n40)", "--id", id]).await;
    }
    let refused = user.run(&["goal", "(go n40)", "--id", "d"]).await;
    assert_eq!(refused.code, Some(1), "{refused:?}");
    assert!(refused.err.contains("2 goals wait already"), "{refused:?}");
    user.ok(&["goal", "(go n4)", "--id", "fire", "--emergency"])
        .await;
    let refused = user.run(&["goal", "(go n4)", "--emergency"]).await;
    assert_eq!(refused.code, Some(1), "{refused:?}");
    assert!(refused.err.contains("too many emergencies"), "{refused:?}");
    // Others have a rate of their own.
    let other = [
        "goal",
        "(go n4)",
        "--id",
        "ill",
        "--emergency",
        "--as",
        "anna",
    ];
    user.ok(&other).await;
    up.until_goal("ill", "goal_accepted").await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_robot_on_a_router_elsewhere_is_locked_as_well() {
    let user = User::new().await;
    let folder = user.path().join("keys");
    let keys = folder.to_str().unwrap();
    user.ok(&["certs", keys]).await;
    let router = Role::Router { listen: Vec::new() };
    let file = folder.join("router.json5");
    let router = session::open(&router, Some(&file)).await.unwrap();
    let connect = session::endpoints(&router).await;
    let mut up = user
        .up(&["--connect", &connect[0], "--security", keys])
        .await;
    user.ok(&["goal", "(go n4)", "--id", "far", "--security", keys])
        .await;
    let viewer = ["--security", keys, "--as", "viewer"];
    let status = user.ok(&[["status"].as_slice(), &viewer].concat()).await;
    assert!(status.out.contains("process"), "{status:?}");
    assert_told_nothing(
        &user
            .run(&[["goal", "(go n4)"].as_slice(), &viewer].concat())
            .await,
    );
    up.until_goal("far", "goal_succeeded").await;
    drop(up);
    session::close(router).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_robot_that_is_flooded_goes_on_with_its_work() {
    let user = User::new().await;
    let mut up = user.up(&[]).await;
    user.ok(&["goal", "(go n40)", "--id", "tour"]).await;
    up.until_doing("arc5").await;
    let connect = vec![up.endpoint.clone()];
    let client = Role::Client { connect };
    let session = session::open(&client, None).await.unwrap();
    let flood = {
        let session = session.clone();
        tokio::spawn(async move {
            let key = Keys::new("robot").unwrap().goal_normal();
            let mut sent = 0_u64;
            loop {
                session.put(&key, "(go n4)").await.unwrap();
                sent += 1;
                if sent.is_multiple_of(100) {
                    tokio::time::sleep(Duration::from_millis(1)).await;
                }
            }
        })
    };
    up.until_goal("tour", "goal_succeeded").await;
    let told = |event: &str| {
        let of_parent = up.story.iter().filter(|told| told["agent"] == "parent");
        of_parent.filter(|told| told["event"] == event).count()
    };
    assert!(told("goal_rejected") > 0, "it was not flooded");
    // The tour, one that may have begun since, and those that wait.
    assert!(told("goal_accepted") <= 66, "{}", told("goal_accepted"));
    flood.abort();
    session::close(session).await;
}
