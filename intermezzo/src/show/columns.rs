//! Several timelines side by side.

use std::fmt::Write;

use anstyle::Style;

use super::people::words;
use crate::style::{BOLD, DIM};

/// Before the first column: the time.
const MARGIN: usize = 10;
/// Narrower than this, a column says nothing.
const NARROWEST: usize = 18;

/// One column for each of some names, the same width each.
#[derive(Debug)]
pub(super) struct Columns {
    names: Vec<String>,
    width: usize,
}

impl Columns {
    /// Columns that fill a terminal of that width, as far as it is wide enough.
    pub(super) fn new(names: Vec<String>, width: usize) -> Self {
        let each = width.saturating_sub(MARGIN) / names.len().max(1);
        Self {
            width: each.max(NARROWEST),
            names,
        }
    }

    /// The names above their columns.
    pub(super) fn heading(&self) -> String {
        let mut heading = " ".repeat(MARGIN);
        for (column, name) in self.names.iter().enumerate() {
            let is_last = column + 1 == self.names.len();
            let rest = if is_last {
                0
            } else {
                self.width.saturating_sub(2)
            };
            let _ = write!(heading, "{DIM}│{DIM:#} {BOLD}{name:<rest$}{BOLD:#}");
        }
        heading
    }

    /// Words in the column of that name, and the bars of all others. `None` if there is no such column.
    ///
    /// `bar` is what stands at the left of each column.
    pub(super) fn line(
        &self,
        at_s: f64,
        name: &str,
        (sign, style): (char, Style),
        text: &str,
        bar: impl Fn(&str) -> (char, Style),
    ) -> Option<String> {
        let own = self.names.iter().position(|known| known == name)?;
        let is_last = own + 1 == self.names.len();
        // A bar, a blank, the sign, a blank, and one between the columns.
        let room = self.width.saturating_sub(5);
        let mut lines = String::new();
        for (index, row) in narrow(text, room).into_iter().enumerate() {
            if index == 0 {
                let _ = write!(lines, "{at_s:>7.1} s ");
            } else {
                let _ = write!(lines, "\n{:MARGIN$}", "");
            }
            for (column, other) in self.names.iter().enumerate() {
                let (bar, bar_style) = bar(other);
                let _ = write!(lines, "{bar_style}{bar}{bar_style:#}");
                if column == own || column + 1 < self.names.len() {
                    lines.push(' ');
                }
                if column == own {
                    let sign = if index == 0 { sign } else { ' ' };
                    let row = if is_last {
                        row.clone()
                    } else {
                        format!("{row:<room$} ")
                    };
                    let _ = write!(lines, "{style}{sign} {row}{style:#}");
                } else if column + 1 < self.names.len() {
                    let _ = write!(lines, "{:1$}", "", self.width.saturating_sub(2));
                }
            }
        }
        Some(lines)
    }

    /// Words across all columns.
    pub(super) fn across(&self, at_s: f64, (sign, style): (char, Style), text: &str) -> String {
        let mut lines = String::new();
        for (index, row) in narrow(text, self.room_across()).into_iter().enumerate() {
            if index == 0 {
                let _ = write!(lines, "{at_s:>7.1} s {style}{sign} {row}{style:#}");
            } else {
                let _ = write!(lines, "\n{:MARGIN$}{style}  {row}{style:#}", "");
            }
        }
        lines
    }

    /// More words across all columns, below others.
    pub(super) fn below(&self, style: Style, text: &str) -> String {
        let rows = narrow(text, self.room_across()).into_iter();
        let rows = rows.map(|row| format!("{:MARGIN$}{style}  {row}{style:#}", ""));
        rows.collect::<Vec<_>>().join("\n")
    }

    /// For words across, after a sign and a blank.
    fn room_across(&self) -> usize {
        (self.names.len() * self.width).saturating_sub(2)
    }
}

/// Text in rows. An expression that is wider than a row is broken between its words, and a word that is,
/// after a hyphen.
fn narrow(text: &str, room: usize) -> Vec<String> {
    let fits = |text: &str| text.chars().count() <= room;
    let mut narrow = Vec::new();
    let mut row = String::new();
    for expression in words(text) {
        let is_wide = !fits(expression);
        for (index, word) in expression.split(' ').enumerate() {
            // One that has to be broken begins a row, and goes on a little to the right.
            let (word, begins) = match is_wide {
                true => (word, index == 0),
                false if index == 0 => (expression, false),
                false => break,
            };
            let longer = format!("{row} {word}");
            if row.is_empty() {
                row.push_str(word);
            } else if !begins && fits(&longer) {
                row = longer;
            } else {
                let indent = if is_wide && index > 0 { " " } else { "" };
                narrow.push(std::mem::replace(&mut row, format!("{indent}{word}")));
            }
            while let Some(rest) = overhang(&mut row, room) {
                narrow.push(std::mem::replace(&mut row, format!(" {rest}")));
            }
        }
    }
    narrow.push(row);
    narrow
}

/// Takes from a row what does not fit, from the last hyphen that does on. `None` if all of it fits, or it
/// cannot be broken.
fn overhang(row: &mut String, room: usize) -> Option<String> {
    let (end, _) = row.char_indices().nth(room)?;
    let hyphen = row.get(..end)?.rfind('-')?;
    Some(row.split_off(hyphen + 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plain(text: &str) -> String {
        anstream::adapter::strip_str(text).to_string()
    }

    fn columns() -> Columns {
        Columns::new(["k1", "k2", "k3"].map(str::to_owned).to_vec(), 82)
    }

    #[test]
    fn each_vehicle_speaks_in_its_own_column() {
        let bar = |_: &str| ('│', DIM);
        for (name, column) in [("k1", 0), ("k2", 1), ("k3", 2)] {
            let line = columns().line(3.25, name, ('·', DIM), "(grasp cola1)", bar);
            let shown = plain(&line.expect("there is such a column"));
            assert!(shown.starts_with("    3.2 s │"), "{shown}");
            let place = shown.chars().position(|c| c == '·');
            assert_eq!(place, Some(MARGIN + column * 24 + 2), "{shown}");
        }
    }

    #[test]
    fn long_words_go_on_below_and_stay_in_their_column() {
        let bar = |_: &str| ('│', DIM);
        let text = "takes up the order of ann again, continued: the suspended plan still holds";
        let line = columns().line(0.0, "k2", ('↩', DIM), text, bar);
        let shown = plain(&line.expect("there is such a column"));
        assert!(shown.lines().count() > 2, "{shown}");
        for row in shown.lines() {
            let bars: Vec<usize> = (row.chars().enumerate())
                .filter(|(_, c)| *c == '│')
                .map(|(place, _)| place)
                .collect();
            assert_eq!(bars, [MARGIN, MARGIN + 24, MARGIN + 48], "{shown}");
        }
    }

    #[test]
    fn an_expression_that_is_too_wide_is_broken() {
        assert_eq!(
            narrow("then (move table2 table1 table1-table2)", 24),
            ["then", "(move table2 table1", " table1-table2)"]
        );
    }

    #[test]
    fn what_follows_a_broken_expression_follows_it_at_once() {
        assert_eq!(
            narrow("since (move table2 table1 table1-table2) needs it", 24),
            ["since", "(move table2 table1", " table1-table2) needs it"]
        );
        assert_eq!(narrow("", 24), [""]);
    }

    #[test]
    fn a_word_that_is_too_wide_is_broken_after_a_hyphen() {
        assert_eq!(
            narrow("(resume-take-from-tray cola1)", 18),
            ["(resume-take-from-", " tray cola1)"]
        );
        assert_eq!(
            narrow("(resume-take-from-tray)", 10),
            ["(resume-", " take-", " from-", " tray)"]
        );
        // Rather too wide than broken anywhere.
        assert_eq!(narrow("unbreakable", 5), ["unbreakable"]);
    }

    #[test]
    fn nothing_is_wider_than_a_terminal_of_eighty_columns() {
        let columns = Columns::new(["k1", "k2", "k3"].map(str::to_owned).to_vec(), 80);
        let bar = |_: &str| ('│', DIM);
        let text = "takes up (serve cola ann) again, repaired: (at table1) does not hold, which (resume-take-from-tray cola1 slot1 table1) needs";
        let said = columns.line(341.8, "k3", ('↩', DIM), text, bar);
        let said = said.expect("there is such a column");
        let across = columns.across(1.0, ('»', BOLD), text);
        let below = columns.below(DIM, text);
        for shown in [columns.heading(), said, across, below] {
            for row in plain(&shown).lines() {
                assert!(row.chars().count() <= 80, "{row}");
            }
        }
    }

    #[test]
    fn no_line_ends_in_blanks() {
        let bar = |_: &str| ('│', DIM);
        let mut shown = vec![
            columns().heading(),
            columns().across(0.0, ('»', BOLD), "words"),
        ];
        shown.extend(
            ["k1", "k3"]
                .iter()
                .filter_map(|name| columns().line(0.0, name, ('·', DIM), "(grasp cola1)", bar)),
        );
        for shown in shown {
            let shown = plain(&shown);
            assert_eq!(shown, shown.trim_end(), "{shown:?}");
        }
    }

    #[test]
    fn whoever_has_no_column_says_nothing() {
        let said = columns().line(0.0, "room", ('·', DIM), "words", |_| ('│', DIM));
        assert_eq!(said, None);
    }
}
