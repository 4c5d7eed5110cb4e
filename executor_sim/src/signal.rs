//! What goes between a robot's controller and its motors and sensors.

use std::collections::BTreeMap;

use agent_core::model::{Action, Symbol, Time};
use serde::{Deserialize, Serialize};

use crate::Place;

/// Which command a sensor speaks of. The controller numbers its commands; a number is used once.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq, Ord, PartialOrd, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Ticket(pub u64);

/// From the controller to the motors. What cannot be done is [`Sensor::Declined`].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum MotorCommand {
    /// Drive to an end of an arc, from wherever on it (or at an end of it) the robot stands.
    Drive {
        /// Number of the command.
        ticket: Ticket,
        /// Along this arc.
        arc: Symbol,
        /// To this end of it.
        to: Symbol,
        /// Share of the top speed to use, up to 1.
        pace: f64,
    },
    /// Stop that drive within the braking distance. Of no effect once it has ended.
    Brake {
        /// Number of the drive.
        ticket: Ticket,
    },
    /// Speak for that long.
    Speak {
        /// Number of the command.
        ticket: Ticket,
        /// How long, in seconds.
        duration_s: f64,
    },
    /// Stop speaking at once. Of no effect once it has ended.
    Hush {
        /// Number of the speech.
        ticket: Ticket,
    },
    /// Open or close a door; it moves at the end of the time.
    SetDoor {
        /// Number of the command.
        ticket: Ticket,
        /// Which door.
        door: Symbol,
        /// Open it, or close it.
        open: bool,
        /// How long that takes, in seconds.
        duration_s: f64,
    },
    /// Do something that is not seen in doors and places, such as handing something over. It is
    /// done at the end of the time, or not at all.
    Deed {
        /// Number of the command.
        ticket: Ticket,
        /// What.
        what: Action,
        /// How long it takes, in seconds.
        duration_s: f64,
    },
    /// Stop everything, whoever commanded it, and say how things stand: [`Sensor::Halted`]. The
    /// first command of a controller that has just started, since it cannot know what goes on.
    Halt {
        /// Number of the command, so that its answer can be told from that to an earlier one.
        ticket: Ticket,
    },
    /// Say where the robot is: [`Sensor::Pose`].
    Look,
}

impl MotorCommand {
    /// Whether nothing moves because of it.
    pub fn is_stop(&self) -> bool {
        match self {
            Self::Brake { .. } | Self::Hush { .. } | Self::Halt { .. } | Self::Look => true,
            Self::Drive { .. } | Self::Speak { .. } | Self::SetDoor { .. } | Self::Deed { .. } => {
                false
            }
        }
    }
}

/// From the sensors to the controller.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Sensor {
    /// A command is being carried out.
    Underway {
        /// Which.
        ticket: Ticket,
        /// How long it will take if nothing is in the way.
        expected: Time,
    },
    /// A command is not carried out, and nothing has changed.
    Declined {
        /// Which.
        ticket: Ticket,
        /// In words.
        reason: String,
    },
    /// The robot stands at the node that it was told to drive to.
    Arrived {
        /// Number of the drive.
        ticket: Ticket,
        /// Where.
        node: Symbol,
        /// How far this drive went, in metres.
        driven_m: f64,
    },
    /// The robot stands after [`MotorCommand::Brake`], not where it was told to drive to.
    Stopped {
        /// Number of the drive.
        ticket: Ticket,
        /// Where.
        place: Place,
        /// How far this drive went, in metres.
        driven_m: f64,
    },
    /// The robot stands before a closed door, of its own accord.
    Obstructed {
        /// Number of the drive.
        ticket: Ticket,
        /// What is in the way.
        door: Symbol,
        /// Where it stands.
        place: Place,
        /// How far this drive went, in metres.
        driven_m: f64,
    },
    /// All has been said.
    SpeechEnded {
        /// Number of the speech.
        ticket: Ticket,
    },
    /// Silent after [`MotorCommand::Hush`].
    Hushed {
        /// Number of the speech.
        ticket: Ticket,
        /// How long it was spoken, in seconds.
        spoken_s: f64,
    },
    /// The robot has opened or closed a door, or found it so.
    DoorSet {
        /// Number of the command.
        ticket: Ticket,
        /// Which door.
        door: Symbol,
        /// How it is now.
        open: bool,
    },
    /// Somebody else has opened or closed a door.
    DoorChanged {
        /// Which.
        door: Symbol,
        /// How it is now.
        open: bool,
    },
    /// A deed is done.
    DeedDone {
        /// Number of the command.
        ticket: Ticket,
    },
    /// Everything stands still after [`MotorCommand::Halt`]; what had not ended then never will.
    /// A speech that was cut off by it was [`Hushed`](Self::Hushed) before.
    Halted {
        /// Number of the halt.
        ticket: Ticket,
        /// Where the robot stands.
        place: Place,
        /// Every door, and whether it is open.
        doors: BTreeMap<Symbol, bool>,
        /// The greatest number of a command that has reached the motors, halts aside.
        heard: Ticket,
        /// The last command that was carried out to its end. `None` if there is no sensor that
        /// could tell.
        done: Option<Ticket>,
    },
    /// Where the robot is: whenever its motion changes, and when asked.
    Pose(Pose),
}

/// A snapshot of the body, for displays.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// When.
    pub at: Time,
    /// On the floor plan, in metres.
    pub position_m: [f64; 2],
    /// From the x axis, counter-clockwise.
    pub heading_rad: f64,
    /// Along the arc; 0 when it stands or turns.
    pub speed_m_s: f64,
    /// The arc that it is on; `None` at a node.
    pub arc: Option<Symbol>,
    /// How far along the arc it is, from 0 at its first end to 1; `None` at a node.
    pub fraction: Option<f64>,
    /// The node that it is at; `None` on an arc.
    pub node: Option<Symbol>,
    /// Whether it is speaking.
    pub speaking: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_motors_and_sensors_say_can_be_read_by_anybody() {
        let sensor = Sensor::Halted {
            ticket: Ticket(8),
            place: Place::at("n1"),
            doors: BTreeMap::from([("d3".into(), true)]),
            heard: Ticket(7),
            done: None,
        };
        let text = serde_json::to_string(&sensor).expect("plain data");
        assert_eq!(
            text,
            r#"{"Halted":{"ticket":8,"place":{"Node":{"node":"n1"}},"doors":{"d3":true},"heard":7,"done":null}}"#
        );
        assert_eq!(sensor, serde_json::from_str(&text).expect("as written"));
        let command = MotorCommand::Brake { ticket: Ticket(7) };
        let text = serde_json::to_string(&command).expect("plain data");
        assert_eq!(text, r#"{"Brake":{"ticket":7}}"#);
    }
}
