//! From ways through the graph to plans, in the words of everybody else.

use std::sync::Arc;

use super::intern::Map;
use super::nodes::{Graph, INFINITE};
use crate::model::Cost;
use crate::planner::network::{Frame, Item, TaskList};
use crate::planner::plan::{Plan, Step};

/// Ways that were gone already, so that plans that begin alike are parts of the same tasks.
#[derive(Debug, Default)]
pub(super) struct Replay {
    gone: Vec<Gone>,
    next: Map<(usize, u32), usize>,
}

#[derive(Debug)]
struct Gone {
    tasks: TaskList,
    step: Option<Step>,
}

impl Replay {
    /// Ways may begin with these tasks. Returns the number of the beginning.
    pub fn begin(&mut self, tasks: &TaskList) -> usize {
        self.gone.push(Gone {
            tasks: tasks.clone(),
            step: None,
        });
        self.gone.len() - 1
    }

    /// The plan of a way through the graph.
    pub fn plan(&mut self, graph: &Graph, begin: usize, way: &[u32], next_frame: &mut u64) -> Plan {
        let mut at = begin;
        let mut steps = Vec::new();
        for pair in way.windows(2) {
            at = self.go(graph, at, pair[0], pair[1], next_frame);
            steps.extend(self.gone[at].step.clone());
        }
        let estimate = way.last().map_or(0, |last| graph.nodes[*last as usize].v);
        let estimate = if estimate == INFINITE { 0 } else { estimate };
        Plan {
            cost: steps
                .iter()
                .fold(Cost(estimate), |sum, step: &Step| sum + step.cost),
            rest: self.gone[at].tasks.clone(),
            steps,
        }
    }

    fn go(&mut self, graph: &Graph, at: usize, from: u32, to: u32, next_frame: &mut u64) -> usize {
        if let Some(known) = self.next.get(&(at, to)) {
            return *known;
        }
        let tasks = self.gone[at].tasks.clone();
        let gone = match tasks.first() {
            Some((item, frame, rest)) if graph.is_action(from) => {
                let out = &graph.nodes[from as usize].out;
                let cost = out.iter().find(|edge| edge.to == to).map_or(0, |e| e.cost);
                Gone {
                    tasks: rest.clone(),
                    step: Some(Step {
                        item: item.clone(),
                        cost: Cost(cost),
                        frame: frame.cloned(),
                        rest: rest.clone(),
                    }),
                }
            }
            Some((item, parent, rest)) => {
                let frame = Arc::new(Frame {
                    id: *next_frame,
                    task: item.clone(),
                    rest: rest.clone(),
                    parent: parent.cloned(),
                });
                *next_frame += 1;
                Gone {
                    tasks: graph.decomposed(to, rest, &frame),
                    step: None,
                }
            }
            None => Gone { tasks, step: None },
        };
        self.gone.push(gone);
        let gone = self.gone.len() - 1;
        self.next.insert((at, to), gone);
        gone
    }
}

impl Graph {
    /// The tasks at a node that comes of decomposing a task that `rest` follows.
    fn decomposed(&self, node: u32, rest: &TaskList, frame: &Arc<Frame>) -> TaskList {
        let lists = &self.world.lists;
        let mut subtasks = Vec::new();
        let mut list = self.nodes[node as usize].list;
        while (lists.len(list) as usize) > rest.len()
            && let Some((entry, after)) = lists.first(list)
        {
            subtasks.push(self.world.name_atom(lists.entry(entry).atom));
            list = after;
        }
        let subtasks = subtasks.into_iter().rev();
        subtasks.fold(rest.clone(), |rest, task| {
            rest.prepend(Item::Task(task), Some(frame.clone()))
        })
    }

    /// Whether the first of what is left to do at a node is an action.
    pub fn is_action(&self, node: u32) -> bool {
        let list = self.nodes[node as usize].list;
        let first = self.world.lists.first(list);
        first.is_some_and(|(entry, _)| {
            let atom = self.world.lists.entry(entry).atom;
            let name = self.world.facts.name(atom);
            self.world.code.operators.contains_key(&name)
        })
    }
}
