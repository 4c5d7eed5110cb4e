//! Chance, from a seed.

/// SplitMix64 (Steele, Lea and Flood 2014).
#[derive(Clone, Debug)]
pub struct Dice(pub u64);

impl Dice {
    /// The next number.
    pub fn draw(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mix(self.0)
    }

    /// From 0 to below `sides`; 0 if there are none.
    pub fn roll(&mut self, sides: u64) -> u64 {
        self.draw() % sides.max(1)
    }

    /// Whether something happens that happens that often in a thousand times.
    pub fn per_mille(&mut self, often: u64) -> bool {
        self.roll(1000) < often
    }

    /// One of them.
    ///
    /// # Panics
    /// If there are none.
    pub fn one_of<'a, T>(&mut self, things: &'a [T]) -> &'a T {
        &things[self.roll(things.len() as u64) as usize]
    }
}

fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// A number that depends on all of these and on nothing else: so what chance does to one message
/// does not depend on how many others there were.
pub fn drawn(seed: u64, what: [u64; 3]) -> u64 {
    what.iter().fold(mix(seed), |z, part| {
        mix(z ^ part.wrapping_mul(0x9e37_79b9_7f4a_7c15))
    })
}
