//! A scenario: what happens when, as a value that can be printed, replayed and cut down.

use std::fmt;

use agent_core::model::Time;
use agent_core::planner::PlannerKind;
use agent_core::protocol::Urgency;
use executor_sim::Fault;

use crate::counts::Counted;
use crate::dice::Dice;
use crate::ground::{DOORS, NODES};

/// Who takes part.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
pub enum Who {
    /// The area level.
    Parent,
    /// The node level.
    Child,
    /// The robot's controller.
    Executor,
    /// A second child, in charge of one area.
    East,
    /// Doors and the robot's body: what is never started anew.
    World,
    /// Whoever asks for goals.
    User,
}

/// All of them.
pub const EVERYONE: [Who; 6] = [
    Who::Parent,
    Who::Child,
    Who::Executor,
    Who::East,
    Who::World,
    Who::User,
];

impl Who {
    /// As agents call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Parent => "parent",
            Self::Child => "child",
            Self::Executor => "executor",
            Self::East => "east",
            Self::World => "world",
            Self::User => "user",
        }
    }

    /// Its place in lists.
    pub fn index(self) -> usize {
        self as usize
    }

    /// The one that agents call so.
    pub fn of(name: &str) -> Option<Self> {
        EVERYONE.into_iter().find(|who| who.name() == name)
    }
}

impl fmt::Display for Who {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// At what point of its work a process is killed.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Point {
    /// Whatever it is doing.
    Now,
    /// While its journal is being written for the `nth` time from now on.
    Writing {
        /// Counts from 0.
        nth: u64,
        /// Whether the writing is found to be whole afterwards.
        kept: bool,
    },
    /// When it sends something for the `nth` time from now on.
    Sending {
        /// Counts from 0.
        nth: u64,
        /// Right after it, or right before.
        after: bool,
    },
}

/// What a user wants of a goal.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Wish {
    /// Set it aside.
    Suspend,
    /// Let it go on.
    Resume,
    /// End it.
    Cancel,
}

/// Something happens.
#[derive(Clone, Debug, PartialEq)]
pub enum What {
    /// A user asks for a goal, until there is an answer.
    Goal {
        /// Its number among the goals of the scenario.
        goal: usize,
        /// What is to be done.
        task: String,
        /// Normal or emergency.
        urgency: Urgency,
        /// Higher goes first.
        priority: i32,
    },
    /// The user asks for the same goal again.
    Again {
        /// Which.
        goal: usize,
    },
    /// A user wants something of a goal.
    Wish {
        /// What.
        wish: Wish,
        /// Of which.
        goal: usize,
    },
    /// A door opens or closes.
    Door {
        /// Which.
        door: &'static str,
        /// Whether it is open from now on.
        open: bool,
    },
    /// The network loses, repeats and delays.
    Weather {
        /// For how long.
        lasts: Time,
        /// Of a thousand messages so many are lost.
        lost: u64,
        /// So many come twice.
        twice: u64,
        /// So many come late, and so out of order.
        late: u64,
    },
    /// Two cannot reach each other.
    Cut {
        /// One.
        one: Who,
        /// The other.
        other: Who,
        /// For how long.
        lasts: Time,
    },
    /// A process is killed and started again.
    Crash {
        /// Whose.
        who: Who,
        /// When exactly.
        point: Point,
        /// How long until it is started again.
        down: Time,
    },
    /// A process is stopped and goes on later as if nothing had happened.
    Freeze {
        /// Whose.
        who: Who,
        /// For how long.
        lasts: Time,
    },
    /// Nothing can be written.
    FullDisk {
        /// Whose journal.
        who: Who,
        /// For how long.
        lasts: Time,
    },
    /// Writing takes its time.
    SlowDisk {
        /// Whose journal.
        who: Who,
        /// For how long.
        lasts: Time,
        /// This long.
        takes: Time,
    },
    /// A process is killed, and its journal is gone.
    LostJournal {
        /// Whose.
        who: Who,
        /// How long until it is started again.
        down: Time,
    },
    /// Something is wrong with an action of the robot.
    Robot {
        /// The number of the action, from 1.
        action: u64,
        /// What.
        fault: Fault,
    },
}

impl What {
    /// How long it goes on.
    pub fn lasts(&self) -> Time {
        match self {
            Self::Weather { lasts, .. }
            | Self::Cut { lasts, .. }
            | Self::Freeze { lasts, .. }
            | Self::FullDisk { lasts, .. }
            | Self::SlowDisk { lasts, .. } => *lasts,
            _ => Time::ZERO,
        }
    }

    /// Whether it is a fault, and not the ordinary course of things; as which it is counted.
    pub fn fault(&self) -> Option<Counted> {
        Some(match self {
            Self::Goal { .. } | Self::Again { .. } | Self::Wish { .. } | Self::Door { .. } => {
                return None;
            }
            Self::Weather { .. } => Counted::BadWeather,
            Self::Cut { .. } => Counted::Cuts,
            Self::Crash { .. } => Counted::Crashes,
            Self::Freeze { .. } => Counted::Freezes,
            Self::FullDisk { .. } => Counted::FullDisks,
            Self::SlowDisk { .. } => Counted::SlowDisks,
            Self::LostJournal { .. } => Counted::LostJournals,
            Self::Robot { .. } => Counted::RobotFaults,
        })
    }
}

/// What happens, and how things are.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// What chance does to single messages follows from this.
    pub seed: u64,
    /// How agents plan.
    pub planner: PlannerKind,
    /// Whether there is a second child.
    pub two_children: bool,
    /// Whether journals are redb files on a disk that forgets what was not synced.
    pub redb: bool,
    /// Whether the robot's sensors can tell afterwards what was done.
    pub hindsight: bool,
    /// The least time that a message takes.
    pub delay: Time,
    /// How much longer it may take.
    pub spread: Time,
    /// How long writing takes at most.
    pub writing: Time,
    /// What happens, each at its time, in this order.
    pub happenings: Vec<(Time, What)>,
}

/// What is to be done once at most for each goal, so that no two goals ask for the same.
const DEEDS: [&str; 3] = ["show", "answer", "greet"];
const PEOPLE: [&str; 3] = ["visitor", "guest", "attendant"];
/// So often a journal is a redb file.
const REDB_EVERY: u64 = 50;

fn ms(milliseconds: u64) -> Time {
    Time(milliseconds * 1000)
}

impl Scenario {
    /// The scenario of a seed.
    pub fn of(seed: u64) -> Self {
        let mut dice = Dice(seed.wrapping_mul(0x2545_f491_4f6c_dd1d).wrapping_add(1));
        let two_children = dice.per_mille(250);
        let mut scenario = Self {
            seed,
            planner: if dice.per_mille(500) {
                PlannerKind::Naive
            } else {
                PlannerKind::Graph
            },
            two_children,
            redb: seed % REDB_EVERY == REDB_EVERY - 1,
            hindsight: dice.per_mille(600),
            delay: ms(1),
            spread: ms(*dice.one_of(&[0, 5, 5, 200])),
            writing: ms(*dice.one_of(&[0, 3, 3, 40])),
            happenings: Vec::new(),
        };
        let mut deeds: Vec<String> = Vec::new();
        let goals = 2 + dice.roll(4) as usize;
        for goal in 0..goals {
            let at = ms(dice.roll(25_000));
            let task = task(&mut dice, &mut deeds);
            let urgency = *dice.one_of(&[Urgency::Normal, Urgency::Emergency]);
            let priority = dice.roll(3) as i32;
            scenario.happenings.push((
                at,
                What::Goal {
                    goal,
                    task,
                    urgency,
                    priority,
                },
            ));
            if dice.per_mille(150) {
                let later = ms(dice.roll(20_000));
                scenario
                    .happenings
                    .push((Time(at.0 + later.0), What::Again { goal }));
            }
        }
        for _ in 0..dice.roll(3) {
            let wish = *dice.one_of(&[Wish::Suspend, Wish::Resume, Wish::Cancel]);
            let goal = dice.roll(goals as u64) as usize;
            scenario
                .happenings
                .push((ms(dice.roll(40_000)), What::Wish { wish, goal }));
        }
        for _ in 0..dice.roll(4) {
            let door = *dice.one_of(&DOORS);
            let open = dice.per_mille(400);
            scenario
                .happenings
                .push((ms(dice.roll(40_000)), What::Door { door, open }));
        }
        for _ in 0..2 + dice.roll(5) {
            let at = ms(dice.roll(45_000));
            let what = fault(&mut dice, two_children);
            // Half of them close to another: things go wrong while others are being mended.
            if dice.per_mille(400) {
                let close = Time(at.0 + ms(dice.roll(1500)).0);
                let what = fault(&mut dice, two_children);
                scenario.happenings.push((close, what));
            }
            scenario.happenings.push((at, what));
        }
        scenario.happenings.sort_by_key(|(at, _)| *at);
        scenario
    }
}

fn task(dice: &mut Dice, deeds: &mut Vec<String>) -> String {
    for _ in 0..8 {
        let kind = *dice.one_of(&["go", "go", "guide", "show", "show", "answer", "greet"]);
        let object = match kind {
            "greet" => *dice.one_of(&PEOPLE),
            _ => *dice.one_of(&NODES),
        };
        let task = format!("({kind} {object})");
        if !DEEDS.contains(&kind) {
            return task;
        }
        if !deeds.contains(&task) {
            deeds.push(task.clone());
            return task;
        }
    }
    format!("(go {})", dice.one_of(&NODES))
}

fn fault(dice: &mut Dice, two_children: bool) -> What {
    let roles = [Who::Parent, Who::Child, Who::Executor, Who::East];
    let roles = &roles[..if two_children { 4 } else { 3 }];
    let who = *dice.one_of(roles);
    let down = ms(match dice.roll(4) {
        0 => dice.roll(50),
        1 | 2 => 300 + dice.roll(2000),
        _ => dice.roll(15_000),
    });
    match dice.roll(100) {
        0..=44 => What::Crash {
            who,
            down,
            point: match dice.roll(8) {
                0 | 1 => Point::Now,
                2..=4 => Point::Writing {
                    nth: dice.roll(4),
                    kept: dice.per_mille(500),
                },
                _ => Point::Sending {
                    nth: dice.roll(6),
                    after: dice.per_mille(500),
                },
            },
        },
        45..=59 => What::Weather {
            lasts: ms(500 + dice.roll(15_000)),
            lost: *dice.one_of(&[0, 50, 200, 500]),
            twice: *dice.one_of(&[0, 50, 300]),
            late: *dice.one_of(&[0, 100, 300]),
        },
        60..=68 => {
            let other = match who {
                Who::Parent => Who::Child,
                Who::Child | Who::East => *dice.one_of(&[Who::Parent, Who::Executor]),
                _ => *dice.one_of(&[Who::Child, Who::World]),
            };
            What::Cut {
                one: who,
                other,
                lasts: ms(dice.roll(8_000)),
            }
        }
        69..=78 => What::Freeze {
            who,
            lasts: ms(dice.roll(6_000)),
        },
        79..=82 => What::FullDisk {
            who,
            lasts: ms(dice.roll(5_000)),
        },
        83..=86 => What::SlowDisk {
            who,
            lasts: ms(dice.roll(5_000)),
            takes: ms(300 + dice.roll(1_500)),
        },
        87 => What::LostJournal { who, down },
        _ => What::Robot {
            action: 1 + dice.roll(12),
            fault: *dice.one_of(&[
                Fault::Failure { fraction: 0.5 },
                Fault::RefusedSuspension,
                Fault::RefusedSuspension,
                Fault::Slow { pace: 0.4 },
                Fault::LateStop { delay: ms(2000) },
                Fault::LateStop { delay: ms(700) },
            ]),
        },
    }
}

impl fmt::Display for Scenario {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "seed {}: planner {:?}, {}, {}, journals {}, messages take {} to {} s, writing takes up to {} s",
            self.seed,
            self.planner,
            if self.two_children {
                "two children"
            } else {
                "one child"
            },
            if self.hindsight {
                "sensors that know what was done"
            } else {
                "no hindsight"
            },
            if self.redb { "in redb" } else { "in memory" },
            self.delay.secs(),
            self.delay.secs() + self.spread.secs(),
            self.writing.secs(),
        )?;
        for (at, what) in &self.happenings {
            writeln!(f, "  {:>7.3} {what:?}", at.secs())?;
        }
        Ok(())
    }
}
