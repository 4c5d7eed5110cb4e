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

    /// What is published at regular intervals, if the wiring asks for it: where everything is.
    fn snapshot(&self) -> Value {
        self.status()
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
}

impl View {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Status,
        Self::Belief,
        Self::Plans,
        Self::Stack,
        Self::Alternatives,
    ];

    /// As it stands in the key.
    pub fn name(self) -> &'static str {
        match self {
            Self::Status => "status",
            Self::Belief => "belief",
            Self::Plans => "plans",
            Self::Stack => "stack",
            Self::Alternatives => "alternatives",
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
        }
    }
}
