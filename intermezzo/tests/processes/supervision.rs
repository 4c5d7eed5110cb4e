//! Roles that die or hang are started again; what cannot be started is not, for ever.

use std::path::Path;

use nix::sys::signal::Signal;
use serde_json::Value;

use crate::harness::User;

#[tokio::test(flavor = "multi_thread")]
async fn a_role_that_is_killed_is_started_again_and_the_robot_goes_on() {
    let user = User::new().await;
    let mut up = user.up(&[]).await;
    for role in ["parent", "child", "executor"] {
        let before = up.processes[role];
        up.signal(role, Signal::SIGKILL);
        let ended = up.until_role(role, "role_ended").await;
        assert_eq!(ended["how"], "signal: 9 (SIGKILL)", "{ended}");
        up.until_role(role, "role_ready").await;
        assert_ne!(up.processes[role], before);
    }
    let status = user.ok(&["status", "--json"]).await.out;
    let status: Value = serde_json::from_str(&status).unwrap();
    for (role, restarts) in [("parent", 1), ("child", 1), ("executor", 1), ("world", 0)] {
        let process = &status["processes"][role];
        assert_eq!(process["state"], "up", "{status}");
        assert_eq!(process["restarts"], restarts, "{status}");
        assert_eq!(
            process["process"],
            up.processes[role].as_raw(),
            "{role}: {status}"
        );
    }
    let status = user.ok(&["status"]).await.out;
    assert!(status.contains("started again once"), "{status}");
    assert!(status.contains("signal: 9 (SIGKILL)"), "{status}");
    user.ok(&["goal", "(go n12)", "--wait"]).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_role_that_freezes_is_shown_and_one_that_stays_frozen_is_replaced() {
    let user = User::new().await;
    let mut up = user.up(&["--hang-limit", "1"]).await;
    up.signal("child", Signal::SIGSTOP);
    up.until_role("child", "role_silent").await;
    let killed = up.until_role("child", "role_killed").await;
    assert!(killed["silent_s"].as_f64().unwrap() >= 1.0, "{killed}");
    up.until_role("child", "role_ready").await;
    user.ok(&["goal", "(go n12)", "--wait"]).await;
}

#[tokio::test(flavor = "multi_thread")]
async fn a_role_that_wakes_up_in_time_is_left_alone() {
    let user = User::new().await;
    let mut up = user.up(&["--hang-limit", "600"]).await;
    let before = up.processes["parent"];
    up.signal("parent", Signal::SIGSTOP);
    up.until_role("parent", "role_silent").await;
    let status = user.ok(&["status"]).await.out;
    assert!(status.contains("does not answer"), "{status}");
    up.signal("parent", Signal::SIGCONT);
    up.until_role("parent", "role_answers").await;
    assert_eq!(up.processes["parent"], before);
    user.ok(&["goal", "(go n12)", "--wait"]).await;
}

fn museum_in(folder: &Path) {
    let museum = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../maps/museum"));
    std::fs::create_dir(folder).unwrap();
    for file in std::fs::read_dir(museum).unwrap() {
        let file = file.unwrap();
        std::fs::copy(file.path(), folder.join(file.file_name())).unwrap();
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_role_that_cannot_be_started_any_more_is_given_up_with_its_words() {
    let user = User::new().await;
    let place = user.path().join("place");
    museum_in(&place);
    let mut up = user.up(&[place.to_str().unwrap()]).await;
    std::fs::write(place.join("map.geojson"), "{}").unwrap();
    up.signal("child", Signal::SIGKILL);
    let status = up.read_to_the_end().await;
    assert_eq!(status.code(), Some(1));
    let starts = up.story.iter().filter(|told| told["event"] == "role_ended");
    // The kill, and the ends that it came to by itself; the last is told otherwise.
    assert_eq!(starts.count(), 5);
    let end = up.story.last().unwrap();
    let why = end["failed"][0].as_str().unwrap();
    assert!(
        why.contains("the child ends whenever it is started"),
        "{end}"
    );
    assert!(why.contains("is not GeoJSON"), "{end}");
    up.assert_nobody_is_left().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn two_robots_cannot_have_the_same_state() {
    let (anna, bert) = (User::new().await, User::new().await);
    let state = anna.path().join("state");
    let state = state.to_str().unwrap();
    let mut up = anna.up(&["--state", state]).await;
    // Another runtime directory: by name they do not know of each other.
    let said = bert.run(&["up", "--state", state]).await;
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(
        said.err.contains("in use by another `intermezzo up`"),
        "{said:?}"
    );
    assert_eq!(up.end_by(Signal::SIGINT).await.code(), Some(0));
    let mut up = bert.up(&["--state", state]).await;
    assert_eq!(up.end_by(Signal::SIGKILL).await.code(), None);
    // Its roles may still be about to end.
    let mut up = bert.up(&["--state", state]).await;
    assert_eq!(up.end_by(Signal::SIGINT).await.code(), Some(0));
    up.assert_nobody_is_left().await;
}

#[tokio::test(flavor = "multi_thread")]
async fn who_waits_for_a_goal_is_told_that_the_robot_is_down_and_not_kept_for_ever() {
    let user = User::new().await;
    let mut up = user.up(&[]).await;
    let waiting = user.run(&["goal", "(go n40)", "--wait", "--patience", "1"]);
    let ending = async {
        up.until_doing("arc5").await;
        up.end_by(Signal::SIGINT).await
    };
    let (said, status) = tokio::join!(waiting, ending);
    assert_eq!(status.code(), Some(0));
    assert_eq!(said.code, Some(3), "{said:?}");
    assert!(said.err.contains("the robot is down"), "{said:?}");
    assert!(
        said.err.contains("nobody knows how the goal has ended"),
        "{said:?}"
    );
}
