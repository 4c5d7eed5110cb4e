//! How robots end: nothing is left of them.

use nix::sys::signal::Signal;

use crate::harness::User;

fn entries(user: &User) -> Vec<String> {
    let directory = user.path().join("intermezzo");
    let files = std::fs::read_dir(directory).unwrap();
    let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
    names.filter(|name| name.ends_with(".json")).collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn ctrl_c_ends_a_robot_at_work_and_all_that_belongs_to_it() {
    for signal in [Signal::SIGINT, Signal::SIGTERM] {
        let user = User::new().await;
        let mut up = user.up(&[]).await;
        assert_eq!(entries(&user), ["robot.json"]);
        user.ok(&["goal", "(go n40)"]).await;
        up.until_doing("arc5").await;
        assert_eq!(up.end_by(signal).await.code(), Some(0));
        up.assert_nobody_is_left().await;
        assert_eq!(entries(&user), [""; 0]);
        assert_eq!(user.run(&["status"]).await.code, Some(3));
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn when_up_is_killed_its_roles_end_by_themselves() {
    let user = User::new().await;
    let mut up = user.up(&[]).await;
    up.end_by(Signal::SIGKILL).await;
    up.assert_nobody_is_left().await;
    let said = user.run(&["goal", "(go n4)"]).await;
    assert_eq!(said.code, Some(3), "{said:?}");
}

/// The temporary directories of the user's robots.
fn temporary(user: &User) -> Vec<String> {
    let files = std::fs::read_dir(user.path()).unwrap();
    let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
    names
        .filter(|name| name.starts_with("intermezzo-"))
        .collect()
}

#[tokio::test(flavor = "multi_thread")]
async fn what_a_killed_up_has_left_behind_is_removed_by_the_next() {
    let user = User::new().await;
    let mut killed = user.up(&[]).await;
    let left = temporary(&user);
    assert_eq!(left.len(), 1, "{left:?}");
    // Not while anybody uses it.
    let mut other = user.up(&["--robot", "other"]).await;
    let both = temporary(&user);
    assert!(both.len() == 2 && both.contains(&left[0]), "{both:?}");
    killed.end_by(Signal::SIGKILL).await;
    killed.assert_nobody_is_left().await;
    assert_eq!(other.end_by(Signal::SIGINT).await.code(), Some(0));
    assert_eq!(temporary(&user), left);
    let mut next = user.up(&[]).await;
    let new = temporary(&user);
    assert!(new.len() == 1 && new != left, "{new:?}");
    assert_eq!(next.end_by(Signal::SIGINT).await.code(), Some(0));
    assert_eq!(temporary(&user), [""; 0]);
}

#[tokio::test(flavor = "multi_thread")]
async fn a_story_with_a_goal_that_cannot_be_ends_with_a_failure() {
    let user = User::new().await;
    let file = user.path().join("story.toml");
    let story = "[[event]]\ngoal = \"(go n4)\"\n[[event]]\ngoal = \"(go n99)\"\n";
    std::fs::write(&file, story).unwrap();
    let file = file.to_str().unwrap();
    let mut up = user.up(&["--scenario", file, "--until-done"]).await;
    assert_eq!(up.read_to_the_end().await.code(), Some(1));
    assert_eq!(up.of_goal("goal1").last(), Some(&"goal_succeeded"));
    let failed = &up.story.last().unwrap()["failed"];
    assert!(
        failed[0].as_str().unwrap().contains("unknown object `n99`"),
        "{failed}"
    );
}

#[tokio::test(flavor = "multi_thread")]
async fn a_story_that_is_broken_off_has_not_been_told() {
    let user = User::new().await;
    let file = user.path().join("story.toml");
    std::fs::write(&file, "[[event]]\nat_s = 100000\nsay = \"Much later.\"\n").unwrap();
    let story = ["--scenario", file.to_str().unwrap(), "--until-done"];
    for (args, told) in [(&story[..], false), (&[][..], true)] {
        let mut up = user.up(args).await;
        assert_eq!(up.end_by(Signal::SIGINT).await.code(), Some(0));
        assert_eq!(up.story.last().unwrap()["success"], told);
    }
}
