//! A table, and the four forms in which it can be read.

use std::fmt::Write;

use comfy_table::{CellAlignment, Table as Printed, presets};
use serde_json::{Map, Value, json};

/// What stands in one place of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Words.
    Text(String),
    /// Something counted.
    Count(u64),
    /// Something measured, in the unit that the column's name ends with. Written with as many
    /// digits as say something.
    Measure(f64),
    /// Not measured here.
    Empty,
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<u64> for Cell {
    fn from(count: u64) -> Self {
        Self::Count(count)
    }
}

impl From<usize> for Cell {
    fn from(count: usize) -> Self {
        Self::Count(count as u64)
    }
}

impl From<f64> for Cell {
    fn from(measure: f64) -> Self {
        Self::Measure(measure)
    }
}

impl<C: Into<Cell>> From<Option<C>> for Cell {
    fn from(cell: Option<C>) -> Self {
        cell.map_or(Self::Empty, Into::into)
    }
}

impl Cell {
    /// In few characters: three digits that say something.
    fn text(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Count(count) => count.to_string(),
            Self::Measure(measure) => match measure.abs() {
                size if size >= 100.0 || size == 0.0 => format!("{measure:.0}"),
                size if size >= 10.0 => format!("{measure:.1}"),
                size if size >= 1.0 => format!("{measure:.2}"),
                size if size >= 0.1 => format!("{measure:.3}"),
                _ => format!("{measure:.4}"),
            },
            Self::Empty => String::new(),
        }
    }

    fn exact(&self) -> String {
        match self {
            Self::Measure(measure) => rounded(*measure).to_string(),
            other => other.text(),
        }
    }

    fn json(&self) -> Value {
        match self {
            Self::Text(text) => json!(text),
            Self::Count(count) => json!(count),
            Self::Measure(measure) => json!(rounded(*measure)),
            Self::Empty => Value::Null,
        }
    }
}

/// To a thousandth: no clock says more.
fn rounded(measure: f64) -> f64 {
    (measure * 1000.0).round() / 1000.0
}

/// A table with a name, under which it is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The name of its files, without their ending.
    pub name: String,
    /// What stands above it.
    pub title: String,
    /// The names of the columns, units last (`median_us`).
    pub columns: Vec<String>,
    /// The rows, each as long as `columns`.
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table without rows.
    pub fn new<'a>(name: &str, title: &str, columns: impl IntoIterator<Item = &'a str>) -> Self {
        Self {
            name: name.to_owned(),
            title: title.to_owned(),
            columns: columns.into_iter().map(ToOwned::to_owned).collect(),
            rows: Vec::new(),
        }
    }

    /// One row more.
    pub fn push(&mut self, row: impl IntoIterator<Item = Cell>) {
        let row: Vec<Cell> = row.into_iter().collect();
        debug_assert_eq!(row.len(), self.columns.len(), "{}", self.name);
        self.rows.push(row);
    }

    fn is_number(&self, column: usize) -> bool {
        self.rows
            .iter()
            .all(|row| !matches!(row.get(column), Some(Cell::Text(_))))
    }

    /// For a terminal, its title above.
    pub fn printed(&self) -> String {
        let mut table = Printed::new();
        table.load_style(presets::NOTHING).set_header(&self.columns);
        for row in &self.rows {
            table.add_row(row.iter().map(Cell::text));
        }
        for (at, column) in table.column_iter_mut().enumerate() {
            if self.is_number(at) {
                column.set_cell_alignment(CellAlignment::Right);
            }
        }
        format!("{}\n\n{table}\n", self.title)
    }

    /// For a document, its title above.
    pub fn markdown(&self) -> String {
        let mut text = format!("**{}**\n\n", self.title);
        let line = |cells: Vec<String>| format!("| {} |\n", cells.join(" | "));
        text += &line(self.columns.clone());
        let rule = |at| match self.is_number(at) {
            true => "---:".to_owned(),
            false => "---".to_owned(),
        };
        text += &line((0..self.columns.len()).map(rule).collect());
        for row in &self.rows {
            let cells = row.iter().map(|cell| cell.text().replace('|', "\\|"));
            text += &line(cells.collect());
        }
        text
    }

    /// For a program that reads tables: names in the first line, a line for each row.
    pub fn csv(&self) -> String {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let rows = self
            .rows
            .iter()
            .map(|row| row.iter().map(Cell::exact).collect());
        let lines = std::iter::once(self.columns.clone()).chain(rows);
        for line in lines {
            // Into memory, and lines that are all as long as the first.
            writer.write_record(&line).unwrap_or_default();
        }
        let bytes = writer.into_inner().unwrap_or_default();
        String::from_utf8(bytes).unwrap_or_default()
    }

    /// For a program: a list of objects.
    pub fn json(&self) -> Value {
        let object = |row: &Vec<Cell>| {
            let values = row.iter().map(Cell::json);
            let named = self.columns.iter().cloned().zip(values);
            Value::Object(named.collect::<Map<String, Value>>())
        };
        Value::Array(self.rows.iter().map(object).collect())
    }
}

/// Several, for a terminal.
pub(crate) fn printed(tables: &[Table]) -> String {
    let mut text = String::new();
    for table in tables {
        let _ = writeln!(text, "{}", table.printed());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let mut table = Table::new("small", "A small one", ["place", "median_us", "expanded"]);
        table.push(["n1, the entrance".into(), 12.34567.into(), 3_u64.into()]);
        table.push(["n|2".into(), Cell::Empty, 0_u64.into()]);
        table
    }

    #[test]
    fn csv_names_its_columns_and_keeps_commas() {
        let csv = table().csv();
        assert_eq!(
            csv,
            "place,median_us,expanded\n\"n1, the entrance\",12.346,3\nn|2,,0\n"
        );
    }

    #[test]
    fn markdown_says_what_is_a_number_and_keeps_bars() {
        let text = table().markdown();
        assert!(text.contains("| --- | ---: | ---: |\n"), "{text}");
        assert!(text.contains("| n\\|2 |  | 0 |\n"), "{text}");
    }

    #[test]
    fn json_knows_numbers_from_what_was_not_measured() {
        let json = table().json();
        assert_eq!(json[0]["median_us"], 12.346);
        assert_eq!(json[1]["median_us"], Value::Null);
    }

    #[test]
    fn measures_are_printed_with_three_digits_that_say_something() {
        let text = |measure: f64| Cell::from(measure).text();
        assert_eq!(text(0.012_34), "0.0123");
        assert_eq!(text(1234.5), "1234");
        assert_eq!(text(12.34), "12.3");
        assert_eq!(text(0.0), "0");
    }
}
