//! One carrier in the restaurant of the paper, several goals at once: the room is the product's, and what
//! other vehicles would tell is told from outside.

use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZeroUsize;
use std::sync::Arc;

use agent_core::agent::{Configuration, Executors, Policy};
use agent_core::language::{parse_atom, parse_tasks};
use agent_core::model::{Fact, FactChange, Symbol, Time};
use agent_core::parallel::ParallelAgent;
use agent_core::planner::{AnyPlanner, PlannerKind, Settings};
use agent_core::protocol::{Event, GoalRequest, Happening, Input, Urgency};
use executor_sim::{Room, Tempo};
use experiments::{ROOM, Team};
use maps::Restaurant;

type Carrier = ParallelAgent<AnyPlanner>;

fn fact(text: &str) -> Fact {
    parse_atom(text).expect("a fact")
}

fn carrier(restaurant: &Restaurant, together: usize) -> Carrier {
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
        policy: Policy::default(),
    };
    let together = NonZeroUsize::new(together).expect("at least one");
    let planner = AnyPlanner::new(PlannerKind::Graph, Settings::default());
    ParallelAgent::new(configuration, together, planner)
}

struct Evening {
    team: Team<Room, Carrier>,
    plot: Vec<(Time, Plot)>,
    events: Vec<Event>,
}

#[derive(Clone, Debug)]
enum Plot {
    Goal(&'static str, String, Urgency),
    /// Something happens, and everybody hears of it.
    Known(FactChange),
    /// Something happens, and whoever sees it sees it.
    Unseen(FactChange),
}

impl Evening {
    fn new(together: usize, tempo: Tempo) -> Self {
        let restaurant = Restaurant::of_the_paper();
        let room = Room::new(&restaurant).expect("a room");
        let vehicles = BTreeMap::from([("k3".into(), carrier(&restaurant, together))]);
        let mut evening = Self {
            team: Team::new(room.with_tempo(tempo), vehicles),
            plot: Vec::new(),
            events: Vec::new(),
        };
        for (guest, table) in [("ann", "table1"), ("ben", "table2"), ("eva", "table3")] {
            let seated = fact(&format!("(seated {guest} {table})"));
            evening.happen(Plot::Known(FactChange::Add(seated)));
        }
        evening
    }

    fn at(&mut self, seconds: f64, plot: Plot) {
        self.plot.push((Time::from_secs(seconds), plot));
    }

    fn goal_at(&mut self, seconds: f64, name: &'static str, task: &str) {
        self.at(seconds, Plot::Goal(name, task.to_owned(), Urgency::Normal));
    }

    fn happen(&mut self, plot: Plot) {
        match plot {
            Plot::Goal(name, task, urgency) => {
                let request = GoalRequest {
                    id: Some(name.into()),
                    tasks: parse_tasks(&task).expect("tasks"),
                    urgency,
                    priority: 0,
                    deadline: None,
                };
                self.team.tell("k3", Input::Goal(request));
            }
            Plot::Known(change) => {
                self.team.change(vec![change.clone()]);
                self.team.tell("k3", Input::Observation(vec![change]));
            }
            Plot::Unseen(change) => self.team.change(vec![change]),
        }
        self.look();
    }

    fn look(&mut self) {
        let events = self.team.take_events().into_iter();
        self.events.extend(
            events
                .filter(|(who, _)| who == "k3")
                .map(|(_, event)| event),
        );
        self.team.vehicle("k3").expect("it lives").check();
        let lawful = self.team.room().check();
        assert!(lawful.is_ok(), "{lawful:?}\n{:#?}", self.story());
    }

    fn play(&mut self, until: f64) {
        self.plot.sort_by_key(|(at, _)| *at);
        let until = Time::from_secs(until);
        for (at, plot) in std::mem::take(&mut self.plot) {
            while self.team.step(at) {
                self.look();
            }
            self.team.run_until(at);
            self.happen(plot);
        }
        while self.team.step(until) {
            self.look();
        }
    }

    fn carrier(&self) -> &Carrier {
        self.team.vehicle("k3").expect("it lives")
    }

    fn begun(&self) -> Vec<String> {
        let begun = self.events.iter().filter_map(|event| match &event.what {
            Happening::ActionStarted { action, .. } | Happening::ActionResumed { action, .. } => {
                Some(action.to_string())
            }
            _ => None,
        });
        begun.collect()
    }

    fn ended(&self) -> BTreeMap<String, (bool, u64)> {
        let ended = self.events.iter().filter_map(|event| {
            let well = match event.what {
                Happening::GoalSucceeded => true,
                Happening::GoalFailed { .. } | Happening::GoalUnknown { .. } => false,
                _ => return None,
            };
            let goal = event.goal.as_ref()?.to_string();
            Some((goal, (well, event.at.secs().round() as u64)))
        });
        ended.collect()
    }

    /// What happened, in short.
    fn story(&self) -> Vec<String> {
        let told = self.events.iter().filter(|event| {
            !matches!(
                event.what,
                Happening::BeliefChanged { .. } | Happening::PlanSelected { .. }
            )
        });
        let lines = told.map(|event| {
            let goal = event.goal.as_ref().map_or("", |it| it.as_str());
            format!("{:.1} {goal} {:?}", event.at.secs(), event.what)
        });
        lines.collect()
    }
}

#[test]
fn the_plan_of_two_guests_is_that_of_the_paper() {
    let mut evening = Evening::new(3, Tempo::even());
    evening.goal_at(0.0, "first", "(serve cola ann)");
    evening.goal_at(35.0, "second", "(serve juice ben)");
    evening.play(2000.0);
    let begun = evening.begun();
    let names: Vec<&str> = (begun.iter())
        .filter_map(|it| it.trim_matches(['(', ')']).split_whitespace().next())
        .collect();
    assert_eq!(
        names,
        [
            "grasp",
            "put-on-tray",
            "grasp",
            "put-on-tray",
            "move",
            "take-from-tray",
            "put-drink",
            "move",
            "take-from-tray",
            "put-drink"
        ],
        "{begun:#?}"
    );
    assert!(begun[7].starts_with("(move table1 table2"), "{begun:#?}");
    let ended = evening.ended();
    assert_eq!(ended["first"], (true, 162));
    assert_eq!(ended["second"], (true, 217));
}

#[test]
fn an_emergency_at_every_moment_and_everybody_is_served() {
    for moment in (0..220).step_by(2) {
        let mut evening = Evening::new(3, Tempo::even());
        evening.goal_at(0.0, "first", "(serve cola ann)");
        evening.goal_at(35.0, "second", "(serve juice ben)");
        let moment = f64::from(moment) + 0.7;
        evening.at(moment, Plot::Known(FactChange::Add(fact("(spill table3)"))));
        let clean = "(clean table3)".to_owned();
        evening.at(moment, Plot::Goal("spill", clean, Urgency::Emergency));
        evening.play(4000.0);
        let ended = evening.ended();
        let well = ended.values().filter(|(well, _)| *well).count();
        assert_eq!(well, 3, "at {moment}: {ended:?}\n{:#?}", evening.story());
    }
}

struct Chance(u64);

impl Chance {
    /// SplitMix64 (Steele, Lea and Flood).
    fn below(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (mixed ^ (mixed >> 31)) % bound
    }

    fn time(&mut self, most: u64) -> f64 {
        self.below(most * 10) as f64 / 10.0
    }
}

const NAMES: [&str; 8] = ["a", "b", "c", "d", "e", "f", "g", "h"];
const GUESTS: [(&str, &str); 3] = [("ann", "table1"), ("ben", "table2"), ("eva", "table3")];
const KINDS: [&str; 3] = ["cola", "juice", "water"];
const BOTTLES: [&str; 6] = ["cola1", "cola2", "juice1", "juice2", "water1", "water2"];

/// A random evening: two bottles of each kind, so that each kind is ordered twice at most.
fn evening(seed: u64) -> (Evening, BTreeSet<Symbol>) {
    let mut chance = Chance(seed);
    let together = 1 + chance.below(4) as usize;
    let mut evening = Evening::new(together, Tempo::varied(seed, 0.15));
    let mut goals = BTreeSet::new();
    let mut ordered: BTreeSet<(u64, u64)> = BTreeSet::new();
    for name in NAMES.iter().take(1 + chance.below(8) as usize) {
        let (guest, kind) = (chance.below(3), chance.below(3));
        let (who, table) = GUESTS[guest as usize];
        let when = chance.time(400);
        match chance.below(8) {
            0 => {
                let spill = FactChange::Add(fact(&format!("(spill {table})")));
                evening.at(when, Plot::Known(spill));
                let clean = format!("(clean {table})");
                evening.at(when, Plot::Goal(name, clean, Urgency::Emergency));
            }
            1 => evening.goal_at(when, name, &format!("(clear {table})")),
            _ => {
                let twice = ordered.iter().filter(|(_, it)| *it == kind).count() > 1;
                if twice || !ordered.insert((guest, kind)) {
                    continue;
                }
                let task = format!("(serve {} {who})", KINDS[kind as usize]);
                evening.goal_at(when, name, &task);
            }
        }
        goals.insert(Symbol::from(*name));
        match chance.below(6) {
            0 => {
                let seated = fact(&format!("(seated {who} {table})"));
                let later = when + chance.time(200);
                evening.at(later, Plot::Known(FactChange::Remove(seated)));
                let gone = fact(&format!("(gone {who})"));
                evening.at(later, Plot::Known(FactChange::Add(gone)));
            }
            1 => {
                let blocked = fact(&format!("(blocked {table})"));
                let from = chance.time(400);
                evening.at(from, Plot::Known(FactChange::Add(blocked.clone())));
                let later = from + chance.time(300);
                evening.at(later, Plot::Known(FactChange::Remove(blocked)));
            }
            2 => {
                let bottle = BOTTLES[chance.below(6) as usize];
                let away = FactChange::Remove(fact(&format!("(stands {bottle} kitchen)")));
                evening.at(chance.time(300), Plot::Unseen(away));
            }
            _ => {}
        }
    }
    (evening, goals)
}

#[test]
fn whatever_comes_every_goal_ends_or_waits_for_what_others_have_to_do() {
    let (mut well, mut waiting) = (0, 0);
    for seed in 0..120 {
        let (mut evening, goals) = evening(seed);
        evening.play(30_000.0);
        let ended = evening.ended();
        well += ended.values().filter(|(well, _)| *well).count();
        let carrier = evening.carrier();
        for intention in carrier.intentions() {
            let goal = &intention.goal.id;
            let wanted = carrier.wanted();
            let waits = wanted.iter().find(|(id, _)| id == goal);
            let facts = waits.map(|(_, facts)| facts.clone());
            assert!(
                facts.as_ref().is_some_and(|facts| !facts.is_empty()),
                "seed {seed}: {goal} stands still: {facts:?}\n{:#?}",
                evening.story()
            );
            waiting += 1;
        }
        let open = carrier.intentions().count();
        assert_eq!(ended.len() + open, goals.len(), "seed {seed}");
        let doing = carrier
            .branches()
            .iter()
            .filter(|it| it.executing().is_some());
        assert_eq!(doing.count(), 0, "seed {seed}: it goes on for ever");
    }
    assert!(well > 240, "{well} goals were reached, {waiting} wait");
}
