//! A parent agent on a museum of any size, whose actions all go as predicted: for counting and
//! measuring what it does.

use std::collections::{BTreeMap, VecDeque};
use std::convert::Infallible;
use std::sync::Arc;

use agent_core::agent::{Agent, Configuration};
use agent_core::language::parse_tasks;
use agent_core::model::{Action, Fact, FactChange, Time};
use agent_core::planner::Planner;
use agent_core::protocol::{
    ActionId, Answer, GoalRequest, Happening, Input, Instruction, Machine, Output, Report, Urgency,
};
use maps::{Place, Site};

/// A museum to plan in, and what is worth doing in it.
pub struct Ground {
    /// Its map.
    pub site: Arc<Site>,
    /// What a parent is made with, the robot standing at the entrance.
    pub configuration: Configuration,
    /// A node four areas away, as in the paper's table.
    pub target: String,
    /// Another node of the area that the robot starts from.
    pub nearby: String,
    /// A door on the way to the target without which there is another way.
    pub door_on_the_way: Option<String>,
    /// An open door far from all this.
    pub door_elsewhere: String,
    /// The node that is furthest away.
    pub far_end: String,
}

impl Ground {
    /// The museum of that many nodes.
    pub fn of(nodes: u32) -> Self {
        let text = maps::scaled_map(nodes, 1);
        let site = Site::from_text("scaled", &text).expect("made-up museums are in order");
        Self::on(Arc::new(site))
    }

    fn on(site: Arc<Site>) -> Self {
        let place = Place::museum();
        let wings = BTreeMap::new();
        let mut configuration =
            parent_agent::configuration(&site, place.area(), "n1", "child", wings, 1)
                .expect("there is an entrance");
        // As the paper's tables have it.
        configuration.policy.keep_what_helps = false;
        let away = areas_away(&site, &[]);
        let most = away.values().max().copied().unwrap_or_default();
        let (target, door_on_the_way) = target(&site, &areas_at(&away, 4.min(most)));
        let far_end = first_node(&site, areas_at(&away, most)[0]);
        let on_the_way = doors_to(&site, &target);
        let mut doors = doors_to(&site, &far_end);
        doors.reverse();
        doors.extend(site.doors().map(|door| door.name().to_string()));
        let door_elsewhere = doors.into_iter().find(|door| !on_the_way.contains(door));
        let entrance = areas_at(&away, 0)[0];
        let nearby = site.area(entrance).and_then(|area| area.nodes().nth(1));
        Self {
            target,
            nearby: nearby
                .expect("the entrance hall has more than an entrance")
                .to_string(),
            door_on_the_way,
            door_elsewhere: door_elsewhere.expect("not all doors are on the way"),
            far_end,
            configuration,
            site,
        }
    }

    /// All doors otherwise than they are at first, or as they are.
    pub fn all_doors(&self, as_at_first: bool) -> Vec<FactChange> {
        let doors = self.site.doors();
        doors
            .map(|door| door_change(door.name().as_str(), door.is_open_at_first() == as_at_first))
            .collect()
    }
}

fn areas_at<'a>(away: &BTreeMap<&'a str, usize>, wanted: usize) -> Vec<&'a str> {
    let there = away.iter().filter(|(_, away)| **away == wanted);
    there.map(|(area, _)| *area).collect()
}

fn first_node(site: &Site, area: &str) -> String {
    let node = site.area(area).and_then(|area| area.nodes().next());
    node.expect("no area is empty").to_string()
}

/// A node in one of these areas, and a door on the way to it that can be gone round; the first area
/// that has both, if there is one.
fn target(site: &Site, areas: &[&str]) -> (String, Option<String>) {
    let choice = |area: &str| {
        let node = first_node(site, area);
        // Through the first door the robot is going when the emergency comes.
        let mut doors = doors_to(site, &node).into_iter().skip(1);
        let around = |door: &String| areas_away(site, &[door]).contains_key(area);
        let door = doors.find(around);
        (node, door)
    };
    let choices: Vec<_> = areas.iter().take(20).map(|area| choice(area)).collect();
    let first = choices.iter().find(|(_, door)| door.is_some());
    first.unwrap_or(&choices[0]).clone()
}

/// How many areas one has to leave on the way from the entrance to each area that can be reached
/// with these doors closed, beside those that are closed at first.
fn areas_away<'a>(site: &'a Site, closed: &[&str]) -> BTreeMap<&'a str, usize> {
    let entrance = site.node("n1").map_or("", |node| node.area().as_str());
    let mut found = BTreeMap::from([(entrance, 0)]);
    let mut beyond: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for door in site.doors().filter(|door| door.is_open_at_first()) {
        if !closed.contains(&door.name().as_str()) {
            let [one, other] = door.joins().map(|area| area.as_str());
            beyond.entry(one).or_default().push(other);
            beyond.entry(other).or_default().push(one);
        }
    }
    let mut open = VecDeque::from([entrance]);
    while let Some(area) = open.pop_front() {
        let away = found[area] + 1;
        for next in beyond.get(area).into_iter().flatten() {
            if !found.contains_key(next) {
                found.insert(next, away);
                open.push_back(next);
            }
        }
    }
    found
}

/// The doors on the shortest way from the entrance to a node.
fn doors_to(site: &Site, node: &str) -> Vec<String> {
    let open = |door: &str| site.door(door).is_some_and(|door| door.is_open_at_first());
    let route = site
        .route("n1", node, |passage| {
            passage.door().is_none_or(|door| open(door.as_str()))
        })
        .expect("the open doors lead everywhere");
    let steps = route.nodes.windows(2);
    steps
        .filter_map(|step| {
            let mut ways = site.neighbours(step[0].as_str());
            let passage = ways.find(|(_, next)| *next.name() == step[1])?.0;
            passage.door().map(ToString::to_string)
        })
        .collect()
}

/// A door opens or closes.
pub fn door_change(door: &str, open: bool) -> FactChange {
    let fact = Fact::new("open", [door]);
    match open {
        true => FactChange::Add(fact),
        false => FactChange::Remove(fact),
    }
}

/// An agent whose executor does as it is told.
pub struct Rig<P> {
    /// The agent.
    pub agent: Agent<P>,
    /// What the executor is doing.
    pub doing: Option<(ActionId, Action)>,
    /// What the agent has said since this was last emptied.
    pub happened: Vec<Happening>,
    suspend: bool,
    goals: u32,
}

impl<P: Planner> Rig<P> {
    /// An agent that stands at the entrance and has nothing to do.
    pub fn new(ground: &Ground, planner: P) -> Self {
        Self {
            agent: Agent::new(ground.configuration.clone(), planner),
            doing: None,
            happened: Vec::new(),
            suspend: false,
            goals: 0,
        }
    }

    /// Gives the agent an input and takes what it says, without letting it think any further.
    pub fn give(&mut self, input: Input<Infallible>) {
        self.agent.handle(Time::ZERO, input);
        while let Some(output) = self.agent.poll_output() {
            match output {
                Output::Instruct { instruction, .. } => self.instructed(instruction),
                Output::Event(event) => self.happened.push(event.what),
                Output::Report { .. } | Output::Observed { .. } | Output::Seen { .. } => {}
                Output::Local(never) => match never {},
            }
        }
    }

    fn instructed(&mut self, instruction: Instruction) {
        match instruction {
            Instruction::Execute { id, action, .. } => self.doing = Some((id, action)),
            // What it was is told by the event; nobody asks the executor.
            Instruction::Resume { id, .. } => self.doing = Some((id, Action::new("resumed", []))),
            Instruction::Suspend { .. } => self.suspend = true,
            Instruction::Clear { .. } => {}
        }
    }

    /// Whether the agent wants to go on thinking.
    pub fn thinks(&self) -> bool {
        self.agent.wake_at() == Some(Time::ZERO)
    }

    /// Lets it think until it has nothing more to think about. Returns how often it was called.
    pub fn think(&mut self) -> u64 {
        let mut slices = 0;
        while self.thinks() {
            self.give(Input::Wake);
            slices += 1;
        }
        slices
    }

    /// Asks for a goal, without letting it think about it.
    pub fn ask(&mut self, task: &str, urgency: Urgency) {
        self.goals += 1;
        self.give(Input::Goal(GoalRequest {
            id: Some(format!("goal{}", self.goals).into()),
            tasks: parse_tasks(task).expect("a task in HDDL"),
            urgency,
            priority: 0,
            deadline: None,
        }));
    }

    /// Asks to go to a node, and lets it think until it goes.
    pub fn go(&mut self, node: &str, urgency: Urgency) {
        self.ask(&format!("(go {node})"), urgency);
        self.think();
    }

    /// The executor has done what it does, as predicted.
    pub fn done(&mut self) {
        if let Some((id, _)) = self.doing.take() {
            let facts = Vec::new();
            self.give(Input::Report {
                id,
                report: Report::Success { facts },
            });
        }
    }

    /// Everything goes as predicted until there is nothing to do.
    pub fn run(&mut self) {
        self.think();
        while self.doing.is_some() {
            self.done();
            self.think();
        }
    }

    /// Something more urgent comes up, and is begun once the executor has stopped.
    pub fn emergency(&mut self, node: &str) {
        self.ask(&format!("(go {node})"), Urgency::Emergency);
        self.stop();
        self.think();
    }

    /// The executor stops, if it was told to.
    pub fn stop(&mut self) {
        if std::mem::take(&mut self.suspend)
            && let Some((id, _)) = self.doing.take()
        {
            let to = Instruction::Suspend { id: id.clone() };
            self.give(Input::Answer {
                to,
                answer: Answer::Suspending,
            });
            let facts = Vec::new();
            self.give(Input::Report {
                id,
                report: Report::Suspended { facts },
            });
        }
    }

    /// Goes on until the emergency is done but for its last report: the next [`done`](Self::done)
    /// takes up what was interrupted.
    pub fn run_to_the_last_action(&mut self) {
        loop {
            self.think();
            let left = self.agent.running().and_then(|intention| {
                let plan = intention.plans.first()?;
                Some(plan.steps.len())
            });
            if left.is_none_or(|left| left <= 1) || self.doing.is_none() {
                return;
            }
            self.done();
        }
    }

    /// The nodes expanded for what was taken up or planned last, since [`happened`](Self::happened)
    /// was last emptied.
    pub fn expanded(&self) -> u64 {
        let expanded = self.happened.iter().rev().find_map(|what| match what {
            Happening::GoalResumed { expanded, .. } | Happening::PlanSelected { expanded, .. } => {
                Some(*expanded)
            }
            _ => None,
        });
        expanded.unwrap_or_default()
    }
}
