//! The names of areas, doors and nodes: those first that are looked for first.

use std::borrow::Cow;
use std::collections::BTreeSet;

use svg::Node as _;
use svg::node::element::{Element, Group};

use super::ground::Outline;
use super::ink::{px, words};
use super::labels::Placed;
use super::{Drawing, sign};
use crate::Node;

/// What stands at places of this rank and above is written beside their names.
const NOTABLE: u8 = 1;
/// Names of this rank and below are not put upon lines where there are many.
const NEGLIGIBLE: u8 = 4;
const MANY: usize = 100;

/// Something that is to be named.
struct Named<'a> {
    /// The less, the sooner.
    rank: u8,
    text: Cow<'a, str>,
    at: [f64; 2],
    /// Of its sign.
    radius: f64,
    class: &'static str,
    size_px: f64,
}

impl Drawing<'_> {
    /// To be called when all is drawn that words must not hide.
    pub(super) fn words(&mut self) -> Group {
        let mut group = Group::new();
        let area_px = (self.frame.usual_px * 0.2).clamp(9.0, 14.0);
        for area in self.site.areas() {
            let outline = Outline::of(area, self.site, &self.frame);
            let name = area.name().as_str();
            let inside = if area.rectangle_m().is_none() {
                self.labels.inside(&outline, name, area_px)
            } else {
                None
            };
            // In a corner of a rectangle; beside an outline that is too small.
            let bounds = outline.bounds();
            let [left, top, right, bottom] = bounds;
            let (middle, radius) = (
                sign::middle([[left, top], [right, bottom]]),
                (right - left) / 2.0,
            );
            let placed = inside
                .or_else(|| self.labels.within(bounds, name, area_px))
                .or_else(|| {
                    self.labels
                        .beside(middle, radius, name, area_px, f64::INFINITY)
                });
            if let Some(placed) = placed {
                group.append(label(name, &placed, "a", area_px));
            }
        }
        let size_px = (self.frame.usual_px * 0.14).clamp(8.0, 11.0);
        let marked: BTreeSet<_> = self.marked().into_iter().map(|(node, _)| node).collect();
        let nodes = self
            .site
            .nodes()
            .map(|node| self.node(node, marked.contains(node.name()), size_px));
        let mut all: Vec<Named<'_>> = nodes.chain(self.doors_named(size_px - 1.0)).collect();
        all.sort_by_key(|named| named.rank);
        let many = self.site.nodes().count() > MANY;
        let mut placed = Vec::new();
        for named in all {
            let most_crossed = if many && named.rank >= NEGLIGIBLE {
                0.4
            } else {
                f64::INFINITY
            };
            let place = self.labels.beside(
                named.at,
                named.radius,
                &named.text,
                named.size_px,
                most_crossed,
            );
            placed
                .extend(place.map(|place| label(&named.text, &place, named.class, named.size_px)));
        }
        for label in placed {
            group.append(label);
        }
        group
    }

    fn node<'b>(&self, node: &'b Node, marked: bool, size_px: f64) -> Named<'b> {
        let look = self.kinds.look(node.kind());
        let name = node.name().as_str();
        let text = match node.kind() {
            Some(kind) if look.rank <= NOTABLE && !name.contains(kind) => {
                Cow::from(format!("{name} {}", kind.replace('_', " ")))
            }
            _ => Cow::from(name),
        };
        // What people have a name for is better known than what only has a number.
        let rank = match node.kind() {
            _ if marked => 0,
            None if name != format!("n{}", node.id()) => NEGLIGIBLE - 1,
            _ => look.rank,
        };
        Named {
            rank,
            text,
            at: self.frame.at(node.position_m()),
            radius: if marked {
                self.mark_px()
            } else {
                self.radius * look.size
            },
            class: match rank {
                _ if marked => "m",
                NEGLIGIBLE.. => "s",
                _ => "w",
            },
            size_px,
        }
    }

    /// Each door once, at the first passage that it is in.
    fn doors_named(&self, size_px: f64) -> Vec<Named<'static>> {
        let mut seen = BTreeSet::new();
        let mut named = Vec::new();
        for passage in self.site.passages() {
            let (Some(door), Some(stroke)) = (passage.door(), self.stroke(passage)) else {
                continue;
            };
            if !seen.insert(door) {
                continue;
            }
            let open = self.is_open(passage);
            named.push(Named {
                rank: if open { 3 } else { 1 },
                text: Cow::from(door.to_string()),
                at: sign::middle(stroke),
                radius: self.door_px(),
                class: if open { "d" } else { "d shut-d" },
                size_px,
            });
        }
        named
    }
}

fn label(text: &str, placed: &Placed, class: &str, size_px: f64) -> Element {
    let mut label = words(text, placed.at, class);
    label.assign("font-size", px(size_px));
    if placed.anchor != "start" {
        label.assign("text-anchor", placed.anchor);
    }
    label
}
