//! When a role that has ended is started again, and when there is no point in it.

use std::time::Duration;

/// Before the first new start.
const FIRST: Duration = Duration::from_millis(100);
/// Never longer than this. Nobody stops what moves faster than its role is there again, so it is as short as
/// it can be: a start takes some hundredths of a second of a core.
const LONGEST: Duration = Duration::from_secs(1);
/// A process that has run for so long ran well: what ends it then is a new trouble.
const WELL: Duration = Duration::from_secs(3);
/// After so many quick ends of a role's own there is no point in another start.
const QUICK_ENDS: u32 = 5;

/// How a process has ended.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum End {
    /// It has ended by itself: with an error that it has told, or because it was asked to.
    Own,
    /// It was killed, or it has crashed.
    Killed,
}

/// What is to be done about it.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(super) enum Verdict {
    /// It is to be started again after this long.
    Again(Duration),
    /// Starting it again would come to the same.
    GiveUp,
}

/// The history of one role, as far as it matters for the next start.
#[derive(Clone, Debug, Default)]
pub(super) struct BackOff {
    /// Whether it has ever been ready.
    has_been_up: bool,
    /// Ends in succession before which it had not run well.
    ends: u32,
    /// Those of them that were its own, in succession.
    own_ends: u32,
}

impl BackOff {
    /// It is ready.
    pub(super) fn up(&mut self) {
        self.has_been_up = true;
    }

    /// Its process has ended after it `ran` for so long.
    ///
    /// A role that has never been ready and says why is believed at once: a file is bad, or its journal
    /// is one that it does not read.
    pub(super) fn ended(&mut self, end: End, ran: Duration) -> Verdict {
        if end == End::Own && !self.has_been_up {
            return Verdict::GiveUp;
        }
        if ran >= WELL {
            self.ends = 0;
            self.own_ends = 0;
        }
        match end {
            End::Own if ran < WELL => self.own_ends += 1,
            End::Own | End::Killed => self.own_ends = 0,
        }
        if self.own_ends >= QUICK_ENDS {
            return Verdict::GiveUp;
        }
        let factor = 2_u32.saturating_pow(self.ends);
        self.ends = self.ends.saturating_add(1);
        Verdict::Again(FIRST.saturating_mul(factor).min(LONGEST))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const QUICK: Duration = Duration::from_millis(40);

    fn ready() -> BackOff {
        let mut back_off = BackOff::default();
        back_off.up();
        back_off
    }

    fn delay(verdict: Verdict) -> Duration {
        match verdict {
            Verdict::Again(delay) => delay,
            Verdict::GiveUp => panic!("it was given up"),
        }
    }

    #[test]
    fn a_role_that_is_killed_again_and_again_is_started_ever_later_but_never_given_up() {
        let mut back_off = ready();
        let delays: Vec<Duration> = (0..100)
            .map(|_| delay(back_off.ended(End::Killed, QUICK)))
            .collect();
        assert_eq!(delays[..4], [100, 200, 400, 800].map(Duration::from_millis));
        assert_eq!(delays[99], LONGEST);
    }

    #[test]
    fn what_has_run_well_is_started_again_soon() {
        let mut back_off = ready();
        for _ in 0..10 {
            back_off.ended(End::Killed, QUICK);
        }
        assert_eq!(delay(back_off.ended(End::Killed, WELL)), FIRST);
        assert_eq!(delay(back_off.ended(End::Own, WELL)), FIRST);
    }

    #[test]
    fn a_role_that_ends_at_once_by_itself_is_given_up_after_some_starts() {
        let mut back_off = ready();
        for _ in 1..QUICK_ENDS {
            delay(back_off.ended(End::Own, QUICK));
        }
        assert_eq!(back_off.ended(End::Own, QUICK), Verdict::GiveUp);
    }

    #[test]
    fn one_that_was_killed_in_between_gets_another_chance() {
        let mut back_off = ready();
        for _ in 0..10 {
            for _ in 1..QUICK_ENDS {
                delay(back_off.ended(End::Own, QUICK));
            }
            delay(back_off.ended(End::Killed, QUICK));
        }
    }

    #[test]
    fn one_that_was_never_ready_and_says_why_is_given_up_at_once() {
        let mut back_off = BackOff::default();
        delay(back_off.ended(End::Killed, QUICK));
        assert_eq!(back_off.ended(End::Own, QUICK), Verdict::GiveUp);
    }
}
