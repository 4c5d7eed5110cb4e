//! Mistakes on purpose, each of which must be found.

use std::sync::Arc;

use agent_core::protocol::{Answer, Arrival, Heard, Input, Rows, read_row};

use crate::letter::{Letter, Side};
use crate::node::Node;
use crate::role::Role;

/// A mistake on purpose, which must be found.
#[derive(Clone, Copy, Debug, Eq, PartialEq, clap::ValueEnum)]
pub enum Mutant {
    /// What depends on a writing leaves before it.
    Hasty,
    /// An answer that something is over does not say how.
    NoOutcome,
    /// After a restart nobody knows what was applied.
    NoInbox,
    /// What stops something ahead of its turn is not heeded if that has not begun.
    NoFence,
    /// An instruction that comes again is followed again.
    Afresh,
    /// The journal says that it has written and has not.
    Unwritten,
}

impl Mutant {
    /// What is found on a disk at a restart.
    pub(crate) fn found(mutant: Option<Self>, disk: &Arc<Rows>) -> Arc<Rows> {
        let mut disk = disk.clone();
        if mutant == Some(Self::NoInbox) {
            Arc::make_mut(&mut disk).retain(|key, _| !key.starts_with("s/in/"));
        }
        disk
    }

    /// What an answer says.
    pub(crate) fn answered(mutant: Option<Self>, answer: Answer) -> Answer {
        match answer {
            Answer::Finished { .. } if mutant == Some(Self::NoOutcome) => Answer::Rejected {
                reason: "it is over".to_owned(),
            },
            answer => answer,
        }
    }

    /// Whether a letter is not heeded.
    pub(crate) fn ignores(mutant: Option<Self>, letter: &Letter) -> bool {
        mutant == Some(Self::NoFence) && matches!(letter, Letter::StopAhead(_))
    }

    /// What a letter that comes again makes it do again.
    pub(crate) fn again<M: Role>(
        mutant: Option<Self>,
        node: &Node<M>,
        letter: &Letter,
    ) -> Option<Arrival<M::In>> {
        let Letter::Instruction(message) = letter else {
            return None;
        };
        if mutant != Some(Self::Afresh) || message.seq > heard(&node.disk_to_be(), Side::Arm).1 {
            return None;
        }
        Some(Arrival::Input(Input::Instruction {
            from: message.from.clone(),
            instruction: message.body.clone(),
        }))
    }
}

/// The epoch and the number of the last message that one has applied, as far as it is on its disk.
pub(crate) fn heard(disk: &Rows, by: Side) -> (u64, u64) {
    let key = match by {
        Side::Arm => "s/in/instruction/boss",
        Side::Boss => "s/in/report/arm",
    };
    let heard = read_row::<Heard<Answer>>(disk, key).ok().flatten();
    heard.map_or((0, 0), |heard| heard.last())
}
