//! Depth-first search with chance, begun anew whenever it has gone astray for long.

use std::sync::Arc;

use super::DepthFirst;
use crate::compile::Compiled;
use crate::control::{Control, Halt, Outcome};

/// So many dead ends, times the number of Luby's sequence, and it is begun anew.
const PATIENCE: u64 = 500;

/// One search after another, each with other choices first.
///
/// Where a wrong choice was made early, depth-first search tries everything behind it; some other
/// order may have chosen right. Lengths follow the sequence of Luby, Sinclair and Zuckerman
/// (*Optimal speedup of Las Vegas algorithms*, 1993).
#[derive(Debug)]
pub struct Restarts {
    search: DepthFirst,
    seed: u64,
    begun: u64,
}

impl Restarts {
    /// Nothing has begun yet.
    pub fn new(compiled: &Arc<Compiled>, seed: u64) -> Self {
        let mut restarts = Self {
            search: DepthFirst::new(compiled),
            seed,
            begun: 0,
        };
        restarts.restart();
        restarts
    }

    fn restart(&mut self) {
        self.begun += 1;
        let seed = self.seed.wrapping_add(self.begun);
        self.search.restart(seed, PATIENCE * luby(self.begun));
    }

    /// Goes on until there is an answer, or [`Control::is_over`]; then it can be called again.
    pub fn run(&mut self, control: &Control<'_>) -> Outcome {
        loop {
            match self.search.run(control) {
                Outcome::Stopped(Halt::Incomplete | Halt::Memory) => self.restart(),
                outcome => return outcome,
            }
        }
    }
}

/// 1 1 2 1 1 2 4 1 1 2 1 1 2 4 8 …, from the first number on.
fn luby(mut number: u64) -> u64 {
    loop {
        if (number + 1).is_power_of_two() {
            return number.div_ceil(2);
        }
        let length = (number + 1).next_power_of_two() / 2;
        number -= length - 1;
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn lengths_follow_the_sequence() {
        let lengths: Vec<u64> = (1..=15).map(super::luby).collect();
        assert_eq!(lengths, [1, 1, 2, 1, 1, 2, 4, 1, 1, 2, 1, 1, 2, 4, 8]);
    }
}
