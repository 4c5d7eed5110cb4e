//! What a task needs, whichever way it is done: read off its methods before anything is
//! instantiated, and asked for as soon as the task is chosen.
//!
//! If all ways to load a crate begin with the crate being at the place, a method that begins with
//! loading it there needs that already. This is exact for the first subtask of a method, as
//! nothing happens between, and for facts that never change also for later ones.

use std::collections::BTreeSet;

use super::formula::{Arg, Lit};
use super::lifted::{Lifted, Rule, What};

/// Facts that must (`true`) or must not hold, over the places of a task's arguments.
type Needs = BTreeSet<(bool, Lit)>;

/// Adds to every link what its subtasks imply. Links whose subtasks can never be done, because
/// every way of doing them contains them again, are taken out.
pub(super) fn add_implied(lifted: &mut Lifted<'_>) {
    let first = lifted.space.first_task();
    let mut by_task: Vec<Vec<usize>> = vec![Vec::new(); lifted.relations - first];
    for (index, rule) in lifted.rules.iter().enumerate() {
        if let Some(rules) = (rule.head.relation as usize)
            .checked_sub(first)
            .and_then(|place| by_task.get_mut(place))
        {
            rules.push(index);
        }
    }
    // `None`: not known to be possible at all. The sets only shrink from there.
    let mut needs: Vec<Option<Needs>> = vec![None; by_task.len()];
    loop {
        let mut changed = false;
        for (place, rules) in by_task.iter().enumerate() {
            let mut common: Option<Needs> = None;
            for rule in rules {
                if let Some(all) = needs_of(lifted, &lifted.rules[*rule], &needs) {
                    let all = over_head(&lifted.rules[*rule].head, &all);
                    common = Some(match common {
                        None => all,
                        Some(common) => common.intersection(&all).cloned().collect(),
                    });
                }
            }
            if common != needs[place] {
                needs[place] = common;
                changed = true;
            }
        }
        if !changed {
            break;
        }
    }
    let additions: Vec<Option<Needs>> = lifted
        .rules
        .iter()
        .map(|rule| needs_of(lifted, rule, &needs))
        .collect();
    let mut keep = additions.iter().map(Option::is_some);
    for (rule, addition) in lifted.rules.iter_mut().zip(&additions) {
        for (sign, lit) in addition.iter().flatten() {
            let bound = lit.vars().all(|var| usize::from(var) < rule.vars);
            let list = if *sign {
                &mut rule.body
            } else {
                &mut rule.negative
            };
            if bound && !list.contains(lit) {
                list.push(lit.clone());
            }
        }
    }
    let mut kept = keep.clone();
    lifted.rules.retain(|_| keep.next().unwrap_or(true));
    lifted.readings.retain(|_| kept.next().unwrap_or(true));
}

/// Everything that the rule needs at its beginning, over its own variables.
fn needs_of(lifted: &Lifted<'_>, rule: &Rule, needs: &[Option<Needs>]) -> Option<Needs> {
    let mut all: Needs = rule.body.iter().map(|lit| (true, lit.clone())).collect();
    all.extend(rule.negative.iter().map(|lit| (false, lit.clone())));
    let What::Link { subs, .. } = &rule.what else {
        return Some(all);
    };
    for (index, sub) in subs.iter().enumerate() {
        let place = (sub.relation as usize).checked_sub(lifted.space.first_task())?;
        let of_sub = needs.get(place)?.as_ref()?;
        for (sign, lit) in of_sub {
            if index == 0 || !lifted.is_fluent(lit.relation) {
                all.insert((*sign, lit.map(&mut |arg| at_place(arg, &sub.args))));
            }
        }
    }
    Some(all)
}

fn at_place(arg: Arg, args: &[Arg]) -> Arg {
    match arg {
        Arg::Var(place) => args.get(usize::from(place)).copied().unwrap_or(arg),
        object => object,
    }
}

/// Those needs that can be said of the head's arguments.
fn over_head(head: &Lit, all: &Needs) -> Needs {
    all.iter()
        .filter_map(|(sign, lit)| {
            let mut sayable = true;
            let lit = lit.map(&mut |arg| match arg {
                Arg::Var(_) => match head.args.iter().position(|other| *other == arg) {
                    Some(place) => Arg::Var(place as u16),
                    None => {
                        sayable = false;
                        arg
                    }
                },
                object => object,
            });
            sayable.then_some((*sign, lit))
        })
        .collect()
}
