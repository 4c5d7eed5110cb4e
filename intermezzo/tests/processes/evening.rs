//! The demonstration of the restaurant.

use serde_json::Value;

use crate::harness::{Up, User};

/// An event of a vehicle's action.
fn is_of(told: &Value, agent: &str, event: &str, action: &str) -> bool {
    told["agent"] == agent
        && told["event"] == event
        && (told["action"].as_str()).is_some_and(|done| done.starts_with(action))
}

/// When that happened first.
fn at(evening: &Up, agent: &str, event: &str, action: &str) -> f64 {
    let told = (evening.story.iter()).find(|told| is_of(told, agent, event, action));
    let told = told.unwrap_or_else(|| panic!("no {event} of {action} by {agent}"));
    told["t_s"].as_f64().unwrap()
}

/// What became of a task in the hands of a vehicle, and in the middle of what it was set aside.
fn life(evening: &Up, agent: &str, task: &str) -> (Vec<String>, Value) {
    let of = |told: &&Value| told["agent"] == agent && told["goal"].is_string();
    let accepted = evening.story.iter().filter(of).find(|told| {
        told["event"] == "goal_accepted" && told["tasks"] == Value::from(vec![Value::from(task)])
    });
    let goal = &accepted.unwrap_or_else(|| panic!("{agent} never had {task}"))["goal"];
    let told = || {
        evening
            .story
            .iter()
            .filter(of)
            .filter(|told| told["goal"] == *goal)
    };
    let life = told().filter_map(|told| told["event"].as_str()?.strip_prefix("goal_"));
    let aside = told().find(|told| told["event"] == "goal_suspended");
    let middle = aside.map_or(Value::Null, |told| told["action"].clone());
    (life.map(str::to_owned).collect(), middle)
}

#[tokio::test(flavor = "multi_thread")]
async fn two_guests_at_two_tables_are_served_in_one_trip_though_a_spill_goes_first() {
    let user = User::new().await;
    // Slower than it is shown to people: a busy machine may be two seconds late for the second order.
    let slowly = ["demo", "restaurant", "--json", "--speed", "4"];
    let mut evening = user.story(&slowly).await;
    let status = evening.read_to_the_end().await;
    assert_eq!(status.code(), Some(0), "{:?}", evening.story.last());
    let end = evening.story.last().unwrap();
    assert_eq!(
        (&end["event"], &end["success"]),
        (&"end".into(), &true.into())
    );
    // The second order comes while the first drink is being put on the tray.
    let ordered = at(&evening, "k2", "action_finished", "(ask ben table2)");
    let stowing = "(put-on-tray cola1 ";
    let from = at(&evening, "k3", "action_started", stowing);
    let to = at(&evening, "k3", "action_finished", stowing);
    assert!(
        (from..to).contains(&ordered),
        "{ordered} is not in {from}..{to}"
    );
    // Then a spill, with the arm in motion: all that k3 does is set aside together, and goes on.
    let interrupted = ["accepted", "started", "suspended", "resumed", "succeeded"];
    let (cola, middle) = life(&evening, "k3", "(serve cola ann)");
    assert_eq!(cola, interrupted);
    let middle = middle.as_str().unwrap_or_default();
    assert!(middle.starts_with("(take-from-tray cola1 "), "{middle}");
    assert_eq!(life(&evening, "k3", "(serve juice ben)").0, interrupted);
    let (spill, _) = life(&evening, "k3", "(clean table3)");
    assert_eq!(spill, ["accepted", "started", "succeeded"]);
    // What k3 has done from the second order on: to the kitchen for the drinks once, and from table to
    // table.
    let done = evening.story.iter().filter(|told| {
        told["agent"] == "k3" && told["event"] == "action_finished" && told["failure"].is_null()
    });
    let done: Vec<&str> = done.filter_map(|told| told["action"].as_str()).collect();
    let wanted = [
        "(move entrance kitchen entrance-kitchen)",
        "(grasp cola1 ann kitchen)",
        "(put-on-tray cola1 slot1 kitchen)",
        "(grasp juice1 ben kitchen)",
        "(put-on-tray juice1 slot2 kitchen)",
        "(move kitchen table1 kitchen-table1)",
        "(move table1 table3 table1-table3)",
        "(wipe table3)",
        "(move table3 table1 table1-table3)",
        "(resume-take-from-tray cola1 slot1 table1)",
        "(put-drink cola1 cola ann table1)",
        "(move table1 table2 table1-table2)",
        "(take-from-tray juice1 slot2 table2)",
    ];
    let begin = done.iter().position(|action| *action == wanted[0]);
    let done = &done[begin.unwrap_or_default()..];
    assert_eq!(done.get(..wanted.len()), Some(&wanted[..]), "{done:#?}");
    evening.assert_nobody_is_left().await;
}
