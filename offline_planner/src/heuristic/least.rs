//! What each task costs at least, in whatever state.

use crate::ground::Model;
use crate::ground::model::Task;

/// More than any plan costs: the task cannot be done.
pub(crate) const IMPOSSIBLE: u64 = u64::MAX / 4;

/// By task, a lower bound of its cost: the cheapest way to decompose it, preconditions aside.
pub(crate) fn least_costs(model: &Model) -> Vec<u64> {
    let mut least: Vec<u64> = model
        .tasks
        .iter()
        .map(|task| match task {
            Task::Action(action) => model.actions[*action as usize].cost.min(IMPOSSIBLE),
            Task::Methods(..) => IMPOSSIBLE,
        })
        .collect();
    loop {
        let mut changed = false;
        for method in &model.methods {
            let subs = model.get(method.subs).iter();
            let sum = subs.fold(0_u64, |sum, sub| {
                sum.saturating_add(least[*sub as usize]).min(IMPOSSIBLE)
            });
            if sum < least[method.task as usize] {
                least[method.task as usize] = sum;
                changed = true;
            }
        }
        if !changed {
            return least;
        }
    }
}
