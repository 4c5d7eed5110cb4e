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
pub(super) struct Faults(Vec<(usize, String)>);

impl Faults {
    /// Notes a fault at a byte of the text.
    pub(super) fn add(&mut self, offset: usize, message: impl Into<String>) {
        self.0.push((offset, message.into()));
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The faults in the order of the text.
    pub(super) fn into_errors(mut self, text: &str) -> Vec<LanguageError> {
        self.0.sort();
        self.0.dedup();
        self.0
            .into_iter()
            .map(|(offset, message)| LanguageError::at(text, offset, message))
            .collect()
    }
}
