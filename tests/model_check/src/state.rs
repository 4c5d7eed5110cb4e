//! Everything at one moment, by numbers.

use smallvec::SmallVec;

use crate::arm::Arm;
use crate::boss::{Boss, goal};
use crate::letter::Side;
use crate::lives::{Cue, Then};
use crate::model::Budget;
use crate::seen::{Kind, Seen, Stamp};
use crate::tables::{Tables, Word};

/// Everything at one moment.
#[derive(Clone, Debug, Eq, Hash, PartialEq)]
pub struct State {
    /// What the superior is.
    pub boss: u32,
    /// What the executor is.
    pub arm: u32,
    /// What really happens.
    pub world: u32,
    /// What is on the wire, in order of numbers; twice what will arrive twice.
    pub wire: SmallVec<[u32; 8]>,
    /// How often the executor is still to hear of its superior's going and coming. An odd number of
    /// times: it misses it.
    pub notices: u8,
    /// Goals that were asked for and not answered since the superior's last start, or acknowledged.
    pub asked: u8,
    /// Goals that were acknowledged.
    pub acked: u8,
    /// Executions of which it was acknowledged that they will not be resumed.
    pub cleared: u64,
    /// What may still go wrong.
    pub left: Budget,
    /// What must not be and is.
    pub broken: Option<u32>,
}

impl State {
    /// Both have started, and nothing has been asked.
    pub fn first(tables: &Tables, budget: Budget) -> Self {
        let (boss, arm) = (tables.first::<Boss>(), tables.first::<Arm>());
        let mut state = Self {
            boss: boss.next,
            arm: arm.next,
            world: tables.first_world(),
            wire: SmallVec::new(),
            notices: 0,
            asked: 0,
            acked: 0,
            cleared: 0,
            left: budget,
            broken: None,
        };
        state.said(tables, Side::Boss, boss.said);
        state.said(tables, Side::Arm, arm.said);
        loop {
            if state.seen(tables, Side::Boss).is_writing {
                state.happens(tables, Side::Boss, Cue::Written);
            } else if state.seen(tables, Side::Arm).is_writing {
                state.happens(tables, Side::Arm, Cue::Written);
            } else if !tables.world(state.world).says.is_empty() {
                state.sense(tables);
            } else {
                break;
            }
        }
        state.spare(tables);
        state.look(tables);
        state
    }

    /// What is looked at of that one.
    pub fn seen<'a>(&self, tables: &'a Tables, side: Side) -> &'a Seen {
        match side {
            Side::Boss => tables.seen(side, self.boss),
            Side::Arm => tables.seen(side, self.arm),
        }
    }

    /// Something must not be.
    pub fn broken(&mut self, tables: &Tables, what: &str) {
        if self.broken.is_none() {
            self.broken = Some(tables.fault(what));
        }
    }

    /// Something happens to one of the two.
    pub fn happens(&mut self, tables: &Tables, side: Side, cue: Cue) {
        let Then { next, said } = match side {
            Side::Boss => tables.after::<Boss>(self.boss, cue),
            Side::Arm => tables.after::<Arm>(self.arm, cue),
        };
        match side {
            Side::Boss => self.boss = next,
            Side::Arm => self.arm = next,
        }
        self.said(tables, side, said);
    }

    /// That is said.
    fn said(&mut self, tables: &Tables, side: Side, said: u32) {
        for word in tables.words(said) {
            match *word {
                Word::Letter(letter) => self.post(tables, letter),
                Word::Acknowledged(number) => self.acked |= 1 << number,
                Word::Motor(motor, begins) => {
                    if begins.is_some_and(|id| self.cleared & bit(id) != 0) {
                        self.broken(tables, "S5: what was cleared starts");
                    }
                    let (world, busy) = tables.obey(self.world, motor);
                    self.world = world;
                    if busy {
                        self.broken(tables, "S3: two actions at once");
                    }
                }
                Word::Cleared(id) => self.cleared |= bit(id),
                Word::Died => self.died(tables, side),
                Word::Broken(what) => {
                    self.broken.get_or_insert(what);
                }
            }
        }
    }

    /// What died with a process.
    fn died(&mut self, tables: &Tables, side: Side) {
        match side {
            // Whoever was not answered asks again.
            Side::Boss => self.asked = self.acked,
            Side::Arm => self.world = tables.silence(self.world),
        }
        // Answers to a process that is no more.
        let kept = |letter: &mut u32| tables.stamp(*letter).kind != Kind::Response(side);
        self.wire.retain(kept);
    }

    /// One of the two dies and starts again.
    pub fn crash(&mut self, tables: &Tables, side: Side, cue: Cue) {
        self.happens(tables, side, cue);
        // It has seen its neighbour at once, and the superior sees its executor at once, since that makes
        // no difference to what either does. When the executor misses its superior does.
        match side {
            Side::Boss => self.notices += 2,
            Side::Arm => {
                self.notices = 0;
                self.happens(tables, Side::Boss, Cue::Again);
            }
        }
    }

    /// What is on a disk matters no more if nobody can die any more.
    pub fn spare(&mut self, tables: &Tables) {
        if self.left.crashes == 0 {
            self.happens(tables, Side::Boss, Cue::Spared);
            self.happens(tables, Side::Arm, Cue::Spared);
        }
    }

    /// The executor hears what the world has to say.
    pub fn sense(&mut self, tables: &Tables) {
        let (world, sensor) = tables.says(self.world);
        self.world = world;
        self.happens(tables, Side::Arm, Cue::Hears(sensor));
    }

    /// The executor hears of its superior.
    pub fn notice(&mut self, tables: &Tables) {
        let there = self.notices % 2 == 1;
        self.notices -= 1;
        self.happens(tables, Side::Arm, Cue::Neighbour(there));
    }

    /// What is being done is done.
    pub fn finish(&mut self, tables: &Tables) {
        let (world, times) = tables.finish(self.world);
        self.world = world;
        if times > 1 {
            self.broken(tables, "S6: something was done twice");
        }
    }

    /// Puts a letter on the wire. Nobody waits any more for an answer to a process that is no more.
    pub fn post(&mut self, tables: &Tables, letter: u32) {
        let Stamp { kind, epoch, .. } = *tables.stamp(letter);
        if let Kind::Response(side) = kind
            && self.seen(tables, side).epoch != epoch
        {
            return;
        }
        let place = self.wire.partition_point(|other| *other < letter);
        self.wire.insert(place, letter);
    }

    /// Takes letters off the wire that will never change anything: answers that nobody waits for, and
    /// messages whose receiver has written down that they are past and whose answer nobody waits for.
    pub fn sweep(&mut self, tables: &Tables) {
        if self.wire.is_empty() {
            return;
        }
        let boss = self.seen(tables, Side::Boss);
        let arm = self.seen(tables, Side::Arm);
        self.wire.retain(|letter| {
            let stamp = tables.stamp(*letter);
            let waits = |seen: &Seen| {
                stamp.epoch == seen.epoch && seen.first.is_some_and(|(_, seq)| seq <= stamp.seq)
            };
            match stamp.kind {
                Kind::Instruction { .. } => !is_past(stamp, arm) || waits(boss),
                Kind::StopAhead => !is_past(stamp, arm),
                Kind::Report => !is_past(stamp, boss) || waits(arm),
                Kind::Response(Side::Boss) => answers(stamp, boss),
                Kind::Response(Side::Arm) => answers(stamp, arm),
            }
        });
    }

    /// Looks for what can be seen to be wrong.
    pub fn look(&mut self, tables: &Tables) {
        let boss = self.seen(tables, Side::Boss);
        let arm = self.seen(tables, Side::Arm);
        if let Some(fault) = boss.fault.as_ref().or(arm.fault.as_ref()) {
            self.broken(tables, fault);
        }
        let lost = self.acked & !(boss.kept & boss.known);
        if lost != 0 {
            let id = goal(lost.trailing_zeros() as usize);
            let what = match boss.kept & lost == lost {
                false => format!("S1: {id} was acknowledged and is not on the disk"),
                true => format!("S1: {id} was acknowledged and is forgotten"),
            };
            self.broken(tables, &what);
        }
    }
}

fn bit(number: u32) -> u64 {
    assert!(number < 64, "more executions than were thought of");
    1 << number
}

fn is_past(stamp: &Stamp, receiver: &Seen) -> bool {
    let (epoch, last) = receiver.heard;
    stamp.epoch < epoch || stamp.epoch == epoch && stamp.seq <= last
}

fn answers(stamp: &Stamp, sender: &Seen) -> bool {
    sender.first.is_some_and(|(_, seq)| seq == stamp.seq)
}
