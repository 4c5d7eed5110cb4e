//! Normal goal handling.

use agent_core::protocol::{Instruction, Urgency};
use intermezzo_tests::of_superior;

use super::{ON_ARC5, entering, on_the_way};

#[test]
fn normal_goals_are_served_in_the_order_in_which_they_came() {
    let mut parent = on_the_way();
    parent.goal("second", "(go n40)");
    parent.goal("third", "(go n40)");
    for number in 1..=5 {
        assert_eq!(parent.running().as_deref(), Some("tour"));
        parent.success(number, &[]);
    }
    // Both are where they wanted to be by now.
    assert_eq!(parent.running(), None);
    let ends = parent
        .events
        .iter()
        .filter(|event| event.what == agent_core::protocol::Happening::GoalSucceeded);
    let ends: Vec<_> = ends
        .map(|event| event.goal.clone().unwrap().to_string())
        .collect();
    assert_eq!(ends, ["tour", "second", "third"]);
}

#[test]
fn priority_orders_the_waiting_list_and_interrupts_nothing() {
    let mut parent = on_the_way();
    parent.goal("low", "(go n2)");
    assert_eq!(
        parent.ask("high", "(go n3)", Urgency::Normal, 5),
        Ok("high".into())
    );
    assert_eq!(parent.running().as_deref(), Some("tour"));
    for number in 1..=5 {
        parent.success(number, &[]);
    }
    assert_eq!(parent.running().as_deref(), Some("high"));
}

#[test]
fn a_normal_goal_waits_until_the_stack_is_empty() {
    let mut parent = on_the_way();
    parent.emergency("desk", "(go n4)");
    parent.suspended(1, &["(in area1)"]);
    parent.goal("later", "(go n2)");
    parent.success(2, &["(at n4)"]);
    assert_eq!(parent.running().as_deref(), Some("tour"), "not `later`");
}

#[test]
fn a_normal_goal_waits_for_goals_that_a_superior_holds_too() {
    let mut child = entering();
    child.instruct(Instruction::Suspend { id: of_superior(1) });
    child.suspended(1, &ON_ARC5);
    child.goal("own", "(reach n1)");
    assert_eq!(child.running(), None);
    child.instruct(Instruction::Clear { id: of_superior(1) });
    assert_eq!(child.running().as_deref(), Some("own"));
}
