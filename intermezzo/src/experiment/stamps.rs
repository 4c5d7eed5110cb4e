//! When what has happened in an interruption.

use std::time::Duration;

use agent_core::model::Time;

/// When what has happened in one interruption, on the world's clock. What has not happened is `None`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Stamps {
    /// The client puts the emergency.
    pub(super) put: Time,
    /// The controller tells its motors to stop.
    pub(super) braking: Option<Time>,
    /// The body begins to brake.
    pub(super) motors: Option<Time>,
    /// The client sees that it brakes.
    pub(super) seen: Option<Time>,
    /// The body stands still.
    pub(super) still: Option<Time>,
    /// The controller begins the first action of the emergency's plan.
    pub(super) first_action: Option<Time>,
    /// The emergency has ended.
    pub(super) ended: Option<Time>,
    /// The controller begins to move for the interrupted goal again.
    pub(super) resumed: Option<Time>,
}

/// From one moment of an interruption to another.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Interval {
    /// What is to be short.
    PutToBraking,
    PutToMotors,
    PutToSeen,
    /// The robot's physics.
    BrakingToStill,
    StillToFirstAction,
    EndToResumed,
}

impl Interval {
    pub(super) const ALL: [Self; 6] = [
        Self::PutToBraking,
        Self::PutToMotors,
        Self::PutToSeen,
        Self::BrakingToStill,
        Self::StillToFirstAction,
        Self::EndToResumed,
    ];

    /// As it stands in the table.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::PutToBraking => "put_to_braking",
            Self::PutToMotors => "put_to_motors",
            Self::PutToSeen => "put_to_seen",
            Self::BrakingToStill => "braking_to_still",
            Self::StillToFirstAction => "still_to_first_action",
            Self::EndToResumed => "end_to_resumed",
        }
    }

    /// How long it took, in microseconds: of everybody's clock, but of the world's for what is the
    /// robot's physics. `None` if it did not come about.
    pub(super) fn of(self, stamps: &Stamps, speed: f64) -> Option<f64> {
        let (from, to) = match self {
            Self::PutToBraking => (Some(stamps.put), stamps.braking),
            Self::PutToMotors => (Some(stamps.put), stamps.motors),
            Self::PutToSeen => (Some(stamps.put), stamps.seen),
            Self::BrakingToStill => (stamps.motors, stamps.still),
            Self::StillToFirstAction => (stamps.still, stamps.first_action),
            Self::EndToResumed => (stamps.ended, stamps.resumed),
        };
        let world_us = (to?.secs() - from?.secs()) * 1e6;
        Some(match self {
            Self::BrakingToStill => world_us,
            _ => world_us / speed,
        })
    }
}

/// What was measured under one condition.
#[derive(Clone, Debug, Default)]
pub(super) struct Measured {
    /// Seconds of the world in one.
    pub(super) speed: f64,
    pub(super) interruptions: Vec<Stamps>,
    /// Bare round trips from client to router to client, between the interruptions.
    pub(super) bare: Vec<Duration>,
    /// The drive had ended when the emergency came to stop it.
    pub(super) too_late: usize,
    /// What the robot did served the emergency too, and went on (decision 8).
    pub(super) kept: usize,
    /// It was broken off before all interruptions were made.
    pub(super) broken_off: bool,
}

impl Measured {
    /// How long an interval took, each time that it came about.
    pub(super) fn of(&self, interval: Interval) -> Vec<f64> {
        let all = self.interruptions.iter();
        all.filter_map(|stamps| interval.of(stamps, self.speed))
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn physics_is_told_in_the_worlds_time_and_all_else_in_everybodys() {
        let at = |s| Some(Time::from_secs(s));
        let stamps = Stamps {
            put: Time::from_secs(10.0),
            braking: at(10.02),
            motors: at(10.04),
            still: at(11.04),
            ..Stamps::default()
        };
        let of = |interval: Interval| interval.of(&stamps, 20.0).map(f64::round);
        assert_eq!(of(Interval::PutToBraking), Some(1000.0));
        assert_eq!(of(Interval::PutToMotors), Some(2000.0));
        assert_eq!(of(Interval::BrakingToStill), Some(1_000_000.0));
        assert_eq!(of(Interval::EndToResumed), None);
    }
}
