//! What an experiment has found, and how it is written.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use crate::{Chart, Table, machine, table};

/// What an experiment has found.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// The experiment's name, and that of its JSON and Markdown files.
    pub name: String,
    /// What was measured, how often, and how.
    pub method: String,
    /// The tables, the most important first.
    pub tables: Vec<Table>,
    /// The pictures.
    pub charts: Vec<Chart>,
    /// What must be known to read the numbers rightly.
    pub remarks: Vec<String>,
}

/// A file of a report could not be written.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {}: {why}", file.display())]
pub struct WriteError {
    /// Which file.
    pub file: PathBuf,
    /// Why.
    pub why: io::Error,
}

impl Report {
    /// Of an experiment of that name; `method` says what was measured and how.
    pub fn new(name: &str, method: impl Into<String>) -> Self {
        Self {
            name: name.to_owned(),
            method: method.into(),
            tables: Vec::new(),
            charts: Vec::new(),
            remarks: Vec::new(),
        }
    }

    /// For a terminal.
    pub fn printed(&self) -> String {
        let mut text = format!("{}\n\n{}", self.method, table::printed(&self.tables));
        for remark in &self.remarks {
            text += &format!("{remark}\n");
        }
        text
    }

    /// For a program: method, machine, remarks, and each table under its name.
    pub fn json(&self) -> Value {
        let tables = self
            .tables
            .iter()
            .map(|table| (table.name.clone(), table.json()));
        json!({
            "experiment": self.name,
            "method": self.method,
            "machine": machine(),
            "remarks": self.remarks,
            "tables": Value::Object(tables.collect()),
        })
    }

    /// For a document: pictures are named as [`write`](Self::write) names them.
    pub fn markdown(&self) -> String {
        let mut text = format!("# {}\n\n{}\n\n", self.name, self.method);
        let machine: Vec<_> = machine()
            .iter()
            .map(|(what, value)| format!("{what}: {value}"))
            .collect();
        text += &format!("Measured on: {}.\n\n", machine.join("; "));
        for table in &self.tables {
            text += &format!("{}\n", table.markdown());
        }
        for chart in &self.charts {
            text += &format!("![{}]({}.svg)\n\n", chart.title, chart.name);
        }
        for remark in &self.remarks {
            text += &format!("- {remark}\n");
        }
        text
    }

    /// Writes everything to a folder, which is made if it is not there: each table as CSV, all as JSON and
    /// Markdown, each chart as SVG. Returns the files.
    ///
    /// # Errors
    /// If one cannot be written; those before it are.
    pub fn write(&self, folder: &Path) -> Result<Vec<PathBuf>, WriteError> {
        let mut files = Vec::new();
        let mut write = |name: String, text: String| {
            let file = folder.join(name);
            let written = fs::create_dir_all(folder).and_then(|()| fs::write(&file, text));
            written.map_err(|why| WriteError {
                file: file.clone(),
                why,
            })?;
            files.push(file);
            Ok(())
        };
        for table in &self.tables {
            write(format!("{}.csv", table.name), table.csv())?;
        }
        write(
            format!("{}.json", self.name),
            format!("{:#}\n", self.json()),
        )?;
        write(format!("{}.md", self.name), self.markdown())?;
        for chart in &self.charts {
            let name = format!("{}.svg", chart.name);
            let svg = chart.svg().map_err(|why| WriteError {
                file: folder.join(&name),
                why: io::Error::other(why),
            })?;
            write(name, svg)?;
        }
        Ok(files)
    }
}
