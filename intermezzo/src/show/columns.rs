//! Several timelines side by side.

use std::fmt::Write;

use anstyle::Style;

use super::people::rows;
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
        for name in &self.names {
            let rest = self.width.saturating_sub(2);
            let _ = write!(heading, "{DIM}│{DIM:#} {BOLD}{name:<rest$}{BOLD:#}");
        }
        heading.trim_end().to_owned()
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
                let _ = write!(lines, "{bar_style}{bar}{bar_style:#} ");
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
        let room = self.names.len() * self.width;
        let mut lines = String::new();
        for (index, row) in rows(text, room.saturating_sub(2)).into_iter().enumerate() {
            if index == 0 {
                let _ = write!(lines, "{at_s:>7.1} s {style}{sign} {row}{style:#}");
            } else {
                let _ = write!(lines, "\n{:MARGIN$}{style}  {row}{style:#}", "");
            }
        }
        lines
    }
}

/// Text in rows. An expression that is wider than a row is broken, too.
fn narrow(text: &str, room: usize) -> Vec<String> {
    let mut narrow: Vec<String> = Vec::new();
    for row in rows(text, room) {
        if row.chars().count() <= room {
            narrow.push(row);
            continue;
        }
        let mut last = String::new();
        for word in row.split(' ') {
            if !last.is_empty() && last.chars().count() + 1 + word.chars().count() > room {
                narrow.push(std::mem::take(&mut last));
                last.push(' ');
            } else if !last.is_empty() {
                last.push(' ');
            }
            last.push_str(word);
        }
        narrow.push(last);
    }
    narrow
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
    fn whoever_has_no_column_says_nothing() {
        let said = columns().line(0.0, "room", ('·', DIM), "words", |_| ('│', DIM));
        assert_eq!(said, None);
    }
}
