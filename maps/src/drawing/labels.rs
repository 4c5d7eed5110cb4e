//! Where words go: beside what they name, upon nothing else, and nowhere if there is no room.

use std::collections::BTreeMap;

use super::ground::Outline;
use super::ink::width_px;

/// Of the squares that what is drawn is filed by.
const CELL_PX: f64 = 48.0;
/// Air around a label.
const AIR_PX: f64 = 1.5;

/// Left, top, right and bottom.
type Extent = [f64; 4];
type Cell = (i32, i32);

/// What is on the paper so far.
pub(super) struct Labels {
    width_px: f64,
    boxes: BTreeMap<Cell, Vec<Extent>>,
    strokes: BTreeMap<Cell, Vec<[[f64; 2]; 2]>>,
}

/// Where a label has found its place.
pub(super) struct Placed {
    pub(super) at: [f64; 2],
    /// For `text-anchor`: start, middle or end.
    pub(super) anchor: &'static str,
}

impl Labels {
    /// On paper of that width.
    pub(super) fn on(width_px: f64) -> Self {
        Self {
            width_px,
            boxes: BTreeMap::new(),
            strokes: BTreeMap::new(),
        }
    }

    /// Here no word may go.
    pub(super) fn occupy(&mut self, extent: Extent) {
        for cell in cells(extent) {
            self.boxes.entry(cell).or_default().push(extent);
        }
    }

    /// Here something round is drawn.
    pub(super) fn occupy_dot(&mut self, [x, y]: [f64; 2], radius: f64) {
        self.occupy([x - radius, y - radius, x + radius, y + radius]);
    }

    /// Words may cross this line, but go elsewhere if they can.
    pub(super) fn stroke(&mut self, line: [[f64; 2]; 2]) {
        let [from, to] = line;
        let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
        let steps = (dx.hypot(dy) / (CELL_PX / 2.0)).ceil().max(1.0) as u32;
        let mut last = None;
        for step in 0..=steps {
            let part = f64::from(step) / f64::from(steps);
            let cell = cell_of([from[0] + dx * part, from[1] + dy * part]);
            if last.replace(cell) != Some(cell) {
                self.strokes.entry(cell).or_default().push(line);
            }
        }
    }

    /// Beside a dot: to the right if it can be. Words that are of less importance (`most_crossed`, in
    /// lengths of themselves) are left out rather than put upon lines.
    pub(super) fn beside(
        &mut self,
        dot: [f64; 2],
        radius: f64,
        text: &str,
        size_px: f64,
        most_crossed: f64,
    ) -> Option<Placed> {
        let (away, slant) = (radius + 3.0, radius * 0.7 + 2.0);
        let [x, y] = dot;
        let (middle, above, below) = (y + size_px * 0.36, y - slant, y + slant + size_px * 0.75);
        let candidates = [
            ([x + away, middle], "start"),
            ([x - away, middle], "end"),
            ([x, y - away], "middle"),
            ([x, y + away + size_px * 0.75], "middle"),
            ([x + slant, above], "start"),
            ([x + slant, below], "start"),
            ([x - slant, above], "end"),
            ([x - slant, below], "end"),
        ];
        let most_px = most_crossed * width_px(text, size_px);
        self.best(&candidates, text, size_px, most_px)
    }

    /// In a corner of an area, or in its middle. It goes over lines if it has to.
    pub(super) fn within(&mut self, extent: Extent, text: &str, size_px: f64) -> Option<Placed> {
        let [left, top, right, bottom] = extent;
        let (high, low) = (top + size_px + 3.0, bottom - 5.0);
        let candidates = [
            ([left + 6.0, high], "start"),
            ([right - 6.0, high], "end"),
            ([left + 6.0, low], "start"),
            ([right - 6.0, low], "end"),
            ([(left + right) / 2.0, high], "middle"),
            ([(left + right) / 2.0, low], "middle"),
            ([(left + right) / 2.0, (top + bottom) / 2.0], "middle"),
        ];
        let inside = |(at, anchor): &([f64; 2], &'static str)| {
            let found = extent_of(*at, anchor, text, size_px);
            found[0] >= left - 1.0 && found[2] <= right + 1.0
        };
        let candidates: Vec<_> = candidates.into_iter().filter(inside).collect();
        self.best(&candidates, text, size_px, f64::INFINITY)
    }

    /// Somewhere in an outline, all of it; over lines if it has to.
    pub(super) fn inside(&mut self, outline: &Outline, text: &str, size_px: f64) -> Option<Placed> {
        let [left, top, right, bottom] = outline.bounds();
        let parts = [0.1, 0.25, 0.4, 0.5, 0.6, 0.75, 0.9];
        let candidates: Vec<_> = parts
            .iter()
            .flat_map(|down| parts.iter().map(move |across| [*across, *down]))
            .map(|[across, down]| {
                let at = [
                    left + (right - left) * across,
                    top + (bottom - top) * down + size_px * 0.3,
                ];
                (at, "middle")
            })
            .filter(|(at, anchor)| {
                let [left, top, right, bottom] = extent_of(*at, anchor, text, size_px);
                let corners = [[left, top], [right, top], [right, bottom], [left, bottom]];
                corners.into_iter().all(|corner| outline.holds(corner))
            })
            .collect();
        self.best(&candidates, text, size_px, f64::INFINITY)
    }

    /// The candidate that lies on nothing and crosses least, the first of equal ones.
    fn best(
        &mut self,
        candidates: &[([f64; 2], &'static str)],
        text: &str,
        size_px: f64,
        most_px: f64,
    ) -> Option<Placed> {
        let mut best: Option<(f64, usize, Extent)> = None;
        for (index, (at, anchor)) in candidates.iter().enumerate() {
            let extent = extent_of(*at, anchor, text, size_px);
            if self.is_taken(extent) {
                continue;
            }
            let crossed = self.crossed_px(extent);
            if crossed > most_px {
                continue;
            }
            // A little dearer the later it comes, so that labels mostly stand alike.
            let crossed = crossed + index as f64 * 2.0;
            if best.is_none_or(|(least, ..)| crossed < least) {
                best = Some((crossed, index, extent));
            }
        }
        let (_, index, extent) = best?;
        self.occupy(extent);
        let (at, anchor) = candidates[index];
        Some(Placed { at, anchor })
    }

    fn is_taken(&self, extent: Extent) -> bool {
        if extent[0] < 0.0 || extent[2] > self.width_px {
            return true;
        }
        cells(extent).any(|cell| {
            let boxes = self.boxes.get(&cell);
            boxes.into_iter().flatten().any(|other| {
                extent[0] < other[2]
                    && other[0] < extent[2]
                    && extent[1] < other[3]
                    && other[1] < extent[3]
            })
        })
    }

    /// How much of the lines a label would hide.
    fn crossed_px(&self, extent: Extent) -> f64 {
        let mut lines: Vec<[[f64; 2]; 2]> = Vec::new();
        for cell in cells(extent) {
            for line in self.strokes.get(&cell).into_iter().flatten() {
                if !lines.contains(line) {
                    lines.push(*line);
                }
            }
        }
        lines.into_iter().map(|line| inside_px(line, extent)).sum()
    }
}

fn extent_of([x, y]: [f64; 2], anchor: &str, text: &str, size_px: f64) -> Extent {
    let width = width_px(text, size_px);
    let left = match anchor {
        "start" => x,
        "middle" => x - width / 2.0,
        _ => x - width,
    };
    let (top, bottom) = (y - size_px * 0.78, y + size_px * 0.2);
    [
        left - AIR_PX,
        top - AIR_PX,
        left + width + AIR_PX,
        bottom + AIR_PX,
    ]
}

fn cell_of([x, y]: [f64; 2]) -> Cell {
    ((x / CELL_PX).floor() as i32, (y / CELL_PX).floor() as i32)
}

fn cells([left, top, right, bottom]: Extent) -> impl Iterator<Item = Cell> {
    let (first, last) = (cell_of([left, top]), cell_of([right, bottom]));
    (first.0..=last.0).flat_map(move |column| (first.1..=last.1).map(move |row| (column, row)))
}

/// The length of the part of a line that lies in an extent, cut after Liang and Barsky (1984).
fn inside_px([from, to]: [[f64; 2]; 2], extent: Extent) -> f64 {
    let (mut enters, mut leaves) = (0.0_f64, 1.0_f64);
    for axis in [0, 1] {
        let step = to[axis] - from[axis];
        let (low, high) = (extent[axis] - from[axis], extent[axis + 2] - from[axis]);
        if step == 0.0 {
            if low > 0.0 || high < 0.0 {
                return 0.0;
            }
            continue;
        }
        let (one, other) = (low / step, high / step);
        enters = enters.max(one.min(other));
        leaves = leaves.min(one.max(other));
    }
    (leaves - enters).max(0.0) * (to[0] - from[0]).hypot(to[1] - from[1])
}
