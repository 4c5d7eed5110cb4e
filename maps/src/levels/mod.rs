//! A site as the two levels of agents see it: objects, facts and values in the words of
//! `area.hddl` and `node.hddl`.

mod areas;
mod nodes;
mod rough;
#[cfg(test)]
mod tests;

use agent_core::model::{Fact, FactChange, Map, Symbol};

pub use areas::{area_level, area_start};
pub use nodes::{area_maps, node_level, node_start, whole_node_level};

/// Writes a map, one statement at a time.
#[derive(Default)]
struct MapWriter {
    map: Map,
}

impl MapWriter {
    fn object(&mut self, name: &Symbol, kind: &str) {
        self.map.objects.insert(name.clone(), Symbol::from(kind));
    }

    fn fact(&mut self, predicate: &str, args: &[&Symbol]) {
        self.map
            .facts
            .apply(&FactChange::Add(atom(predicate, args)));
    }

    fn value(&mut self, function: &str, args: &[&Symbol], value: f64) {
        self.map
            .facts
            .apply(&FactChange::Set(atom(function, args), value));
    }
}

fn atom(name: &str, args: &[&Symbol]) -> Fact {
    Fact {
        name: Symbol::from(name),
        args: args.iter().copied().cloned().collect(),
    }
}
