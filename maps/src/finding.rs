//! What is wrong with a file, and where.

use std::fmt;

/// Something wrong in a map, a domain or an execution model, in the words of its author.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Finding {
    /// The file, as the user named it.
    pub file: String,
    /// The line, or the line and the column. Empty if it concerns the file as a whole.
    pub place: String,
    /// What is wrong.
    pub message: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:", self.file)?;
        if !self.place.is_empty() {
            write!(f, "{}:", self.place)?;
        }
        write!(f, " {}", self.message)
    }
}
