//! The place that a command names.

use std::path::{Path, PathBuf};

use maps::{Finding, Place, Restaurant};

use crate::exit::Failure;

/// The name that means the place that is built in.
const MUSEUM: &str = "museum";
/// The same of a restaurant.
const RESTAURANT: &str = "restaurant";
/// A folder with this is a restaurant.
const ROOM: &str = "room.toml";

/// The place that was typed: its folder, if it is not built in, and what is in it.
///
/// # Errors
/// Everything that is wrong with it.
pub(crate) fn read(typed: &Path) -> Result<(Option<PathBuf>, Place), Failure> {
    if typed == Path::new(MUSEUM) && !typed.is_dir() {
        return Ok((None, Place::museum()));
    }
    if !typed.exists() {
        let what = format!("there is no folder {}", typed.display());
        return Err(Failure::bad_input(what).advice(
            "name a folder such as maps/museum, or what is built in: `museum` or `restaurant`",
        ));
    }
    let place = Place::read(typed).map_err(|findings| {
        let advice = if typed.is_dir() {
            "see maps/README.md for what belongs in a place; a folder with a room.toml is a restaurant"
        } else {
            "name a folder such as maps/museum, or what is built in: `museum` or `restaurant`"
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

/// The restaurant that was typed: its folder, if it is not built in, and what is in it. `None` if it is
/// the place of a single robot.
///
/// # Errors
/// Everything that is wrong with it.
pub(crate) fn read_restaurant(
    typed: &Path,
) -> Result<Option<(Option<PathBuf>, Restaurant)>, Failure> {
    if typed == Path::new(RESTAURANT) && !typed.is_dir() {
        return Ok(Some((None, Restaurant::of_the_paper())));
    }
    if !typed.join(ROOM).is_file() {
        return Ok(None);
    }
    let restaurant = Restaurant::read(typed).map_err(|findings| {
        Failure::bad_input(format_args!(
            "the restaurant {} is not in order:\n{}",
            typed.display(),
            lines(&findings)
        ))
        .advice("see maps/restaurant/README.md for what belongs in it")
    })?;
    Ok(Some((Some(typed.to_owned()), restaurant)))
}

/// A finding a line.
pub(crate) fn lines(findings: &[Finding]) -> String {
    let lines: Vec<String> = findings.iter().map(ToString::to_string).collect();
    lines.join("\n")
}
