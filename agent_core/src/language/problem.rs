//! `(define (problem …) …)`.

use super::error::{Faults, LanguageError};
use super::expression::{Scope, object};
use super::fields::{fields, read_parameters};
use super::fit::Sort;
use super::number::decimal;
use super::section::{requirements, sections};
use super::subtasks::{self, subtasks};
use super::tree::{self, Tree};
use super::typed_list::{Kinds, typed_list};
use crate::model::{Belief, Condition, Domain, Fact, FactChange, Instance, Pattern, Symbol};

/// What a problem may have. What is not here is refused.
const SECTIONS: &[&str] = &[
    ":domain",
    ":requirements",
    ":objects",
    ":htn",
    ":init",
    ":goal",
    ":metric",
];

/// Reads a problem of `domain` and checks that everything it uses is declared and fits.
///
/// All faults that can be told apart are reported at once, in the order of the text. A `:metric`
/// is not kept: what a plan costs is what its actions cost.
pub fn parse_problem(text: &str, domain: &Domain) -> Result<Instance, Vec<LanguageError>> {
    let mut faults = Faults::default();
    let trees = tree::read(text, &mut faults);
    if !faults.is_empty() {
        // Behind a misplaced parenthesis everything else looks wrong as well.
        return Err(faults.into_errors(text));
    }
    let mut reader = Reader {
        instance: Instance::default(),
        domain: domain.clone(),
        faults,
    };
    reader.read(&trees);
    if reader.faults.is_empty() {
        Ok(reader.instance)
    } else {
        Err(reader.faults.into_errors(text))
    }
}

struct Reader {
    instance: Instance,
    /// The domain, with the objects of the problem among its constants.
    domain: Domain,
    faults: Faults,
}

impl Reader {
    fn read(&mut self, trees: &[Tree]) {
        let Some((name, sections)) = sections(trees, "problem", SECTIONS, &mut self.faults) else {
            return;
        };
        self.instance.name = name;
        let of = |keyword: &'static str| {
            sections
                .iter()
                .filter(move |section| section.head() == Some(keyword))
                .filter_map(|section| Some((section.at, section.list()?.get(1..)?)))
        };
        for keyword in [":domain", ":htn", ":goal", ":metric"] {
            if let Some((at, _)) = of(keyword).nth(1) {
                self.faults
                    .add(at, format!("there are two of `({keyword} …)`"));
            }
        }
        of(":domain").for_each(|(at, items)| self.domain(at, items));
        of(":requirements").for_each(|(_, items)| requirements(items, &mut self.faults));
        of(":objects").for_each(|(_, items)| self.objects(items));
        of(":init").for_each(|(_, items)| self.init(items));
        if of(":htn").next().is_none() {
            self.faults.add(
                trees.first().map_or(0, |tree| tree.at),
                "nothing is to be done: add `(:htn :ordered-subtasks (…))`",
            );
        }
        of(":htn").for_each(|(_, items)| self.network(items));
        of(":goal").for_each(|(at, items)| self.goal(at, items));
    }

    fn domain(&mut self, at: usize, items: &[Tree]) {
        let [tree] = items else {
            self.faults.add(at, "write `(:domain NAME)`");
            return;
        };
        let Some(word) = tree.word() else {
            self.faults.add(at, "write `(:domain NAME)`");
            return;
        };
        let known = &self.domain.name;
        if *known != *word {
            let message = format!("this problem is of the domain `{word}`, not of `{known}`");
            self.faults.slip(tree.at, message);
        }
        self.instance.domain = Symbol::from(word);
    }

    fn objects(&mut self, items: &[Tree]) {
        let mut kinds = Kinds::default();
        for typed in typed_list(items, &mut self.faults) {
            let Some(name) = object(typed.name, &mut self.faults) else {
                continue;
            };
            let kind = kinds
                .next(&typed, Some(&self.domain), &mut self.faults)
                .unwrap_or_else(|| Symbol::from("object"));
            let before = self.domain.constants.get(&name);
            // Some problems repeat the constants of their domain; the narrower type says more.
            let kept = match before {
                Some(before) if self.domain.is_a(before, &kind) => continue,
                Some(before) if !self.domain.is_a(&kind, before) => {
                    let message = format!("`{name}` is of type {before} already, not {kind}");
                    self.faults.add(typed.name.at, message);
                    continue;
                }
                _ => kind,
            };
            self.domain.constants.insert(name.clone(), kept.clone());
            self.instance.objects.insert(name, kept);
        }
    }

    fn init(&mut self, items: &[Tree]) {
        let scope = Scope {
            parameters: &[],
            domain: Some(&self.domain),
        };
        let mut init = Belief::default();
        for item in items {
            if self.faults.is_enough() {
                break;
            }
            for tree in conjuncts(item) {
                if let Some(change) = initial(tree, &scope, &mut self.faults) {
                    init.apply(&change);
                }
            }
        }
        self.instance.init = init;
    }

    fn network(&mut self, items: &[Tree]) {
        let fields = fields(
            items,
            subtasks::KEYWORDS,
            "the initial tasks",
            &mut self.faults,
        );
        let parameters = read_parameters(&fields, &self.domain, &mut self.faults);
        let scope = Scope {
            parameters: &parameters,
            domain: Some(&self.domain),
        };
        if let Some((_, tree)) = fields.get(":constraints") {
            self.instance.constraints = scope.condition(tree, &mut self.faults);
        }
        self.instance.tasks = subtasks(&fields, &scope, &mut self.faults);
        self.instance.parameters = parameters;
    }

    fn goal(&mut self, at: usize, items: &[Tree]) {
        let scope = Scope {
            parameters: &[],
            domain: Some(&self.domain),
        };
        self.instance.goal = match items {
            [] => Condition::new(),
            [tree] => scope.condition(tree, &mut self.faults),
            _ => {
                self.faults
                    .add(at, "write one condition: `(:goal (and …))`");
                Condition::new()
            }
        };
    }
}

fn conjuncts(tree: &Tree) -> &[Tree] {
    match (tree.head(), tree.list()) {
        (_, Some([])) => &[],
        (Some("and"), Some([_, items @ ..])) => items,
        _ => std::slice::from_ref(tree),
    }
}

/// `(at n1)`, `(not (at n1))` or `(= (length arc1) 3)`.
fn initial(tree: &Tree, scope: &Scope<'_>, faults: &mut Faults) -> Option<FactChange> {
    match (tree.head(), tree.list()) {
        (Some("not"), Some([_, inner])) => {
            let fact = scope.pattern(inner, Sort::Predicate, faults)?;
            Some(FactChange::Remove(ground(&fact)?))
        }
        (Some("="), Some([_, function, value])) if function.list().is_some() => {
            let function = scope.pattern(function, Sort::Function, faults);
            let Some(number) = value.word().and_then(decimal) else {
                faults.add(value.at, format!("expected a number, found `{value}`"));
                return None;
            };
            Some(FactChange::Set(ground(&function?)?, number))
        }
        (Some("not" | "="), _) => {
            faults.add(
                tree.at,
                format!("expected a fact or `(= (length arc1) 3)`, found `{tree}`"),
            );
            None
        }
        _ => {
            let fact = scope.pattern(tree, Sort::Predicate, faults)?;
            Some(FactChange::Add(ground(&fact)?))
        }
    }
}

fn ground(pattern: &Pattern) -> Option<Fact> {
    pattern.ground(&[])
}
