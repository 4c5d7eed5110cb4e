//! Stories: what happens to a robot, and when.

mod play;
mod read;
#[cfg(test)]
mod tests;

use agent_core::model::{Fact, FactChange, Symbol, Time};
use agent_core::protocol::{Command, GoalId, GoalRequest};

pub(crate) use play::{Player, Told};

/// What happens, one after the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Scenario {
    /// In the order of the file, which is the order in which they happen.
    pub(crate) events: Vec<ScenarioEvent>,
}

/// One thing that happens, once everything before it has.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ScenarioEvent {
    /// Where it stands in the file.
    pub(crate) line: usize,
    pub(crate) when: When,
    /// For people.
    pub(crate) say: Option<String>,
    /// Nothing, if it is only said.
    pub(crate) what: Option<What>,
}

/// When it happens.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum When {
    /// Right after what came before.
    Next,
    /// So long after the robot was ready.
    At(Time),
    /// When the robot is seen well on this arc.
    WhileOn(Symbol),
    /// When an agent is in the middle of an action.
    WhileDoing {
        agent: Symbol,
        /// The action's name.
        action: Symbol,
    },
    /// When somebody has learnt that this is so.
    Once(Fact),
}

/// What happens.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum What {
    Goal {
        request: GoalRequest,
        /// The vehicle that it is for, where there are several.
        to: Option<Symbol>,
    },
    Command(Command),
    Fact(FactChange),
}

impl Scenario {
    /// The names of its goals.
    pub(crate) fn goals(&self) -> impl Iterator<Item = &GoalId> {
        self.events.iter().filter_map(|event| match &event.what {
            // The reader has given each a name.
            Some(What::Goal { request, .. }) => request.id.as_ref(),
            _ => None,
        })
    }
}
