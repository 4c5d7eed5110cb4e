//! The execution model of a level, as its author writes it: `area.toml` beside `area.hddl`.

use std::collections::BTreeMap;

use agent_core::language::{
    LanguageError, check_model, excerpt, nearest, parse_effects, parse_literal, parse_number,
    parse_parameter, parse_pattern,
};
use agent_core::model::{
    ActionModel, Arising, Clause, CostRule, Domain, ExecutionModel, Number, Parameter, Pattern,
    Projection, Suspension, Symbol, TaskModel,
};
use serde::Deserialize;
use toml::{Spanned, Value};

use crate::Finding;

/// Text with its place in the file.
type Text = Spanned<String>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ModelEntry {
    #[serde(default)]
    observable: Vec<Text>,
    #[serde(default)]
    action: BTreeMap<Text, ActionEntry>,
    #[serde(default)]
    task: BTreeMap<Text, TaskEntry>,
    #[serde(default)]
    projection: Vec<Spanned<ProjectionEntry>>,
    #[serde(default)]
    shared: Vec<Text>,
    #[serde(default)]
    asked: Vec<Text>,
    #[serde(default)]
    arising: Vec<Spanned<ArisingEntry>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ActionEntry {
    duration_s: Option<Spanned<Value>>,
    timeout_s: Option<Spanned<Value>>,
    repeatable: Option<bool>,
    achieves_state: Option<bool>,
    #[serde(default)]
    protected: Vec<Text>,
    #[serde(default)]
    goal_states: Vec<Text>,
    #[serde(default)]
    resources: Vec<String>,
    suspension: Option<SuspensionEntry>,
    perform: Option<Text>,
    map_of: Option<Text>,
    #[serde(default)]
    cost: Vec<CostEntry>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CostEntry {
    #[serde(default)]
    variables: Vec<Text>,
    given: Vec<Text>,
    cost: Spanned<Value>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SuspensionEntry {
    /// Required, so that nobody forgets what the executor leaves behind: `[]` says "nothing".
    effect: Spanned<Vec<Text>>,
    resume: Text,
    rollback: Option<Text>,
    reach: Option<Text>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TaskEntry {
    #[serde(default)]
    variables: Vec<Text>,
    #[serde(default)]
    given: Vec<Text>,
    estimate: Spanned<Value>,
    #[serde(default)]
    establishes: Vec<Text>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ProjectionEntry {
    #[serde(default)]
    variables: Vec<Text>,
    when: Vec<Text>,
    then: Text,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ArisingEntry {
    #[serde(default)]
    variables: Vec<Text>,
    when: Vec<Text>,
    task: Text,
}

/// Reads an execution model and checks it against its domain.
///
/// Without a domain, because that has faults of its own, only what needs none is checked.
pub(crate) fn read_model(
    file: &str,
    text: &str,
    domain: Option<&Domain>,
) -> Result<ExecutionModel, Vec<Finding>> {
    let mut reader = Reader {
        file,
        text,
        places: BTreeMap::new(),
        findings: Vec::new(),
    };
    let model = match (toml::from_str::<ModelEntry>(text), domain) {
        (Ok(entry), Some(domain)) => {
            let model = reader.model(entry, domain);
            for error in check_model(domain, &model) {
                let at = reader.place_of(error.key());
                let message = error.to_string();
                let key_again = format!("{}: ", error.key());
                let message = message.strip_prefix(&key_again).unwrap_or(&message);
                reader.fault(at, error.key(), message);
            }
            model
        }
        (Ok(_), None) => ExecutionModel::default(),
        (Err(error), _) => {
            reader.malformed(&error);
            ExecutionModel::default()
        }
    };
    if reader.findings.is_empty() {
        return Ok(model);
    }
    reader.findings.sort_by_key(|(at, _)| *at);
    let findings = reader.findings.into_iter().map(|(_, finding)| finding);
    Err(findings.collect())
}

/// The line and the column of a byte, counted from 1.
pub(crate) fn place_of(text: &str, at: usize) -> (usize, usize) {
    let before = text.get(..at).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let line = before.matches('\n').count() + 1;
    let column = before[line_start..].chars().count() + 1;
    (line, column)
}

fn lower_case(names: &[String]) -> Vec<Symbol> {
    let names = names.iter();
    names
        .map(|name| Symbol::from(name.to_lowercase()))
        .collect()
}

/// Reads entry by entry; what cannot be read is a finding and is left out.
struct Reader<'t> {
    file: &'t str,
    text: &'t str,
    /// Where each key stands that a check may speak of.
    places: BTreeMap<String, usize>,
    /// With the byte at which each stands.
    findings: Vec<(usize, Finding)>,
}

impl Reader<'_> {
    fn fault(&mut self, at: usize, key: &str, message: &str) {
        let (line, column) = place_of(self.text, at);
        let finding = Finding {
            file: self.file.to_owned(),
            place: format!("{line}:{column}"),
            message: format!("{key}: {message}"),
            excerpt: excerpt(self.text, line, column).unwrap_or_default(),
        };
        self.findings.push((at, finding));
    }

    /// What the TOML reader did not like: bad TOML, an unknown key, a value of the wrong sort.
    fn malformed(&mut self, error: &toml::de::Error) {
        let at = error.span().map_or(0, |span| span.start);
        // The table that it is in, as the last header above says.
        let table = self
            .text
            .get(..at)
            .unwrap_or_default()
            .lines()
            .rev()
            .find_map(|line| line.trim_start().strip_prefix('['))
            .map(|header| header.trim_matches(['[', ']', ' ']).to_owned());
        let key = table.unwrap_or_else(|| "file".to_owned());
        self.fault(at, &key, error.message());
    }

    fn place_of(&self, key: &str) -> usize {
        let mut key = key;
        loop {
            match (self.places.get(key), key.rsplit_once('.')) {
                (Some(at), _) => return *at,
                (None, Some((above, _))) => key = above,
                (None, None) => return 0,
            }
        }
    }

    fn remember(&mut self, key: &str, at: usize) {
        self.places.entry(key.to_owned()).or_insert(at);
    }

    fn model(&mut self, entry: ModelEntry, domain: &Domain) -> ExecutionModel {
        let mut model = ExecutionModel {
            observable: self.names("observable", entry.observable),
            shared: self.names("shared", entry.shared),
            asked: self.names("asked", entry.asked),
            ..ExecutionModel::default()
        };
        for (name, action) in entry.action {
            let symbol = Symbol::from(name.get_ref().to_lowercase());
            let key = format!("action.{symbol}");
            self.remember(&key, name.span().start);
            let Some(operator) = domain.operators.get(&symbol) else {
                let known = domain.operators.keys().map(Symbol::as_str);
                self.unknown(&key, &name, "an action", nearest(symbol.as_str(), known));
                continue;
            };
            let action = self.action(&key, action, &operator.parameters, domain);
            if model.actions.insert(symbol, action).is_some() {
                self.fault(
                    name.span().start,
                    &key,
                    "is there already, in other letters",
                );
            }
        }
        for (name, task) in entry.task {
            let symbol = Symbol::from(name.get_ref().to_lowercase());
            let key = format!("task.{symbol}");
            self.remember(&key, name.span().start);
            let Some(parameters) = domain.tasks.get(&symbol) else {
                let known = domain.tasks.keys().map(Symbol::as_str);
                self.unknown(&key, &name, "a task", nearest(symbol.as_str(), known));
                continue;
            };
            if let Some(task) = self.task(&key, &task, parameters) {
                model.tasks.insert(symbol, task);
            }
        }
        for (index, projection) in entry.projection.into_iter().enumerate() {
            let key = format!("projection.{}", index + 1);
            self.remember(&key, projection.span().start);
            model
                .projections
                .extend(self.projection(&key, projection.get_ref()));
        }
        for (index, arising) in entry.arising.into_iter().enumerate() {
            let key = format!("arising.{}", index + 1);
            self.remember(&key, arising.span().start);
            model.arising.extend(self.arising(&key, arising.get_ref()));
        }
        model
    }

    fn names(&mut self, key: &str, texts: Vec<Text>) -> Vec<Symbol> {
        if let Some(first) = texts.first() {
            self.remember(key, first.span().start);
        }
        let names = texts.into_iter();
        names
            .map(|text| Symbol::from(text.get_ref().to_lowercase()))
            .collect()
    }

    fn unknown(&mut self, key: &str, name: &Text, what: &str, near: Option<&str>) {
        let hint = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
        let message = format!("`{}` is not {what} of the domain{hint}", name.get_ref());
        self.fault(name.span().start, key, &message);
    }

    fn action(
        &mut self,
        key: &str,
        entry: ActionEntry,
        parameters: &[Parameter],
        domain: &Domain,
    ) -> ActionModel {
        let sub = |part: &str| format!("{key}.{part}");
        let fallback = ActionModel::default();
        let mut number = |part: &str, value: Option<Spanned<Value>>| {
            value.and_then(|value| self.number(&sub(part), &value, parameters))
        };
        let duration_s = number("duration_s", entry.duration_s);
        let timeout_s = number("timeout_s", entry.timeout_s);
        let suspension = entry.suspension.and_then(|suspension| {
            self.suspension(&sub("suspension"), &suspension, parameters, domain)
        });
        let costs = entry.cost.iter();
        let costs = costs
            .filter_map(|rule| self.cost(&sub("cost"), rule, parameters))
            .collect();
        ActionModel {
            costs,
            duration_s,
            timeout_s,
            repeatable: entry.repeatable.unwrap_or(fallback.repeatable),
            achieves_state: entry.achieves_state.unwrap_or(fallback.achieves_state),
            protected: self.literals(&sub("protected"), &entry.protected, parameters),
            goal_states: self.literals(&sub("goal_states"), &entry.goal_states, parameters),
            resources: lower_case(&entry.resources),
            suspension,
            perform: entry
                .perform
                .and_then(|text| self.pattern(&sub("perform"), &text, parameters)),
            map_of: entry
                .map_of
                .and_then(|text| self.parameter_index(&sub("map_of"), &text, parameters)),
        }
    }

    fn cost(&mut self, key: &str, entry: &CostEntry, parameters: &[Parameter]) -> Option<CostRule> {
        let sub = |part: &str| format!("{key}.{part}");
        let parameters = self.variables(&sub("variables"), &entry.variables, parameters);
        Some(CostRule {
            given: self.literals(&sub("given"), &entry.given, &parameters),
            cost: self.number(&sub("cost"), &entry.cost, &parameters)?,
            parameters,
        })
    }

    fn suspension(
        &mut self,
        key: &str,
        entry: &SuspensionEntry,
        parameters: &[Parameter],
        domain: &Domain,
    ) -> Option<Suspension> {
        let sub = |part: &str| format!("{key}.{part}");
        let effect_key = sub("effect");
        self.remember(&effect_key, entry.effect.span().start);
        // One text at a time, so that each fault is found at its own.
        let mut effect = Some(agent_core::model::Effect::default());
        for text in entry.effect.get_ref() {
            let found = parse_effects(&[text.get_ref()], parameters, domain);
            match (self.read(&effect_key, text, found), &mut effect) {
                (Some(more), Some(effect)) => {
                    effect.remove.extend(more.remove);
                    effect.add.extend(more.add);
                }
                _ => effect = None,
            }
        }
        let resume = self.pattern(&sub("resume"), &entry.resume, parameters);
        let mut optional = |part: &str, text: &Option<Text>| {
            let text = text.as_ref()?;
            self.pattern(&sub(part), text, parameters)
        };
        let rollback = optional("rollback", &entry.rollback);
        let reach = optional("reach", &entry.reach);
        // Half a suspension would be found wanting for what is a fault already.
        Some(Suspension {
            effect: effect?,
            resume: resume?,
            rollback,
            reach,
        })
    }

    fn task(
        &mut self,
        key: &str,
        entry: &TaskEntry,
        parameters: &[Parameter],
    ) -> Option<TaskModel> {
        let sub = |part: &str| format!("{key}.{part}");
        let parameters = self.variables(&sub("variables"), &entry.variables, parameters);
        Some(TaskModel {
            given: self.literals(&sub("given"), &entry.given, &parameters),
            establishes: self.patterns(&sub("establishes"), &entry.establishes, &parameters),
            estimate: self.number(&sub("estimate"), &entry.estimate, &parameters)?,
            parameters,
        })
    }

    fn projection(&mut self, key: &str, entry: &ProjectionEntry) -> Option<Projection> {
        let sub = |part: &str| format!("{key}.{part}");
        let parameters = self.variables(&sub("variables"), &entry.variables, &[]);
        Some(Projection {
            when: self.literals(&sub("when"), &entry.when, &parameters),
            then: self.pattern(&sub("then"), &entry.then, &parameters)?,
            parameters,
        })
    }

    fn arising(&mut self, key: &str, entry: &ArisingEntry) -> Option<Arising> {
        let sub = |part: &str| format!("{key}.{part}");
        let parameters = self.variables(&sub("variables"), &entry.variables, &[]);
        Some(Arising {
            when: self.literals(&sub("when"), &entry.when, &parameters),
            task: self.pattern(&sub("task"), &entry.task, &parameters)?,
            parameters,
        })
    }

    /// The parameters that are there already, then those that the texts declare.
    fn variables(&mut self, key: &str, texts: &[Text], parameters: &[Parameter]) -> Vec<Parameter> {
        let mut out = parameters.to_vec();
        for text in texts {
            let Some(parameter) = self.read(key, text, parse_parameter(text.get_ref())) else {
                continue;
            };
            if out.iter().any(|known| known.name == parameter.name) {
                let message = format!("`{}` is there already", parameter.name);
                self.fault(text.span().start, key, &message);
                continue;
            }
            out.push(parameter);
        }
        out
    }

    fn literals(&mut self, key: &str, texts: &[Text], parameters: &[Parameter]) -> Vec<Clause> {
        texts
            .iter()
            .filter_map(|text| self.read(key, text, parse_literal(text.get_ref(), parameters)))
            .collect()
    }

    fn patterns(&mut self, key: &str, texts: &[Text], parameters: &[Parameter]) -> Vec<Pattern> {
        texts
            .iter()
            .filter_map(|text| self.pattern(key, text, parameters))
            .collect()
    }

    fn pattern(&mut self, key: &str, text: &Text, parameters: &[Parameter]) -> Option<Pattern> {
        self.read(key, text, parse_pattern(text.get_ref(), parameters))
    }

    /// A number as text with functions in it, or simply as a number.
    fn number(
        &mut self,
        key: &str,
        value: &Spanned<Value>,
        parameters: &[Parameter],
    ) -> Option<Number> {
        let written = match value.get_ref() {
            Value::String(text) => text.clone(),
            Value::Integer(number) => number.to_string(),
            Value::Float(number) => number.to_string(),
            other => {
                let message = format!(
                    "expected a number such as `30` or `\"(length ?arc)\"`, found {}",
                    other.type_str()
                );
                self.fault(value.span().start, key, &message);
                return None;
            }
        };
        let text = Spanned::new(value.span(), written);
        self.read(key, &text, parse_number(text.get_ref(), parameters))
    }

    fn parameter_index(
        &mut self,
        key: &str,
        text: &Text,
        parameters: &[Parameter],
    ) -> Option<usize> {
        let name = text.get_ref().to_lowercase();
        let names = || parameters.iter().map(|parameter| parameter.name.as_str());
        let found = names().position(|known| known == name);
        if found.is_none() {
            let known: Vec<&str> = names().collect();
            let message = format!(
                "`{name}` is not a parameter of the action; those are {}",
                known.join(", ")
            );
            self.fault(text.span().start, key, &message);
        }
        found
    }

    /// Notes where a text stands, and what is wrong in it.
    fn read<T>(&mut self, key: &str, text: &Text, found: Result<T, LanguageError>) -> Option<T> {
        self.remember(key, text.span().start);
        let error = match found {
            Ok(value) => return Some(value),
            Err(error) => error,
        };
        let at = self.inside(text, &error);
        self.fault(at, key, &error.message);
        None
    }

    /// Where in the file a fault inside a text stands. If the text is written with escapes or on
    /// several lines, that is where it begins.
    fn inside(&self, text: &Text, error: &LanguageError) -> usize {
        let written = self.text.get(text.span()).unwrap_or_default();
        let inner = written.get(1..written.len().saturating_sub(1));
        if error.line > 1 || inner != Some(text.get_ref()) {
            return text.span().start;
        }
        let before: usize = text
            .get_ref()
            .chars()
            .take(error.column - 1)
            .map(char::len_utf8)
            .sum();
        text.span().start + 1 + before
    }
}
