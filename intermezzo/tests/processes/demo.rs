//! The demonstration.

use crate::harness::User;

#[tokio::test(flavor = "multi_thread")]
async fn the_tour_is_interrupted_twice_and_arrives() {
    let user = User::new().await;
    let mut demo = user.story(&["demo", "--json", "--speed", "50"]).await;
    let status = demo.read_to_the_end().await;
    assert_eq!(status.code(), Some(0), "{:?}", demo.story.last());
    for (goal, life) in [
        (
            "tour",
            vec!["accepted", "started", "suspended", "resumed", "succeeded"],
        ),
        (
            "toilet",
            vec!["accepted", "started", "suspended", "resumed", "succeeded"],
        ),
        ("nursing", vec!["accepted", "started", "succeeded"]),
    ] {
        let life: Vec<String> = life.iter().map(|event| format!("goal_{event}")).collect();
        assert_eq!(demo.of_goal(goal), life, "{goal}");
    }
    let of_parent = |goal: &str, event: &str| {
        demo.story
            .iter()
            .find(|told| {
                told["agent"] == "parent" && told["goal"] == goal && told["event"] == event
            })
            .unwrap_or_else(|| panic!("no {event} of {goal}"))
    };
    // Two goals are suspended when the most urgent one begins, both in the middle of an action.
    assert_eq!(of_parent("nursing", "goal_started")["stack_depth"], 2);
    for goal in ["tour", "toilet"] {
        let action = &of_parent(goal, "goal_suspended")["action"];
        assert!(action.as_str().unwrap().starts_with("(enter "), "{action}");
    }
    // The door that closes meanwhile breaks the suspended plan, and the tour finds another.
    let revised = of_parent("tour", "plan_revised")["why"].as_str().unwrap();
    assert!(revised.contains("(open door3_5)"), "{revised}");
    assert_eq!(of_parent("toilet", "goal_resumed")["how"], "continued");
    assert_eq!(of_parent("tour", "goal_resumed")["how"], "repaired");
    let end = demo.story.last().unwrap();
    assert_eq!(
        (&end["event"], &end["success"]),
        (&"end".into(), &true.into())
    );
    demo.assert_nobody_is_left().await;
}
