//! How the lines of a plan hang together.

use rustc_hash::FxHashMap;

use crate::fault::{Fault, Faults, Kind};
use crate::plan::{NodeId, Plan};

/// A plan that is known to be one tree.
#[derive(Debug)]
pub(crate) struct Tree {
    /// The root's children.
    pub(crate) roots: Vec<NodeId>,
    /// The children of all nodes, at the places that the plan says.
    pub(crate) children: Vec<NodeId>,
    /// Each node's parent; the root is nobody's number.
    pub(crate) parents: Vec<NodeId>,
    /// Parents before their children.
    pub(crate) from_the_root: Vec<NodeId>,
}

/// A parent that is the root above all roots.
pub(crate) const ROOT: NodeId = NodeId::MAX - 1;
const NOBODY: NodeId = NodeId::MAX;

/// Builds the tree, or says why it is none.
pub(crate) fn tree(plan: &Plan<'_>) -> Result<Tree, Vec<Fault>> {
    let mut faults = Faults::default();
    let mut numbers = FxHashMap::default();
    numbers.reserve(plan.nodes.len());
    for (node, content) in plan.nodes.iter().enumerate() {
        if numbers.insert(content.id, node).is_some() {
            let what = "a second line with this id";
            faults.push(Fault::at(Kind::DuplicateId, content.id, what));
        }
    }
    let mut faults = faults.check()?;
    let mut parents = vec![NOBODY; plan.nodes.len()];
    let mut resolve = |parent: NodeId, id: u64| {
        let owner = plan.nodes.get(parent).map(|node| node.id);
        let of = |id: Option<u64>| id.map_or_else(|| "the root".to_owned(), |id| id.to_string());
        let Some(node) = numbers.get(&id).copied() else {
            let what = format!("a child of {}, but no line describes it", of(owner));
            faults.push(Fault::at(Kind::UnknownChild, id, what));
            return NOBODY;
        };
        if parents[node] != NOBODY {
            let other = plan.nodes.get(parents[node]).map(|node| node.id);
            let what = format!("a child of {}, but already one of {}", of(owner), of(other));
            faults.push(Fault::at(Kind::ChildUsedTwice, id, what));
        }
        parents[node] = parent;
        node
    };
    let Some(roots) = &plan.roots else {
        return Err(vec![Fault::new(Kind::Malformed, "no line of roots")]);
    };
    let roots: Vec<NodeId> = roots.iter().map(|id| resolve(ROOT, *id)).collect();
    let mut children = vec![NOBODY; plan.children.len()];
    for node in 0..plan.nodes.len() {
        for place in plan.children_range(node) {
            children[place] = resolve(node, plan.children[place]);
        }
    }
    let faults = faults.check()?;
    let mut from_the_root = Vec::with_capacity(plan.nodes.len());
    from_the_root.extend(&roots);
    let mut next = 0;
    while let Some(node) = from_the_root.get(next).copied() {
        from_the_root.extend(&children[plan.children_range(node)]);
        next += 1;
    }
    let tree = Tree {
        roots,
        children,
        parents,
        from_the_root,
    };
    unreached(plan, &tree, faults).check()?;
    Ok(tree)
}

/// Nodes that have at most one parent each and yet do not hang from the root: orphans, what hangs
/// from them, and circles.
fn unreached(plan: &Plan<'_>, tree: &Tree, mut faults: Faults) -> Faults {
    if tree.from_the_root.len() == plan.nodes.len() {
        return faults;
    }
    // 0: not looked at, otherwise the walk that came by.
    let mut seen = vec![0; plan.nodes.len()];
    for node in &tree.from_the_root {
        seen[*node] = 1;
    }
    for start in 0..plan.nodes.len() {
        let walk = start + 2;
        let mut node = start;
        while seen[node] == 0 {
            seen[node] = walk;
            let id = plan.nodes[node].id;
            let parent = tree.parents[node];
            if parent == NOBODY {
                let what = "neither a root nor a child of anything";
                faults.push(Fault::at(Kind::Unreachable, id, what));
                break;
            }
            if seen[parent] == walk {
                faults.push(Fault::at(Kind::Cycle, id, "its own ancestor"));
            }
            node = parent;
        }
    }
    faults
}
