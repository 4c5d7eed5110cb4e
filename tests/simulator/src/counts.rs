//! How often what was done.

use std::ops::AddAssign;

/// What is counted.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
#[expect(missing_docs, reason = "their names say it")]
pub enum Counted {
    Crashes,
    ProcessesKilled,
    LostJournals,
    Freezes,
    Cuts,
    FullDisks,
    SlowDisks,
    RobotFaults,
    BadWeather,
    Messages,
    MessagesLost,
    MessagesTwice,
    MessagesLate,
    MessagesSentAgain,
    Writings,
    GoalsAcknowledged,
}

/// All of it, with names, and whether it was done to the stacks.
const ALL: [(Counted, &str, bool); 16] = [
    (Counted::Crashes, "crashes", false),
    (Counted::ProcessesKilled, "processes killed", true),
    (Counted::LostJournals, "lost journals", true),
    (Counted::Freezes, "freezes", true),
    (Counted::Cuts, "cuts", true),
    (Counted::FullDisks, "full disks", true),
    (Counted::SlowDisks, "slow disks", true),
    (Counted::RobotFaults, "robot faults", true),
    (Counted::BadWeather, "spells of bad network", false),
    (Counted::Messages, "messages", false),
    (Counted::MessagesLost, "messages lost", true),
    (Counted::MessagesTwice, "messages twice", true),
    (Counted::MessagesLate, "messages late", false),
    (Counted::MessagesSentAgain, "messages sent again", false),
    (Counted::Writings, "writings", false),
    (Counted::GoalsAcknowledged, "goals acknowledged", false),
];

/// How often each.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Counts([u64; ALL.len()]);

impl Counts {
    /// Once more.
    pub fn count(&mut self, what: Counted) {
        self.0[what as usize] += 1;
    }

    /// How often.
    pub fn of(&self, what: Counted) -> u64 {
        self.0[what as usize]
    }

    /// How often anything was done to the stacks.
    pub fn faults(&self) -> u64 {
        let faults = ALL.iter().filter(|(_, _, is_fault)| *is_fault);
        faults.map(|(what, ..)| self.of(*what)).sum()
    }

    /// What has happened, by name, and how often.
    pub fn named(&self) -> impl Iterator<Item = (&'static str, u64)> {
        let all = ALL.iter().map(|(what, name, _)| (*name, self.of(*what)));
        all.filter(|(_, times)| *times > 0)
    }
}

impl AddAssign<&Counts> for Counts {
    fn add_assign(&mut self, other: &Counts) {
        for (here, there) in self.0.iter_mut().zip(other.0) {
            *here += there;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_is_counted_under_its_own_name() {
        for (place, (what, name, _)) in ALL.into_iter().enumerate() {
            assert_eq!(what as usize, place);
            let mut counts = Counts::default();
            counts.count(what);
            assert_eq!(counts.named().collect::<Vec<_>>(), [(name, 1)]);
        }
    }
}
