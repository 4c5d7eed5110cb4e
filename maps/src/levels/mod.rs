//! A site as the two levels of agents see it: objects, facts and values in the words of
//! `area.hddl` and `node.hddl`.

mod areas;
mod far;
mod nodes;
mod rough;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;

use agent_core::model::{Fact, FactChange, Map, Symbol};

pub use areas::{area_level, area_start};
pub use nodes::{AreaMaps, area_maps, node_level, node_start, whole_node_level};

/// Writes a map, one statement at a time.
#[derive(Default)]
struct MapWriter {
    objects: BTreeMap<Symbol, Symbol>,
    facts: Vec<FactChange>,
    /// Each word once, however often it is used.
    words: BTreeMap<&'static str, Symbol>,
}

impl MapWriter {
    fn object(&mut self, name: &Symbol, kind: &'static str) {
        let kind = self.word(kind);
        self.objects.insert(name.clone(), kind);
    }

    fn fact(&mut self, predicate: &'static str, args: &[&Symbol]) {
        let fact = self.atom(predicate, args);
        self.facts.push(FactChange::Add(fact));
    }

    fn value(&mut self, function: &'static str, args: &[&Symbol], value: f64) {
        let function = self.atom(function, args);
        self.facts.push(FactChange::Set(function, value));
    }

    fn atom(&mut self, name: &'static str, args: &[&Symbol]) -> Fact {
        Fact {
            name: self.word(name),
            args: args.iter().copied().cloned().collect(),
        }
    }

    fn word(&mut self, word: &'static str) -> Symbol {
        self.words
            .entry(word)
            .or_insert_with(|| Symbol::from(word))
            .clone()
    }

    fn finish(self) -> Map {
        Map {
            objects: self.objects,
            facts: self.facts.into_iter().collect(),
            news: Vec::new(),
        }
    }
}

fn atom(name: &str, args: &[&Symbol]) -> Fact {
    Fact {
        name: Symbol::from(name),
        args: args.iter().copied().cloned().collect(),
    }
}
