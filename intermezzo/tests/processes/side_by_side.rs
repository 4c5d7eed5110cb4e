//! Several robots on one machine.

use crate::harness::User;

#[tokio::test(flavor = "multi_thread")]
async fn two_robots_do_not_hear_each_other() {
    let user = User::new().await;
    let mut anna = user.up(&["--robot", "anna"]).await;
    let mut bert = user.up(&["--robot", "bert", "--start", "n40"]).await;

    let said = user.run(&["status"]).await;
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(said.err.contains("anna, bert"), "{said:?}");

    user.ok(&["goal", "(go n12)", "--id", "a", "--robot", "anna", "--wait"])
        .await;
    user.ok(&["goal", "(go n39)", "--id", "b", "--robot", "bert", "--wait"])
        .await;
    anna.until_goal("a", "goal_succeeded").await;
    bert.until_goal("b", "goal_succeeded").await;
    assert_eq!(anna.of_goal("b"), [""; 0]);
    assert_eq!(bert.of_goal("a"), [""; 0]);

    let said = user.run(&["up", "--robot", "anna"]).await;
    assert_eq!(said.code, Some(2), "{said:?}");
    assert!(said.err.contains("`anna` is running already"), "{said:?}");
    // Which did not disturb the first of that name.
    user.ok(&["status", "--robot", "anna"]).await;
}
