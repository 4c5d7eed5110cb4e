//! A team with locked doors, as its users meet it.

use std::path::Path;

use agent_link::Keys;
use serde_json::{Value, json};

use crate::harness::User;
use crate::locked::{assert_told_nothing, try_in_vain};
use crate::team::{restaurant, served, until_done};

/// What one of the team, or a user, tries that it may not: the other vehicle's body, an instruction and an
/// award in another's name, a report in the room's, a goal. Nobody answers, and nothing may come of it.
async fn forge(connect: &[String], keys: &Path) {
    let robot = Keys::new("robot").unwrap();
    let letter = |from: &str, body: Value| {
        let line = u64::MAX;
        let letter = json!({
            "v": 1, "from": from, "line": line, "epoch": line, "seq": 1, "settled": 0, "body": body,
        });
        letter.to_string()
    };
    let id = format!("k1.{}.1", u64::MAX);
    let drive = letter(
        "k1",
        json!({ "verb": "execute", "id": id, "action": "(drive k1 table3)" }),
    );
    let serve = letter(
        "k1",
        json!({ "verb": "execute", "id": id, "action": "(serve cola ann)" }),
    );
    let done = letter(
        "room",
        json!({ "id": id, "report": "success", "facts": [] }),
    );
    let award = json!({
        "v": 1, "by": "k1", "t_s": 1.0e6,
        "tasks": {
            "offers": [],
            "awards": [{ "task": "forged", "id": id, "what": "(serve cola ann)", "to": "k2" }],
            "digest": "0000000000000000",
        },
    });
    let award = award.to_string();
    let goal = json!({ "v": 1, "task": "(clean kitchen)", "id": "forged" }).to_string();
    let (room, k2) = (robot.agent("room").unwrap(), robot.agent("k2").unwrap());
    for (who, key, text) in [
        ("k3", format!("{}/k1", room.instruction()), &drive),
        ("k3", format!("{}/k1", k2.instruction()), &serve),
        ("k3", format!("{}/room", k2.report()), &done),
        ("k3", robot.team("k1").unwrap(), &award),
        ("k3", robot.goal_normal(), &goal),
        ("operator", format!("{}/k1", room.instruction()), &drive),
        ("viewer", robot.team("k1").unwrap(), &award),
        ("viewer", k2.goal_normal(), &goal),
    ] {
        try_in_vain(connect, keys, who, &key, text).await;
    }
}

async fn locked(way: &str) {
    let user = User::new().await;
    let keys = user.path().join("keys");
    let keys = keys.to_str().unwrap();
    user.ok(&[way, keys]).await;
    let up = [
        "up",
        "restaurant",
        "--json",
        "--speed",
        "20",
        "--security",
        keys,
    ];
    let mut up = user.story(&up).await;
    let run = async |who: &[&str], args: &[&str]| user.run(&[args, who].concat()).await;
    let operator = ["--security", keys];
    let viewer = ["--security", keys, "--as", "viewer"];

    // A viewer looks, and that is all; a stranger does not even look.
    let status = run(&viewer, &["status"]).await;
    assert_eq!(status.code, Some(0), "{status:?}");
    for name in ["room", "k1", "k2", "k3"] {
        assert!(status.out.contains(name), "{status:?}");
    }
    for args in [
        ["goal", "(clean kitchen)"].as_slice(),
        &["goal", "(clean kitchen)", "--vehicle", "k3", "--emergency"],
        &["fact", "(spill kitchen)"],
        &["cancel", "cola"],
    ] {
        assert_told_nothing(&run(&viewer, args).await);
    }
    for args in [["status"].as_slice(), &["goal", "(clean kitchen)"]] {
        assert_told_nothing(&run(&["--connect", &up.endpoint], args).await);
    }
    forge(&[up.endpoint.clone()], Path::new(keys)).await;

    // The team serves a guest, and a vehicle takes what is for it alone.
    for args in [
        ["fact", "(seated ann table1)"].as_slice(),
        &["fact", "(spill kitchen)"],
        &["goal", "(serve cola ann)", "--id", "cola"],
        &["goal", "(clean kitchen)", "--vehicle", "k3", "--wait"],
    ] {
        let said = run(&operator, args).await;
        assert_eq!(said.code, Some(0), "{args:?}: {said:?}");
    }
    until_done(&mut up, &["cola"]).await;
    assert_eq!(served(&user, &operator).await, ["ann"]);
    let forged = up.story.iter().any(|told| {
        let text = told.to_string();
        text.contains("forged") || text.contains(&u64::MAX.to_string())
    });
    assert!(!forged, "{:?}", up.story);
}

#[tokio::test(flavor = "multi_thread")]
async fn with_certificates_a_team_serves_a_guest_and_nobody_speaks_for_another() {
    locked("certs").await;
}

#[tokio::test(flavor = "multi_thread")]
async fn with_passwords_a_team_serves_a_guest_and_nobody_speaks_for_another() {
    locked("passwords").await;
}

#[tokio::test(flavor = "multi_thread")]
async fn one_vehicle_more_is_let_in_and_until_then_the_team_is_told_what_to_type() {
    let user = User::new().await;
    let dir = restaurant();
    let place = dir.path().to_str().unwrap();
    for way in ["certs", "passwords"] {
        let folder = user.path().join(way);
        let keys = folder.to_str().unwrap();
        user.ok(&[way, keys]).await;
        let up = ["up", place, "--json", "--robot", way, "--security", keys];
        let refused = user.run(&up).await;
        assert_eq!(refused.code, Some(2), "{refused:?}");
        assert!(refused.err.contains("nothing for `k4`"), "{refused:?}");
        let command = format!("intermezzo {way} {keys} --vehicle k4");
        assert!(refused.err.contains(&command), "{refused:?}");
        for taken in ["k1", "room", "parent", "router", "a/b"] {
            let again = user.run(&[way, keys, "--vehicle", taken]).await;
            assert_eq!(again.code, Some(2), "{taken}: {again:?}");
        }
        user.ok(&[way, keys, "--vehicle", "k4"]).await;
        assert!(folder.join("router.json5.before").exists());
        let mut up = user.story(&up).await;
        let robot = ["--robot", way, "--security", keys];
        let mop = ["goal", "(clean kitchen)", "--vehicle", "k4", "--id", "mop"];
        user.ok(&[["fact", "(spill kitchen)"].as_slice(), &robot].concat())
            .await;
        user.ok(&[mop.as_slice(), &robot].concat()).await;
        up.until("that k4 takes it", |told| {
            told["agent"] == "k4" && told["goal"] == "mop" && told["event"] == "goal_accepted"
        })
        .await;
    }
}
