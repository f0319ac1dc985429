//! What an experiment has to say, as data: the command line prints it, `report.html` and the plots are drawn from it.

use serde_json::{Map, Value};

/// All of it.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// What it found, in sentences; the first lines of every form of the report.
    pub headline: Vec<String>,
    /// What a reader must know to trust it or not: noisy times, an unoptimised build. [`super::caveats`] adds to them.
    pub notes: Vec<String>,
    /// The same in numbers: `summary.json` and the answer of `--json`.
    pub summary: Map<String, Value>,
    /// The rest, in order.
    pub sections: Vec<Section>,
    /// What should have held and did not; the command then ends with code 1.
    pub failure: Option<String>,
}

/// Under one heading.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// The heading.
    pub title: String,
    /// In order.
    pub blocks: Vec<Block>,
}

/// A piece of a section.
#[derive(Clone, Debug)]
pub enum Block {
    /// A paragraph.
    Text(String),
    /// Numbers.
    Table(Table),
    /// A plot, written to `plots/` too.
    Chart(Chart),
    /// Two pictures of one size, one over the other, with a line to drag between them.
    Slider {
        /// Over it.
        title: String,
        /// Left of the line.
        before: Picture,
        /// Right of it.
        after: Picture,
    },
    /// Pictures side by side.
    Pictures(Vec<Picture>),
}

/// A picture of the run folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picture {
    /// Its name in `images/`.
    pub file: String,
    /// Below it.
    pub caption: String,
}

/// Rows of values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table {
    /// Over it.
    pub title: String,
    /// With their units.
    pub columns: Vec<String>,
    /// As many values each as there are columns.
    pub rows: Vec<Vec<Value>>,
}

/// How an axis grows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// By differences.
    #[default]
    Linear,
    /// By ratios; values that are not positive are left out.
    Logarithmic,
}

/// What an axis shows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Axis {
    /// With its unit.
    pub label: String,
    /// How it grows.
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
    /// Along the axes.
    pub at: [f64; 2],
    /// The spread of x around it: lowest and highest.
    pub x_range: Option<[f64; 2]>,
    /// The same of y.
    pub y_range: Option<[f64; 2]>,
    /// Shown where the pointer rests.
    pub label: String,
}

/// Points of one kind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// In the legend; not in it where empty.
    pub name: String,
    /// How they are drawn.
    pub drawn: Drawn,
    /// `#rrggbb`; one of the palette's by its place where empty.
    pub color: String,
    /// In order.
    pub points: Vec<Point>,
}

/// A plot of series.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chart {
    /// Names the files in `plots/`.
    pub name: String,
    /// Over it.
    pub title: String,
    /// Across.
    pub x: Axis,
    /// Up.
    pub y: Axis,
    /// Drawn in order, the last on top.
    pub series: Vec<Series>,
    /// Both axes in one scale, as a plan needs it.
    pub is_plan: bool,
}

impl Axis {
    /// By differences.
    pub fn linear(label: &str) -> Self {
        Self { label: label.to_owned(), scale: Scale::Linear }
    }

    /// By ratios.
    pub fn logarithmic(label: &str) -> Self {
        Self { label: label.to_owned(), scale: Scale::Logarithmic }
    }
}

impl Point {
    /// A point without spread.
    pub fn new(x: f64, y: f64, label: impl Into<String>) -> Self {
        Self { at: [x, y], label: label.into(), ..Self::default() }
    }
}

impl Picture {
    /// A picture of `images/`.
    pub fn new(file: impl Into<String>, caption: impl Into<String>) -> Self {
        Self { file: file.into(), caption: caption.into() }
    }
}
