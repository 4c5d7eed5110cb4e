//! Everything at one moment.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use agent_core::protocol::{
    ActionId, Answer, Arrival, Effect, Heard, Input, Instruction, Response, Rows, read_row,
};

use crate::arm::Arm;
use crate::boss::{Boss, goal, knows};
use crate::letter::{Letter, Side, Way};
use crate::model::{Budget, Mutant, Protocol};
use crate::node::Node;
use crate::world::{Motor, World};

/// Everything at one moment. Two moments are the same if their fingerprints are.
#[derive(Clone, Debug)]
pub struct State {
    /// The superior.
    pub boss: Arc<Node<Boss>>,
    /// The executor.
    pub arm: Arc<Node<Arm>>,
    /// What really happens.
    pub world: World,
    /// What is on the wire, in no order, and how often.
    pub wire: BTreeMap<String, (Arc<Letter>, u8)>,
    /// What the superior and the executor are to hear of each other's being there, in order: whether
    /// the neighbour is there now.
    pub notices: [VecDeque<bool>; 2],
    /// Goals that were asked for and not answered, since the superior's last start.
    pub asked: BTreeSet<usize>,
    /// Goals that were acknowledged.
    pub acked: BTreeSet<usize>,
    /// Executions of which it was acknowledged that they will not be resumed.
    pub cleared: BTreeSet<ActionId>,
    /// What may still go wrong.
    pub left: Budget,
    /// What must not be and is.
    pub broken: Option<String>,
    boss_print: u64,
    arm_print: u64,
    print: u64,
}

impl Hash for State {
    fn hash<H: Hasher>(&self, hasher: &mut H) {
        hasher.write_u64(self.print);
    }
}

impl PartialEq for State {
    fn eq(&self, other: &Self) -> bool {
        self.print == other.print
    }
}

impl Eq for State {}

impl State {
    /// Both have started, and nothing has been asked.
    pub fn first(protocol: &Protocol, boss: Node<Boss>, arm: Node<Arm>) -> Self {
        let mut state = Self {
            boss: Arc::new(boss),
            arm: Arc::new(arm),
            world: World::default(),
            wire: BTreeMap::new(),
            notices: [VecDeque::from([true]), VecDeque::from([true])],
            asked: BTreeSet::new(),
            acked: BTreeSet::new(),
            cleared: BTreeSet::new(),
            left: protocol.budget,
            broken: None,
            boss_print: 0,
            arm_print: 0,
            print: 0,
        };
        for side in [Side::Boss, Side::Arm] {
            state.notice(side);
            state.pump(protocol, side);
            while state.is_writing(side) {
                state.written(protocol, side);
            }
        }
        while !state.world.says.is_empty() {
            state.sense(protocol);
        }
        while state.is_writing(Side::Arm) {
            state.written(protocol, Side::Arm);
        }
        state.stamp(protocol, None);
        state
    }

    /// Whether that one is writing.
    pub fn is_writing(&self, side: Side) -> bool {
        match side {
            Side::Boss => self.boss.flight.is_some(),
            Side::Arm => self.arm.flight.is_some(),
        }
    }

    /// Something must not be.
    pub fn broken(&mut self, what: impl Into<String>) {
        self.broken.get_or_insert(what.into());
    }

    /// Takes letters off the wire that will never change anything: answers that nobody waits for, and
    /// messages whose receiver has written down that they are past and whose answer nobody waits for.
    pub fn sweep(&mut self) {
        let instructions = heard(&self.arm.disk, "s/in/instruction/boss");
        let reports = heard(&self.boss.disk, "s/in/report/arm");
        let of = |epoch, queue: &VecDeque<Letter>| (epoch, queue.front().map(Letter::seq));
        let boss = of(self.boss.epoch, &self.boss.queue);
        let arm = of(self.arm.epoch, &self.arm.queue);
        let answered = |(epoch, seq), (now, first): (u64, Option<u64>)| {
            epoch < now || first.is_none_or(|first| first > seq)
        };
        self.wire.retain(|_, (letter, _)| match &**letter {
            Letter::Instruction(it) => {
                let it = (it.epoch, it.seq);
                !(is_past(it, instructions) && answered(it, boss))
            }
            Letter::StopAhead(it) => !is_past((it.epoch, it.seq), instructions),
            Letter::Report(it) => {
                let it = (it.epoch, it.seq);
                !(is_past(it, reports) && answered(it, arm))
            }
            Letter::Response { to, .. } => {
                let (_, first) = match to {
                    Side::Boss => boss,
                    Side::Arm => arm,
                };
                first == Some(letter.seq())
            }
        });
    }

    /// The fingerprint again, and what can be seen to be wrong.
    pub fn stamp(&mut self, protocol: &Protocol, before: Option<&Self>) {
        if before.is_none_or(|before| !Arc::ptr_eq(&before.boss, &self.boss)) {
            let boss = self.boss.clone();
            self.examine(protocol, &boss);
            let machine = boss.station.machine();
            let absent: Vec<String> = machine.absent().iter().map(|n| n.to_string()).collect();
            self.boss_print = boss.print(&absent);
        }
        if before.is_none_or(|before| !Arc::ptr_eq(&before.arm, &self.arm)) {
            let machine = self.arm.station.machine();
            self.arm_print = self.arm.print(&machine.volatile());
            if let Some(fault) = machine.fault() {
                self.broken(fault);
            }
        }
        let mut hasher = DefaultHasher::new();
        (self.boss_print, self.arm_print, &self.world).hash(&mut hasher);
        for (key, (_, count)) in &self.wire {
            (key, count).hash(&mut hasher);
        }
        (&self.notices, &self.asked, &self.acked, &self.cleared).hash(&mut hasher);
        (self.left, &self.broken).hash(&mut hasher);
        self.print = hasher.finish();
    }

    /// S1, and the invariants of the agent itself.
    fn examine(&mut self, protocol: &Protocol, boss: &Node<Boss>) {
        let machine = boss.station.machine();
        if catch_unwind(AssertUnwindSafe(|| machine.check())).is_err() {
            self.broken("an invariant of the agent does not hold");
        }
        if self.acked.is_empty() {
            return;
        }
        match Node::start(
            "boss",
            boss.epoch + 1,
            protocol.boss(boss.epoch + 1),
            boss.disk.clone(),
        ) {
            Ok(again) => {
                for &number in &self.acked.clone() {
                    let id = goal(number);
                    if !knows(again.station.machine(), &id) {
                        self.broken(format!("S1: {id} was acknowledged and is not on the disk"));
                    }
                    if !knows(machine, &id) {
                        self.broken(format!("S1: {id} was acknowledged and is forgotten"));
                    }
                }
            }
            Err(error) => self.broken(format!("the disk cannot be read: {error}")),
        }
    }

    /// A user asks for a goal.
    pub fn ask(&mut self, protocol: &Protocol, number: usize) {
        self.asked.insert(number);
        let input = Input::Goal(crate::boss::request(number));
        Arc::make_mut(&mut self.boss).take(Arrival::Input(input), Some(Way::User(number)));
        self.pump(protocol, Side::Boss);
    }

    /// The disk is done.
    pub fn written(&mut self, protocol: &Protocol, side: Side) {
        match side {
            Side::Boss => Arc::make_mut(&mut self.boss).written(),
            Side::Arm => Arc::make_mut(&mut self.arm).written(),
        }
        self.pump(protocol, side);
    }

    /// The executor hears what the world has to say.
    pub fn sense(&mut self, protocol: &Protocol) {
        if let Some(sensor) = self.world.says.pop_front() {
            let arrival = Arrival::Input(Input::Local(sensor));
            Arc::make_mut(&mut self.arm).take(arrival, None);
            self.pump(protocol, Side::Arm);
        }
    }

    /// What is being done is done.
    pub fn finish(&mut self) {
        let action = self.world.doing.as_ref().map(|(.., action)| action.clone());
        if self.world.finish() > 1 {
            let action = action.map(|action| action.to_string()).unwrap_or_default();
            self.broken(format!("S6: {action} was done twice"));
        }
    }

    /// That one hears that its neighbour is there, or is not.
    pub fn notice(&mut self, side: Side) {
        let Some(there) = self.notices[side as usize].pop_front() else {
            return;
        };
        let name = side.other().name().into();
        match side {
            Side::Boss => {
                let line = self.arm.station.line();
                Arc::make_mut(&mut self.boss).take(presence(name, line, there), None);
            }
            Side::Arm => {
                let line = self.boss.station.line();
                Arc::make_mut(&mut self.arm).take(presence(name, line, there), None);
            }
        }
    }

    /// A letter arrives.
    pub fn deliver(&mut self, protocol: &Protocol, letter: &Letter) {
        match letter.clone() {
            Letter::Instruction(message) => {
                let epoch = message.epoch;
                let way = Some(Way::Neighbour { epoch });
                Arc::make_mut(&mut self.arm).take(Arrival::Instruction(message), way);
                self.pump(protocol, Side::Arm);
            }
            Letter::StopAhead(message) => {
                Arc::make_mut(&mut self.arm).take(Arrival::StopAhead(message), None);
                self.pump(protocol, Side::Arm);
            }
            Letter::Report(message) => {
                let epoch = message.epoch;
                let way = Some(Way::Neighbour { epoch });
                Arc::make_mut(&mut self.boss).take(Arrival::Report(message), way);
                self.pump(protocol, Side::Boss);
            }
            Letter::Response {
                to, response, line, ..
            } => {
                let queue = match to {
                    Side::Boss => &self.boss.queue,
                    Side::Arm => &self.arm.queue,
                };
                if queue
                    .front()
                    .is_some_and(|first| first.seq() == letter.seq())
                {
                    self.answered(protocol, to, response, line);
                }
            }
        }
    }

    fn answered(&mut self, protocol: &Protocol, to: Side, response: Response, line: u64) {
        match (to, response) {
            (_, Response::Superseded { seq }) => {
                self.broken(format!("S8: message {seq} of the {} is refused", to.name()));
            }
            (Side::Boss, Response::Applied { seq, answer }) => {
                let boss = Arc::make_mut(&mut self.boss);
                let sent = boss.queue.pop_front();
                let answer = answer.map(|answer| match answer {
                    Answer::Finished { .. } if protocol.mutant == Some(Mutant::NoOutcome) => {
                        Answer::Rejected {
                            reason: "it is over".to_owned(),
                        }
                    }
                    answer => answer,
                });
                if let Some(Letter::Instruction(message)) = sent
                    && let Instruction::Clear { id } = message.body
                    && !matches!(answer, Some(Answer::Rejected { .. }))
                {
                    self.cleared.insert(id);
                }
                let by = "arm".into();
                let answer = answer.unwrap_or(Answer::Accepted);
                let arrival = Arrival::Answered {
                    by,
                    line,
                    seq,
                    answer,
                };
                boss.take(arrival, None);
                let next = boss.queue.front().cloned();
                self.post(next);
                self.pump(protocol, to);
            }
            (Side::Arm, Response::Applied { seq, .. }) => {
                let arm = Arc::make_mut(&mut self.arm);
                arm.queue.pop_front();
                let by = "boss".into();
                arm.take(Arrival::Delivered { by, line, seq }, None);
                let next = arm.queue.front().cloned();
                self.post(next);
                self.pump(protocol, to);
            }
            _ => {}
        }
    }

    /// Puts a letter on the wire.
    pub fn post(&mut self, letter: Option<Letter>) {
        let Some(letter) = letter else {
            return;
        };
        let key = format!("{letter:?}");
        let entry = self.wire.entry(key);
        entry.or_insert_with(|| (Arc::new(letter), 0)).1 += 1;
    }

    /// What that one has to say goes out.
    pub fn pump(&mut self, protocol: &Protocol, side: Side) {
        let hasty = protocol.mutant == Some(Mutant::Hasty);
        match side {
            Side::Boss => {
                let effects = Arc::make_mut(&mut self.boss).effects(hasty);
                self.boss_says(effects);
            }
            Side::Arm => {
                let effects = Arc::make_mut(&mut self.arm).effects(hasty);
                self.arm_says(effects);
            }
        }
    }

    /// These effects of the superior get out.
    pub fn boss_says<O>(&mut self, effects: Vec<Effect<O, Way>>) {
        for effect in effects {
            match effect {
                Effect::Instruct { message, .. } => {
                    let letter = Letter::Instruction(message);
                    let queue = &mut Arc::make_mut(&mut self.boss).queue;
                    queue.push_back(letter.clone());
                    if queue.len() == 1 {
                        self.post(Some(letter));
                    }
                }
                Effect::StopAhead { message, .. } => self.post(Some(Letter::StopAhead(message))),
                Effect::Respond { to, response, line } => {
                    self.respond(Side::Arm, to, response, line)
                }
                _ => {}
            }
        }
    }

    /// These effects of the executor get out.
    pub fn arm_says(&mut self, effects: Vec<Effect<Motor, Way>>) {
        for effect in effects {
            match effect {
                Effect::Report { message, .. } => {
                    let letter = Letter::Report(message);
                    let queue = &mut Arc::make_mut(&mut self.arm).queue;
                    queue.push_back(letter.clone());
                    if queue.len() == 1 {
                        self.post(Some(letter));
                    }
                }
                Effect::Local(message) => {
                    if let Motor::Go { id, .. } = &message.body
                        && self.cleared.contains(id)
                    {
                        let what = format!("S5: {id} was cleared and starts");
                        self.broken(what);
                    }
                    if self.world.obey(message.body) {
                        self.broken("S3: two actions at once");
                    }
                }
                Effect::Respond { to, response, line } => {
                    self.respond(Side::Boss, to, response, line);
                }
                _ => {}
            }
        }
    }

    fn respond(&mut self, neighbour: Side, to: Way, response: Response, line: u64) {
        match (to, response) {
            (Way::User(number), Response::Goal(Ok(_))) => {
                self.acked.insert(number);
            }
            (Way::User(_), response) => self.broken(format!("a goal is answered {response:?}")),
            (Way::Neighbour { epoch }, response) => {
                let now = match neighbour {
                    Side::Boss => self.boss.epoch,
                    Side::Arm => self.arm.epoch,
                };
                // Nobody waits for it any more otherwise.
                if epoch == now {
                    self.post(Some(Letter::Response {
                        to: neighbour,
                        epoch,
                        response,
                        line,
                    }));
                }
            }
        }
    }
}

fn heard(disk: &Rows, key: &str) -> (u64, u64) {
    let heard = read_row::<Heard<Answer>>(disk, key).ok().flatten();
    heard.map_or((0, 0), |heard| heard.last())
}

fn is_past((epoch, seq): (u64, u64), (known, last): (u64, u64)) -> bool {
    epoch < known || epoch == known && seq <= last
}

fn presence<L>(name: agent_core::model::Symbol, line: u64, there: bool) -> Arrival<L> {
    match there {
        true => Arrival::Appeared { name, line },
        false => Arrival::Input(Input::Neighbour { name, there }),
    }
}
