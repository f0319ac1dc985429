//! Draws a chart as SVG, for files, for the HTML page, and rasterised for PNG.
//!
//! No plotting library is used: none offers, in its SVG, values on hover, styles by the page (light
//! and dark), and marks that differ in shape as well as in colour. Here these take about ten lines
//! each.

use super::axis::{Span, tick_label};
use afterimage::experiment::run::report::{Chart, Drawn, Point, Series};
use std::fmt::Write;

/// Width and height of the drawing, in SVG units.
const SIZE: [f64; 2] = [760.0, 460.0];
const LEFT: f64 = 76.0;
const RIGHT: f64 = 20.0;
const BOTTOM: f64 = 52.0;
const TITLE: f64 = 34.0;
const LEGEND_ROW: f64 = 20.0;

/// Default colours of series: distinct on light and dark backgrounds and, together with the shapes
/// of the marks, under colour blindness.
const PALETTE: [&str; 8] =
    ["#0072b2", "#d55e00", "#009e73", "#b8559a", "#a87900", "#3d9bd4", "#7a68d8", "#808080"];

/// Style of a drawing in a file of its own.
const STYLE: &str = "text{font:13px sans-serif;fill:#222}.title{font-size:16px}.grid{stroke:#ddd}\
    .frame{stroke:#888;fill:none}.line{fill:none;stroke-width:2}.range{stroke-width:1.5;opacity:.45}.paper{fill:#fff}";

/// The plotting area: the ranges of both axes and its top edge in the drawing.
struct Plane {
    x: Span,
    y: Span,
    top: f64,
}

impl Plane {
    fn of(chart: &Chart, top: f64) -> Option<Self> {
        let points = || chart.series.iter().flat_map(|s| &s.points);
        let all = |axis: usize, range: fn(&Point) -> Option<[f64; 2]>| {
            points().flat_map(move |p| std::iter::once(p.at[axis]).chain(range(p).into_iter().flatten()))
        };
        let x = Span::of(all(0, |p| p.x_range), chart.x.scale)?;
        let y = Span::of(all(1, |p| p.y_range), chart.y.scale)?;
        Some(Self { x, y, top })
    }

    fn width(&self) -> f64 {
        SIZE[0] - LEFT - RIGHT
    }

    fn height(&self) -> f64 {
        SIZE[1] - BOTTOM - self.top
    }

    fn across(&self, share: f64) -> f64 {
        LEFT + share * self.width()
    }

    fn up(&self, share: f64) -> f64 {
        SIZE[1] - BOTTOM - share * self.height()
    }

    /// Position of a point in the drawing; `None` if an axis cannot show it.
    fn place(&self, at: [f64; 2]) -> Option<[f64; 2]> {
        Some([self.across(self.x.position(at[0])?), self.up(self.y.position(at[1])?)])
    }
}

/// The chart as an SVG file.
pub(super) fn file(chart: &Chart) -> String {
    let background = r#"<rect class="paper" width="100%" height="100%"/>"#;
    svg(chart, &format!("<style>{STYLE}</style>{background}"))
}

/// The chart as part of a page, whose style gives its colours.
pub(super) fn inline(chart: &Chart) -> String {
    svg(chart, "")
}

fn svg(chart: &Chart, head: &str) -> String {
    let [width, height] = SIZE;
    let title = escaped(&chart.title);
    let mut out = format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" role="img" aria-label="{title}">{head}"#
    );
    let _ = write!(out, r#"<text class="title" x="{LEFT}" y="22">{title}</text>"#);
    let top = TITLE + legend(&mut out, chart);
    match Plane::of(chart, top) {
        Some(plane) => {
            axes(&mut out, chart, &plane);
            for (number, series) in chart.series.iter().enumerate() {
                draw_series(&mut out, &plane, series, number);
            }
        }
        None => {
            let _ = write!(out, r#"<text x="{LEFT}" y="{}">nothing to show yet</text>"#, top + 30.0);
        }
    }
    out + "</svg>"
}

/// Draws the legend in as many rows as needed; returns their height.
fn legend(out: &mut String, chart: &Chart) -> f64 {
    /// Approximate width of a letter.
    const LETTER: f64 = 7.2;
    let (mut x, mut row) = (LEFT, 0.0);
    for (number, series) in chart.series.iter().enumerate().filter(|(_, s)| !s.name.is_empty()) {
        let width = 34.0 + LETTER * series.name.chars().count() as f64;
        if x > LEFT && x + width > SIZE[0] - RIGHT {
            (x, row) = (LEFT, row + 1.0);
        }
        let y = TITLE + row * LEGEND_ROW + 8.0;
        let color = color(series, number);
        if series.drawn != Drawn::Marks {
            let dashes = dashes(series.drawn);
            let end = x + 20.0;
            let _ = write!(out, r#"<path class="line" d="M{x:.1} {y}H{end:.1}" stroke="{color}"{dashes}/>"#);
        }
        if matches!(series.drawn, Drawn::Marks | Drawn::MarksAndLine) {
            mark(out, [x + 10.0, y], number, color);
        }
        let _ = write!(out, r#"<text x="{:.1}" y="{}">{}</text>"#, x + 25.0, y + 4.5, escaped(&series.name));
        x += width;
    }
    let is_empty = chart.series.iter().all(|s| s.name.is_empty());
    if is_empty { 0.0 } else { (row + 1.0) * LEGEND_ROW + 4.0 }
}

fn axes(out: &mut String, chart: &Chart, plane: &Plane) {
    let (left, right) = (plane.across(0.0), plane.across(1.0));
    let (bottom, top) = (plane.up(0.0), plane.up(1.0));
    for tick in plane.x.ticks() {
        let Some(x) = plane.x.position(tick).map(|share| plane.across(share)) else { continue };
        let label = tick_label(tick);
        let y = bottom + 18.0;
        let _ = write!(out, r#"<path class="grid" d="M{x:.1} {top:.1}V{bottom:.1}"/>"#);
        let _ = write!(out, r#"<text text-anchor="middle" x="{x:.1}" y="{y:.1}">{label}</text>"#);
    }
    for tick in plane.y.ticks() {
        let Some(y) = plane.y.position(tick).map(|share| plane.up(share)) else { continue };
        let (label, x) = (tick_label(tick), left - 7.0);
        let _ = write!(out, r#"<path class="grid" d="M{left:.1} {y:.1}H{right:.1}"/>"#);
        let _ = write!(out, r#"<text text-anchor="end" x="{x:.1}" y="{:.1}">{label}</text>"#, y + 4.5);
    }
    let (width, height) = (right - left, bottom - top);
    let _ = write!(
        out,
        r#"<rect class="frame" x="{left:.1}" y="{top:.1}" width="{width:.1}" height="{height:.1}"/>"#
    );
    let (x, y) = ((left + right) / 2.0, SIZE[1] - 12.0);
    let _ =
        write!(out, r#"<text text-anchor="middle" x="{x:.1}" y="{y:.1}">{}</text>"#, escaped(&chart.x.label));
    let y = (top + bottom) / 2.0;
    let _ = write!(
        out,
        r#"<text text-anchor="middle" transform="translate(17 {y:.1}) rotate(-90)">{}</text>"#,
        escaped(&chart.y.label)
    );
}

fn draw_series(out: &mut String, plane: &Plane, series: &Series, number: usize) {
    let color = color(series, number);
    if series.drawn != Drawn::Marks {
        let path = line(plane, &series.points);
        let dashes = dashes(series.drawn);
        let _ = write!(out, r#"<path class="line" d="{path}" stroke="{color}"{dashes}/>"#);
    }
    let has_marks = matches!(series.drawn, Drawn::Marks | Drawn::MarksAndLine);
    for point in &series.points {
        let Some(at) = plane.place(point.at) else { continue };
        ranges(out, plane, point, color);
        if has_marks {
            let label = [&series.name, &point.label].map(|t| escaped(t)).join("\n");
            let _ = write!(out, r#"<g class="mark"><title>{}</title>"#, label.trim());
            mark(out, at, number, color);
            out.push_str("</g>");
        }
    }
}

/// SVG path through the points; it is broken at points that an axis cannot show.
fn line(plane: &Plane, points: &[Point]) -> String {
    let mut path = String::new();
    let mut is_broken = true;
    for point in points {
        let place = plane.place(point.at);
        if let Some([x, y]) = place {
            let command = if is_broken { 'M' } else { 'L' };
            let _ = write!(path, "{command}{x:.1} {y:.1}");
        }
        is_broken = place.is_none();
    }
    path
}

fn ranges(out: &mut String, plane: &Plane, point: &Point, color: &str) {
    let [x, y] = point.at;
    let across = point.x_range.map(|[a, b]| [[a, y], [b, y]]);
    let up = point.y_range.map(|[a, b]| [[x, a], [x, b]]);
    for [from, to] in [across, up].into_iter().flatten() {
        if let (Some([x1, y1]), Some([x2, y2])) = (plane.place(from), plane.place(to)) {
            let _ =
                write!(out, r#"<path class="range" d="M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}" stroke="{color}"/>"#);
        }
    }
}

/// Draws a mark; six series have distinct shapes.
fn mark(out: &mut String, [x, y]: [f64; 2], number: usize, color: &str) {
    let path = match number % 6 {
        0 => "M-4.5 0A4.5 4.5 0 1 0 4.5 0A4.5 4.5 0 1 0 -4.5 0Z",
        1 => "M-4 -4H4V4H-4Z",
        2 => "M0 -5.5L5 4H-5Z",
        3 => "M0 -6L6 0L0 6L-6 0Z",
        4 => "M0 5.5L5 -4H-5Z",
        _ => "M-5 -1.6H-1.6V-5H1.6V-1.6H5V1.6H1.6V5H-1.6V1.6H-5Z",
    };
    let _ = write!(out, r#"<path d="{path}" transform="translate({x:.1} {y:.1})" fill="{color}"/>"#);
}

fn dashes(drawn: Drawn) -> &'static str {
    if drawn == Drawn::Dashes { r#" stroke-dasharray="7 5""# } else { "" }
}

/// Colour of a series: its own if that is a valid colour, otherwise from the palette.
fn color(series: &Series, number: usize) -> &str {
    let digits = series.color.strip_prefix('#').unwrap_or("");
    let is_color = digits.len() == 6 && digits.bytes().all(|b| b.is_ascii_hexdigit());
    if is_color { &series.color } else { PALETTE[number % PALETTE.len()] }
}

/// Escapes text for element content and attributes of XML and HTML. Control characters, which XML
/// forbids, are removed.
pub(super) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c if c.is_control() && c != '\n' => {}
            c => out.push(c),
        }
    }
    out
}
