//! `room.toml`, as its author writes it.

use std::collections::BTreeMap;

use agent_core::language::{excerpt, parse_pattern};
use agent_core::model::Symbol;
use serde::Deserialize;
use toml::Spanned;

use super::plan::{BottlePlan, GuestPlan, MoverPlan, RoomPlan, VehiclePlan, hint};
use crate::execution_model::place_of;
use crate::{Finding, Level, Site};

/// Text with its place in the file.
type Text = Spanned<String>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RoomEntry {
    #[serde(default)]
    mover: MoverEntry,
    #[serde(default)]
    vehicle: BTreeMap<Text, VehicleEntry>,
    #[serde(default)]
    bottle: BTreeMap<Text, BottleEntry>,
    #[serde(default)]
    guest: BTreeMap<Text, GuestEntry>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct MoverEntry {
    speed_m_s: Option<Spanned<f64>>,
    acceleration_m_s2: Option<Spanned<f64>>,
    deceleration_m_s2: Option<Spanned<f64>>,
    turn_rate_rad_s: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct VehicleEntry {
    start: Text,
    #[serde(default)]
    can: Vec<Text>,
    parts: Vec<Text>,
    #[serde(default)]
    provides: BTreeMap<Text, Text>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BottleEntry {
    kind: Text,
    place: Text,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct GuestEntry {
    table: Text,
    wants: Text,
    arrives_s: Option<Spanned<f64>>,
    sits_s: Option<Spanned<f64>>,
    leaves_s: Option<Spanned<f64>>,
}

/// Reads who and what is in a restaurant, and checks it against its map and its domain.
///
/// Without these, because they have faults of their own, only what needs neither is checked.
pub(super) fn read_room(
    file: &str,
    text: &str,
    site: Option<&Site>,
    level: Option<&Level>,
) -> Result<RoomPlan, Vec<Finding>> {
    let mut reader = Reader {
        file,
        text,
        places: BTreeMap::new(),
        findings: Vec::new(),
    };
    let plan = match toml::from_str::<RoomEntry>(text) {
        Ok(entry) => reader.plan(entry, level),
        Err(error) => {
            let at = error.span().map_or(0, |span| span.start);
            reader.fault(at, error.message());
            RoomPlan::default()
        }
    };
    if let (Some(site), Some(level), []) = (site, level, reader.findings.as_slice()) {
        for (key, message) in plan.faults(site, level) {
            let at = reader.place(&key);
            reader.fault(at, &format!("{key}: {message}"));
        }
    }
    if reader.findings.is_empty() {
        return Ok(plan);
    }
    reader.findings.sort_by_key(|(at, _)| *at);
    Err(reader
        .findings
        .into_iter()
        .map(|(_, finding)| finding)
        .collect())
}

struct Reader<'t> {
    file: &'t str,
    text: &'t str,
    /// Where each key stands that a check may speak of.
    places: BTreeMap<String, usize>,
    /// With the byte at which each stands.
    findings: Vec<(usize, Finding)>,
}

impl Reader<'_> {
    fn fault(&mut self, at: usize, message: &str) {
        let (line, column) = place_of(self.text, at);
        let finding = Finding {
            file: self.file.to_owned(),
            place: format!("{line}:{column}"),
            message: message.to_owned(),
            excerpt: excerpt(self.text, line, column).unwrap_or_default(),
        };
        self.findings.push((at, finding));
    }

    /// Where that key stands, or what it is part of.
    fn place(&self, key: &str) -> usize {
        let mut key = key;
        loop {
            match (self.places.get(key), key.rsplit_once('.')) {
                (Some(at), _) => return *at,
                (None, Some((above, _))) => key = above,
                (None, None) => return 0,
            }
        }
    }

    /// A name, in the small letters in which HDDL has it.
    fn name(&mut self, key: String, text: &Text) -> Symbol {
        self.places.insert(key, text.span().start);
        Symbol::from(text.get_ref().to_lowercase())
    }

    fn number(&mut self, key: String, value: Option<Spanned<f64>>, otherwise: f64) -> f64 {
        self.time(key, value).unwrap_or(otherwise)
    }

    fn time(&mut self, key: String, value: Option<Spanned<f64>>) -> Option<f64> {
        let value = value?;
        self.places.insert(key, value.span().start);
        Some(*value.get_ref())
    }

    fn plan(&mut self, entry: RoomEntry, level: Option<&Level>) -> RoomPlan {
        let mut plan = RoomPlan::default();
        let usual = MoverPlan::default();
        let mover = entry.mover;
        let key = |part: &str| format!("mover.{part}");
        plan.mover = MoverPlan {
            speed_m_s: self.number(key("speed_m_s"), mover.speed_m_s, usual.speed_m_s),
            acceleration_m_s2: self.number(
                key("acceleration_m_s2"),
                mover.acceleration_m_s2,
                usual.acceleration_m_s2,
            ),
            deceleration_m_s2: self.number(
                key("deceleration_m_s2"),
                mover.deceleration_m_s2,
                usual.deceleration_m_s2,
            ),
            turn_rate_rad_s: self.number(
                key("turn_rate_rad_s"),
                mover.turn_rate_rad_s,
                usual.turn_rate_rad_s,
            ),
        };
        for (name, entry) in entry.vehicle {
            let key = format!("vehicle.{}", name.get_ref().to_lowercase());
            let symbol = self.name(key.clone(), &name);
            let vehicle = self.vehicle(&key, entry, level);
            let twice = plan.vehicles.insert(symbol, vehicle).is_some();
            self.once(&name, twice);
        }
        for (name, entry) in entry.bottle {
            let key = format!("bottle.{}", name.get_ref().to_lowercase());
            let symbol = self.name(key.clone(), &name);
            let bottle = BottlePlan {
                kind: self.name(format!("{key}.kind"), &entry.kind),
                place: self.name(format!("{key}.place"), &entry.place),
            };
            let twice = plan.bottles.insert(symbol, bottle).is_some();
            self.once(&name, twice);
        }
        for (name, entry) in entry.guest {
            let key = format!("guest.{}", name.get_ref().to_lowercase());
            let symbol = self.name(key.clone(), &name);
            let guest = GuestPlan {
                table: self.name(format!("{key}.table"), &entry.table),
                wants: self.name(format!("{key}.wants"), &entry.wants),
                arrives_s: self.time(format!("{key}.arrives_s"), entry.arrives_s),
                sits_s: self.time(format!("{key}.sits_s"), entry.sits_s),
                leaves_s: self.time(format!("{key}.leaves_s"), entry.leaves_s),
            };
            let twice = plan.guests.insert(symbol, guest).is_some();
            self.once(&name, twice);
        }
        plan
    }

    fn once(&mut self, name: &Text, twice: bool) {
        if twice {
            let message = format!("`{}` is there already, in other letters", name.get_ref());
            self.fault(name.span().start, &message);
        }
    }

    fn vehicle(&mut self, key: &str, entry: VehicleEntry, level: Option<&Level>) -> VehiclePlan {
        let start = self.name(format!("{key}.start"), &entry.start);
        let mut list = |part: &str, texts: &[Text]| {
            let texts = texts.iter();
            texts
                .map(|text| {
                    let name = text.get_ref().to_lowercase();
                    self.name(format!("{key}.{part}.{name}"), text)
                })
                .collect()
        };
        let can = list("can", &entry.can);
        let parts = list("parts", &entry.parts);
        let mut vehicle = VehiclePlan {
            start,
            can,
            parts,
            provides: BTreeMap::new(),
        };
        for (predicate, task) in entry.provides {
            let symbol = self.name(format!("{key}.provides"), &predicate);
            let Some(level) = level else { continue };
            let Some(parameters) = level.domain.predicates.get(&symbol) else {
                let known = level.domain.predicates.keys();
                let hint = hint(&symbol, known.map(Symbol::as_str));
                let message =
                    format!("{key}.provides: `{symbol}` is not a predicate of the domain{hint}");
                self.fault(predicate.span().start, &message);
                continue;
            };
            match parse_pattern(task.get_ref(), parameters) {
                Ok(task) => {
                    vehicle.provides.insert(symbol, task);
                }
                Err(error) => {
                    let message = format!("{key}.provides: {}", error.message);
                    self.fault(task.span().start, &message);
                }
            }
        }
        vehicle
    }
}
