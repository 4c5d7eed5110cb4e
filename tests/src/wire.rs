//! How long messages take.

use std::collections::BTreeMap;

use agent_core::model::{Symbol, Time};

/// A wire that delays. Messages of one kind between two machines stay in order, as they do over
/// the real link; nothing else does.
#[derive(Clone, Debug)]
pub struct Wire {
    least: Time,
    spread: Time,
    seed: u64,
    last: BTreeMap<(Symbol, Symbol, &'static str), Time>,
    extra: BTreeMap<&'static str, Time>,
}

impl Wire {
    /// Every message takes a millisecond.
    pub fn steady() -> Self {
        Self::random(0, Time::from_secs(0.001), Time::ZERO)
    }

    /// Every message takes between `least` and `least + spread`, drawn from `seed`.
    pub fn random(seed: u64, least: Time, spread: Time) -> Self {
        Self {
            least,
            spread,
            seed,
            last: BTreeMap::new(),
            extra: BTreeMap::new(),
        }
    }

    /// Messages of one kind (`instruction`, `answer`, `report`, `facts`) take this much longer.
    #[must_use]
    pub fn slow(mut self, kind: &'static str, by: Time) -> Self {
        self.extra.insert(kind, by);
        self
    }

    /// When a message that is sent now arrives.
    pub fn arrival(&mut self, now: Time, from: &Symbol, to: &Symbol, kind: &'static str) -> Time {
        // SplitMix64 (Steele, Lea and Flood 2014).
        self.seed = self.seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.seed;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        let drawn = Time((z ^ (z >> 31)) % (self.spread.0 + 1));
        let extra = self.extra.get(kind).copied().unwrap_or_default();
        let last = self
            .last
            .entry((from.clone(), to.clone(), kind))
            .or_default();
        *last = (*last).max(now + self.least + drawn + extra);
        *last
    }
}
