//! Which actions a task may come to, in the end.

use rustc_hash::FxHashMap;

use crate::ground::Model;
use crate::ground::model::Task;

/// Tasks with more tasks than this below them are taken to have everything below them.
const MOST: usize = 4096;
/// At most so many actions are kept, over all tasks.
const MOST_KEPT: usize = 1 << 26;

/// Actions below tasks, found when first asked for.
pub(crate) struct Closures<'m> {
    model: &'m Model,
    /// Sorted; `None` if there are too many.
    known: FxHashMap<u32, Option<Box<[u32]>>>,
    seen: Vec<u32>,
    stamp: u32,
    kept: usize,
}

impl<'m> Closures<'m> {
    /// None found yet.
    pub fn new(model: &'m Model) -> Self {
        Self {
            model,
            known: FxHashMap::default(),
            seen: vec![0; model.tasks.len()],
            stamp: 0,
            kept: 0,
        }
    }

    /// Whether the action is among what `task` may come to.
    pub fn has(&mut self, task: u32, action: u32) -> bool {
        if !self.known.contains_key(&task) {
            let found = (self.kept < MOST_KEPT).then(|| self.find(task)).flatten();
            self.kept += found.as_ref().map_or(0, |actions| actions.len());
            self.known.insert(task, found);
        }
        match self.known.get(&task) {
            Some(Some(actions)) => actions.binary_search(&action).is_ok(),
            _ => true,
        }
    }

    fn find(&mut self, task: u32) -> Option<Box<[u32]>> {
        self.stamp += 1;
        let mut actions = Vec::new();
        let mut open = vec![task];
        let mut count = 0;
        while let Some(task) = open.pop() {
            if std::mem::replace(&mut self.seen[task as usize], self.stamp) == self.stamp {
                continue;
            }
            count += 1;
            if count > MOST {
                return None;
            }
            if let Task::Action(action) = self.model.tasks[task as usize] {
                actions.push(action);
            }
            for method in self.model.methods_of(task) {
                open.extend_from_slice(self.model.get(self.model.methods[method].subs));
            }
        }
        actions.sort_unstable();
        Some(actions.into())
    }
}
