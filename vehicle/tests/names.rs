//! What one of a team says counts for itself alone.
#![allow(clippy::unwrap_used, missing_docs)]

use agent_core::model::{Atom, Symbol, Time};
use agent_core::planner::{NaivePlanner, Settings};
use agent_core::protocol::{
    ActionId, Answer, Durable, GoalRequest, Input, Instruction, Machine, Output, Reply, Urgency,
};
use agent_core::service::{Bid, Body, Message, Offer, Tasks};
use maps::Restaurant;
use vehicle::{ROOM, TOGETHER, Vehicle};

/// Long enough after the start to have heard of all others.
const NOW: Time = Time(5_000_000);

fn vehicle(name: &str) -> Vehicle<NaivePlanner> {
    let restaurant = Restaurant::of_the_paper();
    let configuration = vehicle::configuration(&restaurant, name, 1).unwrap();
    let equipment = vehicle::equipment(&restaurant, name, 1.0);
    let planner = NaivePlanner::new(Settings::default());
    let mut vehicle = vehicle::vehicle(configuration, equipment, TOGETHER, planner);
    vehicle.handle(Time::ZERO, Input::Wake);
    vehicle
}

fn id(publisher: &str) -> ActionId {
    ActionId {
        agent: publisher.into(),
        epoch: 1,
        number: 1,
    }
}

fn what() -> Atom {
    Atom::new("clean", ["kitchen"])
}

/// Gives it that, lets it think, and takes what it says.
fn tell(
    vehicle: &mut Vehicle<NaivePlanner>,
    input: Input<Message>,
) -> (Option<Reply>, Vec<Output<Message>>) {
    let reply = vehicle.handle(NOW, input);
    while vehicle.wake_at() == Some(Time::ZERO) {
        vehicle.handle(NOW, Input::Wake);
    }
    let outputs = std::iter::from_fn(|| vehicle.poll_output());
    (reply, outputs.collect())
}

/// Has it hear that from another.
fn say(vehicle: &mut Vehicle<NaivePlanner>, by: &str, body: Body) -> Vec<Output<Message>> {
    let (by, at) = (by.into(), NOW);
    tell(vehicle, Input::Local(Message { by, at, body })).1
}

fn goal() -> GoalRequest {
    GoalRequest {
        id: Some("mop".into()),
        tasks: vec![what()],
        urgency: Urgency::Normal,
        priority: 0,
        deadline: None,
    }
}

fn instruct(vehicle: &mut Vehicle<NaivePlanner>, from: &str, instruction: Instruction) -> Answer {
    let from = Symbol::from(from);
    match tell(vehicle, Input::Instruction { from, instruction }) {
        (Some(Reply::Instruction(answer)), _) => answer,
        other => unreachable!("an instruction is answered, not {other:?}"),
    }
}

#[test]
fn what_one_has_offered_no_other_gives_or_takes_back() {
    let mut k3 = vehicle("k3");
    let offer = Offer {
        task: "t".into(),
        id: id("k2"),
        what: what(),
        urgency: Urgency::Normal,
        priority: 0,
        deadline: None,
    };
    let tasks = Tasks {
        offers: vec![offer],
        ..Tasks::default()
    };
    let said = say(&mut k3, "k2", Body::Tasks(tasks));
    let bids = said.iter().filter(|output| {
        matches!(output, Output::Local(Message { body: Body::Bid(bid), .. }) if bid.cost.is_some())
    });
    assert_eq!(bids.count(), 1, "{said:?}");
    let execute = Instruction::Execute {
        id: id("k2"),
        action: what(),
        map: None,
    };
    let clear = Instruction::Clear { id: id("k2") };
    for refused in [execute.clone(), clear] {
        let answer = instruct(&mut k3, "k1", refused);
        assert!(matches!(answer, Answer::Rejected { .. }), "{answer:?}");
    }
    assert_eq!(instruct(&mut k3, "k2", execute), Answer::Accepted);
    assert!(k3.tasks().taken().contains_key(&id("k2")));
    let clear = Instruction::Clear { id: id("k2") };
    instruct(&mut k3, "k1", clear);
    assert!(k3.tasks().taken().contains_key(&id("k2")));
}

#[test]
fn of_its_actions_a_vehicle_believes_the_room_and_of_its_tasks_who_has_them() {
    let mut k3 = vehicle("k3");
    let action = ActionId {
        agent: "k3.e".into(),
        epoch: 1,
        number: 1,
    };
    assert!(k3.believes(&ROOM.into(), &action));
    assert!(!k3.believes(&"k1".into(), &action));
    for by in ["k1", "k2"] {
        let (name, there) = (by.into(), true);
        tell(&mut k3, Input::Neighbour { name, there });
        say(&mut k3, by, Body::Tasks(Tasks::default()));
    }
    let said = say(&mut k3, "user", Body::Goal(goal()));
    let offers = said.iter().find_map(|output| match output {
        Output::Local(Message {
            body: Body::Tasks(tasks),
            ..
        }) => tasks.offers.first(),
        _ => None,
    });
    let id = offers.unwrap().id.clone();
    assert!(!k3.believes(&"k1".into(), &id), "nobody has it yet");
    for (by, cost) in [("k1", Some(Time::ZERO)), ("k2", None)] {
        let bid = Bid {
            id: id.clone(),
            cost,
            lacks: Vec::new(),
        };
        say(&mut k3, by, Body::Bid(bid));
    }
    assert_eq!(k3.tasks().executor_of(&id), Some(&"k1".into()));
    assert!(k3.believes(&"k1".into(), &id));
    for by in ["k2", ROOM] {
        assert!(!k3.believes(&by.into(), &id), "{by}");
    }
}
