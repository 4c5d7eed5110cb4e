//! How long actions take that are done together.

use crate::model::Time;

/// So many ways to put actions in sequence are looked at; far more than there are for the few that one
/// vehicle has.
const WAYS: usize = 20_000;

/// Actions, by their places, with what is known of their order.
pub(super) struct Jobs<'a> {
    /// How long each takes.
    pub durations: &'a [Time],
    /// Which is before which.
    pub before: Vec<(usize, usize)>,
    /// Which must not be at the same time.
    pub apart: Vec<(usize, usize)>,
    /// No schedule is shorter: what one resource has to do takes so long.
    pub at_least: Time,
}

/// When each of the jobs begins and which is before which, so that all of them are done soonest.
pub(super) struct Schedule {
    /// When the last one ends.
    pub makespan: Time,
    /// When each begins.
    pub begins: Vec<Time>,
    /// All pairs of which the first is before the second.
    pub before: Vec<(usize, usize)>,
}

impl Jobs<'_> {
    /// The shortest schedule; `None` if the order goes round in a circle.
    ///
    /// Branch and bound: where two that must be apart are at the same time, one is put before the
    /// other, and then the other before the one.
    pub fn shortest(&self) -> Option<Schedule> {
        let mut search = Search {
            jobs: self,
            best: None,
            ways: WAYS,
        };
        search.go_on(self.before.clone());
        search.best
    }

    /// When each begins if nothing but `before` keeps it; `None` if that goes round in a circle.
    fn earliest(&self, before: &[(usize, usize)]) -> Option<Vec<Time>> {
        let mut begins = vec![Time::ZERO; self.durations.len()];
        // One round for each job is enough, unless it is a circle.
        for _ in 0..=self.durations.len() {
            let mut changed = false;
            for (first, second) in before {
                let end = begins[*first] + self.durations[*first];
                if begins[*second] < end {
                    begins[*second] = end;
                    changed = true;
                }
            }
            if !changed {
                return Some(begins);
            }
        }
        None
    }
}

struct Search<'a> {
    jobs: &'a Jobs<'a>,
    best: Option<Schedule>,
    ways: usize,
}

impl Search<'_> {
    fn go_on(&mut self, before: Vec<(usize, usize)>) {
        let done = |best: &Schedule| self.ways == 0 || best.makespan <= self.jobs.at_least;
        if self.best.as_ref().is_some_and(done) {
            return;
        }
        self.ways = self.ways.saturating_sub(1);
        let durations = self.jobs.durations;
        // Jobs without a duration would hide a circle.
        if goes_round(durations.len(), &before) {
            return;
        }
        let Some(begins) = self.jobs.earliest(&before) else {
            return;
        };
        let ends = begins.iter().zip(durations).map(|(at, takes)| *at + *takes);
        let makespan = ends.max().unwrap_or(Time::ZERO);
        if (self.best.as_ref()).is_some_and(|best| best.makespan <= makespan) {
            return;
        }
        let open = self.jobs.apart.iter().copied().find(|(a, b)| {
            let sequenced = before.contains(&(*a, *b)) || before.contains(&(*b, *a));
            !sequenced && !is_before(&before, *a, *b) && !is_before(&before, *b, *a)
        });
        let Some((a, b)) = open else {
            self.best = Some(Schedule {
                makespan,
                begins,
                before,
            });
            return;
        };
        for pair in [(a, b), (b, a)] {
            let mut before = before.clone();
            before.push(pair);
            self.go_on(before);
        }
    }
}

fn is_before(before: &[(usize, usize)], a: usize, b: usize) -> bool {
    let mut open = vec![a];
    let mut seen = vec![a];
    while let Some(at) = open.pop() {
        for (_, next) in before.iter().filter(|(first, _)| *first == at) {
            if *next == b {
                return true;
            }
            if !seen.contains(next) {
                seen.push(*next);
                open.push(*next);
            }
        }
    }
    false
}

fn goes_round(jobs: usize, before: &[(usize, usize)]) -> bool {
    (0..jobs).any(|job| is_before(before, job, job))
}
