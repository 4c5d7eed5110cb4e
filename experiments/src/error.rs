//! Why something could not be measured.

/// An experiment has come to no end, or could not begin.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
pub enum ExperimentError {
    /// A map, a robot or an agent cannot be made of what was given.
    #[error("cannot set up the experiment: {0}")]
    Setup(String),
    /// An agent or a robot did something else than the experiment is about.
    #[error("{situation}: {why}")]
    Course {
        /// Which row, as it is printed.
        situation: String,
        /// What happened, or did not.
        why: String,
    },
}

impl ExperimentError {
    pub(crate) fn setup(why: impl ToString) -> Self {
        Self::Setup(why.to_string())
    }

    pub(crate) fn findings(findings: Vec<maps::Finding>) -> Self {
        let findings: Vec<String> = findings.iter().map(ToString::to_string).collect();
        Self::Setup(findings.join("\n"))
    }

    pub(crate) fn course(situation: impl ToString, why: impl ToString) -> Self {
        Self::Course {
            situation: situation.to_string(),
            why: why.to_string(),
        }
    }
}
