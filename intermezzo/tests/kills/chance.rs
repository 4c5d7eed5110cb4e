//! What happens, from a seed.

use std::time::Duration;

use agent_core::model::Time;
use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Chance that can be repeated.
pub struct Chance(ChaCha8Rng);

/// What is done to the robot.
#[derive(Clone, Debug)]
pub struct Blow {
    pub when: When,
    pub strokes: Vec<Stroke>,
    /// Whether the next one waits until the robot has recovered.
    pub rest: bool,
}

/// When it is done.
#[derive(Clone, Copy, Debug)]
pub enum When {
    After(Duration),
    /// As soon as this agent tells this.
    On(&'static str, &'static str),
    /// As soon as a goal has been accepted.
    OnAnswer,
}

/// What is done to one process.
#[derive(Clone, Copy, Debug)]
pub struct Stroke {
    pub whom: &'static str,
    pub how: How,
}

#[derive(Clone, Copy, Debug)]
pub enum How {
    Kill,
    /// It stands still for so long; nobody wakes it up if there is no time.
    Freeze(Option<Duration>),
}

/// The moments at which it hurts most.
const MARKED: [(&str, &str); 9] = [
    ("executor", "action_started"),
    ("executor", "action_suspended"),
    ("executor", "action_finished"),
    ("child", "action_started"),
    ("child", "goal_suspended"),
    ("parent", "goal_suspended"),
    ("parent", "goal_resumed"),
    ("parent", "action_finished"),
    ("parent", "goal_succeeded"),
];

impl Chance {
    pub fn new(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    pub fn below(&mut self, limit: usize) -> usize {
        self.0.random_range(0..limit)
    }

    fn one_in(&mut self, times: usize) -> bool {
        self.below(times) == 0
    }

    pub fn millis(&mut self, range: std::ops::Range<u64>) -> Duration {
        Duration::from_millis(self.0.random_range(range))
    }

    /// Numbers for another stream of chance.
    pub fn seed(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// Something that is done to one or two of `roles`, or to `up`.
    pub fn blow(&mut self, roles: &[&'static str]) -> Blow {
        let when = match self.below(10) {
            0..4 => When::After(self.millis(0..600)),
            4 => When::OnAnswer,
            _ => {
                let (agent, event) = MARKED[self.below(MARKED.len())];
                When::On(agent, event)
            }
        };
        let mut strokes = vec![self.stroke(roles)];
        if self.one_in(3) {
            let other = self.stroke(roles);
            if other.whom != strokes[0].whom {
                strokes.push(other);
            }
        }
        Blow {
            when,
            strokes,
            rest: !self.one_in(4),
        }
    }

    fn stroke(&mut self, roles: &[&'static str]) -> Stroke {
        let whom = match self.below(8) {
            0 => "up",
            number => roles[number % roles.len()],
        };
        let how = match self.below(6) {
            // Nobody looks after `up` itself.
            0 if whom == "up" => How::Freeze(Some(self.millis(100..1500))),
            0 => match self.below(3) {
                0 => How::Freeze(Some(self.millis(50..1000))),
                // Longer than the lease.
                1 => How::Freeze(Some(self.millis(2200..3800))),
                _ => How::Freeze(None),
            },
            _ => How::Kill,
        };
        Stroke { whom, how }
    }

    /// After how many seconds of the world a goal is no longer wanted, if ever.
    pub fn deadline(&mut self) -> Option<Time> {
        self.one_in(8)
            .then(|| Time::from_secs(self.0.random_range(5.0..120.0)))
    }

    /// A task, and whether it has a deed.
    pub fn task(&mut self, person: usize) -> (String, bool) {
        let node = 1 + self.below(40);
        match self.below(5) {
            0 => (format!("(go n{node})"), false),
            1 => (format!("(guide n{node})"), false),
            2 => (format!("(greet p{person})"), true),
            _ => (format!("(and (go n{node}) (greet p{person}))"), true),
        }
    }
}
