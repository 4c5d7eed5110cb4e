//! What remains to be done: lists of tasks that remember what they are parts of.

use std::cmp::Ordering;
use std::fmt;
use std::sync::Arc;

use crate::model::{Action, Task};
use crate::protocol::ActionId;

/// One thing to be done.
#[derive(Clone, Debug, Eq, PartialEq, Ord, PartialOrd)]
pub enum Item {
    /// A task, abstract or not.
    Task(Task),
    /// Take up a suspended action (the paper, section 4: the resuming action).
    Resume {
        /// The execution whose record is taken up.
        id: ActionId,
        /// The action that was suspended.
        original: Action,
        /// The resuming action.
        action: Action,
    },
    /// Undo a suspended action (the rollback action).
    RollBack {
        /// The execution that is undone.
        id: ActionId,
        /// The rollback action.
        action: Action,
    },
}

impl Item {
    /// The task or action as the domain names it.
    pub fn atom(&self) -> &Task {
        match self {
            Self::Task(task) => task,
            Self::Resume { action, .. } | Self::RollBack { action, .. } => action,
        }
    }

    /// What it brings the robot forward by: a resuming action stands for the action that it
    /// resumes.
    pub fn purpose(&self) -> &Task {
        match self {
            Self::Resume { original, .. } => original,
            Self::Task(task) | Self::RollBack { action: task, .. } => task,
        }
    }

    /// Whether it takes up or undoes this execution.
    pub fn needs(&self, record: &ActionId) -> bool {
        match self {
            Self::Resume { id, .. } | Self::RollBack { id, .. } => id == record,
            Self::Task(_) => false,
        }
    }
}

/// A task that was decomposed, and what follows it: enough to do it again (decision 13).
#[derive(Debug)]
pub struct Frame {
    /// Unique among the frames of an agent.
    pub id: u64,
    /// The task.
    pub task: Item,
    /// What is to be done after it.
    pub rest: TaskList,
    /// The task that this one is a part of; `None` for a task of the goal itself.
    pub parent: Option<Arc<Frame>>,
}

/// Tasks in the order in which they are to be done. Cheap to clone; tails are shared.
///
/// Lists compare by their items alone: two ways to arrive at the same work are the same work.
#[derive(Clone, Default)]
pub struct TaskList(Option<Arc<Cell>>);

struct Cell {
    item: Item,
    frame: Option<Arc<Frame>>,
    rest: TaskList,
    length: usize,
}

impl TaskList {
    /// Nothing to do.
    pub fn empty() -> Self {
        Self(None)
    }

    /// Tasks that are not part of another one.
    pub fn of_tasks(tasks: impl DoubleEndedIterator<Item = Task>) -> Self {
        tasks.rev().fold(Self::empty(), |rest, task| {
            rest.prepend(Item::Task(task), None)
        })
    }

    /// `item` first, then this.
    #[must_use]
    pub fn prepend(&self, item: Item, frame: Option<Arc<Frame>>) -> Self {
        Self(Some(Arc::new(Cell {
            item,
            frame,
            rest: self.clone(),
            length: self.len() + 1,
        })))
    }

    /// The first item, the task that it is a part of, and what follows.
    pub fn first(&self) -> Option<(&Item, Option<&Arc<Frame>>, &Self)> {
        self.0
            .as_ref()
            .map(|cell| (&cell.item, cell.frame.as_ref(), &cell.rest))
    }

    /// Whether nothing is left to do.
    pub fn is_empty(&self) -> bool {
        self.0.is_none()
    }

    /// How many items.
    pub fn len(&self) -> usize {
        self.0.as_ref().map_or(0, |cell| cell.length)
    }

    /// Where it is, which tells lists that share their cells from lists that only look alike. Says
    /// nothing once the list is dropped.
    pub(crate) fn address(&self) -> Option<usize> {
        self.0.as_ref().map(|cell| Arc::as_ptr(cell).addr())
    }

    /// The items in order.
    pub fn items(&self) -> impl Iterator<Item = &Item> {
        let mut at = self;
        std::iter::from_fn(move || {
            let (item, _, rest) = at.first()?;
            at = rest;
            Some(item)
        })
    }
}

impl PartialEq for TaskList {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for TaskList {}

impl PartialOrd for TaskList {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for TaskList {
    fn cmp(&self, other: &Self) -> Ordering {
        let (mut a, mut b) = (self, other);
        loop {
            match (&a.0, &b.0) {
                (None, None) => return Ordering::Equal,
                (None, Some(_)) => return Ordering::Less,
                (Some(_), None) => return Ordering::Greater,
                (Some(x), Some(y)) if Arc::ptr_eq(x, y) => return Ordering::Equal,
                (Some(x), Some(y)) => {
                    let first = x.length.cmp(&y.length).then_with(|| x.item.cmp(&y.item));
                    if first.is_ne() {
                        return first;
                    }
                    (a, b) = (&x.rest, &y.rest);
                }
            }
        }
    }
}

impl fmt::Debug for TaskList {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(self.items()).finish()
    }
}

impl Drop for TaskList {
    fn drop(&mut self) {
        let_go(self.0.take(), None);
    }
}

impl Drop for Frame {
    fn drop(&mut self) {
        let_go(self.rest.0.take(), self.parent.take());
    }
}

/// Drops cells and frames that nobody else holds, and what only they hold. Not by recursion: lists
/// may be longer, and tasks nested more deeply, than the stack is deep.
fn let_go(mut cell: Option<Arc<Cell>>, frame: Option<Arc<Frame>>) {
    let mut frames: Vec<Arc<Frame>> = frame.into_iter().collect();
    loop {
        while let Some(last) = cell {
            cell = Arc::into_inner(last).and_then(|mut last| {
                // A frame that others hold as well is no work.
                let frame = last.frame.take();
                frames.extend(frame.filter(|frame| Arc::strong_count(frame) == 1));
                last.rest.0.take()
            });
        }
        let Some(frame) = frames.pop() else {
            return;
        };
        if let Some(mut frame) = Arc::into_inner(frame) {
            frames.extend(frame.parent.take());
            cell = frame.rest.0.take();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Atom;

    #[test]
    fn tasks_may_be_nested_more_deeply_than_the_stack_is_deep() {
        let task = || Item::Task(Atom::new("wander", []));
        let mut parent: Option<Arc<Frame>> = None;
        let mut list = TaskList::empty();
        for id in 0..1_000_000 {
            // Of every third only the list knows the frame.
            let above = if id % 3 == 0 { None } else { parent.clone() };
            let frame = Arc::new(Frame {
                id,
                task: task(),
                rest: list.clone(),
                parent: above,
            });
            list = list.prepend(task(), parent.replace(frame));
        }
        assert_eq!(list.len(), 1_000_000);
        drop(list);
        drop(parent);
    }
}
