//! Names as their authors spell them.

use std::collections::BTreeMap;

use super::error::Faults;
use super::tree::{self, Tree};
use super::typed_list::typed_list;
use crate::model::Symbol;

/// Names as they are written where they are declared.
///
/// HDDL does not tell upper from lower, and the reader folds all names to lower case. Other
/// programs do tell: who writes a plan for them spells names as the author did.
#[derive(Clone, Debug, Default, Eq, PartialEq)]
pub struct Spelling {
    steps: BTreeMap<String, String>,
    methods: BTreeMap<String, String>,
    objects: BTreeMap<String, String>,
}

impl Spelling {
    /// How names are spelt in these texts: a domain, and perhaps a problem. Texts that cannot be
    /// read spell nothing.
    pub fn of(texts: &[&str]) -> Self {
        let mut spelling = Self::default();
        for text in texts {
            for tree in tree::read_as_written(text, &mut Faults::default()) {
                for section in tree.list().unwrap_or_default() {
                    spelling.section(section);
                }
            }
        }
        spelling
    }

    /// A task or an action.
    pub fn step<'a>(&'a self, name: &'a Symbol) -> &'a str {
        spelt(&self.steps, name)
    }

    /// A method.
    pub fn method<'a>(&'a self, name: &'a Symbol) -> &'a str {
        spelt(&self.methods, name)
    }

    /// An object or a constant.
    pub fn object<'a>(&'a self, name: &'a Symbol) -> &'a str {
        spelt(&self.objects, name)
    }

    fn section(&mut self, section: &Tree) {
        let Some((head, items)) = section.list().and_then(|items| items.split_first()) else {
            return;
        };
        let keyword = head.word().unwrap_or_default().to_lowercase();
        let names = match keyword.as_str() {
            ":task" | ":action" => &mut self.steps,
            ":method" => &mut self.methods,
            ":constants" | ":objects" => {
                for typed in typed_list(items, &mut Faults::default()) {
                    note(&mut self.objects, typed.name);
                }
                return;
            }
            _ => return,
        };
        if let Some(name) = items.first() {
            note(names, name);
        }
    }
}

fn note(names: &mut BTreeMap<String, String>, name: &Tree) {
    let Some(word) = name.word() else { return };
    let folded = word.to_lowercase();
    if folded != word {
        names.entry(folded).or_insert_with(|| word.to_owned());
    }
}

fn spelt<'a>(names: &'a BTreeMap<String, String>, name: &'a Symbol) -> &'a str {
    names
        .get(name.as_str())
        .map_or(name.as_str(), String::as_str)
}
