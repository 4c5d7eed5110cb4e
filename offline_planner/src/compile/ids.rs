//! Numbers in place of names.

/// Declares a number that stands for one kind of thing, so that two kinds are not mixed up.
macro_rules! id {
    ($(#[$doc:meta])* $name:ident) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Eq, PartialEq, Ord, PartialOrd, Hash)]
        pub struct $name(pub u32);

        impl $name {
            /// From a place in a list. Lists here are as long as a text that was read, so a place
            /// fits.
            pub fn new(index: usize) -> Self {
                Self(u32::try_from(index).unwrap_or(u32::MAX))
            }

            /// As a place in a list.
            pub fn index(self) -> usize {
                self.0 as usize
            }
        }
    };
}

id!(
    /// An object, by its place in [`Compiled::objects`](super::Compiled::objects).
    ObjectId
);
id!(
    /// A set of objects that a variable ranges over, by its place in [`Compiled::kinds`](super::Compiled::kinds).
    KindId
);
id!(
    /// A predicate, by its place in [`Compiled::predicates`](super::Compiled::predicates).
    PredicateId
);
id!(
    /// An action, by its place in [`Compiled::actions`](super::Compiled::actions).
    ActionId
);
id!(
    /// An abstract task, by its place in [`Compiled::tasks`](super::Compiled::tasks).
    TaskId
);
id!(
    /// A method, by its place in [`Compiled::methods`](super::Compiled::methods).
    MethodId
);
