//! How fast a body goes: trapezoids of speed over time.

use serde::{Deserialize, Serialize};

/// What the mover can do. All of these are positive; with a zero among them it never arrives.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MoverSpec {
    /// Top speed.
    pub max_speed_m_s: f64,
    /// How quickly it gains speed.
    pub acceleration_m_s2: f64,
    /// How quickly it loses speed, when braking as well as when arriving.
    pub deceleration_m_s2: f64,
    /// How quickly it turns on the spot.
    pub turn_rate_rad_s: f64,
}

impl Default for MoverSpec {
    /// A walking pace, as in a museum.
    fn default() -> Self {
        Self {
            max_speed_m_s: 1.0,
            acceleration_m_s2: 0.5,
            deceleration_m_s2: 1.0,
            turn_rate_rad_s: 1.5,
        }
    }
}

impl MoverSpec {
    /// The way that it needs to stop from that speed.
    pub fn braking_distance_m(&self, speed_m_s: f64) -> f64 {
        speed_m_s * speed_m_s / (2.0 * self.deceleration_m_s2)
    }
}

/// Speed over time for one stretch: gain, keep, lose. Ends at standstill.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Profile {
    peak_m_s: f64,
    acceleration_m_s2: f64,
    deceleration_m_s2: f64,
    gain_s: f64,
    keep_s: f64,
    lose_s: f64,
    distance_m: f64,
}

impl Profile {
    /// From standstill over that distance, as fast as `pace` (a share of the top speed) allows.
    pub(crate) fn travel(spec: &MoverSpec, pace: f64, distance_m: f64) -> Self {
        let (gain, lose) = (spec.acceleration_m_s2, spec.deceleration_m_s2);
        // On a short way there is no time to reach the top speed: v²/2a + v²/2b = distance.
        let reachable_m_s = (2.0 * distance_m * gain * lose / (gain + lose)).sqrt();
        let peak_m_s = (spec.max_speed_m_s * pace).min(reachable_m_s);
        let ramps_m = peak_m_s * peak_m_s * (0.5 / gain + 0.5 / lose);
        let keep_s = if peak_m_s > 0.0 {
            ((distance_m - ramps_m) / peak_m_s).max(0.0)
        } else {
            0.0
        };
        Self {
            peak_m_s,
            acceleration_m_s2: gain,
            deceleration_m_s2: lose,
            gain_s: peak_m_s / gain,
            keep_s,
            lose_s: peak_m_s / lose,
            distance_m,
        }
    }

    /// From that speed to standstill.
    pub(crate) fn braking(spec: &MoverSpec, speed_m_s: f64) -> Self {
        Self {
            peak_m_s: speed_m_s,
            acceleration_m_s2: spec.acceleration_m_s2,
            deceleration_m_s2: spec.deceleration_m_s2,
            gain_s: 0.0,
            keep_s: 0.0,
            lose_s: speed_m_s / spec.deceleration_m_s2,
            distance_m: spec.braking_distance_m(speed_m_s),
        }
    }

    /// How long it takes.
    pub(crate) fn duration_s(&self) -> f64 {
        self.gain_s + self.keep_s + self.lose_s
    }

    /// How far it goes.
    pub(crate) fn distance_m(&self) -> f64 {
        self.distance_m
    }

    /// Metres gone and metres a second, that long after the beginning.
    pub(crate) fn at(&self, elapsed_s: f64) -> (f64, f64) {
        if elapsed_s <= 0.0 && self.gain_s > 0.0 {
            return (0.0, 0.0);
        }
        if elapsed_s < self.gain_s {
            let speed = self.acceleration_m_s2 * elapsed_s;
            return (0.5 * speed * elapsed_s, speed);
        }
        let left_s = self.duration_s() - elapsed_s;
        if left_s <= 0.0 {
            return (self.distance_m, 0.0);
        }
        if left_s <= self.lose_s {
            // Counted from the end, so that the end is reached exactly.
            let speed = self.deceleration_m_s2 * left_s;
            return (self.distance_m - 0.5 * speed * left_s, speed);
        }
        let gained_m = 0.5 * self.peak_m_s * self.gain_s;
        (
            gained_m + self.peak_m_s * (elapsed_s - self.gain_s),
            self.peak_m_s,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_way_is_a_trapezoid_and_a_short_one_a_triangle() {
        let spec = MoverSpec::default();
        // 2 s to gain 1 m/s over 1 m, 1 s to lose it over 0.5 m, 8.5 m between.
        let long = Profile::travel(&spec, 1.0, 10.0);
        assert!((long.duration_s() - 11.5).abs() < 1e-12);
        assert_eq!(long.at(2.0), (1.0, 1.0));
        // 0.5 = v² + v²/2, so v² = 1/3.
        let short = Profile::travel(&spec, 1.0, 0.5);
        let peak = (1.0_f64 / 3.0).sqrt();
        assert!((short.duration_s() - 3.0 * peak).abs() < 1e-12);
    }

    #[test]
    fn no_stretch_jumps_and_every_stretch_ends_where_it_should() {
        let spec = MoverSpec::default();
        for distance_m in [0.0, 0.001, 0.7, 1.5, 1.6, 33.0] {
            for pace in [0.2, 0.7, 1.0] {
                let profile = Profile::travel(&spec, pace, distance_m);
                let steps = 1000;
                let step_s = profile.duration_s() / f64::from(steps);
                let (mut gone_m, mut speed_m_s) = (0.0, 0.0);
                for step in 1..=steps {
                    let (next_m, next_m_s) = profile.at(step_s * f64::from(step));
                    assert!(next_m >= gone_m && next_m - gone_m <= step_s + 1e-12);
                    assert!((next_m_s - speed_m_s).abs() <= step_s * 1.001 + 1e-12);
                    (gone_m, speed_m_s) = (next_m, next_m_s);
                }
                assert!((gone_m - distance_m).abs() < 1e-9 && speed_m_s < 1e-9);
            }
        }
    }
}
