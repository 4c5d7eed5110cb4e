//! Names as the domains can have them, each once.

use std::collections::BTreeSet;

/// The names that are taken, whatever by.
#[derive(Default)]
pub(super) struct Names(BTreeSet<String>);

impl Names {
    /// The name that is like `wanted`: in lower case, without what HDDL has no room for, and with a
    /// number behind it if it is taken.
    pub(super) fn claim(&mut self, wanted: &str, letter: char) -> String {
        let like = folded(wanted, letter);
        let mut name = like.clone();
        let mut number = 2;
        while !self.0.insert(name.clone()) {
            name = format!("{like}_{number}");
            number += 1;
        }
        name
    }
}

/// A letter, then letters, digits, `-` and `_`.
pub(super) fn folded(wanted: &str, letter: char) -> String {
    let kept = |letter: char| letter.is_ascii_alphanumeric() || "-_".contains(letter);
    let name: String = wanted
        .trim()
        .chars()
        .map(|letter| {
            if kept(letter) {
                letter.to_ascii_lowercase()
            } else {
                '_'
            }
        })
        .collect();
    if name.starts_with(|first: char| first.is_ascii_lowercase()) {
        name
    } else {
        format!("{letter}{name}")
    }
}

/// What names of one group have in common: all up to the last separator, or up to the number at the
/// end. The name itself if it has neither.
pub(super) fn prefix(name: &str) -> &str {
    let unnumbered = name.trim_end_matches(|last: char| last.is_ascii_digit());
    let cut = match name.rfind(['_', '-', '.', ' ']) {
        Some(at) if at > 0 => &name[..at],
        _ => unnumbered,
    };
    if cut.is_empty() { name } else { cut }
}
