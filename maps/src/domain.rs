//! Levels of planning: a domain with its execution model, and whether levels fit together.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use agent_core::language::{LanguageError, excerpt, parse_domain_strictly};
use agent_core::model::{Domain, ExecutionModel, Symbol};

use crate::Finding;
use crate::execution_model::{place_of, read_model};
use crate::restaurant::Restaurant;

/// What one agent plans with. Whoever has one knows that it was checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// What can be done, and how tasks are decomposed.
    pub domain: Domain,
    /// How long actions take, and how they are suspended and resumed.
    pub model: ExecutionModel,
}

/// Reads the level `name` of a directory: `area` is `area.hddl` and `area.toml`.
pub fn read_level(dir: &Path, name: &str) -> Result<Level, Vec<Finding>> {
    let hddl = dir.join(format!("{name}.hddl"));
    let toml = dir.join(format!("{name}.toml"));
    match (read_text(&hddl), read_text(&toml)) {
        (Ok(hddl_text), Ok(toml_text)) => {
            let names = [hddl, toml].map(|path| path.display().to_string());
            level_from_texts(&hddl_text, &toml_text, [&names[0], &names[1]])
        }
        (hddl_text, toml_text) => {
            let mut findings = Vec::new();
            match hddl_text {
                Ok(text) => findings.extend(domain_findings(&hddl, &text)),
                Err(finding) => findings.push(finding),
            }
            findings.extend(toml_text.err());
            Err(findings)
        }
    }
}

/// Reads a level from the texts of its domain and its execution model, which findings call by
/// `names`.
pub fn level_from_texts(
    hddl: &str,
    toml: &str,
    [hddl_name, toml_name]: [&str; 2],
) -> Result<Level, Vec<Finding>> {
    let domain =
        parse_domain_strictly(hddl).map_err(|errors| language_findings(hddl_name, hddl, errors));
    let model = read_model(toml_name, toml, domain.as_ref().ok());
    match (domain, model) {
        (Ok(domain), Ok(model)) => Ok(Level { domain, model }),
        (domain, model) => {
            let findings = [domain.err(), model.err()];
            Err(findings.into_iter().flatten().flatten().collect())
        }
    }
}

/// Checks all levels of a directory, each on its own and whether they fit together, and says which
/// they are. If there is a `room.toml`, that too, with its map.
pub fn check_domain_dir(dir: &Path) -> Result<Vec<String>, Vec<Finding>> {
    let names = level_names(dir).map_err(|finding| vec![finding])?;
    let mut findings = Vec::new();
    let mut levels = Vec::new();
    for name in &names {
        match read_level(dir, name) {
            Ok(level) => levels.push((name.as_str(), level)),
            Err(found) => findings.extend(found),
        }
    }
    // What a level that cannot be read would have executed is not known.
    if findings.is_empty() {
        for (name, level) in &levels {
            let others = levels.iter().filter(|(other, _)| other != name);
            let others: Vec<&Domain> = others.map(|(_, level)| &level.domain).collect();
            let file = dir.join(format!("{name}.hddl"));
            findings.extend(unexecuted(&file, level, &others));
        }
    }
    if findings.is_empty() && dir.join("room.toml").exists() {
        findings.extend(Restaurant::read(dir).err().unwrap_or_default());
    }
    if findings.is_empty() {
        Ok(names)
    } else {
        Err(findings)
    }
}

/// Actions that nobody can execute: neither a child agent, as a task of its level, nor a robot.
fn unexecuted(file: &Path, level: &Level, others: &[&Domain]) -> Vec<Finding> {
    // A resuming action goes down as "resume", so that no executor needs to know it by name.
    let resuming: BTreeSet<&Symbol> = level
        .model
        .actions
        .values()
        .filter_map(|action| Some(&action.suspension.as_ref()?.resume.name))
        .collect();
    let text = read_text(file).unwrap_or_default();
    let mut findings = Vec::new();
    for operator in level.domain.operators.values() {
        let name = &operator.name;
        let arity = operator.parameters.len();
        let performed = level.model.actions.get(name);
        let performed = performed.is_some_and(|action| action.perform.is_some());
        let arities = || others.iter().filter_map(|other| other.tasks.get(name));
        if performed || resuming.contains(name) || arities().any(|task| task.len() == arity) {
            continue;
        }
        let hint = match arities().next() {
            Some(task) => format!(
                "the task of that name takes {} argument(s), not {arity}",
                task.len()
            ),
            None => "write a task of that name at another level, or `perform` in the execution \
                     model"
                .to_owned(),
        };
        let at = place_of_action(&text, name);
        findings.push(Finding {
            file: file.display().to_string(),
            place: at.map_or_else(String::new, |(line, column)| format!("{line}:{column}")),
            message: format!("nobody can execute action `{name}`: {hint}"),
            excerpt: at
                .and_then(|(line, column)| excerpt(&text, line, column))
                .unwrap_or_default(),
        });
    }
    findings
}

/// Where an action is declared.
fn place_of_action(text: &str, name: &Symbol) -> Option<(usize, usize)> {
    let keyword = "(:action";
    let text = text.to_ascii_lowercase();
    let found = text.match_indices(keyword).find(|(at, _)| {
        let after = text[at + keyword.len()..].split_whitespace().next();
        after.is_some_and(|word| *name == *word.trim_end_matches(')'))
    });
    found.map(|(at, _)| place_of(&text, at))
}

/// The levels of a directory, by the names of their domains, in order.
fn level_names(dir: &Path) -> Result<Vec<String>, Finding> {
    let finding = |message: String| Finding {
        file: dir.display().to_string(),
        place: String::new(),
        message,
        excerpt: String::new(),
    };
    let unreadable = |error: std::io::Error| finding(format!("cannot be read: {error}"));
    let mut names = Vec::new();
    for entry in std::fs::read_dir(dir).map_err(unreadable)? {
        let path: PathBuf = entry.map_err(unreadable)?.path();
        if path.extension().is_none_or(|extension| extension != "hddl") {
            continue;
        }
        let stem = path.file_stem().and_then(|stem| stem.to_str());
        match stem {
            Some(stem) => names.push(stem.to_owned()),
            None => return Err(finding(format!("{} is no readable name", path.display()))),
        }
    }
    if names.is_empty() {
        let message = "there is no domain here: a level is NAME.hddl with NAME.toml beside it";
        return Err(finding(message.to_owned()));
    }
    names.sort();
    Ok(names)
}

fn read_text(path: &Path) -> Result<String, Finding> {
    std::fs::read_to_string(path).map_err(|error| {
        let missing = error.kind() == std::io::ErrorKind::NotFound;
        let is_model = path
            .extension()
            .is_some_and(|extension| extension == "toml");
        let message = if missing && is_model {
            "is missing; write it beside the domain, to say how long each action takes and how it \
             is suspended"
                .to_owned()
        } else {
            format!("cannot be read: {error}")
        };
        Finding {
            file: path.display().to_string(),
            place: String::new(),
            message,
            excerpt: String::new(),
        }
    })
}

fn domain_findings(file: &Path, text: &str) -> Vec<Finding> {
    let errors = parse_domain_strictly(text).err().unwrap_or_default();
    language_findings(&file.display().to_string(), text, errors)
}

fn language_findings(file: &str, text: &str, errors: Vec<LanguageError>) -> Vec<Finding> {
    errors
        .into_iter()
        .map(|error| Finding {
            file: file.to_owned(),
            place: format!("{}:{}", error.line, error.column),
            excerpt: excerpt(text, error.line, error.column).unwrap_or_default(),
            message: error.message,
        })
        .collect()
}

#[cfg(test)]
mod tests;
