//! Gathering all that is wrong, so that a map is mended in one go.

use std::fmt;

use crate::Finding;

/// The findings about one file so far.
pub(crate) struct Faults {
    file: String,
    found: Vec<(usize, String)>,
}

impl Faults {
    pub(crate) fn of(file: &str) -> Self {
        Self {
            file: file.to_owned(),
            found: Vec::new(),
        }
    }

    /// Something is wrong in this line; in none, if it is 0.
    pub(crate) fn add(&mut self, line: usize, message: impl Into<String>) {
        self.found.push((line, message.into()));
    }

    /// Something is wrong with this feature.
    pub(super) fn about(&mut self, origin: &Origin, message: impl fmt::Display) {
        self.add(origin.line, format!("{origin} {message}"));
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.found.is_empty()
    }

    /// From the top of the file to its end.
    pub(crate) fn into_findings(mut self) -> Vec<Finding> {
        self.found.sort_by_key(|(line, _)| *line);
        self.found
            .into_iter()
            .map(|(line, message)| Finding {
                file: self.file.clone(),
                place: if line == 0 {
                    String::new()
                } else {
                    line.to_string()
                },
                message,
                excerpt: String::new(),
            })
            .collect()
    }
}

/// Where a feature stands, and what to call it.
#[derive(Clone, Debug)]
pub(super) struct Origin {
    pub(super) line: usize,
    /// Counted from 1, as lines are.
    pub(super) number: usize,
    /// `node 5 n5`, `edge 1005 arc5`; empty as long as that is not known.
    pub(super) called: String,
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.called.is_empty() {
            write!(f, "feature {}", self.number)
        } else {
            write!(f, "{} (feature {})", self.called, self.number)
        }
    }
}
