//! From metres to the paper: east is right, north is up.

use crate::Site;

/// A passage of usual length is drawn about as long as this, in pixels.
const USUAL_PASSAGE_PX: f64 = 84.0;
/// The longer side of the place is drawn at least and at most as long, in pixels.
const LONGER_SIDE_PX: (f64, f64) = (640.0, 3600.0);
/// A place of one node is no reason to draw millimetres.
const MOST_PX_PER_M: f64 = 60.0;
/// Further away nothing is drawn where it is. The Earth is not as large.
const FURTHEST_M: f64 = 1e9;
/// Free paper around the place, in pixels.
pub(super) const MARGIN_PX: f64 = 40.0;

/// Where things are drawn, in pixels.
pub(super) struct Frame {
    west_m: f64,
    north_m: f64,
    pub(super) px_per_m: f64,
    /// Left and top of the place on the paper.
    pub(super) corner_px: [f64; 2],
    /// Of the place, without margins.
    pub(super) size_px: [f64; 2],
    /// How long a passage of usual length is drawn.
    pub(super) usual_px: f64,
}

impl Frame {
    /// For all of a place, its corner at `corner_px`, on paper at least `least_width_px` wide.
    pub(super) fn around(site: &Site, corner_px: [f64; 2], least_width_px: f64) -> Self {
        let rectangles = site.areas().filter_map(crate::Area::rectangle_m);
        let corners =
            rectangles.flat_map(|[west, south, east, north]| [[west, south], [east, north]]);
        let points = site.nodes().map(crate::Node::position_m).chain(corners);
        let (mut least, mut most) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in points.map(within_reach) {
            for axis in [0, 1] {
                least[axis] = least[axis].min(point[axis]);
                most[axis] = most[axis].max(point[axis]);
            }
        }
        let extent_m = [0, 1].map(|axis| (most[axis] - least[axis]).max(0.1));
        let usual_m = usual_passage_m(site);
        let longer_m = extent_m[0].max(extent_m[1]);
        let (shortest, longest) = (LONGER_SIDE_PX.0 / longer_m, LONGER_SIDE_PX.1 / longer_m);
        let px_per_m = (USUAL_PASSAGE_PX / usual_m)
            .clamp(shortest, longest)
            .min(MOST_PX_PER_M);
        let size_px = extent_m.map(|extent| extent * px_per_m);
        let spare_px = (least_width_px - size_px[0]).max(0.0) / 2.0;
        Self {
            west_m: least[0],
            north_m: most[1],
            px_per_m,
            corner_px: [corner_px[0] + spare_px, corner_px[1]],
            size_px: [size_px[0], size_px[1]],
            usual_px: usual_m * px_per_m,
        }
    }

    /// Of the paper.
    pub(super) fn width_px(&self) -> f64 {
        2.0 * self.corner_px[0] + self.size_px[0]
    }

    /// Where a point of the place is drawn.
    pub(super) fn at(&self, point_m: [f64; 2]) -> [f64; 2] {
        let [x, y] = within_reach(point_m);
        [
            self.corner_px[0] + (x - self.west_m) * self.px_per_m,
            self.corner_px[1] + (self.north_m - y) * self.px_per_m,
        ]
    }
}

fn within_reach(point_m: [f64; 2]) -> [f64; 2] {
    point_m.map(|value| value.clamp(-FURTHEST_M, FURTHEST_M))
}

/// The median of the straight lines between the ends of passages.
fn usual_passage_m(site: &Site) -> f64 {
    let mut lengths: Vec<f64> = site
        .passages()
        .filter_map(|passage| {
            let [from, to] = passage.ends().map(|end| site.node(end.as_str()));
            let [from, to] = [from?.position_m(), to?.position_m()].map(within_reach);
            Some((from[0] - to[0]).hypot(from[1] - to[1]))
        })
        .filter(|length| *length > 0.01)
        .collect();
    lengths.sort_by(f64::total_cmp);
    lengths.get(lengths.len() / 2).copied().unwrap_or(1.0)
}
