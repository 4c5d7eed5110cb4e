//! One scenario, from its beginning until everything is quiet.

mod body;
mod faults;
mod peace;
mod processes;
mod recalling;
mod receiving;
mod seeing;
mod sending;
mod together;
mod users;

use std::collections::{BTreeMap, VecDeque};

use agent_core::model::{Symbol, Time};
use agent_core::protocol::{ActionId, Arrival, GoalRequest, Inbox, Input, Machine, Row};
use executor_sim::World;

use crate::counts::{Counted, Counts};
use crate::dice::drawn;
use crate::ground::Ground;
use crate::law::Law;
use crate::mutant::Mutant;
use crate::process::{Board, Kind, Role};
use crate::scenario::{EVERYONE, Point, Scenario, Who, Wish};
use crate::store::Store;
use crate::wire::{Channel, Message};

pub use together::{run, run_fleet};
use users::goals;

/// Without an answer for so long a message counts as lost.
const TIMEOUT: Time = Time(1_000_000);
/// Between two attempts.
const BACK_OFF: [u64; 3] = [50_000, 100_000, 200_000];
/// Who was not heard of for so long is gone.
const LEASE: Time = Time(1_000_000);
/// A full disk is tried again after that long.
const TRY_AGAIN: Time = Time(200_000);
/// A user asks again after that long.
const PATIENCE: Time = Time(2_000_000);
/// One writing in so many is read again at once.
const RECALL_EVERY: u64 = 50;
/// A scenario never takes so many steps.
const MOST_STEPS: u64 = 200_000;
/// Nor does anything go on for so long after the last fault.
const LONGEST: Time = Time(3_600_000_000);

/// What has become of a scenario.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// What was wrong.
    pub broken: Option<String>,
    /// How often what was done to it.
    pub counts: Counts,
    /// What happened, a line each, if it was to be told.
    pub story: Vec<String>,
}

#[derive(Debug)]
enum Due {
    Deliver {
        /// The number of the robot whose it is.
        robot: u8,
        from: Who,
        to: Who,
        message: Box<Message>,
    },
    Retry {
        who: Who,
        epoch: u64,
        kind: Kind,
        to: Who,
        seq: u64,
        attempt: u32,
    },
    Written {
        who: Who,
        epoch: u64,
    },
    Start {
        who: Who,
    },
    Thaw {
        who: Who,
    },
    /// Somebody looks whether somebody is there.
    Look {
        observer: Who,
        subject: Who,
    },
    AskAgain {
        who: Who,
        epoch: u64,
        executor: Who,
        attempts: u32,
    },
    UserAsks(u32),
    /// It was promised that something stops.
    Promised {
        id: ActionId,
        promised: Time,
    },
    Happening(usize),
    /// Crash, if it has not come to it otherwise.
    CrashAtLast {
        who: Who,
        armed: u64,
    },
    /// Nothing goes wrong any more.
    Peace,
}

#[derive(Default)]
struct Node {
    role: Option<Role>,
    /// When its process is to be woken.
    wake: Option<Time>,
    epoch: u64,
    store: Store,
    writing: Option<Vec<Row>>,
    /// Counts writings, for mutants that lie about some.
    writings: u64,
    full_until: Time,
    slow: Option<(Time, Time)>,
    frozen: Option<(Time, Time)>,
    backlog: VecDeque<(Who, Message)>,
    channels: Vec<Channel>,
    board: Board,
    /// What was read of each executor's facts: epoch and number.
    read: [Option<(u64, u64)>; 6],
    /// The epoch in which each was seen, 0 if it is not there.
    seen: [u64; 6],
    armed: Option<(u64, Point, Time)>,
    instructed: bool,
    ends_dropped: u64,
}

impl Node {
    fn with(store: Store) -> Self {
        Self {
            store,
            ..Self::default()
        }
    }
}

fn store(scenario: &Scenario) -> Store {
    if scenario.redb {
        Store::real()
    } else {
        Store::default()
    }
}

struct Request {
    goal: usize,
    wish: Option<Wish>,
    answered: bool,
    insists: bool,
}

struct Cut {
    one: Who,
    other: Who,
    since: Time,
    until: Time,
}

/// A run of one scenario.
pub struct Simulation<'a> {
    ground: &'a Ground,
    scenario: &'a Scenario,
    /// Its number: so messages are addressed.
    robot: u8,
    mutant: Option<Mutant>,
    now: Time,
    /// What has come to be due, and when; whoever keeps the clock takes it.
    planned: Vec<(Time, Due)>,
    armings: u64,
    epochs: u64,
    nodes: [Node; 6],
    world: World,
    world_hears: Inbox<()>,
    world_says: Channel,
    world_seq: u64,
    /// Of the controller that it has heard last.
    world_epoch: u64,
    requests: Vec<Request>,
    goals: Vec<(Symbol, String, GoalRequest)>,
    /// For each acknowledged goal a row of the parent's journal that speaks of it.
    witnesses: BTreeMap<Symbol, String>,
    cuts: Vec<Cut>,
    weather: Vec<(Time, u64, u64, u64)>,
    messages: u64,
    peace: bool,
    law: Law,
    /// Hangs on everything that was given to a process, and when.
    trace: u64,
    tells: bool,
    story: Vec<(Time, String)>,
    outcome: Outcome,
}

impl<'a> Simulation<'a> {
    fn new(
        ground: &'a Ground,
        scenario: &'a Scenario,
        robot: u8,
        mutant: Option<Mutant>,
        tells: bool,
    ) -> Self {
        let mut simulation = Self {
            ground,
            scenario,
            robot,
            mutant,
            now: Time::ZERO,
            planned: Vec::new(),
            armings: 0,
            epochs: 100,
            nodes: std::array::from_fn(|_| Node::with(store(scenario))),
            world: ground.world(scenario.hindsight),
            world_hears: Inbox::default(),
            world_says: Channel::new(Kind::Local, Who::Executor),
            world_seq: 0,
            world_epoch: 0,
            requests: Vec::new(),
            goals: goals(scenario),
            witnesses: BTreeMap::new(),
            cuts: Vec::new(),
            weather: Vec::new(),
            messages: 0,
            peace: false,
            law: Law::default(),
            trace: 0,
            tells,
            story: Vec::new(),
            outcome: Outcome::default(),
        };
        let last = scenario.happenings.last().map_or(Time::ZERO, |(at, _)| *at);
        for (n, (at, _)) in scenario.happenings.iter().enumerate() {
            simulation.plan(*at, Due::Happening(n));
        }
        simulation.plan(last + Time::from_secs(20.0), Due::Peace);
        for who in simulation.roles() {
            simulation.start(who);
        }
        simulation
    }

    fn roles(&self) -> Vec<Who> {
        let mut roles = vec![Who::Parent, Who::Child, Who::Executor];
        if self.scenario.two_children {
            roles.push(Who::East);
        }
        roles
    }

    fn plan(&mut self, at: Time, due: Due) {
        self.planned.push((at.max(self.now), due));
    }

    fn after(&mut self, delay: Time, due: Due) {
        self.plan(self.now + delay, due);
    }

    fn count(&mut self, what: Counted) {
        self.outcome.counts.count(what);
    }

    fn tell(&mut self, line: impl FnOnce() -> String) {
        if self.tells {
            self.story.push((self.now, line()));
        }
    }

    fn broken(&mut self, what: impl FnOnce() -> String) {
        self.law.broken(self.now, what);
    }

    fn draw(&mut self, what: u64, below: u64) -> u64 {
        self.messages += 1;
        drawn(self.scenario.seed, [what, self.messages, self.now.0]) % below.max(1)
    }

    /// Whoever is to be woken is.
    fn wake(&mut self, who: Who) {
        if self.now > LONGEST {
            return self.broken(|| format!("{who} still wants to be woken after an hour"));
        }
        if who == Who::World {
            self.world.handle(self.now, Input::Wake);
            self.hear_the_world();
        } else {
            self.give(who, Arrival::Input(Input::Wake), None);
        }
    }

    fn next_wake(&self) -> Option<(Time, Who)> {
        let roles = EVERYONE[..4].iter().filter_map(|who| {
            let node = &self.nodes[who.index()];
            if node.frozen.is_some() {
                return None;
            }
            Some((node.wake?.max(self.now), *who))
        });
        let world = self.world.wake_at().map(|at| (at, Who::World));
        roles.chain(world).min_by_key(|(at, _)| *at)
    }

    fn happen(&mut self, due: Due) {
        if self.now > LONGEST {
            return self.broken(|| "things still go on after an hour".to_owned());
        }
        match due {
            Due::Deliver {
                robot,
                from,
                to,
                message,
            } => {
                let own = self.robot;
                if robot != own {
                    let kind = message.kind();
                    return self.broken(|| {
                        format!("{kind} for {to} of robot {robot} comes to robot {own}")
                    });
                }
                self.deliver(from, to, *message);
            }
            Due::Retry {
                who,
                epoch,
                kind,
                to,
                seq,
                attempt,
            } => self.retry(who, epoch, (kind, to), seq, attempt),
            Due::Written { who, epoch } => self.written(who, epoch),
            Due::Start { who } => {
                if self.nodes[who.index()].role.is_none() {
                    self.start(who);
                }
            }
            Due::Thaw { who } => self.thaw(who),
            Due::Look { observer, subject } => self.look(observer, subject),
            Due::AskAgain {
                who,
                epoch,
                executor,
                attempts,
            } => self.ask_what_holds(who, epoch, executor, attempts),
            Due::UserAsks(request) => self.user_asks(request),
            Due::Promised { id, promised } => self.law.stop_is_due(self.now, &id, promised),
            Due::Happening(n) => {
                let what = self.scenario.happenings[n].1.clone();
                self.happening(what);
            }
            Due::CrashAtLast { who, armed } => {
                let node = &self.nodes[who.index()];
                if let Some((of, _, down)) = node.armed
                    && of == armed
                {
                    self.crash(who, false, down);
                }
            }
            Due::Peace => self.make_peace(),
        }
    }
}
