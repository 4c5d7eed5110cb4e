//! Graphs of maps that are not planned on at present: they hear of changes when they are needed again.
//!
//! A robot that drives through one area after another changes what it believes at every node. Most
//! of that is never asked of the graphs of the areas that it has left.

use std::sync::Arc;

use super::GraphPlanner;
use super::key::Touched;
use super::nodes::Graph;
use crate::model::FactChange;

/// After so many changes it is cheaper to compare beliefs.
const MOST: usize = 32;

/// What a graph was not told yet.
#[derive(Clone, Debug, Default)]
pub(super) struct Behind {
    changes: Vec<Arc<[FactChange]>>,
    /// There were more. Whoever needs the graph compares its belief anyway.
    lost: bool,
}

impl Behind {
    pub fn is_empty(&self) -> bool {
        self.changes.is_empty() && !self.lost
    }

    fn add(&mut self, changes: &Arc<[FactChange]>) {
        self.lost |= self.changes.len() >= MOST;
        if self.lost {
            self.changes = Vec::new();
        } else {
            self.changes.push(changes.clone());
        }
    }
}

impl GraphPlanner {
    /// The belief has changed: the graph that is planned on hears of it, and the others will.
    pub(super) fn tell(&mut self, changes: &[FactChange]) {
        let Some((current, others)) = self.graphs.split_last_mut() else {
            return;
        };
        if changes.is_empty() {
            return;
        }
        if !others.is_empty() {
            let changes: Arc<[FactChange]> = changes.into();
            for graph in others {
                graph.behind.add(&changes);
            }
        }
        current.hear(changes);
    }
}

impl Graph {
    fn hear(&mut self, changes: &[FactChange]) {
        let mut touched = Touched::default();
        self.world.apply(changes, &mut touched);
        self.touched(&touched);
    }

    /// Hears of all that it was not told yet, unless that was too much: then it believes what it did
    /// before.
    pub fn catch_up(&mut self) {
        let behind = std::mem::take(&mut self.behind);
        if !behind.lost {
            for changes in behind.changes {
                self.hear(&changes);
            }
        }
    }
}
