//! Whether a plan that was kept is one of the best.
//!
//! Where an emergency has not touched a suspended plan, this is all the planning there is: the few
//! nodes that a change bears on are looked at again, those between what was interrupted and what is
//! known are expanded, and the plan is followed through the graph. No other plans are looked for.

use super::lists::NIL;
use super::nodes::Graph;
use super::{GraphPlanner, Stage, VISITS_PER_EXPANSION};
use crate::model::Cost;
use crate::planner::{Confirmed, Plan};

/// If it takes more than so many expansions, it is not told.
const EXPANSIONS: u64 = 200;
/// So many visits for every step of the plan, as there may be several best ways to begin it.
const VISITS_PER_STEP: usize = 8;

impl GraphPlanner {
    /// See [`Planner::confirm`](super::Planner::confirm).
    pub(super) fn confirmed(&mut self, kept: &Plan) -> Option<Confirmed> {
        let thinking = self.thinking.as_mut()?;
        if kept.steps.is_empty()
            || !kept.rest.is_empty()
            || self.settings.depth.actions().is_some()
            || std::mem::replace(&mut thinking.is_in_doubt, true)
        {
            return None;
        }
        self.go_on(EXPANSIONS * VISITS_PER_EXPANSION, true);
        let graph = self.graphs.last_mut()?;
        let thinking = self.thinking.as_ref()?;
        if !matches!(thinking.stage, Stage::Others(_)) || !thinking.proved {
            return None;
        }
        let cost = |root: &u32| graph.nodes[*root as usize].v;
        let least = thinking.roots.iter().map(cost).min()?;
        let best = thinking.roots.iter().copied();
        let best: Vec<u32> = best.filter(|root| cost(root) == least).collect();
        let entries = kept.steps.iter();
        let entries: Vec<u32> = entries.map(|step| graph.world.entry(&step.item)).collect();
        let cost = graph.follow(best, &entries)?;
        let (work, before) = (graph.work, thinking.before);
        Some(Confirmed {
            cost: Cost(cost),
            expanded: work.expanded - before.expanded,
            evaluated: work.evaluated() - before.evaluated(),
        })
    }
}

impl Graph {
    /// What a way costs that does these things and no others and is nowhere dearer than the cheapest,
    /// if there is one from one of the roots; costs must be settled.
    fn follow(&self, roots: Vec<u32>, entries: &[u32]) -> Option<u64> {
        let mut open: Vec<(u32, usize, u64)> = roots.into_iter().map(|root| (root, 0, 0)).collect();
        for _ in 0..VISITS_PER_STEP * (entries.len() + 1) {
            let (node, done, spent) = open.pop()?;
            let known = &self.nodes[node as usize];
            let Some((entry, _)) = self.world.lists.first(known.list) else {
                debug_assert_eq!(known.list, NIL);
                if done == entries.len() {
                    return Some(spent);
                }
                continue;
            };
            if !known.expanded {
                continue;
            }
            let acts = self.is_action(node);
            if acts && entries.get(done) != Some(&entry) {
                continue;
            }
            let through = |to: u32, weight: u64| weight.saturating_add(self.nodes[to as usize].v);
            // The first way of the domain's on top.
            for edge in known.out.iter().rev() {
                if through(edge.to, edge.weight()) == known.v {
                    open.push((edge.to, done + usize::from(acts), spent + edge.cost));
                }
            }
        }
        None
    }
}
