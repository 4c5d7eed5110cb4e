//! What is to be done in place of a task, and in which order.

use std::collections::{BTreeMap, BTreeSet};

use super::error::Faults;
use super::expression::Scope;
use super::fields::Fields;
use super::fit::Sort;
use super::near::hint;
use super::tree::Tree;
use crate::model::Pattern;

/// What may stand beside the initial tasks of a problem.
pub(super) const KEYWORDS: &[&str] = &[
    ":parameters",
    ":ordered-subtasks",
    ":ordered-tasks",
    ":subtasks",
    ":tasks",
    ":ordering",
    ":order",
    ":constraints",
];

/// A subtask with the name by which `:ordering` may speak of it.
struct Subtask<'t> {
    id: Option<&'t Tree>,
    step: &'t Tree,
}

/// Reads the subtasks of a method or a problem in the order in which they are to be done.
pub(super) fn subtasks(
    fields: &Fields<'_>,
    scope: &Scope<'_>,
    faults: &mut Faults,
) -> Vec<Pattern> {
    let get = |keyword: &str| fields.get(keyword).map(|(at, tree)| (*at, *tree));
    let ordered = get(":ordered-subtasks").or_else(|| get(":ordered-tasks"));
    let unordered = get(":subtasks").or_else(|| get(":tasks"));
    let ordering = get(":ordering").or_else(|| get(":order"));
    let given = match (ordered, unordered) {
        (Some((first, _)), Some((second, _))) => {
            let message = "the subtasks are given twice; keep `:ordered-subtasks`";
            faults.add(first.max(second), message);
            return Vec::new();
        }
        (ordered, unordered) => ordered.or(unordered),
    };
    let Some((at, tree)) = given else {
        return Vec::new();
    };
    let list = sorted(at, ordered.is_some(), ordering, items(tree, faults), faults);
    list.into_iter()
        .filter_map(|subtask| scope.pattern(subtask.step, Sort::Step, faults))
        .collect()
}

fn partially_ordered(at: usize, one: &Subtask<'_>, other: &Subtask<'_>, faults: &mut Faults) {
    let (one, other) = (one.step, other.step);
    faults.add(
        at,
        format!(
            "partially ordered subtasks are not supported; write :ordered-subtasks, or say with \
             :ordering which comes first, `{one}` or `{other}`"
        ),
    );
}

fn items<'t>(tree: &'t Tree, faults: &mut Faults) -> Vec<Subtask<'t>> {
    match (tree.head(), tree.list()) {
        (_, Some([])) => Vec::new(),
        (Some("and"), Some(items)) => items[1..].iter().map(subtask).collect(),
        (_, Some(_)) => vec![subtask(tree)],
        (_, None) => {
            faults.add(
                tree.at,
                format!("expected subtasks such as `(and (go ?n) (explain ?n))`, found `{tree}`"),
            );
            Vec::new()
        }
    }
}

fn subtask(tree: &Tree) -> Subtask<'_> {
    match tree.list() {
        Some([id, step]) if id.word().is_some() && step.list().is_some() => {
            Subtask { id: Some(id), step }
        }
        _ => Subtask {
            id: None,
            step: tree,
        },
    }
}

/// Puts subtasks into the order that `:ordering` gives, which must leave no choice unless they are
/// `ordered` as they stand.
fn sorted<'t>(
    at: usize,
    ordered: bool,
    ordering: Option<(usize, &'t Tree)>,
    subtasks: Vec<Subtask<'t>>,
    faults: &mut Faults,
) -> Vec<Subtask<'t>> {
    let mut known = BTreeMap::new();
    for (index, subtask) in subtasks.iter().enumerate() {
        if let Some(id) = subtask.id
            && known.insert(id.word().unwrap_or_default(), index).is_some()
        {
            faults.add(id.at, format!("the subtask `{id}` is named twice"));
        }
    }
    let mut before = BTreeSet::new();
    if ordered {
        before.extend((1..subtasks.len()).map(|step| (step - 1, step)));
    }
    let mut unreadable = false;
    for pair in ordering.map(|(_, tree)| pairs(tree)).unwrap_or_default() {
        let Some(pair) = pair_of(pair, &known, faults) else {
            unreadable = true;
            continue;
        };
        before.insert(pair);
    }
    if unreadable {
        return subtasks;
    }
    // A total order has at each point exactly one subtask that may come next.
    let mut waits_for = vec![0; subtasks.len()];
    for (_, step) in &before {
        waits_for[*step] += 1;
    }
    let mut next: Vec<usize> = (0..subtasks.len())
        .filter(|step| waits_for[*step] == 0)
        .collect();
    let mut order = Vec::new();
    while let Some(step) = next.pop() {
        if let Some(other) = next.first() {
            let at = ordering.map_or(at, |(at, _)| at);
            partially_ordered(at, &subtasks[*other], &subtasks[step], faults);
            return subtasks;
        }
        order.push(step);
        for (_, after) in before.range((step, 0)..=(step, usize::MAX)) {
            waits_for[*after] -= 1;
            if waits_for[*after] == 0 {
                next.push(*after);
            }
        }
    }
    if order.len() < subtasks.len() {
        let at = ordering.map_or(at, |(at, _)| at);
        faults.add(at, "the ordering goes round in a circle");
        return subtasks;
    }
    let mut subtasks: Vec<Option<Subtask<'t>>> = subtasks.into_iter().map(Some).collect();
    order
        .into_iter()
        .filter_map(|index| subtasks[index].take())
        .collect()
}

fn pairs(ordering: &Tree) -> &[Tree] {
    match (ordering.head(), ordering.list()) {
        (_, Some([])) => &[],
        (Some("and"), Some(items)) => &items[1..],
        _ => std::slice::from_ref(ordering),
    }
}

/// `(< t1 t2)` or `(t1 < t2)`, as indices of the subtasks.
fn pair_of(
    tree: &Tree,
    ids: &BTreeMap<&str, usize>,
    faults: &mut Faults,
) -> Option<(usize, usize)> {
    let (first, second) = match tree.list() {
        Some([sign, first, second]) if sign.word() == Some("<") => (first, second),
        Some([first, sign, second]) if sign.word() == Some("<") => (first, second),
        _ => {
            faults.add(tree.at, format!("expected `(< t1 t2)`, found `{tree}`"));
            return None;
        }
    };
    let mut index = |tree: &Tree| {
        let found = tree.word().and_then(|word| ids.get(word)).copied();
        if found.is_none() {
            let hint = hint(
                tree.word().unwrap_or_default(),
                ids.keys().copied(),
                "; name it as in `(t1 (go ?n))`",
            );
            faults.add(tree.at, format!("no subtask is named `{tree}`{hint}"));
        }
        found
    };
    let (first, second) = (index(first), index(second));
    Some((first?, second?))
}
