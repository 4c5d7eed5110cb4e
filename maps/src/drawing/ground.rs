//! Areas: their outlines, and colours such that neighbours differ.

use std::collections::{BTreeMap, BTreeSet};

use agent_core::model::Symbol;

use super::frame::Frame;
use crate::{Area, Site};

/// Of an area and its border.
pub(super) const COLOURS: [[&str; 2]; 6] = [
    ["#dde9f5", "#9dbbd8"],
    ["#fbe7cf", "#dfb988"],
    ["#e1f0da", "#a9cf98"],
    ["#f2dfee", "#cfa5c6"],
    ["#fdf4c9", "#dcc873"],
    ["#daf0ee", "#94cbc6"],
];

/// How far an outline that nobody has drawn keeps from its nodes, in pixels.
const PADDING_PX: f64 = 14.0;

/// An outline on the paper.
pub(super) struct Outline {
    /// At least one.
    pub(super) points: Vec<[f64; 2]>,
    /// Its border is drawn that wide, in pixels, in the colour of the area; 0 where somebody has
    /// said what the outline is.
    pub(super) padding_px: f64,
}

impl Outline {
    /// As the map gives it, or around the nodes of the area.
    pub(super) fn of(area: &Area, site: &Site, frame: &Frame) -> Self {
        if let Some([west, south, east, north]) = area.rectangle_m() {
            let corners = [[west, south], [east, south], [east, north], [west, north]];
            return Self {
                points: corners.map(|corner| frame.at(corner)).to_vec(),
                padding_px: 0.0,
            };
        }
        let nodes = area.nodes().filter_map(|node| site.node(node.as_str()));
        Self {
            points: hull(nodes.map(|node| frame.at(node.position_m())).collect()),
            padding_px: PADDING_PX.min(frame.usual_px * 0.4),
        }
    }

    /// Whether a point lies within the outline and its padding. Not if nobody has drawn an outline and
    /// the nodes make none.
    pub(super) fn holds(&self, point: [f64; 2]) -> bool {
        let next = self.points.iter().cycle().skip(1);
        let mut sides = self.points.iter().zip(next);
        // A hull turns left all the way round.
        self.points.len() > 2
            && sides.all(|(from, to)| {
                let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
                let left = dx * (point[1] - from[1]) - dy * (point[0] - from[0]);
                left >= -self.padding_px * dx.hypot(dy)
            })
    }

    /// Left, top, right and bottom.
    pub(super) fn bounds(&self) -> [f64; 4] {
        let mut bounds = [
            f64::INFINITY,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::NEG_INFINITY,
        ];
        for [x, y] in &self.points {
            bounds = [
                bounds[0].min(*x),
                bounds[1].min(*y),
                bounds[2].max(*x),
                bounds[3].max(*y),
            ];
        }
        let grown = self.padding_px;
        [
            bounds[0] - grown,
            bounds[1] - grown,
            bounds[2] + grown,
            bounds[3] + grown,
        ]
    }
}

/// The smallest convex outline around some points, by the monotone chain of A. M. Andrew (1979).
fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|one, other| {
        one[0]
            .total_cmp(&other[0])
            .then(one[1].total_cmp(&other[1]))
    });
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let mut outline = chain(points.iter());
    outline.extend(chain(points.iter().rev()));
    outline
}

/// One side of a hull, without its last point.
fn chain<'a>(points: impl Iterator<Item = &'a [f64; 2]>) -> Vec<[f64; 2]> {
    let mut side: Vec<[f64; 2]> = Vec::new();
    for point in points {
        while let [.., one, other] = side[..]
            && (other[0] - one[0]) * (point[1] - one[1])
                <= (other[1] - one[1]) * (point[0] - one[0])
        {
            side.pop();
        }
        side.push(*point);
    }
    side.pop();
    side
}

/// Which colour each area has. Areas that are joined have different ones as long as there are enough.
pub(super) fn colours(site: &Site) -> BTreeMap<&Symbol, usize> {
    let mut neighbours: BTreeMap<&Symbol, BTreeSet<&Symbol>> = BTreeMap::new();
    for door in site.doors() {
        let [one, other] = door.joins();
        neighbours.entry(one).or_default().insert(other);
        neighbours.entry(other).or_default().insert(one);
    }
    let mut chosen: BTreeMap<&Symbol, usize> = BTreeMap::new();
    for (index, area) in site.areas().enumerate() {
        let around = neighbours.get(area.name());
        let taken: BTreeSet<usize> = around
            .into_iter()
            .flatten()
            .filter_map(|other| chosen.get(other).copied())
            .collect();
        // Not always the first that is free, so that all of them are seen.
        let turns = (0..COLOURS.len()).map(|turn| (index + turn) % COLOURS.len());
        let free = turns.clone().find(|colour| !taken.contains(colour));
        chosen.insert(area.name(), free.unwrap_or(index % COLOURS.len()));
    }
    chosen
}
