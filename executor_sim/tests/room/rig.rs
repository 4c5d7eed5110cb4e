//! Superiors of the vehicles of one room, who apply what they are told to beliefs of their own.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use agent_core::language::{parse_atom, parse_fact_change};
use agent_core::model::{Action, Belief, Fact, FactChange, Symbol, Time};
use agent_core::protocol::{
    ActionId, Answer, Durable, Input, Instruction, Machine, Output, Reply, Report, Rows,
};
use executor_sim::{Deed, Room, RoomDoing, Spot};
use maps::Restaurant;

/// A room, its clock, and what its vehicles' superiors believe and have heard.
#[derive(Clone)]
pub struct Rig {
    pub room: Room,
    pub now: Time,
    pub beliefs: BTreeMap<Symbol, Belief>,
    pub reports: Vec<(Time, Symbol, ActionId, Report)>,
    pub seen: Vec<(Time, Symbol, Vec<FactChange>, bool)>,
    pub rows: Rows,
    pub over: BTreeSet<ActionId>,
    next: u64,
}

pub fn paper() -> Restaurant {
    Restaurant::of_the_paper()
}

impl Rig {
    pub fn new() -> Self {
        Self::of(Room::new(&paper()).expect("the restaurant of the paper is a room"))
    }

    pub fn of(room: Room) -> Self {
        let names: Vec<Symbol> = room.movers().map(|mover| mover.name().clone()).collect();
        let mut rig = Self {
            room,
            now: Time::ZERO,
            beliefs: names
                .iter()
                .map(|name| (name.clone(), Belief::default()))
                .collect(),
            reports: Vec::new(),
            seen: Vec::new(),
            rows: Rows::new(),
            over: BTreeSet::new(),
            next: 0,
        };
        rig.drain();
        for name in names {
            rig.tell(Input::Neighbour { name, there: true });
        }
        rig
    }

    pub fn id(vehicle: &str, number: u64) -> ActionId {
        ActionId {
            agent: vehicle.into(),
            epoch: 1,
            number,
        }
    }

    /// Has a vehicle begin something, and gives its identity and the answer.
    pub fn begin(&mut self, vehicle: &str, action: &str) -> (ActionId, Answer) {
        self.next += 1;
        let id = Self::id(vehicle, self.next);
        let answer = self.execute(vehicle, &id, action);
        (id, answer)
    }

    /// The same for what is accepted.
    pub fn start(&mut self, vehicle: &str, action: &str) -> ActionId {
        let (id, answer) = self.begin(vehicle, action);
        assert_eq!(answer, Answer::Accepted, "{vehicle} {action}");
        id
    }

    /// The same, until it has ended.
    pub fn done(&mut self, vehicle: &str, action: &str) {
        let id = self.start(vehicle, action);
        let end = self.run_until_end(&id);
        assert!(
            matches!(end, Some(Report::Success { .. })),
            "{vehicle} {action}: {end:?}"
        );
    }

    pub fn execute(&mut self, vehicle: &str, id: &ActionId, action: &str) -> Answer {
        let action = parse_action(action);
        let id = id.clone();
        let instruction = Instruction::Execute {
            id,
            action,
            map: None,
        };
        self.instruct(vehicle, instruction)
    }

    pub fn suspend(&mut self, vehicle: &str, id: &ActionId) -> Answer {
        self.instruct(vehicle, Instruction::Suspend { id: id.clone() })
    }

    pub fn resume(&mut self, vehicle: &str, id: &ActionId) -> Answer {
        let id = id.clone();
        self.instruct(vehicle, Instruction::Resume { id, map: None })
    }

    pub fn clear(&mut self, vehicle: &str, id: &ActionId) -> Answer {
        self.instruct(vehicle, Instruction::Clear { id: id.clone() })
    }

    fn instruct(&mut self, vehicle: &str, instruction: Instruction) -> Answer {
        let from = Symbol::from(vehicle);
        match self.tell(Input::Instruction { from, instruction }) {
            Some(Reply::Instruction(answer)) => answer,
            other => unreachable!("an instruction is answered, not {other:?}"),
        }
    }

    /// Something changes in the room.
    pub fn change(&mut self, fact: &str) {
        let change = parse_fact_change(fact).expect("a test writes its facts in HDDL");
        self.tell(Input::Observation(vec![change]));
    }

    pub fn tell(&mut self, input: Input<std::convert::Infallible>) -> Option<Reply> {
        let reply = self.room.handle(self.now, input);
        self.drain();
        reply
    }

    fn drain(&mut self) {
        let mut outputs = VecDeque::new();
        while let Some(output) = self.room.poll_output() {
            outputs.push_back(output);
        }
        for output in outputs {
            match output {
                Output::Report { to, id, report } => {
                    self.apply(&to, facts_of(&report));
                    if report.is_end() {
                        self.over.insert(id.clone());
                    }
                    self.reports.push((self.now, to, id, report));
                }
                Output::Seen {
                    to,
                    facts,
                    reported,
                } => {
                    if !reported {
                        self.apply(&to, &facts);
                    }
                    self.seen.push((self.now, to, facts, reported));
                }
                Output::Event(_) => {}
                other => unreachable!("a room does not say {other:?}"),
            }
        }
        for row in self.room.write_down() {
            match row.value {
                Some(value) => self.rows.insert(row.key, value),
                None => self.rows.remove(&row.key),
            };
        }
        if let Err(broken) = self.room.check() {
            unreachable!("at {}: {broken}", self.now);
        }
    }

    fn apply(&mut self, to: &Symbol, facts: &[FactChange]) {
        let belief = self.beliefs.get_mut(to);
        belief
            .expect("only vehicles are told anything")
            .apply_all(facts);
    }

    /// Lets everything happen until then.
    pub fn run_until(&mut self, until: Time) {
        while let Some(due) = self.room.wake_at().filter(|due| *due <= until) {
            self.now = self.now.max(due);
            self.tell(Input::Wake);
        }
        self.now = until;
        self.tell(Input::Wake);
    }

    pub fn run_s(&mut self, seconds: f64) {
        self.run_until(self.now + Time::from_secs(seconds));
    }

    /// Lets everything happen until that execution is over, or nothing happens any more.
    pub fn run_until_end(&mut self, id: &ActionId) -> Option<Report> {
        loop {
            if let Some(report) = self.end_of(id) {
                return Some(report.clone());
            }
            let due = self.room.wake_at()?;
            self.run_until(due);
        }
    }

    /// Lets everything happen until nothing does.
    pub fn run_to_rest(&mut self) {
        while let Some(due) = self.room.wake_at() {
            self.run_until(due);
        }
    }

    pub fn end_of(&self, id: &ActionId) -> Option<&Report> {
        self.reports_of(id).find(|report| report.is_end())
    }

    pub fn reports_of(&self, id: &ActionId) -> impl Iterator<Item = &Report> {
        let reports = self.reports.iter().filter(move |(_, _, of, _)| of == id);
        reports.map(|(_, _, _, report)| report)
    }

    pub fn suspensions_of(&self, id: &ActionId) -> usize {
        let suspended = |report: &&Report| matches!(report, Report::Suspended { .. });
        self.reports_of(id).filter(suspended).count()
    }

    pub fn believes(&self, vehicle: &str, fact: &str) -> bool {
        let belief = self.beliefs.get(&Symbol::from(vehicle));
        let belief = belief.expect("there is such a vehicle");
        belief.holds(&parse_fact(fact))
    }

    pub fn spot(&self, bottle: &str) -> &Spot {
        &self.room.things().bottle(bottle).expect("a bottle").spot
    }

    pub fn done_of(&self, what: impl Fn(&RoomDoing) -> bool) -> usize {
        self.room
            .done()
            .filter(|deed: &&Deed| what(&deed.what))
            .count()
    }

    /// The room's process dies and starts again with what it has written down.
    pub fn restart_room(&mut self, mut fresh: Room) {
        fresh
            .recall(&self.rows)
            .expect("what was written can be read");
        self.room = fresh;
        self.drain();
    }
}

pub fn facts_of(report: &Report) -> &[FactChange] {
    match report {
        Report::Success { facts }
        | Report::Failure { facts, .. }
        | Report::Unknown { facts, .. }
        | Report::Suspended { facts } => facts,
        Report::Started | Report::Progress { .. } => &[],
    }
}

pub fn parse_action(text: &str) -> Action {
    parse_atom(text).expect("a test writes its actions in HDDL")
}

pub fn parse_fact(text: &str) -> Fact {
    match parse_fact_change(text) {
        Ok(FactChange::Add(fact)) => fact,
        other => unreachable!("a test writes its facts in HDDL, not {other:?}"),
    }
}
