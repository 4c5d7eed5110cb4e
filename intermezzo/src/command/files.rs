//! Where what was made goes: to a file, to a folder, or to the standard output.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use maps::museum;

use crate::exit::{Exit, Failure};

/// To the standard output.
pub(crate) fn print(text: &str) -> Result<Exit, Failure> {
    // Whoever reads it may have seen enough: `… | head`.
    match io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Failure::failed(error)),
        _ => Ok(Exit::Done),
    }
}

/// To a file; the folders on the way are made.
pub(crate) fn write(file: &Path, text: &str) -> Result<(), Failure> {
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

/// A map to a file or, if it is a folder that is named (it exists, or its name ends in `/`), a whole
/// place with the museum's domains.
pub(crate) fn write_map(output: &Path, map: &str) -> Result<(), Failure> {
    if !is_folder(output) {
        return write(output, map);
    }
    for (name, text_of_museum) in museum::FILES {
        let is_map = name == museum::FILES[0].0;
        write(
            &output.join(name),
            if is_map { map } else { text_of_museum },
        )?;
    }
    Ok(())
}

/// Whether a whole place goes there.
pub(crate) fn is_folder(output: &Path) -> bool {
    output.is_dir() || output.as_os_str().as_encoded_bytes().ends_with(b"/")
}
