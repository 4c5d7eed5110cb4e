//! One history: goals are set aside and taken up, actions succeed or are suspended, and the world
//! changes, all at random. After every turn the answer must be that of planning from scratch.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::domains::{Scene, scene};
use super::judged::judge;
use super::random::Random;
use crate::agent::{Goal, Intention, Record};
use crate::model::{Action, Belief, ExecutionModel, Fact, FactChange, Map};
use crate::planner::graph::GraphPlanner;
use crate::planner::{
    Item, NaivePlanner, Outcome, Plan, Planner, Problem, Settings, effect_of, effect_of_suspension,
    instance, simulate,
};
use crate::protocol::{ActionId, Urgency};

/// A problem for which planning from scratch takes longer is left.
const EXPANSIONS: u64 = 600;

/// What was done in all histories.
#[derive(Debug, Default)]
pub(super) struct Tally {
    pub replans: u64,
    pub plans: u64,
    pub proved_none: u64,
    pub unproved: u64,
    /// Plans that were put before the judge.
    pub judged: u64,
    pub resumed: u64,
    pub expanded: u64,
    pub expanded_from_scratch: u64,
    pub left: u64,
}

#[derive(Debug)]
pub(super) struct Episode {
    seed: u64,
    turn: usize,
    random: Random,
    scene: Scene,
    other_map: Arc<Map>,
    belief: Belief,
    planner: GraphPlanner,
    /// Whether the planner is told of changes, or has to find out.
    tells: bool,
    impatient: bool,
    forgetful: bool,
    /// The goal that is pursued is the last.
    goals: Vec<(Intention, BTreeSet<Action>)>,
    plans: Vec<Plan>,
    next_record: u64,
    /// What was answered, in words.
    pub trace: String,
}

impl Episode {
    pub fn new(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let scene = scene(&mut random);
        let mut planner = GraphPlanner::new(Settings::default());
        planner.merges = random.chance(80);
        if random.chance(20) {
            planner.least_to_begin_anew = random.between(1, 10);
        }
        let mut other_map = Map::clone(&scene.map);
        let facts: Vec<Fact> = other_map.facts.facts().cloned().collect();
        if let Some(fact) = facts.first() {
            other_map.facts.apply(&FactChange::Remove(fact.clone()));
        }
        let mut episode = Self {
            seed,
            turn: 0,
            belief: scene.belief.clone(),
            other_map: Arc::new(other_map),
            planner,
            tells: random.chance(70),
            impatient: false,
            forgetful: false,
            goals: Vec::new(),
            plans: Vec::new(),
            next_record: 0,
            trace: String::new(),
            scene,
            random,
        };
        episode.push_goal();
        episode
    }

    /// The same with a planner that does not look for the best plan for long.
    pub fn impatient(mut self) -> Self {
        self.impatient = true;
        self.planner = self.planner.impatient(1);
        self
    }

    /// The same with a planner that collects what it does not need before it plans.
    pub fn forgetful(mut self) -> Self {
        self.forgetful = true;
        self
    }

    pub fn run(&mut self, tally: &mut Tally) {
        for turn in 0..self.random.between(5, 30) {
            self.turn = turn;
            if !self.replan(tally) {
                tally.left += 1;
                return;
            }
            self.happen();
        }
    }

    fn problem(&self, model: &Arc<ExecutionModel>) -> Problem {
        let (intention, forbidden) = self.running();
        Problem {
            domain: self.scene.domain.clone(),
            model: model.clone(),
            map: intention.goal.map.clone(),
            belief: Arc::new(self.belief.clone()),
            forbidden: forbidden.clone(),
        }
    }

    fn running(&self) -> &(Intention, BTreeSet<Action>) {
        self.goals.last().expect("there is always a goal")
    }

    fn running_mut(&mut self) -> &mut Intention {
        &mut self.goals.last_mut().expect("there is always a goal").0
    }

    /// Plans both ways and compares. Returns `false` if that takes too long from scratch.
    fn replan(&mut self, tally: &mut Tally) -> bool {
        let Some(expected) = self.answer_from_scratch() else {
            return false;
        };
        let problem = self.problem(&self.scene.model);
        let agendas = self.running().0.agendas.clone();
        if self.forgetful {
            self.planner.forget(&agendas);
        }
        self.planner.begin(problem.clone(), &agendas);
        let mut slices = 0;
        let found = loop {
            slices += 1;
            assert!(slices < 100_000, "{}: it does not end", self.place());
            let slice = self.random.between(1, 40) as u64;
            if let Some(outcome) = self.planner.think(slice) {
                break outcome;
            }
        };
        self.compare(&problem, &expected, &found);
        if self.random.chance(1) {
            for plan in &found.plans {
                let verdict = judge(&problem, &agendas, plan);
                assert_eq!(verdict, Ok(()), "{}", self.place());
                tally.judged += 1;
            }
        }
        if self.random.chance(10) {
            let verdict = self.planner.check();
            assert_eq!(verdict, Ok(()), "{}", self.place());
        }
        tally.replans += 1;
        tally.unproved += u64::from(!found.proved);
        tally.plans += u64::from(!found.plans.is_empty());
        tally.proved_none += u64::from(found.plans.is_empty());
        tally.expanded += found.expanded_for_best;
        tally.expanded_from_scratch += expected.expanded_for_best;
        let first = found.plans.first().and_then(|plan| plan.steps.first());
        tally.resumed += u64::from(first.is_some_and(|s| matches!(s.item, Item::Resume { .. })));
        let actions: Vec<_> = found.plans.iter().map(Plan::actions).collect();
        self.trace += &format!("{actions:?} {}\n", found.expanded);
        self.plans = found.plans;
        true
    }

    fn place(&self) -> String {
        format!("REPLAN_SEED={}, turn {}", self.seed, self.turn)
    }

    /// The baseline, without estimates, so that nothing depends on their being right.
    fn answer_from_scratch(&self) -> Option<Outcome> {
        let mut model = ExecutionModel::clone(&self.scene.model);
        model.tasks.clear();
        let mut naive = NaivePlanner::new(Settings {
            alternatives: 1,
            ..Settings::default()
        });
        let agendas = &self.running().0.agendas;
        naive.begin(self.problem(&Arc::new(model)), agendas);
        naive.think(EXPANSIONS)
    }

    #[track_caller]
    fn compare(&self, problem: &Problem, expected: &Outcome, found: &Outcome) {
        let best = |outcome: &Outcome| outcome.plans.first().map(|plan| plan.cost);
        if !found.proved {
            assert!(best(found) >= best(expected), "{}", self.place());
        }
        let expected_cost = if found.proved {
            best(expected)
        } else {
            best(found)
        };
        assert_eq!(
            best(found),
            expected_cost,
            "I5, {}; {}",
            self.place(),
            self.diagnose(problem, expected, found)
        );
        for plan in &found.plans {
            let cost = simulate(problem, &plan.steps, false);
            assert_eq!(cost, Ok(plan.cost), "I6, {}: {plan:?}", self.place());
            assert!(plan.rest.is_empty(), "{}", self.place());
        }
        assert!(found.proved || self.impatient, "{}", self.place());
        let none = [expected, found].map(|outcome| outcome.plans.is_empty());
        assert_eq!(none[0], none[1], "{}", self.place());
        if found.plans.is_empty() {
            assert_eq!(found.wanted, expected.wanted, "{}", self.place());
        }
    }

    /// What else is known when answers differ.
    fn diagnose(&self, problem: &Problem, expected: &Outcome, found: &Outcome) -> String {
        let agendas = &self.running().0.agendas;
        let best = |mut planner: Box<dyn Planner>| {
            planner.begin(problem.clone(), agendas);
            let outcome = planner.think(1_000_000);
            outcome.and_then(|outcome| outcome.plans.first().map(|plan| plan.cost))
        };
        let settings = Settings::default();
        let actions = |outcome: &Outcome| outcome.plans.first().map(Plan::actions);
        format!(
            "again {:?}, with estimates from scratch {:?}, in a new graph {:?}; expected {:?}, found {:?}; merges: {}, check: {:?}",
            best(Box::new(self.planner.clone())),
            best(Box::new(NaivePlanner::new(settings))),
            best(Box::new(GraphPlanner::new(settings))),
            actions(expected),
            actions(found),
            self.planner.merges,
            self.planner.clone().check(),
        )
    }

    fn happen(&mut self) {
        match self.random.below(100) {
            0..35 => self.execute(),
            35..50 => self.suspend(),
            50..80 => self.surprise(),
            80..85 => self.push_goal(),
            85..90 => self.pop_goal(),
            90..93 => self.forbid(),
            93..95 => self.forget(),
            95..97 => self.there_and_back(),
            97..98 => self.in_either_order(),
            _ => self.reach(),
        }
        if self.random.chance(10) {
            self.surprise();
        }
    }

    fn change(&mut self, changes: &[FactChange]) {
        let different = self.belief.apply_all(changes);
        if self.tells {
            self.planner.observe(&different);
        }
    }

    fn surprise(&mut self) {
        for _ in 0..self.random.between(1, 2) {
            if self.random.chance(20) {
                self.carry();
                continue;
            }
            let change = match self.random.chance(15) {
                true => {
                    let function = self.random.pick(&self.scene.functions).clone();
                    FactChange::Set(function, self.random.between(0, 5) as f64)
                }
                false => self.flip(),
            };
            self.change(&[change]);
        }
    }

    /// A fact that is not as it was.
    fn flip(&mut self) -> FactChange {
        let fact = self.random.pick(&self.scene.changing).clone();
        match self.belief.holds(&fact) {
            true => FactChange::Remove(fact),
            false => FactChange::Add(fact),
        }
    }

    /// I7: a change and its contrary leave all costs as they were.
    fn there_and_back(&mut self) {
        let there = self.flip();
        let back = match &there {
            FactChange::Add(fact) => FactChange::Remove(fact.clone()),
            FactChange::Remove(fact) => FactChange::Add(fact.clone()),
            FactChange::Set(..) => return,
        };
        let mut planner = self.known();
        let before = planner.costs();
        for change in [there, back] {
            planner.observe(&[change]);
            planner.settle();
        }
        let after: BTreeMap<(u32, u32), u64> = planner.costs().into_iter().collect();
        // If it was a change of what never changed before, all is new.
        if !after.is_empty() {
            for (node, cost) in before {
                assert_eq!(after.get(&node), Some(&cost), "I7, {}", self.place());
            }
        }
    }

    /// I8: of two changes it does not matter which comes first.
    fn in_either_order(&mut self) {
        let (a, b) = (self.flip(), self.flip());
        let costs = [[&a, &b], [&b, &a]].map(|changes| {
            let mut planner = self.known();
            for change in changes {
                planner.observe(std::slice::from_ref(change));
            }
            planner.begin(self.problem_after(&[&a, &b]), &self.running().0.agendas);
            let outcome = planner.think(1_000_000).expect("it is small");
            outcome.plans.first().map(|plan| plan.cost)
        });
        assert_eq!(costs[0], costs[1], "I8, {}", self.place());
    }

    /// I11.
    fn reach(&mut self) {
        let change = self.flip();
        let mut planner = self.known();
        planner.settle();
        let verdict = planner.check_reach(&[change]);
        assert_eq!(verdict, Ok(()), "{}", self.place());
    }

    /// The planner with the belief as it is.
    fn known(&self) -> GraphPlanner {
        let mut planner = self.planner.clone();
        planner.begin(self.problem(&self.scene.model), &self.running().0.agendas);
        planner
    }

    fn problem_after(&self, changes: &[&FactChange]) -> Problem {
        let mut problem = self.problem(&self.scene.model);
        let belief = Arc::make_mut(&mut problem.belief);
        for change in changes {
            belief.apply(change);
        }
        problem
    }

    /// The robot is somewhere else.
    fn carry(&mut self) {
        let places = self
            .belief
            .facts()
            .filter(|f| f.name == "at" || f.name == "on");
        let mut changes: Vec<FactChange> = places.cloned().map(FactChange::Remove).collect();
        let spot = self.random.pick(&self.scene.spots).clone();
        changes.insert(
            self.random.below(changes.len() + 1),
            FactChange::Add(spot.clone()),
        );
        changes.push(FactChange::Add(spot));
        self.change(&changes);
    }

    fn execute(&mut self) {
        let Some(step) = self
            .plans
            .first()
            .and_then(|plan| plan.steps.first())
            .cloned()
        else {
            return self.pop_goal();
        };
        let problem = self.problem(&self.scene.model);
        let changes = effect_of(&problem, step.action());
        if self.random.chance(10) {
            let mut planner = self.known();
            let verdict = planner.check_advance(&step.rest, &changes);
            assert_eq!(verdict, Ok(()), "{}", self.place());
        }
        let repeatable = self.random.chance(80);
        let intention = self.running_mut();
        if let Item::Resume { id, .. } | Item::RollBack { id, .. } = &step.item {
            intention.records.retain(|record| record.id != *id);
        }
        intention.after(&step, repeatable);
        if self.random.chance(30) {
            let (_, others) = self.goals.split_last_mut().expect("there is always a goal");
            for (other, _) in others {
                other.done_by_another(step.purpose());
            }
        }
        self.change(&changes);
    }

    fn suspend(&mut self) {
        let Some(step) = self
            .plans
            .first()
            .and_then(|plan| plan.steps.first())
            .cloned()
        else {
            return;
        };
        let action = step.purpose().clone();
        let model = self.scene.model.clone();
        let model = model.actions.get(&action.name);
        let Some(suspension) = model.and_then(|model| model.suspension.as_ref()) else {
            return;
        };
        self.next_record += 1;
        let id = ActionId {
            agent: "tester".into(),
            epoch: 0,
            number: self.next_record,
        };
        let problem = self.problem(&self.scene.model);
        let changes = effect_of_suspension(&problem, &action);
        let rollback = suspension.rollback.as_ref();
        let rollback = rollback.and_then(|pattern| instance(pattern, &action));
        let reach = suspension.reach.as_ref();
        let reach = reach.and_then(|pattern| instance(pattern, &action));
        let resume = instance(&suspension.resume, &action).expect("all variables are the action's");
        let resume = Item::Resume {
            id: id.clone(),
            original: action,
            action: resume,
        };
        let undo = rollback.map(|action| Item::RollBack {
            id: id.clone(),
            action,
        });
        let intention = self.running_mut();
        intention.around(&step, Some((resume, reach.map(Item::Task))), undo);
        intention.records.push(Record {
            id,
            executor: "robot".into(),
            step,
        });
        self.change(&changes);
        if self.random.chance(60) {
            self.push_goal();
        }
    }

    fn push_goal(&mut self) {
        if self.goals.len() > 3 {
            return self.pop_goal();
        }
        let count = self.random.between(1, 2);
        let tasks = (0..count).map(|_| self.random.pick(&self.scene.tasks).clone());
        let tasks = tasks.collect();
        let other = self.random.chance(20);
        let map = if other {
            &self.other_map
        } else {
            &self.scene.map
        };
        let intention = Intention::new(Goal {
            id: "goal".into(),
            tasks,
            urgency: Urgency::Normal,
            priority: 0,
            deadline: None,
            number: 0,
            superior: None,
            map: map.clone(),
        });
        self.goals.push((intention, BTreeSet::new()));
    }

    fn pop_goal(&mut self) {
        self.goals.pop();
        if self.goals.is_empty() {
            self.push_goal();
        }
    }

    fn forbid(&mut self) {
        let first = self.plans.first().and_then(|plan| plan.steps.first());
        let action = first.map(|step| step.purpose().clone());
        let (_, forbidden) = self.goals.last_mut().expect("there is always a goal");
        match action {
            Some(action) if self.random.chance(80) => {
                forbidden.insert(action);
            }
            _ => forbidden.clear(),
        }
    }

    /// A record is cleared.
    fn forget(&mut self) {
        let intention = self.running_mut();
        if let Some(record) = intention.records.pop() {
            intention.forget(&record.id);
        }
    }
}
