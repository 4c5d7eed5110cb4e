//! How many goals an agent lets wait.
#![allow(clippy::unwrap_used, clippy::panic, missing_docs)]

use agent_core::agent::Configuration;
use agent_core::model::Time;
use agent_core::protocol::{Command, GoalId, Happening, Rejection, Urgency};
use executor_sim::Faults;
use intermezzo_tests::{Stack, Wire, museum};

/// A robot at the entrance whose agents let two goals of a kind wait.
fn stack() -> Stack {
    let two = |configuration: &mut Configuration| configuration.policy.most_waiting = 2;
    museum().stack_with("n1", Wire::steady(), Faults::none(), two)
}

fn ask(stack: &mut Stack, id: &str, urgency: Urgency) -> Result<GoalId, Rejection> {
    stack.ask("parent", id, "(go n4)", urgency, 0)
}

fn started(stack: &Stack, goal: &str) -> bool {
    let mut events = stack.about("parent", goal);
    events.any(|event| event.what == Happening::GoalStarted)
}

fn too_many(kind: &str) -> Result<GoalId, Rejection> {
    Err(Rejection::TooManyWaiting {
        kind: kind.into(),
        waiting: 2,
        most: 2,
    })
}

#[test]
fn a_goal_too_many_is_refused_in_words_and_leaves_room_for_emergencies() {
    let mut stack = stack();
    stack.goal("tour", "(go n40)");
    for id in ["second", "third"] {
        assert_eq!(ask(&mut stack, id, Urgency::Normal), Ok(id.into()));
    }
    let refused = ask(&mut stack, "fourth", Urgency::Normal);
    assert_eq!(refused, too_many("goals"));
    assert_eq!(
        refused.unwrap_err().to_string(),
        "2 goals wait already, and no more than 2 may: cancel one, or ask again later"
    );
    // Whoever has not heard the answer and asks again is told what was decided.
    assert_eq!(
        ask(&mut stack, "third", Urgency::Normal),
        Ok("third".into())
    );
    assert_eq!(
        ask(&mut stack, "fire", Urgency::Emergency),
        Ok("fire".into())
    );
    stack.run();
    for id in ["tour", "second", "third", "fire"] {
        assert!(stack.succeeded(id), "{}", stack.story());
    }
    assert!(
        stack.about("parent", "fourth").count() == 1,
        "{}",
        stack.story()
    );
    assert_eq!(
        ask(&mut stack, "fourth", Urgency::Normal),
        Ok("fourth".into())
    );
}

#[test]
fn emergencies_inside_emergencies_have_an_end_and_a_cancelled_one_makes_room() {
    let mut stack = stack();
    stack.goal("tour", "(go n40)");
    stack.run_into("child", "(move n1 n6 arc5)", 1.0);
    // Each is interrupted by the next one: what is suspended waits, too.
    for (id, tasks) in [("a", "(go n12)"), ("b", "(go n28)"), ("c", "(go n12)")] {
        stack.emergency(id, tasks);
        while !started(&stack, id) {
            assert!(stack.step(Time::from_secs(60.0)), "{}", stack.story());
        }
    }
    assert_eq!(
        stack.agent("parent").stack().depth(),
        3,
        "{}",
        stack.story()
    );
    let ask_d = |stack: &mut Stack| stack.ask("parent", "d", "(go n4)", Urgency::Emergency, 4);
    assert_eq!(ask_d(&mut stack), too_many("emergencies"));
    stack.command(Command::Cancel("a".into())).unwrap();
    assert_eq!(ask_d(&mut stack), Ok("d".into()));
    stack.run();
    for id in ["tour", "b", "c", "d"] {
        assert!(stack.succeeded(id), "{}", stack.story());
    }
}

#[test]
fn what_a_superior_asks_for_is_not_counted() {
    let child_keeps_none = |configuration: &mut Configuration| {
        if configuration.name == "child" {
            configuration.policy.most_waiting = 0;
        }
    };
    let mut stack = museum().stack_with("n1", Wire::steady(), Faults::none(), child_keeps_none);
    stack.goal("tour", "(go n40)");
    stack.run_into("child", "(move n1 n6 arc5)", 1.0);
    stack.emergency("fire", "(go n12)");
    stack.run();
    for id in ["tour", "fire"] {
        assert!(stack.succeeded(id), "{}", stack.story());
    }
}
