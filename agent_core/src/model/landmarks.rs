//! Lower bounds of distances where there are too many to list.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{Fact, Symbol};

/// A function of two things that says how far it is at least from one to the other, kept as how
/// far each of them is from some *landmarks*. A hundred thousand places have ten thousand million
/// distances to each other, but only 1.6 million to sixteen landmarks.
///
/// By the triangle inequality: from a place that is 3 m from a landmark to one that is 10 m from it,
/// it is at least 7 m. (A. Goldberg and C. Harrelson, *Computing the shortest path: A\* search meets
/// graph theory*, 2005.)
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Landmarks {
    function: Symbol,
    from: BTreeMap<Symbol, Vec<Reach>>,
    to: BTreeMap<Symbol, Vec<Reach>>,
}

/// How far a thing is from one landmark and to it, in thousandths of the unit. Of a thing that is in
/// several places, an area, the greatest way from the landmark and the least way to it.
#[derive(Clone, Copy, Debug, Eq, PartialEq, Serialize, Deserialize)]
pub struct Reach {
    /// From the landmark to the thing.
    pub from_landmark: u64,
    /// From the thing to the landmark.
    pub to_landmark: u64,
}

impl Landmarks {
    /// The bounds that `function` names. `from` and `to` say for things that can stand as its first
    /// and second argument how far they are from each landmark, the landmarks in the same order
    /// everywhere.
    pub fn new(
        function: Symbol,
        from: BTreeMap<Symbol, Vec<Reach>>,
        to: BTreeMap<Symbol, Vec<Reach>>,
    ) -> Self {
        Self { function, from, to }
    }

    /// The function's value, if it is this function and both things are known.
    pub fn value(&self, function: &Fact) -> Option<f64> {
        let [from, to] = &function.args[..] else {
            return None;
        };
        if function.name != self.function {
            return None;
        }
        let (from, to) = (self.from.get(from)?, self.to.get(to)?);
        let bounds = from.iter().zip(to).map(|(from, to)| {
            let beyond = to.from_landmark.saturating_sub(from.from_landmark);
            let before = from.to_landmark.saturating_sub(to.to_landmark);
            beyond.max(before)
        });
        // Exact below 2^53.
        Some(bounds.max().unwrap_or_default() as f64 / 1000.0)
    }

    /// The function with things that it has a value for, as one example of all; `None` if there are
    /// none.
    pub fn example(&self) -> Option<Fact> {
        let (from, to) = (self.from.keys().next()?, self.to.keys().next()?);
        Some(Fact {
            name: self.function.clone(),
            args: vec![from.clone(), to.clone()],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two places on a line with a landmark at its beginning.
    fn line() -> Landmarks {
        let at = |metres: u64| {
            vec![Reach {
                from_landmark: metres * 1000,
                to_landmark: metres * 1000,
            }]
        };
        let places = BTreeMap::from([(Symbol::from("a"), at(3)), (Symbol::from("b"), at(10))]);
        Landmarks::new(Symbol::from("distance"), places.clone(), places)
    }

    #[test]
    fn what_is_further_from_the_landmark_is_that_much_further_away() {
        let value = |from, to| line().value(&Fact::new("distance", [from, to]));
        assert_eq!(value("a", "b"), Some(7.0));
        assert_eq!(value("b", "a"), Some(7.0));
        assert_eq!(value("a", "a"), Some(0.0));
    }

    #[test]
    fn other_functions_and_unknown_things_have_no_value() {
        for function in [
            Fact::new("length", ["a", "b"]),
            Fact::new("distance", ["a", "c"]),
            Fact::new("distance", ["a"]),
        ] {
            assert_eq!(line().value(&function), None, "{function}");
        }
    }
}
