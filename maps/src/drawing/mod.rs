//! A map as a picture: SVG that needs nothing beside it, the same for the same map.

mod frame;
mod ground;
mod ink;
mod kinds;
mod labels;
mod legend;
mod naming;
mod sign;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};

use agent_core::model::Symbol;
use svg::Node as _;
use svg::node::element::{Group, Rectangle, Style};

use crate::{Node, Passage, Route, Site};
use frame::{Frame, MARGIN_PX};
use ground::{COLOURS, Outline};
use ink::{element, line, px, tip, words};
use kinds::Kinds;
use labels::Labels;
use legend::{Used, legend, ring, scale_bar};

/// Legend and title need some room.
const LEAST_WIDTH_PX: f64 = 620.0;
const TITLE_PX: f64 = 58.0;
/// For the scale bar, beside the legend.
const BAR_PX: f64 = 150.0;
/// A large picture is looked at from further away: title and legend grow with its width, from so
/// many pixels on.
const USUAL_WIDTH_PX: f64 = 1400.0;
/// Above so many nodes nothing says what it is when the pointer rests on it: the file would be large.
const MOST_TIPS: usize = 2000;

/// What a picture shows beside the map itself.
#[derive(Clone, Debug, Default)]
pub struct Picture {
    /// How doors stand that do not stand as they do when the world begins.
    pub doors: BTreeMap<Symbol, bool>,
    /// Where the robot starts.
    pub start: Option<Symbol>,
    /// A way to be shown.
    pub route: Option<Route>,
}

impl Picture {
    /// Whether a door stands open in this picture. A door that is not on the map does.
    pub fn is_open(&self, site: &Site, door: &str) -> bool {
        let at_first = || site.door(door).is_none_or(crate::Door::is_open_at_first);
        self.doors.get(door).copied().unwrap_or_else(at_first)
    }

    /// A shortest way through the doors that stand open in this picture. `None` if there is none, or
    /// no such node.
    pub fn find_route(&self, site: &Site, from: &str, to: &str) -> Option<Route> {
        site.route(from, to, |passage| {
            passage
                .door()
                .is_none_or(|door| self.is_open(site, door.as_str()))
        })
    }

    /// The map as SVG. The same map and picture make the same text.
    pub fn svg(&self, site: &Site) -> String {
        let mut frame = Frame::around(site, [MARGIN_PX, MARGIN_PX], LEAST_WIDTH_PX);
        let grown = (frame.size_px[0] / USUAL_WIDTH_PX).max(1.0);
        frame.corner_px[1] += TITLE_PX * grown;
        let mut drawing = Drawing {
            site,
            picture: self,
            kinds: Kinds::of(site),
            // About as large as the dots of a city map, and smaller where they stand close.
            radius: (frame.usual_px * 0.07).clamp(1.4, 6.0),
            tips: site.nodes().count() <= MOST_TIPS,
            labels: Labels::on(frame.width_px()),
            frame,
            grown,
        };
        drawing.document()
    }
}

struct Drawing<'a> {
    site: &'a Site,
    picture: &'a Picture,
    kinds: Kinds<'a>,
    frame: Frame,
    /// How much larger than usual title and legend are.
    grown: f64,
    radius: f64,
    tips: bool,
    labels: Labels,
}

impl<'a> Drawing<'a> {
    fn document(&mut self) -> String {
        let frame = &self.frame;
        let width = frame.width_px();
        let below = frame.corner_px[1] + frame.size_px[1] + MARGIN_PX;
        let grown = self.grown;
        let room = (width - 2.0 * MARGIN_PX) / grown - BAR_PX;
        let (signs, high) = legend(&self.used(), &self.kinds, room);
        let height = below + high * grown + MARGIN_PX / 2.0;
        let signs = signs.set("transform", moved([MARGIN_PX, below], grown));
        let bar = scale_bar(frame.px_per_m / grown)
            .set("transform", moved([width - MARGIN_PX, below], grown));
        let layers = [
            self.title(),
            self.areas(),
            self.passages(),
            self.route(),
            self.doors(),
            self.nodes(),
        ];
        // Last, when everything that words must not hide is known.
        let words = self.words();
        let mut document = svg::Document::new()
            .set("viewBox", format!("0 0 {} {}", px(width), px(height)))
            .set("width", px(width))
            .set("height", px(height))
            .set("font-family", "Helvetica, Arial, 'DejaVu Sans', sans-serif")
            .add(Style::new(STYLE))
            .add(
                Rectangle::new()
                    .set("class", "paper")
                    .set("width", "100%")
                    .set("height", "100%"),
            );
        for layer in layers.into_iter().chain([words, signs, bar]) {
            document.append(layer);
        }
        format!("{document}\n")
    }

    fn used(&self) -> Used {
        let doors = || {
            self.site
                .doors()
                .map(|door| self.picture.is_open(self.site, door.name().as_str()))
        };
        Used {
            one_way: self.site.passages().any(Passage::is_one_way),
            open: doors().any(|open| open),
            closed: doors().any(|open| !open),
            start: self.picture.start.is_some(),
            route: self.picture.route.is_some(),
            unkind: self.site.nodes().any(|node| node.kind().is_none()),
        }
    }

    fn title(&self) -> Group {
        let name = match self.site.name() {
            "" => "map",
            name => name,
        };
        let mut about = self.site.summary().to_string();
        if let Some(route) = &self.picture.route
            && let [from, .., to] = &route.nodes[..]
        {
            about.push_str(&format!(
                "; from {from} to {to} it is {:.1} m",
                route.length_m
            ));
        }
        Group::new()
            .set("transform", moved([MARGIN_PX, MARGIN_PX], self.grown))
            .add(words(name, [0.0, 8.0], "title"))
            .add(words(&about, [0.0, 28.0], "l"))
    }

    fn areas(&mut self) -> Group {
        let colours = ground::colours(self.site);
        let mut group = Group::new();
        for area in self.site.areas() {
            let outline = Outline::of(area, self.site, &self.frame);
            let [fill, border] = COLOURS[colours.get(area.name()).copied().unwrap_or(0)];
            if outline.padding_px == 0.0 {
                let next = outline.points.iter().cycle().skip(1);
                for (from, to) in outline.points.iter().zip(next) {
                    self.labels.stroke([*from, *to]);
                }
            }
            let path = format!("{}Z", line(&outline.points));
            let mut drawn = if outline.padding_px > 0.0 {
                // The border, as wide as the padding, in the colour of the area, upon a wider one.
                let wide = |grown: f64, colour: &str| {
                    let width = px(2.0 * (outline.padding_px + grown));
                    element(
                        "path",
                        &[
                            ("class", "hull"),
                            ("d", &path),
                            ("fill", colour),
                            ("stroke", colour),
                            ("stroke-width", &width),
                        ],
                    )
                };
                group.append(wide(1.0, border));
                wide(0.0, fill)
            } else {
                element(
                    "path",
                    &[
                        ("class", "area"),
                        ("d", &path),
                        ("fill", fill),
                        ("stroke", border),
                    ],
                )
            };
            if self.tips {
                drawn.append(tip(&format!(
                    "{}: {} nodes",
                    area.name(),
                    area.nodes().count()
                )));
            }
            group.append(drawn);
        }
        group
    }

    /// From where to where a passage is drawn.
    fn stroke(&self, passage: &Passage) -> Option<[[f64; 2]; 2]> {
        let [from, to] = passage.ends().map(|end| self.site.node(end.as_str()));
        Some([
            self.frame.at(from?.position_m()),
            self.frame.at(to?.position_m()),
        ])
    }

    fn is_open(&self, passage: &Passage) -> bool {
        passage
            .door()
            .is_none_or(|door| self.picture.is_open(self.site, door.as_str()))
    }

    fn passages(&mut self) -> Group {
        let (mut free, mut shut, mut arrows) = (String::new(), String::new(), String::new());
        for passage in self.site.passages() {
            let Some(stroke) = self.stroke(passage) else {
                continue;
            };
            self.labels.stroke(stroke);
            let path = if self.is_open(passage) {
                &mut free
            } else {
                &mut shut
            };
            path.push_str(&line(&stroke));
            if passage.is_one_way() {
                arrows.push_str(&sign::arrow(stroke, self.radius.max(2.0)));
            }
        }
        let width = px((self.radius * 0.35).clamp(0.8, 2.0));
        let mut group = Group::new().set("stroke-width", width);
        for (class, path) in [("p", free), ("p shut", shut), ("arrow", arrows)] {
            if !path.is_empty() {
                group.append(element("path", &[("class", class), ("d", &path)]));
            }
        }
        group
    }

    fn route(&self) -> Group {
        let mut group = Group::new();
        if let Some(route) = &self.picture.route {
            let nodes = route
                .nodes
                .iter()
                .filter_map(|node| self.site.node(node.as_str()));
            let points: Vec<_> = nodes.map(|node| self.frame.at(node.position_m())).collect();
            group.append(element(
                "path",
                &[("class", "route"), ("d", &line(&points))],
            ));
        }
        group
    }

    fn doors(&mut self) -> Group {
        let size = self.door_px();
        let mut group = Group::new().set("stroke-width", px((size * 0.45).clamp(1.6, 4.0)));
        for passage in self.site.passages() {
            let (Some(door), Some(stroke)) = (passage.door(), self.stroke(passage)) else {
                continue;
            };
            let open = self.is_open(passage);
            let class = if open { "open" } else { "closed" };
            let mut drawn = element(
                "path",
                &[("class", class), ("d", &sign::door(stroke, size, open))],
            );
            if self.tips {
                drawn.append(tip(&format!("{door}, {class}")));
            }
            group.append(drawn);
            self.labels.occupy_dot(sign::middle(stroke), size * 0.8);
        }
        group
    }

    fn nodes(&mut self) -> Group {
        let mut group = Group::new();
        for node in self.site.nodes() {
            let [x, y] = self.frame.at(node.position_m());
            let look = self.kinds.look(node.kind());
            let radius = self.radius * look.size;
            let mut drawn = element(
                "circle",
                &[
                    ("class", "n"),
                    ("cx", &px(x)),
                    ("cy", &px(y)),
                    ("r", &px(radius)),
                    ("fill", look.colour),
                ],
            );
            if self.tips {
                drawn.append(tip(&described(node)));
            }
            group.append(drawn);
            self.labels.occupy_dot([x, y], radius);
        }
        for (name, class) in self.marked() {
            if let Some(node) = self.site.node(name.as_str()) {
                let at = self.frame.at(node.position_m());
                group.append(ring(at, self.mark_px(), class));
                self.labels.occupy_dot(at, self.mark_px());
            }
        }
        group
    }

    /// From the middle of a passage to the end of the sign of its door.
    fn door_px(&self) -> f64 {
        (self.radius * 1.6).max(3.0)
    }

    /// Radius of the ring around a node that is marked.
    fn mark_px(&self) -> f64 {
        self.radius * 1.3 + 3.5
    }

    /// Nodes with a ring, and of which class.
    fn marked(&self) -> Vec<(&'a Symbol, &'static str)> {
        let picture = self.picture;
        let route = picture.route.iter().flat_map(|route| {
            let [first, last] = [route.nodes.first(), route.nodes.last()];
            first
                .map(|node| (node, "ends"))
                .into_iter()
                .chain(last.map(|node| (node, "ends")))
        });
        let start = picture.start.iter().map(|start| (start, "start"));
        let mut marked: Vec<_> = start.chain(route).collect();
        let mut seen = BTreeSet::new();
        marked.retain(|(node, _)| seen.insert(*node));
        marked
    }
}

/// From the origin to a place, and larger.
fn moved([x, y]: [f64; 2], grown: f64) -> String {
    if grown > 1.0 {
        format!("translate({} {}) scale({grown:.3})", px(x), px(y))
    } else {
        format!("translate({} {})", px(x), px(y))
    }
}

fn described(node: &Node) -> String {
    let (name, area, label) = (node.name(), node.area(), node.label());
    let kind = node
        .kind()
        .map_or_else(String::new, |kind| format!(" ({})", kind.replace('_', " ")));
    if label == name.as_str() {
        format!("{name}{kind}, {area}")
    } else {
        format!("{name}: {label}{kind}, {area}")
    }
}

const STYLE: &str = "\
.paper{fill:#fff}
.title{font-size:22px;font-weight:bold;fill:#1f2933}
.l{font-size:12px;fill:#52606d}
.mid{text-anchor:middle}
.area{stroke-width:1.5}
.hull{stroke-linejoin:round;stroke-linecap:round}
.p{fill:none;stroke:#66727f;stroke-linecap:round}
.legend .p{stroke-width:2}
.shut{stroke:#b91c1c;stroke-dasharray:3 4;opacity:.7}
.arrow{fill:#3e4c59}
.route{fill:none;stroke:#f59e0b;stroke-width:7;stroke-opacity:.75;stroke-linecap:round;stroke-linejoin:round}
.open{fill:none;stroke:#7c4a12}
.closed{fill:none;stroke:#c81e1e}
.legend .open,.legend .closed{stroke-width:4}
.n{stroke:#fff;stroke-width:1}
.start{fill:none;stroke:#15803d;stroke-width:2.5}
.ends{fill:none;stroke:#b45309;stroke-width:2.5}
.bar{fill:none;stroke:#1f2933;stroke-width:1.5}
.a,.m,.w,.s,.d{paint-order:stroke;stroke:#fff;stroke-opacity:.8;stroke-width:2.5;stroke-linejoin:round}
.a{font-weight:bold;fill:#52606d}
.w{fill:#1f2933}
.s{fill:#7b8794}
.m{font-weight:bold;fill:#1f2933}
.d{font-style:italic;fill:#7c4a12}
.shut-d{fill:#c81e1e}";
