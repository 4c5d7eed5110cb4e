//! Who may do what with a robot: the ready configurations of `security/`, and the folder in which
//! they lie with the certificates or passwords that they name.

pub(crate) mod certificates;
pub(crate) mod folder;
pub(crate) mod passwords;
pub(crate) mod team;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use crate::exit::Failure;

/// Whom the ready configurations know. The router is known by what it proves, too.
pub(crate) const ROUTER: &str = "router";
/// The router's configuration, with the rules.
pub(crate) const ROUTER_FILE: &str = "router.json5";
pub(crate) const OPERATOR: &str = "operator";
pub(crate) const VIEWER: &str = "viewer";
/// `intermezzo up` on a router elsewhere.
pub(crate) const SUPERVISOR: &str = "supervisor";

/// The ready configurations of one way to prove who one is.
pub(crate) struct Ready {
    pub(crate) router: &'static str,
    /// Of each client, by name.
    pub(crate) clients: [(&'static str, &'static str); 7],
    /// Of the room of a team.
    pub(crate) room: &'static str,
    /// Of one of its vehicles, with [`team::PLACE`] for its name.
    pub(crate) vehicle: &'static str,
    /// What the router's rules call how somebody is known.
    pub(crate) kind: &'static str,
}

macro_rules! ready {
    ($way:literal, $kind:literal) => {
        Ready {
            router: include_str!(concat!("../../../security/", $way, "/router.json5")),
            clients: [
                (
                    OPERATOR,
                    include_str!(concat!("../../../security/", $way, "/operator.json5")),
                ),
                (
                    VIEWER,
                    include_str!(concat!("../../../security/", $way, "/viewer.json5")),
                ),
                (
                    SUPERVISOR,
                    include_str!(concat!("../../../security/", $way, "/supervisor.json5")),
                ),
                (
                    parent_agent::NAME,
                    include_str!(concat!("../../../security/", $way, "/parent.json5")),
                ),
                (
                    child_agent::NAME,
                    include_str!(concat!("../../../security/", $way, "/child.json5")),
                ),
                (
                    executor_sim::program::EXECUTOR,
                    include_str!(concat!("../../../security/", $way, "/executor.json5")),
                ),
                (
                    executor_sim::program::WORLD,
                    include_str!(concat!("../../../security/", $way, "/world.json5")),
                ),
            ],
            room: include_str!(concat!("../../../security/", $way, "/room.json5")),
            vehicle: include_str!(concat!("../../../security/", $way, "/vehicle.json5")),
            kind: $kind,
        }
    };
}

/// Everybody has a certificate.
pub(crate) const TLS: Ready = ready!("tls", "cert_common_names");

/// Everybody has a password.
pub(crate) const PASSWORDS: Ready = ready!("passwords", "usernames");

impl Ready {
    /// The configurations of all clients by name: of the robot's, and of a room and these vehicles if
    /// there are any.
    pub(crate) fn everybody(&self, vehicles: &BTreeSet<String>) -> Vec<(String, String)> {
        let clients = self.clients.iter();
        let clients = clients.map(|(name, text)| ((*name).to_owned(), (*text).to_owned()));
        let room = (executor_sim::ROOM.to_owned(), self.room.to_owned());
        let room = (!vehicles.is_empty()).then_some(room);
        let vehicles = vehicles.iter();
        let vehicles = vehicles.map(|name| (name.clone(), self.of_vehicle(name)));
        clients.chain(room).chain(vehicles).collect()
    }

    /// For the vehicle of this name.
    pub(crate) fn of_vehicle(&self, name: &str) -> String {
        self.vehicle.replace(team::PLACE, name)
    }

    /// For somebody who is `like` one of those that are known.
    pub(crate) fn of_another(&self, name: &str, like: &str) -> Option<String> {
        let (_, text) = self.clients.iter().find(|(known, _)| *known == like)?;
        Some(text.replace(like, name))
    }
}

/// The configuration of somebody in such a folder.
pub(crate) fn configuration_of(folder: &Path, name: &str) -> PathBuf {
    folder.join(format!("{name}.json5"))
}

/// Who uses a folder, unless they say so: an operator if the folder has what that takes, since it
/// can do all that a viewer can.
pub(crate) fn usual_user(folder: &Path) -> &'static str {
    if configuration_of(folder, OPERATOR).exists() {
        OPERATOR
    } else {
        VIEWER
    }
}

/// Whether a room and these vehicles can prove who they are with what is in that folder, and the rules
/// there, if it has any, are for them. `place`: how the restaurant was typed.
///
/// # Errors
/// If not: who is missing, and what to type.
pub(crate) fn check_team(
    folder: &Path,
    vehicles: &BTreeSet<String>,
    place: &Path,
) -> Result<(), Failure> {
    let (dir, place) = (folder.display(), place.display());
    if !folder.is_dir() {
        let what = format!("there is no folder {dir}");
        return Err(Failure::bad_input(what).advice(format_args!(
            "`intermezzo certs {dir} {place}` makes it, with certificates for this team"
        )));
    }
    let command = match folder.join(passwords::LIST).exists() {
        true => "passwords",
        false => "certs",
    };
    let anew =
        format!("`intermezzo {command} {dir} {place} --force` makes everything anew for this team");
    // Where the router is elsewhere, its rules are, too; and whoever has written their own knows better.
    let router = folder.join(ROUTER_FILE);
    let known = std::fs::read_to_string(&router).ok();
    let known = known.and_then(|text| team::vehicles(&text).ok());
    let missing = |name: &&str| !configuration_of(folder, name).exists();
    let names = vehicles.iter().map(String::as_str);
    if let Some(name) = std::iter::once(executor_sim::ROOM)
        .chain(names)
        .find(missing)
    {
        let failure = Failure::bad_input(format_args!("{dir} has nothing for `{name}`"));
        if name == executor_sim::ROOM {
            return Err(failure.advice(anew));
        }
        let force = match &known {
            Some(known) if known.contains(name) => " --force",
            _ => "",
        };
        return Err(failure.advice(format_args!(
            "`intermezzo {command} {dir} --vehicle {name}{force}` makes what it takes; {anew}"
        )));
    }
    let Some(known) = known else {
        return Ok(());
    };
    let router = router.display();
    let what = match vehicles.difference(&known).next() {
        Some(name) => format!("the rules in {router} do not know `{name}`"),
        None if known.first() == vehicles.first() => return Ok(()),
        None => format!(
            "by the rules in {router} goals for whoever can do them are for {}, which is none of this team",
            known.first().map_or("nobody", String::as_str),
        ),
    };
    Err(Failure::bad_input(what).advice(anew))
}

#[cfg(test)]
mod tests {
    use super::*;
    use zenoh::Config;

    /// As zenoh reads it.
    fn read(text: &str) -> Config {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.json5");
        std::fs::write(&path, text).unwrap();
        Config::from_file(&path).unwrap()
    }

    fn get(config: &Config, key: &str) -> serde_json::Value {
        serde_json::from_str(&config.get_json(key).unwrap()).unwrap()
    }

    #[test]
    fn with_certificates_and_with_passwords_the_same_is_permitted() {
        let (tls, passwords) = (read(TLS.router), read(PASSWORDS.router));
        for key in [
            "access_control/rules",
            "access_control/policies",
            "low_pass_filter",
            "scouting",
            "adminspace",
        ] {
            assert_eq!(get(&tls, key), get(&passwords, key), "{key}");
        }
        let names = |config: &Config, kind: &str| -> Vec<(String, String)> {
            let subjects = get(config, "access_control/subjects");
            let subjects = subjects.as_array().unwrap().iter();
            let words = |value: &serde_json::Value| value.as_str().unwrap().to_owned();
            subjects
                .map(|subject| (words(&subject["id"]), words(&subject[kind][0])))
                .collect()
        };
        let known: Vec<(String, String)> = TLS
            .everybody(&team::of_the_paper())
            .into_iter()
            .map(|(name, _)| (name.clone(), name))
            .collect();
        assert_eq!(names(&tls, TLS.kind), known);
        assert_eq!(names(&passwords, PASSWORDS.kind), known);
    }

    #[test]
    fn nothing_is_permitted_unless_a_rule_says_so_and_every_rule_is_about_this_project() {
        for ready in [TLS, PASSWORDS] {
            let router = read(ready.router);
            let control = get(&router, "access_control");
            assert_eq!(control["enabled"], true);
            assert_eq!(control["default_permission"], "deny");
            for rule in control["rules"].as_array().unwrap() {
                assert_eq!(rule["permission"], "allow", "{rule}");
                for key in rule["key_exprs"].as_array().unwrap() {
                    assert!(key.as_str().unwrap().starts_with("intermezzo/"), "{rule}");
                }
            }
            let router = (ROUTER.to_owned(), ready.router.to_owned());
            let everybody = ready.everybody(&team::of_the_paper()).into_iter();
            for (name, text) in std::iter::once(router).chain(everybody) {
                let config = read(&text);
                for key in [
                    "scouting/multicast/enabled",
                    "scouting/gossip/enabled",
                    "adminspace/enabled",
                ] {
                    assert_eq!(get(&config, key), false, "{name}: {key}");
                }
                let size = get(&config, "transport/link/rx/max_message_size");
                assert_eq!(size, 16 * 1024 * 1024, "{name}");
            }
        }
    }

    #[test]
    fn whoever_may_look_may_look_at_everything() {
        let rules = get(&read(TLS.router), "access_control/rules");
        for rule in rules.as_array().unwrap() {
            if rule["id"] == "look" || rule["id"] == "see" {
                for view in agent_link::View::ALL {
                    let key = format!("intermezzo/*/*/{}", view.name());
                    let keys = rule["key_exprs"].as_array().unwrap();
                    assert!(keys.contains(&serde_json::json!(key)), "{key}");
                }
            }
        }
    }

    #[test]
    fn the_ready_rules_of_a_team_are_those_that_are_written_for_the_built_in_restaurant() {
        for ready in [TLS, PASSWORDS] {
            let vehicles = team::of_the_paper();
            let written = team::with_vehicles(ready.router, ready.kind, &vehicles).unwrap();
            assert_eq!(written, ready.router);
            assert_eq!(team::vehicles(ready.router), Ok(vehicles));
        }
    }

    #[test]
    fn a_team_is_told_what_its_folder_lacks_and_what_to_type() {
        let parent = tempfile::tempdir().unwrap();
        let folder = parent.path().join("keys");
        let place = Path::new("cafe");
        let names = |names: &[&str]| -> BTreeSet<String> {
            names.iter().map(|name| (*name).to_owned()).collect()
        };
        let lacks = |vehicles: &[&str]| match check_team(&folder, &names(vehicles), place) {
            Ok(()) => String::new(),
            Err(failure) => format!("{}; {}", failure.what, failure.advice.unwrap_or_default()),
        };
        let touch = |name: &str| std::fs::write(folder.join(name), TLS.router).unwrap();
        assert!(lacks(&["k1"]).contains("certs"), "{}", lacks(&["k1"]));
        std::fs::create_dir(&folder).unwrap();
        assert!(lacks(&["k1"]).contains("nothing for `room`"));
        for name in ["room.json5", "k1.json5", "k2.json5"] {
            touch(name);
        }
        assert_eq!(lacks(&["k1", "k2"]), "", "the router is elsewhere");
        touch(ROUTER_FILE);
        assert_eq!(lacks(&["k1", "k2"]), "");
        assert!(lacks(&["k1", "k3"]).contains("--vehicle k3 --force`"));
        assert!(lacks(&["k1", "k9"]).contains("--vehicle k9`"));
        assert!(lacks(&["k2"]).contains("are for k1, which is none of this team"));
        touch("k9.json5");
        assert!(lacks(&["k1", "k9"]).contains("do not know `k9`"));
        std::fs::write(folder.join(passwords::LIST), "").unwrap();
        assert!(lacks(&["k1", "k8"]).contains("intermezzo passwords "));
    }

    #[test]
    fn no_ready_configuration_has_a_secret_in_it() {
        for (name, text) in PASSWORDS.everybody(&team::of_the_paper()) {
            let user = get(&read(&text), "transport/auth/usrpwd");
            assert_eq!(user["user"], name);
            assert_eq!(user["password"], passwords::PLACE);
        }
    }
}
