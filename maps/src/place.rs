//! All that is known of a place: its map, and what there is to do.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use agent_core::model::Map;

use crate::fingerprint::fingerprint;
use crate::vocabulary::missing_words;
use crate::{Finding, Level, Site, area_level, level_from_texts, museum, node_level, read_level};

/// All that is wrong with a place, a finding a line.
#[derive(Clone, Debug, Eq, PartialEq, thiserror::Error)]
#[error("the place is not in order:\n{}", lines(.0))]
pub struct NotInOrder(pub Vec<Finding>);

fn lines(findings: &[Finding]) -> String {
    let lines: Vec<String> = findings.iter().map(ToString::to_string).collect();
    lines.join("\n")
}

/// A map and the domains of the two levels that plan on it.
///
/// Invariant, kept by [`read`](Self::read): each domain has the words for what its level is told
/// of the map.
#[derive(Clone, Debug)]
pub struct Place {
    name: String,
    fingerprint: String,
    site: Arc<Site>,
    area: Level,
    node: Level,
}

impl Place {
    /// Reads a folder with `map.geojson` and, for each of the levels `area` and `node`, a domain
    /// and an execution model.
    ///
    /// # Errors
    /// Everything that is wrong with any of the files.
    pub fn read(dir: impl AsRef<Path>) -> Result<Self, Vec<Finding>> {
        let dir = dir.as_ref();
        let name = dir.file_name().map(|name| name.to_string_lossy());
        let files = [
            "map.geojson",
            "area.hddl",
            "area.toml",
            "node.hddl",
            "node.toml",
        ];
        // What cannot be read is a finding below.
        let texts = files.map(|file| std::fs::read(dir.join(file)).unwrap_or_default());
        let domains = ["area", "node"].map(|level| {
            let file = dir.join(format!("{level}.hddl"));
            file.display().to_string()
        });
        Self::from_parts(
            name.unwrap_or_default().as_ref(),
            fingerprint(&texts.each_ref().map(Vec::as_slice)),
            Site::read(dir.join("map.geojson")),
            ["area", "node"].map(|level| read_level(dir, level)),
            domains.each_ref().map(String::as_str),
        )
    }

    /// The place in a folder, or the museum if none is named.
    ///
    /// # Errors
    /// Everything that is wrong with it.
    pub fn open(dir: Option<&Path>) -> Result<Self, NotInOrder> {
        dir.map_or_else(
            || Ok(Self::museum()),
            |dir| Self::read(dir).map_err(NotInOrder),
        )
    }

    /// The museum of the paper, which is part of the program.
    pub fn museum() -> Self {
        let names = ["area.hddl", "node.hddl"];
        let levels = [
            level_from_texts(
                museum::AREA_DOMAIN,
                museum::AREA_MODEL,
                [names[0], "area.toml"],
            ),
            level_from_texts(
                museum::NODE_DOMAIN,
                museum::NODE_MODEL,
                [names[1], "node.toml"],
            ),
        ];
        let site = Site::from_text("map.geojson", museum::MAP);
        // The texts do not change once the program is built, and a test reads them.
        let texts = [
            museum::MAP,
            museum::AREA_DOMAIN,
            museum::AREA_MODEL,
            museum::NODE_DOMAIN,
            museum::NODE_MODEL,
        ];
        let fingerprint = fingerprint(&texts.map(str::as_bytes));
        Self::from_parts("museum", fingerprint, site, levels, names)
            .expect("the museum is in order")
    }

    fn from_parts(
        name: &str,
        fingerprint: String,
        site: Result<Site, Vec<Finding>>,
        [area, node]: [Result<Level, Vec<Finding>>; 2],
        [area_file, node_file]: [&str; 2],
    ) -> Result<Self, Vec<Finding>> {
        let mut findings = Vec::new();
        if let Ok(site) = &site {
            let whole = std::iter::once_with(|| area_level(site));
            findings.extend(unspoken(area_file, &area, whole));
            let areas = site.areas().map(|area| area.name().as_str());
            let parts = areas.filter_map(|area| node_level(site, area));
            findings.extend(unspoken(node_file, &node, parts));
        }
        match (site, area, node) {
            (Ok(site), Ok(area), Ok(node)) if findings.is_empty() => Ok(Self {
                name: if site.name().is_empty() {
                    name
                } else {
                    site.name()
                }
                .to_owned(),
                fingerprint,
                site: Arc::new(site),
                area,
                node,
            }),
            (site, area, node) => {
                let found = [site.err(), area.err(), node.err()];
                let found = found.into_iter().flatten().flatten();
                Err(found.chain(findings).collect())
            }
        }
    }

    /// What the map calls it; if that is nothing, what its folder is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Of the texts that it was read from: what was written down in one place makes no sense in
    /// another.
    pub fn fingerprint(&self) -> &str {
        &self.fingerprint
    }

    /// Its map.
    pub fn site(&self) -> &Arc<Site> {
        &self.site
    }

    /// What the parent agent plans with.
    pub fn area(&self) -> &Level {
        &self.area
    }

    /// What the child agent plans with.
    pub fn node(&self) -> &Level {
        &self.node
    }

    /// The level of that name, `area` or `node`.
    pub fn level(&self, name: &str) -> Option<&Level> {
        match name {
            "area" => Some(&self.area),
            "node" => Some(&self.node),
            _ => None,
        }
    }
}

/// Findings about what the maps say and the domain has no words for.
fn unspoken(
    file: &str,
    level: &Result<Level, Vec<Finding>>,
    maps: impl Iterator<Item = Map>,
) -> Vec<Finding> {
    let Ok(level) = level else {
        return Vec::new();
    };
    let missing = maps.flat_map(|map| missing_words(&level.domain, &map));
    let missing: BTreeSet<String> = missing.collect();
    missing
        .into_iter()
        .map(|message| Finding {
            file: file.to_owned(),
            place: String::new(),
            message,
            excerpt: String::new(),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::area_maps;

    fn museum_with(area_domain: &str, node_domain: &str) -> Result<Place, Vec<Finding>> {
        Place::from_parts(
            "copy",
            String::new(),
            Site::from_text("map.geojson", museum::MAP),
            [
                level_from_texts(area_domain, museum::AREA_MODEL, ["area.hddl", "area.toml"]),
                level_from_texts(node_domain, museum::NODE_MODEL, ["node.hddl", "node.toml"]),
            ],
            ["area.hddl", "node.hddl"],
        )
    }

    #[track_caller]
    fn assert_refused(place: Result<Place, Vec<Finding>>, expected: &[&str]) {
        let found = place.err().unwrap_or_default();
        let found: Vec<String> = found.iter().map(ToString::to_string).collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn the_museum_needs_no_folder() {
        let place = Place::museum();
        assert_eq!(place.name(), "museum");
        assert_eq!(place.site().nodes().count(), 40);
        assert!(place.area().domain.tasks.contains_key("tour"));
        assert_eq!(place.level("node"), Some(place.node()));
        assert_eq!(place.level("room"), None);
    }

    #[test]
    fn the_museum_in_its_folder_is_the_museum_in_the_program() {
        let dir = concat!(env!("CARGO_MANIFEST_DIR"), "/museum");
        let (read, built_in) = (Place::read(dir).expect("in order"), Place::museum());
        assert_eq!(read.area(), built_in.area());
        assert_eq!(read.node(), built_in.node());
        assert_eq!(area_maps(read.site()), area_maps(built_in.site()));
        for (name, text) in museum::FILES {
            let file = std::fs::read_to_string(format!("{dir}/{name}")).expect("it is there");
            assert_eq!(file, text, "{name}");
        }
    }

    #[test]
    fn a_folder_with_nothing_in_it_lacks_all_its_files() {
        let found = Place::read("no/such/place").expect_err("there is nothing");
        let files: BTreeSet<&str> = found.iter().map(|one| one.file.as_str()).collect();
        for name in ["map.geojson", "area.hddl", "node.hddl"] {
            assert!(
                files.contains(format!("no/such/place/{name}").as_str()),
                "{files:?}"
            );
        }
    }

    #[test]
    fn a_domain_that_does_not_fit_the_map_is_refused_with_its_file() {
        let taken = |text: &str| text.replace("(:constants visitor", "(:constants n7 visitor");
        let place = museum_with(&taken(museum::AREA_DOMAIN), &taken(museum::NODE_DOMAIN));
        let message = "n7 is a constant, but also the name of something on the map";
        assert_refused(
            place,
            &[
                &format!("area.hddl: {message}"),
                &format!("node.hddl: {message}"),
            ],
        );
    }
}
