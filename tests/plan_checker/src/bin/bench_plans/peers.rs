//! What other planners did with the same instances.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::instances::Instance;

/// One planner's result for one instance.
#[derive(Clone, Debug)]
pub struct PeerResult {
    pub solved: bool,
    pub wall_s: f64,
    pub cpu_s: f64,
    pub length: Option<usize>,
}

/// All results, by instance and planner.
#[derive(Debug, Default)]
pub struct Peers(BTreeMap<(String, String), BTreeMap<String, PeerResult>>);

impl Peers {
    pub fn read(file: &Path) -> Result<Self, String> {
        let text = fs::read_to_string(file);
        let text = text.map_err(|error| format!("cannot read {}: {error}", file.display()))?;
        let mut peers = Self::default();
        for line in text.lines().skip(1) {
            let columns: Vec<&str> = line.split('\t').collect();
            let [planner, domain, instance, status, wall, cpu, length, ..] = columns[..] else {
                return Err(format!("{}: not seven columns: {line}", file.display()));
            };
            let of_instance = (domain.to_owned(), instance.to_owned());
            let result = PeerResult {
                solved: status == "ok",
                wall_s: wall.parse().unwrap_or(f64::NAN),
                cpu_s: cpu.parse().unwrap_or(f64::NAN),
                length: length.parse().ok(),
            };
            let of_instance = peers.0.entry(of_instance).or_default();
            of_instance.insert(planner.to_owned(), result);
        }
        Ok(peers)
    }

    /// What one planner did, if it solved the instance.
    pub fn solved_by(&self, planner: &str, instance: &Instance) -> Option<&PeerResult> {
        let result = self.of(instance)?.get(planner)?;
        result.solved.then_some(result)
    }

    /// Whether anybody solved it.
    pub fn solved(&self, instance: &Instance) -> bool {
        let of_instance = self.of(instance);
        of_instance.is_some_and(|planners| planners.values().any(|result| result.solved))
    }

    /// The length of the shortest of their plans.
    pub fn shortest(&self, instance: &Instance) -> Option<usize> {
        let results = self.of(instance)?.values();
        results
            .filter(|result| result.solved)
            .filter_map(|result| result.length)
            .min()
    }

    fn of(&self, instance: &Instance) -> Option<&BTreeMap<String, PeerResult>> {
        self.0
            .get(&(instance.folder.clone(), instance.file.clone()))
    }
}
