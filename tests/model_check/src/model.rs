//! All that can happen next.

use std::sync::Arc;

use stateright::{Model, Property};

use crate::arm::Arm;
use crate::boss::{Boss, Bosses};
use crate::happen::{Left, Rules};
use crate::letter::Side;
use crate::lives::Cue;
use crate::mutant::Mutant;
use crate::seen::{Kind, Stamp};
use crate::state::State;
use crate::tables::Tables;

/// How often something may go wrong.
#[derive(Clone, Copy, Debug, Default, Eq, Hash, PartialEq)]
pub struct Budget {
    /// Letters that never arrive.
    pub losses: u8,
    /// Letters that arrive twice.
    pub duplicates: u8,
    /// Processes that die and are started again.
    pub crashes: u8,
}

/// One superior, one executor, and a network that does what it likes within a budget.
#[derive(Clone, Debug)]
pub struct Protocol {
    /// How many goals are asked for, the first of them a normal one, the others emergencies.
    pub goals: usize,
    /// What may go wrong.
    pub budget: Budget,
    /// What has been found out about it.
    pub tables: Arc<Tables>,
}

/// Something that happens. Letters are meant by their place on the wire.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Step {
    /// A user asks for that goal.
    Ask(usize),
    /// That letter arrives.
    Deliver(usize),
    /// It arrives, and will arrive once more. Nothing is different before it has arrived once.
    DeliverOneOfTwo(usize),
    /// It is lost.
    Lose(usize),
    /// What is not answered is sent again.
    Repeat(Side),
    /// What is answered is sent again, since the answer of that place is lost. Nothing is different
    /// before that: until then it might have been late.
    RepeatUnheard(Side, usize),
    /// What was being written is on the disk.
    Written(Side),
    /// What is being done is done.
    Finish,
    /// The executor hears what the world says.
    Sense,
    /// The executor hears of its superior's presence.
    Notice,
    /// That one dies and is started again.
    Crash(Side, Left),
}

const SIDES: [Side; 2] = [Side::Boss, Side::Arm];

impl Protocol {
    /// That many goals, with those faults.
    pub fn new(goals: usize, budget: Budget, mutant: Option<Mutant>) -> Self {
        let rules = Rules {
            bosses: Bosses::new(goals),
            mutant,
        };
        Self {
            goals,
            budget,
            tables: Arc::new(Tables::new(rules, goals)),
        }
    }

    /// With every process that looks like another compared with it in all that it does.
    pub fn doubting(mut self) -> Self {
        let rules = self.tables.rules.clone();
        let mut tables = Tables::new(rules, self.goals);
        tables.doubts = true;
        self.tables = Arc::new(tables);
        self
    }

    /// What happens without anything going wrong.
    fn steps(&self, state: &State, mut step: impl FnMut(Step)) {
        let tables = &*self.tables;
        let asked = |number: &usize| state.asked & 1 << number == 0;
        (0..self.goals)
            .filter(asked)
            .map(Step::Ask)
            .for_each(&mut step);
        each(state, |place, letter| {
            if !self.comes_too_early(state, letter) {
                step(Step::Deliver(place));
            }
        });
        for side in SIDES {
            if state.seen(tables, side).is_writing {
                step(Step::Written(side));
            }
            if self.repeats(state, side) {
                step(Step::Repeat(side));
            }
        }
        if state.notices > 0 {
            step(Step::Notice);
        }
        let world = tables.world(state.world);
        if world.doing.is_some() {
            step(Step::Finish);
        }
        if !world.says.is_empty() {
            step(Step::Sense);
        }
    }

    /// Whether the first message is neither under way nor answered. A repetition although it is on its
    /// way is a duplicate.
    fn repeats(&self, state: &State, side: Side) -> bool {
        self.is_unanswered(state, side, &state.wire)
    }

    /// Whether the first message is not among those letters, nor an answer to it, nor an answer to be said.
    fn is_unanswered(&self, state: &State, side: Side, wire: &[u32]) -> bool {
        let tables = &*self.tables;
        let Some((first, seq)) = state.seen(tables, side).first else {
            return false;
        };
        if state.seen(tables, side.other()).is_busy {
            return false;
        }
        !wire.iter().any(|letter| {
            let stamp = tables.stamp(*letter);
            *letter == first || stamp.kind == Kind::Response(side) && stamp.seq == seq
        })
    }

    /// Whether, if the letter of that place were lost, what it answers would be sent again.
    fn is_missed(&self, state: &State, side: Side, place: usize) -> bool {
        let mut wire = state.wire.clone();
        wire.remove(place);
        self.is_unanswered(state, side, &wire)
    }

    /// Whether a letter resumes something while the executor misses its superior. It would be answered by
    /// a report of suspension, and resumed again, without end until the superior is seen: that is bounded
    /// by time, which there is none of here.
    fn comes_too_early(&self, state: &State, letter: u32) -> bool {
        let resumes = Kind::Instruction { resumes: true };
        state.notices % 2 == 1 && self.tables.stamp(letter).kind == resumes
    }

    /// L1: where nothing can happen any more but a fault, all goals are done and nothing is left.
    fn ends(&self, state: &State) -> bool {
        let mut goes_on = state.broken.is_some();
        self.steps(state, |_| goes_on = true);
        if goes_on {
            return true;
        }
        let tables = &*self.tables;
        let all = u8::MAX >> (8 - self.goals);
        let boss = state.seen(tables, Side::Boss);
        let arm = state.seen(tables, Side::Arm);
        let done = tables.world(state.world).effects.len() == self.goals;
        state.acked == all && boss.ended == all && done && boss.is_idle && arm.is_idle
    }

    fn faults(&self, state: &State, mut step: impl FnMut(Step)) {
        let tables = &*self.tables;
        each(state, |place, letter| {
            let Stamp { kind, epoch, .. } = *tables.stamp(letter);
            let is_old = || epoch < state.seen(tables, Side::Boss).epoch;
            match kind {
                // It is repeated until it is answered: lost and repeated is late.
                Kind::Instruction { .. } | Kind::Report => {}
                Kind::Response(side) => {
                    if state.left.losses > 0 && self.is_missed(state, side, place) {
                        step(Step::RepeatUnheard(side, place));
                    }
                }
                // Past what it runs ahead of it comes too late to be of any use, and that is taken off the
                // wire. Only if that never comes it makes a difference.
                Kind::StopAhead => {
                    if state.left.losses > 0 && is_old() {
                        step(Step::Lose(place));
                    }
                }
            }
            // The second of two answers is of no interest to anybody.
            let is_answer = matches!(kind, Kind::Response(_));
            let is_early = self.comes_too_early(state, letter);
            if state.left.duplicates > 0 && !is_answer && !is_early {
                step(Step::DeliverOneOfTwo(place));
            }
        });
        if state.left.crashes > 0 {
            for side in SIDES {
                step(Step::Crash(side, Left::Before));
                if !state.seen(tables, side).is_writing {
                    continue;
                }
                let effects = match side {
                    Side::Boss => tables.released::<Boss>(state.boss),
                    Side::Arm => tables.released::<Arm>(state.arm),
                };
                for sent in 0..=effects {
                    step(Step::Crash(side, Left::All(sent)));
                }
            }
        }
    }

    fn take(&self, state: &mut State, step: Step) {
        let tables = &*self.tables;
        match step {
            Step::Ask(number) => {
                state.asked |= 1 << number;
                state.happens(tables, Side::Boss, Cue::Ask(number));
            }
            Step::Deliver(place) => {
                let letter = state.wire.remove(place);
                let Stamp { kind, .. } = *tables.stamp(letter);
                state.happens(tables, kind.to(), Cue::Arrives(letter));
            }
            Step::DeliverOneOfTwo(place) => {
                state.left.duplicates -= 1;
                let letter = state.wire[place];
                let Stamp { kind, .. } = *tables.stamp(letter);
                state.happens(tables, kind.to(), Cue::Arrives(letter));
            }
            Step::Lose(place) => {
                state.left.losses -= 1;
                state.wire.remove(place);
            }
            Step::RepeatUnheard(side, place) => {
                state.left.losses -= 1;
                state.wire.remove(place);
                self.take(state, Step::Repeat(side));
            }
            Step::Repeat(side) => {
                if let Some((first, _)) = state.seen(tables, side).first {
                    state.post(tables, first);
                }
            }
            Step::Written(side) => state.happens(tables, side, Cue::Written),
            Step::Finish => state.finish(tables),
            Step::Sense => state.sense(tables),
            Step::Notice => state.notice(tables),
            Step::Crash(side, left) => {
                state.left.crashes -= 1;
                state.crash(tables, side, Cue::Dies(left));
                state.spare(tables);
            }
        }
        state.sweep(tables);
        state.look(tables);
    }
}

/// Every different letter on the wire, with its place.
fn each(state: &State, mut look: impl FnMut(usize, u32)) {
    let mut last = None;
    for (place, letter) in state.wire.iter().enumerate() {
        if last != Some(letter) {
            look(place, *letter);
        }
        last = Some(letter);
    }
}

impl Model for Protocol {
    type State = State;
    type Action = Step;

    fn init_states(&self) -> Vec<State> {
        vec![State::first(&self.tables, self.budget)]
    }

    fn actions(&self, state: &State, steps: &mut Vec<Step>) {
        if state.broken.is_none() {
            self.steps(state, |step| steps.push(step));
            self.faults(state, |step| steps.push(step));
        }
    }

    fn next_state(&self, last: &State, step: Step) -> Option<State> {
        let mut state = last.clone();
        self.take(&mut state, step);
        Some(state)
    }

    fn properties(&self) -> Vec<Property<Self>> {
        vec![
            Property::always("nothing happens that must not", |_, state: &State| {
                state.broken.is_none()
            }),
            Property::always("every acknowledged goal ends", |protocol: &Self, state| {
                protocol.ends(state)
            }),
        ]
    }
}
