//! What is in a room as a restaurant opens.

use std::collections::BTreeSet;

use agent_core::model::Time;
use maps::Restaurant;

use super::things::{Bottle, Guest, Spot, Things, Whereabouts};

impl Things {
    /// As the restaurant opens.
    pub(super) fn of(restaurant: &Restaurant) -> Self {
        let plan = restaurant.room();
        let bottles = plan.bottles.iter().map(|(name, bottle)| {
            let node = bottle.place.clone();
            let bottle = Bottle {
                kind: bottle.kind.clone(),
                spot: Spot::Proper { node },
                gripped_by: None,
                given_to: None,
                used: false,
            };
            (name.clone(), bottle)
        });
        let guests = plan.guests.iter().map(|(name, guest)| {
            let table = guest.table.clone();
            let plans = [
                (guest.arrives_s, Whereabouts::Entrance),
                (guest.sits_s, Whereabouts::Seated { table }),
                (guest.leaves_s, Whereabouts::Gone),
            ];
            let plans = plans.into_iter().filter_map(|(at, to)| {
                let at = Time::from_secs(at?);
                Some((at, to))
            });
            let guest = Guest {
                table: guest.table.clone(),
                wants: guest.wants.clone(),
                whereabouts: Whereabouts::Outside,
                served: BTreeSet::new(),
                plans: plans.collect(),
            };
            (name.clone(), guest)
        });
        let places = restaurant.site().nodes().map(|node| node.name().clone());
        Self {
            bottles: bottles.collect(),
            guests: guests.collect(),
            places: places.collect(),
            ..Self::default()
        }
    }
}
