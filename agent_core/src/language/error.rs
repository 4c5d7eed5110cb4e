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

/// More faults than anyone reads at once. What is read after so many is not looked at.
const ENOUGH: usize = 1000;

/// How many parts of conditions may be copied into effects: a long condition in front of many
/// facts is a condition of each of them.
const COPIES: usize = 1_000_000;

/// The faults found so far; reading goes on after one, so that all are reported at once.
#[derive(Debug, Default)]
pub(super) struct Faults {
    faults: Vec<(usize, String)>,
    slips: Vec<(usize, String)>,
    copied: usize,
}

impl Faults {
    /// Notes a fault at a byte of the text.
    pub(super) fn add(&mut self, offset: usize, message: impl Into<String>) {
        self.faults.push((offset, printable(message.into())));
    }

    /// Notes what has a meaning, but is probably not what was meant: a fault only for those who
    /// read strictly.
    pub(super) fn slip(&mut self, offset: usize, message: impl Into<String>) {
        if self.slips.len() < ENOUGH {
            self.slips.push((offset, printable(message.into())));
        }
    }

    /// Makes faults of all slips.
    pub(super) fn be_strict(&mut self) {
        self.faults.append(&mut self.slips);
    }

    pub(super) fn is_empty(&self) -> bool {
        self.faults.is_empty()
    }

    /// Whether so much is wrong that it is not worth while to look for more.
    pub(super) fn is_enough(&self) -> bool {
        self.faults.len() >= ENOUGH
    }

    /// Counts copies of parts of the text. Whether there have been so many that memory is in
    /// danger, which is a fault.
    pub(super) fn copies_too_much(&mut self, offset: usize, parts: usize) -> bool {
        let before = self.copied;
        self.copied = before.saturating_add(parts);
        if before <= COPIES && self.copied > COPIES {
            self.add(
                offset,
                "too many effects share too long conditions and variables; write them shorter",
            );
        }
        self.copied > COPIES
    }

    /// The faults in the order of the text.
    pub(super) fn into_errors(mut self, text: &str) -> Vec<LanguageError> {
        self.faults.sort();
        self.faults.dedup();
        let mut place = Place { line: 1, start: 0 };
        self.faults
            .into_iter()
            .map(|(offset, message)| {
                let column = place.go_on(text, offset);
                LanguageError {
                    line: place.line,
                    column,
                    message,
                }
            })
            .collect()
    }
}

/// A message quotes the text, which may have been made to confuse a terminal.
fn printable(message: String) -> String {
    if message.contains(char::is_control) {
        message.replace(char::is_control, "\u{fffd}")
    } else {
        message
    }
}

/// A line of a text.
struct Place {
    /// Counted from 1.
    line: usize,
    /// The byte at which it begins.
    start: usize,
}

impl Place {
    /// Goes on to the line of a later byte and says in which column that is.
    fn go_on(&mut self, text: &str, offset: usize) -> usize {
        let passed = text.get(self.start..offset).unwrap_or_default();
        if let Some(last) = passed.rfind('\n') {
            self.line += passed.matches('\n').count();
            self.start += last + 1;
        }
        let before = text.get(self.start..offset).unwrap_or_default();
        before.chars().count() + 1
    }
}
