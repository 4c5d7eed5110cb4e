//! What a process is, as far as the two are different.

use std::convert::Infallible;
use std::fmt::Debug;
use std::panic::{AssertUnwindSafe, catch_unwind};

use agent_core::protocol::Durable;

use crate::arm::Arm;
use crate::boss::{Boss, Bosses, goal, knows};
use crate::letter::Side;
use crate::world::{Motor, Sensor};

/// A machine that is one of the two.
pub trait Role:
    Durable<In: Send + Sync, Out: Clone + Debug + Send + Sync> + Clone + Debug + Send + Sync
{
    /// Which of the two.
    const SIDE: Side;

    /// One that starts in that epoch.
    fn make(bosses: &Bosses, epoch: u64) -> Self;

    /// In words, what it knows and does not write down.
    fn volatile(&self) -> String;

    /// What the world says, as it hears it, if it does.
    fn hears(sensor: Sensor) -> Option<Self::In>;

    /// What it tells the motors.
    fn tells(out: Self::Out) -> Motor;

    /// What is wrong with it.
    fn fault(&self) -> Option<String>;

    /// The goals that it knows of, by number, a bit each.
    fn known(&self, goals: usize) -> u8;

    /// The goals that have ended, as far as it knows.
    fn ended(&self, goals: usize) -> u8;

    /// Whether it has nothing to do and keeps nothing.
    fn is_idle(&self) -> bool;
}

impl Role for Boss {
    const SIDE: Side = Side::Boss;

    fn make(bosses: &Bosses, epoch: u64) -> Self {
        bosses.make(epoch)
    }

    fn volatile(&self) -> String {
        let absent: Vec<String> = self.absent().iter().map(|n| n.to_string()).collect();
        absent.join(" ")
    }

    fn hears(_: Sensor) -> Option<Infallible> {
        None
    }

    fn tells(out: Infallible) -> Motor {
        match out {}
    }

    fn fault(&self) -> Option<String> {
        let checked = catch_unwind(AssertUnwindSafe(|| self.check()));
        let fault = "an invariant of the agent does not hold";
        checked.err().map(|_| fault.to_owned())
    }

    fn known(&self, goals: usize) -> u8 {
        bits(goals, |number| knows(self, &goal(number)))
    }

    fn ended(&self, goals: usize) -> u8 {
        bits(goals, |number| self.ended_goal(&goal(number)).is_some())
    }

    fn is_idle(&self) -> bool {
        self.counts().values().all(|count| *count == 0)
    }
}

impl Role for Arm {
    const SIDE: Side = Side::Arm;

    fn make(_: &Bosses, _: u64) -> Self {
        Self::new()
    }

    fn volatile(&self) -> String {
        format!("{:?} {:?}", self.volatile_parts(), Self::fault(self))
    }

    fn hears(sensor: Sensor) -> Option<Sensor> {
        Some(sensor)
    }

    fn tells(out: Motor) -> Motor {
        out
    }

    fn fault(&self) -> Option<String> {
        self.fault_told().map(str::to_owned)
    }

    fn known(&self, _: usize) -> u8 {
        0
    }

    fn ended(&self, _: usize) -> u8 {
        0
    }

    fn is_idle(&self) -> bool {
        self.is_empty()
    }
}

fn bits(goals: usize, holds: impl Fn(usize) -> bool) -> u8 {
    (0..goals).fold(0, |bits, number| bits | u8::from(holds(number)) << number)
}
