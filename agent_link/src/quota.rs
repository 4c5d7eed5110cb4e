//! How much users may ask for: pure counting, with the time as an argument.
//!
//! An emergency stops what a robot does, so it may not be asked for without end. Each sender has a
//! rate, and all of them together have one. A sender is who the key says
//! (`goal/emergency/<sender>`): with access control that is somebody whom the router knows, as it
//! lets a user ask under its own name only. Without it, a name is only what somebody says. Whoever
//! gives no name shares one rate with all others that give none.

use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

use agent_core::protocol::GoalId;

/// So many senders are told apart. Further ones share a rate, as those without a name do.
const MOST_SENDERS: usize = 256;

/// So many goals are remembered: who asks again for one of them, because an answer was lost, has
/// paid for it.
const MOST_REMEMBERED: usize = 1024;

/// Who has not asked for a while may ask for what falls due in so many seconds at once.
const BURST: Duration = Duration::from_secs(5);

/// How many in a second in the long run, and how many at once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    /// What each takes from the time that there is.
    interval: Duration,
    /// How much of the time to come may be taken beforehand.
    ahead: Duration,
}

impl Rate {
    /// So many in a second, above zero, and what falls due in five seconds at once, but at least
    /// one. `None` for what is no such number.
    pub fn per_second(number: f64) -> Option<Self> {
        let interval = Duration::try_from_secs_f64(1.0 / number).ok()?;
        // Zero: a number without end.
        (!interval.is_zero()).then(|| Self {
            interval,
            ahead: interval.max(BURST),
        })
    }

    /// The same, with what falls due in that time at once.
    pub(crate) fn at_once(self, burst: Duration) -> Self {
        Self {
            ahead: self.interval.max(burst),
            ..self
        }
    }

    /// How many in a second.
    pub fn number(self) -> f64 {
        1.0 / self.interval.as_secs_f64()
    }
}

/// What was taken of a rate (the generic cell rate algorithm).
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Meter {
    /// When all that was admitted would be due, had it come one by one.
    due: Duration,
}

impl Meter {
    /// How long one more has to wait at time `now`. Zero: it may go.
    pub(crate) fn wait(&self, now: Duration, rate: Rate) -> Duration {
        let one_more = self.due.max(now) + rate.interval;
        one_more.saturating_sub(now + rate.ahead)
    }

    /// One goes at time `now`.
    pub(crate) fn take(&mut self, now: Duration, rate: Rate) {
        self.due = self.due.max(now) + rate.interval;
    }
}

/// Limits on what users ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Emergencies of one sender.
    pub of_sender: Rate,
    /// Emergencies of all senders.
    pub in_total: Rate,
}

impl Default for Limits {
    /// More than people can mean, and few enough for a robot to look at.
    fn default() -> Self {
        let per_second = |seconds| Rate {
            interval: Duration::from_secs(1) / seconds,
            ahead: BURST,
        };
        Self {
            of_sender: per_second(5),
            in_total: per_second(20),
        }
    }
}

/// Too many emergencies.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "too many emergencies: no more than {per_minute:.0} a minute are taken {from}; ask again in {wait_s:.1} s",
    wait_s = .wait.as_secs_f64()
)]
pub(crate) struct TooMany {
    /// The limit, in the long run.
    per_minute: f64,
    /// Whose limit that is.
    from: String,
    /// When it will be taken, if nobody else asks meanwhile.
    wait: Duration,
}

/// Who has asked for how much.
#[derive(Clone, Debug)]
pub(crate) struct Quota {
    limits: Limits,
    total: Meter,
    /// By the sender's name.
    named: BTreeMap<String, Meter>,
    /// Of those without a name.
    unnamed: Meter,
    /// The latest that were admitted and have an id.
    admitted: VecDeque<GoalId>,
}

impl Quota {
    pub(crate) fn new(limits: Limits) -> Self {
        Self {
            limits,
            total: Meter::default(),
            named: BTreeMap::new(),
            unnamed: Meter::default(),
            admitted: VecDeque::new(),
        }
    }

    /// Whether an emergency that a sender asks for at time `now` may reach the agent.
    pub(crate) fn admit(
        &mut self,
        now: Duration,
        sender: Option<&str>,
        goal: Option<&GoalId>,
    ) -> Result<(), TooMany> {
        if goal.is_some_and(|goal| self.admitted.contains(goal)) {
            return Ok(());
        }
        let Limits {
            of_sender,
            in_total,
        } = self.limits;
        let too_many = |rate: Rate, from: String, wait| TooMany {
            per_minute: rate.number() * 60.0,
            from,
            wait,
        };
        let sender = sender.filter(|sender| self.room_for(now, sender));
        // A sender's own limit comes first: it is the one that the sender can keep.
        let meter = match sender {
            Some(sender) => self.named.get(sender).copied().unwrap_or_default(),
            None => self.unnamed,
        };
        let wait = meter.wait(now, of_sender);
        if !wait.is_zero() {
            let from = match sender {
                Some(sender) => format!("from `{sender}`"),
                None => "from those who give no name".to_owned(),
            };
            return Err(too_many(of_sender, from, wait));
        }
        let wait = self.total.wait(now, in_total);
        if !wait.is_zero() {
            return Err(too_many(in_total, "in total".to_owned(), wait));
        }
        self.total.take(now, in_total);
        match sender {
            Some(sender) => self.named.entry(sender.to_owned()).or_default(),
            None => &mut self.unnamed,
        }
        .take(now, of_sender);
        if let Some(goal) = goal {
            if self.admitted.len() == MOST_REMEMBERED {
                self.admitted.pop_front();
            }
            self.admitted.push_back(goal.clone());
        }
        Ok(())
    }

    /// Whether a sender is, or can be, counted by itself. Who owes nothing any more is forgotten
    /// if there are too many.
    fn room_for(&mut self, now: Duration, sender: &str) -> bool {
        if self.named.contains_key(sender) || self.named.len() < MOST_SENDERS {
            return true;
        }
        self.named.retain(|_, meter| meter.due > now);
        self.named.len() < MOST_SENDERS
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    fn rate(per_s: f64) -> Rate {
        Rate::per_second(per_s).unwrap()
    }

    fn quota(of_sender: f64, in_total: f64) -> Quota {
        Quota::new(Limits {
            of_sender: rate(of_sender),
            in_total: rate(in_total),
        })
    }

    /// How many of `asked` at one time are taken.
    fn taken(quota: &mut Quota, now: Duration, sender: Option<&str>, asked: u32) -> u32 {
        let taken = (0..asked).filter(|_| quota.admit(now, sender, None).is_ok());
        taken.count().try_into().unwrap()
    }

    #[test]
    fn a_rate_is_a_number_above_zero_and_below_endless() {
        for number in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300] {
            assert_eq!(Rate::per_second(number), None, "{number}");
        }
        assert_eq!(rate(4.0).number(), 4.0);
        // Once an hour is once at once.
        let mut rarely = quota(1.0 / 3600.0, 100.0);
        assert_eq!(taken(&mut rarely, Duration::ZERO, None, 3), 1);
        assert_eq!(taken(&mut rarely, 3600 * SECOND, None, 3), 1);
    }

    #[test]
    fn who_floods_is_slowed_down_and_nobody_else_is() {
        let mut quota = quota(2.0, 100.0);
        assert_eq!(taken(&mut quota, Duration::ZERO, Some("anna"), 1000), 10);
        assert_eq!(taken(&mut quota, Duration::ZERO, Some("ben"), 5), 5);
        assert_eq!(taken(&mut quota, SECOND, Some("anna"), 1000), 2);
        assert_eq!(taken(&mut quota, SECOND, None, 1000), 10);
        assert_eq!(taken(&mut quota, SECOND, Some("clara"), 1), 1);
        let refused = quota.admit(SECOND, Some("anna"), None).unwrap_err();
        assert_eq!(
            refused.to_string(),
            "too many emergencies: no more than 120 a minute are taken from `anna`; \
             ask again in 0.5 s"
        );
        assert_eq!(taken(&mut quota, 1000 * SECOND, Some("anna"), 1000), 10);
    }

    #[test]
    fn many_names_are_bounded_by_the_total_and_in_memory() {
        let everybody = |quota: &mut Quota| -> u32 {
            let names = (0..10_000).map(|number| format!("sender-{number}"));
            names
                .map(|name| taken(quota, Duration::ZERO, Some(&name), 1))
                .sum()
        };
        let mut bounded = quota(1.0, 40.0);
        assert_eq!(everybody(&mut bounded), 200);
        let refused = bounded.admit(Duration::ZERO, Some("anna"), None);
        let refused = refused.unwrap_err().to_string();
        assert!(
            refused.contains("2400 a minute are taken in total"),
            "{refused}"
        );
        // Names that there is no room for share a rate with those who give none.
        let mut quota = quota(1.0, 1000.0);
        assert_eq!(everybody(&mut quota), 256 + 5);
        assert_eq!(quota.named.len(), MOST_SENDERS);
        // Later those who owe nothing are forgotten, and new names are told apart again.
        assert_eq!(taken(&mut quota, 100 * SECOND, Some("anna"), 1000), 5);
        assert_eq!(taken(&mut quota, 100 * SECOND, Some("ben"), 1000), 5);
    }

    #[test]
    fn who_has_not_heard_the_answer_asks_again_for_nothing() {
        let mut quota = quota(1.0, 1.0);
        let now = Duration::ZERO;
        let fire = GoalId::from("fire");
        assert!(quota.admit(now, None, Some(&fire)).is_ok());
        assert_eq!(taken(&mut quota, now, None, 1000), 4);
        // It was accepted: to be told that it was not would be a lie.
        assert!(quota.admit(now, None, Some(&fire)).is_ok());
        assert!(quota.admit(now, None, Some(&"flood".into())).is_err());
        // What was refused is not remembered as paid.
        assert!(quota.admit(now, None, Some(&"flood".into())).is_err());
    }

    proptest! {
        /// Whoever asks when, in any span of time nobody gets more than the rate and the burst, and
        /// who was told to wait so long is then taken.
        #[test]
        fn no_span_of_time_holds_more_than_its_share(
            steps in prop::collection::vec((0_u64..1_000, 0_usize..3), 1..80),
            per_s in 0.5_f64..20.0,
        ) {
            let senders = [None, Some("anna"), Some("ben")];
            let mut quota = quota(per_s, per_s * 2.0);
            let mut now = Duration::ZERO;
            let mut admitted: Vec<(Duration, usize)> = Vec::new();
            for (pause_ms, who) in steps {
                now += Duration::from_millis(pause_ms);
                match quota.admit(now, senders[who], None) {
                    Ok(()) => admitted.push((now, who)),
                    Err(refused) => {
                        prop_assert!(!refused.wait.is_zero());
                        let due = now + refused.wait;
                        let again = quota.clone().admit(due, senders[who], None);
                        // The total may be what is in the way next.
                        let from = again.map_err(|refused| refused.from);
                        prop_assert!(from != Err(refused.from), "{from:?}");
                    }
                }
            }
            for (place, (from, _)) in admitted.iter().enumerate() {
                for (to_place, (to, _)) in admitted.iter().enumerate().skip(place) {
                    let span_s = (*to - *from).as_secs_f64();
                    let most = |per_s: f64| (span_s + BURST.as_secs_f64()) * per_s + 1.0 + 1e-6;
                    let within = &admitted[place..=to_place];
                    prop_assert!(within.len() as f64 <= most(per_s * 2.0));
                    for sender in 0..senders.len() {
                        let of_sender = within.iter().filter(|(_, who)| *who == sender);
                        prop_assert!(of_sender.count() as f64 <= most(per_s));
                    }
                }
            }
        }
    }
}
