//! A small floor, a small domain, and a superior that writes everything down.

use std::collections::BTreeMap;

use agent_core::model::{
    Action, ActionModel, Atom, Belief, Domain, Effect, ExecutionModel, FactChange, Number,
    Operator, Parameter, Pattern, Suspension, Symbol, Term, Time,
};
use agent_core::protocol::{
    ActionId, Answer, Durable, Event, Input, Instruction, Machine, Output, Reply, Report, Row, Rows,
};
use executor_sim::{Controller, Faults, Floor, MoverSpec, Passage, Place, SimulatedRobot};

/// n4 --arc7-- n1 --arc5-- n6 --arc12, door d3-- n10, and n1 --arc8-- n10, curved.
pub fn floor() -> Floor {
    let nodes = [
        ("n1", [0.0, 0.0]),
        ("n4", [-3.0, 0.0]),
        ("n6", [6.0, 0.0]),
        ("n10", [6.0, 8.0]),
    ];
    let arcs = [
        ("arc5", ["n1", "n6"], 6.0, None),
        ("arc7", ["n4", "n1"], 3.0, None),
        ("arc8", ["n1", "n10"], 15.0, None),
        ("arc12", ["n6", "n10"], 8.0, Some("d3")),
    ];
    Floor::new(
        nodes.map(|(node, at)| (node.into(), at)).into(),
        arcs.map(|(arc, ends, length_m, door)| {
            let passage = Passage {
                ends: ends.map(Symbol::from),
                length_m,
                door: door.map(Symbol::from),
            };
            (arc.into(), passage)
        })
        .into(),
        BTreeMap::from([("d3".into(), true)]),
    )
    .expect("every name leads somewhere")
}

fn pattern(name: &str, args: &[&str], parameters: &[&str]) -> Pattern {
    let args =
        args.iter().map(
            |arg| match parameters.iter().position(|parameter| parameter == arg) {
                Some(index) => Term::Variable(index),
                None => Term::Constant((*arg).into()),
            },
        );
    Pattern {
        name: name.into(),
        args: args.collect(),
    }
}

/// Action, parameters, what the robot performs, whether it can be suspended.
type Entry = (
    &'static str,
    &'static [&'static str],
    &'static [&'static str],
    bool,
);

const ACTIONS: [Entry; 8] = [
    (
        "move",
        &["?from", "?to", "?arc"],
        &["drive", "?arc", "?to"],
        true,
    ),
    (
        "return",
        &["?from", "?arc"],
        &["drive", "?arc", "?from"],
        false,
    ),
    ("leave", &["?arc", "?n"], &["drive", "?arc", "?n"], true),
    ("narrate", &["?e"], &["speak", "30"], true),
    ("hail", &["?p"], &["speak", "2"], false),
    ("shut", &["?d"], &["set-door", "?d", "closed"], false),
    ("unlock", &["?d"], &["set-door", "?d", "open"], false),
    ("hand-over", &["?x"], &["deed", "hand-over", "?x"], false),
];

pub fn domain_of(rows: &[Entry]) -> (Domain, ExecutionModel) {
    let (mut domain, mut model) = (Domain::default(), ExecutionModel::default());
    for (name, parameters, perform, suspendable) in rows {
        let parameter = |name: &&str| Parameter {
            name: (*name).into(),
            kind: "object".into(),
        };
        domain.operators.insert(
            (*name).into(),
            Operator {
                name: (*name).into(),
                parameters: parameters.iter().map(parameter).collect(),
                precondition: Vec::new(),
                effect: Effect::default(),
                cost: Number::Constant(1.0),
            },
        );
        let about = ActionModel {
            duration_s: Some(Number::Constant(5.0)),
            repeatable: perform[0] != "deed",
            perform: Some(pattern(perform[0], &perform[1..], parameters)),
            suspension: suspendable.then(|| Suspension {
                effect: Effect::default(),
                resume: pattern("resume", &[], &[]),
                rollback: None,
                reach: None,
            }),
            ..ActionModel::default()
        };
        model.actions.insert((*name).into(), about);
    }
    (domain, model)
}

pub fn domain() -> (Domain, ExecutionModel) {
    domain_of(&ACTIONS)
}

pub fn secs(seconds: f64) -> Time {
    Time::from_secs(seconds)
}

pub fn id(number: u64) -> ActionId {
    ActionId {
        agent: "child".into(),
        epoch: 1,
        number,
    }
}

pub fn atom(text: &str) -> Atom {
    let mut words = text.split_whitespace();
    let name = words.next().expect("a name");
    Atom::new(name, words)
}

/// What a journal makes of that.
pub fn write_rows(journal: &mut Rows, rows: Vec<Row>) {
    for Row { key, value } in rows {
        match value {
            Some(value) => drop(journal.insert(key, value)),
            None => drop(journal.remove(&key)),
        }
    }
}

/// The superior `child`, and the robot that it instructs.
pub struct Rig {
    pub robot: SimulatedRobot,
    pub journal: Rows,
    pub now: Time,
    /// When, of which action, what.
    pub reports: Vec<(Time, ActionId, Report)>,
    /// What other superiors got: to whom, of which action, what.
    pub elsewhere: Vec<(Symbol, ActionId, Report)>,
    pub observed: Vec<(Time, Vec<FactChange>, Option<Symbol>)>,
    pub events: Vec<Event>,
    /// What the superior holds to be true; it begins as the robot does.
    pub belief: Belief,
    /// What somebody believes who only listens to observations.
    pub bystander: Belief,
}

impl Rig {
    pub fn new(start: &str) -> Self {
        Self::with(start, Faults::none())
    }

    pub fn with(start: &str, faults: Faults) -> Self {
        let (domain, model) = domain();
        let mut robot = SimulatedRobot::new(
            &domain,
            &model,
            floor(),
            MoverSpec::default(),
            Place::at(start),
            faults,
        )
        .expect("a sound robot");
        let mut belief = Belief::default();
        belief.apply_all(&robot.announcement());
        Self {
            robot,
            journal: Rows::new(),
            now: Time::ZERO,
            reports: Vec::new(),
            elsewhere: Vec::new(),
            observed: Vec::new(),
            events: Vec::new(),
            bystander: belief.clone(),
            belief,
        }
    }

    fn drain(&mut self) {
        while let Some(output) = self.robot.poll_output() {
            match output {
                Output::Report { to, id, report } if to == "child" => {
                    if let Report::Success { facts }
                    | Report::Failure { facts, .. }
                    | Report::Unknown { facts, .. }
                    | Report::Suspended { facts } = &report
                    {
                        self.belief.apply_all(facts);
                    }
                    self.reports.push((self.now, id, report));
                }
                Output::Report { to, id, report } => self.elsewhere.push((to, id, report)),
                Output::Observed { facts, reported_to } => {
                    self.bystander.apply_all(&facts);
                    if reported_to.as_ref().is_none_or(|to| *to != "child") {
                        self.belief.apply_all(&facts);
                    }
                    self.observed.push((self.now, facts, reported_to));
                }
                Output::Seen { to, .. } => unreachable!("a robot of one has no secrets for {to}"),
                Output::Event(event) => self.events.push(event),
                Output::Instruct { to, .. } => unreachable!("a robot instructs nobody, not {to}"),
            }
        }
    }

    /// Lets time pass, event by event.
    pub fn until(&mut self, seconds: f64) -> &mut Self {
        let end = secs(seconds);
        assert!(end >= self.now, "time does not go back");
        while let Some(due) = self.robot.wake_at().filter(|due| *due <= end) {
            self.now = self.now.max(due);
            let _ = self.robot.handle(self.now, Input::Wake);
            self.drain();
        }
        self.now = end;
        self
    }

    pub fn instruct_as(&mut self, from: &str, instruction: Instruction) -> Answer {
        let input = Input::Instruction {
            from: from.into(),
            instruction,
        };
        let reply = self.robot.handle(self.now, input);
        self.drain();
        let Some(Reply::Instruction(answer)) = reply else {
            unreachable!("an instruction is answered: {reply:?}");
        };
        answer
    }

    pub fn execute(&mut self, number: u64, action: &str) -> Answer {
        let action: Action = atom(action);
        self.instruct_as(
            "child",
            Instruction::Execute {
                id: id(number),
                action,
                map: None,
            },
        )
    }

    pub fn suspend(&mut self, number: u64) -> Answer {
        self.instruct_as("child", Instruction::Suspend { id: id(number) })
    }

    pub fn resume(&mut self, number: u64) -> Answer {
        let id = id(number);
        self.instruct_as("child", Instruction::Resume { id, map: None })
    }

    pub fn clear(&mut self, number: u64) -> Answer {
        self.instruct_as("child", Instruction::Clear { id: id(number) })
    }

    /// Somebody opens or shuts a door.
    pub fn door(&mut self, door: &str, open: bool) -> &mut Self {
        let fact = Atom::new("open", [door]);
        let change = if open {
            FactChange::Add(fact)
        } else {
            FactChange::Remove(fact)
        };
        let _ = self
            .robot
            .handle(self.now, Input::Observation(vec![change]));
        self.drain();
        self
    }

    /// A new process controls the robot, with nothing but what the last one wrote down.
    pub fn restart(&mut self, keep_memory: bool) {
        let (domain, model) = domain();
        let mut fresh =
            Controller::new(&domain, &model, floor(), Faults::none()).expect("a sound controller");
        if keep_memory {
            write_rows(&mut self.journal, self.robot.write_down());
            fresh.recall(&self.journal).expect("as written");
        }
        self.robot.restart_controller(self.now, fresh);
        self.drain();
    }

    /// Reports of an action except `Started`.
    pub fn told(&self, number: u64) -> Vec<&Report> {
        self.reports
            .iter()
            .filter(|(_, of, report)| *of == id(number) && *report != Report::Started)
            .map(|(_, _, report)| report)
            .collect()
    }

    /// The only report of an action except `Started`, and when it came.
    pub fn only(&self, number: u64) -> (f64, &Report) {
        let mut reports = self
            .reports
            .iter()
            .filter(|(_, of, report)| *of == id(number) && *report != Report::Started);
        let (at, _, report) = reports.next().expect("a report");
        assert_eq!(reports.next(), None, "one report too many");
        (at.secs(), report)
    }

    pub fn believes(&self, fact: &str) -> bool {
        self.belief.holds(&atom(fact))
    }

    pub fn gap_m(&self, arc: &str, node: &str) -> f64 {
        let function = Atom::new("gap", [arc, node]);
        self.belief.value(&function).expect("a gap")
    }

    pub fn place(&self) -> Place {
        self.robot.world().place(self.now)
    }

    pub fn odometer_m(&self) -> f64 {
        self.robot.world().odometer_m(self.now)
    }

    /// What superiors believe of the robot's place is so, word for word.
    #[track_caller]
    pub fn check_belief(&self) {
        assert!(self.robot.world().stands(), "it still moves");
        let floor = floor();
        let mut expected = Belief::default();
        let mut gaps = BTreeMap::new();
        match self.place() {
            Place::Node { node } => {
                expected.apply(&FactChange::Add(Atom::new("at", [node.as_str()])));
            }
            Place::Arc {
                arc,
                offset_m,
                left,
            } => {
                let passage = floor.passage(&arc).expect("an arc of the floor");
                let mut holds = vec![format!("on {arc}"), format!("left {left}")];
                let [first, second] = &passage.ends;
                gaps.insert(format!("gap {arc} {first}"), offset_m);
                gaps.insert(format!("gap {arc} {second}"), passage.length_m - offset_m);
                if let Some(door) = &passage.door {
                    let open = self.robot.world().doors()[door];
                    let middle_m = passage.length_m / 2.0;
                    if open || offset_m <= middle_m {
                        holds.push(format!("free {arc} {first}"));
                    }
                    if open || offset_m >= middle_m {
                        holds.push(format!("free {arc} {second}"));
                    }
                }
                for fact in holds {
                    expected.apply(&FactChange::Add(atom(&fact)));
                }
            }
        }
        for (door, open) in self.robot.world().doors() {
            if *open {
                expected.apply(&FactChange::Add(Atom::new("open", [door.as_str()])));
            }
        }
        for belief in [&self.belief, &self.bystander] {
            let held: Vec<_> = belief.facts().collect();
            assert_eq!(held, expected.facts().collect::<Vec<_>>());
            for (function, value_m) in &gaps {
                let held_m = belief.value(&atom(function)).expect("a gap");
                assert!((held_m - value_m).abs() < 1e-9, "{function}: {held_m}");
            }
        }
    }
}

/// Whether the report is one of success.
pub fn is_success(report: &Report) -> bool {
    matches!(report, Report::Success { .. })
}

/// Whether the report is one of suspension.
pub fn is_suspended(report: &Report) -> bool {
    matches!(report, Report::Suspended { .. })
}

/// The reason of a failure; empty for anything else.
pub fn reason(report: &Report) -> &str {
    match report {
        Report::Failure { reason, .. } => reason,
        _ => "",
    }
}
