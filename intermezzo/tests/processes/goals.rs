//! Goals that are asked for with the command, while the robot is at work.

use serde_json::Value;

use crate::harness::User;

#[tokio::test(flavor = "multi_thread")]
async fn one_emergency_and_another_within_it() {
    let user = User::new().await;
    let mut up = user.up(&[]).await;
    let waiting = user.run(&["goal", "(guide n40)", "--id", "tour", "--wait"]);
    let story = async {
        up.until_doing("arc5").await;
        user.ok(&["goal", "(go n28)", "--emergency", "--id", "toilet"])
            .await;
        let suspended = up.until_goal("tour", "goal_suspended").await;
        assert_eq!(suspended["stack_depth"], 1);
        up.until_goal("toilet", "action_started").await;
        the_plans_of_both_can_be_seen(&user).await;
        user.ok(&["goal", "(go n13)", "-e", "--id", "nursing"])
            .await;
        let begun = up.until_goal("nursing", "goal_started").await;
        assert_eq!(begun["stack_depth"], 2);
        for goal in ["nursing", "toilet", "tour"] {
            up.until_goal(goal, "goal_succeeded").await;
        }
    };
    let (said, ()) = tokio::join!(waiting, story);
    assert_eq!(said.code, Some(0), "{said:?}");
    for words in ["set aside", "taken up again", "done"] {
        assert!(said.out.contains(words), "{words}: {said:?}");
    }
    let status = user.ok(&["status"]).await.out;
    assert!(status.contains("at n40"), "{status}");
}

/// What each costs and hangs on, and that the tour is to go on where it was stopped.
async fn the_plans_of_both_can_be_seen(user: &User) {
    let told = user.ok(&["status", "--plans", "--json"]).await.out;
    let told: Value = serde_json::from_str(&told).unwrap();
    let goals = told["agents"]["parent"]["alternatives"].as_array().unwrap();
    let of = |id: &str| goals.iter().find(|goal| goal["id"] == id).unwrap();
    let (toilet, tour) = (of("toilet"), of("tour"));
    assert_eq!(toilet["place"], "running", "{told}");
    let plan = &toilet["plans"][0];
    assert!(plan["cost"].as_f64().unwrap() > 0.0, "{told}");
    let hangs_on = plan["hangs_on"].as_array().unwrap();
    let door = |it: &&Value| it["changes_alone"] == true && it["holds"] == true;
    assert!(hangs_on.iter().any(|it| door(&it)), "{told}");
    assert_eq!(tour["place"], "suspended", "{told}");
    let resumed = tour["choice"]["resumes"].as_str().unwrap();
    assert!(resumed.starts_with("(enter area1 area3"), "{told}");
    let told = user.ok(&["status", "--plans"]).await.out;
    for words in ["hangs on", "follows the first", "(open door"] {
        assert!(told.contains(words), "{words}: {told}");
    }
}

#[tokio::test(flavor = "multi_thread")]
async fn a_goal_waits_for_the_door_on_its_only_way() {
    let user = User::new().await;
    let mut up = user.up(&["--start", "n34"]).await;
    user.ok(&["door", "door7_8", "closed"]).await;
    user.ok(&["goal", "(go n40)", "--id", "hall"]).await;
    let blocked = up.until_goal("hall", "goal_blocked").await;
    let blocked_by = blocked["blocked_by"].as_array().unwrap();
    assert!(blocked_by.contains(&"(open door7_8)".into()), "{blocked}");
    let status = user.ok(&["status"]).await.out;
    assert!(
        status.contains("blocked") && status.contains("(open door7_8)"),
        "{status}"
    );
    // Whatever else there is to do goes on.
    user.ok(&["goal", "(go n29)", "--wait"]).await;
    user.ok(&["door", "door7_8", "open"]).await;
    up.until_goal("hall", "goal_succeeded").await;
}

#[tokio::test(flavor = "multi_thread")]
async fn users_suspend_resume_and_cancel() {
    let user = User::new().await;
    let mut up = user.up(&[]).await;
    user.ok(&["goal", "(go n40)", "--id", "far"]).await;
    up.until_doing("arc5").await;
    user.ok(&["suspend", "far"]).await;
    up.until_goal("far", "goal_suspended").await;
    let status = user.ok(&["status"]).await.out;
    assert!(status.contains("set aside by the user"), "{status}");
    user.ok(&["resume", "far"]).await;
    up.until_goal("far", "goal_resumed").await;
    user.ok(&["cancel", "far"]).await;
    up.until_goal("far", "goal_failed").await;
    let said = user.run(&["cancel", "far"]).await;
    assert_eq!(said.code, Some(1), "{said:?}");
}
