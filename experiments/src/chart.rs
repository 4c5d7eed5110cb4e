//! A picture of curves.

use plotters::prelude::*;

/// One curve, or points of one kind.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// What it is.
    pub name: String,
    /// Where it goes, from left to right.
    pub points: Vec<(f64, f64)>,
}

/// Curves over one axis, both axes logarithmic.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// The name of its file, without ending.
    pub name: String,
    /// What stands above it.
    pub title: String,
    /// What the horizontal axis is, with its unit.
    pub across: String,
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

    fn draw(&self, text: &mut String) -> Result<(), Box<dyn std::error::Error + '_>> {
        let area = SVGBackend::with_string(text, (860, 520)).into_drawing_area();
        area.fill(&WHITE)?;
        let (across, up) = self.ranges();
        let mut chart = ChartBuilder::on(&area)
            .caption(&self.title, ("sans-serif", 20))
            .margin(16)
            .x_label_area_size(48)
            .y_label_area_size(72)
            .build_cartesian_2d((across.0..across.1).log_scale(), (up.0..up.1).log_scale())?;
        chart
            .configure_mesh()
            .x_desc(&self.across)
            .y_desc(&self.up)
            .x_label_formatter(&short)
            .y_label_formatter(&short)
            .light_line_style(RGBColor(0xee, 0xee, 0xee))
            .draw()?;
        for (line, colour) in self.lines.iter().zip(COLOURS.into_iter().cycle()) {
            let points = || {
                line.points
                    .iter()
                    .copied()
                    .filter(|(x, y)| *x > 0.0 && *y > 0.0)
            };
            chart
                .draw_series(LineSeries::new(points(), colour.stroke_width(2)))?
                .label(&line.name)
                .legend(move |(x, y)| {
                    PathElement::new([(x, y), (x + 18, y)], colour.stroke_width(2))
                });
            let dots = points().map(|point| Circle::new(point, 3, colour.filled()));
            chart.draw_series(dots)?;
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperLeft)
            .background_style(WHITE.mix(0.85))
            .border_style(RGBColor(0xcc, 0xcc, 0xcc))
            .draw()?;
        area.present()?;
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
    fn a_picture_of_nothing_is_a_picture() {
        let chart = Chart {
            name: "nothing".to_owned(),
            title: "Nothing".to_owned(),
            across: "x".to_owned(),
            up: "y".to_owned(),
            lines: vec![Line {
                name: "zero".to_owned(),
                points: vec![(0.0, 0.0)],
            }],
        };
        assert!(chart.svg().is_ok());
    }
}
