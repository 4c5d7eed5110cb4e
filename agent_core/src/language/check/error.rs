//! Why an execution model is refused.

use std::fmt;

use super::super::fit::Misfit;
use crate::model::Symbol;

/// Why an execution model was refused, in the words of its author.
///
/// The key says where in the side file it stands, as in `action.enter.suspension.resume`.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
pub enum DomainError {
    /// A name, a number of arguments or a type that the domain does not know like this.
    #[error("{key}: {misfit}")]
    Misfit {
        /// Where it stands.
        key: String,
        /// What does not fit.
        misfit: Misfit,
    },
    /// The side file speaks of a type that the domain does not declare.
    #[error("{key}: type `{kind}` is not declared in the domain")]
    UndeclaredType {
        /// Where it stands.
        key: String,
        /// The type.
        kind: Symbol,
    },
    /// Only an action can resume or roll back another: a plan begins with an action.
    #[error("`{action}` needs an action here, but `{task}` is a task")]
    NotAnAction {
        /// Where it stands.
        key: String,
        /// The action that can be suspended.
        action: Symbol,
        /// What was given in place of an action.
        task: Symbol,
    },
    /// After the suspension the resuming action could not be executed.
    #[error(
        "`{action}` is suspended, but then `{resuming}` cannot be executed: nothing makes sure \
         that {condition}{case}; add it to the effect of the suspension, or to the precondition of \
         `{action}`"
    )]
    CannotResume {
        /// Where it stands.
        key: String,
        /// The action that can be suspended.
        action: Symbol,
        /// The action that resumes it, with its arguments.
        resuming: String,
        /// The condition that is not met.
        condition: String,
        /// In which case, or nothing.
        case: String,
    },
    /// Suspending and resuming does not come to the same as executing without interruption.
    #[error(
        "`{resuming}` does not end where `{action}` would have ended: `{fact}` is {after_action} \
         after `{action}`, but {after_resuming} after suspending and resuming it{case}"
    )]
    EndsElsewhere {
        /// Where it stands.
        key: String,
        /// The action that can be suspended.
        action: Symbol,
        /// The action that resumes it, with its arguments.
        resuming: String,
        /// The fact that differs.
        fact: String,
        /// What it is without interruption.
        after_action: Truth,
        /// What it is with interruption.
        after_resuming: Truth,
        /// In which case, or nothing.
        case: String,
    },
    /// An effect that depends on the state, or that ranges over some objects only.
    #[error(
        "of `{action}`, suspended and resumed, nothing can be proved, because {whose} has an effect \
         with `when`, or a `forall` that is not over all there is to remove; write it without, or \
         do not let `{action}` be suspended"
    )]
    Unproved {
        /// Where it stands.
        key: String,
        /// The action that can be suspended.
        action: Symbol,
        /// Whose effect it is.
        whose: String,
    },
    /// Nobody waits for sensors without an end.
    #[error(
        "`{action}` is done only when sensors confirm it; add a `timeout_s`, after which it counts \
         as failed"
    )]
    NoTimeOut {
        /// Where it stands.
        key: String,
        /// The action.
        action: Symbol,
    },
    /// A fact that others bring about is brought about by this agent.
    #[error(
        "`{predicate}` is observable, so others change it, but `{action}` makes it true; remove \
         one of the two"
    )]
    ObservableAdded {
        /// Where it stands.
        key: String,
        /// The predicate.
        predicate: Symbol,
        /// The action that adds it.
        action: Symbol,
    },
}

/// What a fact is after an action.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Truth {
    /// It holds.
    True,
    /// It does not hold.
    False,
    /// What it was before.
    AsBefore,
}

impl fmt::Display for Truth {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::True => "true",
            Self::False => "false",
            Self::AsBefore => "as it was before",
        })
    }
}

impl DomainError {
    /// Where in the side file the fault stands: `action.enter.suspension.resume`.
    pub fn key(&self) -> &str {
        match self {
            Self::Misfit { key, .. }
            | Self::UndeclaredType { key, .. }
            | Self::NotAnAction { key, .. }
            | Self::CannotResume { key, .. }
            | Self::EndsElsewhere { key, .. }
            | Self::Unproved { key, .. }
            | Self::NoTimeOut { key, .. }
            | Self::ObservableAdded { key, .. } => key,
        }
    }
}
