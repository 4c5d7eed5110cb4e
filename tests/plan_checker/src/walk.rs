//! Goes through the plan action by action: whether the order is one that the methods allow, and
//! whether preconditions hold where they have to.
//!
//! A method's precondition has to hold somewhere between the end of all that comes before its task
//! and its own first action, as if an action without effect stood before its subtasks. In a total
//! order that is one state. In a partial order it may be several, and the earliest is never worse
//! than a later one: a precondition changes nothing, and only what comes after waits for it.

use crate::Report;
use crate::fault::{Fault, Kind};
use crate::instance::{Instances, bind};
use crate::model::{Method, Model};
use crate::plan::{NodeId, Plan};
use crate::solve::Solver;
use crate::state::{State, cost};
use crate::tree::ROOT;

struct Walk<'a, 'm> {
    model: &'m Model,
    plan: &'a Plan<'m>,
    instances: &'a Instances<'m>,
    state: State,
    /// The place of each node among its siblings.
    places: Vec<u32>,
    /// For how many siblings each node still waits.
    waits_for: Vec<u32>,
    /// How many children of each node are not over yet.
    children_left: Vec<u32>,
    stages: Vec<Stage>,
    roots_left: usize,
    /// Decompositions whose turn it is and whose preconditions have not been looked at.
    fresh: Vec<NodeId>,
    /// Those whose preconditions have not held so far.
    waiting: Vec<NodeId>,
}

#[derive(Clone, Copy, Debug, Eq, PartialEq)]
enum Stage {
    /// Something before it is not over, or its parent has not begun.
    Blocked,
    /// An action that may be done, or a decomposition that waits for its precondition.
    Due,
    /// Its subtasks are being done.
    Begun,
    Over,
}

/// Walks through the whole plan.
pub(crate) fn walk(
    model: &Model,
    plan: &Plan<'_>,
    instances: &Instances<'_>,
) -> Result<Report, Fault> {
    let count = plan.nodes.len();
    let mut walk = Walk {
        model,
        plan,
        instances,
        state: State::initial(model),
        places: vec![0; count],
        waits_for: vec![0; count],
        children_left: vec![0; count],
        stages: vec![Stage::Blocked; count],
        roots_left: instances.tree.roots.len(),
        fresh: Vec::new(),
        waiting: Vec::new(),
    };
    let mut total = 0.0;
    walk.begin_root()?;
    for action in plan.actions.iter().copied() {
        walk.begin_what_can();
        if walk.stages[action] != Stage::Due {
            return Err(walk.why_not(action));
        }
        let task = &model.tasks[plan.nodes[action].task];
        let arguments = plan.arguments(action);
        let changes = walk.state.changes(model, task, arguments);
        let changes = changes.map_err(|part| {
            let call = plan.call(model, action);
            let what = format!("the precondition {part} of {call} does not hold here");
            Fault::at(Kind::Precondition, plan.nodes[action].id, what)
        })?;
        let mut changed = false;
        for (fact, truth) in &changes {
            changed |= walk.state.set(fact, *truth);
        }
        total += cost(model, task, arguments);
        walk.over(action);
        if changed {
            walk.fresh.append(&mut walk.waiting);
        }
    }
    walk.begin_what_can();
    if let Some(node) = walk.waiting.first() {
        return Err(walk.unmet(*node));
    }
    walk.goal()?;
    Ok(Report {
        actions: plan.actions.len(),
        decompositions: count - plan.actions.len(),
        cost: total,
    })
}

impl<'a> Walk<'a, '_> {
    fn begin_root(&mut self) -> Result<(), Fault> {
        let root = self.instances.root;
        let roots = &self.instances.tree.roots;
        let values = bind(self.model, self.plan, root, None, roots);
        let holds = values.is_some_and(|mut values| {
            let wanted: Vec<usize> = (0..root.parameters).collect();
            self.solver(root)
                .solvable(&root.condition, &wanted, &mut values)
        });
        if !holds {
            let what = "the constraints of the problem's tasks do not hold for the roots";
            return Err(Fault::new(Kind::WrongRoots, what));
        }
        self.begin(root, roots);
        Ok(())
    }

    fn solver<'s>(&'s self, method: &'s Method) -> Solver<'s, State> {
        Solver {
            model: self.model,
            world: &self.state,
            variables: &method.variables,
        }
    }

    fn begin(&mut self, method: &Method, children: &[NodeId]) {
        for (place, (child, before)) in children.iter().zip(&method.before).enumerate() {
            self.places[*child] = place as u32;
            self.waits_for[*child] = before.len() as u32;
            if before.is_empty() {
                self.due(*child);
            }
        }
    }

    fn due(&mut self, node: NodeId) {
        self.stages[node] = Stage::Due;
        if self.instances.methods[node].is_some() {
            self.fresh.push(node);
        }
    }

    fn children(&self, node: NodeId) -> &'a [NodeId] {
        &self.instances.tree.children[self.plan.children_range(node)]
    }

    /// Begins all decompositions whose turn it is and whose preconditions hold now.
    fn begin_what_can(&mut self) {
        let instances = self.instances;
        while let Some(node) = self.fresh.pop() {
            let Some(method) = instances.methods[node] else {
                continue;
            };
            let children = &instances.tree.children[self.plan.children_range(node)];
            if !self.holds(method, node) {
                self.waiting.push(node);
                continue;
            }
            self.stages[node] = Stage::Begun;
            self.children_left[node] = children.len() as u32;
            self.begin(method, children);
            if children.is_empty() {
                self.over(node);
            }
        }
    }

    fn holds(&self, method: &Method, node: NodeId) -> bool {
        let children = self.children(node);
        let values = bind(self.model, self.plan, method, Some(node), children);
        values.is_some_and(|mut values| {
            let wanted: Vec<usize> = (0..method.parameters).collect();
            self.solver(method)
                .solvable(&method.condition, &wanted, &mut values)
        })
    }

    /// A node is over, and perhaps its parent with it, and so on.
    fn over(&mut self, mut node: NodeId) {
        let instances = self.instances;
        loop {
            self.stages[node] = Stage::Over;
            let (siblings, method) = self.siblings(node);
            if let Some(method) = method {
                for after in &method.after[self.places[node] as usize] {
                    let after = siblings[*after];
                    self.waits_for[after] -= 1;
                    if self.waits_for[after] == 0 {
                        self.due(after);
                    }
                }
            }
            let parent = instances.tree.parents[node];
            if parent == ROOT {
                self.roots_left -= 1;
                return;
            }
            self.children_left[parent] -= 1;
            if self.children_left[parent] > 0 {
                return;
            }
            node = parent;
        }
    }

    fn siblings(&self, node: NodeId) -> (&'a [NodeId], Option<&'a Method>) {
        let instances = self.instances;
        match instances.tree.parents[node] {
            ROOT => (&instances.tree.roots, Some(instances.root)),
            parent => (self.children(parent), instances.methods[parent]),
        }
    }

    /// Why the next action of the plan cannot be done now.
    fn why_not(&self, action: NodeId) -> Fault {
        let plan = self.plan;
        // The highest ancestor that has not begun is held up by its own precondition or by a
        // sibling; that one by what is in it.
        let mut held_up = action;
        loop {
            let parent = self.instances.tree.parents[held_up];
            if parent == ROOT || self.stages[parent] == Stage::Begun {
                break;
            }
            held_up = parent;
        }
        while self.stages[held_up] == Stage::Blocked || self.stages[held_up] == Stage::Begun {
            let before = if self.stages[held_up] == Stage::Blocked {
                let (siblings, method) = self.siblings(held_up);
                let place = self.places[held_up] as usize;
                let before = method.map_or(&[][..], |method| &method.before[place]);
                let mut before = before.iter().map(|before| siblings[*before]);
                before.find(|before| self.stages[*before] != Stage::Over)
            } else {
                let mut children = self.children(held_up).iter().copied();
                children.find(|child| self.stages[*child] != Stage::Over)
            };
            match before {
                Some(before) => held_up = before,
                None => break,
            }
        }
        if self.instances.methods[held_up].is_some() {
            return self.unmet(held_up);
        }
        let (call, id) = (plan.call(self.model, action), plan.nodes[action].id);
        let other = plan.call(self.model, held_up);
        let other_id = plan.nodes[held_up].id;
        let what = format!("{call} comes before {other} ({other_id}), which has to be done first");
        Fault::at(Kind::WrongOrder, id, what)
    }

    /// That a method's precondition does not hold.
    fn unmet(&self, node: NodeId) -> Fault {
        let (model, plan) = (self.model, self.plan);
        let id = plan.nodes[node].id;
        let call = plan.call(model, node);
        let Some(method) = self.instances.methods[node] else {
            return Fault::at(Kind::MethodPrecondition, id, call);
        };
        let values = bind(model, plan, method, Some(node), self.children(node));
        let mut values = values.unwrap_or_else(|| vec![None; method.variables.len()]);
        let part = self
            .solver(method)
            .first_false(&method.condition, &mut values);
        let (part, rest) = match part {
            Some(part) => (part, ""),
            None => (&method.condition, " for any values of its other variables"),
        };
        let part = model.formula(part, &method.variables, &values);
        let name = &method.name;
        let what =
            format!("the precondition {part} of `{name}` for {call} does not hold here{rest}");
        Fault::at(Kind::MethodPrecondition, id, what)
    }

    fn goal(&self) -> Result<(), Fault> {
        let model = self.model;
        let solver = Solver {
            model,
            world: &self.state,
            variables: &model.goal_variables,
        };
        let mut values = vec![None; model.goal_variables.len()];
        match solver.first_false(&model.goal, &mut values) {
            Some(part) => {
                let part = model.formula(part, &model.goal_variables, &values);
                let what = format!("at the end, the goal {part} does not hold");
                Err(Fault::new(Kind::Goal, what))
            }
            None => Ok(()),
        }
    }
}
