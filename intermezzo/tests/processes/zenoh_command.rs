//! The Python `zenoh` command (package zenoh-cli) gives goals, with nothing of ours in between.
//!
//! Where the environment variable `INTERMEZZO_ZENOH_COMMAND` does not say where it is, there is
//! nothing to test; `.ci/run` installs it and says so.

use std::ffi::OsString;

use tokio::process::Command;
use tokio::time::timeout;

use crate::harness::{PATIENCE, User};

/// What the command prints.
async fn zenoh(command: &OsString, endpoint: &str, args: &[&str]) -> String {
    let output = Command::new(command)
        .args(["--mode", "client", "--connect", endpoint])
        .args(["--cfg", "scouting/multicast/enabled:false"])
        .args(args)
        .kill_on_drop(true)
        .output();
    let output = timeout(PATIENCE, output).await.unwrap().unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}\n{complaint}");
    said
}

#[tokio::test(flavor = "multi_thread")]
async fn a_put_and_a_get_of_the_zenoh_command_are_goals() {
    let Some(command) = std::env::var_os("INTERMEZZO_ZENOH_COMMAND") else {
        return;
    };
    let user = User::new().await;
    let mut up = user.up(&[]).await;
    let endpoint = up.endpoint.clone();
    user.ok(&["goal", "(go n40)", "--id", "tour"]).await;
    up.until_doing("arc5").await;

    let key = "intermezzo/robot/goal/emergency";
    let put = ["put", "-k", key, "-v", "(go n4)", "--encoder", "text"];
    zenoh(&command, &endpoint, &put).await;
    // The robot gives a name to a goal that has none: its second.
    up.until_goal("g2", "goal_succeeded").await;

    let goal = r#"{"task":"(go n5)","priority":1,"id":"desk"}"#;
    let get = [
        "get",
        "-s",
        key,
        "-v",
        goal,
        "--encoder",
        "text",
        "--decoder",
        "text",
    ];
    let answer = zenoh(&command, &endpoint, &get).await;
    assert!(answer.contains(r#""accepted":true"#), "{answer}");
    up.until_goal("desk", "goal_succeeded").await;

    let plans = "intermezzo/robot/parent/alternatives";
    let answer = zenoh(
        &command,
        &endpoint,
        &["get", "-s", plans, "--decoder", "text"],
    )
    .await;
    assert!(answer.contains(r#""alternatives":["#), "{answer}");

    let unknown = [
        "get",
        "-s",
        key,
        "-v",
        "(go n99)",
        "--encoder",
        "text",
        "--decoder",
        "text",
    ];
    let answer = zenoh(&command, &endpoint, &unknown).await;
    assert!(answer.contains("unknown object `n99`"), "{answer}");
    up.until_goal("tour", "goal_succeeded").await;
}
