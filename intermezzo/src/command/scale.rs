//! `map scale`: a made-up museum of any size.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use maps::{Site, museum, scaled_map};

use crate::cli::ScaleArgs;
use crate::exit::{Exit, Failure};
use crate::style::GOOD;

/// Writes the map, or the whole place.
pub(crate) fn run(args: &ScaleArgs) -> Result<Exit, Failure> {
    let text = scaled_map(args.nodes, args.seed);
    let Some(output) = &args.output else {
        // Whoever reads it may have seen enough: `… | head`.
        return match io::stdout().lock().write_all(text.as_bytes()) {
            Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Failure::failed(error)),
            _ => Ok(Exit::Done),
        };
    };
    let is_folder = output.is_dir() || output.as_os_str().as_encoded_bytes().ends_with(b"/");
    if is_folder {
        for (name, text_of_museum) in museum::FILES {
            let is_map = name == museum::FILES[0].0;
            write(
                &output.join(name),
                if is_map { &text } else { text_of_museum },
            )?;
        }
    } else {
        write(output, &text)?;
    }
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

fn write(file: &Path, text: &str) -> Result<(), Failure> {
    let folder = file
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    folder
        .map_or(Ok(()), fs::create_dir_all)
        .and_then(|()| fs::write(file, text))
        .map_err(|error| {
            Failure::bad_input(format_args!("cannot write {}: {error}", file.display()))
                .advice("name a file, or a folder, that you may write")
        })
}
