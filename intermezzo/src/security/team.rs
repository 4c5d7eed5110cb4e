//! The rules of a team: who may do what among a room and its vehicles.
//!
//! A router tells identities apart by exact names, so each vehicle has rules of its own. They stand in
//! the router's configuration between two lines that say so, and are written anew when a vehicle is
//! added; what people write elsewhere in the file stays.

use std::collections::BTreeSet;
use std::fmt;

use executor_sim::ROOM;

/// The vehicles of the restaurant that is built in: the ready configurations are for these.
pub(crate) fn of_the_paper() -> BTreeSet<String> {
    let restaurant = maps::Restaurant::of_the_paper();
    let vehicles = restaurant.room().vehicles.keys();
    vehicles.map(ToString::to_string).collect()
}

/// Where a ready configuration wants the name of a vehicle.
pub(crate) const PLACE: &str = "VEHICLE";

/// The line before what is written here, up to the names.
const BEGIN: &str = "// The team:";
/// What stands there instead of names, if there are none.
const NOBODY: &str = "nobody";
/// The line after it.
const END: &str = "// End of the team.";

/// Any robot.
const ANY: &str = "*";

/// Why the rules of a team cannot be written into a router's configuration.
#[derive(Debug, Eq, PartialEq)]
pub(crate) enum TeamError {
    /// Somebody has taken the lines away, or the file is older than they are.
    NoPlace,
    /// What is there is for some robots by name.
    Several(String),
}

impl fmt::Display for TeamError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoPlace => write!(
                f,
                "it does not have a line `{BEGIN} …`, and then `{END}`, among its rules, policies and subjects each"
            ),
            Self::Several(robots) => {
                write!(f, "its rules of a team are for several robots ({robots})")
            }
        }
    }
}

/// What one may do: the rest of the name of the rule, the direction, the messages and the keys.
type Rule = (
    &'static str,
    &'static str,
    &'static [&'static str],
    Vec<String>,
);

/// The vehicles that a router's configuration has rules for.
///
/// # Errors
/// If it is not one that was written here.
pub(crate) fn vehicles(router: &str) -> Result<BTreeSet<String>, TeamError> {
    let line = router.lines().find_map(|line| {
        let names = line.trim().strip_prefix(BEGIN)?;
        names.trim().strip_suffix('.')
    });
    let names = line.ok_or(TeamError::NoPlace)?;
    let names = names.split(", ").filter(|name| *name != NOBODY);
    Ok(names.map(ToOwned::to_owned).collect())
}

/// A router's configuration with rules for these vehicles and their room, instead of those that it has
/// rules for. Who has proved to be whom is said by `kind`.
///
/// # Errors
/// If nothing says where they are to stand, or it is not clear for which robot.
pub(crate) fn with_vehicles(
    router: &str,
    kind: &str,
    vehicles: &BTreeSet<String>,
) -> Result<String, TeamError> {
    let robot = robot(router)?;
    let parts = [
        rules(&robot, vehicles),
        policies(vehicles),
        subjects(kind, vehicles),
    ];
    let mut parts = parts.into_iter();
    let mut text = String::with_capacity(router.len());
    let mut rest = router;
    while let Some((begin, end)) = next_place(rest) {
        let part = parts.next().ok_or(TeamError::NoPlace)?;
        text.push_str(rest.get(..begin).unwrap_or_default());
        text.push_str(&heading(vehicles));
        text.push_str(&part);
        rest = rest.get(end..).unwrap_or_default();
    }
    text.push_str(rest);
    match parts.next() {
        None => Ok(text),
        Some(_) => Err(TeamError::NoPlace),
    }
}

/// Where the next lines of ours stand: from the beginning of the first to that of the last.
fn next_place(text: &str) -> Option<(usize, usize)> {
    let begin = text.find(BEGIN)?;
    let begin = text.get(..begin)?.rfind('\n')? + 1;
    let inside = text.get(begin..)?;
    let end = inside.find(END)?;
    let end = inside.get(..end)?.rfind('\n')? + 1;
    Some((begin, begin + end))
}

/// For which robot the rules are that stand there: somebody may have written its name.
fn robot(router: &str) -> Result<String, TeamError> {
    let Some((begin, end)) = next_place(router) else {
        return Err(TeamError::NoPlace);
    };
    let keys = router.get(begin..end).unwrap_or_default();
    let keys = keys.split("\"intermezzo/").skip(1);
    let robots: BTreeSet<&str> = keys.filter_map(|key| key.split('/').next()).collect();
    let mut names = robots.iter();
    match (names.next(), names.next()) {
        (None, _) => Ok(ANY.to_owned()),
        (Some(robot), None) => Ok((*robot).to_owned()),
        _ => Err(TeamError::Several(
            robots.into_iter().collect::<Vec<_>>().join(", "),
        )),
    }
}

fn heading(vehicles: &BTreeSet<String>) -> String {
    let names: Vec<&str> = vehicles.iter().map(String::as_str).collect();
    let names = match names.as_slice() {
        [] => NOBODY.to_owned(),
        names => names.join(", "),
    };
    format!("      {BEGIN} {names}.\n")
}

fn rules(robot: &str, vehicles: &BTreeSet<String>) -> String {
    if vehicles.is_empty() {
        return String::new();
    }
    let mut text = String::from(
        "      // The room: moves all bodies, each for its own vehicle, and tells each what it sees.\n",
    );
    for rule in of_room() {
        text.push_str(&written(robot, ROOM, rule));
    }
    for vehicle in vehicles {
        text.push_str(
            "\n      // A vehicle: says everything under its own name, which stands last in the key.\n",
        );
        for rule in of_vehicle(vehicle) {
            text.push_str(&written(robot, vehicle, rule));
        }
    }
    if let Some(first) = vehicles.first() {
        text.push_str(
            "\n      // The first by name also takes what is for no vehicle in particular.\n",
        );
        for rule in of_first() {
            text.push_str(&written(robot, first, rule));
        }
    }
    text
}

const OFFERS: &[&str] = &["declare_queryable", "reply"];

fn of_room() -> Vec<Rule> {
    let offered = keys(&[
        "room/*",
        "room/instruction/*",
        "room/facts/*",
        "clock",
        "facts",
    ]);
    vec![
        lives(ROOM),
        ("offers", IN, OFFERS, offered.clone()),
        ("listens", IN, &["declare_subscriber"], keys(&["facts"])),
        ("asks", IN, &["query"], keys(&["*/report/room"])),
        (
            "tells",
            IN,
            &["put"],
            keys(&["event", "world/pose", "room/facts/*"]),
        ),
        ("is asked", OUT, &["query"], offered),
        ("is told", OUT, &["put"], keys(&["facts"])),
        ("is answered", OUT, &["reply"], keys(&["*/report/room"])),
    ]
}

fn of_vehicle(name: &str) -> Vec<Rule> {
    let own = |rest: &[&str]| -> Vec<String> {
        rest.iter().map(|key| key.replace(PLACE, name)).collect()
    };
    let offered = own(&[
        "VEHICLE/*",
        "VEHICLE/instruction/*",
        "VEHICLE/report/*",
        "VEHICLE/goal/*",
    ]);
    let asked = own(&[
        "*/instruction/VEHICLE",
        "*/report/VEHICLE",
        "room/facts",
        "room/facts/VEHICLE",
    ]);
    let heard = own(&[
        "team/*",
        "room/facts",
        "room/facts/VEHICLE",
        "VEHICLE/goal/normal",
        "VEHICLE/goal/emergency",
    ]);
    vec![
        lives(name),
        ("offers", IN, OFFERS, offered.clone()),
        ("listens", IN, &["declare_subscriber"], heard.clone()),
        ("asks", IN, &["query"], asked.clone()),
        (
            "tells",
            IN,
            &["put"],
            own(&["team/VEHICLE", "event", "goal/answers"]),
        ),
        ("is asked", OUT, &["query"], offered),
        ("is told", OUT, &["put"], heard),
        ("is answered", OUT, &["reply"], asked),
    ]
}

fn of_first() -> Vec<Rule> {
    let goals = keys(&[
        "goal/normal",
        "goal/normal/*",
        "goal/emergency",
        "goal/emergency/*",
    ]);
    let mut asked = goals.clone();
    asked.extend(keys(&["goal/command"]));
    vec![
        ("takes goals", IN, OFFERS, asked.clone()),
        (
            "listens to goals",
            IN,
            &["declare_subscriber"],
            goals.clone(),
        ),
        ("is asked for goals", OUT, &["query"], asked),
        ("is told goals", OUT, &["put"], goals),
    ]
}

const IN: &str = "ingress";
const OUT: &str = "egress";

fn lives(name: &str) -> Rule {
    let keys = vec![format!("alive/{name}/*")];
    ("lives", IN, &["liveliness_token"], keys)
}

fn keys(keys: &[&str]) -> Vec<String> {
    keys.iter().map(|key| (*key).to_owned()).collect()
}

/// A rule as it stands in the file.
fn written(robot: &str, who: &str, (what, flow, messages, keys): Rule) -> String {
    let messages: Vec<String> = messages.iter().map(|it| format!("\"{it}\"")).collect();
    let keys: Vec<String> = keys
        .iter()
        .map(|key| format!("\"intermezzo/{robot}/{key}\""))
        .collect();
    format!(
        "      {{ id: \"{who} {what}\", permission: \"allow\", flows: [\"{flow}\"],\n\
         \x20       messages: [{}],\n\
         \x20       key_exprs: [{}] }},\n",
        messages.join(", "),
        wrapped(&keys, "                    "),
    )
}

/// As many a line as are easily read.
fn wrapped(words: &[String], indent: &str) -> String {
    const WIDTH: usize = 76;
    let mut text = String::new();
    let mut width = 0;
    for (number, word) in words.iter().enumerate() {
        if number > 0 {
            text.push(',');
            if width + word.len() > WIDTH {
                text.push('\n');
                text.push_str(indent);
                width = 0;
            } else {
                text.push(' ');
            }
        }
        text.push_str(word);
        width += word.len() + 2;
    }
    text
}

fn policies(vehicles: &BTreeSet<String>) -> String {
    let Some(first) = vehicles.first() else {
        return String::new();
    };
    let everybody: Vec<String> = members(vehicles)
        .map(|name| format!("\"{name}\""))
        .collect();
    let mut text = format!(
        "      {{ subjects: [{}],\n\
         \x20       rules: [\"see who is there\", \"be told who is there\", \"be told who listens\",\n\
         \x20               \"ask for the time\", \"be told the time\"] }},\n",
        wrapped(&everybody, "                   "),
    );
    for who in members(vehicles) {
        let mut rules = match who {
            ROOM => of_room(),
            vehicle => of_vehicle(vehicle),
        };
        if who == first {
            rules.extend(of_first());
        }
        let rules = rules.into_iter();
        let rules: Vec<String> = rules
            .map(|(what, ..)| format!("\"{who} {what}\""))
            .collect();
        text.push_str(&format!(
            "      {{ subjects: [\"{who}\"],\n\x20       rules: [{}] }},\n",
            wrapped(&rules, "                "),
        ));
    }
    text
}

fn subjects(kind: &str, vehicles: &BTreeSet<String>) -> String {
    if vehicles.is_empty() {
        return String::new();
    }
    let subjects = members(vehicles);
    let subjects =
        subjects.map(|name| format!("      {{ id: \"{name}\", {kind}: [\"{name}\"] }},\n"));
    subjects.collect()
}

/// The room, then its vehicles.
fn members(vehicles: &BTreeSet<String>) -> impl Iterator<Item = &str> {
    std::iter::once(ROOM).chain(vehicles.iter().map(String::as_str))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::security::{PASSWORDS, TLS};

    fn names(names: &[&str]) -> BTreeSet<String> {
        names.iter().map(|name| (*name).to_owned()).collect()
    }

    fn control(text: &str) -> serde_json::Value {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.json5");
        std::fs::write(&path, text).unwrap();
        let config = zenoh::Config::from_file(&path).unwrap();
        serde_json::from_str(&config.get_json("access_control").unwrap()).unwrap()
    }

    /// The rules that `name` has by policies of its own.
    fn rules_of(control: &serde_json::Value, name: &str) -> Vec<serde_json::Value> {
        let policies = control["policies"].as_array().unwrap().iter();
        let ids = policies.filter(|policy| policy["subjects"] == serde_json::json!([name]));
        let ids: Vec<_> = ids
            .flat_map(|policy| policy["rules"].as_array().unwrap().clone())
            .collect();
        let rules = control["rules"].as_array().unwrap().iter();
        rules
            .filter(|rule| ids.contains(&rule["id"]))
            .cloned()
            .collect()
    }

    #[test]
    fn whoever_is_added_may_do_under_its_name_what_the_others_may_under_theirs() {
        for ready in [TLS, PASSWORDS] {
            let team = with_vehicles(ready.router, ready.kind, &names(&["k2", "k9"])).unwrap();
            let control = control(&team);
            let of = |name: &str| {
                let rules = serde_json::to_string(&rules_of(&control, name)).unwrap();
                rules.replace(name, "it")
            };
            let (first, added) = (of("k2"), of("k9"));
            let added = added.strip_suffix(']').unwrap();
            let more = first.strip_prefix(added).unwrap();
            assert!(more.contains("it takes goals"), "{more}");
            assert!(!team.contains("k1") && !team.contains("k3"));
        }
    }

    #[test]
    fn what_people_write_beside_the_team_stays_and_so_does_the_name_of_the_robot() {
        let edited = TLS.router.replace("intermezzo/*/", "intermezzo/cafe/");
        let edited = edited.replace("[\"operator\"", "[\"operator\", \"anna\"");
        // Lines are not broken at the same places.
        let edited = with_vehicles(&edited, TLS.kind, &of_the_paper()).unwrap();
        let all = names(&["k1", "k2", "k3", "k4"]);
        let more = with_vehicles(&edited, TLS.kind, &all).unwrap();
        assert!(!more.contains("intermezzo/*/"));
        assert!(more.contains("intermezzo/cafe/k4/instruction/*"));
        assert_eq!(more.matches("anna").count(), edited.matches("anna").count());
        assert_eq!(vehicles(&more), Ok(all));
        let less = with_vehicles(&more, TLS.kind, &of_the_paper()).unwrap();
        assert!(less == edited, "{less}");
    }

    #[test]
    fn without_vehicles_there_is_no_room_either() {
        let nobody = with_vehicles(TLS.router, TLS.kind, &names(&[])).unwrap();
        assert_eq!(vehicles(&nobody), Ok(names(&[])));
        assert!(rules_of(&control(&nobody), ROOM).is_empty());
        let again = with_vehicles(&nobody, TLS.kind, &of_the_paper());
        assert_eq!(again.unwrap(), TLS.router);
    }

    #[test]
    fn a_file_without_a_place_for_them_and_one_of_several_robots_are_refused() {
        let one = names(&["k1"]);
        let no_place = TLS.router.replace(END, "// gone");
        for text in ["", "{}", &no_place] {
            let refused = with_vehicles(text, TLS.kind, &one);
            assert_eq!(refused, Err(TeamError::NoPlace));
        }
        assert_eq!(vehicles("{}"), Err(TeamError::NoPlace));
        let several = TLS
            .router
            .replacen("intermezzo/*/alive/k1", "intermezzo/cafe/alive/k1", 1);
        let refused = with_vehicles(&several, TLS.kind, &one);
        assert_eq!(refused, Err(TeamError::Several("*, cafe".to_owned())));
    }
}
