//! A fault as it is shown to whoever wrote the text: with the line, and a marker under the place.

use super::error::LanguageError;

/// As much of a line as fits beside another window.
const WIDTH: usize = 100;

/// More faults than this are counted, not shown.
const SHOWN: usize = 20;

/// The faults of a file for its author, each with its line of the text and a marker under the
/// place, in the order of the text.
pub fn report(file: &str, text: &str, errors: &[LanguageError]) -> String {
    let mut sorted: Vec<&LanguageError> = errors.iter().collect();
    sorted.sort();
    let mut shown: Vec<String> = sorted
        .iter()
        .take(SHOWN)
        .map(|error| {
            let excerpt = excerpt(text, error.line, error.column);
            let excerpt = excerpt.map(|excerpt| format!("\n{excerpt}"));
            format!("{file}:{error}{}", excerpt.unwrap_or_default())
        })
        .collect();
    if errors.len() > SHOWN {
        shown.push(format!("{file}: and {} faults more", errors.len() - SHOWN));
    }
    shown.join("\n")
}

/// The line of the text, and below it a marker under the word at `column`; both are indented.
///
/// Line and column are counted from 1. `None` if the text has no such line. Of a long line what
/// stands around the place is shown; tabs and other control characters become blanks.
pub fn excerpt(text: &str, line: usize, column: usize) -> Option<String> {
    let line = text.lines().nth(line.checked_sub(1)?)?;
    let at = column.checked_sub(1)?;
    // What comes before and after is cut so that the place stays in sight.
    let cut = at.saturating_sub(WIDTH * 2 / 3);
    let from = if line.chars().nth(WIDTH).is_some() {
        cut
    } else {
        0
    };
    let mut source = String::from(if from > 0 { "… " } else { "" });
    let mut before = source.chars().count();
    let mut word = 0;
    let mut in_word = true;
    let mut rest = line.chars().enumerate().skip(from);
    for (index, letter) in rest.by_ref().take(WIDTH) {
        let blank = letter.is_control() || letter.is_whitespace();
        source.push(if blank { ' ' } else { letter });
        if index < at {
            before += 1;
        } else {
            // A parenthesis is marked alone; a word ends before the next one.
            let ends = blank || matches!(letter, '(' | ')' | ';');
            in_word &= word == 0 || !ends;
            word += usize::from(in_word);
            in_word &= !ends;
        }
    }
    if rest.next().is_some() {
        source.push_str(" …");
    }
    let source = source.trim_end();
    let marker = "^".repeat(word.max(1));
    let blanks = " ".repeat(before);
    Some(format!("  | {source}\n  | {blanks}{marker}"))
}
