//! Weighted A* that goes on after each plan until nothing cheaper can be left (Hansen and Zhou,
//! *Anytime Heuristic Search*, 2007).

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::atomic::Ordering;

use rustc_hash::FxHashMap;

use super::progress::{Ended, Place, Walker};
use super::store::States;
use crate::control::{Control, Halt};
use crate::ground::Model;
use crate::ground::model::NONE;
use crate::heuristic::additive::Additive;
use crate::heuristic::conflict::Conflicts;
use crate::heuristic::least::{IMPOSSIBLE, least_costs};
use crate::heuristic::relaxed::Relaxed;

/// The bound counts so much where ways on are compared, so that plans are found early.
const WEIGHT: u64 = 2;

/// A way on: from a place by a method; by a bound of the whole cost, for the order and as it is.
type Entry = (Reverse<u64>, u64, u32);

struct Successor {
    place: Place,
    state: u32,
    method: u32,
}

/// Searches for ever cheaper plans, below `bound` from the start; each is given to `found` with
/// its cost. Everything was searched if it ends with `Ok`.
pub(crate) fn anytime(
    model: &Model,
    mut bound: u64,
    control: &Control<'_>,
    found: &mut dyn FnMut(Vec<u32>, u64),
) -> Result<(), Halt> {
    let relaxed = Relaxed::new(model);
    let mut additive = Additive::new(model, &relaxed, 1, 1);
    let mut conflicts = Conflicts::new(model);
    let least = least_costs(model);
    let mut walker = Walker::new(model);
    let mut states = States::new(model.init.len());
    let mut cheapest: FxHashMap<(u32, u32), u64> = FxHashMap::default();
    let mut successors: Vec<Successor> = Vec::new();
    let mut open: BinaryHeap<Entry> = BinaryHeap::new();
    let mut tasks = Vec::new();
    loop {
        match walker.go_on() {
            Ended::Done if walker.place.cost < bound => {
                bound = walker.place.cost;
                found(walker.trace.methods(walker.place.trace), bound);
            }
            Ended::Done | Ended::Dead => {}
            Ended::Choice => {
                let place = walker.place;
                tasks.clear();
                tasks.extend(walker.stacks.tasks(place.stack));
                let rest = tasks.iter().fold(0_u64, |sum, task| {
                    sum.saturating_add(least[*task as usize]).min(IMPOSSIBLE)
                });
                let state = states.insert(&walker.state);
                let before = cheapest.entry((state, place.stack)).or_insert(u64::MAX);
                let better = place.cost < *before;
                *before = place.cost.min(*before);
                if better
                    && place.cost.saturating_add(rest) < bound
                    && !conflicts.hopeless(&tasks)
                    && additive.evaluate(&walker.state, &tasks).is_some()
                {
                    control.expanded.fetch_add(1, Ordering::Relaxed);
                    let first = least[tasks[0] as usize];
                    for method in walker.methods.iter().rev() {
                        let subs = model.get(model.methods[*method as usize].subs).iter();
                        let instead = subs.fold(rest.saturating_sub(first), |sum, sub| {
                            sum.saturating_add(least[*sub as usize]).min(IMPOSSIBLE)
                        });
                        let whole = place.cost.saturating_add(instead);
                        if whole < bound {
                            let order = place.cost.saturating_add(instead * WEIGHT);
                            open.push((Reverse(order), whole, successors.len() as u32));
                            successors.push(Successor {
                                place,
                                state,
                                method: *method,
                            });
                        }
                    }
                }
            }
        }
        if control.is_over() {
            return Err(Halt::Told);
        }
        let bytes = states.bytes()
            + walker.bytes()
            + cheapest.capacity() * 17
            + successors.len() * (size_of::<Successor>() + size_of::<Entry>());
        if bytes as u64 > control.memory_limit_bytes || successors.len() >= NONE as usize {
            return Err(Halt::Memory);
        }
        let next = loop {
            match open.pop() {
                None => return Ok(()),
                Some((_, whole, _)) if whole >= bound => {}
                Some((_, _, number)) => break &successors[number as usize],
            }
        };
        walker.jump(next.place, states.get(next.state));
        walker.use_method(next.method);
    }
}
