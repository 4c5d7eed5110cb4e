//! What may go wrong with a robot: a list, or chance from a seed.

use std::collections::BTreeMap;
use std::fmt;

use agent_core::model::Time;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// What goes wrong with one action, between its `Execute` and its first suspension or its end.
/// What is resumed goes well.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// Told to stop, the robot says yes and begins to brake only after this long.
    LateStop {
        /// How long.
        delay: Time,
    },
    /// Told to stop, it says that it cannot, though the model says that it can.
    RefusedSuspension,
    /// It fails by itself on the way.
    Failure {
        /// After this share of the time that it should take, between 0 and 1.
        fraction: f64,
    },
    /// It is slower than planned.
    Slow {
        /// Share of the usual speed, between 0 and 1.
        pace: f64,
    },
}

/// How often each thing goes wrong, in thousandths of all actions. Their sum is at most 1000;
/// what is above counts for nothing.
#[derive(Clone, Copy, Debug, Default, Eq, PartialEq)]
pub struct FaultRates {
    /// [`Fault::LateStop`]
    pub late_stop_per_mille: u32,
    /// [`Fault::RefusedSuspension`]
    pub refused_suspension_per_mille: u32,
    /// [`Fault::Failure`]
    pub failure_per_mille: u32,
    /// [`Fault::Slow`]
    pub slow_per_mille: u32,
}

/// Decides for every action whether something goes wrong with it.
///
/// The same seed gives the same faults in the same order. `Display` says which seed, so that a
/// failing run can be had again.
#[derive(Clone, Debug, Default)]
pub struct Faults {
    source: Source,
    asked: u64,
}

#[derive(Clone, Debug, Default)]
enum Source {
    #[default]
    None,
    List(BTreeMap<u64, Fault>),
    Random {
        seed: u64,
        rates: FaultRates,
        // Boxed: most robots have none, and carry it along in every copy.
        rng: Box<ChaCha8Rng>,
    },
}

impl Faults {
    /// Nothing goes wrong.
    pub fn none() -> Self {
        Self::default()
    }

    /// These go wrong: number of the action, counted from 1, and what.
    pub fn list(faults: impl IntoIterator<Item = (u64, Fault)>) -> Self {
        Self {
            source: Source::List(faults.into_iter().collect()),
            asked: 0,
        }
    }

    /// Chance decides.
    pub fn random(seed: u64, rates: FaultRates) -> Self {
        let rng = Box::new(ChaCha8Rng::seed_from_u64(seed));
        Self {
            source: Source::Random { seed, rates, rng },
            asked: 0,
        }
    }

    /// How far in its list or its chances it is.
    pub(crate) fn position(&self) -> (u64, u128) {
        match &self.source {
            Source::Random { rng, .. } => (self.asked, rng.get_word_pos()),
            Source::None | Source::List(_) => (self.asked, 0),
        }
    }

    /// Goes on from where one of the same list or seed was.
    pub(crate) fn go_on_from(&mut self, (asked, chance): (u64, u128)) {
        self.asked = asked;
        if let Source::Random { rng, .. } = &mut self.source {
            rng.set_word_pos(chance);
        }
    }

    /// What goes wrong with the next action. To be asked once for each.
    pub fn next_action(&mut self) -> Option<Fault> {
        self.asked = self.asked.saturating_add(1);
        match &mut self.source {
            Source::None => None,
            Source::List(faults) => faults.get(&self.asked).copied(),
            Source::Random { rates, rng, .. } => {
                // Always two draws: what one action gets does not depend on another's rates.
                let lot: u32 = rng.random_range(0..1000);
                let share: f64 = rng.random_range(0.0..1.0);
                rates.fault_at(lot, share)
            }
        }
    }
}

impl FaultRates {
    fn fault_at(&self, lot: u32, share: f64) -> Option<Fault> {
        let kinds = [
            (
                self.late_stop_per_mille,
                Fault::LateStop {
                    delay: Time::from_secs(3.0 * share),
                },
            ),
            (self.refused_suspension_per_mille, Fault::RefusedSuspension),
            (
                self.failure_per_mille,
                Fault::Failure {
                    fraction: 0.1 + 0.8 * share,
                },
            ),
            (
                self.slow_per_mille,
                Fault::Slow {
                    pace: 0.2 + 0.7 * share,
                },
            ),
        ];
        let mut below = 0;
        kinds.into_iter().find_map(|(per_mille, fault)| {
            below += per_mille;
            (lot < below).then_some(fault)
        })
    }
}

impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.source {
            Source::None => f.write_str("no faults"),
            Source::List(faults) => {
                f.write_str("faults by list:")?;
                faults
                    .iter()
                    .try_for_each(|(number, fault)| write!(f, " action {number} {fault:?};"))
            }
            Source::Random { seed, rates, .. } => write!(
                f,
                "faults from seed {seed}: of 1000 actions {} stop late, {} refuse to, {} fail, {} are slow",
                rates.late_stop_per_mille,
                rates.refused_suspension_per_mille,
                rates.failure_per_mille,
                rates.slow_per_mille,
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OFTEN: FaultRates = FaultRates {
        late_stop_per_mille: 100,
        refused_suspension_per_mille: 100,
        failure_per_mille: 100,
        slow_per_mille: 100,
    };

    #[test]
    fn a_seed_gives_the_same_faults_again_and_about_as_many_as_asked_for() {
        let draw = |seed| {
            let mut faults = Faults::random(seed, OFTEN);
            (0..10_000)
                .map(|_| faults.next_action())
                .collect::<Vec<_>>()
        };
        assert_eq!(draw(7), draw(7));
        assert_ne!(draw(7), draw(8));
        let some = draw(7).iter().flatten().count();
        assert!((3_700..4_300).contains(&some), "{some}");
        assert!(Faults::random(7, OFTEN).to_string().contains("seed 7"));
    }

    #[test]
    fn a_list_counts_actions_from_one() {
        let mut faults = Faults::list([(2, Fault::RefusedSuspension)]);
        let drawn = [(); 3].map(|()| faults.next_action());
        assert_eq!(drawn, [None, Some(Fault::RefusedSuspension), None]);
        assert_eq!(Faults::none().next_action(), None);
    }
}
