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
    /// The line of the text and a marker under the place, to be shown below. Empty if there is
    /// none.
    pub excerpt: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:", self.file)?;
        if !self.place.is_empty() {
            write!(f, "{}:", self.place)?;
        }
        write!(f, " {}", self.message)?;
        if !self.excerpt.is_empty() {
            write!(f, "\n{}", self.excerpt)?;
        }
        Ok(())
    }
}
