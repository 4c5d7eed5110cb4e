//! Many measurements of one thing.

/// What is said of many measurements, in their unit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Summary {
    /// How many there are.
    pub count: usize,
    /// A tenth is at most this.
    pub p10: f64,
    /// Half of them are at most this.
    pub median: f64,
    /// All but a tenth are at most this.
    pub p90: f64,
    /// All but a hundredth are at most this.
    pub p99: f64,
    /// The largest.
    pub max: f64,
}

impl Summary {
    /// Of these measurements; all zero if there are none. What is not a number is left out.
    pub fn of(measured: impl IntoIterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = measured
            .into_iter()
            .filter(|value| !value.is_nan())
            .collect();
        sorted.sort_by(f64::total_cmp);
        // The nearest rank: a value that was measured, never one in between.
        let at = |part: f64| {
            let rank = (part * sorted.len() as f64).ceil() as usize;
            sorted
                .get(rank.saturating_sub(1))
                .copied()
                .unwrap_or_default()
        };
        Self {
            count: sorted.len(),
            p10: at(0.10),
            median: at(0.50),
            p90: at(0.90),
            p99: at(0.99),
            max: at(1.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_figure_is_one_of_those_measured() {
        let summary = Summary::of((1..=100).rev().map(f64::from));
        let figures = [
            summary.p10,
            summary.median,
            summary.p90,
            summary.p99,
            summary.max,
        ];
        assert_eq!(figures, [10.0, 50.0, 90.0, 99.0, 100.0]);
        assert_eq!(summary.count, 100);
    }

    #[test]
    fn one_measurement_is_all_of_them_and_none_is_nothing() {
        assert_eq!(Summary::of([7.0]).p10, 7.0);
        assert_eq!(Summary::of([7.0]).p99, 7.0);
        assert_eq!(Summary::of([f64::NAN]), Summary::default());
    }
}
