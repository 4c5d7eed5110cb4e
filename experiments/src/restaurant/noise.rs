//! What may become of what vehicles say to each other: it is lost, comes late or comes twice.

use agent_core::model::Time;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// How often, of a hundred, and how late.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct NoiseRates {
    /// It does not arrive at all.
    pub lost: u32,
    /// It arrives later.
    pub late: u32,
    /// It arrives once more.
    pub twice: u32,
    /// No later than that.
    pub most_late: Time,
}

/// Chance on the way between vehicles.
#[derive(Clone, Debug)]
pub struct Noise {
    rates: NoiseRates,
    random: ChaCha8Rng,
}

impl Noise {
    /// Chance from a seed.
    pub fn new(seed: u64, rates: NoiseRates) -> Self {
        Self {
            rates,
            random: ChaCha8Rng::seed_from_u64(seed),
        }
    }

    /// How much later the next message arrives, each time that it does.
    pub(super) fn arrivals(&mut self) -> Vec<Time> {
        let rates = self.rates;
        let mut arrivals = Vec::new();
        if !self.happens(rates.lost) {
            arrivals.push(self.delay());
        }
        if self.happens(rates.twice) {
            arrivals.push(self.delay());
        }
        arrivals
    }

    fn happens(&mut self, of_a_hundred: u32) -> bool {
        self.random.random_range(..100_u32) < of_a_hundred
    }

    fn delay(&mut self) -> Time {
        if self.happens(self.rates.late) {
            Time(self.random.random_range(..=self.rates.most_late.0))
        } else {
            Time::ZERO
        }
    }
}
