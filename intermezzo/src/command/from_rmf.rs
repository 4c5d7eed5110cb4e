//! `map from-rmf`: a map of a navigation graph of Open-RMF.

use maps::{FromRmf, Place, RmfOptions};
use serde_json::json;

use super::files::{is_folder, print, write_map};
use crate::cli::{AreasBy, FromRmfArgs};
use crate::exit::{Exit, Failure};
use crate::style::{ADVICE, ASIDE, GOOD};

/// Writes the map, or the whole place.
pub(crate) fn run(args: &FromRmfArgs) -> Result<Exit, Failure> {
    let file = args.file.display().to_string();
    let text = std::fs::read_to_string(&args.file).map_err(|error| {
        Failure::bad_input(format_args!("cannot read {file}: {error}"))
            .advice("name a navigation graph, such as maps/examples/office.rmf.yaml")
    })?;
    let options = RmfOptions {
        level: args.level.clone(),
        areas_by: match args.areas_by {
            AreasBy::Doors => maps::AreasBy::Doors,
            AreasBy::Names => maps::AreasBy::Names,
        },
        most_nodes: usize::try_from(args.area_nodes).unwrap_or(usize::MAX),
    };
    let made = maps::from_rmf(&file, &text, &options)
        .map_err(|findings| Failure::failed(crate::place::lines(&findings)))?;
    let Some(output) = &args.output else {
        tell(&made.notes);
        return print(&made.map);
    };
    write_map(output, &made.map)?;
    let whole = is_folder(output);
    if whole {
        // The museum's domains have names of their own.
        Place::read(output).map_err(|findings| {
            Failure::failed(format_args!(
                "the place is written, but not in order:\n{}",
                crate::place::lines(&findings)
            ))
        })?;
    }
    if args.json {
        let summary = summary(&made, &output.display().to_string());
        anstream::println!("{summary}");
        return Ok(Exit::Done);
    }
    tell(&made.notes);
    let shown = output.display();
    anstream::println!("{GOOD}written:{GOOD:#} {shown}: {}", made.site.summary());
    if whole {
        let start = &made.start;
        anstream::println!("{ADVICE}  try:{ADVICE:#} intermezzo up {shown} --start {start}");
    }
    Ok(Exit::Done)
}

fn tell(notes: &[String]) {
    for note in notes {
        anstream::eprintln!("{ASIDE}note:{ASIDE:#} {note}");
    }
}

fn summary(made: &FromRmf, output: &str) -> serde_json::Value {
    let found = made.site.summary();
    json!({
        "written": output,
        "level": made.level,
        "start": made.start,
        "areas": found.areas,
        "nodes": found.nodes,
        "passages": found.passages,
        "one_way": found.one_way,
        "doors": found.doors,
        "notes": made.notes,
    })
}
