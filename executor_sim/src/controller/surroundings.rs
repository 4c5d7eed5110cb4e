//! What the robot knows of its place, in the words of its superiors.

use std::collections::{BTreeMap, BTreeSet};

use agent_core::model::{Fact, FactChange, Symbol};
use agent_core::protocol::{Ledger, Rows, Unreadable, read_row};

use crate::{Floor, Place};

const DOORS: &str = "m/doors";
const TOLD: &str = "m/told";

/// Where the robot stood last, which doors are open, and what of it has been told.
#[derive(Clone, Debug)]
pub(super) struct Surroundings {
    floor: Floor,
    /// `None` until the sensors have said so for the first time.
    place: Option<Place>,
    doors: BTreeMap<Symbol, bool>,
    /// A building has tens of thousands: they are not gone through for every row that is written.
    doors_are_written: bool,
    /// Facts about the place that superiors hold to be true, because they have been told.
    told: BTreeSet<Fact>,
}

impl Surroundings {
    pub(super) fn new(floor: Floor) -> Self {
        Self {
            doors: floor.doors().clone(),
            doors_are_written: false,
            floor,
            place: None,
            told: BTreeSet::new(),
        }
    }

    pub(super) fn floor(&self) -> &Floor {
        &self.floor
    }

    pub(super) fn place(&self) -> Option<&Place> {
        self.place.as_ref()
    }

    pub(super) fn doors(&self) -> &BTreeMap<Symbol, bool> {
        &self.doors
    }

    pub(super) fn stands_at(&mut self, place: Place) {
        self.place = Some(place);
    }

    /// Until the sensors say so again.
    pub(super) fn forget_place(&mut self) {
        self.place = None;
    }

    /// Whether that is news.
    pub(super) fn set_door(&mut self, door: &Symbol, open: bool) -> bool {
        let changed = self.doors.insert(door.clone(), open) != Some(open);
        self.doors_are_written &= !changed;
        changed
    }

    pub(super) fn write_down(&mut self, ledger: &mut Ledger) {
        if !std::mem::replace(&mut self.doors_are_written, true) {
            ledger.put(DOORS.to_owned(), &self.doors);
        }
        ledger.put(TOLD.to_owned(), &self.told);
    }

    /// Where the robot stands has to be found out anew.
    pub(super) fn recall(&mut self, rows: &Rows) -> Result<(), Unreadable> {
        let doors: BTreeMap<Symbol, bool> = read_row(rows, DOORS)?.unwrap_or_default();
        if let Some(door) = doors.keys().find(|door| !self.doors.contains_key(*door)) {
            return Err(Unreadable::new(DOORS, format!("there is no door `{door}`")));
        }
        self.doors.extend(doors);
        self.doors_are_written = false;
        self.told = read_row(rows, TOLD)?.unwrap_or_default();
        Ok(())
    }

    /// Whether the robot stands on an arc that leads through that door.
    pub(super) fn stands_by(&self, door: &Symbol) -> bool {
        match &self.place {
            Some(Place::Arc { arc, .. }) => self
                .floor
                .passage(arc)
                .is_some_and(|passage| passage.door.as_ref() == Some(door)),
            _ => false,
        }
    }

    /// Whether that door is open.
    pub(super) fn door_fact(&self, door: &Symbol) -> FactChange {
        let fact = fact("open", [door]);
        if self.doors.get(door) == Some(&true) {
            FactChange::Add(fact)
        } else {
            FactChange::Remove(fact)
        }
    }

    /// All that is true about the place where the robot stands, and what no longer is.
    ///
    /// No longer true is what was told before, and whatever one might have thought of `arc`, the
    /// one that the robot was sent along: a superior may have believed a model's prediction.
    pub(super) fn tell(&mut self, arc: Option<&Symbol>) -> Vec<FactChange> {
        let (now, gaps) = self.standing();
        let mut before = std::mem::take(&mut self.told);
        before.extend(arc.into_iter().flat_map(|arc| self.imaginable(arc)));
        let changes = before
            .difference(&now)
            .cloned()
            .map(FactChange::Remove)
            .chain(now.iter().cloned().map(FactChange::Add))
            .chain(gaps)
            .collect();
        self.told = now;
        changes
    }

    /// The same, after a time in which anything may have happened; of no interest to anybody if
    /// nothing was told before: whoever wants to know has it [announced](Self::announce).
    pub(super) fn tell_again(&mut self) -> Vec<FactChange> {
        let was_told = !self.told.is_empty();
        let changes = self.tell(None);
        if was_told { changes } else { Vec::new() }
    }

    /// The same for a superior of whom nobody knows what it believes: nothing else is true of the
    /// whole floor.
    pub(super) fn announce(&mut self) -> Vec<FactChange> {
        let nodes = self.floor.nodes().map(|(node, _)| fact("at", [node]));
        let arcs = self
            .floor
            .passages()
            .flat_map(|(arc, _)| self.imaginable(arc));
        let everything: BTreeSet<_> = nodes.chain(arcs).collect();
        self.told.extend(everything);
        let mut changes = self.tell(None);
        changes.extend(self.doors.keys().map(|door| self.door_fact(door)));
        changes
    }

    /// Facts about the place that hold, and the gaps to both ends of the arc.
    fn standing(&self) -> (BTreeSet<Fact>, Vec<FactChange>) {
        match &self.place {
            None => (BTreeSet::new(), Vec::new()),
            Some(Place::Node { node }) => (BTreeSet::from([fact("at", [node])]), Vec::new()),
            Some(Place::Arc {
                arc,
                offset_m,
                left,
            }) => {
                let mut facts = BTreeSet::from([fact("on", [arc]), fact("left", [left])]);
                let mut gaps = Vec::new();
                for (end, end_m) in self.ends(arc) {
                    gaps.push(FactChange::Set(
                        fact("gap", [arc, end]),
                        (end_m - offset_m).abs(),
                    ));
                    if self.is_free(arc, *offset_m, end_m) == Some(true) {
                        facts.insert(fact("free", [arc, end]));
                    }
                }
                (facts, gaps)
            }
        }
    }

    /// Whether no closed door lies between. `None` for an arc without a door: there the map says
    /// so once and for all.
    fn is_free(&self, arc: &Symbol, here_m: f64, end_m: f64) -> Option<bool> {
        let passage = self.floor.passage(arc)?;
        let door = passage.door.as_ref()?;
        let open = self.doors.get(door) == Some(&true);
        Some(open || !passage.door_lies_between(here_m, end_m))
    }

    fn ends(&self, arc: &Symbol) -> impl Iterator<Item = (&Symbol, f64)> {
        self.floor.passage(arc).into_iter().flat_map(|passage| {
            [
                (&passage.ends[0], 0.0),
                (&passage.ends[1], passage.length_m),
            ]
        })
    }

    /// Every fact about a place that could hold on an arc or at its ends.
    fn imaginable(&self, arc: &Symbol) -> BTreeSet<Fact> {
        let mut facts = BTreeSet::from([fact("on", [arc])]);
        let has_door = self
            .floor
            .passage(arc)
            .is_some_and(|passage| passage.door.is_some());
        for (end, _) in self.ends(arc) {
            facts.insert(fact("at", [end]));
            facts.insert(fact("left", [end]));
            if has_door {
                facts.insert(fact("free", [arc, end]));
            }
        }
        facts
    }
}

/// A fact about objects of the floor.
pub(super) fn fact<const N: usize>(predicate: &str, objects: [&Symbol; N]) -> Fact {
    Fact {
        name: predicate.into(),
        args: objects.into_iter().cloned().collect(),
    }
}
