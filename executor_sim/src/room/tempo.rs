//! How long things really take, measured by what the model says.

use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

use agent_core::model::{Action, Symbol};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Something that is about to be done.
#[derive(Clone, Debug)]
pub struct Pace<'a> {
    /// By whom.
    pub vehicle: &'a Symbol,
    /// What.
    pub action: &'a Action,
    /// How often it was begun before, by anybody.
    pub before: u64,
}

type Choose = dyn Fn(&Pace<'_>) -> f64 + Send + Sync;

/// For everything that is begun: how many seconds it takes for one of the model's.
#[derive(Clone)]
pub struct Tempo {
    choose: Arc<Choose>,
    begun: BTreeMap<Action, u64>,
}

impl Tempo {
    /// What `choose` says; what is not positive counts as 1.
    pub fn new(choose: impl Fn(&Pace<'_>) -> f64 + Send + Sync + 'static) -> Self {
        Self {
            choose: Arc::new(choose),
            begun: BTreeMap::new(),
        }
    }

    /// Everything takes as long as the model says.
    pub fn even() -> Self {
        Self::new(|_| 1.0)
    }

    /// Everything takes up to `share` more or less, as chance has it. It depends on what is done and
    /// how often that was begun before, not on who does it or when: in two ways of serving the same
    /// guests the same things take equally long.
    pub fn varied(seed: u64, share: f64) -> Self {
        let share = share.clamp(0.0, 0.99);
        Self::new(move |pace| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed ^ mixed(pace.action, pace.before));
            if share > 0.0 {
                rng.random_range(1.0 - share..1.0 + share)
            } else {
                1.0
            }
        })
    }

    pub(super) fn of(&mut self, vehicle: &Symbol, action: &Action) -> f64 {
        let before = self.begun.entry(action.clone()).or_insert(0);
        let pace = Pace {
            vehicle,
            action,
            before: *before,
        };
        *before += 1;
        let tempo = (self.choose)(&pace);
        if tempo.is_finite() && tempo > 0.0 {
            tempo
        } else {
            1.0
        }
    }
}

impl Default for Tempo {
    fn default() -> Self {
        Self::even()
    }
}

impl fmt::Debug for Tempo {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Tempo").finish_non_exhaustive()
    }
}

/// Of a name and a number (FNV-1a, by G. Fowler, L. C. Noll and K.-P. Vo).
fn mixed(action: &Action, before: u64) -> u64 {
    let bytes = action.to_string().into_bytes();
    let bytes = bytes.into_iter().chain(before.to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}
