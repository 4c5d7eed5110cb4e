//! What tells two stations apart, for whoever looks at all states that there are.

use std::fmt::Debug;

use super::{Effect, Station};
use crate::protocol::durable::{Durable, Row};

impl<M: Durable, T> Station<M, T>
where
    M: Clone,
    M::Out: Clone + Debug,
    T: Clone + Debug,
{
    /// Whether anything but events for observers waits for the disk.
    pub fn has_to_say(&self) -> bool {
        let mut held = self.held.iter().map(|(_, effect)| effect);
        held.any(|effect| !matches!(effect, Effect::Event { .. }))
    }

    /// What it would write down if nothing were being written, and in words what it remembers besides,
    /// events for observers excepted.
    /// Two stations that have written the same, and of whose machines nothing is volatile, go on alike
    /// if both of these are the same.
    pub fn sameness(&self) -> (Vec<Row>, String) {
        let mut copy = self.clone();
        let mut rows = copy.machine.write_down();
        rows.append(&mut copy.own_rows());
        // Counting what was handled would tell states apart that differ only in how they came about:
        // what counts is what the writing under way includes.
        let included = |state: u64| self.writing.is_some_and(|writing| state <= writing);
        let held: Vec<_> = self
            .held
            .iter()
            .filter(|(_, effect)| !matches!(effect, Effect::Event { .. }))
            .map(|(state, effect)| (included(*state), effect))
            .collect();
        let mailboxes = &self.mailboxes;
        let settled = mailboxes.settled(included);
        let words = format!(
            "{:?} {held:?} {:?} {settled:?} {}",
            self.ahead,
            self.ready,
            self.writing.is_some(),
        );
        (rows, words)
    }
}
