//! Reading scenario files, with everything that is wrong with them.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use agent_core::language::{nearest, parse_fact_change, parse_tasks};
use agent_core::model::{Atom, FactChange, Symbol, Time};
use agent_core::protocol::{Command, GoalId, GoalRequest, Urgency};
use maps::{Finding, Site};
use toml::de::{DeTable, DeValue};

use super::{Scenario, ScenarioEvent, What, When};

/// What an event may say of itself.
const KEYS: [&str; 17] = [
    "at_s",
    "while_on",
    "while_doing",
    "once",
    "say",
    "goal",
    "emergency",
    "id",
    "to",
    "priority",
    "deadline_s",
    "door",
    "state",
    "fact",
    "suspend",
    "resume",
    "cancel",
];
/// Those that make something happen; an event has one of them at most.
const DEEDS: [&str; 7] = [
    "goal",
    "emergency",
    "door",
    "fact",
    "suspend",
    "resume",
    "cancel",
];

impl Scenario {
    /// Reads a scenario for that place. `file` is only for the findings.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub(crate) fn from_text(file: &str, text: &str, site: &Site) -> Result<Self, Vec<Finding>> {
        let mut reader = Reader {
            file,
            text,
            site,
            names: BTreeSet::new(),
            findings: Vec::new(),
        };
        let (table, errors) = DeTable::parse_recoverable(text);
        for error in errors {
            reader.fault(error.span().unwrap_or(0..0), error.message());
        }
        let events = reader.events(table.get_ref());
        if reader.findings.is_empty() {
            Ok(Self { events })
        } else {
            Err(reader.findings)
        }
    }
}

struct Reader<'a> {
    file: &'a str,
    text: &'a str,
    site: &'a Site,
    /// Of goals so far.
    names: BTreeSet<GoalId>,
    findings: Vec<Finding>,
}

/// The keys of one event with their values and where those stand.
type Fields<'a> = BTreeMap<&'a str, (&'a DeValue<'a>, Range<usize>)>;

impl Reader<'_> {
    fn line(&self, span: &Range<usize>) -> usize {
        let before = self.text.get(..span.start).unwrap_or_default();
        before.matches('\n').count() + 1
    }

    fn fault(&mut self, span: Range<usize>, message: impl Into<String>) {
        let place = self.line(&span).to_string();
        self.findings.push(Finding {
            file: self.file.to_owned(),
            place,
            message: message.into(),
            excerpt: String::new(),
        });
    }

    fn events(&mut self, table: &DeTable<'_>) -> Vec<ScenarioEvent> {
        for (key, _) in table.iter() {
            if key.get_ref() != "event" {
                let message = format!(
                    "`{}` is unknown: a scenario has only [[event]]s",
                    key.get_ref()
                );
                self.fault(key.span(), message);
            }
        }
        let Some(events) = table.get("event") else {
            if self.findings.is_empty() {
                self.fault(0..0, "there is no [[event]]");
            }
            return Vec::new();
        };
        let Some(array) = events.get_ref().as_array() else {
            self.fault(events.span(), "events are written [[event]]");
            return Vec::new();
        };
        let mut read = Vec::new();
        for event in array.iter() {
            match event.get_ref().as_table() {
                Some(table) => read.extend(self.event(table, event.span())),
                None => self.fault(event.span(), "an event is a table, written [[event]]"),
            }
        }
        read
    }

    fn event(&mut self, table: &DeTable<'_>, span: Range<usize>) -> Option<ScenarioEvent> {
        let faults_before = self.findings.len();
        let mut fields: Fields<'_> = BTreeMap::new();
        for (key, value) in table.iter() {
            let name: &str = key.get_ref();
            if KEYS.contains(&name) {
                fields.insert(name, (value.get_ref(), value.span()));
            } else {
                let hint = nearest(name, KEYS).map_or_else(
                    || format!("an event has {}", KEYS.join(", ")),
                    |near| format!("did you mean `{near}`?"),
                );
                self.fault(key.span(), format!("`{name}` is unknown: {hint}"));
            }
        }
        let when = self.when(&mut fields);
        let say = self.text_of(&mut fields, "say");
        let what = self.what(&mut fields, &span);
        for (name, (_, span)) in fields {
            let belongs_to = match name {
                "state" => "door",
                "id" | "to" | "priority" | "deadline_s" => "goal or emergency",
                // The others are taken out above, or reported as one deed too many.
                _ => continue,
            };
            self.fault(span, format!("`{name}` stands without a {belongs_to}"));
        }
        if what.is_none() && say.is_none() && self.findings.len() == faults_before {
            self.fault(
                span.clone(),
                format!("nothing happens: add one of {}, or say", DEEDS.join(", ")),
            );
        }
        (self.findings.len() == faults_before).then(|| ScenarioEvent {
            line: self.line(&span),
            when,
            say,
            what,
        })
    }

    fn when(&mut self, fields: &mut Fields<'_>) -> When {
        let at = self.number_of(fields, "at_s");
        let [arc, doing, once] =
            ["while_on", "while_doing", "once"].map(|name| self.text_of_spanned(fields, name));
        let given = [
            at.as_ref().map(|(_, span)| span),
            arc.as_ref().map(|(_, span)| span),
            doing.as_ref().map(|(_, span)| span),
            once.as_ref().map(|(_, span)| span),
        ];
        if let [first, _, ..] = given.into_iter().flatten().collect::<Vec<_>>().as_slice() {
            let message = "an event has one of `at_s`, `while_on`, `while_doing` and `once`";
            self.fault((*first).clone(), message);
            return When::Next;
        }
        if let Some((at_s, span)) = at {
            if at_s >= 0.0 {
                return When::At(Time::from_secs(at_s));
            }
            self.fault(span, "`at_s` counts from when the robot is ready");
        }
        if let Some((arc, span)) = arc {
            if self.site.passage(&arc).is_none() {
                let arcs = self.site.passages().map(|arc| arc.name().as_str());
                let message = unknown("arc", &arc, nearest(&arc, arcs));
                self.fault(span, message);
            }
            return When::WhileOn(arc.into());
        }
        if let Some((words, span)) = doing {
            match words.split_whitespace().collect::<Vec<_>>().as_slice() {
                [agent, action] => {
                    return When::WhileDoing {
                        agent: Symbol::from(*agent),
                        action: Symbol::from(*action),
                    };
                }
                _ => self.fault(
                    span,
                    "`while_doing` is an agent and an action, such as \"k3 grasp\"",
                ),
            }
        }
        if let Some((text, span)) = once {
            match parse_fact_change(&text) {
                Ok(FactChange::Add(fact)) => return When::Once(fact),
                Ok(_) => self.fault(span, "`once` is a fact, such as \"(served ann cola)\""),
                Err(error) => self.fault(span, error.to_string()),
            }
        }
        When::Next
    }

    fn what(&mut self, fields: &mut Fields<'_>, span: &Range<usize>) -> Option<What> {
        let deeds: Vec<&str> = DEEDS
            .into_iter()
            .filter(|deed| fields.contains_key(deed))
            .collect();
        if deeds.len() > 1 {
            let message = format!("an event does one thing, not {}", deeds.join(" and "));
            self.fault(span.clone(), message);
            for deed in deeds {
                fields.remove(deed);
            }
            return None;
        }
        let deed = *deeds.first()?;
        let (text, span) = self.text_of_spanned(fields, deed)?;
        match deed {
            "goal" => self.goal(fields, Urgency::Normal, &text, span),
            "emergency" => self.goal(fields, Urgency::Emergency, &text, span),
            "door" => self.door(fields, &text, span),
            "fact" => match parse_fact_change(&text) {
                Ok(fact) => Some(What::Fact(fact)),
                Err(error) => {
                    self.fault(span, error.to_string());
                    None
                }
            },
            _ => {
                let goal = GoalId::from(text.as_str());
                if !self.names.contains(&goal) {
                    let known = self.names.iter().map(GoalId::as_str);
                    let message = unknown("goal", &text, nearest(&text, known));
                    self.fault(
                        span,
                        format!("{message}: it needs an `id` in an event before this one"),
                    );
                }
                Some(What::Command(match deed {
                    "suspend" => Command::Suspend(goal),
                    "resume" => Command::Resume(goal),
                    _ => Command::Cancel(goal),
                }))
            }
        }
    }

    fn goal(
        &mut self,
        fields: &mut Fields<'_>,
        urgency: Urgency,
        text: &str,
        span: Range<usize>,
    ) -> Option<What> {
        let tasks = match parse_tasks(text) {
            Ok(tasks) => tasks,
            Err(error) => {
                self.fault(span.clone(), error.to_string());
                Vec::new()
            }
        };
        let id = match self.text_of_spanned(fields, "id") {
            Some((id, span)) => {
                if id.is_empty() || id.contains(char::is_whitespace) {
                    self.fault(span.clone(), "an id is one word");
                }
                if self.names.contains(&*id) {
                    self.fault(span, format!("another goal is named `{id}`"));
                }
                id.into()
            }
            None => self.new_name(urgency),
        };
        self.names.insert(id.clone());
        let priority = match self.number_of(fields, "priority") {
            Some((number, _)) if number.fract() == 0.0 && number.abs() < 1e9 => number as i32,
            Some((_, span)) => {
                self.fault(span, "`priority` is a whole number");
                0
            }
            None => 0,
        };
        let deadline = match self.number_of(fields, "deadline_s") {
            Some((seconds, _)) if seconds > 0.0 => Some(Time::from_secs(seconds)),
            Some((_, span)) => {
                self.fault(span, "`deadline_s` is more than nothing");
                None
            }
            None => None,
        };
        let to = self.text_of(fields, "to").map(Symbol::from);
        Some(What::Goal {
            request: GoalRequest {
                id: Some(id),
                tasks,
                urgency,
                priority,
                deadline,
            },
            to,
        })
    }

    /// A name for a goal that has none: what becomes of it has to be told from the others'.
    fn new_name(&self, urgency: Urgency) -> GoalId {
        let stem = match urgency {
            Urgency::Normal => "goal",
            Urgency::Emergency => "emergency",
        };
        let mut number = 1;
        loop {
            let name = GoalId::from(format!("{stem}{number}"));
            if !self.names.contains(&name) {
                return name;
            }
            number += 1;
        }
    }

    fn door(&mut self, fields: &mut Fields<'_>, door: &str, span: Range<usize>) -> Option<What> {
        if self.site.door(door).is_none() {
            let doors = self.site.doors().map(|door| door.name().as_str());
            let message = unknown("door", door, nearest(door, doors));
            self.fault(span.clone(), message);
        }
        let fact = Atom {
            name: Symbol::from("open"),
            args: vec![Symbol::from(door)],
        };
        match self.text_of_spanned(fields, "state") {
            Some((state, _)) if state == "open" => Some(What::Fact(FactChange::Add(fact))),
            Some((state, _)) if state == "closed" => Some(What::Fact(FactChange::Remove(fact))),
            Some((_, span)) => {
                self.fault(span, "`state` is \"open\" or \"closed\"");
                None
            }
            None => {
                self.fault(span, "a door needs a `state`, \"open\" or \"closed\"");
                None
            }
        }
    }

    fn text_of(&mut self, fields: &mut Fields<'_>, name: &str) -> Option<String> {
        self.text_of_spanned(fields, name).map(|(text, _)| text)
    }

    fn text_of_spanned(
        &mut self,
        fields: &mut Fields<'_>,
        name: &str,
    ) -> Option<(String, Range<usize>)> {
        let (value, span) = fields.remove(name)?;
        match value.as_str() {
            Some(text) => Some((text.to_owned(), span)),
            None => {
                self.fault(span, format!("`{name}` is text, written \"…\""));
                None
            }
        }
    }

    fn number_of(&mut self, fields: &mut Fields<'_>, name: &str) -> Option<(f64, Range<usize>)> {
        let (value, span) = fields.remove(name)?;
        let text = match value {
            DeValue::Integer(number) => number.as_str(),
            DeValue::Float(number) => number.as_str(),
            _ => "",
        };
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => Some((number, span)),
            _ => {
                self.fault(span, format!("`{name}` is a number"));
                None
            }
        }
    }
}

fn unknown(what: &str, name: &str, near: Option<&str>) -> String {
    match near {
        Some(near) => format!("there is no {what} `{name}`; did you mean `{near}`?"),
        None => format!("there is no {what} `{name}`"),
    }
}
