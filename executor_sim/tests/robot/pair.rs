//! A controller that dies, a world that does not, and the wires between them.

use std::collections::{BTreeMap, VecDeque};

use agent_core::model::{Action, FactChange, Time};
use agent_core::protocol::{
    ActionId, Answer, Arrival, Durable, Effect, Envelope, Input, Instruction, Report, ReportBody,
    Response, Rows, Station, read_row,
};
use executor_sim::{
    Controller, Doing, Done, Faults, MotorCommand, MoverSpec, Place, Sensor, World,
};

use crate::rig::{atom, domain, floor, id, write_rows};

/// Who waits for a response.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Waiting {
    Superior,
    /// The world's process of that epoch.
    World(u64),
}

/// The world, its robot's controller with a journal, and the superior `child`.
///
/// Nothing is delivered by itself: whoever drives a test says what happens next.
pub struct Pair {
    pub now: Time,
    epoch: u64,
    faults: Faults,
    pub world: Station<World, ()>,
    pub robot: Station<Controller, Waiting>,
    journal: Rows,
    reality: Rows,
    /// On their way to the world; they die with the controller, or come late.
    pub commands: VecDeque<Envelope<MotorCommand>>,
    /// Those that the world has got at this very moment: it may not have acknowledged them yet.
    just_heard: VecDeque<Envelope<MotorCommand>>,
    /// All that was ever done, by whatever world.
    pub done: Vec<Done>,
    seen: u64,
    /// From the world, repeated until the controller has acknowledged them.
    pub sensors: VecDeque<Envelope<Sensor>>,
    /// To the robot, repeated until they are answered.
    pub instructions: VecDeque<Envelope<Instruction>>,
    next_instruction: u64,
    /// What the superior has got, each once and in order.
    pub answers: Vec<(Instruction, Answer)>,
    pub reports: Vec<(ActionId, Report)>,
    /// How many commands have set something going.
    begun: usize,
    /// Whether this controller has heard that the robot stands.
    stood: bool,
    /// Whether the superior is there, as whoever starts hears.
    superior: bool,
    last_report: u64,
    /// Facts that were told to all.
    pub observed: Vec<FactChange>,
}

fn controller(faults: &Faults) -> Controller {
    let (domain, model) = domain();
    Controller::new(&domain, &model, floor(), faults.clone()).expect("a sound controller")
}

impl Pair {
    pub fn new(start: &str) -> Self {
        Self::with(start, Faults::none(), true)
    }

    pub fn with(start: &str, faults: Faults, hindsight: bool) -> Self {
        let world = World::new(floor(), MoverSpec::default(), Place::at(start));
        let mut world = world.expect("a sound world");
        if !hindsight {
            world = world.without_hindsight();
        }
        let mut pair = Self {
            now: Time::ZERO,
            epoch: 1,
            world: Station::new("world".into(), 1, world),
            robot: Station::new("executor".into(), 1, controller(&faults)),
            faults,
            journal: Rows::new(),
            reality: Rows::new(),
            commands: VecDeque::new(),
            just_heard: VecDeque::new(),
            done: Vec::new(),
            seen: 0,
            sensors: VecDeque::new(),
            instructions: VecDeque::new(),
            next_instruction: 1,
            answers: Vec::new(),
            reports: Vec::new(),
            begun: 0,
            stood: false,
            superior: true,
            last_report: 0,
            observed: Vec::new(),
        };
        pair.world_says();
        pair.robot_says();
        pair
    }

    /// What the world has to say goes on the wire.
    fn world_says(&mut self) {
        let world = self.world.machine();
        let news = world.done().filter(|done| done.number > self.seen);
        self.done.extend(news.cloned());
        self.seen = world.done_count();
        self.world.release();
        while let Some(effect) = self.world.poll_effect() {
            if let Effect::Local(message) = effect {
                self.sensors.push_back(message);
            }
        }
    }

    /// What may leave the controller's process does. Nothing is lost between process and superior:
    /// that wire is the station's own affair.
    pub fn robot_says(&mut self) {
        while let Some(effect) = self.robot.poll_effect() {
            match effect {
                Effect::Local(command) => {
                    self.check_command(&command.body);
                    self.commands.push_back(command);
                }
                Effect::Report { message, .. } => self.reported(message),
                Effect::Observed { facts, .. } => self.observed.extend(facts),
                Effect::Respond { to, response, .. } => self.responded(to, response),
                Effect::Event { .. }
                | Effect::Seen { .. }
                | Effect::Instruct { .. }
                | Effect::StopAhead { .. } => {}
            }
        }
        assert!(
            self.begun <= self.accepted(),
            "something was begun that nobody has asked for"
        );
    }

    /// What sets something going was written down before, and comes from a robot that stands.
    fn check_command(&mut self, command: &MotorCommand) {
        let (MotorCommand::Drive { ticket, .. }
        | MotorCommand::Speak { ticket, .. }
        | MotorCommand::SetDoor { ticket, .. }
        | MotorCommand::Deed { ticket, .. }) = command
        else {
            assert!(command.is_stop());
            return;
        };
        let written: Option<u64> = read_row(&self.journal, "m/ticket").expect("a number");
        assert!(
            written >= Some(ticket.0),
            "{command:?} before it was written down"
        );
        assert!(self.stood, "{command:?} from a robot that may roll");
        self.begun += 1;
    }

    /// How often something was asked for and granted.
    fn accepted(&self) -> usize {
        let answers = self.answers.iter();
        answers
            .filter(|(instruction, answer)| {
                let begins = matches!(
                    instruction,
                    Instruction::Execute { .. } | Instruction::Resume { .. }
                );
                begins && *answer == Answer::Accepted
            })
            .count()
    }

    fn reported(&mut self, message: Envelope<ReportBody>) {
        if message.seq == self.last_report + 1 {
            self.last_report = message.seq;
            self.reports.push((message.body.id, message.body.report));
        }
        let delivered = Arrival::Delivered {
            by: "child".into(),
            line: 1,
            seq: message.seq,
        };
        self.robot.handle(self.now, delivered, None);
    }

    fn responded(&mut self, to: Waiting, response: Response) {
        let Response::Applied { seq, answer } = response else {
            return;
        };
        match to {
            Waiting::World(epoch) => {
                let front = self.sensors.front();
                if front.is_some_and(|front| (front.epoch, front.seq) == (epoch, seq)) {
                    self.sensors.pop_front();
                }
            }
            Waiting::Superior => {
                if self
                    .instructions
                    .front()
                    .is_none_or(|front| front.seq != seq)
                {
                    return;
                }
                if let (Some(message), Some(answer)) = (self.instructions.pop_front(), answer) {
                    self.answers.push((message.body, answer));
                }
            }
        }
    }

    /// What the controller has decided is on the disk.
    pub fn commit(&mut self) {
        if let Some(rows) = self.robot.write_down() {
            write_rows(&mut self.journal, rows);
            self.robot.written();
        }
        self.robot_says();
    }

    /// The first sensor message on the wire gets there (and stays until it is acknowledged).
    pub fn sense(&mut self) {
        if let Some(message) = self.sensors.front().cloned() {
            let from = Waiting::World(message.epoch);
            self.stood |= matches!(message.body, Sensor::Halted { .. });
            self.arrive(Arrival::Local(message), Some(from));
        }
    }

    pub fn hear(&mut self) {
        if let Some(message) = self.instructions.front().cloned() {
            self.arrive(Arrival::Instruction(message), Some(Waiting::Superior));
        }
    }

    pub fn arrive(&mut self, arrival: Arrival<Sensor>, from: Option<Waiting>) {
        self.robot.handle(self.now, arrival, from);
        self.robot_says();
    }

    /// The first command on the wire gets to the motors.
    pub fn command(&mut self) {
        if let Some(command) = self.commands.pop_front() {
            self.just_heard.push_back(command.clone());
            self.world.handle(self.now, Arrival::Local(command), None);
            self.world_says();
        }
    }

    pub fn instruct(&mut self, instruction: Instruction) {
        self.instructions.push_back(Envelope {
            from: "child".into(),
            line: 1,
            epoch: 1,
            seq: self.next_instruction,
            settled: 0,
            to_line: 0,
            body: instruction,
        });
        self.next_instruction += 1;
    }

    pub fn execute(&mut self, number: u64, action: &str) {
        let action: Action = atom(action);
        self.instruct(Instruction::Execute {
            id: id(number),
            action,
            map: None,
        });
    }

    /// The world goes on until then; nobody hears of it yet.
    pub fn pass(&mut self, seconds: f64) {
        let until = self.now + Time::from_secs(seconds);
        if until > self.now {
            self.just_heard.clear();
        }
        while let Some(due) = self.world.wake_at().filter(|due| *due <= until) {
            self.now = self.now.max(due);
            self.world
                .handle(self.now, Arrival::Input(Input::Wake), None);
            self.world_says();
        }
        self.now = until;
        if self.robot.wake_at().is_some_and(|due| due <= until) {
            self.arrive(Arrival::Input(Input::Wake), None);
        }
    }

    /// Everything that is on its way arrives, and is written down.
    pub fn settle(&mut self) {
        for _ in 0..1000 {
            self.commit();
            if self.commands.is_empty() && self.sensors.is_empty() && self.instructions.is_empty() {
                return;
            }
            self.command();
            self.sense();
            self.hear();
        }
        unreachable!("it comes to no rest");
    }

    /// Everything arrives, for so long.
    pub fn live(&mut self, seconds: f64) {
        let until = self.now + Time::from_secs(seconds);
        self.settle();
        while self.now < until {
            let dues = [self.world.wake_at(), self.robot.wake_at()];
            let due = dues.into_iter().flatten().min();
            let due = due.map_or(until, |due| due.clamp(self.now, until));
            self.pass(due.since(self.now).secs());
            self.now = due;
            self.settle();
        }
    }

    /// The controller's process dies, and another one takes its place with what is on the disk.
    /// `late` of the commands on the wire still get to the world, some time.
    pub fn die(&mut self, late: bool) {
        if !late {
            self.commands.clear();
        }
        self.just_heard.clear();
        self.epoch += 1;
        self.stood = false;
        let fresh = controller(&self.faults);
        self.robot = Station::recall("executor".into(), self.epoch, fresh, &self.journal)
            .expect("what was written down can be read");
        if self.superior {
            self.superior_is_there(true);
        }
        self.robot_says();
    }

    /// The superior has appeared or vanished.
    pub fn superior_is_there(&mut self, there: bool) {
        self.superior = there;
        let name = "child".into();
        self.arrive(Arrival::Input(Input::Neighbour { name, there }), None);
    }

    /// The controller's process dies, and its journal is lost with it.
    pub fn forget(&mut self) {
        self.journal.clear();
        (self.next_instruction, self.last_report) = (1, 0);
        self.die(false);
    }

    /// Whether that is to hand something over.
    pub fn is_deed(&self, number: u64) -> bool {
        self.answers.iter().any(|(instruction, _)| {
            matches!(instruction, Instruction::Execute { id: of, action, .. }
                if *of == id(number) && action.name == "hand-over")
        })
    }

    /// What is so is on the disk of the world, which waits for nobody's.
    pub fn remember_reality(&mut self) {
        self.pass(0.0);
        self.world
            .handle(self.now, Arrival::Input(Input::Wake), None);
        self.world_says();
        if let Some(rows) = self.world.write_down() {
            write_rows(&mut self.reality, rows);
            self.world.written();
        }
    }

    /// The world's process dies with all that it had to say, and another one goes on from what is on
    /// its disk. It may have acknowledged what it had not written down: its mailboxes begin anew.
    pub fn reality_ends(&mut self) {
        let world = World::new(floor(), MoverSpec::default(), Place::at("n1"));
        let mut world = world.expect("a sound world");
        world
            .recall(&self.reality)
            .expect("what was written down can be read");
        self.epoch += 1;
        self.world = Station::new("world".into(), self.epoch, world);
        self.sensors.clear();
        self.seen = self.world.machine().done_count();
        // What was not acknowledged is sent again.
        self.just_heard.append(&mut self.commands);
        std::mem::swap(&mut self.just_heard, &mut self.commands);
        self.world_says();
    }

    /// How often the world says that it was done to the end.
    pub fn deeds(&self, what: &str) -> usize {
        let done = self.done.iter();
        done.filter(|done| done.to_the_end)
            .filter(|done| matches!(&done.what, Doing::Deed { what: deed } if *deed == atom(what)))
            .count()
    }

    /// Reports of an action, in order.
    pub fn told(&self, number: u64) -> Vec<&Report> {
        let reports = self.reports.iter().filter(|(of, _)| *of == id(number));
        reports.map(|(_, report)| report).collect()
    }

    /// How every action has ended that was accepted, by number; `None` if it has not.
    pub fn ends(&self) -> BTreeMap<u64, Option<&Report>> {
        let accepted = self.answers.iter().filter_map(|answer| match answer {
            (Instruction::Execute { id, .. }, Answer::Accepted) => Some(id.number),
            _ => None,
        });
        accepted
            .map(|number| {
                let end = self.told(number).into_iter().find(|report| report.is_end());
                (number, end)
            })
            .collect()
    }
}

/// The last thing that was said of an action.
pub fn last(pair: &Pair, number: u64) -> &Report {
    pair.told(number).last().expect("something was said")
}
