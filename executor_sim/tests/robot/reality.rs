//! The world by itself, with a controller that does as it likes.

use agent_core::model::{FactChange, Time};
use agent_core::protocol::{Answer, Input, Instruction, Machine, Output, Reply};
use executor_sim::{MotorCommand, MoverSpec, Place, Sensor, SetupError, Ticket, World};

use crate::rig::{atom, floor, id, secs};

fn world() -> World {
    World::new(floor(), MoverSpec::default(), Place::at("n1")).expect("a sound world")
}

/// What the sensors say to that, poses aside.
fn sensed(world: &mut World, now: Time, input: Input<MotorCommand>) -> Vec<Sensor> {
    assert_eq!(world.handle(now, input), None);
    let outputs = std::iter::from_fn(|| world.poll_output());
    outputs
        .filter_map(|output| match output {
            Output::Local(Sensor::Pose(_)) => None,
            Output::Local(sensor) => Some(sensor),
            _ => unreachable!("a world has nothing but sensors"),
        })
        .collect()
}

fn drive(ticket: u64, arc: &str, to: &str) -> Input<MotorCommand> {
    Input::Local(MotorCommand::Drive {
        ticket: Ticket(ticket),
        arc: arc.into(),
        to: to.into(),
        pace: 1.0,
    })
}

#[test]
fn a_command_that_cannot_be_carried_out_is_declined_and_disturbs_nothing() {
    let mut world = world();
    sensed(&mut world, Time::ZERO, drive(1, "arc5", "n6"));
    for (ticket, command, why) in [
        (2, drive(2, "arc5", "n1"), "the body is moving"),
        (
            3,
            Input::Local(MotorCommand::SetDoor {
                ticket: Ticket(3),
                door: "d9".into(),
                open: true,
                duration_s: 1.0,
            }),
            "there is no door `d9`",
        ),
    ] {
        let declined = Sensor::Declined {
            ticket: Ticket(ticket),
            reason: why.to_owned(),
        };
        assert_eq!(sensed(&mut world, secs(1.0), command), [declined]);
    }
    let arrived = sensed(&mut world, secs(60.0), Input::Wake);
    assert!(matches!(
        arrived[..],
        [Sensor::Arrived { ticket: Ticket(1), driven_m, .. }] if (driven_m - 6.0).abs() < 1e-9
    ));
    let [Sensor::Declined { reason, .. }] =
        &sensed(&mut world, secs(61.0), drive(4, "arc7", "n4"))[..]
    else {
        unreachable!("n6 is not on arc7");
    };
    assert_eq!(reason, "the robot stands at n6, not on `arc7`");
}

#[test]
fn a_brake_for_another_drive_brakes_nothing() {
    let mut world = world();
    sensed(&mut world, Time::ZERO, drive(1, "arc5", "n6"));
    let brake = |ticket| {
        Input::Local(MotorCommand::Brake {
            ticket: Ticket(ticket),
        })
    };
    assert!(sensed(&mut world, secs(3.0), brake(7)).is_empty());
    assert_eq!(world.wake_at(), Some(secs(7.5)));
    sensed(&mut world, secs(3.0), brake(1));
    assert_eq!(world.wake_at(), Some(secs(4.0)));
}

#[test]
fn a_halt_is_said_to_be_one_at_standstill_wherever_that_is() {
    // Within the braking distance of the node, and far from it.
    for (at_s, place) in [(7.0, Some(Place::at("n6"))), (3.0, None)] {
        let mut world = world();
        sensed(&mut world, Time::ZERO, drive(1, "arc5", "n6"));
        let halt = Input::Local(MotorCommand::Halt { ticket: Ticket(2) });
        assert!(sensed(&mut world, secs(at_s), halt).is_empty(), "it rolls");
        let halted = sensed(&mut world, secs(60.0), Input::Wake);
        let [
            Sensor::Halted {
                ticket: Ticket(2),
                place: at,
                doors,
                ..
            },
        ] = &halted[..]
        else {
            unreachable!("{halted:?}");
        };
        assert!(place.is_none_or(|place| place == *at));
        assert!(doors["d3"]);
    }
}

#[test]
fn the_world_goes_its_way_without_a_controller() {
    let mut world = world();
    sensed(&mut world, Time::ZERO, drive(1, "arc5", "n6"));
    let shut = vec![FactChange::Remove(atom("open d3"))];
    // Late is no excuse: what was due before comes first.
    let sensors = sensed(&mut world, secs(100.0), Input::Observation(shut));
    assert!(matches!(
        sensors[..],
        [
            Sensor::Arrived { .. },
            Sensor::DoorChanged { open: false, .. }
        ]
    ));
}

#[test]
fn nobody_instructs_the_world() {
    let input = Input::Instruction {
        from: "child".into(),
        instruction: Instruction::Clear { id: id(1) },
    };
    let reason = "the world takes no instructions".to_owned();
    let rejected = Reply::Instruction(Answer::Rejected { reason });
    assert_eq!(world().handle(Time::ZERO, input), Some(rejected));
}

#[test]
fn a_world_that_cannot_be_is_refused() {
    let nowhere = World::new(floor(), MoverSpec::default(), Place::at("n99")).err();
    assert_eq!(
        nowhere.map(|error| error.to_string()),
        Some("the floor plan has no such place: at n99".to_owned())
    );
    let lame = MoverSpec {
        max_speed_m_s: 0.0,
        ..MoverSpec::default()
    };
    let refused = World::new(floor(), lame, Place::at("n1")).err();
    assert_eq!(refused, Some(SetupError::Immobile(lame)));
}

#[test]
fn a_world_that_is_about_to_end_brakes_and_then_rests() {
    let mut world = world();
    assert!(world.rests());
    sensed(&mut world, Time::ZERO, drive(1, "arc5", "n6"));
    assert!(!world.rests());
    world.wind_down(secs(4.0));
    let at = world.wake_at().expect("it rolls out");
    assert!(at < secs(10.0), "it stops at {at}");
    sensed(&mut world, at, Input::Wake);
    assert!(world.rests());
    assert!(
        matches!(world.place(at), Place::Arc { .. }),
        "{}",
        world.place(at)
    );
    // What was driven counts, and not as done to its end.
    let done = world
        .done()
        .next_back()
        .expect("a drive that was broken off");
    assert!(!done.to_the_end, "{done}");
}
