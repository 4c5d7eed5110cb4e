//! All that can happen next.

use std::sync::Arc;

use agent_core::protocol::{Instruction, Rows};
use stateright::{Model, Property};

use crate::arm::Arm;
use crate::boss::{Boss, Bosses, goal};
use crate::letter::{Letter, Side};
use crate::node::{Left, Node};
use crate::state::State;

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

/// A mistake on purpose, which must be found.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Mutant {
    /// What depends on a writing leaves before it.
    Hasty,
    /// An answer that something is over does not say how.
    NoOutcome,
    /// After a restart nobody knows what was applied.
    NoInbox,
}

/// One superior, one executor, and a network that does what it likes within a budget.
#[derive(Clone, Debug)]
pub struct Protocol {
    /// How many goals are asked for, the first of them a normal one, the others emergencies.
    pub goals: usize,
    /// What may go wrong.
    pub budget: Budget,
    /// What is wrong on purpose.
    pub mutant: Option<Mutant>,
    bosses: Bosses,
}

/// Something that happens.
#[derive(Clone, Debug, Eq, PartialEq)]
pub enum Step {
    /// A user asks for that goal.
    Ask(usize),
    /// The letter of that place on the wire arrives.
    Deliver(usize),
    /// It is lost.
    Lose(usize),
    /// It will arrive once more than it would have.
    Duplicate(usize),
    /// What is not answered is sent again.
    Repeat(Side),
    /// What was being written is on the disk.
    Written(Side),
    /// What is being done is done.
    Finish,
    /// The executor hears what the world says.
    Sense,
    /// That one hears of its neighbour's presence.
    Notice(Side),
    /// That one dies and is started again.
    Crash(Side, Left),
}

impl Protocol {
    /// That many goals, with those faults.
    pub fn new(goals: usize, budget: Budget, mutant: Option<Mutant>) -> Self {
        Self {
            goals,
            budget,
            mutant,
            bosses: Bosses::new(goals),
        }
    }

    /// A superior that has just started.
    pub fn boss(&self, epoch: u64) -> Boss {
        self.bosses.make(epoch)
    }

    /// What happens without anything going wrong.
    fn steps(&self, state: &State, steps: &mut Vec<Step>) {
        let unasked = (0..self.goals).filter(|number| !state.asked.contains(number));
        steps.extend(unasked.map(Step::Ask));
        let arrives = |at: &usize| !comes_too_early(state, *at);
        steps.extend((0..state.wire.len()).filter(arrives).map(Step::Deliver));
        for side in [Side::Boss, Side::Arm] {
            if state.is_writing(side) {
                steps.push(Step::Written(side));
            }
            if !state.notices[side as usize].is_empty() {
                steps.push(Step::Notice(side));
            }
            if repeats(state, side) {
                steps.push(Step::Repeat(side));
            }
        }
        if state.world.doing.is_some() {
            steps.push(Step::Finish);
        }
        if !state.world.says.is_empty() {
            steps.push(Step::Sense);
        }
    }

    fn crash(&self, state: &mut State, side: Side, left: Left) {
        match side {
            Side::Boss => {
                let mut boss = (*state.boss).clone();
                if let Left::All(sent) = left {
                    boss.written();
                    let mut effects = boss.effects(false);
                    effects.truncate(sent);
                    state.boss_says(effects);
                }
                let epoch = boss.epoch + 1;
                let disk = self.found(boss.disk);
                match Node::start("boss", epoch, self.boss(epoch), disk) {
                    Ok(boss) => state.boss = Arc::new(boss),
                    Err(error) => state.broken(error.to_string()),
                }
                // Whoever was not answered asks again.
                state.asked = state.acked.clone();
            }
            Side::Arm => {
                let mut arm = (*state.arm).clone();
                if let Left::All(sent) = left {
                    arm.written();
                    let mut effects = arm.effects(false);
                    effects.truncate(sent);
                    state.arm_says(effects);
                }
                let epoch = arm.epoch + 1;
                let disk = self.found(arm.disk);
                match Node::start("arm", epoch, Arm::new(), disk) {
                    Ok(arm) => state.arm = Arc::new(arm),
                    Err(error) => state.broken(error.to_string()),
                }
                state.world.says.clear();
            }
        }
        // Answers to a process that is no more.
        let kept = |letter: &Letter| !matches!(letter, Letter::Response { to, .. } if *to == side);
        state.wire.retain(|_, (letter, _)| kept(letter));
        state.pump(self, side);
        // Whoever starts sees its neighbour at once, and the superior its executor, since that makes no
        // difference to what either does. When the executor misses its superior does.
        state.notices[side as usize] = [true].into();
        state.notice(side);
        state.pump(self, side);
        state.notices[side.other() as usize].extend([false, true]);
        if side == Side::Arm {
            state.notice(Side::Boss);
            state.notice(Side::Boss);
            state.pump(self, Side::Boss);
        }
    }

    fn found(&self, mut disk: Rows) -> Rows {
        if self.mutant == Some(Mutant::NoInbox) {
            disk.retain(|key, _| !key.starts_with("s/in/"));
        }
        disk
    }

    /// In words, what a step does.
    pub fn tell(&self, state: &State, step: &Step) -> String {
        let letter = |at: usize| {
            let mut letters = state.wire.values();
            letters
                .nth(at)
                .map(|(letter, _)| letter.to_string())
                .unwrap_or_default()
        };
        match step {
            Step::Ask(number) => format!("a user asks for {}", goal(*number)),
            Step::Deliver(at) => format!("arrives: {}", letter(*at)),
            Step::Lose(at) => format!("IS LOST: {}", letter(*at)),
            Step::Duplicate(at) => format!("IS DOUBLED: {}", letter(*at)),
            Step::Repeat(side) => format!("the {} repeats what is not answered", side.name()),
            Step::Written(side) => format!("the {}'s disk has it", side.name()),
            Step::Finish => format!(
                "the world has done {}",
                state
                    .world
                    .doing
                    .as_ref()
                    .map(|(.., a)| a.to_string())
                    .unwrap_or_default()
            ),
            Step::Sense => format!("the arm hears {:?}", state.world.says.front()),
            Step::Notice(side) => format!(
                "the {} hears that the {} is {}",
                side.name(),
                side.other().name(),
                match state.notices[*side as usize].front() {
                    Some(false) => "gone",
                    _ => "there",
                }
            ),
            Step::Crash(side, Left::Before) => {
                format!(
                    "THE {} DIES and starts again from what was written before",
                    side.name()
                )
            }
            Step::Crash(side, Left::All(sent)) => format!(
                "THE {} DIES after a writing, when {sent} effects of it had got out, and starts again",
                side.name()
            ),
        }
    }
}

/// Whether the first message is neither under way nor answered. A repetition although it is on its way
/// is a duplicate.
fn repeats(state: &State, side: Side) -> bool {
    let (first, busy) = match side {
        Side::Boss => (state.boss.queue.front(), state.arm.station.held() > 0),
        Side::Arm => (state.arm.queue.front(), state.boss.station.held() > 0),
    };
    let Some(first) = first.filter(|_| !busy) else {
        return false;
    };
    let mut letters = state.wire.values().map(|(letter, _)| &**letter);
    !letters.any(|letter| {
        letter == first
            || matches!(letter, Letter::Response { to, .. } if *to == side)
                && letter.seq() == first.seq()
    })
}

impl Model for Protocol {
    type State = State;
    type Action = Step;

    fn init_states(&self) -> Vec<State> {
        let boss = Node::start("boss", 1, self.boss(1), Rows::new());
        let arm = Node::start("arm", 1, Arm::new(), Rows::new());
        let (boss, arm) = (boss.expect("an empty disk"), arm.expect("an empty disk"));
        vec![State::first(self, boss, arm)]
    }

    fn actions(&self, state: &State, steps: &mut Vec<Step>) {
        if state.broken.is_some() {
            return;
        }
        self.steps(state, steps);
        let letters = state.wire.len();
        if state.left.losses > 0 {
            let lost = |at: &usize| !is_request(state, *at);
            steps.extend((0..letters).filter(lost).map(Step::Lose));
        }
        if state.left.duplicates > 0 {
            let doubled = |at: &usize| !is_response(state, *at);
            steps.extend((0..letters).filter(doubled).map(Step::Duplicate));
        }
        if state.left.crashes > 0 {
            for side in [Side::Boss, Side::Arm] {
                steps.push(Step::Crash(side, Left::Before));
                if !state.is_writing(side) {
                    continue;
                }
                let effects = match side {
                    Side::Boss => released(&state.boss),
                    Side::Arm => released(&state.arm),
                };
                steps.extend((0..=effects).map(|sent| Step::Crash(side, Left::All(sent))));
            }
        }
    }

    fn next_state(&self, last: &State, step: Step) -> Option<State> {
        let mut state = last.clone();
        let at = |at: usize| last.wire.iter().nth(at);
        match step {
            Step::Ask(number) => state.ask(self, number),
            Step::Deliver(place) => {
                let (key, (letter, _)) = at(place)?;
                take_off(&mut state, key);
                state.deliver(self, letter);
            }
            Step::Lose(place) => {
                state.left.losses -= 1;
                take_off(&mut state, at(place)?.0);
            }
            Step::Duplicate(place) => {
                state.left.duplicates -= 1;
                state.wire.get_mut(at(place)?.0)?.1 += 1;
            }
            Step::Repeat(side) => {
                let first = match side {
                    Side::Boss => last.boss.queue.front(),
                    Side::Arm => last.arm.queue.front(),
                };
                state.post(first.cloned());
            }
            Step::Written(side) => state.written(self, side),
            Step::Finish => state.finish(),
            Step::Sense => state.sense(self),
            Step::Notice(side) => {
                state.notice(side);
                state.pump(self, side);
            }
            Step::Crash(side, left) => {
                state.left.crashes -= 1;
                self.crash(&mut state, side, left);
            }
        }
        state.sweep();
        state.stamp(self, Some(last));
        Some(state)
    }

    fn properties(&self) -> Vec<Property<Self>> {
        vec![
            Property::always("nothing happens that must not", |_, state: &State| {
                state.broken.is_none()
            }),
            Property::always("every acknowledged goal ends", |protocol: &Self, state| {
                ends(protocol, state)
            }),
        ]
    }
}

/// L1: where nothing can happen any more but a fault, all goals are done and nothing is left.
fn ends(protocol: &Protocol, state: &State) -> bool {
    let mut steps = Vec::new();
    protocol.steps(state, &mut steps);
    if !steps.is_empty() || state.broken.is_some() {
        return true;
    }
    let boss = state.boss.station.machine();
    let all = (0..protocol.goals)
        .all(|number| state.acked.contains(&number) && boss.ended_goal(&goal(number)).is_some());
    let done = state.world.effects.len() == protocol.goals;
    let idle = boss.counts().values().all(|count| *count == 0);
    all && done && idle && state.arm.station.machine().is_empty()
}

/// Whether a letter is repeated until it is answered. If such a one is lost and repeated it is as if it had
/// been late, so it need not be lost here.
fn is_request(state: &State, at: usize) -> bool {
    let mut letters = state.wire.values();
    letters
        .nth(at)
        .is_some_and(|(letter, _)| matches!(**letter, Letter::Instruction(_) | Letter::Report(_)))
}

/// Whether a letter is an answer. The second of two is of no interest to anybody.
fn is_response(state: &State, at: usize) -> bool {
    let mut letters = state.wire.values();
    letters
        .nth(at)
        .is_some_and(|(letter, _)| matches!(**letter, Letter::Response { .. }))
}

/// Whether a letter resumes something while the executor misses its superior. It would be answered by
/// a report of suspension, and resumed again, without end until the superior is seen: that is bounded
/// by time, which there is none of here.
fn comes_too_early(state: &State, at: usize) -> bool {
    if state.notices[Side::Arm as usize].len() != 1 {
        return false;
    }
    let mut letters = state.wire.values();
    letters.nth(at).is_some_and(|(letter, _)| match &**letter {
        Letter::Instruction(message) => matches!(message.body, Instruction::Resume { .. }),
        _ => false,
    })
}

fn take_off(state: &mut State, key: &str) {
    if let Some((_, count)) = state.wire.get_mut(key) {
        *count -= 1;
        if *count == 0 {
            state.wire.remove(key);
        }
    }
}

/// How many effects wait for the writing that is under way.
fn released<M>(node: &Node<M>) -> usize
where
    M: agent_core::protocol::Durable + Clone + std::fmt::Debug,
    M::Out: Clone + std::fmt::Debug,
{
    let mut node = node.clone();
    node.written();
    node.effects(false).len().saturating_sub(1)
}
