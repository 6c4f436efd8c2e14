//! Plots as SVG, drawn in the page's own colours so that they follow its light and dark.

use std::fmt::Write;

use super::escape::escape;

/// A plot of one or more series over two axes.
#[derive(Clone, Debug, Default)]
pub struct Plot {
    /// What it shows.
    pub caption: String,
    /// The horizontal axis, with unit.
    pub x: String,
    /// The vertical axis, with unit.
    pub y: String,
    /// What is drawn, first to last.
    pub series: Vec<Series>,
    /// Vertical lines, as (x, name, colour).
    pub marks: Vec<(f64, String, usize)>,
    /// Whether lengths are the same along both axes.
    pub equal: bool,
    /// Whether the vertical axis begins at zero.
    pub from_zero: bool,
}

/// A series of a plot.
#[derive(Clone, Debug)]
pub struct Series {
    /// Its name in the legend; none where empty.
    pub name: String,
    /// How it is drawn.
    pub kind: SeriesStyle,
    /// Its colour, counted from 0.
    pub colour: usize,
    /// Its points (x, y).
    pub points: Vec<(f64, f64)>,
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeriesStyle {
    /// A line.
    Line,
    /// A broken line.
    Dashes,
    /// A line with dots.
    DottedLine,
    /// Dots.
    Dots,
    /// Bars from zero, all as wide as the least step between them.
    Bars,
}

impl Series {
    /// A series.
    #[must_use]
    pub fn new(name: &str, kind: SeriesStyle, colour: usize, points: Vec<(f64, f64)>) -> Self {
        Self { name: name.to_owned(), kind, colour, points }
    }
}

const WIDTH: f64 = 520.0;
const HEIGHT: f64 = 300.0;
const LEFT: f64 = 62.0;
const RIGHT: f64 = 14.0;
const TOP: f64 = 14.0;
const BOTTOM: f64 = 46.0;

/// An axis: from values to places in the drawing.
#[derive(Clone, Copy)]
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    fn place(&self, value: f64) -> f64 {
        self.from + (value - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// Round values, about `count` of them.
    fn ticks(&self, count: f64) -> Vec<f64> {
        let step = round_step((self.high - self.low) / count);
        let first = (self.low / step - 1e-9).ceil() as i64;
        let last = (self.high / step + 1e-9).floor() as i64;
        (first..=last).map(|tick| tick as f64 * step).collect()
    }
}

/// 1, 2 or 5 times a power of ten, the least that is not below `step`.
fn round_step(step: f64) -> f64 {
    let power = 10.0_f64.powf(step.log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|factor| factor * power).find(|&round| round >= step * 0.999).unwrap_or(step)
}

/// The least and the greatest of finite values, a little apart in any case.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    match (low <= high, high > low) {
        (true, true) => (low, high),
        (true, false) => (low - 0.5, high + 0.5),
        _ => (0.0, 1.0),
    }
}

impl Plot {
    /// The plot as an `svg` element.
    #[must_use]
    pub fn svg(&self) -> String {
        let legend = self.legend();
        let top = TOP + 18.0 * legend.len() as f64;
        let height = HEIGHT + top - TOP;
        let (x, y) = self.axes(top, height);
        let mut svg =
            format!("<svg viewBox=\"0 0 {WIDTH} {height}\" role=\"img\" aria-label=\"{}\">\n", escape(&self.caption));
        svg.push_str(&legend.join(""));
        self.grid(&mut svg, x, y);
        for series in &self.series {
            draw(&mut svg, series, x, y);
        }
        for (value, name, colour) in &self.marks {
            let (at, end) = (x.place(*value), if x.place(*value) > WIDTH * 0.7 { "end" } else { "start" });
            let beside = if end == "end" { -5.0 } else { 5.0 };
            let row = y.to + 12.0 + 14.0 * *colour as f64;
            let _ = writeln!(
                svg,
                "<path class=\"line c{colour}\" d=\"M{at:.1} {:.1}V{:.1}\"/><text class=\"f{colour}\" x=\"{:.1}\" \
                 y=\"{row:.1}\" text-anchor=\"{end}\">{}</text>",
                y.from,
                y.to,
                at + beside,
                escape(name)
            );
        }
        svg.push_str("</svg>\n");
        svg
    }

    /// One line of the legend for each two series.
    fn legend(&self) -> Vec<String> {
        let named: Vec<&Series> = self.series.iter().filter(|series| !series.name.is_empty()).collect();
        let mut lines = Vec::new();
        for (row, pair) in named.chunks(2).enumerate() {
            let mut line = String::new();
            for (column, series) in pair.iter().enumerate() {
                let (x, y) = (LEFT + 225.0 * column as f64, 12.0 + 18.0 * row as f64);
                let class = if series.kind == SeriesStyle::Dashes { "line dashes" } else { "line" };
                let _ = write!(
                    line,
                    "<path class=\"{class} c{}\" d=\"M{x:.0} {:.0}h20\"/><text x=\"{:.0}\" y=\"{y:.0}\">{}</text>",
                    series.colour,
                    y - 4.0,
                    x + 26.0,
                    escape(&series.name)
                );
            }
            lines.push(line + "\n");
        }
        lines
    }

    fn axes(&self, top: f64, height: f64) -> (Axis, Axis) {
        let points = || self.series.iter().flat_map(|series| series.points.iter().copied());
        let (mut x_low, mut x_high) = range(points().map(|p| p.0).chain(self.marks.iter().map(|mark| mark.0)));
        let (mut y_low, mut y_high) = range(points().map(|p| p.1));
        let bars = self.series.iter().any(|series| series.kind == SeriesStyle::Bars);
        if self.from_zero || bars {
            (y_low, y_high) = (y_low.min(0.0), y_high.max(0.0));
        }
        let (wide, tall) = (WIDTH - LEFT - RIGHT, height - top - BOTTOM);
        let margin = 0.04;
        let (x_room, y_room) = ((x_high - x_low) * margin, (y_high - y_low) * margin);
        (x_low, x_high) = (x_low - x_room, x_high + x_room);
        y_high += y_room;
        if y_low != 0.0 {
            y_low -= y_room;
        }
        if self.equal {
            let scale = ((x_high - x_low) / wide).max((y_high - y_low) / tall);
            let widen = |low: f64, high: f64, room: f64| {
                let spare = (scale * room - (high - low)) / 2.0;
                (low - spare, high + spare)
            };
            (x_low, x_high) = widen(x_low, x_high, wide);
            (y_low, y_high) = widen(y_low, y_high, tall);
        }
        let x = Axis { low: x_low, high: x_high, from: LEFT, to: WIDTH - RIGHT };
        let y = Axis { low: y_low, high: y_high, from: height - BOTTOM, to: top };
        (x, y)
    }

    fn grid(&self, svg: &mut String, x: Axis, y: Axis) {
        for value in y.ticks(5.0) {
            let at = y.place(value);
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{LEFT} {at:.1}H{:.1}\"/><text x=\"{:.1}\" y=\"{:.1}\" \
                 text-anchor=\"end\">{}</text>",
                WIDTH - RIGHT,
                LEFT - 7.0,
                at + 4.0,
                number(value)
            );
        }
        for value in x.ticks(7.0) {
            let at = x.place(value);
            let _ = writeln!(
                svg,
                "<path class=\"grid\" d=\"M{at:.1} {:.1}v4\"/><text x=\"{at:.1}\" y=\"{:.1}\" \
                 text-anchor=\"middle\">{}</text>",
                y.from,
                y.from + 17.0,
                number(value)
            );
        }
        let _ = writeln!(
            svg,
            "<path class=\"axis\" d=\"M{LEFT} {:.1}V{:.1}H{:.1}\"/>\
             <text class=\"name\" x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\
             <text class=\"name\" transform=\"translate(14 {:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            y.to,
            y.from,
            WIDTH - RIGHT,
            (x.from + x.to) / 2.0,
            y.from + 36.0,
            escape(&self.x),
            (y.from + y.to) / 2.0,
            escape(&self.y)
        );
    }
}

fn draw(svg: &mut String, series: &Series, x: Axis, y: Axis) {
    let colour = series.colour;
    let points: Vec<(f64, f64)> = series
        .points
        .iter()
        .filter(|point| point.0.is_finite() && point.1.is_finite())
        .map(|point| (x.place(point.0), y.place(point.1)))
        .collect();
    if series.kind == SeriesStyle::Bars {
        let steps = points.windows(2).map(|pair| (pair[1].0 - pair[0].0).abs());
        let step = steps.fold(f64::INFINITY, f64::min);
        let width = if step.is_finite() { (step * 0.9).max(1.0) } else { 12.0 };
        let zero = y.place(0.0);
        for &(px, py) in &points {
            let (high, low) = (py.min(zero), py.max(zero));
            let left = px - width / 2.0;
            let _ =
                write!(svg, "<path class=\"bar f{colour}\" d=\"M{left:.1} {low:.1}V{high:.1}h{width:.1}V{low:.1}z\"/>");
        }
        svg.push('\n');
        return;
    }
    if matches!(series.kind, SeriesStyle::Line | SeriesStyle::Dashes | SeriesStyle::DottedLine) {
        let path: Vec<String> = points.iter().map(|(px, py)| format!("{px:.1} {py:.1}")).collect();
        let class = if series.kind == SeriesStyle::Dashes { "line dashes" } else { "line" };
        let _ = writeln!(svg, "<path class=\"{class} c{colour}\" d=\"M{}\"/>", path.join("L"));
    }
    if matches!(series.kind, SeriesStyle::Dots | SeriesStyle::DottedLine) {
        let radius = if points.len() > 200 { 1.3 } else { 3.0 };
        for (px, py) in &points {
            let _ = write!(svg, "<circle class=\"dot f{colour}\" cx=\"{px:.1}\" cy=\"{py:.1}\" r=\"{radius}\"/>");
        }
        svg.push('\n');
    }
}

/// A tick's value, short.
fn number(value: f64) -> String {
    let text = if value != 0.0 && (value.abs() < 1e-3 || value.abs() >= 1e5) {
        return format!("{value:.1e}");
    } else {
        format!("{value:.4}")
    };
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".into() } else { short.replace('-', "\u{2212}") }
}

/// The counts of values in `bins` bins of equal width, as (middle, share).
#[must_use]
pub fn histogram(values: &[f64], bins: usize) -> Vec<(f64, f64)> {
    let (low, high) = range(values.iter().copied());
    let mut counts = vec![0_u64; bins];
    for value in values {
        let bin = ((value - low) / (high - low) * bins as f64) as usize;
        counts[bin.min(bins - 1)] += 1;
    }
    let width = (high - low) / bins as f64;
    let middle = |bin: usize| low + (bin as f64 + 0.5) * width;
    counts.iter().enumerate().map(|(bin, &count)| (middle(bin), count as f64 / values.len().max(1) as f64)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round() {
        let axis = Axis { low: -0.013, high: 0.108, from: 0.0, to: 100.0 };
        let ticks = axis.ticks(5.0);
        assert!(ticks.len() >= 3 && ticks.contains(&0.0), "{ticks:?}");
        assert_eq!(round_step(0.03), 0.05);
        assert_eq!(round_step(0.12), 0.2);
        assert_eq!((number(0.05), number(-2.0), number(0.0)), ("0.05".into(), "\u{2212}2".into(), "0".into()));
    }

    #[test]
    fn places_are_within_the_drawing() {
        let points = vec![(0.0, -1.0), (1.0, f64::NAN), (2.0, 5.0)];
        for kind in
            [SeriesStyle::Line, SeriesStyle::Dots, SeriesStyle::Bars, SeriesStyle::DottedLine, SeriesStyle::Dashes]
        {
            let plot = Plot { series: vec![Series::new("a < b", kind, 0, points.clone())], ..Plot::default() };
            let svg = plot.svg();
            assert!(svg.contains("a &lt; b") && !svg.contains("NaN"));
        }
        assert!(Plot::default().svg().starts_with("<svg"));
    }

    #[test]
    fn histograms_count_everything() {
        let bins = histogram(&[0.0, 0.1, 0.9, 1.0], 2);
        assert_eq!(bins, [(0.25, 0.5), (0.75, 0.5)]);
        assert_eq!(histogram(&[3.0; 5], 4).iter().map(|bin| bin.1).sum::<f64>(), 1.0);
    }
}
