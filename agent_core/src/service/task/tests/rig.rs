//! Vehicles that do tasks, in virtual time and on a bad network. Chance comes from a seed.

mod exchange;

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use super::super::*;
use crate::model::Atom;
use crate::protocol::{Answer, Rows};

/// A source of chance (SplitMix64, after Steele, Lea and Flood).
pub(super) struct Chance(pub u64);

impl Chance {
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Below `most`.
    pub fn below(&mut self, most: usize) -> usize {
        (self.next() % most as u64) as usize
    }

    pub fn within(&mut self, from_s: f64, to_s: f64) -> Time {
        let share = (self.next() >> 11) as f64 / (1_u64 << 53) as f64;
        Time::from_secs(from_s + share * (to_s - from_s))
    }

    pub fn one_in(&mut self, times: usize) -> bool {
        self.below(times) == 0
    }
}

/// What goes wrong.
#[derive(Clone, Copy, Debug)]
pub(super) struct Faults {
    /// Messages to all are lost, late, repeated.
    pub messages: bool,
    /// Vehicles die, freeze, and are cut off.
    pub vehicles: bool,
    /// Work fails now and then.
    pub work: bool,
}

/// What travels between two vehicles, in order and once, whenever both are there.
#[derive(Clone, Debug)]
enum Parcel {
    Give(ActionId),
    Answer(ActionId, Answer),
    TakeBack(ActionId),
    Report(ActionId, Report),
}

#[derive(Clone, Debug)]
enum What {
    Message(usize, Message),
    Parcel(usize, usize),
    Wake(usize),
    Work(usize, ActionId, u64),
    Publish(usize, TaskId),
    Seen { by: usize, whom: usize },
    Kill(usize, Option<Time>),
    Start(usize),
    Freeze(usize, Time),
    Thaw(usize),
    CutOff(usize, Time),
    Heal(usize),
    SayGivenUp(usize, usize, ActionId),
}

/// Work on an execution, as the body does it.
#[derive(Clone, Debug)]
struct Work {
    task: TaskId,
    what: Task,
    publisher: usize,
    left: Time,
    /// Counts changes, so that an earlier end is not taken for a later one.
    version: u64,
    since: Option<Time>,
    /// When the body stands still, if nobody is at work on it.
    busy_until: Time,
}

struct Vehicle {
    service: Option<TaskService>,
    rows: Rows,
    epoch: u64,
    frozen: bool,
    cut_off: bool,
    dead_for_good: bool,
    work: BTreeMap<ActionId, Work>,
    /// Whom it sees.
    sees: BTreeSet<usize>,
    /// Bodies come to rest a while after they were told to, by task.
    resting: BTreeMap<TaskId, Time>,
    woken_at: Option<Time>,
    /// What came while it was frozen.
    waiting: VecDeque<What>,
}

pub(super) struct World {
    seed: u64,
    pub chance: Chance,
    faults: Faults,
    now: Time,
    count: u64,
    queue: BTreeMap<(Time, u64), What>,
    vehicles: Vec<Vehicle>,
    lanes: BTreeMap<(usize, usize), VecDeque<Parcel>>,
    pub publisher_of: BTreeMap<TaskId, usize>,
    pub done: BTreeMap<TaskId, u32>,
    pub ended: BTreeMap<TaskId, Outcome>,
    /// Found done already by one who was to do it.
    pub found_done: u32,
    able: BTreeMap<(usize, TaskId), Time>,
    pub log: Vec<String>,
    /// Executions that were begun.
    pub begun: u32,
    pub given_up: u32,
}

const NAMES: [&str; 5] = ["k1", "k2", "k3", "k4", "k5"];

impl World {
    pub fn new(seed: u64, faults: Faults) -> Self {
        let mut chance = Chance(seed);
        let count = 2 + chance.below(4);
        let mut world = Self {
            seed,
            chance,
            faults,
            now: Time::ZERO,
            count: 0,
            queue: BTreeMap::new(),
            vehicles: Vec::new(),
            lanes: BTreeMap::new(),
            publisher_of: BTreeMap::new(),
            done: BTreeMap::new(),
            ended: BTreeMap::new(),
            found_done: 0,
            able: BTreeMap::new(),
            log: Vec::new(),
            begun: 0,
            given_up: 0,
        };
        for _ in 0..count {
            world.vehicles.push(Vehicle {
                service: None,
                rows: Rows::new(),
                epoch: 0,
                frozen: false,
                cut_off: false,
                dead_for_good: false,
                work: BTreeMap::new(),
                sees: BTreeSet::new(),
                resting: BTreeMap::new(),
                woken_at: None,
                waiting: VecDeque::new(),
            });
        }
        for vehicle in 0..count {
            world.at(Time::ZERO, What::Start(vehicle));
        }
        for number in 0..1 + world.chance.below(6) {
            let task = TaskId::from(format!("t{number}"));
            let publisher = world.chance.below(count);
            world.publisher_of.insert(task.clone(), publisher);
            for vehicle in 0..count {
                // Somebody can do it for certain.
                if world.chance.one_in(2) || vehicle == number % count {
                    let cost = world.chance.within(2.0, 20.0);
                    world.able.insert((vehicle, task.clone()), cost);
                }
            }
            let at = world.chance.within(0.0, 20.0);
            world.at(at, What::Publish(publisher, task));
        }
        if faults.vehicles {
            for _ in 0..world.chance.below(8) {
                world.plan_a_fault();
            }
        }
        world
    }

    fn plan_a_fault(&mut self) {
        let whom = self.chance.below(self.vehicles.len());
        let at = self.chance.within(0.5, 60.0);
        let lasts = self.chance.within(0.05, 25.0);
        let what = match self.chance.below(4) {
            0 => What::Freeze(whom, lasts),
            1 => What::CutOff(whom, lasts),
            2 if self.chance.one_in(3) && whom > 0 => What::Kill(whom, None),
            _ => What::Kill(whom, Some(lasts)),
        };
        self.at(at, what);
    }

    fn at(&mut self, at: Time, what: What) {
        self.count += 1;
        self.queue.insert((at.max(self.now), self.count), what);
    }

    fn soon(&mut self, least_s: f64, most_s: f64, what: What) {
        let at = self.now + self.chance.within(least_s, most_s);
        self.at(at, what);
    }

    fn say(&mut self, what: impl FnOnce() -> String) {
        let line = format!("{} {}", self.now, what());
        self.log.push(line);
    }

    /// Runs until nothing has gone wrong for long.
    pub fn run(&mut self, until: Time) {
        while let Some(((at, _), what)) = self.queue.pop_first() {
            if at > until {
                return;
            }
            self.now = at;
            self.happen(what);
            self.check();
        }
    }

    fn connected(&self, a: usize, b: usize) -> bool {
        !self.vehicles[a].cut_off && !self.vehicles[b].cut_off
    }

    fn lives(&self, vehicle: usize) -> bool {
        self.vehicles[vehicle].service.is_some()
    }

    pub fn anybody_is_dead(&self) -> bool {
        self.vehicles.iter().any(|vehicle| vehicle.dead_for_good)
    }

    pub fn is_dead(&self, vehicle: usize) -> bool {
        self.vehicles[vehicle].dead_for_good
    }

    fn happen(&mut self, what: What) {
        match what {
            What::Message(to, _)
            | What::Wake(to)
            | What::Publish(to, _)
            | What::Seen { by: to, .. }
            | What::SayGivenUp(to, ..)
                if self.vehicles[to].frozen =>
            {
                self.vehicles[to].waiting.push_back(what);
            }
            What::Publish(by, task) if !self.lives(by) => {
                if !self.vehicles[by].dead_for_good {
                    self.soon(1.0, 2.0, What::Publish(by, task));
                }
            }
            What::Message(to, message) => {
                let from = NAMES.iter().position(|name| message.by == *name);
                let from = from.expect("all who speak have a name");
                if self.connected(from, to) {
                    self.tell(to, |service| service.heard(&message));
                }
            }
            What::Wake(to) => {
                self.vehicles[to].woken_at = None;
                self.tell(to, |_| {});
            }
            What::Publish(by, task) => {
                let new = NewTask {
                    what: Atom::new("do", [task.as_str()]),
                    urgency: Urgency::Normal,
                    priority: 0,
                    deadline: None,
                };
                self.tell(by, |service| {
                    service.publish(Some(task), new);
                });
            }
            What::Parcel(from, to) => self.parcel(from, to),
            What::SayGivenUp(who, publisher, id) => {
                let mut knows = false;
                self.tell(who, |service| {
                    knows = service.taken().contains_key(&id);
                    service.let_go(&id);
                });
                if knows {
                    let given_up = Report::Suspended { facts: Vec::new() };
                    self.send(who, publisher, Parcel::Report(id, given_up));
                }
            }
            What::Work(who, id, version) => self.finish(who, &id, version),
            What::Seen { by, whom } => self.see(by, whom),
            What::Kill(who, again) => self.kill(who, again),
            What::Start(who) => self.start(who),
            What::Freeze(who, lasts) => {
                if self.lives(who) && !self.vehicles[who].frozen {
                    self.say(|| format!("{} freezes", NAMES[who]));
                    // It takes a while until that is seen, and the body is stopped.
                    self.pause_work(who, 5.2);
                    self.vehicles[who].frozen = true;
                    self.look_again(who, 1.8, 2.2);
                    self.soon(lasts.secs(), lasts.secs(), What::Thaw(who));
                }
            }
            What::Thaw(who) => {
                self.say(|| format!("{} thaws", NAMES[who]));
                self.vehicles[who].frozen = false;
                self.look_again(who, 0.0, 0.3);
                let waiting = std::mem::take(&mut self.vehicles[who].waiting);
                for what in waiting {
                    self.at(self.now, what);
                }
                // Whatever comes first, what is due comes before it.
                self.tell(who, |_| {});
                self.resume_work(who);
            }
            What::CutOff(who, lasts) => {
                if !self.vehicles[who].cut_off {
                    self.say(|| format!("{} is cut off", NAMES[who]));
                    self.vehicles[who].cut_off = true;
                    self.look_again(who, 0.02, 2.2);
                    self.soon(lasts.secs(), lasts.secs(), What::Heal(who));
                }
            }
            What::Heal(who) => {
                self.say(|| format!("{} is no longer cut off", NAMES[who]));
                self.vehicles[who].cut_off = false;
                self.look_again(who, 0.0, 0.3);
                for other in 0..self.vehicles.len() {
                    self.soon(0.0, 0.1, What::Parcel(who, other));
                    self.soon(0.0, 0.1, What::Parcel(other, who));
                }
            }
        }
    }

    /// Everybody finds out, each in its own time, whom it sees.
    fn look_again(&mut self, whom: usize, least_s: f64, most_s: f64) {
        for other in 0..self.vehicles.len() {
            if other != whom {
                self.soon(least_s, most_s, What::Seen { by: other, whom });
                self.soon(
                    least_s,
                    most_s,
                    What::Seen {
                        by: whom,
                        whom: other,
                    },
                );
            }
        }
    }

    fn see(&mut self, by: usize, whom: usize) {
        let there = self.lives(whom) && !self.vehicles[whom].frozen && self.connected(by, whom);
        let changed = match there {
            true => self.vehicles[by].sees.insert(whom),
            false => self.vehicles[by].sees.remove(&whom),
        };
        if changed && self.lives(by) {
            self.tell(by, |service| service.neighbour(&NAMES[whom].into(), there));
            // Whoever does not see the publisher stands still.
            self.pause_work(by, 3.0);
            self.resume_work(by);
        }
    }

    fn kill(&mut self, who: usize, again: Option<Time>) {
        if !self.lives(who) {
            return;
        }
        self.say(|| format!("{} dies, again: {again:?}", NAMES[who]));
        let rest = Times::default().rest.secs();
        let vehicle = &mut self.vehicles[who];
        vehicle.service = None;
        vehicle.frozen = false;
        let waiting = std::mem::take(&mut vehicle.waiting);
        vehicle.dead_for_good = again.is_none();
        vehicle.sees.clear();
        let work = std::mem::take(&mut vehicle.work);
        for work in work.into_values() {
            let until = match work.since {
                Some(_) => self.now + self.chance.within(0.0, rest),
                // It stood still already, or was about to.
                None => work.busy_until,
            };
            self.vehicles[who].resting.insert(work.task, until);
        }
        // What nobody has acknowledged is asked for again.
        for what in waiting {
            if matches!(what, What::Publish(..)) {
                self.at(self.now, what);
            }
        }
        self.look_again(who, 0.01, 0.05);
        if let Some(after) = again {
            self.soon(after.secs(), after.secs(), What::Start(who));
        }
    }

    fn start(&mut self, who: usize) {
        if self.lives(who) {
            return;
        }
        self.say(|| format!("{} starts", NAMES[who]));
        let vehicle = &mut self.vehicles[who];
        vehicle.epoch += 1;
        vehicle.woken_at = None;
        let mut service = TaskService::new(NAMES[who].into(), vehicle.epoch, Times::default());
        service
            .recall(&vehicle.rows)
            .expect("what was written can be read");
        // What it has given to itself it goes on with.
        let taken = service.taken().iter();
        let own: Vec<(ActionId, Taken)> = taken
            .filter(|(_, taken)| taken.publisher == NAMES[who])
            .map(|(id, taken)| (id.clone(), taken.clone()))
            .collect();
        for (id, taken) in own {
            self.vehicles[who].resting.remove(&taken.task);
            self.begin(who, &mut service, &id, taken.task, taken.what, who);
        }
        self.vehicles[who].service = Some(service);
        self.look_again(who, 0.0, 0.1);
        for other in 0..self.vehicles.len() {
            self.soon(0.0, 0.1, What::Parcel(other, who));
            self.soon(0.0, 0.1, What::Parcel(who, other));
        }
        self.tell(who, |_| {});
    }
}

fn index(name: &Symbol) -> usize {
    let found = NAMES.iter().position(|known| *name == **known);
    found.expect("all vehicles have one of these names")
}

fn failure(reason: &str) -> Report {
    Report::Failure {
        reason: reason.to_owned(),
        facts: Vec::new(),
        blocked_by: Vec::new(),
    }
}
