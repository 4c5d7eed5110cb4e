//! Hashes of states and task lists.

/// Spreads a number over all bits (the finalizer of `splitmix64`, by Sebastiano Vigna).
pub fn spread(number: u64) -> u64 {
    let mut z = number.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// One hash of two, in this order.
pub fn join(one: u64, other: u64) -> u64 {
    spread(one.rotate_left(17) ^ other.wrapping_mul(0xff51_afd7_ed55_8ccd))
}

/// Numbers that are well spread already: open addressing, eight bytes each.
///
/// Two different states could have one number; with a hundred million of them the chance is less
/// than one in a thousand, and with a million one in ten million.
#[derive(Debug)]
pub struct Numbers {
    slots: Vec<u64>,
    used: usize,
}

impl Default for Numbers {
    fn default() -> Self {
        Self {
            slots: vec![0; 1 << 10],
            used: 0,
        }
    }
}

impl Numbers {
    /// Puts a number in; `false` if it was there.
    pub fn insert(&mut self, number: u64) -> bool {
        // Zero marks what is empty.
        let number = number.max(1);
        if self.used * 4 >= self.slots.len() * 3 {
            self.grow();
        }
        let place = self.place(number);
        if self.slots[place] == number {
            return false;
        }
        self.slots[place] = number;
        self.used += 1;
        true
    }

    /// Whether the number was put in.
    pub fn contains(&self, number: u64) -> bool {
        self.slots[self.place(number.max(1))] != 0
    }

    /// How much memory it takes.
    pub fn bytes(&self) -> usize {
        self.slots.len() * size_of::<u64>()
    }

    fn place(&self, number: u64) -> usize {
        let mask = self.slots.len() - 1;
        let mut place = number as usize & mask;
        while self.slots[place] != 0 && self.slots[place] != number {
            place = (place + 1) & mask;
        }
        place
    }

    fn grow(&mut self) {
        let larger = vec![0; self.slots.len() * 2];
        let before = std::mem::replace(&mut self.slots, larger);
        for number in before.into_iter().filter(|number| *number != 0) {
            let place = self.place(number);
            self.slots[place] = number;
        }
    }
}
