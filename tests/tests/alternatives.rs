//! What an agent says when it is asked what else it could do.

use agent_core::agent::{Against, Alternative, GoalPlace};
use agent_core::model::Cost;
use intermezzo_tests::museum;

/// What a plan hangs on that can change without the robot.
fn doors(plan: &Alternative) -> Vec<String> {
    let alone = plan.hangs_on.iter().filter(|it| it.changes_alone);
    alone.map(|it| it.fact.to_string()).collect()
}

#[test]
fn a_tour_hangs_on_the_doors_on_its_way() {
    let mut stack = museum().stack("n1");
    stack.goal("tour", "(guide n40)");
    stack.run_into("child", "(move n1 n6 arc5)", 1.0);
    let all = stack.agent("parent").alternatives();
    assert_eq!(all.len(), 1);
    let tour = &all[0];
    assert_eq!(tour.place, GoalPlace::Running);
    assert!(tour.complete);
    let followed = &tour.plans[0];
    assert!(followed.kept && followed.broken.is_none());
    assert_eq!(
        doors(followed),
        [
            "(open door1_3)",
            "(open door3_5)",
            "(open door5_7)",
            "(open door7_8)"
        ]
    );
    // It is on its way: where it set out from no longer matters.
    assert_eq!(followed.hangs_on.len(), 4);
    assert!(tour.plans.len() > 1);
    let next = tour.plans[1..].iter().map(|plan| plan.cost).min();
    let saved = Cost(next.unwrap().0 - followed.cost.0);
    let choice = tour.choice.as_ref().unwrap();
    assert_eq!(choice.against_others, Against::Less(saved));
    assert_eq!(choice.resumes, None);
    assert_eq!(tour.what_if, None, "the staff door would be no shorter");
}

#[test]
fn a_suspended_tour_takes_up_where_it_stopped_until_a_door_closes() {
    let mut stack = museum().stack("n1");
    stack.goal("tour", "(guide n40)");
    stack.run_into("child", "(move n1 n6 arc5)", 1.0);
    stack.emergency("toilet", "(go n28)");
    stack.run_to("parent", |event| {
        event
            .goal
            .as_ref()
            .is_some_and(|goal| goal.as_str() == "toilet")
            && matches!(
                event.what,
                agent_core::protocol::Happening::ActionStarted { .. }
            )
    });
    let all = stack.agent("parent").alternatives();
    let places: Vec<GoalPlace> = all.iter().map(|goal| goal.place).collect();
    assert_eq!(places, [GoalPlace::Running, GoalPlace::Suspended]);
    let choice = all[1].choice.as_ref().unwrap();
    assert_eq!(
        choice.resumes.as_ref().map(ToString::to_string).as_deref(),
        Some("(enter area1 area3 door1_3)")
    );
    assert!(matches!(choice.against_others, Against::Less(_)));

    stack.world("(not (open door3_5))");
    let all = stack.agent("parent").alternatives();
    let tour = &all[1];
    let broken = tour.plans[0].broken.as_deref().unwrap();
    assert!(broken.contains("(open door3_5)"), "{broken}");
    let missing: Vec<String> = (tour.plans[0].hangs_on.iter())
        .filter(|it| !it.given)
        .map(|it| it.fact.to_string())
        .collect();
    assert_eq!(missing, ["(open door3_5)"]);
    assert!(tour.plans[1].broken.is_none(), "another way is known");
    let what_if = tour.what_if.as_ref().unwrap();
    let changes: Vec<String> = what_if.changes.iter().map(ToString::to_string).collect();
    assert_eq!(changes, ["(open door3_5)"]);
    assert_eq!(what_if.plan.cost, tour.plans[0].cost);
}

#[test]
fn a_goal_that_is_blocked_says_what_it_would_take() {
    let mut stack = museum().stack("n34");
    stack.world("(not (open door7_8))");
    stack.goal("hall", "(go n40)");
    stack.run();
    let all = stack.agent("parent").alternatives();
    assert_eq!(all[0].place, GoalPlace::Aside);
    assert!(all[0].plans.is_empty() && all[0].choice.is_none());
    let what_if = all[0].what_if.as_ref().unwrap();
    let changes: Vec<String> = what_if.changes.iter().map(ToString::to_string).collect();
    assert_eq!(changes, ["(open door7_8)"]);
}

#[test]
fn to_be_asked_changes_nothing() {
    let story = |ask: bool| {
        let mut stack = museum().stack("n1");
        stack.goal("tour", "(tour n2 n12 n19 n32)");
        stack.run_into("child", "(narrate n12)", 5.0);
        stack.emergency("toilet", "(go n28)");
        for second in 0..60 {
            stack.run_until(100.0 + f64::from(second));
            if ask {
                for agent in ["parent", "child"] {
                    assert!(stack.agent(agent).alternatives().len() <= 3);
                }
            }
        }
        stack.run();
        assert!(stack.succeeded("tour"));
        stack.story()
    };
    assert_eq!(story(true), story(false));
}
