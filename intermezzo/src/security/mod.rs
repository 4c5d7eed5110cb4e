//! Who may do what with a robot: the ready configurations of `security/`, and the folder in which
//! they lie with the certificates or passwords that they name.

pub(crate) mod certificates;
pub(crate) mod folder;
pub(crate) mod passwords;

use std::path::{Path, PathBuf};

/// Whom the ready configurations know. The router is known by what it proves, too.
pub(crate) const ROUTER: &str = "router";
pub(crate) const OPERATOR: &str = "operator";
pub(crate) const VIEWER: &str = "viewer";
/// `intermezzo up` on a router elsewhere.
pub(crate) const SUPERVISOR: &str = "supervisor";

/// The ready configurations of one way to prove who one is.
pub(crate) struct Ready {
    pub(crate) router: &'static str,
    /// Of each client, by name.
    pub(crate) clients: [(&'static str, &'static str); 7],
}

macro_rules! ready {
    ($way:literal) => {
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
        }
    };
}

/// Everybody has a certificate.
pub(crate) const TLS: Ready = ready!("tls");

/// Everybody has a password.
pub(crate) const PASSWORDS: Ready = ready!("passwords");

impl Ready {
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
            .clients
            .iter()
            .map(|(name, _)| ((*name).to_owned(), (*name).to_owned()))
            .collect();
        assert_eq!(names(&tls, "cert_common_names"), known);
        assert_eq!(names(&passwords, "usernames"), known);
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
            for (name, text) in [(ROUTER, ready.router)].iter().chain(&ready.clients) {
                let config = read(text);
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
    fn no_ready_configuration_has_a_secret_in_it() {
        for (name, text) in PASSWORDS.clients {
            let user = get(&read(text), "transport/auth/usrpwd");
            assert_eq!(user["user"], name);
            assert_eq!(user["password"], passwords::PLACE);
        }
    }
}
