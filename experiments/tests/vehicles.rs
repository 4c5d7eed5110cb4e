//! The vehicles of the restaurant together, in virtual time: tasks that come up are given to whoever can
//! do them, and facts get about.

use std::collections::BTreeMap;

use agent_core::model::{Atom, Fact, FactChange, Symbol, Task, Time};
use agent_core::planner::{GraphPlanner, Settings};
use agent_core::protocol::{Durable, Event, GoalRequest, Happening, Input, Reply, Rows, Urgency};
use agent_core::service::{Body, Message};
use executor_sim::{Room, RoomDoing, Spot};
use experiments::Team;
use maps::Restaurant;
use vehicle::{TOGETHER, Vehicle, configuration, equipment};

type Carrier = Vehicle<GraphPlanner>;
type Restaurateurs = Team<Room, Carrier>;

/// The restaurant of the paper, with a second carrier.
fn restaurant() -> Restaurant {
    let paper = Restaurant::of_the_paper();
    let mut room = paper.room().clone();
    let k3 = room.vehicles[&Symbol::from("k3")].clone();
    room.vehicles.insert("k4".into(), k3);
    paper.with_room(room).expect("there can be two carriers")
}

fn make(restaurant: &Restaurant, name: &str, epoch: u64) -> Carrier {
    let configuration = configuration(restaurant, name, epoch).expect("it is in the room");
    let equipment = equipment(restaurant, name, 1.0);
    let planner = GraphPlanner::new(Settings::default());
    vehicle::vehicle(configuration, equipment, TOGETHER, planner)
}

fn team(restaurant: &Restaurant) -> Restaurateurs {
    let room = Room::new(restaurant).expect("the restaurant is in order");
    let vehicles = restaurant.room().vehicles.keys();
    let vehicles: BTreeMap<Symbol, Carrier> = vehicles
        .map(|name| (name.clone(), make(restaurant, name.as_str(), 1)))
        .collect();
    Team::new(room, vehicles)
}

fn at(secs: f64) -> Time {
    Time::from_secs(secs)
}

fn fact(name: &str, args: &[&str]) -> Fact {
    Atom::new(name, args.iter().copied())
}

fn add(name: &str, args: &[&str]) -> FactChange {
    FactChange::Add(fact(name, args))
}

/// A user's goal for whoever can do it.
fn ask(team: &mut Restaurateurs, id: &str, task: Task) {
    let request = GoalRequest {
        id: Some(id.into()),
        tasks: vec![task],
        urgency: Urgency::Normal,
        priority: 0,
        deadline: None,
    };
    let message = Message {
        by: "user".into(),
        at: team.now(),
        body: Body::Goal(request),
    };
    let reply = team.tell("k1", Input::Local(message));
    assert_eq!(reply, Some(Reply::Goal(Ok(id.into()))));
}

fn told(events: &[(Symbol, Event)]) -> String {
    let lines = events.iter().map(|(who, event)| {
        let goal = event.goal.as_ref().map_or("", Symbol::as_str);
        format!("{:>7} {who} {goal} {:?}", event.at, event.what)
    });
    lines.collect::<Vec<_>>().join("\n")
}

/// What was handed over to whom in reality.
fn served(team: &Restaurateurs) -> Vec<(Symbol, Symbol)> {
    let done = team.room().done().filter_map(|deed| match &deed.what {
        RoomDoing::Served { guest, .. } => Some((deed.vehicle.clone(), guest.clone())),
        _ => None,
    });
    done.collect()
}

/// Runs until a goal has ended so, and says how long that took.
fn run_until(
    team: &mut Restaurateurs,
    events: &mut Vec<(Symbol, Event)>,
    until: Time,
    found: impl Fn(&(Symbol, Event)) -> bool,
) -> Time {
    loop {
        let new = team.take_events();
        let hit = new.iter().any(&found);
        events.extend(new);
        if hit {
            return team.now();
        }
        assert!(team.step(until), "it did not come about:\n{}", told(events));
    }
}

#[test]
fn a_guest_is_greeted_asked_and_served_by_three_vehicles_that_nobody_has_told_to() {
    let restaurant = Restaurant::of_the_paper();
    let mut team = team(&restaurant);
    team.run_until(at(3.0));
    team.change(vec![add("arrived", &["ben"])]);
    team.run_until(at(30.0));
    team.change(vec![add("seated", &["ben", "table2"])]);
    let mut events = Vec::new();
    run_until(
        &mut team,
        &mut events,
        at(900.0),
        |(_, event)| matches!(&event.what, Happening::TaskEnded { what, by: Some(_), .. } if what.name == "serve"),
    );
    assert_eq!(
        served(&team),
        [("k3".into(), "ben".into())],
        "{}",
        told(&events)
    );
    let ended: Vec<(String, String)> = events
        .iter()
        .filter_map(|(_, event)| match &event.what {
            Happening::TaskEnded {
                what, by: Some(by), ..
            } => Some((what.to_string(), by.to_string())),
            _ => None,
        })
        .collect();
    let by = |task: &str| {
        let found = ended.iter().find(|(what, _)| what == task);
        found.map(|(_, by)| by.as_str())
    };
    assert_eq!(by("(greet ben)"), Some("k1"), "{}", told(&events));
    assert_eq!(by("(take-order ben)"), Some("k2"), "{}", told(&events));
    assert_eq!(by("(serve juice ben)"), Some("k3"), "{}", told(&events));
}

#[test]
fn a_goal_for_the_team_is_done_by_one_who_can_and_what_is_unknown_is_found_out_first() {
    let restaurant = Restaurant::of_the_paper();
    let mut team = team(&restaurant);
    team.run_until(at(3.0));
    // Nobody has seen her sit down: k2 goes and looks.
    team.change(vec![add("seated", &["eva", "table3"])]);
    ask(&mut team, "order-1", Atom::new("serve", ["water", "eva"]));
    let mut events = Vec::new();
    run_until(&mut team, &mut events, at(900.0), |(_, event)| {
        event.goal == Some("order-1".into()) && event.what == Happening::GoalSucceeded
    });
    assert_eq!(
        served(&team),
        [("k3".into(), "eva".into())],
        "{}",
        told(&events)
    );
    let looked = events.iter().any(|(who, event)| {
        who == "k2" && matches!(&event.what, Happening::ActionFinished { action, .. } if action.name == "look")
    });
    assert!(looked, "{}", told(&events));
}

/// The carrier cannot see: what it knows of the tables it has from the others.
fn with_a_blind_carrier() -> Restaurant {
    let paper = Restaurant::of_the_paper();
    let mut room = paper.room().clone();
    let carrier = room.vehicles.get_mut("k3").expect("it is there");
    carrier.parts.retain(|part| part != "eyes");
    let waiter = room.vehicles.get_mut("k2").expect("it is there");
    waiter.start = "table1".into();
    paper.with_room(room).expect("a carrier needs no eyes")
}

#[test]
fn what_one_vehicle_sees_break_stops_another_that_cannot_see_it() {
    let mut team = team(&with_a_blind_carrier());
    team.run_until(at(3.0));
    team.change(vec![add("seated", &["ann", "table1"])]);
    ask(&mut team, "order-1", Atom::new("serve", ["cola", "ann"]));
    let mut events = Vec::new();
    run_until(&mut team, &mut events, at(600.0), |(who, event)| {
        who == "k3"
            && matches!(&event.what, Happening::ActionStarted { action, .. } if action.name == "move" && action.args[1] == "table1")
    });
    let later = team.now() + at(5.0);
    team.run_until(later);
    let blocked = team.now();
    team.change(vec![add("blocked", &["table1"])]);
    let stopped = run_until(&mut team, &mut events, at(600.0), |(who, event)| {
        who == "k3"
            && matches!(&event.what, Happening::GoalBlocked { blocked_by } if blocked_by.contains(&fact("blocked", &["table1"])))
    });
    assert!(stopped.since(blocked) < at(1.0), "{}", told(&events));
    let seen_by = |who: &str, change: &FactChange| {
        events.iter().any(|(to, event)| {
            to == "k3" && matches!(&event.what, Happening::FactsTold { by, changes } if by == who && changes.contains(change))
        })
    };
    assert!(seen_by("k2", &add("blocked", &["table1"])));
    // What it was told it is told again: the table is free, and she gets her drink.
    team.change(vec![FactChange::Remove(fact("blocked", &["table1"]))]);
    run_until(&mut team, &mut events, at(900.0), |(_, event)| {
        event.goal == Some("order-1".into()) && event.what == Happening::GoalSucceeded
    });
    assert_eq!(served(&team), [("k3".into(), "ann".into())]);
}

/// Whether that vehicle has begun, or ended, an action of that name.
fn does(event: &(Symbol, Event), vehicle: &str, name: &str, ends: bool) -> bool {
    event.0 == vehicle
        && match &event.1.what {
            Happening::ActionStarted { action, .. } => !ends && action.name == name,
            Happening::ActionFinished { action, .. } => ends && action.name == name,
            _ => false,
        }
}

fn stands(team: &Restaurateurs, bottle: &str, place: &str) -> bool {
    let node = place.into();
    let bottle = team.room().things().bottle(bottle);
    bottle.map(|it| &it.spot) == Some(&Spot::Proper { node })
}

#[test]
fn an_empty_that_was_set_down_in_haste_is_cleared_all_the_same() {
    let restaurant = Restaurant::of_the_paper();
    let mut team = team(&restaurant);
    team.change(vec![
        add("stands", &["cola1", "table3"]),
        add("used", &["cola1"]),
    ]);
    team.run_until(at(3.0));
    team.tell("k3", Input::Observation(vec![add("spill", &["table1"])]));
    ask(&mut team, "clear", Atom::new("clear", ["table3"]));
    let mut events = Vec::new();
    // Nobody knows of the bottle until k3 comes by.
    let come_by = Atom::new("clean", ["table3"]);
    ask(&mut team, "come-by", come_by);
    let begun = |event: &(Symbol, Event)| does(event, "k3", "collect", false);
    run_until(&mut team, &mut events, at(600.0), begun);
    let later = team.now() + at(10.0);
    team.run_until(later);
    let request = GoalRequest {
        id: Some("spill".into()),
        tasks: vec![Atom::new("clean", ["table1"])],
        urgency: Urgency::Emergency,
        priority: 0,
        deadline: None,
    };
    team.tell("k3", Input::Goal(request));
    let later = team.now() + at(600.0);
    team.run_until(later);
    events.extend(team.take_events());
    assert!(stands(&team, "cola1", "kitchen"), "{}", told(&events));
}

#[test]
fn what_is_aboard_and_nobody_waits_for_goes_back_to_the_counter() {
    let restaurant = Restaurant::of_the_paper();
    // In the hand, on the tray, half grasped.
    for (action, ends) in [("grasp", true), ("put-on-tray", true), ("grasp", false)] {
        let mut team = team(&restaurant);
        team.run_until(at(3.0));
        team.change(vec![add("seated", &["eva", "table3"])]);
        ask(&mut team, "order", Atom::new("serve", ["water", "eva"]));
        let mut events = Vec::new();
        let done = |event: &(Symbol, Event)| does(event, "k3", action, ends);
        run_until(&mut team, &mut events, at(600.0), done);
        let later = team.now() + at(1.0);
        team.run_until(later);
        let emergency = GoalRequest {
            id: Some("spill".into()),
            tasks: vec![Atom::new("clean", ["table1"])],
            urgency: Urgency::Emergency,
            priority: 0,
            deadline: None,
        };
        team.tell("k3", Input::Goal(emergency));
        let later = team.now() + at(20.0);
        team.run_until(later);
        // Nobody at the table sees it; k1 does, at the door.
        team.change(vec![add("gone", &["eva"])]);
        let later = team.now() + at(600.0);
        team.run_until(later);
        events.extend(team.take_events());
        let bottles = ["water1", "water2"];
        let put_away = bottles.iter().all(|it| stands(&team, it, "kitchen"));
        assert!(put_away, "{action}: {}", told(&events));
    }
}

#[test]
fn when_the_one_who_carries_dies_its_task_goes_to_another_and_the_drink_it_held_is_told() {
    let restaurant = restaurant();
    let mut team = team(&restaurant);
    team.run_until(at(3.0));
    for (guest, table) in [("ann", "table1"), ("ben", "table2")] {
        team.change(vec![add("seated", &[guest, table])]);
    }
    ask(&mut team, "order-1", Atom::new("serve", ["cola", "ann"]));
    let mut events = Vec::new();
    // It has a bottle in its hand.
    run_until(
        &mut team,
        &mut events,
        at(600.0),
        |(_, event)| matches!(&event.what, Happening::ActionFinished { action, .. } if action.name == "grasp"),
    );
    let carrier = events
        .iter()
        .find_map(|(who, event)| match &event.what {
            Happening::ActionFinished { action, .. } if action.name == "grasp" && who != "room" => {
                Some(who.clone())
            }
            _ => None,
        })
        .expect("somebody has it");
    let later = team.now() + at(1.0);
    team.run_until(later);
    team.kill(carrier.as_str());
    run_until(&mut team, &mut events, at(1200.0), |(_, event)| {
        event.goal == Some("order-1".into()) && event.what == Happening::GoalSucceeded
    });
    let lost = events.iter().find_map(|(_, event)| match &event.what {
        Happening::VehicleLost { name, held, tasks } => Some((name, held, tasks)),
        _ => None,
    });
    let (name, held, tasks) = lost.unwrap_or_else(|| panic!("{}", told(&events)));
    assert_eq!(*name, carrier);
    assert!(
        held.iter()
            .any(|fact| fact.name == "with" && fact.args[1] == carrier),
        "{held:?}"
    );
    assert!(
        tasks
            .iter()
            .any(|task| task.to_string() == "(serve cola ann)"),
        "{tasks:?}"
    );
    let served = served(&team);
    let ann: Vec<&Symbol> = served
        .iter()
        .filter(|(_, guest)| guest == "ann")
        .map(|(who, _)| who)
        .collect();
    assert_eq!(ann.len(), 1, "{}", told(&events));
    assert_ne!(*ann[0], carrier);
    // The one that died still has what it had.
    let bottles = ["cola1", "cola2", "juice1", "juice2"];
    let spots = bottles.map(|bottle| {
        let bottle = team.room().things().bottle(bottle);
        bottle.map(|bottle| bottle.spot.clone())
    });
    assert!(
        spots.iter().any(|spot| matches!(spot, Some(Spot::Hand { vehicle } | Spot::Slot { vehicle, .. }) if *vehicle == carrier)),
        "{spots:?}"
    );
}

#[test]
fn a_vehicle_that_is_started_again_gives_back_what_it_had_and_everything_is_done_once() {
    let restaurant = restaurant();
    for kill_after_s in [5.0, 20.0, 40.0, 70.0, 100.0] {
        let mut team = team(&restaurant);
        team.run_until(at(3.0));
        team.change(vec![add("seated", &["ann", "table1"])]);
        ask(&mut team, "order-1", Atom::new("serve", ["cola", "ann"]));
        let mut events = Vec::new();
        run_until(
            &mut team,
            &mut events,
            at(600.0),
            |(_, event)| matches!(&event.what, Happening::TaskGiven { what, .. } if what.name == "serve"),
        );
        let carrier = events
            .iter()
            .rev()
            .find_map(|(_, event)| match &event.what {
                Happening::TaskGiven { what, to } if what.name == "serve" => Some(to.clone()),
                _ => None,
            })
            .expect("somebody has it");
        let later = team.now() + at(kill_after_s);
        team.run_until(later);
        let mut dead = team.kill(carrier.as_str()).expect("it lives");
        let rows: Rows = dead
            .write_down()
            .into_iter()
            .filter_map(|row| Some((row.key, row.value?)))
            .collect();
        let later = team.now() + at(0.5);
        team.run_until(later);
        let mut again = make(&restaurant, carrier.as_str(), 2);
        again.recall(&rows).expect("it was written so");
        team.restart(carrier.as_str(), again, true);
        run_until(&mut team, &mut events, at(1500.0), |(_, event)| {
            event.goal == Some("order-1".into()) && event.what == Happening::GoalSucceeded
        });
        assert_eq!(served(&team).len(), 1, "{kill_after_s}: {}", told(&events));
        assert_eq!(team.room().check(), Ok(()));
    }
}

#[test]
fn a_task_that_cannot_be_gone_on_with_is_given_back_and_done_by_one_who_can() {
    let restaurant = restaurant();
    let mut team = team(&restaurant);
    team.run_until(at(3.0));
    team.change(vec![add("seated", &["ann", "table1"])]);
    ask(&mut team, "order", Atom::new("serve", ["cola", "ann"]));
    let mut events = Vec::new();
    let stowed = |event: &(Symbol, Event)| {
        does(event, "k3", "put-on-tray", true) || does(event, "k4", "put-on-tray", true)
    };
    run_until(&mut team, &mut events, at(600.0), stowed);
    let has_it = |team: &Restaurateurs, vehicle: &str| {
        let mut bottles = team.room().things().bottles();
        bottles.any(
            |(_, it)| matches!(&it.spot, Spot::Slot { vehicle: whose, .. } if *whose == vehicle),
        )
    };
    let (first, other) = match has_it(&team, "k3") {
        true => ("k3", "k4"),
        false => ("k4", "k3"),
    };
    let mut dead = team.kill(first).expect("it lives");
    let rows = dead.write_down().into_iter();
    let rows: Rows = rows.filter_map(|row| Some((row.key, row.value?))).collect();
    // The other one gets the task, and somebody takes the last bottle before its eyes.
    let given = |(_, event): &(Symbol, Event)| matches!(&event.what, Happening::TaskGiven { to, .. } if to == other);
    run_until(&mut team, &mut events, at(900.0), given);
    for bottle in ["cola1", "cola2"] {
        let gone = FactChange::Remove(fact("stands", &[bottle, "kitchen"]));
        team.change(vec![gone]);
    }
    let later = team.now() + at(30.0);
    team.run_until(later);
    let mut again = make(&restaurant, first, 2);
    again.recall(&rows).expect("it was written so");
    team.restart(first, again, true);
    run_until(&mut team, &mut events, at(1500.0), |(_, event)| {
        event.goal == Some("order".into()) && event.what == Happening::GoalSucceeded
    });
    assert_eq!(
        served(&team),
        [(first.into(), "ann".into())],
        "{}",
        told(&events)
    );
}

#[test]
fn the_last_bottle_brought_for_a_guest_who_has_gone_is_brought_to_the_next() {
    let restaurant = Restaurant::of_the_paper();
    let mut team = team(&restaurant);
    team.run_until(at(3.0));
    team.change(vec![add("wants", &["ben", "cola"])]);
    for (guest, table) in [("ann", "table1"), ("ben", "table2")] {
        team.change(vec![add("seated", &[guest, table])]);
        ask(&mut team, guest, Atom::new("serve", ["cola", guest]));
    }
    let mut events = Vec::new();
    let stowed = |event: &(Symbol, Event)| does(event, "k3", "put-on-tray", true);
    run_until(&mut team, &mut events, at(600.0), stowed);
    let grasped = events.iter().find_map(|(_, event)| match &event.what {
        Happening::ActionFinished { action, .. } if action.name == "grasp" => Some(&action.args),
        _ => None,
    });
    let grasped = grasped.expect("it is on the tray").clone();
    let (other, next) = match (grasped[0].as_str(), grasped[1].as_str()) {
        ("cola1", "ann") => ("cola2", "ben"),
        ("cola1", _) => ("cola2", "ann"),
        (_, "ann") => ("cola1", "ben"),
        _ => ("cola1", "ann"),
    };
    // Both are on its mind from now on: to take it back, and to bring it to the other guest.
    let hand = FactChange::Remove(fact("holding", &[other]));
    let place = FactChange::Remove(fact("stands", &[other, "kitchen"]));
    let edge = FactChange::Remove(fact("edge", &[other, "kitchen"]));
    team.change(vec![hand, place, edge, add("gone", &[grasped[1].as_str()])]);
    run_until(&mut team, &mut events, at(900.0), |(_, event)| {
        event.goal == Some(next.into()) && event.what == Happening::GoalSucceeded
    });
    assert_eq!(served(&team), [("k3".into(), next.into())]);
}
