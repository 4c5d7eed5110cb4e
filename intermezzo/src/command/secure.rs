//! `certs` and `passwords`: what it takes to lock a robot's doors.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use agent_link::Keys;

use crate::cli::{CertsArgs, PasswordsArgs};
use crate::exit::{Exit, Failure};
use crate::place;
use crate::security::certificates::{AUTHORITY, AUTHORITY_KEY, Authority, Signed};
use crate::security::folder::{Folder, read};
use crate::security::passwords::{LIST, Passwords};
use crate::security::team::{self, TeamError};
use crate::security::{OPERATOR, PASSWORDS, ROUTER, ROUTER_FILE, Ready, TLS};
use crate::style::{BOLD, DIM, GOOD};

/// `intermezzo certs`.
pub(crate) fn certs(args: &CertsArgs) -> Result<Exit, Failure> {
    let days = i64::from(args.days);
    let mut folder = Folder::new(&args.dir, args.force);
    if args.add.is_some() || !args.vehicle.is_empty() {
        let authority = Authority::again(
            &read(&args.dir.join(AUTHORITY))?,
            &read(&args.dir.join(AUTHORITY_KEY))?,
        )?;
        if let Some(name) = &args.add {
            check(name)?;
            put_signed(&mut folder, name, authority.client(name, days)?);
            put_another(&mut folder, name, TLS.of_another(name, OPERATOR));
            folder.write()?;
            added(&args.dir, name, TLS.kind);
            return Ok(Exit::Done);
        }
        let rules = rules_with(&args.dir, &TLS, &args.vehicle, args.force)?;
        for name in &args.vehicle {
            put_signed(&mut folder, name, authority.client(name, days)?);
            folder.put(format!("{name}.json5"), TLS.of_vehicle(name));
        }
        folder.write()?;
        vehicles_added(&args.dir, &args.vehicle, write_rules(&args.dir, rules)?);
        return Ok(Exit::Done);
    }
    let vehicles = vehicles_of(args.place.as_deref())?;
    let (authority, signed) = Authority::new()?;
    folder.put(AUTHORITY, signed.certificate);
    folder.put(AUTHORITY_KEY, signed.key);
    put_signed(
        &mut folder,
        ROUTER,
        authority.router(ROUTER, &args.name, days)?,
    );
    folder.put_edited(ROUTER_FILE, rules_for(&TLS, &vehicles)?);
    for (name, configuration) in TLS.everybody(&vehicles) {
        put_signed(&mut folder, &name, authority.client(&name, days)?);
        folder.put(format!("{name}.json5"), configuration);
    }
    let kept = folder.write()?;
    let valid = format!(
        "An authority and certificates for {days} days are in {}.",
        args.dir.display()
    );
    next(&args.dir, &valid, args.place.as_deref(), &vehicles);
    replaced(kept.as_deref());
    anstream::println!(
        "{DIM}To somebody elsewhere give ca.pem and the three files with their name (viewer.pem, \
         viewer-key.pem, viewer.json5),\nand nothing else. {AUTHORITY_KEY} makes more \
         certificates: nobody else may have it, and no robot needs it.{DIM:#}"
    );
    Ok(Exit::Done)
}

/// `intermezzo passwords`.
pub(crate) fn passwords(args: &PasswordsArgs) -> Result<Exit, Failure> {
    let mut folder = Folder::new(&args.dir, args.force);
    if let Some(name) = &args.add {
        check(name)?;
        let mut list = Passwords::read(&args.dir)?;
        let configuration = PASSWORDS.of_another(name, OPERATOR);
        let configuration = configuration.map(|text| list.known_by(name, &text));
        put_another(&mut folder, name, configuration.transpose()?);
        folder.write()?;
        list.write(&args.dir)?;
        added(&args.dir, name, PASSWORDS.kind);
        return Ok(Exit::Done);
    }
    if !args.vehicle.is_empty() {
        let rules = rules_with(&args.dir, &PASSWORDS, &args.vehicle, args.force)?;
        let mut list = Passwords::read(&args.dir)?;
        for name in &args.vehicle {
            if args.force {
                list.forget(name);
            }
            let text = list.known_by(name, &PASSWORDS.of_vehicle(name))?;
            folder.put(format!("{name}.json5"), text);
        }
        folder.write()?;
        list.write(&args.dir)?;
        vehicles_added(&args.dir, &args.vehicle, write_rules(&args.dir, rules)?);
        return Ok(Exit::Done);
    }
    let vehicles = vehicles_of(args.place.as_deref())?;
    folder.put_edited(ROUTER_FILE, rules_for(&PASSWORDS, &vehicles)?);
    let mut list = Passwords::none(&args.dir);
    for (name, configuration) in PASSWORDS.everybody(&vehicles) {
        let text = list.known_by(&name, &configuration)?;
        folder.put(format!("{name}.json5"), text);
    }
    folder.put(LIST, list.text());
    let kept = folder.write()?;
    let made = format!("Passwords are in {}.", args.dir.display());
    next(&args.dir, &made, args.place.as_deref(), &vehicles);
    replaced(kept.as_deref());
    anstream::println!(
        "{DIM}To somebody elsewhere give the file with their name (viewer.json5), and nothing else. \
         What is said can\nbe read on the way: beyond one machine use `intermezzo certs`.{DIM:#}"
    );
    Ok(Exit::Done)
}

/// The vehicles that are to have an identity each: those of a restaurant, or of the one that is built in.
fn vehicles_of(place: Option<&Path>) -> Result<BTreeSet<String>, Failure> {
    let vehicles = match place {
        None => team::of_the_paper(),
        Some(typed) => match place::read_restaurant(typed)? {
            Some((_, restaurant)) => {
                let vehicles = restaurant.room().vehicles.keys();
                vehicles.map(ToString::to_string).collect()
            }
            None => place::read(typed).map(|_| BTreeSet::new())?,
        },
    };
    vehicles.iter().try_for_each(|name| check_vehicle(name))?;
    Ok(vehicles)
}

/// The ready rules, for a team of these.
fn rules_for(ready: &Ready, vehicles: &BTreeSet<String>) -> Result<String, Failure> {
    team::with_vehicles(ready.router, ready.kind, vehicles).map_err(Failure::failed)
}

/// The rules that stand in that folder, for these vehicles more.
fn rules_with(dir: &Path, ready: &Ready, more: &[String], force: bool) -> Result<String, Failure> {
    let path = dir.join(ROUTER_FILE);
    let text = read(&path)?;
    let not_ours = |error: TeamError| {
        Failure::bad_input(format_args!(
            "cannot add vehicles to {}: {error}",
            path.display()
        ))
        .advice("add them by hand (security/README.md), or make everything anew with --force")
    };
    let mut vehicles = team::vehicles(&text).map_err(not_ours)?;
    for name in more {
        check_vehicle(name)?;
        if !vehicles.insert(name.clone()) && !force {
            let known = format!("{} knows `{name}` already", path.display());
            return Err(Failure::bad_input(known).advice("--force proves the same name anew"));
        }
    }
    team::with_vehicles(&text, ready.kind, &vehicles).map_err(not_ours)
}

/// Writes the router's rules; returns where those are that stood there.
fn write_rules(dir: &Path, rules: String) -> Result<Option<PathBuf>, Failure> {
    let mut folder = Folder::new(dir, true);
    folder.put_edited(ROUTER_FILE, rules);
    folder.write()
}

/// What can be somebody's name in a key, and stands for nobody yet.
fn check(name: &str) -> Result<(), Failure> {
    Keys::new(name).map_err(Failure::bad_input)?;
    let taken = TLS.clients.iter().any(|(known, _)| *known == name);
    // `anna-key.pem` is anna's.
    let taken =
        taken || [ROUTER, executor_sim::ROOM, "ca"].contains(&name) || name.ends_with("-key");
    if taken {
        let message = format!("`{name}` is somebody else: choose another name");
        return Err(Failure::bad_input(message));
    }
    Ok(())
}

/// The same for a vehicle, which has keys of its own.
fn check_vehicle(name: &str) -> Result<(), Failure> {
    check(name)?;
    let keys = Keys::new(ROUTER).and_then(|keys| keys.agent(name));
    keys.map(|_| ()).map_err(Failure::bad_input)
}

fn put_signed(folder: &mut Folder<'_>, name: &str, signed: Signed) {
    folder.put(format!("{name}.pem"), signed.certificate);
    folder.put(format!("{name}-key.pem"), signed.key);
}

fn put_another(folder: &mut Folder<'_>, name: &str, configuration: Option<String>) {
    if let Some(configuration) = configuration {
        folder.put(format!("{name}.json5"), configuration);
    }
}

fn next(dir: &Path, done: &str, place: Option<&Path>, vehicles: &BTreeSet<String>) {
    let dir = dir.display();
    anstream::println!("{GOOD}ok{GOOD:#} {done}\n{BOLD}Next:{BOLD:#}");
    let robot = "a robot with locked doors";
    let names: Vec<&str> = vehicles.iter().map(String::as_str).collect();
    let team = format!("a team with locked doors: {}", names.join(", "));
    let up = match place {
        None => vec![
            (format!("up --security {dir}"), robot),
            (format!("up restaurant --security {dir}"), team.as_str()),
        ],
        Some(place) => {
            let what = if vehicles.is_empty() { robot } else { &team };
            vec![(format!("up {} --security {dir}", place.display()), what)]
        }
    };
    let others = [
        (
            format!("status --security {dir}"),
            "as operator, who may also ask for goals",
        ),
        (
            format!("watch --security {dir} --as viewer"),
            "as viewer, who may look and watch",
        ),
    ];
    for (command, what) in up.into_iter().chain(others) {
        let command = format!("intermezzo {command}");
        anstream::println!("  {command:<52} {DIM}{what}{DIM:#}");
    }
}

/// What is next for vehicles that were added.
fn vehicles_added(dir: &Path, vehicles: &[String], kept: Option<PathBuf>) {
    let (names, file) = (vehicles.join(", "), dir.join(ROUTER_FILE));
    anstream::println!(
        "{GOOD}ok{GOOD:#} {names} can now prove who that is, and the rules in {} say what a vehicle may do.\n\
         {BOLD}Next:{BOLD:#} start the router anew, with the vehicles in room.toml.",
        file.display(),
    );
    if let Some(kept) = kept {
        anstream::println!(
            "{DIM}The rules as they stood are in {}.{DIM:#}",
            kept.display()
        );
    }
}

/// Users of one's own have to be added again.
fn replaced(kept: Option<&Path>) {
    if let Some(kept) = kept {
        anstream::println!(
            "Whoever was added before is not known any more: add them again with --add. The rules as they \
             stood are in {}.",
            kept.display()
        );
    }
}

fn added(dir: &Path, name: &str, kind: &str) {
    let (router, dir) = (dir.join(ROUTER_FILE), dir.display());
    anstream::println!(
        "{GOOD}ok{GOOD:#} {name} can now prove who that is, and may do nothing yet.\n\
         {BOLD}Next:{BOLD:#} in {}, add {name} wherever an operator stands, or for looking and watching\n\
         only wherever a viewer stands:\n\
         \x20 subjects  {{ id: \"{name}\", {kind}: [\"{name}\"] }},\n\
         \x20 policies  \"{name}\" beside \"operator\" (or \"viewer\"), save where it says \"operator's name\";\n\
         \x20           for an operator also {{ subjects: [\"{name}\"], rules: [\"{name}'s name\"] }},\n\
         \x20 rules     for an operator a copy of \"operator's name\", with {name} for operator\n\
         Then start the robot anew, and use it with --security {dir} --as {name}.",
        router.display(),
    );
}
