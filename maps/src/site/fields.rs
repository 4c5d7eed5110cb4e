//! What one feature says of itself.

use agent_core::model::Symbol;
use geojson::{JsonObject, JsonValue};

use super::faults::{Faults, Origin};
use super::read::{EdgeFeature, NodeFeature};

/// Nav2's Route Server counts in 32 bits, its messages in 16 (`maps/README.md`).
const MAX_ID: u64 = 4_294_967_295;
/// Sums of lengths stay far from the limits of their type.
const MAX_LENGTH_M: f64 = 1e6;

/// The properties of one feature, and where to complain about them.
pub(super) struct Fields<'a> {
    pub(super) properties: &'a JsonObject,
    pub(super) metadata: &'a JsonObject,
    pub(super) origin: &'a mut Origin,
    pub(super) faults: &'a mut Faults,
}

impl Fields<'_> {
    pub(super) fn fault(&mut self, message: impl std::fmt::Display) {
        self.faults.about(self.origin, message);
    }

    pub(super) fn id(&mut self, what: &str) -> Option<u32> {
        let Some(value) = self.properties.get("id") else {
            self.fault(format!("is meant as {what}, but has no `properties.id`"));
            return None;
        };
        match value.as_u64() {
            Some(id) if id <= MAX_ID => u32::try_from(id).ok(),
            Some(id) => {
                self.fault(format!(
                    "has the id {id}; the largest that Nav2 knows is {MAX_ID}"
                ));
                None
            }
            None => {
                self.fault(format!("has the id {value}, which is not a whole number"));
                None
            }
        }
    }

    /// Text in the metadata. What is there but is no text is a fault.
    fn text(&mut self, key: &str) -> Option<String> {
        match self.metadata.get(key)? {
            JsonValue::String(text) => Some(text.clone()),
            _ => {
                self.fault(format!("has a `metadata.{key}` that is not text"));
                None
            }
        }
    }

    pub(super) fn name(&mut self, key: &str) -> Option<Symbol> {
        let text = self.text(key)?;
        symbol(&text)
            .map_err(|message| {
                self.fault(format!(
                    "has a `metadata.{key}` that cannot be used: {message}"
                ))
            })
            .ok()
    }

    /// A number in metres, from an object of the feature.
    fn metres(&mut self, key: &str, value: &JsonValue) -> Option<f64> {
        match value.as_f64() {
            Some(value) if (0.001..=MAX_LENGTH_M).contains(&value) => Some(value),
            _ => {
                let message = format!("has `{key}` {value}, which is no length in metres");
                self.fault(message);
                None
            }
        }
    }

    fn length_m(&mut self) -> Option<f64> {
        if let Some(value) = self.metadata.get("length_m") {
            return self.metres("length_m", value);
        }
        match self.properties.get("cost") {
            // Nav2 takes 0 for an edge that does not say.
            Some(value) if value.as_f64() != Some(0.0) => self.metres("cost", value),
            _ => {
                self.fault("has no length: neither `metadata.length_m` nor a `cost` above 0");
                None
            }
        }
    }

    pub(super) fn node(
        mut self,
        id: u32,
        name: Option<Symbol>,
        position: &[f64],
    ) -> Option<NodeFeature> {
        let position_m = match position {
            [x, y, ..] if x.is_finite() && y.is_finite() => Some([*x, *y]),
            _ => {
                self.fault("has no coordinates");
                None
            }
        };
        let area = if self.metadata.contains_key("area") {
            self.name("area")
        } else {
            self.fault("lies in no area: it has no `metadata.area`");
            None
        };
        let (kind, label) = (self.text("kind"), self.text("label"));
        Some(NodeFeature {
            origin: self.origin.clone(),
            id,
            name: name.unwrap_or_else(|| Symbol::from(format!("n{id}"))),
            area: area?,
            kind,
            label,
            position_m: position_m?,
        })
    }

    pub(super) fn edge(mut self, id: u32, name: Option<Symbol>) -> Option<EdgeFeature> {
        let [start, end] = ["startid", "endid"].map(|key| {
            let value = self.properties.get(key).and_then(JsonValue::as_u64);
            if value.is_none() {
                self.fault(format!("has no `{key}`, the id of a node"));
            }
            value
        });
        let length_m = self.length_m();
        let door = self.name("door");
        Some(EdgeFeature {
            origin: self.origin.clone(),
            id,
            start: start?,
            end: end?,
            named: name.is_some(),
            name: name.unwrap_or_else(|| Symbol::from(format!("arc{id}"))),
            length_m,
            door_unclear: door.is_none() && self.metadata.contains_key("door"),
            door,
        })
    }
}

/// A name as the domains can have it: HDDL knows no upper case, and no spaces in names.
pub(super) fn symbol(text: &str) -> Result<Symbol, String> {
    let letters = |letter: char| letter.is_ascii_alphanumeric() || "-_".contains(letter);
    if text.starts_with(|first: char| first.is_ascii_alphabetic()) && text.chars().all(letters) {
        Ok(Symbol::from(text.to_ascii_lowercase()))
    } else {
        let rule = "a name is a letter, then letters, digits, `-` and `_`";
        Err(format!("{text:?} is not a name of HDDL ({rule})"))
    }
}
