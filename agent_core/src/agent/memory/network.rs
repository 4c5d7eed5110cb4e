//! Task lists and frames, which share most of what they are made of, as rows and back.

use std::sync::Arc;

use hashbrown::HashMap;
use rustc_hash::FxBuildHasher;

use super::rows::{AtomRow, FrameRow, ItemRow, ListRow, NetworkRow, NodeRow, StepRow};
use crate::model::{Atom, Cost, Domain, Symbol};
use crate::planner::{Frame, Item, Step, TaskList};

/// Far more than are ever counted, and far from where numbers end.
pub(super) const HIGHEST: u64 = 1 << 60;

/// Writes lists and frames, each once.
#[derive(Default)]
pub(super) struct Writer {
    row: NetworkRow,
    names: HashMap<Symbol, u32, FxBuildHasher>,
    /// Where each cell and frame was written. They live while they are written, so that no two are
    /// at the same address.
    written: HashMap<usize, u32, FxBuildHasher>,
}

#[derive(Clone, Copy)]
enum Node<'a> {
    Cell(&'a TaskList, usize),
    Frame(&'a Arc<Frame>),
}

impl<'a> Node<'a> {
    fn of_list(list: &'a TaskList) -> Option<Self> {
        Some(Self::Cell(list, list.address()?))
    }

    fn address(self) -> usize {
        match self {
            Self::Cell(_, address) => address,
            Self::Frame(frame) => Arc::as_ptr(frame).addr(),
        }
    }

    /// The list and the frame that it is made of.
    fn parts(self) -> [Option<Self>; 2] {
        let (list, frame) = match self {
            Self::Cell(list, _) => match list.first() {
                Some((_, frame, rest)) => (Some(rest), frame),
                None => (None, None),
            },
            Self::Frame(frame) => (Some(&frame.rest), frame.parent.as_ref()),
        };
        [list.and_then(Node::of_list), frame.map(Node::Frame)]
    }
}

impl Writer {
    /// All that was written.
    pub fn finish(self) -> NetworkRow {
        self.row
    }

    pub fn list(&mut self, list: &TaskList) -> ListRow {
        Node::of_list(list).map(|node| self.node(node))
    }

    pub fn step(&mut self, step: &Step) -> StepRow {
        StepRow {
            item: self.item(&step.item),
            cost: step.cost.0,
            frame: step.frame.as_ref().map(|f| self.node(Node::Frame(f))),
            rest: self.list(&step.rest),
        }
    }

    /// Not by recursion: lists are long.
    fn node(&mut self, node: Node<'_>) -> u32 {
        if let Some(known) = self.written.get(&node.address()) {
            return *known;
        }
        let mut open = vec![node];
        let mut last = 0;
        while let Some(node) = open.last().copied() {
            let parts = node.parts();
            let new = |part: &Node<'_>| !self.written.contains_key(&part.address());
            let before = open.len();
            open.extend(parts.iter().flatten().copied().filter(new));
            if open.len() > before {
                continue;
            }
            open.pop();
            // It may have been met on two ways.
            if new(&node) {
                let [list, frame] =
                    parts.map(|part| part.and_then(|p| self.written.get(&p.address()).copied()));
                last = self.add(node, list, frame);
            }
        }
        last
    }

    fn add(&mut self, node: Node<'_>, rest: ListRow, frame: FrameRow) -> u32 {
        let row = match node {
            Node::Cell(list, _) => {
                let Some((item, _, _)) = list.first() else {
                    return 0;
                };
                let item = self.item(item);
                NodeRow::Cell { item, frame, rest }
            }
            Node::Frame(of) => NodeRow::Frame {
                id: of.id,
                task: self.item(&of.task),
                rest,
                parent: frame,
            },
        };
        let place = self.row.nodes.len() as u32;
        self.row.nodes.push(row);
        self.written.insert(node.address(), place);
        place
    }

    fn item(&mut self, item: &Item) -> ItemRow {
        match item {
            Item::Task(task) => ItemRow::Task(self.atom(task)),
            Item::Resume {
                id,
                original,
                action,
            } => ItemRow::Resume {
                id: id.clone(),
                original: self.atom(original),
                action: self.atom(action),
            },
            Item::RollBack { id, action } => ItemRow::RollBack {
                id: id.clone(),
                action: self.atom(action),
            },
        }
    }

    fn atom(&mut self, atom: &Atom) -> AtomRow {
        let names = std::iter::once(&atom.name).chain(&atom.args);
        names.map(|name| self.name(name)).collect()
    }

    fn name(&mut self, name: &Symbol) -> u32 {
        if let Some(known) = self.names.get(name) {
            return *known;
        }
        let place = self.row.names.len() as u32;
        self.row.names.push(name.clone());
        self.names.insert(name.clone(), place);
        place
    }
}

/// Reads what a [`Writer`] has written, and trusts none of it.
pub(super) struct Reader<'a> {
    domain: &'a Domain,
    names: Vec<Symbol>,
    nodes: Vec<Read>,
    /// Higher than the number of any frame.
    pub next_frame: u64,
}

enum Read {
    List(TaskList),
    Frame(Arc<Frame>),
}

impl<'a> Reader<'a> {
    pub fn new(domain: &'a Domain, row: NetworkRow) -> Result<Self, String> {
        let mut reader = Self {
            domain,
            names: row.names,
            nodes: Vec::new(),
            next_frame: 0,
        };
        for node in row.nodes {
            // Only what is before it is there by now.
            let node = match node {
                NodeRow::Cell { item, frame, rest } => {
                    let (item, frame) = (reader.item(item)?, reader.frame(frame)?);
                    Read::List(reader.list(rest)?.prepend(item, frame))
                }
                NodeRow::Frame {
                    id,
                    task,
                    rest,
                    parent,
                } => Read::Frame(Arc::new(Frame {
                    id: reader.number_of_frame(id)?,
                    task: reader.item(task)?,
                    rest: reader.list(rest)?,
                    parent: reader.frame(parent)?,
                })),
            };
            reader.nodes.push(node);
        }
        Ok(reader)
    }

    pub fn number_of_frame(&mut self, number: u64) -> Result<u64, String> {
        if number >= HIGHEST {
            return Err(format!("no frame has the number {number}"));
        }
        self.next_frame = self.next_frame.max(number + 1);
        Ok(number)
    }

    pub fn list(&self, row: ListRow) -> Result<TaskList, String> {
        let Some(place) = row else {
            return Ok(TaskList::empty());
        };
        match self.nodes.get(place as usize) {
            Some(Read::List(list)) => Ok(list.clone()),
            _ => Err(format!("there is no list at {place}")),
        }
    }

    fn frame(&self, row: FrameRow) -> Result<Option<Arc<Frame>>, String> {
        let Some(place) = row else {
            return Ok(None);
        };
        match self.nodes.get(place as usize) {
            Some(Read::Frame(frame)) => Ok(Some(frame.clone())),
            _ => Err(format!("there is no frame at {place}")),
        }
    }

    pub fn step(&self, row: StepRow) -> Result<Step, String> {
        let item = self.item(row.item)?;
        if !self.domain.operators.contains_key(&item.atom().name) {
            return Err(format!("`{}` is no action of the domain", item.atom().name));
        }
        Ok(Step {
            item,
            cost: Cost(row.cost),
            frame: self.frame(row.frame)?,
            rest: self.list(row.rest)?,
        })
    }

    fn item(&self, row: ItemRow) -> Result<Item, String> {
        Ok(match row {
            ItemRow::Task(task) => Item::Task(self.atom(&task)?),
            ItemRow::Resume {
                id,
                original,
                action,
            } => Item::Resume {
                id,
                original: self.atom(&original)?,
                action: self.atom(&action)?,
            },
            ItemRow::RollBack { id, action } => Item::RollBack {
                id,
                action: self.atom(&action)?,
            },
        })
    }

    fn atom(&self, row: &AtomRow) -> Result<Atom, String> {
        let name = |place: &u32| {
            let name = self.names.get(*place as usize).cloned();
            name.ok_or_else(|| format!("there is no name at {place}"))
        };
        let Some((first, args)) = row.split_first() else {
            return Err("a task has no name".to_owned());
        };
        let atom = Atom {
            name: name(first)?,
            args: args.iter().map(name).collect::<Result<_, _>>()?,
        };
        understood(self.domain, &atom)?;
        Ok(atom)
    }
}

/// Whether it is a task or an action of the domain, with as many arguments.
pub(super) fn understood(domain: &Domain, task: &Atom) -> Result<(), String> {
    let operator = domain.operators.get(&task.name).map(|o| &o.parameters);
    let Some(parameters) = domain.tasks.get(&task.name).or(operator) else {
        return Err(format!(
            "`{}` is no task or action of the domain",
            task.name
        ));
    };
    if parameters.len() != task.args.len() {
        return Err(format!(
            "{task} has {} argument(s) where the domain has {}",
            task.args.len(),
            parameters.len()
        ));
    }
    Ok(())
}
