//! The signs of the map, drawn upon a stroke from point to point.

use super::ink::line;
use super::kinds::Look;

/// What can be explained in the legend.
pub(super) enum Sign {
    Start,
    Route,
    Passage,
    OneWay,
    Door { open: bool },
    Dot(Look),
    Nothing,
}

/// The direction of a stroke, of length 1; to the right if it has none.
fn direction([from, to]: [[f64; 2]; 2]) -> [f64; 2] {
    let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    let length = dx.hypot(dy);
    if length > 1e-6 {
        [dx / length, dy / length]
    } else {
        [1.0, 0.0]
    }
}

/// A point on a stroke, and beside it.
fn point([from, to]: [[f64; 2]; 2], part: f64, along: f64, across: f64) -> [f64; 2] {
    let [dx, dy] = direction([from, to]);
    [
        from[0] + (to[0] - from[0]) * part + dx * along - dy * across,
        from[1] + (to[1] - from[1]) * part + dy * along + dx * across,
    ]
}

/// A small triangle beyond the middle, for one-way passages.
pub(super) fn arrow(stroke: [[f64; 2]; 2], size: f64) -> String {
    let corners = [
        (size, 0.0),
        (-size * 0.8, size * 0.75),
        (-size * 0.8, -size * 0.75),
    ];
    let corners = corners.map(|(along, across)| point(stroke, 0.6, along, across));
    format!("{}Z", line(&corners))
}

/// Two posts with a way between them, or a bar across the way, in the middle of a passage.
pub(super) fn door(stroke: [[f64; 2]; 2], size: f64, open: bool) -> String {
    let across =
        |from: f64, to: f64| line(&[point(stroke, 0.5, 0.0, from), point(stroke, 0.5, 0.0, to)]);
    if open {
        format!(
            "{}{}",
            across(-size, -size * 0.45),
            across(size * 0.45, size)
        )
    } else {
        across(-size, size)
    }
}

/// Where the sign of a door is.
pub(super) fn middle([from, to]: [[f64; 2]; 2]) -> [f64; 2] {
    [(from[0] + to[0]) / 2.0, (from[1] + to[1]) / 2.0]
}
