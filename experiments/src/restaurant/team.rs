//! A room and the vehicles in it, in virtual time: one clock, and messages that take no time. What they
//! do is the code of the product; only waiting is left out.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::convert::Infallible;

use agent_core::model::{FactChange, Symbol, Time};
use agent_core::protocol::{
    ActionId, Answer, Event, Input, Instruction, Machine, Output, Reply, Report,
};

use super::Noise;

/// What the room is called as an executor.
pub const ROOM: &str = "room";

/// More messages at one moment are a conversation without end.
const MOST_AT_ONCE: usize = 100_000;

/// On its way from one machine to another.
#[derive(Clone, Debug)]
enum Message<N> {
    Instruction(Instruction),
    Answer(Instruction, Answer),
    Report(ActionId, Report),
    Facts(Vec<FactChange>),
    /// From a vehicle to all others.
    Notice(N),
}

/// The room, the vehicles, and what is on its way between them.
#[derive(Clone, Debug)]
pub struct Team<R, V: Machine> {
    now: Time,
    room: R,
    vehicles: BTreeMap<Symbol, V>,
    /// Whose process has died.
    dead: BTreeSet<Symbol>,
    on_the_way: VecDeque<(Symbol, Symbol, Message<V::Out>)>,
    /// What is kept for a vehicle whose process has died: it is sent until it is acknowledged.
    kept: VecDeque<(Symbol, Symbol, Message<V::Out>)>,
    events: Vec<(Symbol, Event)>,
    /// What becomes of what vehicles say to each other; nothing, if there is none.
    noise: Option<Noise>,
    /// What arrives later, and in which order.
    late: BTreeMap<(Time, u64), (Symbol, Symbol, V::Out)>,
    /// Counts what was late.
    delayed: u64,
}

impl<R, V, N> Team<R, V>
where
    R: Machine<In = Infallible, Out = Infallible>,
    V: Machine<In = N, Out = N>,
    N: Clone,
{
    /// All there, and nothing done yet.
    pub fn new(room: R, vehicles: BTreeMap<Symbol, V>) -> Self {
        let mut team = Self {
            now: Time::ZERO,
            room,
            vehicles,
            dead: BTreeSet::new(),
            on_the_way: VecDeque::new(),
            kept: VecDeque::new(),
            events: Vec::new(),
            noise: None,
            late: BTreeMap::new(),
            delayed: 0,
        };
        let names: Vec<Symbol> = team.vehicles.keys().cloned().collect();
        for name in &names {
            team.meet(name);
        }
        team
    }

    /// The same, with chance in what vehicles say to all others from now on. What is instructed, answered
    /// and reported is delivered once and in order, as ever.
    #[must_use]
    pub fn with_noise(mut self, noise: Noise) -> Self {
        self.noise = Some(noise);
        self
    }

    /// The time.
    pub fn now(&self) -> Time {
        self.now
    }

    /// The reality.
    pub fn room(&self) -> &R {
        &self.room
    }

    /// A vehicle that is alive.
    pub fn vehicle(&self, name: &str) -> Option<&V> {
        self.vehicles.get(&Symbol::from(name))
    }

    /// What was told since this was asked last, and by whom.
    pub fn take_events(&mut self) -> Vec<(Symbol, Event)> {
        std::mem::take(&mut self.events)
    }

    /// Tells a vehicle, or the room, something from outside.
    pub fn tell(&mut self, whom: &str, input: Input<N>) -> Option<Reply> {
        let reply = self.hand(&Symbol::from(whom), input);
        self.deliver();
        reply
    }

    /// Something changes in the room.
    pub fn change(&mut self, changes: Vec<FactChange>) {
        let _ = self.hand(&Symbol::from(ROOM), Input::Observation(changes));
        self.deliver();
    }

    /// A vehicle's process dies. Its body stays where it is.
    pub fn kill(&mut self, name: &str) -> Option<V> {
        let name = Symbol::from(name);
        let gone = self.vehicles.remove(&name)?;
        self.dead.insert(name.clone());
        self.neighbours(&name, |name| Input::Neighbour { name, there: false });
        Some(gone)
    }

    /// It is started again; `remembers` says whether it knows what was before.
    pub fn restart(&mut self, name: &str, vehicle: V, remembers: bool) {
        let name = Symbol::from(name);
        self.dead.remove(&name);
        self.vehicles.insert(name.clone(), vehicle);
        let kept = std::mem::take(&mut self.kept);
        let (own, others): (VecDeque<_>, VecDeque<_>) =
            kept.into_iter().partition(|(_, to, _)| *to == name);
        self.kept = others;
        if remembers {
            self.on_the_way.extend(own);
        } else {
            self.neighbours(&name, |name| Input::Reborn { name });
        }
        self.meet(&name);
    }

    /// Everybody learns that somebody is there, who learns the same of everybody.
    fn meet(&mut self, name: &Symbol) {
        self.neighbours(name, |name| Input::Neighbour { name, there: true });
        let others: Vec<Symbol> = self.vehicles.keys().cloned().collect();
        let others = others.into_iter().chain([Symbol::from(ROOM)]);
        for other in others.filter(|other| other != name) {
            let there = true;
            let _ = self.hand(name, Input::Neighbour { name: other, there });
        }
        self.deliver();
    }

    fn neighbours(&mut self, about: &Symbol, input: impl Fn(Symbol) -> Input<N>) {
        let others: Vec<Symbol> = self.vehicles.keys().cloned().collect();
        for other in others.into_iter().chain([Symbol::from(ROOM)]) {
            if other != *about {
                let _ = self.hand(&other, input(about.clone()));
            }
        }
        self.deliver();
    }

    /// Lets the next thing happen, if anything does before that time. Returns whether it did.
    pub fn step(&mut self, until: Time) -> bool {
        let mut due = vec![(self.room.wake_at(), Symbol::from(ROOM))];
        let vehicles = self.vehicles.iter();
        due.extend(vehicles.map(|(name, vehicle)| (vehicle.wake_at(), name.clone())));
        let next = due.into_iter().filter_map(|(at, who)| Some((at?, who)));
        let next = next.map(|(at, who)| (at.max(self.now), who)).min();
        let late = self.late.first_key_value().map(|(key, _)| *key);
        if let Some(key) = late.filter(|(at, _)| next.as_ref().is_none_or(|(next, _)| at <= next))
            && key.0 <= until
            && let Some((from, to, notice)) = self.late.remove(&key)
        {
            self.now = self.now.max(key.0);
            self.on_the_way
                .push_back((from, to, Message::Notice(notice)));
            self.deliver();
            return true;
        }
        let Some((at, who)) = next else {
            return false;
        };
        if at > until {
            return false;
        }
        self.now = at;
        let _ = self.hand(&who, Input::Wake);
        self.deliver();
        true
    }

    /// Lets time pass until then.
    pub fn run_until(&mut self, until: Time) {
        while self.step(until) {}
        self.now = self.now.max(until);
    }

    /// Delivers what is on its way, in the order in which it was sent.
    fn deliver(&mut self) {
        for _ in 0..MOST_AT_ONCE {
            let Some((from, to, message)) = self.on_the_way.pop_front() else {
                return;
            };
            if self.dead.contains(&to) {
                if !matches!(message, Message::Facts(_) | Message::Notice(_)) {
                    self.kept.push_back((from, to, message));
                }
                continue;
            }
            let instruction = match &message {
                Message::Instruction(instruction) => Some(instruction.clone()),
                _ => None,
            };
            let input = match message {
                Message::Instruction(instruction) => Input::Instruction {
                    from: from.clone(),
                    instruction,
                },
                Message::Answer(to, answer) => Input::Answer { to, answer },
                Message::Report(id, report) => Input::Report { id, report },
                Message::Facts(facts) => Input::Observation(facts),
                Message::Notice(notice) => Input::Local(notice),
            };
            let reply = self.hand(&to, input);
            if let (Some(instruction), Some(Reply::Instruction(answer))) = (instruction, reply) {
                let message = Message::Answer(instruction, answer);
                self.on_the_way.push_back((to, from, message));
            }
        }
    }

    /// Gives a machine an input and sends off what it says.
    fn hand(&mut self, whom: &Symbol, input: Input<N>) -> Option<Reply> {
        if whom == ROOM {
            let reply = self.room.handle(self.now, without_notice(input)?);
            while let Some(output) = self.room.poll_output() {
                self.send(whom, output, |_: &mut Self, never| match never {});
            }
            return reply;
        }
        let now = self.now;
        let vehicle = self.vehicles.get_mut(whom)?;
        let reply = vehicle.handle(now, input);
        while let Some(output) = self.vehicles.get_mut(whom)?.poll_output() {
            self.send(whom, output, |team, notice: N| {
                let others: Vec<Symbol> = team.vehicles.keys().cloned().collect();
                for other in others.into_iter().filter(|other| other != whom) {
                    team.say(whom, &other, &notice);
                }
            });
        }
        reply
    }

    /// From one vehicle to another, which may or may not hear it.
    fn say(&mut self, from: &Symbol, to: &Symbol, notice: &N) {
        let arrivals = self.noise.as_mut().map(Noise::arrivals);
        for delay in arrivals.unwrap_or_else(|| vec![Time::ZERO]) {
            let (from, to, notice) = (from.clone(), to.clone(), notice.clone());
            if delay == Time::ZERO {
                let message = Message::Notice(notice);
                self.on_the_way.push_back((from, to, message));
            } else {
                self.delayed += 1;
                let at = (self.now + delay, self.delayed);
                self.late.insert(at, (from, to, notice));
            }
        }
    }

    fn send<L>(&mut self, from: &Symbol, output: Output<L>, local: impl Fn(&mut Self, L)) {
        let message = match output {
            Output::Instruct { to, instruction } => (to, Message::Instruction(instruction)),
            Output::Report { to, id, report } => (to, Message::Report(id, report)),
            Output::Observed { facts, reported_to } => {
                let all: Vec<Symbol> = self.vehicles.keys().cloned().collect();
                for to in all {
                    if to != *from && Some(&to) != reported_to.as_ref() {
                        let message = Message::Facts(facts.clone());
                        self.on_the_way.push_back((from.clone(), to, message));
                    }
                }
                return;
            }
            Output::Seen { reported: true, .. } => return,
            Output::Seen { to, facts, .. } => (to, Message::Facts(facts)),
            Output::Event(event) => {
                self.events.push((from.clone(), event));
                return;
            }
            Output::Local(notice) => return local(self, notice),
        };
        self.on_the_way
            .push_back((from.clone(), message.0, message.1));
    }
}

/// Nobody tells the room notices.
fn without_notice<N>(input: Input<N>) -> Option<Input<Infallible>> {
    Some(match input {
        Input::Goal(goal) => Input::Goal(goal),
        Input::Command(command) => Input::Command(command),
        Input::Instruction { from, instruction } => Input::Instruction { from, instruction },
        Input::Answer { to, answer } => Input::Answer { to, answer },
        Input::Report { id, report } => Input::Report { id, report },
        Input::Observation(facts) => Input::Observation(facts),
        Input::Neighbour { name, there } => Input::Neighbour { name, there },
        Input::Reborn { name } => Input::Reborn { name },
        Input::Wake => Input::Wake,
        Input::Local(_) => return None,
    })
}
