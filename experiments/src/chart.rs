//! A picture of curves.

use plotters::coord::ranged1d::ValueFormatter;
use plotters::prelude::*;

/// One curve, or points of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// What it is.
    pub name: String,
    /// Where it goes, from left to right.
    pub points: Vec<(f64, f64)>,
}

/// Curves over one axis, both axes logarithmic; or, over the names of rows, points beside each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// The name of its file, without ending.
    pub name: String,
    /// What stands above it.
    pub title: String,
    /// What the horizontal axis is, with its unit.
    pub across: String,
    /// If not empty, what stands at 1, 2, 3, … of the horizontal axis, which is then not logarithmic; what
    /// is above one name has nothing to do with what is above the next.
    pub rows: Vec<String>,
    /// What the vertical axis is, with its unit.
    pub up: String,
    /// The curves.
    pub lines: Vec<Line>,
}

const COLOURS: [RGBColor; 8] = [
    RGBColor(0x1f, 0x77, 0xb4),
    RGBColor(0xd6, 0x27, 0x28),
    RGBColor(0x2c, 0xa0, 0x2c),
    RGBColor(0xff, 0x7f, 0x0e),
    RGBColor(0x94, 0x67, 0xbd),
    RGBColor(0x8c, 0x56, 0x4b),
    RGBColor(0x17, 0xbe, 0xcf),
    RGBColor(0x7f, 0x7f, 0x7f),
];

impl Chart {
    /// The picture, as SVG. Points at or below zero have no place on a logarithmic axis and are left out.
    ///
    /// # Errors
    /// What plotters has against it.
    pub fn svg(&self) -> Result<String, String> {
        let mut text = String::new();
        self.draw(&mut text).map_err(|error| error.to_string())?;
        Ok(text)
    }

    fn draw<'a>(&'a self, text: &'a mut String) -> Result<(), Box<dyn std::error::Error + 'a>> {
        let area = SVGBackend::with_string(text, (860, 520)).into_drawing_area();
        area.fill(&WHITE)?;
        let (across, up) = self.ranges();
        let mut chart = ChartBuilder::on(&area);
        chart
            .caption(&self.title, ("sans-serif", 20))
            .margin(16)
            .x_label_area_size(48)
            .y_label_area_size(72);
        let up = (up.0..up.1).log_scale();
        if self.rows.is_empty() {
            let across = (across.0..across.1).log_scale();
            self.fill(chart.build_cartesian_2d(across, up)?, &short)?;
        } else {
            // With room for what the points are.
            let across = 0.5..self.rows.len() as f64 + 1.9;
            let name = |place: &f64| {
                let row = (place - 1.0).round().max(0.0) as usize;
                let is_row = (place - 1.0 - row as f64).abs() < 0.01;
                let name = self.rows.get(row).filter(|_| is_row);
                name.cloned().unwrap_or_default()
            };
            self.fill(chart.build_cartesian_2d(across, up)?, &name)?;
        }
        area.present()?;
        Ok(())
    }

    fn fill<'a, X, Y>(
        &self,
        mut chart: ChartContext<'a, SVGBackend<'a>, Cartesian2d<X, Y>>,
        name: &dyn Fn(&f64) -> String,
    ) -> Result<(), Box<dyn std::error::Error + 'a>>
    where
        X: Ranged<ValueType = f64> + ValueFormatter<f64>,
        Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
    {
        chart
            .configure_mesh()
            .x_desc(&self.across)
            .y_desc(&self.up)
            .x_label_formatter(&name)
            .y_label_formatter(&short)
            .light_line_style(RGBColor(0xee, 0xee, 0xee))
            .draw()?;
        for (line, colour) in self.lines.iter().zip(COLOURS.into_iter().cycle()) {
            let points = || {
                let points = line.points.iter().copied();
                points.filter(|(x, y)| *x > 0.0 && *y > 0.0)
            };
            let joined = points().filter(|_| self.rows.is_empty());
            chart
                .draw_series(LineSeries::new(joined, colour.stroke_width(2)))?
                .label(&line.name)
                .legend(move |(x, y)| {
                    PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2))
                });
            let size = if self.rows.is_empty() { 3 } else { 5 };
            let dots = points().map(|point| Circle::new(point, size, colour.filled()));
            chart.draw_series(dots)?;
        }
        chart
            .configure_series_labels()
            .position(match self.rows.is_empty() {
                true => SeriesLabelPosition::UpperLeft,
                false => SeriesLabelPosition::UpperRight,
            })
            .background_style(WHITE.mix(0.85))
            .border_style(RGBColor(0xcc, 0xcc, 0xcc))
            .draw()?;
        Ok(())
    }

    /// What the axes show: all points, with some room.
    fn ranges(&self) -> ((f64, f64), (f64, f64)) {
        let points = self.lines.iter().flat_map(|line| &line.points);
        let shown: Vec<_> = points.filter(|(x, y)| *x > 0.0 && *y > 0.0).collect();
        let range = |values: &mut dyn Iterator<Item = f64>| {
            let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(low, high), value| {
                (low.min(value), high.max(value))
            });
            match low <= high {
                true => (low / 1.6, high * 1.6),
                false => (1.0, 10.0),
            }
        };
        let across = range(&mut shown.iter().map(|(x, _)| *x));
        (across, range(&mut shown.iter().map(|(_, y)| *y)))
    }
}

/// 40000 as 40k.
fn short(value: &f64) -> String {
    match *value {
        value if value >= 1e6 => format!("{}M", value / 1e6),
        value if value >= 1e3 => format!("{}k", value / 1e3),
        value => format!("{value}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_curve_is_named_in_the_picture() {
        let line = |name: &str, factor: f64| Line {
            name: name.to_owned(),
            points: [40.0, 400.0, 4000.0].map(|x| (x, x * factor)).to_vec(),
        };
        let chart = Chart {
            name: "growth".to_owned(),
            title: "Growth".to_owned(),
            across: "nodes".to_owned(),
            rows: Vec::new(),
            up: "us".to_owned(),
            lines: vec![line("online", 0.5), line("naive", 3.0)],
        };
        let svg = chart.svg().unwrap();
        assert!(svg.starts_with("<svg"));
        for word in ["online", "naive", "Growth", "nodes"] {
            assert!(svg.contains(word), "{word} is not in {svg}");
        }
    }

    #[test]
    fn rows_are_named_below_their_points() {
        let chart = Chart {
            name: "rows".to_owned(),
            title: "Rows".to_owned(),
            across: "emergency".to_owned(),
            rows: ["n38", "n28", "n29"].map(ToOwned::to_owned).to_vec(),
            up: "us".to_owned(),
            lines: vec![Line {
                name: "online".to_owned(),
                points: vec![(1.0, 30.0), (2.0, 200.0), (3.0, 40.0)],
            }],
        };
        let svg = chart.svg().unwrap();
        for row in &chart.rows {
            assert!(svg.contains(row), "{row} is not in {svg}");
        }
    }

    #[test]
    fn a_picture_of_nothing_is_a_picture() {
        let chart = Chart {
            name: "nothing".to_owned(),
            title: "Nothing".to_owned(),
            across: "x".to_owned(),
            rows: Vec::new(),
            up: "y".to_owned(),
            lines: vec![Line {
                name: "zero".to_owned(),
                points: vec![(0.0, 0.0)],
            }],
        };
        assert!(chart.svg().is_ok());
    }
}
