//! The place that a command names.

use std::path::{Path, PathBuf};

use maps::{Finding, Place};

use crate::exit::Failure;

/// The name that means the place that is built in.
const MUSEUM: &str = "museum";

/// The place that was typed: its folder, if it is not built in, and what is in it.
///
/// # Errors
/// Everything that is wrong with it.
pub(crate) fn read(typed: &Path) -> Result<(Option<PathBuf>, Place), Failure> {
    if typed == Path::new(MUSEUM) && !typed.is_dir() {
        return Ok((None, Place::museum()));
    }
    let place = Place::read(typed).map_err(|findings| {
        let advice = if typed.is_dir() {
            "see maps/README.md for what belongs in a place"
        } else {
            "name a folder such as maps/museum, or `museum`, which is built in"
        };
        Failure::bad_input(format_args!(
            "the place {} is not in order:\n{}",
            typed.display(),
            lines(&findings)
        ))
        .advice(advice)
    })?;
    Ok((Some(typed.to_owned()), place))
}

/// A finding a line.
pub(crate) fn lines(findings: &[Finding]) -> String {
    let lines: Vec<String> = findings.iter().map(ToString::to_string).collect();
    lines.join("\n")
}
