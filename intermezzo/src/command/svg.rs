//! `map svg`: a picture of a map.

use std::path::Path;

use maps::{Picture, Site};

use super::check;
use super::files::{print, write};
use crate::cli::SvgArgs;
use crate::exit::{Exit, Failure};
use crate::style::GOOD;

/// Draws the map, to a file or to the standard output.
pub(crate) fn run(args: &SvgArgs) -> Result<Exit, Failure> {
    let site = match check::read_map(&args.file)? {
        Ok(site) => site,
        // On the standard error: the standard output is for the picture.
        Err(findings) => {
            return Err(Failure::failed(crate::place::lines(&findings))
                .advice("mend the map; `intermezzo map check` names its faults, too"));
        }
    };
    let mut picture = Picture::default();
    for (doors, open) in [(&args.open, true), (&args.closed, false)] {
        for door in doors {
            let name = site.door(&door.to_ascii_lowercase()).map(maps::Door::name);
            let name = name.ok_or_else(|| no_such(door, "door", &args.file))?;
            picture.doors.insert(name.clone(), open);
        }
    }
    let node = |name: &String| {
        let node = site.node(&name.to_ascii_lowercase());
        node.ok_or_else(|| no_such(name, "node", &args.file))
    };
    if let Some(start) = &args.start {
        picture.start = Some(node(start)?.name().clone());
    }
    if let [from, to] = &args.route[..] {
        let [from, to] = [node(from)?.name(), node(to)?.name()];
        let route = picture.find_route(&site, from.as_str(), to.as_str());
        let route = route.ok_or_else(|| no_way(&site, &picture, from.as_str(), to.as_str()))?;
        picture.route = Some(route);
    }
    let text = picture.svg(&site);
    let Some(output) = &args.output else {
        return print(&text);
    };
    write(output, &text)?;
    anstream::println!(
        "{GOOD}drawn:{GOOD:#} {}: {}",
        output.display(),
        site.summary()
    );
    Ok(Exit::Done)
}

fn no_such(name: &str, what: &str, file: &Path) -> Failure {
    Failure::bad_input(format_args!("{} has no {what} {name}", file.display())).advice(
        format_args!("look at the map without it: all {what}s are named there"),
    )
}

fn no_way(site: &Site, picture: &Picture, from: &str, to: &str) -> Failure {
    let closed: Vec<&str> = site
        .doors()
        .map(|door| door.name().as_str())
        .filter(|door| !picture.is_open(site, door))
        .collect();
    // With all doors open there is a way from every node to every other (`Site`).
    Failure::failed(format_args!(
        "there is no way from {from} to {to} with {} closed",
        closed.join(", ")
    ))
    .advice("open doors with --open DOOR")
}
