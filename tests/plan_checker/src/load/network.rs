//! Subtasks and their order.

use rustc_hash::FxHashMap;

use super::formula::Scope;
use super::{Loader, Parts};
use crate::fault::Fault;
use crate::model::{Call, Formula, Method};
use crate::sexpr::Sexpr;

impl Loader {
    pub(super) fn network(
        &mut self,
        name: &str,
        head: Option<Call>,
        mut scope: Scope,
        parts: &Parts<'_>,
    ) -> Result<Method, Fault> {
        let parameters = scope.variables.len();
        let condition = Formula::And(vec![
            self.condition(parts.get(":precondition"), &mut scope)?,
            self.condition(parts.get(":constraints"), &mut scope)?,
        ]);
        let mut subtasks = Vec::new();
        let mut ids = FxHashMap::default();
        let lists = [
            (":subtasks", false),
            (":tasks", false),
            (":ordered-subtasks", true),
            (":ordered-tasks", true),
        ];
        let mut ordered = false;
        let mut lists = lists
            .into_iter()
            .filter_map(|(keyword, ordered)| Some((parts.get(keyword)?, ordered)));
        if let Some((list, in_order)) = lists.next() {
            ordered = in_order;
            for each in members(list)? {
                let (id, call) = match each.list() {
                    Some([id, call]) if call.list().is_some() => (id.word(), call),
                    _ => (None, each),
                };
                if let Some(id) = id
                    && ids.insert(id.to_owned(), subtasks.len()).is_some()
                {
                    return Err(each.fault(format_args!("a second subtask `{id}`")));
                }
                subtasks.push(self.call(call, &scope)?);
            }
        }
        if let Some((list, _)) = lists.next() {
            return Err(list.fault("a second list of subtasks"));
        }
        let mut pairs = Vec::new();
        if let Some(ordering) = parts.get(":ordering").or(parts.get(":order")) {
            for each in members(ordering)? {
                pairs.push(pair(each, &ids)?);
            }
        }
        if ordered {
            pairs.extend((1..subtasks.len()).map(|index| (index - 1, index)));
        }
        let order = Order::new(subtasks.len(), &pairs);
        let order = order.ok_or_else(|| match parts.get(":ordering") {
            Some(ordering) => ordering.fault("the order goes in circles"),
            None => Fault::new(crate::Kind::Unjudgeable, "the order goes in circles"),
        })?;
        Ok(Method {
            name: name.to_owned(),
            head,
            variables: scope.variables,
            parameters,
            condition,
            subtasks,
            after: order.after,
            before: order.before,
            chain: order.chain,
        })
    }
}

/// What is in `(and …)`, or the one thing that stands without it.
fn members(list: &Sexpr) -> Result<&[Sexpr], Fault> {
    let items = list.expect_list("subtasks or an order")?;
    Ok(match list.head() {
        Some("and") => &items[1..],
        _ if items.is_empty() => items,
        _ => std::slice::from_ref(list),
    })
}

fn pair(each: &Sexpr, ids: &FxHashMap<String, usize>) -> Result<(usize, usize), Fault> {
    let Some([less, first, second]) = each.list() else {
        return Err(each.fault("expected (< FIRST SECOND)"));
    };
    if less.word() != Some("<") {
        return Err(less.fault("expected (< FIRST SECOND)"));
    }
    let find = |id: &Sexpr| {
        let name = id.expect_word("a subtask")?;
        let found = ids.get(name).copied();
        found.ok_or_else(|| id.fault(format_args!("no subtask `{name}`")))
    };
    Ok((find(first)?, find(second)?))
}

struct Order {
    after: Vec<Vec<usize>>,
    before: Vec<Vec<usize>>,
    chain: Option<Vec<usize>>,
}

impl Order {
    /// `None` if the pairs go in circles.
    fn new(count: usize, pairs: &[(usize, usize)]) -> Option<Self> {
        let (mut after, mut before) = links(count, pairs.iter().copied());
        let mut left: Vec<usize> = before.iter().map(Vec::len).collect();
        let mut open: Vec<usize> = (0..count).filter(|index| left[*index] == 0).collect();
        let mut sorted = Vec::new();
        while let Some(each) = open.pop() {
            sorted.push(each);
            for next in &after[each] {
                left[*next] -= 1;
                if left[*next] == 0 {
                    open.push(*next);
                }
            }
        }
        if sorted.len() < count {
            return None;
        }
        // A chain through all says all that longer leaps say, too.
        let steps = || sorted.windows(2).map(|pair| (pair[0], pair[1]));
        let chain = steps().all(|(first, second)| after[first].contains(&second));
        if chain {
            (after, before) = links(count, steps());
        }
        Some(Self {
            after,
            before,
            chain: chain.then_some(sorted),
        })
    }
}

type Links = Vec<Vec<usize>>;

fn links(count: usize, pairs: impl Iterator<Item = (usize, usize)>) -> (Links, Links) {
    let mut after = vec![Vec::new(); count];
    let mut before = vec![Vec::new(); count];
    for (first, second) in pairs {
        after[first].push(second);
        before[second].push(first);
    }
    (after, before)
}
