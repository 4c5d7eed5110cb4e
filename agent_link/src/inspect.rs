//! Looking inside a machine while it runs.

use serde_json::{Value, json};

/// What a machine shows of itself. What it has nothing to say about is empty.
pub trait Inspect {
    /// What it is doing.
    fn status(&self) -> Value {
        json!({})
    }

    /// What it holds to be true.
    fn belief(&self) -> Value {
        json!({})
    }

    /// The plan it follows and those it keeps.
    fn plans(&self) -> Value {
        json!({})
    }

    /// The goals it has set aside.
    fn stack(&self) -> Value {
        json!({})
    }

    /// What it could do instead for each of its goals, with what that hangs on, and why it does what
    /// it does. Takes some planning to tell.
    fn alternatives(&self) -> Value {
        json!([])
    }

    /// All goals that it knows of, with how they stand: those that wait, those that are being seen
    /// to, and the latest that have ended.
    fn goals(&self) -> Value {
        json!([])
    }

    /// What is published at regular intervals, if the wiring asks for it: where everything is.
    fn snapshot(&self) -> Value {
        self.status()
    }

    /// Whether something has happened since this was asked last that a snapshot should show at
    /// once. Asked only where snapshots are published.
    fn is_worth_showing(&self) -> bool {
        false
    }
}

/// One of the ways to look inside.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum View {
    /// [`Inspect::status`].
    Status,
    /// [`Inspect::belief`].
    Belief,
    /// [`Inspect::plans`].
    Plans,
    /// [`Inspect::stack`].
    Stack,
    /// [`Inspect::alternatives`].
    Alternatives,
    /// [`Inspect::goals`]; if the question names one, only that.
    Goals,
    /// Where and how well what it knows is written down; nothing without a journal.
    Journal,
}

impl View {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Status,
        Self::Belief,
        Self::Plans,
        Self::Stack,
        Self::Alternatives,
        Self::Goals,
        Self::Journal,
    ];

    /// As it stands in the key.
    pub fn name(self) -> &'static str {
        match self {
            Self::Status => "status",
            Self::Belief => "belief",
            Self::Plans => "plans",
            Self::Stack => "stack",
            Self::Alternatives => "alternatives",
            Self::Goals => "goals",
            Self::Journal => "journal",
        }
    }

    /// What `machine` shows.
    pub fn of(self, machine: &impl Inspect) -> Value {
        match self {
            Self::Status => machine.status(),
            Self::Belief => machine.belief(),
            Self::Plans => machine.plans(),
            Self::Stack => machine.stack(),
            Self::Alternatives => machine.alternatives(),
            Self::Goals => machine.goals(),
            // No machine knows of its journal.
            Self::Journal => json!({}),
        }
    }
}
