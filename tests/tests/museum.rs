//! Whole stacks in the museum, in virtual time: parent, child and robot.

use std::collections::BTreeMap;

use agent_core::language::parse_tasks;
use agent_core::model::{Symbol, Time};
use agent_core::planner::{Depth, Settings};
use agent_core::protocol::{Command, GoalRequest, Happening, Resumption, Urgency};
use executor_sim::{Fault, Faults};
use intermezzo_tests::{Planning, Stack, Wire, agent, agent_planning, museum};
use maps::read_level;

/// The exhibits at which an explanation was begun, one entry for each beginning.
fn explanations(stack: &Stack) -> Vec<String> {
    let begun = stack.of("executor").filter_map(|event| match &event.what {
        Happening::ActionStarted { action, .. } if action.name == "narrate" => {
            Some(action.args[0].to_string())
        }
        _ => None,
    });
    begun.collect()
}

#[test]
fn a_tour_interrupted_in_mid_explanation_goes_on_with_that_explanation() {
    let mut stack = museum().stack("n1");
    stack.goal("tour", "(tour n2 n12 n19 n32)");
    stack.run_into("child", "(narrate n19)", 10.0);
    stack.emergency("toilet", "(go n28)");
    stack.run();
    assert!(stack.succeeded("toilet"), "{}", stack.story());
    assert!(stack.succeeded("tour"), "{}", stack.story());
    assert_eq!(
        explanations(&stack),
        ["n2", "n12", "n19", "n32"],
        "none twice"
    );
    let done = stack.done("executor");
    let third = done.iter().filter(|action| action.contains("narrate n19"));
    assert_eq!(third.count(), 1);
    // In mid-sentence: ten seconds were told before, twenty after.
    let ends: Vec<Time> = stack
        .of("executor")
        .filter(|event| match &event.what {
            Happening::ActionResumed { action, .. } | Happening::ActionFinished { action, .. } => {
                action.to_string().contains("narrate n19")
            }
            _ => false,
        })
        .map(|event| event.at)
        .collect();
    assert_eq!(ends.len(), 2, "{}", stack.story());
    let told_s = ends[1].since(ends[0]).secs();
    assert!((told_s - 20.0).abs() < 0.1, "{told_s}");
    let parent = stack.done("parent");
    let shown = parent
        .iter()
        .filter(|action| action.starts_with("(approach"));
    // Each exhibit once, the toilet, and the third again to go on.
    assert_eq!(shown.count(), 6, "{parent:?}");
}

#[test]
fn a_question_and_a_greeting_break_off_an_explanation_in_mid_sentence() {
    let mut stack = museum().stack("n1");
    stack.goal("show", "(show n12)");
    stack.run_into("child", "(narrate n12)", 5.0);
    stack.emergency("question", "(answer n12)");
    stack.run_into("child", "(reply n12)", 3.0);
    // Too short to be broken off itself.
    stack.emergency("hello", "(greet guest)");
    stack.run();
    for goal in ["hello", "question", "show"] {
        assert!(stack.succeeded(goal), "{goal}\n{}", stack.story());
    }
    assert_eq!(
        stack.done("executor")[3..],
        ["(hail guest)", "(reply n12)", "(narrate n12)"],
        "{}",
        stack.story()
    );
    assert_eq!(
        stack.resumption("parent", "question"),
        Some(Resumption::Continued)
    );
    assert_eq!(
        stack.resumption("parent", "show"),
        Some(Resumption::Continued)
    );
}

#[test]
fn two_nested_emergencies_and_a_closed_door_do_not_lose_the_tour() {
    let mut stack = museum().stack("n1");
    stack.goal("tour", "(guide n40)");
    stack.run_into("child", "(move n1 n6 arc5)", 4.0);
    stack.emergency("toilet", "(go n28)");
    stack.run_into("child", "(move n14 n16 arc25)", 2.0);
    stack.emergency("bench", "(go n13)");
    stack.run_to("parent", |event| {
        event.stack_depth == 2 && event.what == Happening::GoalStarted
    });
    stack.world("(not (open door4_6))");
    stack.run();
    for goal in ["bench", "toilet", "tour"] {
        assert!(stack.succeeded(goal), "{goal}\n{}", stack.story());
    }
    assert_eq!(stack.place(), "at n40");
    assert_eq!(
        stack.resumption("parent", "toilet"),
        Some(Resumption::Continued)
    );
    assert_eq!(
        stack.resumption("parent", "tour"),
        Some(Resumption::Repaired)
    );
    let parent = stack.done("parent");
    assert!(
        !parent.iter().any(|action| action.contains("door4_6")),
        "{parent:?}"
    );
}

#[test]
fn a_door_that_closes_ahead_makes_the_robot_go_another_way() {
    let mut stack = museum().stack("n1");
    stack.goal("tour", "(go n40)");
    stack.run_into("child", "(move n8 n9 arc14)", 2.0);
    stack.world("(not (open door3_5))");
    stack.run();
    assert!(stack.succeeded("tour"), "{}", stack.story());
    let parent = stack.done("parent");
    assert!(
        parent.contains(&"(enter area3 area4 door3_4)".to_owned()),
        "{parent:?}"
    );
    assert!(
        !stack
            .done("child")
            .iter()
            .any(|action| action.contains("door3_5"))
    );
}

#[test]
fn a_door_that_shuts_in_front_of_the_robot_fails_the_action_and_not_the_goal() {
    let mut stack = museum().stack("n1");
    stack.goal("tour", "(go n12)");
    stack.run_into("child", "(pass n6 n10 arc12 door1_3)", 0.5);
    stack.world("(not (open door1_3))");
    stack.run();
    assert!(stack.succeeded("tour"), "{}", stack.story());
    assert_eq!(stack.place(), "at n12");
}

#[test]
fn a_goal_whose_only_way_is_closed_is_blocked_and_goes_on_when_the_door_opens() {
    let mut stack = museum().stack("n30");
    stack.world("(not (open door7_8))");
    stack.goal("far", "(go n40)");
    stack.run_until(20.0);
    let blocked = stack.about("parent", "far").any(|event| match &event.what {
        Happening::GoalBlocked { blocked_by } => blocked_by
            .iter()
            .any(|fact| fact.to_string() == "(open door7_8)"),
        _ => false,
    });
    assert!(blocked, "{}", stack.story());
    assert_eq!(stack.place(), "at n30");
    stack.world("(open door7_8)");
    stack.run();
    assert!(stack.succeeded("far"), "{}", stack.story());
}

#[test]
fn a_staff_door_that_opens_makes_a_shorter_way_and_it_is_taken() {
    let mut stack = museum().stack("n23");
    stack.world("(open door6_8)");
    stack.goal("far", "(go n36)");
    stack.run();
    assert_eq!(
        stack.done("parent"),
        // n36 is just behind it.
        ["(enter area6 area8 door6_8)"],
        "{}",
        stack.story()
    );
}

/// The actions of a drive without their numbers: what the robot did, in the child's words.
fn drive_of(mut stack: Stack) -> Vec<String> {
    stack.goal("tour", "(show n12)");
    stack.run_into("child", "(move n1 n6 arc5)", 4.0);
    stack.emergency("desk", "(go n4)");
    stack.run_into("child", "(narrate n12)", 5.0);
    stack.emergency("toilet", "(go n28)");
    stack.run();
    for goal in ["desk", "toilet", "tour"] {
        assert!(stack.succeeded(goal), "{goal}\n{}", stack.story());
    }
    stack.done("child")
}

#[test]
fn three_storeys_give_the_same_drive_as_two_without_new_agent_code() {
    let museum = museum();
    let two = drive_of(museum.stack("n1"));
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("domains");
    let motion = read_level(&folder, "motion").expect("the third storey is in order");
    let mut stack = Stack::new(Wire::steady());
    stack.add_agent(agent(museum.parent("n1")), &["child"]);
    stack.add_agent(
        agent(museum.child("n1", "child", "grandchild")),
        &["grandchild"],
    );
    let mut grandchild = museum.child("n1", "grandchild", "executor");
    grandchild.domain = motion.domain.clone().into();
    grandchild.model = motion.model.clone().into();
    stack.add_agent(agent(grandchild), &["executor"]);
    stack.add_robot("executor", museum.robot_of(&motion, "n1", Faults::none()));
    assert_eq!(drive_of(stack), two);
}

#[test]
fn two_wings_with_a_child_agent_each_work_in_turn() {
    let museum = museum();
    let wings: BTreeMap<Symbol, Symbol> = ["area2", "area4", "area6", "area8"]
        .map(|area| (area.into(), "east".into()))
        .into();
    let mut stack = Stack::new(Wire::steady());
    stack.add_agent(agent(museum.parent_of("n1", wings)), &["child", "east"]);
    stack.add_agent(
        agent(museum.child("n1", "child", "executor")),
        &["executor"],
    );
    stack.add_agent(agent(museum.child("n1", "east", "executor")), &["executor"]);
    stack.add_robot("executor", museum.robot("n1", Faults::none()));
    stack.goal("tour", "(go n40)");
    stack.run_into("child", "(move n1 n6 arc5)", 4.0);
    stack.emergency("toilet", "(go n28)");
    stack.run_into("east", "(move n14 n16 arc25)", 2.0);
    stack.emergency("desk", "(go n4)");
    stack.run();
    for goal in ["desk", "toilet", "tour"] {
        assert!(stack.succeeded(goal), "{goal}\n{}", stack.story());
    }
    assert_eq!(stack.place(), "at n40");
    assert!(!stack.done("east").is_empty());
    // One at a time: the robot is never told to begin while another action runs.
    let refused = stack.of("executor").any(|event| {
        matches!(
            &event.what,
            Happening::ActionFinished {
                failure: Some(_),
                ..
            }
        )
    });
    assert!(!refused, "{}", stack.story());
}

#[test]
fn an_emergency_at_any_moment_is_served_and_the_tour_goes_on() {
    let museum = museum();
    for tenths in (0..900).step_by(7) {
        let mut stack = museum.stack("n1");
        stack.goal("tour", "(show n12)");
        stack.run_until(f64::from(tenths) / 10.0);
        stack.emergency("desk", "(go n4)");
        stack.run();
        let story = || format!("after {tenths} tenths of a second\n{}", stack.story());
        assert!(stack.succeeded("desk"), "{}", story());
        assert!(stack.succeeded("tour"), "{}", story());
        assert_eq!(explanations(&stack), ["n12"], "{}", story());
    }
}

#[test]
fn goals_at_random_over_a_slow_wire_and_with_faults_all_come_to_an_end() {
    let museum = museum();
    let places = ["n4", "n12", "n13", "n19", "n28", "n5", "n40"];
    for seed in 0..60_u64 {
        let wire = Wire::random(seed, Time::from_secs(0.001), Time::from_secs(0.4));
        let faults = Faults::list([
            (seed % 5, Fault::Failure { fraction: 0.5 }),
            (5 + seed % 3, Fault::RefusedSuspension),
            (9 + seed % 4, Fault::Slow { pace: 0.5 }),
            (
                13,
                Fault::LateStop {
                    delay: Time::from_secs(1.5),
                },
            ),
        ]);
        let mut stack = museum.stack_with("n1", wire, faults, |_| {});
        stack.goal("tour", "(tour n2 n12 n19 n32)");
        let mut draw = seed.wrapping_mul(0x2545_f491_4f6c_dd1d) | 1;
        for number in 0..4 {
            draw ^= draw << 13;
            draw ^= draw >> 7;
            draw ^= draw << 17;
            stack.run_until(stack.now().secs() + (draw % 40_000) as f64 / 1000.0);
            let place = places[(draw >> 20) as usize % places.len()];
            let priority = (draw >> 40) as i32 % 3;
            let id = format!("e{number}");
            let task = format!("(go {place})");
            let verdict = stack.ask("parent", &id, &task, Urgency::Emergency, priority);
            assert_eq!(verdict, Ok(id.as_str().into()));
        }
        stack.run();
        for goal in ["tour", "e0", "e1", "e2", "e3"] {
            assert!(
                stack.succeeded(goal),
                "seed {seed}: {goal}\n{}",
                stack.story()
            );
        }
        assert_eq!(stack.agent("parent").stack().depth(), 0, "seed {seed}");
        assert_eq!(stack.agent("child").stack().depth(), 0, "seed {seed}");
    }
}

#[test]
fn the_paper_s_depth_of_planning_reaches_the_goal_too() {
    let museum = museum();
    let mut stack = Stack::new(Wire::steady());
    let shallow = |configuration| {
        let settings = Settings {
            depth: Depth::FirstAction,
            ..Settings::default()
        };
        agent_planning(configuration, Planning::default(), settings)
    };
    stack.add_agent(shallow(museum.parent("n1")), &["child"]);
    stack.add_agent(
        shallow(museum.child("n1", "child", "executor")),
        &["executor"],
    );
    stack.add_robot("executor", museum.robot("n1", Faults::none()));
    stack.goal("tour", "(go n40)");
    stack.run_into("child", "(move n1 n6 arc5)", 4.0);
    stack.emergency("desk", "(go n4)");
    stack.run();
    assert!(stack.succeeded("desk"), "{}", stack.story());
    assert!(stack.succeeded("tour"), "{}", stack.story());
}

#[test]
fn a_cancelled_goal_leaves_the_robot_free_and_a_deadline_ends_a_goal() {
    let mut stack = museum().stack("n1");
    stack.goal("tour", "(go n40)");
    stack.run_into("child", "(move n1 n6 arc5)", 4.0);
    assert_eq!(stack.command(Command::Cancel("tour".into())), Ok(()));
    stack.run();
    let request = GoalRequest {
        id: Some("late".into()),
        tasks: parse_tasks("(go n40)").expect("HDDL"),
        urgency: Urgency::Normal,
        priority: 0,
        deadline: Some(Time::from_secs(10.0)),
    };
    assert_eq!(stack.request("parent", request), Ok("late".into()));
    stack.run();
    for goal in ["tour", "late"] {
        let failed = stack
            .about("parent", goal)
            .any(|event| matches!(event.what, Happening::GoalFailed { .. }));
        assert!(failed, "{goal}\n{}", stack.story());
    }
    stack.goal("desk", "(go n4)");
    stack.run();
    assert!(stack.succeeded("desk"), "{}", stack.story());
}

#[test]
fn the_child_holds_the_map_of_the_area_it_works_in_and_no_more() {
    let mut stack = museum().stack("n1");
    stack.goal("tour", "(go n12)");
    stack.run_into("child", "(move n1 n6 arc5)", 1.0);
    let goal = stack.agent("child").running().expect("it is under way");
    let objects: Vec<&str> = goal.goal.map.objects.keys().map(Symbol::as_str).collect();
    assert!(objects.contains(&"n5"), "a node of area1");
    assert!(objects.contains(&"n10"), "the far side of its door");
    assert!(!objects.contains(&"n12"), "in the middle of area3");
}

#[test]
fn facts_seen_below_look_the_same_above_in_whatever_order_they_come() {
    // Projection commutes with updates: what the parent hears of the last state does not depend on
    // the way there.
    let museum = museum();
    let mut near = museum.stack("n1");
    near.goal("go", "(go n12)");
    near.run();
    let mut far = museum.stack("n40");
    far.goal("go", "(go n12)");
    far.run();
    let place = |stack: &Stack| -> Vec<String> {
        let belief = stack.agent("parent").belief();
        let facts = belief
            .facts()
            .filter(|fact| fact.name == "at" || fact.name == "in");
        facts.map(ToString::to_string).collect()
    };
    assert_eq!(place(&near), ["(at n12)", "(in area3)"]);
    assert_eq!(place(&near), place(&far));
}
