//! A plan with its decomposition tree.

use std::sync::Arc;

use agent_core::language::Spelling;
use agent_core::model::{Atom, Cost, Symbol};

use super::Choices;
use crate::compile::{Compiled, MethodId, ObjectId, Step};

/// A place in the decomposition tree.
#[derive(Clone, Copy, Debug, Eq, PartialEq, Ord, PartialOrd, Hash)]
pub struct NodeId(pub u32);

/// An action, or a task with the method that decomposed it.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    /// What it is.
    pub step: Step,
    /// How it was decomposed; none for actions.
    pub method: Option<MethodId>,
    first_argument: u32,
    first_child: u32,
}

/// A plan with its decomposition tree, and how it was found.
///
/// The tree is flat lists: a plan may have millions of steps, one below the other.
#[derive(Clone, Debug)]
pub struct Solution {
    compiled: Arc<Compiled>,
    nodes: Vec<Node>,
    arguments: Vec<ObjectId>,
    actions: Vec<NodeId>,
    cost: Cost,
    /// Whether no plan is cheaper (proved, and only then `true`).
    pub optimal: bool,
}

impl Solution {
    /// The plan that the choices make; `None` if they make none, which would be an error of the
    /// search. Whether preconditions hold is not looked at.
    pub fn new(compiled: &Arc<Compiled>, choices: &Choices) -> Option<Self> {
        let mut solution = Self {
            compiled: Arc::clone(compiled),
            nodes: Vec::new(),
            arguments: Vec::new(),
            actions: Vec::new(),
            cost: Cost::ZERO,
            optimal: false,
        };
        solution.nodes.push(Node {
            step: Step::Task(compiled.top),
            method: None,
            first_argument: 0,
            first_child: 0,
        });
        let mut choices = choices.iter(compiled);
        let mut open = vec![NodeId(0)];
        while let Some(id) = open.pop() {
            let node = solution.nodes[id.0 as usize];
            let Step::Action(action) = node.step else {
                let (method, bindings) = choices.next()?;
                solution.decompose(id, method, bindings, &mut open)?;
                continue;
            };
            if !compiled.is_artificial(node.step) {
                solution.cost = solution.cost + compiled.cost(action, solution.arguments(id));
                solution.actions.push(id);
            }
        }
        choices.next().is_none().then_some(solution)
    }

    fn decompose(
        &mut self,
        id: NodeId,
        method: MethodId,
        bindings: &[ObjectId],
        open: &mut Vec<NodeId>,
    ) -> Option<()> {
        let first_child = u32::try_from(self.nodes.len()).ok()?;
        let node = &mut self.nodes[id.0 as usize];
        let chosen = self.compiled.method(method);
        if node.step != Step::Task(chosen.task) {
            return None;
        }
        node.method = Some(method);
        node.first_child = first_child;
        for subtask in &chosen.subtasks {
            let first_argument = u32::try_from(self.arguments.len()).ok()?;
            let args = subtask.args.iter().map(|term| term.value(bindings));
            self.arguments.extend(args);
            self.nodes.push(Node {
                step: subtask.step,
                method: None,
                first_argument,
                first_child: 0,
            });
        }
        let last_child = u32::try_from(self.nodes.len()).ok()?;
        open.extend((first_child..last_child).rev().map(NodeId));
        Some(())
    }

    /// Spells all names as their authors did.
    pub fn spell(&mut self, spelling: &Spelling) {
        let compiled = Arc::make_mut(&mut self.compiled);
        for object in &mut compiled.objects {
            *object = spelling.object(object).into();
        }
        let actions = compiled.actions.iter_mut().map(|action| &mut action.name);
        for name in actions.chain(compiled.tasks.iter_mut().map(|task| &mut task.name)) {
            *name = spelling.step(name).into();
        }
        for method in &mut compiled.methods {
            method.name = spelling.method(&method.name).into();
        }
    }

    /// How many actions it has.
    pub fn length(&self) -> usize {
        self.actions.len()
    }

    /// What its actions cost together; their number if the domain has no costs.
    pub fn cost(&self) -> Cost {
        self.cost
    }

    /// The actions, in the order in which they are to be executed.
    pub fn actions(&self) -> &[NodeId] {
        &self.actions
    }

    /// The tasks that the problem asked for, or the actions.
    pub fn roots(&self) -> impl Iterator<Item = NodeId> {
        self.children(NodeId(0))
    }

    /// What is at that place.
    pub fn node(&self, id: NodeId) -> Node {
        self.nodes[id.0 as usize]
    }

    /// How many places the tree has, the artificial ones among them.
    pub(super) fn places(&self) -> usize {
        self.nodes.len()
    }

    /// What it was decomposed into, in order; nothing for actions.
    pub fn children(&self, id: NodeId) -> impl Iterator<Item = NodeId> {
        let node = self.node(id);
        let count = node
            .method
            .map_or(0, |method| self.compiled.method(method).subtasks.len());
        (node.first_child..)
            .take(count)
            .map(NodeId)
            .filter(|child| !self.compiled.is_artificial(self.node(*child).step))
    }

    /// The objects that the action or task is applied to.
    pub fn arguments(&self, id: NodeId) -> &[ObjectId] {
        let node = self.node(id);
        let first = node.first_argument as usize;
        &self.arguments[first..first + self.kinds(node.step)]
    }

    fn kinds(&self, step: Step) -> usize {
        match step {
            Step::Action(action) => self.compiled.action(action).kinds.len(),
            Step::Task(task) => self.compiled.task(task).kinds.len(),
        }
    }

    /// The name of the action or task at that place.
    pub fn name(&self, id: NodeId) -> &Symbol {
        match self.node(id).step {
            Step::Action(action) => &self.compiled.action(action).name,
            Step::Task(task) => &self.compiled.task(task).name,
        }
    }

    /// The name of the method by which the task at that place was decomposed.
    pub fn method_name(&self, id: NodeId) -> Option<&Symbol> {
        let method = self.node(id).method?;
        Some(&self.compiled.method(method).name)
    }

    /// The name of an object.
    pub fn object(&self, object: ObjectId) -> &Symbol {
        &self.compiled.objects[object.index()]
    }

    /// The action or task at that place, with names.
    pub fn atom(&self, id: NodeId) -> Atom {
        Atom {
            name: self.name(id).clone(),
            args: self
                .arguments(id)
                .iter()
                .map(|object| self.object(*object).clone())
                .collect(),
        }
    }
}
