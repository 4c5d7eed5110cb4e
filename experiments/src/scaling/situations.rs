//! The paper's kinds of situations, on any map.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use agent_core::model::{Fact, FactChange, Symbol};
use maps::Site;

use crate::drive::Situation;

/// So many areas lie between start and goal, where the map is large enough: as in the paper.
const AREAS_AWAY: usize = 4;

/// A situation with its name.
pub(super) type Named = (String, Situation);

/// All situations there are on a map, from the entrance and back.
pub(super) fn situations(site: &Site) -> Vec<Named> {
    let Some(entrance) = site.node("n1") else {
        return Vec::new();
    };
    let away = areas_away(site, entrance.area(), &BTreeSet::new());
    let most = away.values().max().copied().unwrap_or_default();
    let goals = away
        .iter()
        .filter(|(_, away)| **away == AREAS_AWAY.min(most))
        .filter_map(|(area, _)| site.area(area.as_str())?.nodes().next());
    // The first way from which a door that is closed can be gone round, or else the first.
    let choices: Vec<Vec<Named>> = goals
        .take(20)
        .map(|goal| {
            let there = one_way(site, entrance.name(), goal, "there");
            let back = one_way(site, goal, entrance.name(), "back");
            there.into_iter().chain(back).collect()
        })
        .collect();
    choices
        .into_iter()
        .rev()
        .max_by_key(Vec::len)
        .unwrap_or_default()
}

fn one_way(site: &Site, start: &Symbol, goal: &Symbol, direction: &str) -> Vec<Named> {
    let Some(way) = Way::new(site, start, goal) else {
        return Vec::new();
    };
    let situation = |emergency: &Symbol, closes: Option<&Symbol>| Situation {
        start: start.to_string(),
        goal: goal.to_string(),
        interruption: String::new(),
        emergency: emergency.to_string(),
        change: closes.map(|door| FactChange::Remove(Fact::new("open", [door.as_str()]))),
    };
    let same_area = way.beside(0);
    let mut found = Vec::new();
    let mut add = |name: &str, emergency: Option<&Symbol>, closes: Option<&Symbol>| {
        if let Some(emergency) = emergency {
            found.push((format!("{name}, {direction}"), situation(emergency, closes)));
        }
    };
    add("same area", same_area, None);
    add("on the route", way.beside(2), None);
    add("off the route", way.aside(), None);
    if let Some(door) = way.door_that_can_be_gone_round() {
        add("door closes on the route", same_area, Some(door));
    }
    if let Some(door) = way.door_elsewhere() {
        add("door closes elsewhere", same_area, Some(door));
    }
    found
}

/// The shortest way from one node to another.
struct Way<'a> {
    site: &'a Site,
    nodes: Vec<Symbol>,
    /// In order.
    areas: Vec<&'a Symbol>,
    /// Through which it goes from each of `areas` to the next.
    doors: Vec<&'a Symbol>,
}

impl<'a> Way<'a> {
    fn new(site: &'a Site, start: &Symbol, goal: &Symbol) -> Option<Self> {
        let is_open = |door: &Symbol| {
            site.door(door.as_str())
                .is_some_and(|d| d.is_open_at_first())
        };
        let route = site.route(start.as_str(), goal.as_str(), |passage| {
            passage.door().is_none_or(is_open)
        })?;
        let mut areas: Vec<&Symbol> = Vec::new();
        for node in &route.nodes {
            let area = site.node(node.as_str())?.area();
            if areas.last() != Some(&area) {
                areas.push(area);
            }
        }
        let doors = route.nodes.windows(2).filter_map(|step| {
            let mut ways = site.neighbours(step[0].as_str());
            ways.find(|(_, next)| *next.name() == step[1])?.0.door()
        });
        Some(Self {
            site,
            areas,
            doors: doors.collect(),
            nodes: route.nodes,
        })
    }

    /// A node of one of the areas, off the way.
    fn beside(&self, area: usize) -> Option<&'a Symbol> {
        // The last area is the goal's: an emergency there leaves little to resume.
        let area = self
            .areas
            .get(area.min(self.areas.len().saturating_sub(2)))?;
        let mut nodes = self.site.area(area.as_str())?.nodes();
        nodes.find(|node| !self.nodes.contains(node))
    }

    /// A node of an area that lies beside the first ones of the way.
    fn aside(&self) -> Option<&'a Symbol> {
        let doors = self.site.doors().filter(|door| door.is_open_at_first());
        let joined: Vec<[&Symbol; 2]> = doors.map(|door| door.joins()).collect();
        self.areas.iter().take(3).find_map(|on_the_way| {
            let beside = joined.iter().find_map(|[one, other]| {
                match () {
                    () if one == on_the_way => Some(*other),
                    () if other == on_the_way => Some(*one),
                    () => None,
                }
                .filter(|area| !self.areas.contains(area))
            })?;
            self.site.area(beside.as_str())?.nodes().last()
        })
    }

    /// Not the first, which the robot may be going through already.
    fn door_that_can_be_gone_round(&self) -> Option<&'a Symbol> {
        let (first, last) = (self.areas.first()?, self.areas.last()?);
        let mut doors = self.doors.iter().skip(1).copied();
        doors.find(|door| areas_away(self.site, first, &BTreeSet::from([*door])).contains_key(last))
    }

    /// One that leads out of an area of the way, and is none of the way's.
    fn door_elsewhere(&self) -> Option<&'a Symbol> {
        let mut doors = self.site.doors().filter(|door| door.is_open_at_first());
        let beside = |door: &&maps::Door| door.joins().iter().any(|area| self.areas.contains(area));
        doors
            .find(|door| beside(door) && !self.doors.contains(&door.name()))
            .map(|door| door.name())
    }
}

/// How many areas one has to leave on the way from one to each that can be reached with these doors
/// closed, beside those that are closed at first.
fn areas_away<'a>(
    site: &'a Site,
    from: &'a Symbol,
    closed: &BTreeSet<&Symbol>,
) -> BTreeMap<&'a Symbol, usize> {
    let mut beyond: BTreeMap<&Symbol, Vec<&'a Symbol>> = BTreeMap::new();
    for door in site.doors().filter(|door| door.is_open_at_first()) {
        if !closed.contains(door.name()) {
            let [one, other] = door.joins();
            beyond.entry(one).or_default().push(other);
            beyond.entry(other).or_default().push(one);
        }
    }
    let mut found = BTreeMap::from([(from, 0)]);
    let mut open = VecDeque::from([(from, 0)]);
    while let Some((area, away)) = open.pop_front() {
        for next in beyond.get(area).into_iter().flatten() {
            if !found.contains_key(next) {
                found.insert(next, away + 1);
                open.push_back((next, away + 1));
            }
        }
    }
    found
}
