//! `certs` and `passwords`: what it takes to lock a robot's doors.

use std::path::Path;

use agent_link::Keys;

use crate::cli::{CertsArgs, PasswordsArgs};
use crate::exit::{Exit, Failure};
use crate::security::certificates::{AUTHORITY, AUTHORITY_KEY, Authority, Signed};
use crate::security::folder::{Folder, read};
use crate::security::passwords::{LIST, PLACE, password};
use crate::security::{OPERATOR, PASSWORDS, ROUTER, TLS};
use crate::style::{BOLD, DIM, GOOD};

/// `intermezzo certs`.
pub(crate) fn certs(args: &CertsArgs) -> Result<Exit, Failure> {
    let days = i64::from(args.days);
    let mut folder = Folder::new(&args.dir, args.force);
    if let Some(name) = &args.add {
        check(name)?;
        let authority = Authority::again(
            &read(&args.dir.join(AUTHORITY))?,
            &read(&args.dir.join(AUTHORITY_KEY))?,
        )?;
        put_signed(&mut folder, name, authority.client(name, days)?);
        put_another(&mut folder, name, TLS.of_another(name, OPERATOR));
        folder.write()?;
        added(&args.dir, name, "cert_common_names");
        return Ok(Exit::Done);
    }
    let (authority, signed) = Authority::new()?;
    folder.put(AUTHORITY, signed.certificate);
    folder.put(AUTHORITY_KEY, signed.key);
    put_signed(
        &mut folder,
        ROUTER,
        authority.router(ROUTER, &args.name, days)?,
    );
    folder.put_edited(format!("{ROUTER}.json5"), TLS.router);
    for (name, configuration) in TLS.clients {
        put_signed(&mut folder, name, authority.client(name, days)?);
        folder.put(format!("{name}.json5"), configuration);
    }
    let kept = folder.write()?;
    let valid = format!(
        "An authority and certificates for {days} days are in {}.",
        args.dir.display()
    );
    next(&args.dir, &valid);
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
    if let Some(name) = &args.add {
        check(name)?;
        let list = args.dir.join(LIST);
        let mut known = read(&list)?;
        let line = |known: &&str| known.split(':').next() == Some(name);
        if known.lines().any(|known| line(&known)) {
            let there = format!("{} knows `{name}` already", list.display());
            return Err(Failure::bad_input(there));
        }
        let password = password()?;
        let mut folder = Folder::new(&args.dir, args.force);
        let configuration = PASSWORDS.of_another(name, OPERATOR);
        let configuration = configuration.map(|text| text.replace(PLACE, &password));
        put_another(&mut folder, name, configuration);
        folder.write()?;
        if !known.ends_with('\n') {
            known.push('\n');
        }
        known.push_str(&format!("{name}:{password}\n"));
        let mut folder = Folder::new(&args.dir, true);
        folder.put(LIST, known);
        folder.write()?;
        added(&args.dir, name, "usernames");
        return Ok(Exit::Done);
    }
    let mut folder = Folder::new(&args.dir, args.force);
    folder.put_edited(format!("{ROUTER}.json5"), PASSWORDS.router);
    let mut list = String::new();
    for (name, configuration) in PASSWORDS.clients {
        let password = password()?;
        list.push_str(&format!("{name}:{password}\n"));
        folder.put(
            format!("{name}.json5"),
            configuration.replace(PLACE, &password),
        );
    }
    folder.put(LIST, list);
    let kept = folder.write()?;
    next(
        &args.dir,
        &format!("Passwords are in {}.", args.dir.display()),
    );
    replaced(kept.as_deref());
    anstream::println!(
        "{DIM}To somebody elsewhere give the file with their name (viewer.json5), and nothing else. \
         What is said can\nbe read on the way: beyond one machine use `intermezzo certs`.{DIM:#}"
    );
    Ok(Exit::Done)
}

/// What can be somebody's name in a key, and stands for nobody yet.
fn check(name: &str) -> Result<(), Failure> {
    Keys::new(name).map_err(Failure::bad_input)?;
    let taken = name == ROUTER || TLS.clients.iter().any(|(known, _)| *known == name);
    if taken || name == "ca" {
        let message = format!("`{name}` is somebody else: choose another name");
        return Err(Failure::bad_input(message));
    }
    Ok(())
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

fn next(dir: &Path, done: &str) {
    let dir = dir.display();
    anstream::println!("{GOOD}ok{GOOD:#} {done}\n{BOLD}Next:{BOLD:#}");
    for (command, what) in [
        (format!("up --security {dir}"), "a robot with locked doors"),
        (
            format!("goal '(go n40)' --security {dir}"),
            "as operator, who may ask for goals",
        ),
        (
            format!("watch --security {dir} --as viewer"),
            "as viewer, who may look and watch",
        ),
    ] {
        let command = format!("intermezzo {command}");
        anstream::println!("  {command:<52} {DIM}{what}{DIM:#}");
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
    let (router, dir) = (dir.join(format!("{ROUTER}.json5")), dir.display());
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
