//! Whether decompositions are instances of their methods.

use crate::fault::{Fault, Faults, Kind};
use crate::model::{Method, Model};
use crate::plan::{NodeId, Plan};
use crate::solve::{Solver, Values};
use crate::state::State;
use crate::tree::{ROOT, Tree};

/// How often each child of a node may on average be tried as a subtask before we give up.
const MOST_TRIES: usize = 10_000;

/// Which method each node is an instance of, with its children in the order of the subtasks.
#[derive(Debug)]
pub(crate) struct Instances<'m> {
    /// `None` for actions.
    pub(crate) methods: Vec<Option<&'m Method>>,
    pub(crate) root: &'m Method,
    pub(crate) tree: Tree,
}

/// Where in the plan a node's actions stand: first and last, if it has any.
type Spans = Vec<Option<(usize, usize)>>;

struct Matcher<'a, 'm> {
    model: &'m Model,
    plan: &'a Plan<'m>,
    nowhere: &'a State,
    spans: Spans,
}

/// Finds a method for every decomposition, or says for which there is none.
pub(crate) fn instances<'m>(
    model: &'m Model,
    plan: &Plan<'m>,
    mut tree: Tree,
) -> Result<Instances<'m>, Vec<Fault>> {
    let mut faults = Faults::default();
    let matcher = Matcher {
        model,
        plan,
        nowhere: &State::default(),
        spans: spans(plan, &tree),
    };
    let mut methods = Vec::with_capacity(plan.nodes.len());
    for (node, content) in plan.nodes.iter().enumerate() {
        methods.push(None);
        let Some(named) = content.method else {
            continue;
        };
        let range = plan.children_range(node);
        let mut why = String::new();
        for method in plan.methods[named as usize] {
            let method = &model.methods[*method];
            match matcher.matched(method, Some(node), &tree.children[range.clone()]) {
                Ok(children) => {
                    tree.children[range.clone()].copy_from_slice(&children);
                    methods[node] = Some(method);
                    break;
                }
                Err(reason) => why = reason,
            }
        }
        if methods[node].is_none() {
            faults.push(Fault::at(Kind::NotAnInstance, content.id, why));
        }
    }
    match matcher.matched(&model.root, None, &tree.roots) {
        Ok(roots) => tree.roots = roots,
        Err(why) => faults.push(Fault::new(Kind::WrongRoots, why)),
    }
    faults.check()?;
    Ok(Instances {
        methods,
        root: &model.root,
        tree,
    })
}

fn spans(plan: &Plan<'_>, tree: &Tree) -> Spans {
    let mut spans: Spans = vec![None; plan.nodes.len()];
    for (place, node) in plan.actions.iter().enumerate() {
        spans[*node] = Some((place, place));
    }
    for node in tree.from_the_root.iter().rev().copied() {
        let parent = tree.parents[node];
        if let (Some((first, last)), true) = (spans[node], parent != ROOT) {
            let span = spans[parent].unwrap_or((first, last));
            spans[parent] = Some((span.0.min(first), span.1.max(last)));
        }
    }
    spans
}

/// The values that a decomposition gives to the variables of its method. `None` if it gives one
/// of them two values or a wrong one.
pub(crate) fn bind(
    model: &Model,
    plan: &Plan<'_>,
    method: &Method,
    node: Option<NodeId>,
    children: &[NodeId],
) -> Option<Values> {
    let nowhere = State::default();
    let solver = Solver {
        model,
        world: &nowhere,
        variables: &method.variables,
    };
    let mut values = vec![None; method.variables.len()];
    let mut set = Vec::new();
    if let (Some(head), Some(node)) = (&method.head, node)
        && !solver.unify(&head.terms, plan.arguments(node), &mut values, &mut set)
    {
        return None;
    }
    for (subtask, child) in method.subtasks.iter().zip(children) {
        let same = plan.nodes[*child].task == subtask.task;
        if !same
            || !solver.unify(
                &subtask.terms,
                plan.arguments(*child),
                &mut values,
                &mut set,
            )
        {
            return None;
        }
    }
    Some(values)
}

impl Matcher<'_, '_> {
    /// The children in the order of the method's subtasks, or why they are not its subtasks.
    fn matched(
        &self,
        method: &Method,
        node: Option<NodeId>,
        children: &[NodeId],
    ) -> Result<Vec<NodeId>, String> {
        let (model, plan) = (self.model, self.plan);
        let name = &method.name;
        if let (Some(head), Some(node)) = (&method.head, node)
            && plan.nodes[node].task != head.task
        {
            let (found, wanted) = (plan.call(model, node), &model.tasks[head.task].name);
            return Err(format!("`{name}` decomposes `{wanted}`, not `{found}`"));
        }
        let (wanted, found) = (method.subtasks.len(), children.len());
        if wanted != found {
            return Err(format!("`{name}` has {wanted} subtasks, here are {found}"));
        }
        let solver = Solver {
            model,
            world: self.nowhere,
            variables: &method.variables,
        };
        let mut values = vec![None; method.variables.len()];
        if let (Some(head), Some(node)) = (&method.head, node)
            && !solver.unify(
                &head.terms,
                plan.arguments(node),
                &mut values,
                &mut Vec::new(),
            )
        {
            let call = plan.call(model, node);
            return Err(format!("`{name}` is not for arguments as in `{call}`"));
        }
        let mut search = Assignment {
            matcher: self,
            solver,
            method,
            children,
            chosen: Vec::new(),
            used: vec![false; children.len()],
            values,
            tries: 0,
            ordered: true,
            farthest: 0,
        };
        if search.assign() {
            return Ok(search.chosen.iter().map(|place| children[*place]).collect());
        }
        if search.tries >= search.most_tries() {
            return Err(format!(
                "`{name}`: too many ways to tell its subtasks apart"
            ));
        }
        // Without a look at the order: the walk through the plan says better what is wrong there.
        let farthest = search.farthest;
        search.ordered = false;
        search.tries = 0;
        if search.assign() {
            return Ok(search.chosen.iter().map(|place| children[*place]).collect());
        }
        let farthest = farthest.max(search.farthest);
        let subtask = &method.subtasks[farthest.min(wanted.saturating_sub(1))];
        let subtask = &model.tasks[subtask.task].name;
        let calls: Vec<_> = (children.iter().map(|child| plan.call(model, *child))).collect();
        let number = farthest + 1;
        Err(format!(
            "no instance of `{name}`: nothing in `{}` can be its subtask {number}, `{subtask}`",
            calls.join(" ")
        ))
    }

    fn keeps_order(&self, first: NodeId, second: NodeId) -> bool {
        match (self.spans[first], self.spans[second]) {
            (Some((_, last)), Some((first, _))) => last < first,
            _ => true,
        }
    }
}

/// Which child is which subtask.
struct Assignment<'a, 'm> {
    matcher: &'a Matcher<'a, 'm>,
    solver: Solver<'a, State>,
    method: &'a Method,
    children: &'a [NodeId],
    chosen: Vec<usize>,
    used: Vec<bool>,
    values: Values,
    tries: usize,
    ordered: bool,
    farthest: usize,
}

impl Assignment<'_, '_> {
    /// Assigns one subtask after the other, without recursion: a method can have very many.
    fn assign(&mut self) -> bool {
        self.chosen.clear();
        let count = self.children.len();
        // For each subtask the next candidate (counted from its own place) and what it bound.
        let mut stack: Vec<(usize, Vec<usize>)> = vec![(0, Vec::new())];
        loop {
            let subtask = stack.len() - 1;
            self.farthest = self.farthest.max(subtask);
            if subtask == count {
                return true;
            }
            let (next, bound) = &mut stack[subtask];
            // Back here: the candidate chosen before led nowhere.
            if self.chosen.len() > subtask {
                for slot in bound.drain(..) {
                    self.values[slot] = None;
                }
                if let Some(place) = self.chosen.pop() {
                    self.used[place] = false;
                }
            }
            let mut found = false;
            while *next < count && self.tries < self.most_tries() {
                let place = (subtask + *next) % count;
                *next += 1;
                self.tries += 1;
                if self.used[place] {
                    continue;
                }
                let child = self.children[place];
                let plan = self.matcher.plan;
                let call = &self.method.subtasks[subtask];
                let fits = plan.nodes[child].task == call.task
                    && self.solver.unify(
                        &call.terms,
                        plan.arguments(child),
                        &mut self.values,
                        bound,
                    );
                self.chosen.push(place);
                if fits && (!self.ordered || self.in_order(subtask)) {
                    self.used[place] = true;
                    found = true;
                    break;
                }
                self.chosen.pop();
                for slot in bound.drain(..) {
                    self.values[slot] = None;
                }
            }
            if found {
                stack.push((0, Vec::new()));
            } else {
                stack.pop();
                if stack.is_empty() {
                    return false;
                }
            }
        }
    }

    fn most_tries(&self) -> usize {
        MOST_TRIES * self.children.len()
    }

    /// Whether the newest subtask stands right to those before it.
    fn in_order(&self, newest: usize) -> bool {
        let node = |subtask: usize| self.children[self.chosen[subtask]];
        let chosen = |other: &&usize| **other < newest;
        let keeps_order = |first, second| self.matcher.keeps_order(node(first), node(second));
        let method = self.method;
        let mut before = method.before[newest].iter().filter(chosen);
        let mut after = method.after[newest].iter().filter(chosen);
        before.all(|other| keeps_order(*other, newest))
            && after.all(|other| keeps_order(newest, *other))
    }
}
