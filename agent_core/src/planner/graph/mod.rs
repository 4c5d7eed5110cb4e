//! The plan graph: what was found out about tasks and states is kept, and only what a change bears
//! on is found out again.
//!
//! A node is a list of tasks in a state (`nodes`), the state being what is believed overlaid with
//! what the actions on the way have brought about (`world`, `eval`). Every question that was asked
//! of the belief is remembered, so that a change reaches exactly the nodes that it may concern.
//! Costs are costs to the end: an action that is carried out moves the root and changes none of
//! them. Goals that are suspended are further roots of the same graph.

mod alternatives;
mod behind;
mod code;
mod collect;
mod confirm;
mod decompose;
mod dive;
mod eval;
mod facts;
mod groups;
mod intern;
mod key;
mod known;
mod lists;
mod nodes;
mod reading;
mod replay;
mod search;
mod world;

#[cfg(test)]
mod check;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use alternatives::Alternatives;
use dive::Dive;
use intern::NONE;
use key::{Key, Touched};
use nodes::{Graph, INFINITE, LEAST_TO_BEGIN_ANEW, Work};
use reading::Reading;
use replay::Replay;
use search::{Search, Step, walk};
use world::World;

use super::{Agenda, Confirmed, Outcome, Plan, Planner, Problem, Settings, TaskList};
use crate::model::{Fact, FactChange, Map};
use crate::protocol::GoalId;

/// Agendas of goals, as tasks.
type Kept = BTreeMap<GoalId, Vec<TaskList>>;

/// What one expansion counts, in visits of nodes that are known and repairs of costs.
const VISITS_PER_EXPANSION: u64 = 8;
/// After so many expansions in search of the best plan some plan is looked for, depth first, and
/// after [`PATIENCE`] times as many the best that is known is taken.
const EXPANSIONS_BEFORE_DIVING: u64 = 10_000;
/// See [`EXPANSIONS_BEFORE_DIVING`].
const PATIENCE: u64 = 4;
/// How many maps are kept in mind.
const GRAPHS: usize = 4;

/// The incremental planner.
///
/// Answers as [`NaivePlanner`](super::NaivePlanner) does, up to plans of the same cost, but from
/// what it already knows.
#[derive(Clone, Debug)]
pub struct GraphPlanner {
    settings: Settings,
    next_frame: u64,
    /// The domain that was read last.
    reading: Option<Arc<Reading>>,
    /// One for each map, domain and execution model; the one used last is the last.
    graphs: Vec<Graph>,
    thinking: Option<Thinking>,
    /// The agendas of goals that are not planned for at present.
    kept: Kept,
    /// Whether facts of which at most one holds are one variable.
    merges: bool,
    expansions_before_diving: u64,
    /// With fewer nodes to be looked at again, what is known is never given up for that.
    least_to_begin_anew: usize,
}

/// What is being planned for.
#[derive(Clone, Debug)]
struct Thinking {
    agendas: Vec<Agenda>,
    lists: Vec<u32>,
    roots: Vec<u32>,
    stage: Stage,
    /// The best plan, as far as is known, and what it costs.
    found: Option<(Vec<u32>, u64)>,
    /// What had been done before.
    before: Work,
    /// Expansions until the best plan was found.
    expanded_for_best: u64,
    /// A plan that was found depth first, and what it costs.
    some: Option<(Vec<u32>, u64)>,
    /// Whether the best plan is known to be the best.
    proved: bool,
    upset: u64,
    /// It was asked whether a kept plan is one of the best, and that could not be told.
    is_in_doubt: bool,
}

#[derive(Clone, Debug)]
enum Stage {
    /// What has changed is looked at, and costs are put right.
    Settle,
    /// Nodes are expanded.
    Search(Box<Search>),
    /// Any plan is looked for, and then the search goes on.
    Dive(Box<Dive>, Box<Search>),
    /// The best plan is known.
    Others(Box<Alternatives>),
}

impl GraphPlanner {
    /// A planner that has nothing to do and knows nothing.
    pub fn new(settings: Settings) -> Self {
        Self {
            settings,
            next_frame: 0,
            reading: None,
            graphs: Vec::new(),
            thinking: None,
            kept: BTreeMap::new(),
            merges: true,
            expansions_before_diving: EXPANSIONS_BEFORE_DIVING,
            least_to_begin_anew: LEAST_TO_BEGIN_ANEW,
        }
    }

    /// The same, but with so many expansions in search of the best plan before any plan is looked
    /// for, and four times as many before the best that is known is taken.
    pub fn impatient(mut self, expansions: u64) -> Self {
        self.expansions_before_diving = expansions;
        self
    }

    /// Makes the graph for a problem the last one, with the belief of the problem.
    fn fetch(&mut self, problem: &Problem) {
        let same = |graph: &Graph| graph.world.is_of(problem);
        match self.graphs.iter().position(same) {
            Some(place) => {
                let graph = self.graphs.remove(place);
                self.graphs.push(graph);
            }
            None => {
                if self.graphs.len() == GRAPHS {
                    self.graphs.remove(0);
                }
                let world = World::new(problem, &self.read(problem));
                self.graphs
                    .push(Graph::new(world, self.least_to_begin_anew));
            }
        }
        let Some(graph) = self.graphs.last_mut() else {
            return;
        };
        graph.catch_up();
        let mut touched = Touched::default();
        if !graph.world.knows(&problem.belief) {
            graph.world.become_like(&problem.belief, &mut touched);
        }
        let forbidden = graph.world.forbid(&problem.forbidden);
        let forbidden = forbidden.into_iter().map(Key::Action);
        touched.keys.extend(forbidden.map(|key| (key, NONE)));
        graph.touched(&touched);
        graph.begin_anew_if_much_is_dirty();
    }

    /// The problem's domain, which is read if it is another than before.
    fn read(&mut self, problem: &Problem) -> Arc<Reading> {
        let known = self.reading.take().filter(|known| known.is_of(problem));
        let reading = known.unwrap_or_else(|| Arc::new(Reading::new(problem, self.merges)));
        self.reading = Some(reading.clone());
        reading
    }

    /// Thinks until the budget is spent; with `best_only`, also no further than until the best plan is
    /// known.
    fn go_on(&mut self, mut budget: u64, best_only: bool) -> Option<Outcome> {
        let graph = self.graphs.last_mut()?;
        let thinking = self.thinking.as_mut()?;
        let depth = self.settings.depth.actions();
        if thinking.upset != graph.upset {
            thinking.restart(graph);
        }
        loop {
            if budget == 0 {
                return None;
            }
            graph.sweep();
            match &mut thinking.stage {
                Stage::Settle => {
                    if graph.reevaluate_one() {
                        budget = budget.saturating_sub(VISITS_PER_EXPANSION);
                    } else if graph.repair_one() {
                        budget -= 1;
                    } else if !thinking.decide(graph, &self.settings) {
                        // It is told again to whoever thinks.
                        return (!best_only).then(|| thinking.none(graph));
                    }
                }
                Stage::Search(search) => match search.step(graph, depth) {
                    Step::Visited(expanded) => {
                        budget = budget.saturating_sub(price(expanded));
                        thinking.grow_impatient(graph, self.expansions_before_diving);
                    }
                    Step::Found(way, cost) => {
                        thinking.found = Some((way, cost));
                        thinking.stage = Stage::Settle;
                    }
                    // Nothing is cheaper than what was found depth first.
                    Step::Exhausted => {
                        thinking.found = thinking.some.take();
                        thinking.stage = Stage::Settle;
                    }
                },
                Stage::Dive(dive, search) => match dive.step(graph, depth) {
                    Step::Visited(expanded) => budget = budget.saturating_sub(price(expanded)),
                    Step::Found(way, cost) => {
                        search.bound = cost;
                        thinking.some = Some((way, cost));
                        thinking.stage = Stage::Search(search.clone());
                    }
                    Step::Exhausted => thinking.stage = Stage::Search(search.clone()),
                },
                Stage::Others(_) if best_only => return None,
                Stage::Others(others) => match others.step(graph, depth) {
                    Some(expanded) => budget = budget.saturating_sub(price(expanded)),
                    None => {
                        let ways = std::mem::take(&mut others.plans);
                        return Some(thinking.plans(graph, &ways, &mut self.next_frame));
                    }
                },
            }
        }
    }
}

fn price(expanded: bool) -> u64 {
    if expanded { VISITS_PER_EXPANSION } else { 1 }
}

impl Thinking {
    /// The belief has changed meanwhile: what was found out stays, the search does not.
    fn restart(&mut self, graph: &mut Graph) {
        let tasks = self.agendas.iter().map(|agenda| &agenda.tasks);
        self.lists = tasks.map(|tasks| graph.world.list(tasks)).collect();
        self.stage = Stage::Settle;
        self.found = None;
        self.some = None;
        self.proved = true;
        self.upset = graph.upset;
    }

    /// Where the best plan is long in coming, any plan is looked for, and taken if need be.
    fn grow_impatient(&mut self, graph: &Graph, patience: u64) {
        let Stage::Search(search) = &mut self.stage else {
            return;
        };
        if search.expansions == patience && !search.has_dived {
            search.has_dived = true;
            let dive = Dive::new(graph, &self.roots, PATIENCE * patience);
            self.stage = Stage::Dive(Box::new(dive), search.clone());
        } else if search.expansions >= PATIENCE * patience && self.some.is_some() {
            self.found = self.some.take();
            self.proved = false;
            self.stage = Stage::Settle;
        }
    }

    /// All costs are right. Returns `false` if there is no plan.
    fn decide(&mut self, graph: &mut Graph, settings: &Settings) -> bool {
        let depth = settings.depth.actions();
        // A way that was found begins at one of the roots as they were.
        if self.found.is_none() {
            self.roots = self.lists.iter().map(|list| graph.root(*list)).collect();
        }
        let cost = |root: &u32| graph.nodes[*root as usize].v;
        let Some(best) = self.roots.iter().copied().min_by_key(cost) else {
            return false;
        };
        let least = cost(&best);
        if least == INFINITE {
            return false;
        }
        let found = self.found.take();
        let good = |cost: u64| depth.is_some() || !self.proved || cost <= least;
        let found = found.filter(|(_, cost)| good(*cost));
        let way = found.map(|(way, _)| way);
        self.stage = match way.or_else(|| walk(graph, best, depth)) {
            None => Stage::Search(Box::new(Search::new(graph, &self.roots))),
            Some(way) => {
                self.expanded_for_best = graph.work.expanded - self.before.expanded;
                let wanted = settings.alternatives.max(1);
                Stage::Others(Box::new(Alternatives::new(graph, &self.roots, way, wanted)))
            }
        };
        true
    }

    fn plans(&self, graph: &Graph, ways: &[Vec<u32>], next_frame: &mut u64) -> Outcome {
        let mut replay = Replay::default();
        let begins: Vec<usize> = self
            .agendas
            .iter()
            .map(|a| replay.begin(&a.tasks))
            .collect();
        let mut plans = Vec::new();
        for way in ways {
            let agenda = self.roots.iter().position(|root| way.first() == Some(root));
            if let Some(agenda) = agenda {
                plans.push(replay.plan(graph, begins[agenda], way, next_frame));
            }
        }
        Outcome {
            plans,
            wanted: BTreeSet::new(),
            expanded: graph.work.expanded - self.before.expanded,
            expanded_for_best: self.expanded_for_best,
            evaluated: graph.work.evaluated() - self.before.evaluated(),
            proved: self.proved,
        }
    }

    /// There is no plan. What was asked for in vain is what the nodes ask for that can be reached:
    /// all of them were expanded, or there might be a plan.
    fn none(&self, graph: &Graph) -> Outcome {
        let mut wanted = BTreeSet::new();
        let mut open = self.roots.clone();
        let mut seen: BTreeSet<u32> = open.iter().copied().collect();
        while let Some(node) = open.pop() {
            wanted.extend(graph.wanted.get(&node).into_iter().flatten().copied());
            for edge in &graph.nodes[node as usize].out {
                if seen.insert(edge.to) {
                    open.push(edge.to);
                }
            }
        }
        let expanded = graph.work.expanded - self.before.expanded;
        Outcome {
            plans: Vec::new(),
            wanted: wanted
                .into_iter()
                .map(|fact| graph.world.name_atom(fact))
                .collect::<BTreeSet<Fact>>(),
            expanded,
            expanded_for_best: expanded,
            evaluated: graph.work.evaluated() - self.before.evaluated(),
            proved: true,
        }
    }
}

impl Planner for GraphPlanner {
    fn prepare(&mut self, problem: &Problem) {
        self.fetch(problem);
    }

    fn begin(&mut self, problem: Problem, agendas: &[Agenda]) {
        self.fetch(&problem);
        let Some(graph) = self.graphs.last_mut() else {
            return;
        };
        if graph.is_full() {
            graph.forget_all_but(agendas, &self.kept);
        }
        let mut thinking = Thinking {
            agendas: agendas.to_vec(),
            lists: Vec::new(),
            roots: Vec::new(),
            stage: Stage::Settle,
            found: None,
            before: graph.work,
            expanded_for_best: 0,
            some: None,
            proved: true,
            upset: graph.upset,
            is_in_doubt: false,
        };
        thinking.restart(graph);
        self.thinking = Some(thinking);
    }

    fn think(&mut self, expansions: u64) -> Option<Outcome> {
        let budget = expansions.max(1).saturating_mul(VISITS_PER_EXPANSION);
        let outcome = self.go_on(budget, false)?;
        self.thinking = None;
        Some(outcome)
    }

    fn confirm(&mut self, kept: &Plan) -> Option<Confirmed> {
        let confirmed = self.confirmed(kept)?;
        self.thinking = None;
        Some(confirmed)
    }

    fn is_thinking(&self) -> bool {
        self.thinking.is_some()
    }

    fn stop(&mut self) {
        self.thinking = None;
    }

    fn keep(&mut self, goal: &GoalId, agendas: &[Agenda]) {
        let tasks = agendas.iter().map(|agenda| agenda.tasks.clone());
        self.kept.insert(goal.clone(), tasks.collect());
    }

    fn number_frames_from(&mut self, first: u64) {
        self.next_frame = self.next_frame.max(first);
    }

    fn release(&mut self, goal: &GoalId) {
        self.kept.remove(goal);
    }

    fn known(&self, problem: &Problem, agendas: &[Agenda]) -> Vec<Plan> {
        self.best_known(problem, agendas)
    }

    fn observe(&mut self, changes: &[FactChange]) {
        self.tell(changes);
    }
}

impl World {
    /// Whether it was made for this domain, execution model and map.
    fn is_of(&self, problem: &Problem) -> bool {
        same(&self.domain, &problem.domain)
            && same(&self.model, &problem.model)
            && same_map(&self.map, &problem.map)
    }
}

fn same<T: PartialEq>(a: &Arc<T>, b: &Arc<T>) -> bool {
    same_one(a, b) || **a == **b
}

/// A child is given its maps with every instruction, most of them again.
fn same_map(a: &Arc<Map>, b: &Arc<Map>) -> bool {
    let listed = || a.facts.landmarks().next().is_none() && b.facts.landmarks().next().is_none();
    let alike = || a.facts.fingerprint() == b.facts.fingerprint();
    same_one(a, b)
        || alike() && a.objects == b.objects && (listed() || a.facts == b.facts) && a.news == b.news
}

/// Without a comparison, which takes as long as both are large.
fn same_one<T>(a: &Arc<T>, b: &Arc<T>) -> bool {
    Arc::ptr_eq(a, b)
}
