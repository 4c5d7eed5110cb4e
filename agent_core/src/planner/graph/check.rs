//! What always holds of the graph, for tests to assert.

use super::GraphPlanner;
use super::decompose;
use super::lists::NIL;
use super::nodes::{Dependency, Graph, INFINITE};
use crate::model::FactChange;
use crate::planner::{Agenda, TaskList};

impl GraphPlanner {
    /// Whether the graph that was used last is sound; else what is not. Finishes what is to be
    /// looked at again first.
    pub(super) fn check(&mut self) -> Result<(), String> {
        let Some(graph) = self.graphs.last_mut() else {
            return Ok(());
        };
        graph.settle();
        graph.check_costs()?;
        graph.check_subscriptions()?;
        graph.check_edges()?;
        graph.check_equals()?;
        let roots = self.thinking.iter().flat_map(|thinking| &thinking.roots);
        for root in roots {
            let delta = graph.nodes[*root as usize].delta;
            if !graph.world.is_realised(delta) {
                return Err(format!("I1: root {root} says what is not so"));
            }
        }
        Ok(())
    }
}

/// What a node is, and what it costs from there.
pub(super) type Costs = Vec<((u32, u32), u64)>;

impl GraphPlanner {
    /// Puts everything right, and says what each node costs.
    pub(super) fn costs(&mut self) -> Costs {
        let Some(graph) = self.graphs.last_mut() else {
            return Costs::new();
        };
        graph.settle();
        let known = graph.nodes.iter().filter(|node| !node.is_free());
        known
            .map(|node| ((node.list, node.delta), node.v))
            .collect()
    }

    /// Gives up what these agendas do not lead to, in all graphs.
    pub(super) fn forget(&mut self, agendas: &[Agenda]) {
        for graph in &mut self.graphs {
            graph.forget_all_but(agendas, &self.kept);
        }
    }

    /// Puts everything right.
    pub(super) fn settle(&mut self) {
        if let Some(graph) = self.graphs.last_mut() {
            graph.settle();
        }
    }

    /// I11: as many nodes are looked at again as have asked for one of these facts and whose deltas
    /// say nothing of it. Nothing must be left to be looked at before.
    pub(super) fn check_reach(&mut self, changes: &[FactChange]) -> Result<(), String> {
        let Some(graph) = self.graphs.last_mut() else {
            return Ok(());
        };
        let mut touched = super::key::Touched::default();
        graph.world.apply(changes, &mut touched);
        if touched.all {
            graph.touched(&touched);
            return Ok(());
        }
        let mut concerned = std::collections::BTreeSet::new();
        for (number, node) in graph.nodes.iter().enumerate().filter(|(_, n)| !n.is_free()) {
            for (key, variable) in &touched.keys {
                let key = graph.keys.get(key).copied();
                let asked = node.dependencies.iter().any(|d| Some(d.key) == key);
                if asked && !graph.world.shadows(node.delta, *variable) {
                    concerned.insert(number);
                }
            }
        }
        graph.touched(&touched);
        let before = graph.work.reevaluated;
        graph.settle();
        let looked_at = graph.work.reevaluated - before;
        match looked_at == concerned.len() as u64 {
            true => Ok(()),
            false => Err(format!("I11: {looked_at} and not {}", concerned.len())),
        }
    }

    /// I12: an action that was carried out as predicted leaves everything below it as it is.
    pub(super) fn check_advance(
        &mut self,
        rest: &TaskList,
        changes: &[FactChange],
    ) -> Result<(), String> {
        let Some(graph) = self.graphs.last_mut() else {
            return Ok(());
        };
        let list = graph.world.list(rest);
        let mut touched = super::key::Touched::default();
        graph.world.apply(changes, &mut touched);
        graph.touched(&touched);
        if touched.all {
            return Ok(());
        }
        let realised = graph.realised(list);
        let untouched = |root: &u32| {
            let mut open = vec![*root];
            let mut seen = std::collections::BTreeSet::from([*root]);
            while let Some(node) = open.pop() {
                let node = &graph.nodes[node as usize];
                if node.dirty {
                    return false;
                }
                let new = node.out.iter().map(|edge| edge.to);
                open.extend(new.filter(|to| seen.insert(*to)));
            }
            true
        };
        match realised.iter().any(untouched) {
            true => Ok(()),
            false => Err(format!("I12: all of {realised:?} are touched below")),
        }
    }
}

impl Graph {
    fn settle(&mut self) {
        while self.reevaluate_one() || self.repair_one() {}
    }

    /// I2.
    fn check_costs(&self) -> Result<(), String> {
        for (number, node) in self.nodes.iter().enumerate().filter(|(_, n)| !n.is_free()) {
            if node.v != node.rhs {
                return Err(format!(
                    "I2: {number} costs {} and not {}",
                    node.v, node.rhs
                ));
            }
            let through = node.out.iter().map(|edge| {
                let to = &self.nodes[edge.to as usize];
                edge.weight().saturating_add(to.v)
            });
            let least = through.min().unwrap_or(INFINITE);
            if node.list == NIL && node.v != 0
                || node.list != NIL && node.expanded && node.v != least
            {
                return Err(format!("I2: {number} costs {} and not {least}", node.v));
            }
        }
        Ok(())
    }

    /// I3, of what is noted; that it is all that was asked is part of I4.
    fn check_subscriptions(&self) -> Result<(), String> {
        let mut noted = 0;
        for (number, node) in self.nodes.iter().enumerate().filter(|(_, n)| !n.is_free()) {
            noted += node.dependencies.len();
            for (place, Dependency { key, at }) in node.dependencies.iter().enumerate() {
                let subscription = self.subscriptions[*key as usize].get(*at as usize);
                let right = subscription
                    .is_some_and(|s| (s.node as usize, s.dependency as usize) == (number, place));
                if !right {
                    return Err(format!("I3: {number} is not noted with its key {place}"));
                }
            }
        }
        let all: usize = self.subscriptions.iter().map(Vec::len).sum();
        if all != noted {
            return Err(format!("I3: {all} subscriptions, {noted} dependencies"));
        }
        Ok(())
    }

    /// Nodes that mean the same because all that their deltas say is so cost the same.
    fn check_equals(&self) -> Result<(), String> {
        let mut costs: std::collections::BTreeMap<u32, (usize, u64)> = Default::default();
        for (number, node) in self.nodes.iter().enumerate().filter(|(_, n)| !n.is_free()) {
            if !self.world.is_realised(node.delta) || !self.is_explored(number as u32) {
                continue;
            }
            let (first, v) = *costs.entry(node.list).or_insert((number, node.v));
            if v != node.v {
                return Err(format!(
                    "{first} and {number} mean the same, and cost {v} and {}",
                    node.v
                ));
            }
        }
        Ok(())
    }

    /// Whether the cheapest way from a node is known to its end, or that there is none.
    fn is_explored(&self, node: u32) -> bool {
        self.nodes[node as usize].v == INFINITE || super::search::walk(self, node, None).is_some()
    }

    /// I4, and the other half of I3.
    fn check_edges(&mut self) -> Result<(), String> {
        for number in 0..self.nodes.len() {
            let node = self.nodes[number].clone();
            if node.is_free() {
                continue;
            }
            let mut reads;
            if node.expanded {
                let found = decompose::ways(&mut self.world, node.list, node.delta);
                reads = found.reads;
                let mut fresh = Vec::new();
                for way in found.ways {
                    let to = self.table.get(&(way.list, way.delta));
                    fresh.push((to.copied(), way.cost));
                }
                for (to, cost) in &fresh {
                    let kept = node.out.iter().find(|edge| Some(edge.to) == *to);
                    if kept.is_none_or(|edge| edge.cost > *cost) {
                        return Err(format!("I4: {number} has a way that is not kept"));
                    }
                }
                for edge in &node.out {
                    if !fresh.contains(&(Some(edge.to), edge.cost)) {
                        return Err(format!("I4: {number} keeps a way that it has not"));
                    }
                }
            } else {
                let (estimate, asked) = decompose::estimate(&mut self.world, node.list, node.delta);
                reads = asked;
                if estimate != node.v {
                    return Err(format!("I4: {number} is estimated wrongly"));
                }
            }
            reads.sort_unstable();
            reads.dedup();
            let mut kept: Vec<u32> = node.dependencies.iter().map(|d| d.key).collect();
            let mut asked: Vec<u32> = reads
                .iter()
                .filter_map(|r| self.keys.get(r))
                .copied()
                .collect();
            kept.sort_unstable();
            asked.sort_unstable();
            if kept != asked || asked.len() != reads.len() {
                return Err(format!("I3: {number} has asked for something else"));
            }
        }
        Ok(())
    }
}
