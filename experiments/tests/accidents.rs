//! What can go wrong while a guest is served, at every step of it: somebody takes the bottle, the table is
//! blocked, the guest leaves. The room and its bodies are the product's.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::sync::Arc;

use agent_core::agent::{Configuration, Executors, Policy, Repair};
use agent_core::language::{parse_atom, parse_tasks};
use agent_core::model::{FactChange, Symbol, Time};
use agent_core::parallel::ParallelAgent;
use agent_core::planner::{AnyPlanner, PlannerKind, Settings};
use agent_core::protocol::{Event, GoalRequest, Happening, Input, Urgency};
use executor_sim::{Room, RoomDoing, Spot};
use experiments::{ROOM, Team};
use maps::Restaurant;

type Carrier = ParallelAgent<AnyPlanner>;

/// Two guests are served in 217 s.
const SERVING_S: u32 = 217;

fn carrier(restaurant: &Restaurant, together: usize, planner: PlannerKind) -> Carrier {
    let start = restaurant.start("k3").expect("it is there");
    let level = restaurant.level();
    let configuration = Configuration {
        name: "k3".into(),
        epoch: 1,
        domain: Arc::new(level.domain.clone()),
        model: Arc::new(level.model.clone()),
        map: start.map,
        maps_below: Arc::new(()),
        facts: start.facts.into_iter().map(FactChange::Add).collect(),
        executors: Executors::one(ROOM),
        policy: Policy {
            repair: Repair::Nearest,
            ..Policy::default()
        },
    };
    let together = NonZeroUsize::new(together).expect("at least one");
    let planner = AnyPlanner::new(planner, Settings::default());
    ParallelAgent::new(configuration, together, planner)
}

/// An evening on which cola is brought to ann at table 1 and juice to ben at table 2.
struct Evening {
    team: Team<Room, Carrier>,
    events: Vec<Event>,
}

fn change(text: &str) -> FactChange {
    match text.strip_prefix("not ") {
        Some(text) => FactChange::Remove(parse_atom(text).expect("a fact")),
        None => FactChange::Add(parse_atom(text).expect("a fact")),
    }
}

impl Evening {
    fn new(together: usize, planner: PlannerKind) -> Self {
        let restaurant = Restaurant::of_the_paper();
        let room = Room::new(&restaurant).expect("a room");
        let vehicles = BTreeMap::from([("k3".into(), carrier(&restaurant, together, planner))]);
        let mut evening = Self {
            team: Team::new(room, vehicles),
            events: Vec::new(),
        };
        evening.known(&["(seated ann table1)"]);
        evening.known(&["(seated ben table2)"]);
        evening
    }

    /// Both goals, the second after 35 s, and what happens at one moment.
    fn with(mut self, moment: u32, accident: impl FnOnce(&mut Self)) -> Self {
        let moment = f64::from(moment) + 0.3;
        self.goal("first", "(serve cola ann)");
        if moment < 35.0 {
            self.until(moment);
            accident(&mut self);
            self.until(35.0);
            self.goal("second", "(serve juice ben)");
        } else {
            self.until(35.0);
            self.goal("second", "(serve juice ben)");
            self.until(moment);
            accident(&mut self);
        }
        self
    }

    fn goal(&mut self, name: &str, task: &str) {
        let request = GoalRequest {
            id: Some(name.into()),
            tasks: parse_tasks(task).expect("tasks"),
            urgency: Urgency::Normal,
            priority: 0,
            deadline: None,
        };
        self.team.tell("k3", Input::Goal(request));
        self.look();
    }

    /// It happens, and everybody hears of it.
    fn known(&mut self, facts: &[&str]) {
        let changes: Vec<FactChange> = facts.iter().map(|fact| change(fact)).collect();
        self.team.change(changes.clone());
        self.team.tell("k3", Input::Observation(changes));
        self.look();
    }

    /// It happens, and whoever sees it sees it.
    fn unseen(&mut self, fact: &str) {
        self.team.change(vec![change(fact)]);
        self.look();
    }

    fn until(&mut self, seconds: f64) {
        let until = Time::from_secs(seconds);
        while self.team.step(until) {
            self.look();
        }
        self.team.run_until(until);
        self.look();
    }

    fn look(&mut self) {
        let events = self.team.take_events().into_iter();
        let own = events.filter(|(who, _)| who == "k3");
        self.events.extend(own.map(|(_, event)| event));
        self.carrier().check();
        let lawful = self.team.room().check();
        assert!(lawful.is_ok(), "{lawful:?}\n{:#?}", self.story());
    }

    fn carrier(&self) -> &Carrier {
        self.team.vehicle("k3").expect("it lives")
    }

    fn spot(&self, bottle: &str) -> &Spot {
        let bottle = self.team.room().things().bottle(bottle);
        &bottle.expect("it is in the room").spot
    }

    /// Takes the bottle away from wherever it is; `false` if a guest has it.
    fn take(&mut self, bottle: &str) -> bool {
        let given = self.team.room().things().bottle(bottle);
        if given.is_some_and(|bottle| bottle.given_to.is_some()) {
            return false;
        }
        let fact = match self.spot(bottle) {
            Spot::Proper { node } => format!("not (stands {bottle} {node})"),
            Spot::Edge { node } => format!("not (edge {bottle} {node})"),
            Spot::Hand { .. } => format!("not (holding {bottle})"),
            Spot::Slot { slot, .. } => format!("not (loaded {bottle} {slot})"),
            Spot::Away => return false,
        };
        self.unseen(&fact);
        true
    }

    /// How often a guest was given a drink.
    fn given(&self, whom: &str) -> usize {
        let deeds = self.team.room().done();
        let given = deeds
            .filter(|deed| matches!(&deed.what, RoomDoing::Served { guest, .. } if *guest == whom));
        given.count()
    }

    /// Whether a goal was reached; `None` if it is not over.
    fn ended(&self, goal: &str) -> Option<bool> {
        self.events.iter().rev().find_map(|event| {
            if event.goal.as_ref().is_none_or(|it| it.as_str() != goal) {
                return None;
            }
            match event.what {
                Happening::GoalSucceeded => Some(true),
                Happening::GoalFailed { .. } | Happening::GoalUnknown { .. } => Some(false),
                _ => None,
            }
        })
    }

    /// Bottles that are in the hand or on the tray.
    fn aboard(&self) -> Vec<&Symbol> {
        let bottles = self.team.room().things().bottles();
        let aboard = bottles
            .filter(|(_, bottle)| matches!(bottle.spot, Spot::Hand { .. } | Spot::Slot { .. }));
        aboard.map(|(name, _)| name).collect()
    }

    /// Which tasks were decomposed anew, and how far they were above what had failed.
    fn repaired(&self) -> Vec<(String, usize)> {
        let repaired = self.events.iter().filter_map(|event| match &event.what {
            Happening::TaskRepaired { task, levels, .. } => Some((task.to_string(), *levels)),
            _ => None,
        });
        repaired.collect()
    }

    /// What happened, in short.
    fn story(&self) -> Vec<String> {
        let told = self
            .events
            .iter()
            .filter(|event| !matches!(event.what, Happening::PlanSelected { .. }));
        let lines = told.map(|event| {
            let goal = event.goal.as_ref().map_or("", |it| it.as_str());
            format!("{:.1} {goal} {:?}", event.at.secs(), event.what)
        });
        lines.collect()
    }

    #[track_caller]
    fn assert(&self, so: bool, moment: u32, what: &str) {
        assert!(so, "{what}, at {moment} s: {:#?}", self.story());
    }
}

/// The ways to go about it, and every so many seconds of it.
fn everywhere(step: usize, mut run: impl FnMut(&dyn Fn() -> Evening, u32)) {
    for (together, planner) in [
        (1, PlannerKind::Graph),
        (3, PlannerKind::Graph),
        (3, PlannerKind::Naive),
    ] {
        // One after the other takes longer.
        let end = SERVING_S * if together == 1 { 3 } else { 2 } / 2;
        let step = match planner {
            PlannerKind::Graph => step,
            PlannerKind::Naive => 3 * step,
        };
        for moment in (0..end).step_by(step) {
            run(&|| Evening::new(together, planner), moment);
        }
    }
}

#[test]
fn whenever_the_bottle_is_taken_away_another_of_its_kind_is_brought_and_nobody_gets_two() {
    let mut repaired: BTreeMap<(String, usize), usize> = BTreeMap::new();
    everywhere(3, |evening, moment| {
        let mut evening = evening().with(moment, |evening| {
            evening.take("cola1");
        });
        evening.until(3000.0);
        for (goal, guest) in [("first", "ann"), ("second", "ben")] {
            evening.assert(evening.ended(goal) == Some(true), moment, goal);
            evening.assert(evening.given(guest) == 1, moment, guest);
        }
        evening.assert(evening.aboard().is_empty(), moment, "all was handed over");
        for (task, levels) in evening.repaired() {
            let name = task.split([' ', ')']).next().unwrap_or_default();
            *repaired.entry((name.to_owned(), levels)).or_default() += 1;
        }
    });
    // Another bottle is a matter of the whole task: the parts of it are about this one.
    assert!(
        repaired.keys().any(|(task, _)| task == "(serve"),
        "{repaired:?}"
    );
}

#[test]
fn whenever_a_table_is_blocked_its_guest_is_served_once_it_is_free() {
    everywhere(3, |evening, moment| {
        let mut evening = evening().with(moment, |evening| evening.known(&["(blocked table1)"]));
        evening.until(1500.0);
        evening.assert(evening.given("ben") == 1, moment, "the other is served");
        evening.assert(evening.ended("second") == Some(true), moment, "second");
        evening.known(&["not (blocked table1)"]);
        evening.until(4000.0);
        evening.assert(evening.ended("first") == Some(true), moment, "first");
        evening.assert(evening.given("ann") == 1, moment, "ann");
        evening.assert(evening.given("ben") == 1, moment, "ben");
        evening.assert(evening.aboard().is_empty(), moment, "all was handed over");
    });
}

#[test]
fn whenever_a_guest_leaves_the_drink_is_taken_back_and_the_other_guest_is_served() {
    let mut taken_back = 0;
    everywhere(3, |evening, moment| {
        let mut evening = evening().with(moment, |evening| {
            evening.known(&["not (seated ann table1)", "(gone ann)"]);
        });
        evening.until(4000.0);
        evening.assert(evening.ended("first").is_some(), moment, "the goal is over");
        evening.assert(evening.given("ann") <= 1, moment, "ann");
        evening.assert(evening.ended("second") == Some(true), moment, "second");
        evening.assert(evening.given("ben") == 1, moment, "ben");
        evening.assert(
            evening.aboard().is_empty(),
            moment,
            "nothing is left aboard",
        );
        if evening.given("ann") == 0 {
            let back = |bottle| match evening.spot(bottle) {
                Spot::Proper { node } | Spot::Edge { node } => *node == "kitchen",
                _ => false,
            };
            let both = ["cola1", "cola2"].into_iter().all(back);
            evening.assert(both, moment, "they stand where they were");
            taken_back += 1;
        }
    });
    assert!(taken_back > 50, "{taken_back}");
}

#[test]
fn when_there_is_no_other_bottle_the_goal_waits_or_is_given_up_and_the_other_guest_is_served() {
    everywhere(9, |evening, moment| {
        let mut taken = false;
        let mut evening = evening().with(moment, |evening| {
            taken = evening.take("cola1") && evening.take("cola2");
        });
        evening.until(4000.0);
        evening.assert(evening.given("ben") == 1, moment, "ben");
        evening.assert(evening.given("ann") == usize::from(!taken), moment, "ann");
        let busy = evening.carrier().agents();
        let busy = busy.into_iter().any(|agent| agent.executing().is_some());
        evening.assert(!busy, moment, "it goes on for ever");
    });
}
