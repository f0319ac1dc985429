//! A report as data. The command line prints it; `report.html` and the plots are drawn from it.

use serde_json::{Map, Value};

/// Findings of an experiment as data; every form of the report is made from it.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Findings in sentences, the first lines of every form of the report.
    pub headline: Vec<String>,
    /// What a reader must know before trusting the figures. [`super::caveats`] are added.
    pub notes: Vec<String>,
    /// Findings in numbers: `summary.json` and the answer of `--json`.
    pub summary: Map<String, Value>,
    /// Sections in order.
    pub sections: Vec<Section>,
    /// What should have held and did not; the command then ends with exit code 1.
    pub failure: Option<String>,
}

/// Blocks under one heading.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// Heading.
    pub title: String,
    /// Blocks in order.
    pub blocks: Vec<Block>,
}

/// One part of a section.
#[derive(Clone, Debug)]
pub enum Block {
    /// A paragraph.
    Text(String),
    /// A table of values.
    Table(Table),
    /// A plot, also written to `plots/`.
    Chart(Chart),
    /// Two pictures of one size on top of each other, divided by a line that the reader drags.
    Slider {
        /// Title above the pictures.
        title: String,
        /// Picture left of the line.
        before: Picture,
        /// Picture right of the line.
        after: Picture,
    },
    /// Pictures side by side.
    Pictures(Vec<Picture>),
}

/// A picture of the run folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// File name in `images/`.
    pub file: String,
    /// Caption below the picture.
    pub caption: String,
}

/// A table of values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Title above the table.
    pub title: String,
    /// Names of the columns, with units.
    pub columns: Vec<String>,
    /// Rows with one value per column.
    pub rows: Vec<Vec<Value>>,
}

/// Scale of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Equal distances are equal differences.
    #[default]
    Linear,
    /// Equal distances are equal ratios; values that are not positive are left out.
    Logarithmic,
}

/// An axis of a plot.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Axis {
    /// Label with the unit.
    pub label: String,
    /// Scale of the axis.
    pub scale: Scale,
}

/// How the points of a series are drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Drawn {
    /// As marks.
    #[default]
    Marks,
    /// As marks joined by a line.
    MarksAndLine,
    /// As a line.
    Line,
    /// As a dashed line.
    Dashes,
}

/// A point of a series.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Point {
    /// Values on the two axes.
    pub at: [f64; 2],
    /// Lowest and highest x of the error bar.
    pub x_range: Option<[f64; 2]>,
    /// Lowest and highest y of the error bar.
    pub y_range: Option<[f64; 2]>,
    /// Text shown under the pointer.
    pub label: String,
}

/// Points with one name and one style.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// Name in the legend; a series without a name is not in the legend.
    pub name: String,
    /// Marks, line or both, with which the points are drawn.
    pub drawn: Drawn,
    /// Colour as `#rrggbb`; if empty, the palette provides one.
    pub color: String,
    /// Points in order.
    pub points: Vec<Point>,
}

/// A plot of series.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    /// Base name of the files in `plots/`.
    pub name: String,
    /// Title above the plot.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Series in drawing order; the last is on top.
    pub series: Vec<Series>,
}

impl Section {
    /// Blocks under a heading.
    pub fn new(title: impl Into<String>, blocks: Vec<Block>) -> Self {
        Self { title: title.into(), blocks }
    }
}

impl Block {
    /// A paragraph.
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    /// A table.
    pub fn table(
        title: impl Into<String>,
        columns: impl IntoIterator<Item = impl Into<String>>,
        rows: impl IntoIterator<Item = Vec<Value>>,
    ) -> Self {
        let columns = columns.into_iter().map(Into::into).collect();
        Self::Table(Table { title: title.into(), columns, rows: rows.into_iter().collect() })
    }

    /// A plot of series over a horizontal and a vertical axis.
    pub fn chart(
        name: impl Into<String>,
        title: impl Into<String>,
        [x, y]: [Axis; 2],
        series: impl IntoIterator<Item = Series>,
    ) -> Self {
        let series = series.into_iter().collect();
        Self::Chart(Chart { name: name.into(), title: title.into(), x, y, series })
    }
}

/// A row of a table: a first value, often a name, and further values.
pub fn row<V: Into<Value>>(first: impl Into<Value>, rest: impl IntoIterator<Item = V>) -> Vec<Value> {
    std::iter::once(first.into()).chain(rest.into_iter().map(Into::into)).collect()
}

/// The fields of a JSON object, for [`Report::summary`]; empty for any other value.
pub fn fields(value: Value) -> Map<String, Value> {
    if let Value::Object(fields) = value { fields } else { Map::new() }
}

impl Axis {
    /// An axis of equal differences.
    pub fn linear(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Linear }
    }

    /// An axis of equal ratios.
    pub fn logarithmic(label: impl Into<String>) -> Self {
        Self { label: label.into(), scale: Scale::Logarithmic }
    }
}

impl Series {
    /// Points under a name, in a colour of the palette.
    pub fn new(name: impl Into<String>, drawn: Drawn, points: impl IntoIterator<Item = Point>) -> Self {
        Self { name: name.into(), drawn, color: String::new(), points: points.into_iter().collect() }
    }

    /// The series in a given colour, `#rrggbb`.
    #[must_use]
    pub fn in_color(self, color: &str) -> Self {
        Self { color: color.to_owned(), ..self }
    }
}

impl Point {
    /// A point without error bars.
    pub fn new(x: f64, y: f64, label: impl Into<String>) -> Self {
        Self { at: [x, y], label: label.into(), ..Self::default() }
    }
}

impl Picture {
    /// A picture of `images/` with its caption.
    pub fn new(file: impl Into<String>, caption: impl Into<String>) -> Self {
        Self { file: file.into(), caption: caption.into() }
    }
}
