//! What the graph can tell without being changed.

use std::borrow::Cow;

use super::intern::Map;
use super::lists::NIL;
use super::nodes::Graph;
use super::replay::Replay;
use super::world::World;
use super::{GraphPlanner, same_one};
use crate::model::Atom;
use crate::planner::network::{Item, TaskList};
use crate::planner::{Agenda, Plan, Problem};

impl GraphPlanner {
    /// The best way that is known for each agenda; see [`Planner::known`](super::Planner::known).
    pub(super) fn best_known<'a>(&'a self, problem: &Problem, agendas: &[Agenda]) -> Vec<Plan> {
        let here = |graph: &&Graph| {
            let world = &graph.world;
            same_one(&world.map, &problem.map)
                && same_one(&world.domain, &problem.domain)
                && same_one(&world.model, &problem.model)
        };
        // Of one that is behind, a copy is told, as nothing is to be changed.
        let told = |graph: &'a Graph| match graph.behind.is_empty() {
            true => Cow::Borrowed(graph),
            false => {
                let mut graph = graph.clone();
                graph.catch_up();
                Cow::Owned(graph)
            }
        };
        let knows = |graph: &Cow<'_, Graph>| graph.world.knows(&problem.belief);
        let Some(graph) = self.graphs.iter().filter(here).map(told).find(knows) else {
            return Vec::new();
        };
        let graph: &Graph = &graph;
        // The plans are shown, and forgotten again: their frames need no numbers of their own.
        let mut next_frame = self.next_frame;
        let mut replay = Replay::default();
        let found = agendas.iter().filter_map(|agenda| {
            let list = graph.world.find_list(&agenda.tasks)?;
            let roots = graph.realised(list).into_iter();
            let mut ways: Vec<(u64, Vec<u32>)> = roots
                .filter_map(|root| Some((graph.nodes[root as usize].v, follow(graph, root)?)))
                .collect();
            ways.sort();
            let (_, way) = ways.into_iter().next()?;
            let begin = replay.begin(&agenda.tasks);
            Some(replay.plan(graph, begin, &way, &mut next_frame))
        });
        let mut plans: Vec<Plan> = found.collect();
        plans.sort_by_key(|plan| plan.cost);
        plans
    }
}

/// The way that looks cheapest, if all of it is known. Costs need not be settled, so it might lead
/// in circles.
fn follow(graph: &Graph, root: u32) -> Option<Vec<u32>> {
    let mut way = vec![root];
    let mut seen = Map::from_iter([(root, ())]);
    let mut at = root;
    while graph.nodes[at as usize].list != NIL {
        if !graph.nodes[at as usize].expanded {
            return None;
        }
        at = graph.best_edge(at)?.to;
        if seen.insert(at, ()).is_some() {
            return None;
        }
        way.push(at);
    }
    Some(way)
}

impl World {
    /// The number of an atom, if it has one.
    fn find_atom(&self, atom: &Atom) -> Option<u32> {
        let names = [&atom.name].into_iter().chain(&atom.args);
        let words: Option<Vec<u32>> = names.map(|name| self.names.find(name)).collect();
        self.facts.find(&words?)
    }

    /// The number of a list of tasks, if it has one.
    fn find_list(&self, tasks: &TaskList) -> Option<u32> {
        let items: Vec<&Item> = tasks.items().collect();
        items.into_iter().rev().try_fold(NIL, |rest, item| {
            let atom = self.find_atom(item.atom())?;
            self.lists.find(item, atom, rest)
        })
    }
}
