//! Planning from scratch: the baseline of every comparison, and the oracle of other planners.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet, BinaryHeap};
use std::sync::Arc;

use super::decompose::successors;
use super::detour::decisive;
use super::estimate::estimate;
use super::network::TaskList;
use super::plan::{Agenda, Plan, Step};
use super::state::Delta;
use super::{Depth, Outcome, Planner, Problem, Settings};
use crate::model::{Cost, Fact, Symbol};

/// After the best plan is found, alternatives are looked for with at most this many expansions,
/// or twice as many as the best plan took.
const EXPANSIONS_FOR_ALTERNATIVES: u64 = 200;

/// Best first, by cost plus estimate; forgets everything between two goals.
#[derive(Clone, Debug)]
pub struct NaivePlanner {
    settings: Settings,
    next_frame: u64,
    search: Option<Search>,
}

impl NaivePlanner {
    /// A planner that has nothing to do.
    pub fn new(settings: Settings) -> Self {
        Self {
            settings,
            next_frame: 0,
            search: None,
        }
    }
}

impl Planner for NaivePlanner {
    fn begin(&mut self, problem: Problem, agendas: &[Agenda]) {
        self.search = Some(Search::new(problem, agendas));
    }

    fn think(&mut self, expansions: u64) -> Option<Outcome> {
        let search = self.search.as_mut()?;
        let outcome = search.run(&self.settings, &mut self.next_frame, expansions)?;
        self.search = None;
        Some(outcome)
    }

    fn is_thinking(&self) -> bool {
        self.search.is_some()
    }

    fn stop(&mut self) {
        self.search = None;
    }

    fn number_frames_from(&mut self, first: u64) {
        self.next_frame = self.next_frame.max(first);
    }
}

/// A state, what is to be done in it, and how it was reached.
#[derive(Clone, Debug)]
struct Node {
    key: Arc<Key>,
    spent: Cost,
    /// Spent and estimated.
    total: Cost,
    parent: Option<usize>,
    step: Option<Step>,
}

#[derive(Debug, Eq, PartialEq, Ord, PartialOrd)]
struct Key {
    delta: Delta,
    tasks: TaskList,
}

#[derive(Clone, Debug)]
struct Search {
    problem: Problem,
    nodes: Vec<Node>,
    /// By total; among equals the one that has come furthest, then the oldest.
    frontier: BinaryHeap<Reverse<(Cost, Reverse<Cost>, usize)>>,
    /// How often a key was expanded: as often as there may be alternatives, since each of them
    /// may pass through it.
    expanded: BTreeMap<Arc<Key>, usize>,
    plans: Vec<Plan>,
    wanted: BTreeSet<Fact>,
    expansions: u64,
    expansions_of_best: u64,
    /// The predicates on which it hangs what can be done. Others are facts to remember, or bear
    /// on costs alone.
    decisive: BTreeSet<Symbol>,
}

impl Search {
    fn new(problem: Problem, agendas: &[Agenda]) -> Self {
        let mut search = Self {
            decisive: decisive(&problem.domain),
            problem,
            nodes: Vec::new(),
            frontier: BinaryHeap::new(),
            expanded: BTreeMap::new(),
            plans: Vec::new(),
            wanted: BTreeSet::new(),
            expansions: 0,
            expansions_of_best: 0,
        };
        for agenda in agendas {
            search.add(Delta::new(), agenda.tasks.clone(), Cost::ZERO, None, None);
        }
        search
    }

    fn add(
        &mut self,
        delta: Delta,
        tasks: TaskList,
        spent: Cost,
        parent: Option<usize>,
        step: Option<Step>,
    ) {
        let total = spent + estimate(&self.problem, &delta, &tasks);
        let index = self.nodes.len();
        self.nodes.push(Node {
            key: Arc::new(Key { delta, tasks }),
            spent,
            total,
            parent,
            step,
        });
        self.frontier.push(Reverse((total, Reverse(spent), index)));
    }

    /// Goes on for so many expansions; `None` if that was not enough.
    fn run(&mut self, settings: &Settings, next_frame: &mut u64, budget: u64) -> Option<Outcome> {
        let stop_at = self.expansions.saturating_add(budget);
        while let Some(Reverse((_, _, index))) = self.frontier.pop() {
            if self.is_plan(index, settings.depth) {
                self.keep(index);
                if self.plans.len() >= settings.alternatives {
                    break;
                }
                continue;
            }
            let spare = EXPANSIONS_FOR_ALTERNATIVES.max(2 * self.expansions_of_best);
            if !self.plans.is_empty() && self.expansions > self.expansions_of_best + spare {
                break;
            }
            let key = self.nodes[index].key.clone();
            let times = self.expanded.get(&key).copied().unwrap_or_default();
            if times >= settings.alternatives || self.goes_in_circles(index) {
                continue;
            }
            self.expanded.insert(key, times + 1);
            self.expand(index, next_frame);
            if self.expansions >= stop_at && !self.frontier.is_empty() {
                return None;
            }
        }
        let found = !self.plans.is_empty();
        Some(Outcome {
            plans: std::mem::take(&mut self.plans),
            wanted: std::mem::take(&mut self.wanted),
            expanded: self.expansions,
            expanded_for_best: match found {
                true => self.expansions_of_best,
                false => self.expansions,
            },
            evaluated: self.nodes.len() as u64,
            proved: true,
        })
    }

    fn expand(&mut self, index: usize, next_frame: &mut u64) {
        self.expansions += 1;
        let key = self.nodes[index].key.clone();
        let spent = self.nodes[index].spent;
        let found = successors(
            &self.problem,
            &key.delta,
            &key.tasks,
            next_frame,
            &mut self.wanted,
        );
        for next in found {
            // One millionth at least, so that nothing is free and every search in a finite space
            // of states ends.
            let cost = next
                .step
                .as_ref()
                .map_or(Cost(1), |step| step.cost.max(Cost(1)));
            self.add(next.delta, next.tasks, spent + cost, Some(index), next.step);
        }
    }

    /// Whether the same state with the same work lies on the way to this node.
    ///
    /// Of alternatives more is asked: one that only comes back to where something else could be
    /// done, by another door, is the best plan with a detour and of no use to anybody.
    fn goes_in_circles(&self, index: usize) -> bool {
        let key = &self.nodes[index].key;
        let detours = !self.plans.is_empty();
        let decides = |(fact, _): &(&Fact, &bool)| self.decisive.contains(&fact.name);
        self.way_to(index).skip(1).any(|node| {
            let before = &node.key;
            before == key
                || detours
                    && before.tasks == key.tasks
                    && (before.delta.iter().filter(decides)).eq(key.delta.iter().filter(decides))
        })
    }

    /// The node and those that lead to it, last first.
    fn way_to(&self, index: usize) -> impl Iterator<Item = &Node> {
        let mut at = Some(index);
        std::iter::from_fn(move || {
            let node = &self.nodes[at?];
            at = node.parent;
            Some(node)
        })
    }

    fn is_plan(&self, index: usize, depth: Depth) -> bool {
        self.nodes[index].key.tasks.is_empty()
            || depth.actions().is_some_and(|wanted| {
                let steps = self.way_to(index).filter(|node| node.step.is_some());
                steps.count() >= wanted
            })
    }

    fn keep(&mut self, index: usize) {
        let way = self.way_to(index);
        let mut steps: Vec<Step> = way.filter_map(|node| node.step.clone()).collect();
        steps.reverse();
        let node = &self.nodes[index];
        let estimate = Cost(node.total.0 - node.spent.0);
        let plan = Plan {
            cost: steps.iter().fold(estimate, |sum, step| sum + step.cost),
            rest: node.key.tasks.clone(),
            steps,
        };
        if self.plans.is_empty() {
            self.expansions_of_best = self.expansions;
        }
        let mut kept = self.plans.iter();
        if !kept.any(|kept| kept.purposes().eq(plan.purposes())) {
            self.plans.push(plan);
        }
    }
}
