//! `(define (domain …) …)`.

use std::collections::{BTreeMap, BTreeSet};

use super::action::{self, action};
use super::error::{Faults, LanguageError};
use super::expression::object;
use super::fields::{Fields, fields, read_parameters};
use super::method::{self, method};
use super::section::{requirements, sections};
use super::tree::{self, Tree};
use super::typed_list::{Kinds, name, parameters, typed_list};
use super::types;
use crate::model::{Domain, Number, Operator, Parameter, Symbol};

/// Sections in the order in which they must be read, so that what is used is known by then.
const SECTIONS: &[&str] = &[
    ":requirements",
    ":types",
    ":constants",
    ":predicates",
    ":functions",
    ":task",
    ":action",
    ":method",
];

/// Reads a domain and checks that everything it uses is declared and fits.
///
/// All faults that can be told apart are reported at once, in the order of the text.
pub fn parse_domain(text: &str) -> Result<Domain, Vec<LanguageError>> {
    read_domain(text, false)
}

/// Reads a domain as [`parse_domain`] does, and refuses also what has a meaning but is probably a
/// slip: a task that no method does, two methods of one name, an argument that can never be of
/// the type wanted, a requirement that nobody knows.
///
/// For domains that agents act on, which deserve the care; published ones are full of such things.
pub fn parse_domain_strictly(text: &str) -> Result<Domain, Vec<LanguageError>> {
    read_domain(text, true)
}

fn read_domain(text: &str, strict: bool) -> Result<Domain, Vec<LanguageError>> {
    let mut faults = Faults::default();
    let trees = tree::read(text, &mut faults);
    if !faults.is_empty() {
        // Behind a misplaced parenthesis everything else looks wrong as well.
        return Err(faults.into_errors(text));
    }
    let mut reader = Reader {
        domain: Domain::default(),
        faults,
        task_places: BTreeMap::new(),
        method_names: BTreeSet::new(),
    };
    reader.read(&trees);
    let Reader {
        domain, mut faults, ..
    } = reader;
    if strict {
        faults.be_strict();
    }
    if faults.is_empty() {
        Ok(domain)
    } else {
        Err(faults.into_errors(text))
    }
}

struct Reader {
    domain: Domain,
    faults: Faults,
    /// Where each task is declared.
    task_places: BTreeMap<Symbol, usize>,
    method_names: BTreeSet<Symbol>,
}

/// An action or a method whose keywords have been read.
struct Headed<'t> {
    name: Symbol,
    at: usize,
    parameters: Vec<Parameter>,
    fields: Fields<'t>,
}

impl Reader {
    fn read(&mut self, trees: &[Tree]) {
        let Some((name, sections)) = sections(trees, "domain", SECTIONS, &mut self.faults) else {
            return;
        };
        self.domain.name = name;
        let of = |keyword: &'static str| {
            sections
                .iter()
                .filter(move |section| section.head() == Some(keyword))
                .filter_map(|section| Some((section.at, section.list()?.get(1..)?)))
        };
        of(":requirements").for_each(|(_, items)| requirements(items, &mut self.faults));
        let types: Vec<Tree> = of(":types").flat_map(|(_, items)| items.to_vec()).collect();
        types::types(&types, &mut self.domain, &mut self.faults);
        for section in &sections {
            types::unions(section, &mut self.domain);
        }
        of(":constants").for_each(|(_, items)| self.constants(items));
        of(":predicates").for_each(|(_, items)| self.predicates(items));
        of(":functions").for_each(|(_, items)| self.functions(items));
        of(":task").for_each(|(at, items)| self.task(at, items));
        let actions: Vec<Headed<'_>> = of(":action")
            .filter_map(|(at, items)| self.action_head(at, items))
            .collect();
        // Every head is known before any body, since bodies speak of each other.
        for head in actions {
            let operator = action(
                &head.name,
                &head.parameters,
                &head.fields,
                &self.domain,
                &mut self.faults,
            );
            self.domain.operators.insert(head.name, operator);
        }
        of(":method").for_each(|(at, items)| self.method(at, items));
        types::forget_unused_unions(&mut self.domain);
        self.undone_tasks();
    }

    fn constants(&mut self, items: &[Tree]) {
        let mut kinds = Kinds::default();
        for typed in typed_list(items, &mut self.faults) {
            let Some(constant) = object(typed.name, &mut self.faults) else {
                continue;
            };
            let kind = kinds
                .next(&typed, Some(&self.domain), &mut self.faults)
                .unwrap_or_else(|| Symbol::from("object"));
            let message = format!("constant `{constant}` is declared twice");
            match self.domain.constants.insert(constant, kind.clone()) {
                Some(before) if before == kind => self.faults.slip(typed.name.at, message),
                Some(_) => self.faults.add(typed.name.at, message),
                None => {}
            }
        }
    }

    fn predicates(&mut self, items: &[Tree]) {
        for item in items {
            let Some((name, parameters)) = self.declaration(item, "a predicate") else {
                continue;
            };
            let message = format!("predicate `{name}` is declared twice");
            match self.domain.predicates.insert(name, parameters.clone()) {
                Some(before) if before == parameters => self.faults.slip(item.at, message),
                Some(_) => self.faults.add(item.at, message),
                None => {}
            }
        }
    }

    fn functions(&mut self, items: &[Tree]) {
        for typed in typed_list(items, &mut self.faults) {
            if let Some(kind) = typed.kind.filter(|kind| kind.word() != Some("number")) {
                self.faults.add(
                    kind.at,
                    format!("only functions to `number` are supported, not to `{kind}`"),
                );
            }
            let Some((name, parameters)) = self.declaration(typed.name, "a function") else {
                continue;
            };
            let message = format!("function `{name}` is declared twice");
            match self.domain.functions.insert(name, parameters.clone()) {
                Some(before) if before == parameters => self.faults.slip(typed.name.at, message),
                Some(_) => self.faults.add(typed.name.at, message),
                None => {}
            }
        }
    }

    /// `(at ?n - node)`
    fn declaration(&mut self, tree: &Tree, what: &str) -> Option<(Symbol, Vec<Parameter>)> {
        let Some((head, rest)) = tree.list().and_then(|items| items.split_first()) else {
            self.faults.add(
                tree.at,
                format!("expected {what} such as `(name ?x - type)`, found `{tree}`"),
            );
            return None;
        };
        let name = name(head, what, &mut self.faults)?;
        let parameters = parameters(rest, Some(&self.domain), &mut self.faults);
        Some((name, parameters))
    }

    /// The name, the parameters and the other keywords of a task or an action.
    fn head<'t>(
        &mut self,
        at: usize,
        items: &'t [Tree],
        what: &str,
        words: &[&str],
    ) -> Option<Headed<'t>> {
        let Some((head, rest)) = items.split_first() else {
            self.faults.add(at, format!("{what} needs a name"));
            return None;
        };
        let name = name(head, &format!("the name of {what}"), &mut self.faults)?;
        let fields = fields(rest, words, what, &mut self.faults);
        Some(Headed {
            name,
            at: head.at,
            parameters: Vec::new(),
            fields,
        })
    }

    fn task(&mut self, at: usize, items: &[Tree]) {
        let words = &[":parameters", ":precondition", ":effect"];
        let Some(head) = self.head(at, items, "a task", words) else {
            return;
        };
        for keyword in &words[1..] {
            // HDDL's earlier drafts have them, always empty.
            if let Some((at, tree)) = head.fields.get(keyword)
                && tree.list().is_none_or(|items| !items.is_empty())
            {
                let message = format!("`{keyword}` of a task is not supported; put it in methods");
                self.faults.add(*at, message);
            }
        }
        let parameters = read_parameters(&head.fields, &self.domain, &mut self.faults);
        if self
            .task_places
            .insert(head.name.clone(), head.at)
            .is_some()
        {
            let message = format!("task `{}` is declared twice", head.name);
            self.faults.add(head.at, message);
        }
        self.domain.tasks.insert(head.name, parameters);
    }

    fn action_head<'t>(&mut self, at: usize, items: &'t [Tree]) -> Option<Headed<'t>> {
        let mut head = self.head(at, items, "an action", action::KEYWORDS)?;
        head.parameters = read_parameters(&head.fields, &self.domain, &mut self.faults);
        let name = &head.name;
        if self.task_places.contains_key(name) {
            let message = format!("`{name}` is both a task and an action; rename one of them");
            self.faults.add(head.at, message);
        }
        let known = Operator {
            name: name.clone(),
            parameters: head.parameters.clone(),
            precondition: Vec::new(),
            effect: Default::default(),
            cost: Number::Constant(0.0),
        };
        if self.domain.operators.insert(name.clone(), known).is_some() {
            let message = format!("action `{name}` is declared twice");
            self.faults.add(head.at, message);
        }
        Some(head)
    }

    fn method(&mut self, at: usize, items: &[Tree]) {
        let Some(head) = self.head(at, items, "a method", method::KEYWORDS) else {
            return;
        };
        let name = head.name;
        if !self.method_names.insert(name.clone()) {
            let message = format!("method `{name}` is declared twice");
            self.faults.slip(head.at, message);
        }
        let method = method(name, head.at, &head.fields, &self.domain, &mut self.faults);
        if let Some((_, tree)) = head.fields.get(":task") {
            // Even a method that is refused shows that its author thought of the task.
            self.task_places.remove(tree.head().unwrap_or_default());
        }
        self.domain.methods.extend(method);
    }

    fn undone_tasks(&mut self) {
        for (task, at) in std::mem::take(&mut self.task_places) {
            let message = format!("no method does the task `{task}`; write one, or remove it");
            self.faults.slip(at, message);
        }
    }
}
