//! What is wrong with a text, and where.

/// A fault in a text, in the words of whoever wrote it.
#[derive(Clone, Debug, Eq, Ord, PartialEq, PartialOrd, thiserror::Error)]
#[error("{line}:{column}: {message}")]
pub struct LanguageError {
    /// Counted from 1.
    pub line: usize,
    /// In characters, counted from 1.
    pub column: usize,
    /// What is wrong, and what to do.
    pub message: String,
}

impl LanguageError {
    /// A fault at a byte of `text`.
    pub(super) fn at(text: &str, offset: usize, message: String) -> Self {
        let before = text.get(..offset).unwrap_or(text);
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        Self {
            line: before.matches('\n').count() + 1,
            column: before[line_start..].chars().count() + 1,
            message,
        }
    }
}

/// The faults found so far; reading goes on after one, so that all are reported at once.
#[derive(Debug, Default)]
pub(super) struct Faults {
    faults: Vec<(usize, String)>,
    slips: Vec<(usize, String)>,
}

impl Faults {
    /// Notes a fault at a byte of the text.
    pub(super) fn add(&mut self, offset: usize, message: impl Into<String>) {
        self.faults.push((offset, message.into()));
    }

    /// Notes what has a meaning, but is probably not what was meant: a fault only for those who
    /// read strictly.
    pub(super) fn slip(&mut self, offset: usize, message: impl Into<String>) {
        self.slips.push((offset, message.into()));
    }

    /// Makes faults of all slips.
    pub(super) fn be_strict(&mut self) {
        self.faults.append(&mut self.slips);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.faults.is_empty()
    }

    /// The faults in the order of the text.
    pub(super) fn into_errors(mut self, text: &str) -> Vec<LanguageError> {
        self.faults.sort();
        self.faults.dedup();
        self.faults
            .into_iter()
            .map(|(offset, message)| LanguageError::at(text, offset, message))
            .collect()
    }
}
