//! `experiment restaurant`.

use experiments::{ExperimentError, Onlooker, Report, Restaurants};

use crate::cli::RestaurantArgs;

pub(super) fn run(
    args: &RestaurantArgs,
    onlooker: &mut dyn Onlooker,
) -> Result<Report, ExperimentError> {
    let what = match args.quick {
        true => Restaurants {
            runs: 10,
            guests: vec![2, 5],
            carriers: vec![1, 2],
            evenings: 2,
            seed: args.seed,
        },
        false => Restaurants {
            runs: args.runs,
            guests: args.guests.clone(),
            carriers: args.carriers.clone(),
            evenings: args.evenings,
            seed: args.seed,
        },
    };
    experiments::restaurant(&what, onlooker)
}
