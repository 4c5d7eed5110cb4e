//! A plan as a tree: which action serves which task, and by which method.
//!
//! ```text
//! (deliver letter shop)  by m-deliver
//! ├─ (go van street)  by m-drive
//! │  ├─ 0 (drive van depot street)
//! │  └─ (go van street)  by m-stay, nothing to do
//! └─ …
//! ```

use std::io::{self, Write};

use offline_planner::Solution;
use offline_planner::plan::NodeId;

/// As many lines as anybody scrolls through.
const EASILY_READ: usize = 200;
/// More levels do not fit beside each other.
const DEEPEST: usize = 24;
/// Of so many siblings only the first and the last are shown.
const MOST_SIBLINGS: usize = 60;

/// What the tree says at each node, beside its name.
struct Counts {
    /// For each action its number, as the plan is written; for each task how many actions it has.
    numbers: Vec<usize>,
}

/// Writes the tree down to a depth, or as deep as it can easily be read.
pub(super) fn tree(
    out: &mut impl Write,
    solution: &Solution,
    depth: Option<usize>,
) -> io::Result<()> {
    let shown = depth.unwrap_or_else(|| easily_read(solution));
    let siblings = if depth.is_some() {
        usize::MAX
    } else {
        MOST_SIBLINGS
    };
    let counts = Counts::of(solution);
    let mut folded = false;
    // What is left to write, with the lines to its left; the last one first.
    let mut open: Vec<(Line, String, usize)> = Vec::new();
    push(
        &mut open,
        &solution.roots().collect::<Vec<_>>(),
        "",
        1,
        siblings,
    );
    while let Some((line, left, level)) = open.pop() {
        let Line::Node { id, last } = line else {
            folded = true;
            let Line::Skipped(count) = line else { continue };
            writeln!(out, "{left}├─ … {count} more like these")?;
            continue;
        };
        let branch = match (level, last) {
            (1, _) => "",
            (_, true) => "└─ ",
            (_, false) => "├─ ",
        };
        write!(out, "{left}{branch}")?;
        let Some(method) = solution.method_name(id) else {
            writeln!(
                out,
                "{} {}",
                counts.numbers[id.0 as usize],
                solution.atom(id)
            )?;
            continue;
        };
        write!(out, "{}  by {method}", solution.atom(id))?;
        let children: Vec<NodeId> = solution.children(id).collect();
        let actions = counts.numbers[id.0 as usize];
        if children.is_empty() {
            writeln!(out, ", nothing to do")?;
        } else if level >= shown {
            folded = true;
            let plural = if actions == 1 { "" } else { "s" };
            writeln!(out, " … {actions} action{plural}")?;
        } else {
            writeln!(out)?;
            let below = match (level, last) {
                (1, _) => String::new(),
                (_, true) => format!("{left}   "),
                (_, false) => format!("{left}│  "),
            };
            push(&mut open, &children, &below, level + 1, siblings);
        }
    }
    if folded {
        writeln!(
            out,
            "(… stands for what is left out; --explain=DEPTH shows more or fewer levels)"
        )?;
    }
    Ok(())
}

enum Line {
    Node { id: NodeId, last: bool },
    Skipped(usize),
}

fn push(
    open: &mut Vec<(Line, String, usize)>,
    nodes: &[NodeId],
    left: &str,
    level: usize,
    most: usize,
) {
    let skipped = if nodes.len() > most {
        most / 2..nodes.len() - most / 2
    } else {
        0..0
    };
    for (place, id) in nodes.iter().enumerate().rev() {
        if skipped.contains(&place) {
            if place == skipped.start {
                let count = skipped.len();
                open.push((Line::Skipped(count), left.to_owned(), level));
            }
            continue;
        }
        let last = place + 1 == nodes.len();
        open.push((Line::Node { id: *id, last }, left.to_owned(), level));
    }
}

/// How many levels give a tree of not too many lines; at least one.
fn easily_read(solution: &Solution) -> usize {
    let mut level: Vec<NodeId> = solution.roots().collect();
    level.truncate(MOST_SIBLINGS);
    let mut lines = level.len();
    for depth in 1..DEEPEST {
        let below = |id: &NodeId| solution.children(*id).take(MOST_SIBLINGS);
        level = level.iter().flat_map(below).collect();
        lines += level.len();
        if level.is_empty() || lines > EASILY_READ {
            return depth;
        }
    }
    DEEPEST
}

impl Counts {
    fn of(solution: &Solution) -> Self {
        let mut order: Vec<NodeId> = solution.roots().collect();
        let mut parents = vec![None; order.len()];
        let mut next = 0;
        while let Some(id) = order.get(next).copied() {
            order.extend(solution.children(id));
            parents.resize(order.len(), Some(next));
            next += 1;
        }
        let most = order.iter().map(|id| id.0 as usize).max();
        let mut numbers = vec![0; most.map_or(0, |most| most + 1)];
        for place in (0..order.len()).rev() {
            let id = order[place];
            let is_action = solution.method_name(id).is_none();
            let actions = if is_action { 1 } else { numbers[id.0 as usize] };
            if let Some(parent) = parents[place] {
                numbers[order[parent].0 as usize] += actions;
            }
        }
        for (number, id) in solution.actions().iter().enumerate() {
            numbers[id.0 as usize] = number;
        }
        Self { numbers }
    }
}
