//! `map scale`: a made-up museum of any size.

use maps::{Site, scaled_map};

use super::files::{print, write_map};
use crate::cli::ScaleArgs;
use crate::exit::{Exit, Failure};
use crate::style::GOOD;

/// Writes the map, or the whole place.
pub(crate) fn run(args: &ScaleArgs) -> Result<Exit, Failure> {
    let text = scaled_map(args.nodes, args.seed);
    let Some(output) = &args.output else {
        return print(&text);
    };
    write_map(output, &text)?;
    let shown = output.display();
    match Site::from_text(&shown.to_string(), &text) {
        Ok(site) => anstream::println!("{GOOD}written:{GOOD:#} {shown}: {}", site.summary()),
        // A fault of the generator, not of what was typed.
        Err(findings) => {
            return Err(Failure::failed(format_args!(
                "the museum that was made up is not in order: {}",
                crate::place::lines(&findings)
            )));
        }
    }
    Ok(Exit::Done)
}
