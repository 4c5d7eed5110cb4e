//! Numbers that must not be mixed up.

use std::fmt;
use std::ops::Add;

use serde::{Deserialize, Serialize};

/// What a plan or a part of it costs, in millionths of the domain's unit.
///
/// Whole numbers, so that sums do not depend on their order and equal plans compare as equal.
#[derive(
    Clone, Copy, Debug, Default, Eq, PartialEq, Ord, PartialOrd, Hash, Serialize, Deserialize,
)]
#[serde(transparent)]
pub struct Cost(pub u64);

impl Cost {
    /// Nothing.
    pub const ZERO: Self = Self(0);

    /// From the domain's units. What is negative or not a number counts as nothing.
    pub fn from_units(units: f64) -> Self {
        // A cast of a float saturates, and turns what is not a number into zero.
        Self((units * 1e6).round() as u64)
    }

    /// In the domain's units.
    pub fn units(self) -> f64 {
        self.0 as f64 / 1e6
    }
}

impl Add for Cost {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }
}

impl fmt::Display for Cost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.1}", self.units())
    }
}

/// A moment or a span of time, in microseconds of the world's clock.
#[derive(
    Clone, Copy, Debug, Default, Eq, PartialEq, Ord, PartialOrd, Hash, Serialize, Deserialize,
)]
#[serde(transparent)]
pub struct Time(pub u64);

impl Time {
    /// The beginning.
    pub const ZERO: Self = Self(0);

    /// From seconds. What is negative or not a number counts as zero.
    pub fn from_secs(seconds: f64) -> Self {
        Self((seconds * 1e6).round() as u64)
    }

    /// In seconds.
    pub fn secs(self) -> f64 {
        self.0 as f64 / 1e6
    }

    /// How long after `earlier` this is; zero if it is not.
    pub fn since(self, earlier: Self) -> Self {
        Self(self.0.saturating_sub(earlier.0))
    }
}

impl Add for Time {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0.saturating_add(other.0))
    }
}

impl fmt::Display for Time {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.1} s", self.secs())
    }
}
