//! The museum's own domain and map, word by word.

use std::path::Path;

use agent_core::protocol::{Answer, Input, Instruction, Machine, Reply};
use executor_sim::{Faults, Floor, MoverSpec, Place, SimulatedRobot};
use maps::{Site, read_level};

use crate::rig::{atom, id, secs};

#[test]
fn the_robot_can_do_whatever_the_museum_asks_of_it() {
    let museum = Path::new(env!("CARGO_MANIFEST_DIR")).join("../maps/museum");
    let level = read_level(&museum, "node").expect("the museum's node level");
    let site = Site::read(museum.join("map.geojson")).expect("the museum's map");
    for (action, suspendable) in [
        ("move n1 n6 arc5", true),
        ("leave arc5 n6", true),
        ("return n1 arc5", false),
        ("narrate n1", true),
        ("reply n1", true),
        ("hail guest", false),
        ("announce n1", false),
    ] {
        let mut robot = SimulatedRobot::new(
            &level.domain,
            &level.model,
            Floor::try_from(&site).expect("the museum's floor"),
            MoverSpec::default(),
            Place::at("n1"),
            Faults::none(),
        )
        .expect("a robot that knows the museum's words");
        let mut instruct = |at_s, instruction| {
            let from = "child".into();
            robot.handle(secs(at_s), Input::Instruction { from, instruction })
        };
        let begin = Instruction::Execute {
            id: id(1),
            action: atom(action),
            map: None,
        };
        let accepted = Reply::Instruction(Answer::Accepted);
        assert_eq!(instruct(0.0, begin), Some(accepted), "{action}");
        match instruct(0.0, Instruction::Suspend { id: id(1) }) {
            Some(Reply::Instruction(Answer::Suspending)) => assert!(suspendable, "{action}"),
            // Driving back to where one is takes no time.
            Some(Reply::Instruction(Answer::Refused { .. } | Answer::Finished { .. })) => {
                assert!(!suspendable, "{action}");
            }
            other => unreachable!("{action}: {other:?}"),
        }
    }
}
