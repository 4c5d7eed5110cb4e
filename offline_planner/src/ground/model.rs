//! The ground problem: facts, actions, tasks and methods by number, without variables.

use super::origin::Origin;

/// No check, action or task.
pub(crate) const NONE: u32 = u32::MAX;

/// A fact or its negation: twice the fact's number, and one more if it must not hold.
pub(crate) type Literal = u32;

/// A part of one of the model's lists.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Span {
    start: u32,
    len: u32,
}

impl Span {
    fn range(self) -> std::ops::Range<usize> {
        self.start as usize..(self.start + self.len) as usize
    }
}

/// What can be executed.
#[derive(Clone, Debug)]
pub(crate) struct Action {
    /// Literals that must hold.
    pub pre: Span,
    /// A further condition, or [`NONE`].
    pub check: u32,
    /// Facts that end, in any case.
    pub del: Span,
    /// Facts that begin, in any case.
    pub add: Span,
    /// Effects under conditions.
    pub conditional: (u32, u32),
    /// In millionths of the domain's unit.
    pub cost: u64,
    /// Which it was made of; [`NONE`] for those that no plan shows.
    pub origin: u32,
}

/// A fact that begins or ends under a condition.
#[derive(Clone, Debug)]
pub(crate) struct Conditional {
    /// Literals that must hold before the action.
    pub when: Span,
    /// A further condition, or [`NONE`].
    pub check: u32,
    /// Whether the fact begins.
    pub add: bool,
    /// Which.
    pub fact: u32,
}

/// A way to do a task, or a piece of one.
#[derive(Clone, Debug)]
pub(crate) struct Method {
    /// The task.
    pub task: u32,
    /// Literals that must hold.
    pub pre: Span,
    /// A further condition, or [`NONE`].
    pub check: u32,
    /// Tasks that are to be done instead, in order.
    pub subs: Span,
    /// Which it was made of.
    pub origin: u32,
}

/// What is to be done.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Task {
    /// By executing this.
    Action(u32),
    /// By one of these methods: the first, and how many.
    Methods(u32, u32),
}

/// A condition that is no conjunction of literals.
#[derive(Clone, Debug)]
pub(crate) enum Check {
    /// The literal holds.
    Literal(Literal),
    /// All of these.
    All(Vec<Check>),
    /// One of these.
    Any(Vec<Check>),
    /// Never.
    Never,
}

/// The ground problem.
#[derive(Clone, Debug, Default)]
pub(crate) struct Model {
    /// How many facts there are.
    pub facts: usize,
    /// One bit for each fact that holds at first.
    pub init: Vec<u64>,
    /// By task.
    pub tasks: Vec<Task>,
    /// By action.
    pub actions: Vec<Action>,
    /// Those of one task together.
    pub methods: Vec<Method>,
    /// By number.
    pub conditionals: Vec<Conditional>,
    /// By number.
    pub checks: Vec<Check>,
    /// The task that stands for the whole problem.
    pub top: u32,
    /// What everything was made of.
    pub origin: Origin,
    pool: Vec<u32>,
}

/// Whether `state` has the fact.
pub(crate) fn has(state: &[u64], fact: u32) -> bool {
    state[fact as usize / 64] >> (fact % 64) & 1 == 1
}

/// Whether the literal holds in `state`.
pub(crate) fn holds(state: &[u64], literal: Literal) -> bool {
    has(state, literal >> 1) != (literal & 1 == 1)
}

impl Check {
    /// Whether it holds in `state`.
    pub fn holds(&self, state: &[u64]) -> bool {
        match self {
            Self::Literal(literal) => holds(state, *literal),
            Self::All(parts) => parts.iter().all(|part| part.holds(state)),
            Self::Any(parts) => parts.iter().any(|part| part.holds(state)),
            Self::Never => false,
        }
    }
}

impl Model {
    /// About how much memory this takes.
    pub fn bytes(&self) -> usize {
        self.pool.len() * 4
            + self.actions.len() * size_of::<Action>()
            + self.methods.len() * size_of::<Method>()
            + self.conditionals.len() * size_of::<Conditional>()
            + self.tasks.len() * size_of::<Task>()
            + self.origin.bytes()
    }

    /// Puts numbers into the common list.
    pub fn list(&mut self, numbers: impl IntoIterator<Item = u32>) -> Span {
        let start = self.pool.len();
        self.pool.extend(numbers);
        Span {
            start: start as u32,
            len: (self.pool.len() - start) as u32,
        }
    }

    /// Sorted, each number once.
    pub fn set(&mut self, mut numbers: Vec<u32>) -> Span {
        numbers.sort_unstable();
        numbers.dedup();
        self.list(numbers)
    }

    /// What the span stands for.
    pub fn get(&self, span: Span) -> &[u32] {
        &self.pool[span.range()]
    }

    /// The action's effects under conditions.
    pub fn conditionals_of(&self, action: &Action) -> &[Conditional] {
        let (first, count) = action.conditional;
        &self.conditionals[first as usize..(first + count) as usize]
    }

    /// Whether literals and check hold in `state`.
    pub fn possible(&self, state: &[u64], pre: Span, check: u32) -> bool {
        self.get(pre).iter().all(|literal| holds(state, *literal)) && self.check_holds(state, check)
    }

    /// Whether the check, if there is one, holds in `state`.
    pub fn check_holds(&self, state: &[u64], check: u32) -> bool {
        check == NONE || self.checks[check as usize].holds(state)
    }

    /// Writes into `after` what `action` makes of `state`.
    pub fn apply(&self, action: &Action, state: &[u64], after: &mut [u64]) {
        after.copy_from_slice(state);
        let happening = |adds: bool| {
            self.conditionals_of(action).iter().filter(move |effect| {
                effect.add == adds && self.possible(state, effect.when, effect.check)
            })
        };
        for fact in self.get(action.del) {
            after[*fact as usize / 64] &= !(1 << (fact % 64));
        }
        for effect in happening(false) {
            after[effect.fact as usize / 64] &= !(1 << (effect.fact % 64));
        }
        for fact in self.get(action.add) {
            after[*fact as usize / 64] |= 1 << (fact % 64);
        }
        for effect in happening(true) {
            after[effect.fact as usize / 64] |= 1 << (effect.fact % 64);
        }
    }

    /// The methods of a task; none for an action.
    pub fn methods_of(&self, task: u32) -> std::ops::Range<usize> {
        match self.tasks[task as usize] {
            Task::Methods(first, count) => first as usize..(first + count) as usize,
            Task::Action(_) => 0..0,
        }
    }
}
