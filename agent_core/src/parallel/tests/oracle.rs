//! Finds out by trying: actions are carried out on sets of facts in every order, overlapping or not.
//! Nothing of the code that is tested is used here.

/// An action over facts that are numbered by bits.
#[derive(Clone, Debug, Default)]
pub struct Act {
    pub needs: u32,
    pub needs_not: u32,
    pub keeps: u32,
    pub keeps_not: u32,
    pub adds: u32,
    pub removes: u32,
    pub resources: u8,
    pub takes: u64,
    pub later: u32,
    pub later_not: u32,
    pub deadline: Option<u64>,
}

#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Together {
    Independent,
    Before,
    After,
    Either,
    Exclusive,
}

impl Act {
    fn can_begin(&self, state: u32) -> bool {
        self.needs & !state == 0 && self.needs_not & state == 0 && self.is_kept(state)
    }

    fn is_kept(&self, state: u32) -> bool {
        self.keeps & !state == 0 && self.keeps_not & state == 0
    }

    fn done(&self, state: u32) -> u32 {
        state & !self.removes | self.adds
    }

    pub fn missing(&self, now: u32) -> u32 {
        self.needs & !now
    }
}

/// Carries out begins and ends in that order. Returns the state at the end, unless something breaks.
fn carry_out(acts: [&Act; 2], events: [usize; 4], start: u32, with_resources: bool) -> Option<u32> {
    let mut state = start;
    let mut running = [false; 2];
    for which in events {
        let act = acts[which];
        if running[which] {
            running[which] = false;
            state = act.done(state);
        } else {
            if !act.can_begin(state) {
                return None;
            }
            if with_resources && running[1 - which] && acts[0].resources & acts[1].resources != 0 {
                return None;
            }
            running[which] = true;
        }
        if (0..2).any(|other| running[other] && !acts[other].is_kept(state)) {
            return None;
        }
    }
    Some(state)
}

const FIRST_THEN_SECOND: [usize; 4] = [0, 0, 1, 1];
const ORDERS: [[usize; 4]; 6] = [
    FIRST_THEN_SECOND,
    [1, 1, 0, 0],
    [0, 1, 0, 1],
    [0, 1, 1, 0],
    [1, 0, 0, 1],
    [1, 0, 1, 0],
];

pub fn together(a: &Act, b: &Act, now: u32) -> Together {
    // What others bring about is there; what the two bring about for each other is not.
    let start = now | a.missing(now) & !b.adds | b.missing(now) & !a.adds;
    let start = start & !(a.adds & b.missing(now)) & !(b.adds & a.missing(now));
    let freely = |with_resources: bool| {
        ORDERS.iter().all(|order| {
            carry_out([a, b], *order, start, with_resources).is_some_and(|end| {
                (a.adds | b.adds) & !end == 0 && (a.removes | b.removes) & end == 0
            })
        })
    };
    if freely(true) {
        return Together::Independent;
    }
    if freely(false) {
        return Together::Either;
    }
    let in_order = |first: &Act, second: &Act| {
        let end = carry_out([first, second], FIRST_THEN_SECOND, start, true);
        let result_stays =
            end.is_some_and(|end| first.removes & end == 0 && first.adds & first.later & !end == 0);
        let withheld = start & !first.adds | first.removes;
        let waits = second.needs & !withheld != 0 || second.needs_not & withheld != 0;
        let reversed = carry_out([second, first], FIRST_THEN_SECOND, start, true);
        let reason = reversed.is_none()
            || waits && (second.needs & first.adds != 0 || second.needs_not & first.removes != 0)
            || first.resources & second.resources != 0;
        result_stays && reason
    };
    match (in_order(a, b), in_order(b, a)) {
        (true, false) => Together::Before,
        (false, true) => Together::After,
        _ => Together::Exclusive,
    }
}

/// The best set of actions, by trying all sets in all orders.
#[derive(Clone, Debug, PartialEq)]
pub struct Best {
    pub members: Vec<usize>,
    pub saving: u64,
    pub loss: u64,
}

pub struct Case<'a> {
    pub acts: &'a [Act],
    /// What runs, and how long it still takes.
    pub running: &'a [(Act, u64)],
    pub now: u32,
    /// How long it takes to bring a fact about again, or to get rid of it, after so many changes.
    pub mending: &'a dyn Fn(usize, bool, usize) -> Option<u64>,
}

impl Case<'_> {
    pub fn best(&self) -> Option<Best> {
        let mut best: Option<(Best, i128, u64, u64)> = None;
        for set in 0_u32..1 << self.acts.len() {
            let members: Vec<usize> = (0..self.acts.len())
                .filter(|it| set >> it & 1 == 1)
                .collect();
            if members.is_empty() && self.running.is_empty() {
                continue;
            }
            let Some((makespan, state)) = self.quickest(&members) else {
                continue;
            };
            let own: u64 = members.iter().map(|it| self.acts[*it].takes).sum();
            let all = own + self.running.iter().map(|(_, left)| left).sum::<u64>();
            let found = Best {
                saving: all - makespan,
                loss: self.loss(&members, state),
                members,
            };
            let score = i128::from(found.saving) - i128::from(found.loss);
            let deadlines = found
                .members
                .iter()
                .filter_map(|it| self.acts[*it].deadline);
            let deadline = deadlines.min().unwrap_or(u64::MAX);
            let better = match &best {
                None => true,
                Some((known, known_score, known_own, known_deadline)) => {
                    let (a, b) = (
                        (score, own, found.members.len()),
                        (*known_score, *known_own, known.members.len()),
                    );
                    a > b
                        || a == b
                            && (deadline < *known_deadline
                                || deadline == *known_deadline && found.members < known.members)
                }
            };
            if better {
                best = Some((found, score, own, deadline));
            }
        }
        best.map(|(best, ..)| best)
    }

    /// The shortest way to do all of them, and the facts that are so by their doing in the end:
    /// added, removed.
    fn quickest(&self, members: &[usize]) -> Option<(u64, (u32, u32))> {
        let all: Vec<(&Act, u64)> = (self.running.iter().map(|(act, left)| (act, *left)))
            .chain(
                members
                    .iter()
                    .map(|it| (&self.acts[*it], self.acts[*it].takes)),
            )
            .collect();
        let ran = self.running.len();
        let mut pairs = vec![vec![Together::Independent; all.len()]; all.len()];
        for a in 0..all.len() {
            for b in a + 1..all.len() {
                if b < ran {
                    continue;
                }
                let mut how = together(all[a].0, all[b].0, self.now);
                if a < ran {
                    // What runs wants nothing of what comes after it.
                    let alone = Act {
                        later: 0,
                        later_not: 0,
                        ..all[a].0.clone()
                    };
                    how = match together(&alone, all[b].0, self.now) {
                        Together::Either => Together::Before,
                        Together::After => Together::Exclusive,
                        how => how,
                    };
                }
                if how == Together::Exclusive {
                    return None;
                }
                pairs[a][b] = how;
                pairs[b][a] = match how {
                    Together::Before => Together::After,
                    Together::After => Together::Before,
                    how => how,
                };
            }
        }
        let mut search = Orders {
            case: self,
            all: &all,
            ran,
            pairs: &pairs,
            best: None,
        };
        let begun: Vec<(usize, u64)> = (0..ran).map(|it| (it, 0)).collect();
        search.all_orders(&begun);
        search.best
    }

    /// What is lost by leaving out the others, beyond what the members lost if those went first.
    fn loss(&self, members: &[usize], (added, removed): (u32, u32)) -> u64 {
        let mut loss = 0;
        for (place, act) in self.acts.iter().enumerate() {
            if members.contains(&place) {
                continue;
            }
            let theirs = members.iter().map(|it| &self.acts[*it]);
            let theirs: u64 = theirs
                .map(|it| self.spoilt(it, act.adds, act.removes))
                .sum();
            loss += self.spoilt(act, added, removed).saturating_sub(theirs);
        }
        loss
    }

    /// How long it takes to make good for `act` what these changes spoil.
    fn spoilt(&self, act: &Act, added: u32, removed: u32) -> u64 {
        let changed = (added | removed).count_ones() as usize;
        let after = self.now & !removed | added;
        let (mut adds, mut removes) = (act.adds & act.later, act.removes & act.later_not);
        if adds | removes == 0 {
            (adds, removes) = (act.adds, act.removes);
        }
        if adds & !after == 0 && removes & after == 0 {
            return 0;
        }
        let mut lost = 0;
        for fact in 0..32 {
            let bit = 1 << fact;
            let spoilt = act.needs & self.now & removed & bit != 0;
            let in_the_way = act.needs_not & !self.now & added & bit != 0;
            if spoilt || in_the_way {
                lost += (self.mending)(fact, spoilt, changed).unwrap_or(act.takes);
            }
        }
        lost
    }
}

struct Orders<'a> {
    case: &'a Case<'a>,
    all: &'a [(&'a Act, u64)],
    ran: usize,
    pairs: &'a [Vec<Together>],
    best: Option<(u64, (u32, u32))>,
}

impl Orders<'_> {
    /// Puts one action after another, each as early as those before it let it begin.
    fn all_orders(&mut self, begun: &[(usize, u64)]) {
        if begun.len() == self.all.len() {
            self.try_out(begun);
            return;
        }
        for next in self.ran..self.all.len() {
            if begun.iter().any(|(it, _)| *it == next) {
                continue;
            }
            let too_late =
                (begun.iter()).any(|(before, _)| self.pairs[*before][next] == Together::After);
            // Of two that have nothing to do with each other one order is enough.
            let same_again = begun.last().is_some_and(|(last, _)| {
                *last >= self.ran
                    && *last > next
                    && self.pairs[*last][next] == Together::Independent
            });
            if too_late || same_again {
                continue;
            }
            let ends = begun.iter().filter_map(|(before, at)| {
                let apart = self.pairs[*before][next] != Together::Independent;
                apart.then(|| at + self.all[*before].1)
            });
            let at = ends.max().unwrap_or(0);
            let mut begun = begun.to_vec();
            begun.push((next, at));
            self.all_orders(&begun);
        }
    }

    /// Carries it out on the facts.
    fn try_out(&mut self, begun: &[(usize, u64)]) {
        // Time, whether it begins, which: what ends makes room for what begins.
        let mut events: Vec<(u64, bool, usize)> = Vec::new();
        for (which, at) in begun {
            if *which >= self.ran {
                events.push((*at, true, *which));
            }
            events.push((at + self.all[*which].1, false, *which));
        }
        events.sort();
        let mut state = self.case.now;
        let (mut added, mut removed) = (0, 0);
        let mut running: Vec<usize> = (0..self.ran).collect();
        for (_, begins, which) in &events {
            let act = self.all[*which].0;
            if *begins {
                let taken = running
                    .iter()
                    .any(|it| self.all[*it].0.resources & act.resources != 0);
                if taken || !act.can_begin(state) {
                    return;
                }
                running.push(*which);
            } else {
                running.retain(|it| it != which);
                state = act.done(state);
                if *which >= self.ran {
                    added = added & !act.removes | act.adds;
                    removed = removed & !act.adds | act.removes;
                }
            }
            if running.iter().any(|it| !self.all[*it].0.is_kept(state)) {
                return;
            }
        }
        let makespan = events.last().map_or(0, |(at, ..)| *at);
        if self.best.is_none_or(|(known, _)| makespan < known) {
            self.best = Some((makespan, (added, removed)));
        }
    }
}
