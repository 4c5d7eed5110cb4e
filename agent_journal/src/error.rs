//! Why a journal is not opened, or not written.

use std::io;

/// Why a journal is not opened. It has been left as it is.
#[derive(Debug, thiserror::Error)]
pub enum JournalError {
    /// By a process that lives.
    #[error(
        "the journal {place} is in use by another process; only one may write it: end that one, or choose another directory with --state"
    )]
    InUse {
        /// Which.
        place: String,
    },
    /// Something else than a journal, or one without a beginning.
    #[error("{place} is not a journal of Intermezzo ({why}); {MOVE_AWAY}")]
    Foreign {
        /// Which.
        place: String,
        /// What is wrong with it.
        why: String,
    },
    /// Cut short, or not what was written.
    #[error("the journal {place} is damaged ({why}); {MOVE_AWAY}")]
    Damaged {
        /// Which.
        place: String,
        /// What is wrong with it.
        why: String,
    },
    /// Of a later release.
    #[error(
        "the journal {place} was written by a newer release ({found}; this one reads {known}): start that release, or {MOVE_AWAY}"
    )]
    Newer {
        /// Which.
        place: String,
        /// What it says of itself.
        found: String,
        /// What is understood here.
        known: String,
    },
    /// Of somebody else, or of a life elsewhere.
    #[error(
        "the journal {place} is that of {what} `{found}`, not `{wanted}`: choose another directory with --state, or {MOVE_AWAY}"
    )]
    OfAnother {
        /// Which.
        place: String,
        /// Whether it is the robot, the role, or the map with its domains that is another.
        what: &'static str,
        /// What the journal says.
        found: String,
        /// What it should say.
        wanted: String,
    },
    /// The file system.
    #[error("the journal {place} cannot be opened: {why}")]
    Io {
        /// Which.
        place: String,
        /// In the system's words.
        why: io::Error,
    },
}

const MOVE_AWAY: &str = "move it away to begin with an empty memory";

/// Why something was not written down. Nothing is known of what has reached the disk; the next
/// attempt writes all of it anew.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
#[error("the journal {place} cannot be written: {why}")]
pub struct CommitError {
    /// Which.
    pub place: String,
    /// In words.
    pub why: String,
}
