//! Several robots on one network, for whom some things go wrong together.

use std::fmt;

use agent_core::model::Time;

use crate::dice::Dice;
use crate::ground::DOORS;
use crate::scenario::{Point, Scenario, What, Who};

/// One seed in so many is of several robots.
pub const FLEET_EVERY: u64 = 8;
/// Of so many fleets one is compared with its robots alone.
const ALONE_EVERY: u64 = 8;

/// One or several robots, each with its own parent, child, controller and journals.
#[derive(Clone, Debug, PartialEq)]
pub struct Fleet {
    /// What befalls each.
    pub robots: Vec<Scenario>,
    /// Whether they are compared with what each of them does alone.
    pub alone: bool,
}

impl Fleet {
    /// What is run for a seed of a long run.
    pub fn at(seed: u64) -> Self {
        if seed % FLEET_EVERY == FLEET_EVERY - 1 {
            Self::of(seed)
        } else {
            Self {
                robots: vec![Scenario::of(seed)],
                alone: false,
            }
        }
    }

    /// How many things befall them.
    pub fn happenings(&self) -> usize {
        self.robots.iter().map(|robot| robot.happenings.len()).sum()
    }

    /// Two robots, or three, whose goals have the same names, and who share a network that is bad, a
    /// machine that fails, and doors.
    pub fn of(seed: u64) -> Self {
        let mut dice = Dice(seed.wrapping_mul(0x9e6c_63d0_876a_4f3b).wrapping_add(7));
        let count = if dice.per_mille(250) { 3 } else { 2 };
        // Scenarios that no seed of one robot has soon.
        let first = (1 << 40) + seed * 4;
        let mut robots: Vec<Scenario> = (first..first + count).map(Scenario::of).collect();
        for (at, what) in common(&mut dice) {
            for robot in &mut robots {
                robot.happenings.push((at, what.clone()));
            }
        }
        for robot in &mut robots {
            robot.happenings.sort_by_key(|(at, _)| *at);
        }
        Self {
            robots,
            alone: (seed / FLEET_EVERY).is_multiple_of(ALONE_EVERY),
        }
    }
}

/// What befalls all of them at once.
fn common(dice: &mut Dice) -> Vec<(Time, What)> {
    let ms = |milliseconds| Time(milliseconds * 1000);
    let mut common = Vec::new();
    if dice.per_mille(500) {
        let weather = What::Weather {
            lasts: ms(500 + dice.roll(10_000)),
            lost: *dice.one_of(&[50, 200, 500]),
            twice: *dice.one_of(&[0, 50, 300]),
            late: *dice.one_of(&[0, 100, 300]),
        };
        common.push((ms(dice.roll(40_000)), weather));
    }
    if dice.per_mille(500) {
        let door = *dice.one_of(&DOORS);
        let open = dice.per_mille(400);
        common.push((ms(dice.roll(40_000)), What::Door { door, open }));
    }
    if dice.per_mille(500) {
        // The machine that all of them run on, or that their parents do.
        let everyone = [Who::Parent, Who::Child, Who::Executor];
        let upto = if dice.per_mille(500) { 3 } else { 1 };
        let at = ms(dice.roll(40_000));
        let down = ms(dice.roll(5_000));
        for who in &everyone[..upto] {
            let point = Point::Now;
            let who = *who;
            common.push((at, What::Crash { who, point, down }));
        }
    }
    common
}

impl fmt::Display for Fleet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (n, robot) in self.robots.iter().enumerate() {
            if self.robots.len() > 1 {
                writeln!(f, "robot {n}:")?;
            }
            write!(f, "{robot}")?;
        }
        Ok(())
    }
}
