//! What can be seen of a robot that moves.

use agent_core::model::Time;
use serde::{Deserialize, Serialize};

use super::World;
use crate::{Place, Pose, Sensor};

/// What a robot does, as far as it can be seen from outside.
#[derive(Clone, Copy, Debug, Eq, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Motion {
    /// Nothing moves.
    Still,
    /// It stands and speaks.
    Speaking,
    /// It drives, or turns in order to.
    Driving,
    /// It is coming to rest before the end of its way.
    Braking,
}

impl World {
    /// A snapshot for displays; any time up to the next event will do.
    pub fn pose(&self, now: Time) -> Pose {
        let seen = self.body.seen(&self.floor, now);
        let position = seen.isometry.translation.vector;
        let (node, arc, fraction) = match seen.place {
            Place::Node { node } => (Some(node), None, None),
            Place::Arc { arc, offset_m, .. } => {
                let fraction = self
                    .floor
                    .passage(&arc)
                    .map(|passage| offset_m / passage.length_m);
                (None, Some(arc), fraction)
            }
        };
        Pose {
            at: now,
            position_m: [position.x, position.y],
            heading_rad: seen.isometry.rotation.angle(),
            speed_m_s: seen.speed_m_s,
            arc,
            fraction,
            node,
            speaking: self.speech.is_some(),
        }
    }

    /// What the robot does, and since when.
    pub fn motion(&self) -> (Motion, Time) {
        let motion = match (self.body.is_braking(), self.speech.is_some()) {
            (true, _) => Motion::Braking,
            (false, _) if !self.body.stands() => Motion::Driving,
            (false, true) => Motion::Speaking,
            (false, false) => Motion::Still,
        };
        (motion, self.changed_at)
    }

    pub(super) fn tell_pose(&mut self, now: Time) {
        self.changed_at = now;
        let pose = self.pose(now);
        self.outputs.push_back(Sensor::Pose(pose));
    }
}
