//! Emergency goal handling.

use agent_core::model::Time;
use agent_core::protocol::{Answer, Happening, Report, Resumption};

use super::{on_the_way, parent, parent_as_in_the_paper};

#[test]
fn an_emergency_starts_at_once_when_nothing_runs() {
    let mut parent = parent();
    parent.emergency("toilet", "(go n28)");
    assert_eq!(parent.told(), ["execute #1 (enter area1 area2 door1_2)"]);
}

#[test]
fn an_emergency_suspends_executes_and_resumes() {
    let mut parent = on_the_way();
    parent.emergency("desk", "(go n4)");
    assert_eq!(parent.told(), ["suspend #1"]);
    parent.answer_to_suspend(1, Answer::Suspending);
    assert!(
        parent.told().is_empty(),
        "nothing begins before the robot stands"
    );
    parent.suspended(1, &["(in area1)"]);
    assert_eq!(parent.stacked(), ["tour"]);
    assert_eq!(parent.told(), ["execute #2 (approach n4 area1)"]);
    parent.success(2, &["(at n4)"]);
    assert_eq!(parent.told(), ["resume #1"]);
    assert!(parent.stacked().is_empty());
    assert!(parent.said("tour", |what| matches!(
        what,
        Happening::GoalResumed {
            how: Resumption::Continued,
            ..
        }
    )));
}

#[test]
fn an_action_that_ends_before_the_request_leaves_none_to_resume() {
    let mut parent = on_the_way();
    parent.emergency("desk", "(go n13)");
    parent.told();
    // Decision 3: the answer carries the outcome; the report comes late.
    let facts = Vec::new();
    let outcome = Report::Success { facts };
    parent.answer_to_suspend(1, Answer::Finished { outcome });
    assert_eq!(parent.stacked(), ["tour"]);
    parent.success(1, &[]);
    let entry = &parent.agent.stack().entries()[0];
    assert!(entry.intention.records.is_empty());
    assert_eq!(parent.plans("tour")[0][0], "(enter area3 area5 door3_5)");
    assert_eq!(parent.told(), ["execute #2 (enter area3 area1 door1_3)"]);
}

#[test]
fn an_action_that_ends_while_it_is_being_suspended_leaves_none_to_resume() {
    let mut parent = on_the_way();
    parent.emergency("bench", "(go n13)");
    parent.answer_to_suspend(1, Answer::Suspending);
    parent.success(1, &[]);
    assert_eq!(parent.stacked(), ["tour"]);
    assert!(
        parent.agent.stack().entries()[0]
            .intention
            .records
            .is_empty()
    );
}

#[test]
fn an_action_that_ended_the_goal_leaves_nothing_to_push() {
    let mut parent = parent_as_in_the_paper();
    parent.goal("desk", "(go n4)");
    parent.emergency("bench", "(go n13)");
    parent.answer_to_suspend(1, Answer::Suspending);
    parent.success(1, &["(at n4)"]);
    assert!(parent.said("desk", |what| *what == Happening::GoalSucceeded));
    assert!(parent.stacked().is_empty());
    assert_eq!(parent.running().as_deref(), Some("bench"));
}

#[test]
fn an_action_that_cannot_be_suspended_runs_to_its_end() {
    let mut parent = on_the_way();
    parent.emergency("bench", "(go n13)");
    let finishes_in = Time::from_secs(5.0);
    parent.answer_to_suspend(1, Answer::Refused { finishes_in });
    assert_eq!(parent.told(), ["suspend #1"]);
    parent.success(1, &[]);
    assert_eq!(parent.told(), ["execute #2 (enter area3 area1 door1_3)"]);
}

#[test]
fn an_action_that_the_domain_does_not_suspend_is_not_asked_to() {
    let mut parent = parent_as_in_the_paper();
    parent.goal("hello", "(greet guest)");
    parent.told();
    parent.emergency("desk", "(go n4)");
    assert!(parent.told().is_empty());
    parent.success(1, &[]);
    assert!(parent.said("hello", |what| *what == Happening::GoalSucceeded));
    assert_eq!(parent.told(), ["execute #2 (approach n4 area1)"]);
}

#[test]
fn an_emergency_that_fails_lets_the_suspended_goal_go_on() {
    let mut parent = on_the_way();
    parent.emergency("story", "(explain n28)");
    parent.suspended(1, &[]);
    assert!(parent.said("story", |what| matches!(what, Happening::GoalFailed { .. })));
    assert_eq!(parent.told(), ["suspend #1", "resume #1"]);
}

#[test]
fn emergencies_nest_to_any_depth() {
    let mut parent = on_the_way();
    let places = ["n4", "n13", "n5", "n2", "n3"];
    for (depth, place) in places.iter().enumerate() {
        parent.emergency(place, &format!("(go {place})"));
        let number = depth as u64 + 1;
        parent.suspended(number, &["(in area1)"]);
        assert_eq!(parent.stacked().len(), depth + 1);
    }
    assert_eq!(parent.stacked(), ["tour", "n4", "n13", "n5", "n2"]);
    parent.told();
    parent.success(6, &["(at n3)"]);
    // n2 was being approached: that is taken up again.
    assert_eq!(parent.told(), ["resume #5"]);
    assert_eq!(parent.stacked(), ["tour", "n4", "n13", "n5"]);
}
