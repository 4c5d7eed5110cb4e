//! The decisions where the paper is silent, by their numbers in ARCHITECTURE.md.

use agent_core::agent::{ResumedBy, SuspendedGoal};
use agent_core::model::Time;
use agent_core::protocol::{
    Answer, Command, GoalRequest, Happening, Input, Instruction, Rejection, Reply, Resumption,
    Urgency,
};
use intermezzo_tests::{museum, of_superior};

use super::{ON_ARC5, entering, map_of, on_the_way, parent};

/// A goal as it comes in.
fn request(id: Option<&str>, tasks: &str, urgency: Urgency) -> GoalRequest {
    GoalRequest {
        id: id.map(Into::into),
        tasks: agent_core::language::parse_tasks(tasks).expect("a test writes its tasks in HDDL"),
        urgency,
        priority: 0,
        deadline: None,
    }
}

#[test]
fn decision_1_an_instruction_starts_above_a_held_goal() {
    // Read literally, the emergency's subgoal waits for a stack that only its parent can empty,
    // and the parent waits for the subgoal.
    let mut child = entering();
    child.instruct(Instruction::Suspend { id: of_superior(1) });
    child.suspended(1, &ON_ARC5);
    child.told();
    assert_eq!(child.stacked(), ["superior.1.1"]);
    let answer = child.execute(2, "(approach n4 area1)", Some(&map_of("area1")));
    assert_eq!(answer, Answer::Accepted);
    assert_eq!(child.told(), ["execute #2 (leave arc5 n1)"]);
    child.success(2, &["(not (on arc5))", "(not (left n1))", "(at n1)"]);
    child.success(3, &["(not (at n1))", "(at n4)"]);
    assert_eq!(child.reported(), ["#1 suspended", "#2 success"]);
    assert_eq!(child.stacked(), ["superior.1.1"], "still held");
}

#[test]
fn decision_2_only_plans_that_were_kept_are_rolled_back() {
    let mut child = entering();
    child.instruct(Instruction::Suspend { id: of_superior(1) });
    child.suspended(1, &ON_ARC5);
    // The way back is the shorter one now: the door in front has closed, another is to be taken.
    child.instruct(Instruction::Clear { id: of_superior(1) });
    child.told();
    child.execute(2, "(enter area1 area2 door1_2)", Some(&map_of("area1")));
    assert_eq!(
        child.told(),
        ["execute #2 (leave arc5 n1)"],
        "and no (return n1 arc5) before it"
    );
}

#[test]
fn decision_4_the_higher_priority_goes_first_and_the_newest_among_equals() {
    let mut parent = on_the_way();
    parent.ask("low", "(go n4)", Urgency::Emergency, 1).unwrap();
    parent.suspended(1, &["(in area1)"]);
    assert_eq!(parent.running().as_deref(), Some("low"));
    // Higher: interrupts.
    parent
        .ask("high", "(go n2)", Urgency::Emergency, 2)
        .unwrap();
    parent.suspended(2, &["(in area1)"]);
    assert_eq!(parent.running().as_deref(), Some("high"));
    // Lower than what runs, and equal to what is suspended but newer: next.
    parent
        .ask("newer", "(go n3)", Urgency::Emergency, 1)
        .unwrap();
    assert_eq!(parent.running().as_deref(), Some("high"));
    // Lower than everything: after all emergencies, before the tour.
    parent
        .ask("last", "(go n5)", Urgency::Emergency, 0)
        .unwrap();
    parent.success(3, &["(at n2)"]);
    assert_eq!(parent.running().as_deref(), Some("newer"));
    parent.success(4, &["(at n3)"]);
    assert_eq!(parent.running().as_deref(), Some("low"));
    parent.success(2, &["(at n4)"]);
    assert_eq!(parent.running().as_deref(), Some("last"));
    parent.success(5, &["(at n5)"]);
    assert_eq!(parent.running().as_deref(), Some("tour"));
}

#[test]
fn decision_5_an_emergency_during_a_suspension_asks_nothing_twice() {
    let mut parent = on_the_way();
    parent.emergency("first", "(go n4)");
    parent.emergency("second", "(go n2)");
    assert_eq!(parent.told(), ["suspend #1"]);
    parent.suspended(1, &["(in area1)"]);
    assert_eq!(parent.running().as_deref(), Some("second"));
    assert_eq!(parent.stacked(), ["tour"]);
    parent.success(2, &["(at n2)"]);
    assert_eq!(parent.running().as_deref(), Some("first"));
}

#[test]
fn decision_6_what_runs_above_a_goal_is_suspended_and_released_with_it() {
    let mut child = entering();
    // An emergency of the child's own.
    child.emergency("own", "(reach n4)");
    child.suspended(1, &ON_ARC5);
    assert_eq!(child.stacked(), ["superior.1.1"]);
    child.told();
    assert_eq!(
        child.instruct(Instruction::Suspend { id: of_superior(1) }),
        Answer::Suspending
    );
    assert_eq!(child.told(), ["suspend #2"]);
    child.suspended(2, &["(on arc5)"]);
    assert_eq!(child.stacked(), ["superior.1.1", "own"]);
    assert_eq!(child.reported(), ["#1 suspended"]);
    assert_eq!(child.running(), None, "nothing of it restarts by itself");
    let held = |entry: &SuspendedGoal| entry.resumed_by == ResumedBy::Superior;
    assert!(
        child.agent.stack().entries().iter().all(held),
        "all of it is held"
    );
    let map = Some(map_of("area1"));
    child.instruct(Instruction::Resume {
        id: of_superior(1),
        map,
    });
    assert_eq!(child.running().as_deref(), Some("own"), "the top first");
}

#[test]
fn decision_7_a_goal_without_a_plan_is_blocked_and_goes_on_when_the_fact_changes() {
    let mut parent = parent();
    parent.observe(&["(not (open door7_8))"]);
    parent.goal("tour", "(go n40)");
    assert!(parent.told().is_empty());
    assert!(parent.said(
        "tour",
        |what| matches!(what, Happening::GoalBlocked { blocked_by }
        if blocked_by.iter().any(|fact| fact.to_string() == "(open door7_8)"))
    ));
    // Others go on meanwhile.
    parent.goal("desk", "(go n4)");
    assert_eq!(parent.told(), ["execute #1 (approach n4 area1)"]);
    parent.success(1, &["(at n4)"]);
    assert!(parent.told().is_empty());
    parent.observe(&["(open door7_8)"]);
    assert_eq!(parent.told(), ["execute #2 (enter area1 area3 door1_3)"]);
}

#[test]
fn decision_7_a_deadline_ends_a_blocked_goal() {
    let mut parent = parent();
    parent.observe(&["(not (open door7_8))"]);
    let request = GoalRequest {
        deadline: Some(Time::from_secs(30.0)),
        ..request(Some("tour"), "(go n40)", Urgency::Normal)
    };
    parent.tell(Input::Goal(request));
    assert_eq!(
        agent_core::protocol::Machine::wake_at(&parent.agent),
        Some(Time::from_secs(30.0))
    );
    parent.now = Time::from_secs(30.0);
    parent.tell(Input::Wake);
    assert!(parent.said(
        "tour",
        |what| matches!(what, Happening::GoalFailed { reason }
        if reason.contains("deadline"))
    ));
}

#[test]
fn decision_8_an_action_that_serves_the_emergency_goes_on() {
    let mut parent = parent();
    parent.goal("tour", "(go n40)");
    parent.told();
    parent.emergency("exhibit", "(go n12)");
    assert!(
        parent.told().is_empty(),
        "area3 is on the way: nothing is stopped"
    );
    assert_eq!(parent.running().as_deref(), Some("exhibit"));
    assert_eq!(parent.stacked(), ["tour"]);
    parent.success(1, &[]);
    assert_eq!(parent.told(), ["execute #2 (approach n12 area3)"]);
    parent.success(2, &["(at n12)"]);
    assert_eq!(parent.told(), ["execute #3 (enter area3 area5 door3_5)"]);
}

#[test]
fn decision_8_an_action_that_does_not_serve_the_emergency_is_stopped() {
    let mut parent = parent();
    parent.goal("tour", "(go n40)");
    parent.told();
    parent.emergency("bench", "(go n13)");
    assert_eq!(parent.told(), ["suspend #1"]);
}

#[test]
fn decision_9_an_emergency_is_acted_on_in_the_midst_of_planning() {
    let mut configuration = museum().parent("n1");
    configuration.policy.expansions_per_slice = 1;
    let mut parent = intermezzo_tests::Bench::new(configuration);
    let reply = parent.tell_only(Input::Goal(request(
        Some("tour"),
        "(go n40)",
        Urgency::Normal,
    )));
    assert_eq!(reply, Some(Reply::Goal(Ok("tour".into()))));
    assert!(parent.told().is_empty(), "one expansion makes no plan");
    parent.tell(Input::Goal(request(
        Some("desk"),
        "(go n4)",
        Urgency::Emergency,
    )));
    assert_eq!(parent.told(), ["execute #1 (approach n4 area1)"]);
    assert_eq!(parent.stacked(), ["tour"]);
}

#[test]
fn decision_10_stopping_waits_for_nothing() {
    let mut parent = on_the_way();
    let request = request(Some("desk"), "(go n4)", Urgency::Emergency);
    // Not for a plan, not for a second look, and before the goal's sender has its answer.
    let reply = parent.tell_only(Input::Goal(request));
    assert_eq!(parent.told(), ["suspend #1"]);
    assert_eq!(reply, Some(Reply::Goal(Ok("desk".into()))));
}

fn resumption(parent: &intermezzo_tests::Bench, goal: &str) -> Option<Resumption> {
    let about = parent.events.iter().rev();
    about
        .filter(|event| event.goal.as_ref().is_some_and(|id| *id == goal))
        .find_map(|event| match event.what {
            Happening::GoalResumed { how, .. } => Some(how),
            _ => None,
        })
}

/// A tour that is suspended in area1 while the robot visits n3; then facts change, and it is
/// taken up again.
fn resumed_after(facts: &[&str]) -> intermezzo_tests::Bench {
    let mut parent = on_the_way();
    parent.emergency("wall", "(go n3)");
    parent.suspended(1, &["(in area1)"]);
    parent.observe(facts);
    parent.success(2, &["(at n3)"]);
    parent
}

#[test]
fn decision_12_a_plan_that_still_holds_is_continued() {
    let parent = resumed_after(&[]);
    assert_eq!(resumption(&parent, "tour"), Some(Resumption::Continued));
}

#[test]
fn decision_12_another_plan_that_was_kept_is_an_alternative() {
    // One door further on is closed: a way round it was kept from the beginning.
    let parent = resumed_after(&["(not (open door3_5))"]);
    assert_eq!(resumption(&parent, "tour"), Some(Resumption::Alternative));
}

#[test]
fn decision_12_a_new_plan_that_ends_as_a_kept_one_is_repaired() {
    let parent = resumed_after(&[
        "(not (open door3_5))",
        "(not (open door4_6))",
        "(open door6_8)",
        "(not (in area1))",
        "(in area6)",
    ]);
    assert_eq!(resumption(&parent, "tour"), Some(Resumption::Repaired));
}

#[test]
fn decision_12_a_goal_that_had_no_plan_is_replanned() {
    let mut configuration = museum().parent("n1");
    configuration.policy.expansions_per_slice = 1;
    let mut parent = intermezzo_tests::Bench::new(configuration);
    parent.tell_only(Input::Goal(request(
        Some("tour"),
        "(go n40)",
        Urgency::Normal,
    )));
    parent.tell(Input::Goal(request(
        Some("desk"),
        "(go n4)",
        Urgency::Emergency,
    )));
    parent.success(1, &["(at n4)"]);
    assert_eq!(resumption(&parent, "tour"), Some(Resumption::Replanned));
}

#[test]
fn decision_11_a_task_under_which_something_was_done_once_is_not_begun_again() {
    let mut parent = parent();
    parent.goal("tour", "(tour n2 n3 n4 n5)");
    let may_begin_again = |parent: &intermezzo_tests::Bench| {
        let agendas = &parent.agent.running().unwrap().agendas;
        let mut first = agendas.iter().filter_map(|agenda| agenda.tasks.first());
        first.any(|(item, _, _)| item.atom().name == "tour")
    };
    parent.success(1, &["(at n2)"]);
    assert!(may_begin_again(&parent), "moving may be repeated");
    parent.success(2, &[]);
    assert_eq!(
        parent.told(),
        [
            "execute #1 (approach n2 area1)",
            "execute #2 (explain n2)",
            "execute #3 (approach n3 area1)"
        ]
    );
    assert!(!may_begin_again(&parent), "an explanation may not");
}

#[test]
fn decision_13_an_explanation_is_taken_up_again_where_it_was_broken_off() {
    let mut parent = parent();
    parent.goal("show", "(show n2)");
    parent.success(1, &["(at n2)"]);
    assert_eq!(
        parent.told(),
        ["execute #1 (approach n2 area1)", "execute #2 (explain n2)"]
    );
    parent.emergency("bench", "(go n13)");
    parent.suspended(2, &[]);
    assert_eq!(
        parent.told(),
        ["suspend #2", "execute #3 (enter area1 area2 door1_2)"]
    );
    parent.success(3, &["(not (at n2))"]);
    parent.success(4, &["(at n13)"]);
    assert_eq!(
        parent.told(),
        [
            "execute #4 (approach n13 area2)",
            "execute #5 (enter area2 area1 door1_2)"
        ],
        "the record of the explanation is not cleared on the way back"
    );
    parent.success(5, &["(not (at n13))"]);
    parent.success(6, &["(at n2)"]);
    assert_eq!(
        parent.told(),
        ["execute #6 (approach n2 area1)", "resume #2"]
    );
    parent.success(2, &[]);
    assert!(parent.said("show", |what| *what == Happening::GoalSucceeded));
}

#[test]
fn what_a_user_sets_aside_waits_for_the_user() {
    let mut parent = on_the_way();
    assert_eq!(parent.command(Command::Suspend("tour".into())), Ok(()));
    assert_eq!(parent.told(), ["suspend #1"]);
    parent.suspended(1, &[]);
    assert_eq!(parent.running(), None);
    parent.goal("desk", "(go n4)");
    assert_eq!(
        parent.told(),
        ["execute #2 (approach n4 area1)"],
        "others go on"
    );
    parent.success(2, &["(at n4)"]);
    assert_eq!(parent.command(Command::Resume("tour".into())), Ok(()));
    assert_eq!(parent.told(), ["resume #1"]);
    assert_eq!(
        parent.command(Command::Resume("nobody".into())),
        Err(Rejection::UnknownGoal("nobody".into()))
    );
}

#[test]
fn what_a_user_cancels_is_rolled_back_where_the_domain_says_how() {
    let mut configuration = museum().child("n1", "child", "executor");
    configuration.map = map_of("area1");
    let mut child = intermezzo_tests::Bench::new(configuration);
    child.goal("walk", "(reach n6)");
    child.told();
    assert_eq!(child.command(Command::Cancel("walk".into())), Ok(()));
    child.suspended(1, &ON_ARC5);
    assert_eq!(
        child.told(),
        ["suspend #1", "clear #1", "execute #2 (return n1 arc5)"]
    );
    child.success(2, &["(not (on arc5))", "(at n1)"]);
    assert!(child.said("walk", |what| matches!(
        what,
        Happening::ActionRolledBack { .. }
    )));
    assert!(child.said("walk", |what| matches!(what, Happening::GoalFailed { .. })));
    assert_eq!(child.running(), None);
}

#[test]
fn a_goal_without_a_name_gets_one_that_nobody_has_given() {
    let mut parent = on_the_way();
    let mut name = |id: Option<&str>| {
        let request = request(id, "(go n4)", Urgency::Normal);
        match parent.tell(Input::Goal(request)) {
            Some(Reply::Goal(Ok(id))) => id.to_string(),
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(name(Some("g3")), "g3");
    assert_eq!(name(None), "g4", "the third of this agent, but g3 is taken");
    assert_eq!(name(None), "g5", "and so is g4 now");
}

#[test]
fn a_goal_named_twice_is_one_goal_and_bad_goals_are_refused_with_a_reason() {
    let mut parent = on_the_way();
    assert_eq!(
        parent.ask("tour", "(go n40)", Urgency::Normal, 0),
        Ok("tour".into())
    );
    assert_eq!(parent.agent.waiting().intentions().len(), 0);
    let mut reason = |id: &str, tasks: &str| {
        let verdict = parent.ask(id, tasks, Urgency::Emergency, 0);
        verdict.expect_err("it is refused").to_string()
    };
    assert_eq!(
        reason("tour", "(go n1)"),
        "there is another goal named `tour` already"
    );
    assert_eq!(
        reason("a", "(go n41)"),
        "unknown object `n41` in `(go n41)`"
    );
    assert_eq!(
        reason("b", "(go area1)"),
        "`area1` in `(go area1)` is of type area, but node is wanted"
    );
    assert_eq!(reason("c", "(go)"), "`(go)` takes 1 argument(s), not 0");
    assert!(reason("d", "(fly n1)").starts_with("unknown task `fly`; this agent knows "));
    assert_eq!(parent.running().as_deref(), Some("tour"));
}
