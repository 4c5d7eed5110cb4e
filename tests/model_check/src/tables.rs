//! What has been found out: by number, and once.

use std::sync::{PoisonError, RwLock};

use agent_core::protocol::ActionId;
use rustc_hash::FxHashMap;

use crate::arm::Arm;
use crate::boss::Boss;
use crate::happen::{Event, Rules, Said};
use crate::letter::{Letter, Side};
use crate::lives::{Cue, Life, Lives, Then};
use crate::names::Names;
use crate::node::{Node, disk_print};
use crate::role::Role;
use crate::seen::{Seen, Stamp};
use crate::world::{Motor, Sensor, World};

/// What is said, by numbers.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum Word {
    /// A letter is on the wire.
    Letter(u32),
    /// A user was told that the goal is accepted.
    Acknowledged(usize),
    /// The motors were told something; which execution is to begin, if one is.
    Motor(u32, Option<u32>),
    /// An execution will not be resumed.
    Cleared(u32),
    /// It has died; what follows comes from the next process.
    Died,
    /// Something that must not be.
    Broken(u32),
}

/// Something that happens to the world.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
enum Deed {
    Obeys(u32),
    Finishes,
    Says,
    Silenced,
}

/// All that has been found out about one protocol.
#[derive(Debug)]
pub struct Tables {
    /// How things go.
    pub rules: Rules,
    /// How many goals there are.
    pub goals: usize,
    /// Whether those that look the same are compared in all they do.
    pub doubts: bool,
    letters: Names<String, (Letter, Stamp)>,
    motors: Names<Motor, Motor>,
    sensors: Names<Sensor, Sensor>,
    executions: Names<ActionId, ()>,
    faults: Names<String, String>,
    speeches: Names<Vec<Word>, Vec<Word>>,
    worlds: Names<World, World>,
    deeds: RwLock<FxHashMap<(u32, Deed), (u32, u32)>>,
    kept: RwLock<FxHashMap<u128, u8>>,
    bosses: Lives<Boss>,
    arms: Lives<Arm>,
}

/// Machines of one kind, in the tables.
pub trait Home: Role {
    /// What they have come to be.
    fn lives(tables: &Tables) -> &Lives<Self>;
}

impl Home for Boss {
    fn lives(tables: &Tables) -> &Lives<Self> {
        &tables.bosses
    }
}

impl Home for Arm {
    fn lives(tables: &Tables) -> &Lives<Self> {
        &tables.arms
    }
}

impl Tables {
    /// Nothing is known yet.
    pub fn new(rules: Rules, goals: usize) -> Self {
        Self {
            rules,
            goals,
            doubts: false,
            letters: Names::default(),
            motors: Names::default(),
            sensors: Names::default(),
            executions: Names::default(),
            faults: Names::default(),
            speeches: Names::default(),
            worlds: Names::default(),
            deeds: RwLock::default(),
            kept: RwLock::default(),
            bosses: Lives::default(),
            arms: Lives::default(),
        }
    }

    /// One that has just started for the first time.
    pub fn first<M: Home>(&self) -> Then {
        let (node, said) = self.rules.first::<M>();
        self.then(node, said)
    }

    /// What becomes of that one.
    pub fn after<M: Home>(&self, number: u32, cue: Cue) -> Then {
        let life = M::lives(self).get(number);
        if let Some(then) = life.known(cue) {
            return then;
        }
        let (node, said) = self.rules.happens(&life.node, self.event(cue));
        let then = self.then(node, said);
        life.learn(cue, then);
        if self.doubts {
            for twin in life.twins() {
                self.compare(&twin, cue, then);
            }
        }
        then
    }

    fn then<M: Home>(&self, node: Node<M>, said: Vec<Said>) -> Then {
        let said = self.speech(said);
        let next = self.name(node);
        Then { next, said }
    }

    fn name<M: Home>(&self, node: Node<M>) -> u32 {
        let kept = self.kept(&node);
        let print = node.print(kept);
        let lives = M::lives(self);
        let found = lives.find(print);
        if let Some(number) = found {
            if self.doubts {
                self.doubt(lives.get(number), &node, kept);
            }
            return number;
        }
        lives.number(print, node, |node| self.look(node, kept))
    }

    /// It looks like one that is known: so it goes on like that one.
    fn doubt<M: Home>(&self, life: &Life<M>, twin: &Node<M>, kept: u8) {
        let seen = self.look(twin, kept);
        assert_eq!(life.seen, seen, "these look the same and are not");
        if life.add_twin(twin) {
            for (cue, then) in life.all_known() {
                self.compare(twin, cue, then);
            }
        }
    }

    fn compare<M: Home>(&self, twin: &Node<M>, cue: Cue, then: Then) {
        let (node, said) = self.rules.happens(twin, self.event(cue));
        let event = self.event(cue);
        let print = node.print(self.kept(&node));
        assert_eq!(
            (Some(then.next), then.said),
            (M::lives(self).find(print), self.speech(said)),
            "two that look the same go on differently after {event:?}"
        );
    }

    fn look<M: Home>(&self, node: &Node<M>, kept: u8) -> Seen {
        let first = node.queue.front();
        let first = first.map(|letter| self.letter_number(letter));
        Seen::of(node, self.goals, first, kept)
    }

    /// The goals that would be known of after a restart, found out once for each disk.
    fn kept<M: Home>(&self, node: &Node<M>) -> u8 {
        if M::SIDE == Side::Arm {
            return 0;
        }
        let print = disk_print(&node.disk);
        let known = {
            let known = self.kept.read().unwrap_or_else(PoisonError::into_inner);
            known.get(&print).copied()
        };
        known.unwrap_or_else(|| {
            let again = self.rules.recalled(node);
            let kept = again.map_or(0, |again| again.station.machine().known(self.goals));
            let mut known = self.kept.write().unwrap_or_else(PoisonError::into_inner);
            known.insert(print, kept);
            kept
        })
    }

    /// What is looked at of that one.
    pub fn seen(&self, side: Side, number: u32) -> &Seen {
        match side {
            Side::Boss => &self.bosses.get(number).seen,
            Side::Arm => &self.arms.get(number).seen,
        }
    }

    /// How many effects wait for its writing that is under way.
    pub fn released<M: Home>(&self, number: u32) -> u8 {
        let life = M::lives(self).get(number);
        life.released(|node| self.rules.released(node))
    }

    fn event(&self, cue: Cue) -> Event {
        match cue {
            Cue::Ask(number) => Event::Ask(number),
            Cue::Arrives(letter) => Event::Arrives(Box::new(self.letter(letter).clone())),
            Cue::Written => Event::Written,
            Cue::Hears(sensor) => Event::Hears(self.sensors.get(sensor).clone()),
            Cue::Neighbour(there) => Event::Neighbour(there),
            Cue::Again => Event::Again,
            Cue::Dies(left) => Event::Dies(left),
            Cue::Spared => Event::Spared,
        }
    }

    fn letter_number(&self, letter: &Letter) -> u32 {
        let words = format!("{letter:?}");
        self.letters
            .number(words, || (letter.clone(), Stamp::of(letter)))
    }

    fn speech(&self, said: Vec<Said>) -> u32 {
        let words = said.into_iter().map(|said| match said {
            Said::Letter(letter) => Word::Letter(self.letter_number(&letter)),
            Said::Acknowledged(number) => Word::Acknowledged(number),
            Said::Motor(motor) => {
                let begins = match &motor {
                    Motor::Go { id, .. } => Some(self.execution(id)),
                    Motor::Stop { .. } | Motor::Halt => None,
                };
                Word::Motor(self.motors.number(motor.clone(), || motor), begins)
            }
            Said::Cleared(id) => Word::Cleared(self.execution(&id)),
            Said::Died => Word::Died,
            Said::Broken(what) => Word::Broken(self.fault(&what)),
        });
        let words: Vec<Word> = words.collect();
        self.speeches.number(words.clone(), || words)
    }

    fn execution(&self, id: &ActionId) -> u32 {
        self.executions.number(id.clone(), || ())
    }

    /// What was said.
    pub fn words(&self, said: u32) -> &[Word] {
        self.speeches.get(said)
    }

    /// That letter.
    pub fn letter(&self, number: u32) -> &Letter {
        &self.letters.get(number).0
    }

    /// What is looked at of that letter.
    pub fn stamp(&self, letter: u32) -> &Stamp {
        &self.letters.get(letter).1
    }

    /// The number of something that must not be.
    pub fn fault(&self, what: &str) -> u32 {
        self.faults.number(what.to_owned(), || what.to_owned())
    }

    /// What it is that must not be.
    pub fn fault_of(&self, number: u32) -> &str {
        self.faults.get(number)
    }

    /// The world in the beginning.
    pub fn first_world(&self) -> u32 {
        self.worlds.number(World::default(), World::default)
    }

    /// That world.
    pub fn world(&self, number: u32) -> &World {
        self.worlds.get(number)
    }

    /// Obeys. Whether it could not, for doing something else.
    pub fn obey(&self, world: u32, motor: u32) -> (u32, bool) {
        let (world, busy) = self.deed(world, Deed::Obeys(motor));
        (world, busy > 0)
    }

    /// What is being done is done. How often it has been.
    pub fn finish(&self, world: u32) -> (u32, u32) {
        self.deed(world, Deed::Finishes)
    }

    /// The world has nothing to say any more.
    pub fn silence(&self, world: u32) -> u32 {
        self.deed(world, Deed::Silenced).0
    }

    /// The next thing the world says; it has something to say.
    pub fn says(&self, world: u32) -> (u32, u32) {
        self.deed(world, Deed::Says)
    }

    fn deed(&self, world: u32, deed: Deed) -> (u32, u32) {
        let known = self.deeds.read().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = known.get(&(world, deed)) {
            return *known;
        }
        drop(known);
        let mut then = self.world(world).clone();
        let result = match deed {
            Deed::Obeys(motor) => u32::from(then.obey(self.motors.get(motor).clone())),
            Deed::Finishes => u32::from(then.finish()),
            Deed::Says => {
                let sensor = then.says.pop_front();
                let sensor = sensor.expect("it has something to say");
                self.sensors.number(sensor.clone(), || sensor)
            }
            Deed::Silenced => {
                then.says.clear();
                0
            }
        };
        let then = self.worlds.number(then.clone(), || then);
        let mut known = self.deeds.write().unwrap_or_else(PoisonError::into_inner);
        known.insert((world, deed), (then, result));
        (then, result)
    }

    /// How many different superiors, executors, letters and worlds there were.
    pub fn sizes(&self) -> [usize; 4] {
        [
            self.bosses.len(),
            self.arms.len(),
            self.letters.len(),
            self.worlds.len(),
        ]
    }
}
