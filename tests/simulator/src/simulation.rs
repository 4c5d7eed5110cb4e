//! One scenario, from its beginning until everything is quiet.

use std::collections::{BTreeMap, VecDeque};

use agent_core::language::{parse_fact_change, parse_tasks};
use agent_core::model::{FactChange, Symbol, Time};
use agent_core::protocol::{
    ActionId, Arrival, Command, Effect, Envelope, GoalRequest, Inbox, Input, Machine, Output,
    Receipt, Response, Row, Rows, Unreadable,
};
use executor_sim::{Faults, MotorCommand, Sensor, World};

use crate::dice::{Dice, drawn};
use crate::ground::{DOORS, Ground};
use crate::law::{BOUND, Law};
use crate::mutant::Mutant;
use crate::process::{AnyArrival, AnyEffect, Board, Kind, Role, Way, name};
use crate::scenario::{EVERYONE, Point, Scenario, What, Who, Wish};
use crate::store::{Store, apply};
use crate::wire::{Channel, Message};

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
    pub counts: BTreeMap<&'static str, u64>,
    /// What happened, a line each, if it was to be told.
    pub story: Vec<String>,
}

#[derive(Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "nearly all of them are deliveries"
)]
enum Due {
    Deliver {
        from: Who,
        to: Who,
        message: Message,
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
    mutant: Option<Mutant>,
    now: Time,
    due: BTreeMap<(Time, u64), Due>,
    counter: u64,
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
    cuts: Vec<Cut>,
    weather: Vec<(Time, u64, u64, u64)>,
    messages: u64,
    peace: bool,
    law: Law,
    tells: bool,
    outcome: Outcome,
}

/// Runs a scenario. `tells`: with its story.
pub fn run(ground: &Ground, scenario: &Scenario, mutant: Option<Mutant>, tells: bool) -> Outcome {
    let mut simulation = Simulation::new(ground, scenario, mutant, tells);
    simulation.go();
    simulation.outcome.broken = simulation.law.broken.take();
    simulation.outcome
}

impl<'a> Simulation<'a> {
    fn new(
        ground: &'a Ground,
        scenario: &'a Scenario,
        mutant: Option<Mutant>,
        tells: bool,
    ) -> Self {
        let mut simulation = Self {
            ground,
            scenario,
            mutant,
            now: Time::ZERO,
            due: BTreeMap::new(),
            counter: 0,
            epochs: 100,
            nodes: std::array::from_fn(|_| Node::with(store(scenario))),
            world: ground.world(scenario.hindsight),
            world_hears: Inbox::default(),
            world_says: Channel::new(Kind::Local, Who::Executor),
            world_seq: 0,
            world_epoch: 0,
            requests: Vec::new(),
            goals: goals(scenario),
            cuts: Vec::new(),
            weather: Vec::new(),
            messages: 0,
            peace: false,
            law: Law::default(),
            tells,
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
        self.counter += 1;
        self.due.insert((at.max(self.now), self.counter), due);
    }

    fn after(&mut self, delay: Time, due: Due) {
        self.plan(self.now + delay, due);
    }

    fn count(&mut self, what: &'static str) {
        *self.outcome.counts.entry(what).or_default() += 1;
    }

    fn tell(&mut self, line: impl FnOnce() -> String) {
        if self.tells {
            let line = format!("{:>9.4} {}", self.now.secs(), line());
            self.outcome.story.push(line);
        }
    }

    fn broken(&mut self, what: impl FnOnce() -> String) {
        self.law.broken(self.now, what);
    }

    fn draw(&mut self, what: u64, below: u64) -> u64 {
        self.messages += 1;
        drawn(self.scenario.seed, [what, self.messages, self.now.0]) % below.max(1)
    }

    // ---- the loop ------------------------------------------------------------------------------

    fn go(&mut self) {
        for _ in 0..MOST_STEPS {
            if self.law.broken.is_some() {
                return;
            }
            if !self.step() {
                if self.peace {
                    self.judge();
                    return;
                }
                return self.broken(|| "it ended before there was peace".to_owned());
            }
        }
        self.broken(|| "it goes round in circles".to_owned());
    }

    fn step(&mut self) -> bool {
        let wake = self.next_wake();
        let next = self.due.first_key_value().map(|(key, _)| *key);
        let wake_first = match (wake, next) {
            (None, None) => return false,
            (Some(_), None) => true,
            (None, Some(_)) => false,
            (Some((at, _)), Some((due, _))) => at < due,
        };
        if let Some((at, who)) = wake.filter(|_| wake_first) {
            self.now = self.now.max(at);
            if self.now > LONGEST {
                self.broken(|| format!("{who} still wants to be woken after an hour"));
                return false;
            }
            if who == Who::World {
                self.world.handle(self.now, Input::Wake);
                self.hear_the_world();
            } else {
                self.give(who, Arrival::Input(Input::Wake), None);
            }
            return true;
        }
        let Some(((at, _), due)) = self.due.pop_first() else {
            return false;
        };
        self.now = self.now.max(at);
        if self.now > LONGEST {
            self.broken(|| "things still go on after an hour".to_owned());
            return false;
        }
        self.happen(due);
        true
    }

    fn next_wake(&self) -> Option<(Time, Who)> {
        let roles = EVERYONE[..4].iter().filter_map(|who| {
            let node = &self.nodes[who.index()];
            if node.frozen.is_some() {
                return None;
            }
            Some((node.role.as_ref()?.wake_at()?.max(self.now), *who))
        });
        let world = self.world.wake_at().map(|at| (at, Who::World));
        roles.chain(world).min_by_key(|(at, _)| *at)
    }

    fn happen(&mut self, due: Due) {
        match due {
            Due::Deliver { from, to, message } => self.deliver(from, to, message),
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

    // ---- processes -----------------------------------------------------------------------------

    fn start(&mut self, who: Who) {
        self.epochs += 1;
        let before = self.nodes[who.index()].epoch;
        let forgets = self.mutant == Some(Mutant::ForgetTheEpoch) && before != 0;
        let epoch = if forgets { before } else { self.epochs };
        let found = self.nodes[who.index()].store.open(who.name()).cloned();
        let mut rows = match found {
            Ok(rows) => rows,
            Err(error) => return self.broken(|| format!("the journal of {who}: {error}")),
        };
        if let Some(mutant) = self.mutant
            && !rows.is_empty()
        {
            mutant.found(&mut rows);
        }
        let role = self.role(who, epoch, &rows);
        let role = match role {
            Ok(role) => role,
            Err(error) => {
                return self.broken(|| format!("S10: {who} cannot read its journal: {error}"));
            }
        };
        self.tell(|| format!("{who:<9} starts in epoch {epoch} with {} rows", rows.len()));
        self.law.handled(self.now, who, &role);
        let node = &mut self.nodes[who.index()];
        node.role = Some(role);
        node.epoch = epoch;
        node.instructed = false;
        if who == Who::Parent {
            self.owes_nothing();
        }
        for other in EVERYONE {
            self.look_soon(other, who);
            self.look_soon(who, other);
        }
        self.pump(who);
    }

    /// S1: of every goal that the parent has acknowledged there is something in its journal.
    fn owes_nothing(&mut self) {
        let node = &self.nodes[Who::Parent.index()];
        let line = node.role.as_ref().map_or(0, Role::line);
        let rows = node.store.rows();
        let lost = self.law.owed(line).find(|goal| !speak_of(rows, goal));
        if let Some(goal) = lost.cloned() {
            self.broken(|| format!("S1: the parent has forgotten {goal}"));
        }
    }

    /// S10: who recalls what was just written, with what is in the journal, is as the one that has
    /// written it.
    fn recalls(&mut self, who: Who, writing: &[Row]) {
        let node = &self.nodes[who.index()];
        let mut rows = node.store.rows().clone();
        apply(&mut rows, writing);
        let recalled = self.role(who, node.epoch, &rows);
        let wrong = match (recalled, &node.role) {
            (Ok(mut recalled), Some(role)) => {
                let again = recalled.write_down().unwrap_or_default();
                let other = again.iter().find(|row| !differs_after_a_start(&row.key));
                other
                    .map(|row| format!("recalls another {}", row.key))
                    .or_else(|| unlike(role, &recalled))
            }
            (Err(error), _) => Some(error.to_string()),
            (Ok(_), None) => None,
        };
        if let Some(wrong) = wrong {
            self.broken(|| format!("S10: {who}: {wrong}"));
        }
    }

    /// A process of it that starts.
    fn role(&self, who: Who, epoch: u64, rows: &Rows) -> Result<Role, Unreadable> {
        let scenario = self.scenario;
        match who {
            Who::Executor => {
                let controller = self.ground.controller(faults(scenario));
                Role::controller(who, epoch, controller, rows, self.mutant)
            }
            Who::Parent => {
                let two = scenario.two_children;
                let agent = self.ground.parent(epoch, scenario.planner, two);
                Role::agent(who, epoch, agent, rows, self.mutant)
            }
            _ => {
                let agent = self.ground.child(who.name(), epoch, scenario.planner);
                Role::agent(who, epoch, agent, rows, self.mutant)
            }
        }
    }

    fn crash(&mut self, who: Who, kept: bool, down: Time) {
        let node = &mut self.nodes[who.index()];
        if node.role.take().is_none() {
            return;
        }
        let mut interrupted = node.writing.take();
        let mut written = Ok(());
        match (&mut interrupted, self.mutant) {
            (Some(rows), Some(Mutant::TornWriting)) => {
                rows.truncate(rows.len() / 2);
                written = node.store.write(rows);
                interrupted = None;
            }
            (_, Some(Mutant::SkipTheJournal)) => interrupted = None,
            (Some(rows), _) if kept => {
                written = node.store.write(rows);
                interrupted = None;
            }
            _ => {}
        }
        let chance = [10, node.epoch, node.writings];
        let mut dice = Dice(drawn(self.scenario.seed, chance));
        node.store.crash(interrupted.as_deref(), &mut dice);
        node.channels.clear();
        node.backlog.clear();
        node.frozen = None;
        node.armed = None;
        node.board = Board::default();
        node.read = [None; 6];
        node.seen = [0; 6];
        if let Err(error) = written {
            self.broken(|| format!("the journal of {who}: {error}"));
        }
        self.law.died(who);
        self.law.trouble(self.now + down);
        self.count("processes killed");
        self.tell(|| format!("{who:<9} is killed"));
        for other in EVERYONE {
            self.look_soon(other, who);
        }
        self.after(down, Due::Start { who });
    }

    fn thaw(&mut self, who: Who) {
        let node = &mut self.nodes[who.index()];
        let Some((_, until)) = node.frozen else {
            return;
        };
        if until > self.now {
            return;
        }
        node.frozen = None;
        let backlog = std::mem::take(&mut node.backlog);
        self.tell(|| format!("{who:<9} goes on"));
        for other in EVERYONE {
            self.look_soon(other, who);
            self.look_soon(who, other);
        }
        for (from, message) in backlog {
            self.deliver(from, who, message);
        }
    }

    /// Gives a role something, and takes what comes of it.
    fn give(&mut self, who: Who, arrival: AnyArrival, way: Option<Way>) {
        let now = self.now;
        let node = &mut self.nodes[who.index()];
        let Some(role) = &mut node.role else {
            return;
        };
        role.handle(now, arrival, way);
        self.law.handled(now, who, role);
        self.pump(who);
    }

    /// Takes what may go out now, and writes down what has to be.
    fn pump(&mut self, who: Who) {
        let now = self.now;
        loop {
            let node = &mut self.nodes[who.index()];
            let epoch = node.epoch;
            let Some(role) = &mut node.role else {
                return;
            };
            if let Some(effect) = role.poll_effect() {
                let line = role.line();
                if self.tick(who, true) {
                    return;
                }
                let late = self.mutant == Some(Mutant::StopWaitsForTheDisk);
                if late && matches!(effect, Effect::StopAhead { .. }) {
                    continue;
                }
                self.law.sent(now, who, line, &effect);
                self.send_effect(who, epoch, effect);
                if self.tick(who, false) {
                    return;
                }
                continue;
            }
            if node.writing.is_some() || !role.wants_writing() {
                return;
            }
            let Some(rows) = role.write_down() else {
                // Nothing was different: what waited is free.
                if role.held() == 0 {
                    continue;
                }
                return;
            };
            let hasty = self.mutant == Some(Mutant::AckBeforePersist);
            if hasty {
                role.release();
            }
            node.writings += 1;
            let writings = node.writings;
            let chance = [11, writings, who.index() as u64];
            if drawn(self.scenario.seed, chance).is_multiple_of(RECALL_EVERY) && !self.lies() {
                self.recalls(who, &rows);
            }
            self.nodes[who.index()].writing = Some(rows);
            if self.begins_writing(who) {
                return;
            }
            let most = self.scenario.writing.0;
            let mut takes = Time(self.draw(1, most + 1));
            if let Some((until, slow)) = self.nodes[who.index()].slow
                && until > now
            {
                takes = slow;
            }
            self.after(takes, Due::Written { who, epoch });
            if !hasty {
                return;
            }
        }
    }

    fn written(&mut self, who: Who, epoch: u64) {
        let now = self.now;
        let node = &mut self.nodes[who.index()];
        if node.epoch != epoch || node.role.is_none() {
            return;
        }
        if let Some((_, until)) = node.frozen {
            return self.plan(until, Due::Written { who, epoch });
        }
        if node.full_until > now {
            let rows = node.writing.as_deref().unwrap_or_default();
            if let Err(error) = node.store.write_in_vain(rows) {
                return self.broken(|| format!("the journal of {who}: {error}"));
            }
            // Whoever waits is told that nothing is acknowledged; to us that is as if it were lost.
            if let Some(role) = &mut node.role {
                role.refuse_waiting();
            }
            return self.after(TRY_AGAIN, Due::Written { who, epoch });
        }
        let Some(rows) = node.writing.take() else {
            return;
        };
        let lies = match self.mutant {
            Some(Mutant::SkipTheJournal) => true,
            Some(Mutant::LyingDisk) => node.writings % 8 == 7,
            _ => false,
        };
        if !lies && let Err(error) = node.store.write(&rows) {
            return self.broken(|| format!("the journal of {who}: {error}"));
        }
        if let Some(role) = &mut node.role {
            role.written();
        }
        if who == Who::Parent {
            self.owes_nothing();
        }
        self.count("writings");
        self.pump(who);
    }

    /// Whether the journal is not what was written, or was not found so: comparing would tell
    /// nothing of the machines then.
    fn lies(&self) -> bool {
        matches!(
            self.mutant,
            Some(
                Mutant::SkipTheJournal
                    | Mutant::LyingDisk
                    | Mutant::TornWriting
                    | Mutant::LoseTheOutbox
                    | Mutant::ResetNumbers
                    | Mutant::ForgetTheInbox
                    | Mutant::NewLineAtEveryStart
                    | Mutant::LoseAGoal
            )
        )
    }

    /// Whether the process dies at this point of sending.
    fn tick(&mut self, who: Who, before: bool) -> bool {
        let node = &mut self.nodes[who.index()];
        let Some((_, Point::Sending { nth, after }, down)) = &mut node.armed else {
            return false;
        };
        if *after == before {
            return false;
        }
        if *nth > 0 {
            *nth -= 1;
            return false;
        }
        let down = *down;
        self.crash(who, false, down);
        true
    }

    /// Whether the process dies while it writes this.
    fn begins_writing(&mut self, who: Who) -> bool {
        let node = &mut self.nodes[who.index()];
        let Some((_, Point::Writing { nth, kept }, down)) = &mut node.armed else {
            return false;
        };
        if *nth > 0 {
            *nth -= 1;
            return false;
        }
        let (kept, down) = (*kept, *down);
        self.crash(who, kept, down);
        true
    }

    // ---- what goes out -------------------------------------------------------------------------

    fn send_effect(&mut self, who: Who, epoch: u64, effect: AnyEffect) {
        match effect {
            Effect::Instruct { to, message } => {
                let Some(to) = Who::of(to.as_str()) else {
                    return;
                };
                let seq = message.seq;
                self.enqueue(
                    who,
                    Kind::Instruction,
                    to,
                    seq,
                    Message::Instruction(message),
                );
            }
            Effect::StopAhead { to, message } => {
                if let Some(to) = Who::of(to.as_str()) {
                    self.send(who, to, Message::StopAhead(message));
                }
            }
            Effect::Report { to, message } => {
                let Some(to) = Who::of(to.as_str()) else {
                    return;
                };
                let seq = message.seq;
                self.enqueue(who, Kind::Report, to, seq, Message::Report(message));
            }
            Effect::Local(message) => {
                if let Some(ticket) = begun_by(&message.body) {
                    self.law.commanded(epoch, ticket);
                }
                let seq = message.seq;
                self.enqueue(who, Kind::Local, Who::World, seq, Message::Command(message));
            }
            Effect::Observed { facts, reported_to } => {
                let node = &mut self.nodes[who.index()];
                node.board.tell(&facts);
                let seq = node.board.seq;
                for to in superiors(who, self.scenario.two_children) {
                    let facts = facts.clone();
                    let reported = reported_to.as_ref().is_some_and(|by| *by == to.name());
                    let all = false;
                    let message = Message::Facts {
                        epoch,
                        seq,
                        facts,
                        reported,
                        all,
                    };
                    self.send(who, *to, message);
                }
            }
            Effect::Event { number, event } => {
                self.tell(|| {
                    let goal = event.goal.as_ref().map_or("", Symbol::as_str);
                    format!(
                        "{who:<9} event {number} {goal} [{}] {:?}",
                        event.stack_depth, event.what
                    )
                });
            }
            Effect::Respond { to, response, line } => self.respond(who, to, response, line),
        }
    }

    fn respond(&mut self, who: Who, to: Way, response: Response, line: u64) {
        match to {
            Way::User(request) => {
                let goal = self.requests[request as usize].goal;
                if let Response::Goal(Ok(id)) = &response {
                    let id = id.clone();
                    self.law.acknowledged(&id, line);
                    self.count("goals acknowledged");
                }
                self.tell(|| format!("{who:<9} answers about goal{goal}: {response:?}"));
                self.send(who, Who::User, Message::Verdict(request));
            }
            Way::Neighbour {
                who: to,
                epoch,
                kind,
            } => {
                let message = Message::Response {
                    epoch,
                    kind,
                    response,
                    line,
                };
                self.send(who, to, message);
            }
        }
    }

    fn enqueue(&mut self, who: Who, kind: Kind, to: Who, seq: u64, message: Message) {
        let channels = &mut self.nodes[who.index()].channels;
        let at = channels
            .iter()
            .position(|channel| channel.kind == kind && channel.to == to);
        let at = at.unwrap_or_else(|| {
            channels.push(Channel::new(kind, to));
            channels.len() - 1
        });
        channels[at].queue.push_back((seq, message));
        if channels[at].queue.len() == 1 {
            channels[at].attempts = 0;
            self.attempt(who, kind, to);
        }
    }

    /// Sends the first of a channel, and sees to it that it is sent again.
    fn attempt(&mut self, who: Who, kind: Kind, to: Who) {
        let epoch = self.nodes[who.index()].epoch;
        let channel = match who {
            Who::World => Some(&mut self.world_says),
            _ => self.nodes[who.index()]
                .channels
                .iter_mut()
                .find(|channel| channel.kind == kind && channel.to == to),
        };
        let Some(channel) = channel else {
            return;
        };
        let Some((seq, message)) = channel.queue.front().cloned() else {
            return;
        };
        channel.attempts += 1;
        let attempt = channel.attempts;
        self.send(who, to, message);
        self.after(
            TIMEOUT,
            Due::Retry {
                who,
                epoch,
                kind,
                to,
                seq,
                attempt,
            },
        );
    }

    fn retry(&mut self, who: Who, epoch: u64, (kind, to): (Kind, Who), seq: u64, attempt: u32) {
        let node = &self.nodes[who.index()];
        if node.epoch != epoch || (node.role.is_none() && who != Who::World) {
            return;
        }
        if let Some((_, until)) = node.frozen {
            return self.plan(
                until,
                Due::Retry {
                    who,
                    epoch,
                    kind,
                    to,
                    seq,
                    attempt,
                },
            );
        }
        let channel = match who {
            Who::World => Some(&self.world_says),
            _ => node
                .channels
                .iter()
                .find(|channel| channel.kind == kind && channel.to == to),
        };
        let still = channel.is_some_and(|channel| {
            channel.attempts == attempt && channel.queue.front().is_some_and(|(s, _)| *s == seq)
        });
        if still {
            self.count("messages sent again");
            self.attempt(who, kind, to);
        }
    }

    /// Puts a message on the network, which may lose, repeat and delay it.
    fn send(&mut self, from: Who, to: Who, message: Message) {
        self.count("messages");
        let now = self.now;
        let spread = self.scenario.spread.0;
        let mut delay = self.scenario.delay.0 + self.draw(2, spread + 1);
        let bad = self
            .weather
            .iter()
            .find(|(until, ..)| *until > now)
            .copied();
        if self.is_cut(from, to) {
            self.count("messages lost");
            return;
        }
        if let Some((_, lost, twice, late)) = bad {
            if self.draw(3, 1000) < lost {
                self.count("messages lost");
                self.tell(|| format!("{from:<9} -> {to}: {} is lost", message.kind()));
                return;
            }
            if self.draw(4, 1000) < late {
                self.count("messages late");
                delay += self.draw(5, 3_000_000);
            }
            if self.draw(6, 1000) < twice {
                self.count("messages twice");
                let later = Time(delay + self.draw(7, 2_000_000));
                let message = message.clone();
                self.after(later, Due::Deliver { from, to, message });
            }
        }
        self.after(Time(delay), Due::Deliver { from, to, message });
    }

    fn is_cut(&self, one: Who, other: Who) -> bool {
        self.cuts.iter().any(|cut| {
            cut.until > self.now
                && ((cut.one, cut.other) == (one, other) || (cut.other, cut.one) == (one, other))
        })
    }

    // ---- what comes in -------------------------------------------------------------------------

    fn deliver(&mut self, from: Who, to: Who, message: Message) {
        match to {
            Who::User => {
                if let Message::Verdict(request) = message {
                    self.requests[request as usize].answered = true;
                }
                return;
            }
            Who::World => return self.deliver_to_world(message),
            _ => {}
        }
        let node = &mut self.nodes[to.index()];
        if node.role.is_none() {
            return;
        }
        if node.frozen.is_some() {
            node.backlog.push_back((from, message));
            return;
        }
        if self.tells && !matches!(message, Message::Response { .. }) {
            let text = in_words(&message);
            self.tell(|| format!("{from:<9} -> {to}: {text}"));
        }
        let neighbour = |epoch, kind| Way::Neighbour {
            who: from,
            epoch,
            kind,
        };
        match message {
            Message::Instruction(envelope) => {
                let way = neighbour(envelope.epoch, Kind::Instruction);
                let starts = matches!(
                    envelope.body,
                    agent_core::protocol::Instruction::Execute { .. }
                        | agent_core::protocol::Instruction::Resume { .. }
                );
                self.nodes[to.index()].instructed |= starts;
                if self.mutant == Some(Mutant::ApplyTwice) {
                    let from = envelope.from.clone();
                    let instruction = envelope.body.clone();
                    let twice = Input::Instruction { from, instruction };
                    self.give(to, Arrival::Instruction(envelope), Some(way));
                    self.give(to, Arrival::Input(twice), None);
                } else {
                    self.give(to, Arrival::Instruction(envelope), Some(way));
                }
            }
            Message::StopAhead(envelope) => self.give(to, Arrival::StopAhead(envelope), None),
            Message::Report(envelope) => self.deliver_report(from, to, envelope),
            Message::Sensor(envelope) => {
                // The world has one epoch.
                let way = neighbour(0, Kind::Local);
                self.give(to, Arrival::Local(envelope), Some(way));
            }
            Message::Response {
                epoch,
                kind,
                response,
                line,
            } => self.answered(from, to, epoch, kind, response, line),
            Message::Facts {
                epoch,
                seq,
                facts,
                reported,
                all,
            } => self.read_facts(from, to, (epoch, seq), facts, reported, all),
            Message::WhatHolds => {
                let node = &self.nodes[to.index()];
                let message = Message::Facts {
                    epoch: node.epoch,
                    seq: node.board.seq,
                    facts: node.board.all(),
                    reported: false,
                    all: true,
                };
                self.send(to, from, message);
            }
            Message::Request(request) => self.requested(to, request),
            Message::Door(change) => {
                let observed = Input::Observation(vec![change]);
                self.give(to, Arrival::Input(observed), None);
            }
            Message::Command(_) | Message::Verdict(_) => {}
        }
    }

    fn deliver_report(
        &mut self,
        from: Who,
        to: Who,
        envelope: Envelope<agent_core::protocol::ReportBody>,
    ) {
        let way = Way::Neighbour {
            who: from,
            epoch: envelope.epoch,
            kind: Kind::Report,
        };
        if self.mutant == Some(Mutant::DropTheLastReport) && envelope.body.report.is_end() {
            let node = &mut self.nodes[to.index()];
            node.ends_dropped += 1;
            if node.ends_dropped % 4 == 3 {
                let line = node.role.as_ref().map_or(0, Role::line);
                let response = Response::Applied {
                    seq: envelope.seq,
                    answer: None,
                };
                return self.respond(to, way, response, line);
            }
        }
        let (id, report) = (envelope.body.id.clone(), envelope.body.report.clone());
        self.law.learned(self.now, to, from, &envelope);
        self.give(to, Arrival::Report(envelope), Some(way));
        if self.mutant == Some(Mutant::ApplyTwice) {
            self.give(to, Arrival::Input(Input::Report { id, report }), None);
        }
    }

    /// A message of ours was answered.
    fn answered(
        &mut self,
        by: Who,
        who: Who,
        epoch: u64,
        kind: Kind,
        response: Response,
        line: u64,
    ) {
        let node = &mut self.nodes[who.index()];
        if node.epoch != epoch {
            return;
        }
        let channel = node
            .channels
            .iter_mut()
            .find(|channel| channel.kind == kind && channel.to == by);
        let Some(channel) = channel else {
            return;
        };
        let Some((first, message)) = channel.queue.front() else {
            return;
        };
        let attempts = channel.attempts;
        match response {
            Response::Applied { seq, answer } if seq == *first => {
                let instruction = match message {
                    Message::Instruction(envelope) => Some(envelope.body.clone()),
                    _ => None,
                };
                channel.queue.pop_front();
                channel.attempts = 0;
                match (kind, instruction) {
                    (Kind::Instruction, Some(instruction)) => {
                        // Without one it was answered before the sender had written it down, and
                        // the receiver was told since that it has.
                        let mut answer = answer.unwrap_or(agent_core::protocol::Answer::Accepted);
                        if self.mutant == Some(Mutant::ForgetAnswers) && attempts > 1 {
                            answer = agent_core::protocol::Answer::Accepted;
                        }
                        self.tell(|| format!("{by:<9} answers {who}: {answer:?} to {}", seq));
                        if self.law.answered(self.now, &instruction, &answer) {
                            let id = instruction.id().clone();
                            let promised = self.now;
                            self.after(BOUND, Due::Promised { id, promised });
                        }
                        let by = name(by);
                        let arrival = Arrival::Answered {
                            by,
                            line,
                            seq,
                            answer,
                        };
                        self.give(who, arrival, None);
                    }
                    (Kind::Report, _) => {
                        let by = name(by);
                        self.give(who, Arrival::Delivered { by, line, seq }, None);
                    }
                    _ => {}
                }
                self.attempt(who, kind, by);
            }
            Response::Gap { seq, .. } if seq == *first => {
                let wait = BACK_OFF[(attempts as usize).min(BACK_OFF.len() - 1)];
                let (to, attempt) = (by, attempts);
                self.after(
                    Time(wait),
                    Due::Retry {
                        who,
                        epoch,
                        kind,
                        to,
                        seq,
                        attempt,
                    },
                );
            }
            Response::Superseded { seq }
                if seq == *first && who != Who::World && kind != Kind::Local =>
            {
                self.broken(|| format!("{by} takes {who} for one that was replaced"));
            }
            _ => {}
        }
    }

    fn read_facts(
        &mut self,
        from: Who,
        to: Who,
        at: (u64, u64),
        facts: Vec<FactChange>,
        reported: bool,
        all: bool,
    ) {
        let node = &mut self.nodes[to.index()];
        let last = &mut node.read[from.index()];
        if at.1 == 0 || last.is_some_and(|last| at <= last) {
            return;
        }
        let due = match *last {
            Some((epoch, seq)) if epoch == at.0 => seq + 1,
            _ => 1,
        };
        if !all && at.1 != due {
            let epoch = node.epoch;
            return self.ask_what_holds(to, epoch, from, 0);
        }
        *last = Some(at);
        if !reported {
            self.give(to, Arrival::Input(Input::Observation(facts)), None);
        }
    }

    fn ask_what_holds(&mut self, who: Who, epoch: u64, executor: Who, attempts: u32) {
        let node = &self.nodes[who.index()];
        if node.epoch != epoch || node.role.is_none() || attempts >= 10 {
            return;
        }
        // Asked for once, it is asked for until something comes.
        let known = node.read[executor.index()];
        let its = self.nodes[executor.index()].epoch;
        if attempts > 0
            && (known.is_some_and(|(epoch, _)| epoch == its)
                || !self.nodes[executor.index()].board.is_used())
        {
            return;
        }
        self.send(who, executor, Message::WhatHolds);
        let attempts = attempts + 1;
        self.after(
            TIMEOUT,
            Due::AskAgain {
                who,
                epoch,
                executor,
                attempts,
            },
        );
    }

    // ---- users ---------------------------------------------------------------------------------

    fn request(&mut self, goal: usize, wish: Option<Wish>, insists: bool) {
        let number = self.requests.len() as u32;
        self.requests.push(Request {
            goal,
            wish,
            answered: false,
            insists,
        });
        self.user_asks(number);
    }

    fn user_asks(&mut self, number: u32) {
        let request = &self.requests[number as usize];
        if request.answered {
            return;
        }
        let insists = request.insists;
        self.send(Who::User, Who::Parent, Message::Request(number));
        if insists {
            self.after(PATIENCE, Due::UserAsks(number));
        }
    }

    fn requested(&mut self, to: Who, number: u32) {
        let request = &self.requests[number as usize];
        let (id, _, goal) = &self.goals[request.goal];
        let input = match request.wish {
            None => {
                if self.nodes[to.index()].full_until > self.now {
                    // Refused by the driver: the user asks again.
                    return;
                }
                Input::Goal(goal.clone())
            }
            Some(Wish::Suspend) => Input::Command(Command::Suspend(id.clone())),
            Some(Wish::Resume) => Input::Command(Command::Resume(id.clone())),
            Some(Wish::Cancel) => Input::Command(Command::Cancel(id.clone())),
        };
        self.give(to, Arrival::Input(input), Some(Way::User(number)));
    }

    // ---- the world -----------------------------------------------------------------------------

    fn deliver_to_world(&mut self, message: Message) {
        match message {
            Message::Command(envelope) => {
                let response = match self.world_hears.receive(&envelope) {
                    Receipt::New { .. } => {
                        self.world_hears.applied(&envelope, None);
                        self.world_epoch = envelope.epoch;
                        let seq = envelope.seq;
                        let text = format!("{:?}", envelope.body);
                        self.tell(|| format!("world     is told {text}"));
                        self.world
                            .handle(self.now, Input::Local(envelope.body.clone()));
                        self.hear_the_world();
                        Response::Applied { seq, answer: None }
                    }
                    Receipt::Again(_) => Response::Applied {
                        seq: envelope.seq,
                        answer: None,
                    },
                    Receipt::Old => Response::Superseded { seq: envelope.seq },
                    Receipt::Gap { due } => Response::Gap {
                        seq: envelope.seq,
                        due,
                    },
                };
                let message = Message::Response {
                    epoch: envelope.epoch,
                    kind: Kind::Local,
                    response,
                    line: 1,
                };
                self.send(Who::World, Who::Executor, message);
            }
            Message::Response {
                response: Response::Applied { seq, .. },
                ..
            } if self.world_says.is_first(seq) => {
                self.world_says.queue.pop_front();
                self.world_says.attempts = 0;
                self.attempt(Who::World, Kind::Local, Who::Executor);
            }
            Message::Door(change) => {
                self.world
                    .handle(self.now, Input::Observation(vec![change]));
                self.hear_the_world();
            }
            _ => {}
        }
    }

    /// Takes what the sensors say.
    fn hear_the_world(&mut self) {
        while let Some(output) = self.world.poll_output() {
            let Output::Local(sensor) = output else {
                continue;
            };
            if matches!(sensor, Sensor::Pose(_)) {
                // For displays.
                continue;
            }
            let epoch = self.world_epoch;
            // What a process has commanded that is no more may still come before the halt of the next.
            let node = &self.nodes[Who::Executor.index()];
            let instructed = node.instructed || epoch != node.epoch;
            self.tell(|| format!("world     says {sensor:?}"));
            self.law.sensed(self.now, epoch, &sensor, instructed);
            self.world_seq += 1;
            let seq = self.world_seq;
            let message = Message::Sensor(Envelope {
                from: name(Who::World),
                line: 1,
                epoch: 1,
                seq,
                settled: seq - 1,
                to_line: 0,
                body: sensor,
            });
            self.world_says.queue.push_back((seq, message));
            if self.world_says.queue.len() == 1 {
                self.world_says.attempts = 0;
                self.attempt(Who::World, Kind::Local, Who::Executor);
            }
        }
    }

    // ---- who is there --------------------------------------------------------------------------

    fn look_soon(&mut self, observer: Who, subject: Who) {
        if are_neighbours(observer, subject) {
            let delay = Time(1_000 + self.draw(8, 30_000));
            self.after(delay, Due::Look { observer, subject });
        }
    }

    fn look_later(&mut self, observer: Who, subject: Who) {
        if are_neighbours(observer, subject) {
            let delay = Time(LEASE.0 + 1_000 + self.draw(9, 300_000));
            self.after(delay, Due::Look { observer, subject });
        }
    }

    fn look(&mut self, observer: Who, subject: Who) {
        let node = &self.nodes[subject.index()];
        let lease_is_over = |since: Time| self.now.since(since) >= LEASE;
        let gone = node.role.is_none()
            || node.frozen.is_some_and(|(since, _)| lease_is_over(since))
            || self.cuts.iter().any(|cut| {
                cut.until > self.now
                    && lease_is_over(cut.since)
                    && [(cut.one, cut.other), (cut.other, cut.one)].contains(&(observer, subject))
            });
        let epoch = if gone { 0 } else { node.epoch };
        let looks = &mut self.nodes[observer.index()];
        if looks.role.is_none() || looks.frozen.is_some() {
            return;
        }
        let seen = std::mem::replace(&mut looks.seen[subject.index()], epoch);
        if seen == epoch {
            return;
        }
        let own = looks.epoch;
        let name = name(subject);
        if seen != 0 {
            self.tell(|| format!("{observer:<9} sees that {subject} is gone"));
            let there = false;
            let name = name.clone();
            self.law.sees(observer, name.clone(), there);
            let gone = Input::Neighbour { name, there };
            self.give(observer, Arrival::Input(gone), None);
        }
        if epoch != 0 {
            self.tell(|| format!("{observer:<9} sees that {subject} is there"));
            let line = self.nodes[subject.index()]
                .role
                .as_ref()
                .map_or(0, Role::line);
            self.law.sees(observer, name.clone(), true);
            self.give(observer, Arrival::Appeared { name, line }, None);
            if is_superior(observer, subject) {
                self.ask_what_holds(observer, own, subject, 0);
            }
        }
    }

    // ---- what goes wrong -----------------------------------------------------------------------

    fn happening(&mut self, what: What) {
        if self.peace {
            return;
        }
        if let Some(fault) = what.fault() {
            self.count(fault);
            self.law.trouble(self.now + what.lasts());
        }
        self.tell(|| format!("--------- {what:?}"));
        let now = self.now;
        match what {
            What::Goal { goal, .. } => self.request(goal, None, true),
            What::Again { goal } => self.request(goal, None, false),
            What::Wish { wish, goal } => self.request(goal, Some(wish), false),
            What::Door { door, open } => self.door(door, open),
            What::Weather {
                lasts,
                lost,
                twice,
                late,
            } => self.weather.push((now + lasts, lost, twice, late)),
            What::Cut { one, other, lasts } => {
                self.cuts.push(Cut {
                    one,
                    other,
                    since: now,
                    until: now + lasts,
                });
                self.look_later(one, other);
                self.look_later(other, one);
                // And when it is over.
                self.after(
                    Time(lasts.0 + 5_000),
                    Due::Look {
                        observer: one,
                        subject: other,
                    },
                );
                self.after(
                    Time(lasts.0 + 5_000),
                    Due::Look {
                        observer: other,
                        subject: one,
                    },
                );
            }
            What::Crash { who, point, down } => match point {
                Point::Now => self.crash(who, false, down),
                _ => {
                    self.counter += 1;
                    let armed = self.counter;
                    self.nodes[who.index()].armed = Some((armed, point, down));
                    self.after(Time::from_secs(10.0), Due::CrashAtLast { who, armed });
                }
            },
            What::Freeze { who, lasts } => {
                if self.nodes[who.index()].role.is_some() {
                    self.nodes[who.index()].frozen = Some((now, now + lasts));
                    self.after(lasts, Due::Thaw { who });
                    for other in EVERYONE {
                        self.look_later(other, who);
                    }
                }
            }
            What::FullDisk { who, lasts } => {
                let node = &mut self.nodes[who.index()];
                node.full_until = node.full_until.max(now + lasts);
            }
            What::SlowDisk { who, lasts, takes } => {
                self.nodes[who.index()].slow = Some((now + lasts, takes));
            }
            What::LostJournal { who, down } => {
                self.crash(who, false, down);
                self.nodes[who.index()].store.lose();
                self.law.memory_lost = true;
                self.law.goals_lost |= who == Who::Parent;
            }
            What::Robot { .. } => {}
        }
    }

    fn door(&mut self, door: &str, open: bool) {
        let fact = format!("(open {door})");
        let text = if open { fact } else { format!("(not {fact})") };
        let Ok(change) = parse_fact_change(&text) else {
            return;
        };
        for who in EVERYONE {
            if who != Who::User {
                self.send(Who::User, who, Message::Door(change.clone()));
            }
        }
    }

    /// Nothing goes wrong any more, and nothing is in anybody's way.
    fn make_peace(&mut self) {
        let first = !self.peace;
        self.peace = true;
        self.weather.clear();
        self.tell(|| "--------- nothing goes wrong any more".to_owned());
        for who in self.roles() {
            let node = &mut self.nodes[who.index()];
            node.armed = None;
            node.full_until = Time::ZERO;
            node.slow = None;
            if let Some((_, until)) = &mut node.frozen {
                *until = self.now;
                self.thaw(who);
            }
            self.after(Time::ZERO, Due::Start { who });
        }
        let cuts = std::mem::take(&mut self.cuts);
        for cut in cuts {
            self.look_soon(cut.one, cut.other);
            self.look_soon(cut.other, cut.one);
        }
        if first {
            // Once everybody is there.
            self.after(Time::from_secs(10.0), Due::Peace);
            return;
        }
        for door in DOORS {
            self.door(door, true);
        }
        for goal in 0..self.goals.len() {
            if self.requests.iter().any(|request| request.goal == goal) {
                self.request(goal, Some(Wish::Resume), true);
            }
        }
    }

    /// All is quiet: nothing is left.
    fn judge(&mut self) {
        let line = self.nodes[Who::Parent.index()]
            .role
            .as_ref()
            .map_or(0, Role::line);
        let tasks: Vec<(Symbol, String)> = self
            .goals
            .iter()
            .map(|(id, task, _)| (id.clone(), task.clone()))
            .collect();
        self.law.at_the_end(self.now, &tasks, line);
        for who in self.roles() {
            let node = &self.nodes[who.index()];
            let Some(role) = &node.role else {
                self.broken(|| format!("{who} was not started again"));
                continue;
            };
            let waiting: usize = node.channels.iter().map(|c| c.queue.len()).sum();
            if role.held() > 0 || waiting > 0 {
                let held = role.held();
                self.broken(|| {
                    format!("L3: {who} holds {held} effect(s), {waiting} message(s) wait")
                });
                continue;
            }
            if let Some(agent) = role.as_agent() {
                let left: usize = agent.counts().values().sum();
                if left > 0 {
                    let counts = format!("{:?}", agent.counts());
                    self.broken(|| format!("L3: something is left at {who}: {counts}"));
                }
            }
        }
        if !self.world.stands() {
            self.broken(|| "the robot has not come to rest".to_owned());
        }
    }
}

fn goals(scenario: &Scenario) -> Vec<(Symbol, String, GoalRequest)> {
    let mut goals: Vec<Option<(Symbol, String, GoalRequest)>> = Vec::new();
    for (_, what) in &scenario.happenings {
        let What::Goal {
            goal,
            task,
            urgency,
            priority,
        } = what
        else {
            continue;
        };
        if goals.len() <= *goal {
            goals.resize(goal + 1, None);
        }
        let id = Symbol::from(format!("goal{goal}").as_str());
        let request = GoalRequest {
            id: Some(id.clone()),
            tasks: parse_tasks(task).unwrap_or_default(),
            urgency: *urgency,
            priority: *priority,
            deadline: None,
        };
        goals[*goal] = Some((id, task.clone(), request));
    }
    // Nobody asks for what is not among the happenings, but somebody may want it cancelled.
    let missing = |n: usize| {
        let id = Symbol::from(format!("goal{n}").as_str());
        let request = GoalRequest {
            id: Some(id.clone()),
            tasks: Vec::new(),
            urgency: agent_core::protocol::Urgency::Normal,
            priority: 0,
            deadline: None,
        };
        (id, String::new(), request)
    };
    let most = scenario
        .happenings
        .iter()
        .filter_map(|(_, what)| match what {
            What::Goal { goal, .. } | What::Again { goal } | What::Wish { goal, .. } => {
                Some(goal + 1)
            }
            _ => None,
        });
    let most = most.max().unwrap_or_default();
    goals.resize(most.max(goals.len()), None);
    let named = goals.into_iter().enumerate();
    named
        .map(|(n, goal)| goal.unwrap_or_else(|| missing(n)))
        .collect()
}

fn faults(scenario: &Scenario) -> Faults {
    let list = scenario.happenings.iter();
    Faults::list(list.filter_map(|(_, what)| match what {
        What::Robot { action, fault } => Some((*action, *fault)),
        _ => None,
    }))
}

/// The number of a command that moves something.
fn begun_by(command: &MotorCommand) -> Option<u64> {
    match command {
        MotorCommand::Drive { ticket, .. }
        | MotorCommand::Speak { ticket, .. }
        | MotorCommand::SetDoor { ticket, .. }
        | MotorCommand::Deed { ticket, .. } => Some(ticket.0),
        MotorCommand::Brake { .. }
        | MotorCommand::Hush { .. }
        | MotorCommand::Halt { .. }
        | MotorCommand::Look => None,
    }
}

fn superiors(who: Who, two: bool) -> &'static [Who] {
    match who {
        Who::Child | Who::East => &[Who::Parent],
        Who::Executor if two => &[Who::Child, Who::East],
        Who::Executor => &[Who::Child],
        _ => &[],
    }
}

fn is_superior(who: Who, of: Who) -> bool {
    superiors(of, true).contains(&who)
}

fn are_neighbours(one: Who, other: Who) -> bool {
    is_superior(one, other) || is_superior(other, one)
}

/// Whether there is anything of a goal in a journal, be it live or ended.
fn speak_of(rows: &Rows, goal: &Symbol) -> bool {
    let name = goal.as_str();
    rows.iter().any(|(key, value)| {
        let is_name = |part: &[u8]| part == name.as_bytes();
        key.contains(name) || value.windows(name.len()).any(is_name)
    })
}

/// What a start changes in a journal: the epoch is another, a robot halts, with a number, and what
/// was observed has been told again.
fn differs_after_a_start(key: &str) -> bool {
    ["s/epoch", "m/ticket", "m/running"].contains(&key) || key.starts_with("s/observed/")
}

/// In what a recalled agent is not as the living one.
fn unlike(living: &Role, recalled: &Role) -> Option<String> {
    let (living, recalled) = (living.as_agent()?, recalled.as_agent()?);
    let (was, is) = (living.counts(), recalled.counts());
    if was != is {
        return Some(format!("has {is:?}, and had {was:?}"));
    }
    let (was, is) = (living.executing(), recalled.executing());
    if was != is {
        return Some(format!("is having {is:?} done, and was {was:?}"));
    }
    (living.belief() != recalled.belief()).then(|| "believes something else".to_owned())
}

fn in_words(message: &Message) -> String {
    match message {
        Message::Instruction(e) => match &e.body {
            agent_core::protocol::Instruction::Execute { id, action, .. } => {
                format!("#{} execute {id} {action}", e.seq)
            }
            agent_core::protocol::Instruction::Resume { id, .. } => {
                format!("#{} resume {id}", e.seq)
            }
            other => format!("#{} {other:?}", e.seq),
        },
        Message::StopAhead(e) => format!("ahead of #{}: suspend {}", e.seq, e.body.id()),
        Message::Report(e) => format!("#{} {} {:?}", e.seq, e.body.id, e.body.report),
        other => format!("{other:?}"),
    }
}

#[cfg(test)]
mod tests {
    use executor_sim::Fault;

    use super::*;

    #[test]
    fn a_scenario_runs_twice_alike() {
        let ground = Ground::new();
        for seed in 0..20 {
            let scenario = Scenario::of(seed);
            let one = run(&ground, &scenario, None, true);
            let other = run(&ground, &scenario, None, true);
            assert_eq!(one.story, other.story);
        }
    }

    #[test]
    fn the_robots_faults_are_those_of_the_scenario() {
        let fault = Fault::RefusedSuspension;
        let mut scenario = Scenario::of(1);
        scenario.happenings = vec![(Time::ZERO, What::Robot { action: 2, fault })];
        let mut faults = faults(&scenario);
        assert_eq!(faults.next_action(), None);
        assert_eq!(faults.next_action(), Some(fault));
    }
}
