//! What can be asked of the belief, and what of it has changed.

/// What a node may have asked for, so that it is looked at again when that changes.
#[derive(Clone, Copy, Debug, Eq, Hash, Ord, PartialEq, PartialOrd)]
pub(super) enum Key {
    /// The value of a variable.
    Variable(u32),
    /// Which facts of a predicate there are, with this object at this place (from 1; 0: with any).
    Pattern(u32, u32, u32),
    /// The value of a function.
    Value(u32),
    /// Whether an action may be tried.
    Action(u32),
}

/// What a change of the belief comes to.
#[derive(Debug, Default)]
pub(super) struct Touched {
    /// What is different, and the variable that is, if it is one: a node whose delta says something
    /// of that does not see the difference.
    pub keys: Vec<(Key, u32)>,
    /// Whether facts have changed of which it was thought that they do not: nothing that was
    /// found out before can be trusted.
    pub all: bool,
}
