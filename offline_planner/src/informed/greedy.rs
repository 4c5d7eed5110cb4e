//! Greedy best-first search over states and task stacks, evaluated when a place is left.

use std::collections::BTreeMap;
use std::sync::atomic::Ordering;

use rustc_hash::FxHashSet;

use super::progress::{Ended, Place, Trace, go_on, use_method};
use super::store::{EMPTY, Stacks, States};
use crate::control::{Control, Halt};
use crate::ground::Model;
use crate::ground::model::NONE;
use crate::heuristic::additive::{Additive, NEVER};
use crate::heuristic::relaxed::{Lists, Relaxed};

/// How a search over the ground problem ended.
pub(crate) enum Found {
    /// With these methods, in order.
    Plan(Vec<u32>),
    /// With nothing left to be searched.
    Nothing,
    /// Early.
    Stopped(Halt),
}

/// Somewhere to go: from a place by a method.
#[derive(Clone, Copy)]
struct Successor {
    place: Place,
    state: u32,
    method: u32,
}

/// Tasks below each task.
pub(crate) fn below(model: &Model) -> Lists {
    let mut lists = Lists::default();
    for task in 0..model.tasks.len() {
        let mut subs: Vec<u32> = model
            .methods_of(task as u32)
            .flat_map(|method| model.get(model.methods[method].subs))
            .copied()
            .collect();
        subs.sort_unstable();
        subs.dedup();
        lists.push(subs);
    }
    lists
}

/// Searches.
pub(crate) fn greedy(model: &Model, control: &Control<'_>) -> Found {
    let relaxed = Relaxed::new(model);
    let below = below(model);
    let mut additive = Additive::new(&relaxed, 1, 1);
    let mut states = States::new(model.init.len());
    let mut stacks = Stacks::new();
    let mut trace = Trace::default();
    let mut seen: FxHashSet<(u32, u32)> = FxHashSet::default();
    let mut open: BTreeMap<u32, Vec<Successor>> = BTreeMap::new();
    let mut state = model.init.clone();
    let mut spare = Vec::new();
    let (mut methods, mut tasks) = (Vec::new(), Vec::new());
    let mut place = Place {
        stack: stacks.push(model.top, EMPTY),
        trace: NONE,
        cost: 0,
        length: 0,
    };
    let mut expanded = 0_u64;
    loop {
        let ended = go_on(
            model,
            &mut stacks,
            &mut trace,
            &mut place,
            &mut state,
            &mut spare,
            &mut methods,
        );
        match ended {
            Ended::Done => return Found::Plan(trace.methods(place.trace)),
            Ended::Dead => {}
            Ended::Choice => {
                let number = states.insert(&state);
                if seen.insert((number, place.stack)) {
                    expanded += 1;
                    control.expanded.fetch_add(1, Ordering::Relaxed);
                    tasks.clear();
                    tasks.extend(stacks.tasks(place.stack));
                    if let Some(estimate) = additive.evaluate(&state, &tasks, &below) {
                        let costs: Vec<u32> = methods
                            .iter()
                            .map(|method| additive.method_cost(*method as usize))
                            .collect();
                        let least = costs.iter().min().copied().unwrap_or(NEVER);
                        for (method, cost) in methods.iter().zip(costs).rev() {
                            if cost != NEVER {
                                let key = estimate.plan.saturating_add(cost - least);
                                open.entry(key).or_default().push(Successor {
                                    place,
                                    state: number,
                                    method: *method,
                                });
                            }
                        }
                    }
                    if expanded.is_multiple_of(64) {
                        if control.is_over() {
                            return Found::Stopped(Halt::Told);
                        }
                        let bytes = states.bytes()
                            + stacks.bytes()
                            + trace.bytes()
                            + seen.capacity() * 9
                            + expanded as usize * 200;
                        if bytes as u64 > control.memory_limit_bytes {
                            return Found::Stopped(Halt::Memory);
                        }
                    }
                }
            }
        }
        let Some(mut entry) = open.first_entry() else {
            return Found::Nothing;
        };
        let Some(next) = entry.get_mut().pop() else {
            return Found::Nothing;
        };
        if entry.get().is_empty() {
            entry.remove();
        }
        place = next.place;
        state.clear();
        state.extend_from_slice(states.get(next.state));
        use_method(model, &mut stacks, &mut trace, &mut place, next.method);
    }
}
