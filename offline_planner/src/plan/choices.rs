//! A plan as the searches hand it over.

use crate::compile::{Compiled, MethodId, ObjectId};

/// Which method with which objects, for each task that is decomposed, in the order in which a
/// machine comes to them that always decomposes the first task that is left.
///
/// The first choice is for [`Compiled::top`]. Together they say everything about a plan: actions
/// need no choice. Kept flat, as a plan may have millions of them.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Choices {
    methods: Vec<MethodId>,
    bindings: Vec<ObjectId>,
}

impl Choices {
    /// One more: an object for each variable of the method.
    pub fn push(&mut self, method: MethodId, bindings: &[ObjectId]) {
        self.methods.push(method);
        self.bindings.extend_from_slice(bindings);
    }

    /// How many tasks are decomposed.
    pub fn len(&self) -> usize {
        self.methods.len()
    }

    /// Whether there is not even one for the top.
    pub fn is_empty(&self) -> bool {
        self.methods.is_empty()
    }

    /// All of them, in order.
    pub fn iter<'a>(
        &'a self,
        compiled: &'a Compiled,
    ) -> impl Iterator<Item = (MethodId, &'a [ObjectId])> {
        let mut rest = &self.bindings[..];
        self.methods.iter().map_while(move |method| {
            let (bindings, after) = rest.split_at_checked(compiled.method(*method).kinds.len())?;
            rest = after;
            Some((*method, bindings))
        })
    }
}
