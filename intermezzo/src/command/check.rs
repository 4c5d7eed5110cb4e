//! `map check` and `domain check`.

use std::path::Path;

use maps::{Finding, Site, check_domain_dir};

use crate::exit::{Exit, Failure};
use crate::style::{BAD, GOOD};

/// The map in a file, or all that is wrong with it.
pub(crate) fn read_map(file: &Path) -> Result<Result<Site, Vec<Finding>>, Failure> {
    if !file.is_file() {
        return Err(
            Failure::bad_input(format_args!("there is no file {}", file.display()))
                .advice("name a map, such as maps/museum/map.geojson"),
        );
    }
    Ok(Site::read(file))
}

/// Names everything that is wrong with a map.
pub(crate) fn map(file: &Path) -> Result<Exit, Failure> {
    Ok(match read_map(file)? {
        Ok(site) => {
            let name = match site.name() {
                "" => file.display().to_string(),
                name => name.to_owned(),
            };
            anstream::println!("{GOOD}in order:{GOOD:#} {name}: {}", site.summary());
            Exit::Done
        }
        Err(findings) => faults(&findings),
    })
}

/// Names everything that is wrong with the domains of a folder.
pub(crate) fn domain(dir: &Path) -> Result<Exit, Failure> {
    if !dir.is_dir() {
        return Err(
            Failure::bad_input(format_args!("there is no folder {}", dir.display()))
                .advice("name a folder with domains, such as maps/museum"),
        );
    }
    Ok(match check_domain_dir(dir) {
        Ok(levels) => {
            anstream::println!("{GOOD}in order:{GOOD:#} {}", levels.join(", "));
            Exit::Done
        }
        Err(findings) => faults(&findings),
    })
}

fn faults(findings: &[Finding]) -> Exit {
    for finding in findings {
        anstream::println!("{finding}");
    }
    let plural = if findings.len() == 1 { "" } else { "s" };
    anstream::eprintln!("{BAD}{} fault{plural}{BAD:#}", findings.len());
    Exit::Failed
}
