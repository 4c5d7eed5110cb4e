//! What the signs mean, and how long a metre is.

use svg::Node;
use svg::node::element::{Element, Group};

use super::ink::{element, line, px, width_px, words};
use super::kinds::Kinds;
use super::sign::{Sign, arrow, door};

const SIZE_PX: f64 = 12.0;
const ROW_PX: f64 = 22.0;
/// Between a sign and its words, and between one entry and the next.
const SIGN_PX: f64 = 30.0;
const GAP_PX: f64 = 20.0;
/// More kinds than that are not explained.
const MOST_KINDS: usize = 16;

/// One sign, and what it means.
struct Entry {
    sign: Sign,
    words: String,
}

/// Which signs occur.
pub(super) struct Used {
    pub(super) one_way: bool,
    pub(super) open: bool,
    pub(super) closed: bool,
    pub(super) start: bool,
    pub(super) route: bool,
    pub(super) unkind: bool,
}

/// The legend, from the origin on and not wider than what is available, and how high it is.
pub(super) fn legend(used: &Used, kinds: &Kinds<'_>, available_px: f64) -> (Group, f64) {
    let mut group = Group::new().set("class", "legend");
    let (mut x, mut y) = (0.0, ROW_PX / 2.0);
    for entry in entries(used, kinds) {
        let wide = SIGN_PX + width_px(&entry.words, SIZE_PX) + GAP_PX;
        if x > 0.0 && x + wide > available_px {
            (x, y) = (0.0, y + ROW_PX);
        }
        for part in drawn(&entry.sign, [x + SIGN_PX / 2.0 - 4.0, y]) {
            group.append(part);
        }
        group.append(words(&entry.words, [x + SIGN_PX, y + SIZE_PX * 0.36], "l"));
        x += wide;
    }
    (group, y + ROW_PX / 2.0)
}

fn entries(used: &Used, kinds: &Kinds<'_>) -> Vec<Entry> {
    let mut entries = Vec::new();
    let mut add = |sign: Sign, words: &str| {
        entries.push(Entry {
            sign,
            words: words.to_owned(),
        })
    };
    if used.start {
        add(Sign::Start, "start");
    }
    if used.route {
        add(Sign::Route, "shortest way");
    }
    add(Sign::Passage, "passage");
    if used.one_way {
        add(Sign::OneWay, "one-way");
    }
    if used.open {
        add(Sign::Door { open: true }, "door, open");
    }
    if used.closed {
        add(Sign::Door { open: false }, "door, closed");
    }
    for (kind, look, count) in kinds.iter().take(MOST_KINDS) {
        add(
            Sign::Dot(look),
            &format!("{} ({count})", kind.replace('_', " ")),
        );
    }
    let more = kinds.iter().count().saturating_sub(MOST_KINDS);
    if more > 0 {
        add(Sign::Nothing, &format!("and {more} more kinds"));
    }
    if used.unkind {
        add(Sign::Dot(kinds.look(None)), "node");
    }
    entries
}

fn drawn(sign: &Sign, at: [f64; 2]) -> Vec<Element> {
    let [x, y] = at;
    let ends = [[x - 11.0, y], [x + 11.0, y]];
    let stroke = |class: &str| element("path", &[("class", class), ("d", &line(&ends))]);
    match sign {
        Sign::Nothing => Vec::new(),
        Sign::Start => vec![ring(at, 6.0, "start")],
        Sign::Route => vec![stroke("route")],
        Sign::Passage => vec![stroke("p")],
        Sign::OneWay => vec![
            stroke("p"),
            element("path", &[("class", "arrow"), ("d", &arrow(ends, 5.0))]),
        ],
        Sign::Door { open } => vec![
            stroke(if *open { "p" } else { "p shut" }),
            element(
                "path",
                &[
                    ("class", if *open { "open" } else { "closed" }),
                    ("d", &door(ends, 7.0, *open)),
                ],
            ),
        ],
        Sign::Dot(look) => vec![element(
            "circle",
            &[
                ("cx", &px(x)),
                ("cy", &px(y)),
                ("r", &px(5.0 * look.size)),
                ("fill", look.colour),
                ("class", "n"),
            ],
        )],
    }
}

/// A ring around a place.
pub(super) fn ring([x, y]: [f64; 2], radius: f64, class: &str) -> Element {
    element(
        "circle",
        &[
            ("cx", &px(x)),
            ("cy", &px(y)),
            ("r", &px(radius)),
            ("class", class),
        ],
    )
}

/// A bar of a round number of metres, with its right end at the origin.
pub(super) fn scale_bar(px_per_m: f64) -> Group {
    let (right, y) = (0.0, 22.0);
    let metres = round_metres(110.0 / px_per_m);
    let left = right - metres * px_per_m;
    let bar = [[left, y - 5.0], [left, y], [right, y], [right, y - 5.0]];
    let text = if metres >= 1000.0 {
        format!("{} km", metres / 1000.0)
    } else {
        format!("{metres} m")
    };
    Group::new()
        .set("class", "legend")
        .add(element("path", &[("class", "bar"), ("d", &line(&bar))]))
        .add(words(&text, [(left + right) / 2.0, y - 5.0], "l mid"))
}

/// 1, 2 or 5 of some power of ten: the largest not above `most`.
fn round_metres(most: f64) -> f64 {
    let mut power = 1e-3;
    while power * 10.0 <= most && power < 1e12 {
        power *= 10.0;
    }
    let steps = [5.0, 2.0, 1.0].map(|step| step * power);
    let found = steps
        .into_iter()
        .find(|metres| *metres <= most)
        .unwrap_or(power);
    // 0.05 and not 0.05000000000000001.
    (found * 1000.0).round() / 1000.0
}
