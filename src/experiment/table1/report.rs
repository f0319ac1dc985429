//! The paper's figures beside ours.

use crate::experiment::run::report::{Block, Picture, Section, Table};
use crate::experiment::run::{Identity, Report, RunRecord, counted};
use crate::experiment::statistics::median;
use serde_json::{Map, Value, json};

/// A column of the paper's Table 1: share in percent and seconds of each type, and the printed sum.
struct Printed {
    percent: [f64; 3],
    secs: [f64; 3],
    sum_secs: f64,
}

const PAPER: [Printed; 2] = [
    Printed { percent: [56.55, 9.96, 33.49], secs: [3.01, 36.26, 171.61], sum_secs: 211.41 },
    Printed { percent: [66.74, 10.52, 22.74], secs: [4.32, 38.30, 125.23], sum_secs: 168.53 },
];
/// Full ray tracing.
const PAPER_RT_SECS: f64 = 550.72;
/// As printed below each type.
const PAPER_MS_PER_PIXEL: [f64; 3] = [0.25, 1.39, 2.1];
const PAPER_PIXELS: f64 = 65536.0;

/// The medians of one cell.
#[derive(Clone, Debug)]
struct Column {
    mode: String,
    references: usize,
    percent: [f64; 3],
    secs: [f64; 3],
    ms_per_pixel: [Option<f64>; 3],
    frame_secs: f64,
    reference_secs: f64,
    psnr_db: f64,
    flip_mean: f64,
    see_through_percent: f64,
}

impl Column {
    fn of(mode: &str, references: usize, records: &[RunRecord]) -> Option<Self> {
        let wanted = RunRecord::default().with("mode", mode).with("references", references);
        let found = counted(records).filter(|r| r.agrees_with(&wanted));
        let middle = |name: &str| median(found.clone().filter_map(|r| r.number(name)));
        let per_type = |what: &str| [1, 2, 3].map(|t| middle(&format!("type{t}_{what}")).unwrap_or(0.0));
        let (percent, secs, pixels) = (per_type("percent"), per_type("secs"), middle("pixels")?);
        let ms = |t: usize| (percent[t] > 0.0).then(|| 1e3 * secs[t] / (pixels * percent[t] / 100.0));
        Some(Self {
            mode: mode.to_owned(),
            references,
            percent,
            secs,
            ms_per_pixel: [0, 1, 2].map(ms),
            frame_secs: middle("frame_secs")?,
            reference_secs: middle("reference_secs")?,
            psnr_db: middle("psnr_db")?,
            flip_mean: middle("flip_mean")?,
            see_through_percent: middle("see_through_percent")?,
        })
    }

    fn name(&self) -> String {
        match self.references {
            0 => self.mode.clone(),
            n => format!("{}, {n} ref.", self.mode),
        }
    }
}

pub(crate) fn report(_: &Identity, records: &[RunRecord]) -> Report {
    let columns: Vec<Column> =
        super::plan::CELLS.iter().filter_map(|(mode, n)| Column::of(mode.name(), *n, records)).collect();
    let full = columns.iter().find(|c| c.mode == "full");
    let mut report = Report { summary: summary(&columns), ..Report::default() };
    if let Some(full) = full {
        report.headline.extend(columns.iter().filter(|c| c.mode != "full").map(|c| sentence(c, full)));
    }
    report.sections.push(Section {
        title: "Table 1".to_owned(),
        blocks: vec![
            Block::Table(beside_the_paper(&columns)),
            Block::Text(inconsistency()),
            Block::Text(OURS.to_owned()),
            Block::Table(all_modes(&columns)),
        ],
    });
    report.sections.push(figures(&columns));
    report
}

const OURS: &str = "Seconds are medians over the repetitions, wall time of all threads together. Type 1 holds the warp, \
    the classification and the copying; in the modes that look up it holds the primary rays and look-ups of every pixel.";

fn sentence(c: &Column, full: &Column) -> String {
    format!(
        "Mode {} with {} reference{} takes {:.1} ms, {:.2} times as fast as full ray tracing ({:.1} ms), at {:.1} dB \
         PSNR against {:.1} dB.",
        c.mode,
        c.references,
        if c.references == 1 { "" } else { "s" },
        c.frame_secs * 1e3,
        full.frame_secs / c.frame_secs,
        full.frame_secs * 1e3,
        c.psnr_db,
        full.psnr_db,
    )
}

fn summary(columns: &[Column]) -> Map<String, Value> {
    let full = columns.iter().find(|c| c.mode == "full").map(|c| c.frame_secs);
    let column = |c: &Column| {
        json!({
            "mode": c.mode, "references": c.references,
            "type1_percent": c.percent[0], "type2_percent": c.percent[1], "type3_percent": c.percent[2],
            "type1_secs": c.secs[0], "type2_secs": c.secs[1], "type3_secs": c.secs[2],
            "type1_ms_per_pixel": c.ms_per_pixel[0], "type2_ms_per_pixel": c.ms_per_pixel[1],
            "type3_ms_per_pixel": c.ms_per_pixel[2],
            "frame_secs": c.frame_secs, "reference_secs": c.reference_secs,
            "speedup": full.map(|f| f / c.frame_secs),
            "psnr_db": c.psnr_db, "flip_mean": c.flip_mean, "see_through_percent": c.see_through_percent,
        })
    };
    let paper = |p: &Printed| {
        json!({
            "type1_percent": p.percent[0], "type2_percent": p.percent[1], "type3_percent": p.percent[2],
            "type1_secs": p.secs[0], "type2_secs": p.secs[1], "type3_secs": p.secs[2],
            "frame_secs": p.sum_secs, "speedup": PAPER_RT_SECS / p.sum_secs,
        })
    };
    let rows = json!({
        "columns": columns.iter().map(column).collect::<Vec<_>>(),
        "paper": { "one_reference": paper(&PAPER[0]), "two_references": paper(&PAPER[1]), "full_secs": PAPER_RT_SECS,
                   "printed_ms_per_pixel": PAPER_MS_PER_PIXEL },
    });
    rows.as_object().cloned().unwrap_or_default()
}

/// The paper's rows, its figures and ours side by side.
fn beside_the_paper(columns: &[Column]) -> Table {
    let ours = |mode: &str, n: usize| columns.iter().find(|c| c.mode == mode && c.references == n);
    let (full, one, two) = (ours("full", 0), ours("paper", 1), ours("paper", 2));
    let value = |v: Option<f64>| v.map_or(Value::Null, Value::from);
    let mut rows = Vec::new();
    for (t, printed_ms) in PAPER_MS_PER_PIXEL.into_iter().enumerate() {
        let number = t + 1;
        let mut row = |name: String, paper: [f64; 2], of: &dyn Fn(&Column) -> Option<f64>| {
            let [a, b] = paper.map(Value::from);
            rows.push(vec![
                name.into(),
                a,
                value(one.and_then(of)),
                b,
                value(two.and_then(of)),
                Value::Null,
                Value::Null,
            ]);
        };
        row(format!("Type {number}, share in %"), [PAPER[0].percent[t], PAPER[1].percent[t]], &|c| {
            Some(c.percent[t])
        });
        row(format!("Type {number}, seconds"), [PAPER[0].secs[t], PAPER[1].secs[t]], &|c| Some(c.secs[t]));
        row(
            format!("Type {number}, ms per pixel by the table"),
            [0, 1].map(|i| derived_ms(&PAPER[i], t)),
            &|c| c.ms_per_pixel[t],
        );
        row(format!("Type {number}, ms per pixel as printed"), [printed_ms; 2], &|_| None);
    }
    let secs = |c: Option<&Column>| value(c.map(|c| c.frame_secs));
    let speedup = |c: Option<&Column>| value(full.zip(c).map(|(f, c)| f.frame_secs / c.frame_secs));
    rows.push(vec![
        "sum, seconds".into(),
        PAPER[0].sum_secs.into(),
        secs(one),
        PAPER[1].sum_secs.into(),
        secs(two),
        PAPER_RT_SECS.into(),
        secs(full),
    ]);
    let paper_speedup = |i: usize| Value::from(PAPER_RT_SECS / PAPER[i].sum_secs);
    rows.push(vec![
        "speed-up".into(),
        paper_speedup(0),
        speedup(one),
        paper_speedup(1),
        speedup(two),
        1.0.into(),
        1.0.into(),
    ]);
    let columns =
        ["", "paper, 1 ref.", "ours, 1 ref.", "paper, 2 refs.", "ours, 2 refs.", "paper, full", "ours, full"];
    Table {
        title: "The paper's Table 1 and mode paper".to_owned(),
        columns: columns.map(str::to_owned).to_vec(),
        rows,
    }
}

/// A type's milliseconds per pixel by the seconds and the share that the paper's own table gives.
fn derived_ms(printed: &Printed, t: usize) -> f64 {
    1e3 * printed.secs[t] / (PAPER_PIXELS * printed.percent[t] / 100.0)
}

fn inconsistency() -> String {
    let derived = |i: usize| [0, 1, 2].map(|t| format!("{:.2}", derived_ms(&PAPER[i], t))).join(" / ");
    let sum = |i: usize| PAPER[i].secs.iter().sum::<f64>();
    format!(
        "The paper's table does not agree with itself. Below the types it prints 0.25 / 1.39 / 2.1 ms per pixel; its own \
         seconds and shares give {} ms with one reference and {} ms with two. Its seconds add up to {:.2} and {:.2}, not \
         to the printed {:.2} and {:.2}. Full tracing took {:.2} ms per pixel.",
        derived(0),
        derived(1),
        sum(0),
        sum(1),
        PAPER[0].sum_secs,
        PAPER[1].sum_secs,
        1e3 * PAPER_RT_SECS / PAPER_PIXELS,
    )
}

/// The same rows for every mode.
fn all_modes(columns: &[Column]) -> Table {
    let full = columns.iter().find(|c| c.mode == "full").map(|c| c.frame_secs);
    type Of<'a> = (String, Box<dyn Fn(&Column) -> Option<f64> + 'a>);
    let mut wanted: Vec<Of<'_>> = Vec::new();
    for t in 0..3 {
        wanted.push((format!("Type {}, share in %", t + 1), Box::new(move |c| Some(c.percent[t]))));
        wanted.push((format!("Type {}, ms", t + 1), Box::new(move |c| Some(c.secs[t] * 1e3))));
        wanted.push((
            format!("Type {}, us per pixel", t + 1),
            Box::new(move |c| c.ms_per_pixel[t].map(|ms| ms * 1e3)),
        ));
    }
    wanted.push(("frame, ms".to_owned(), Box::new(|c| Some(c.frame_secs * 1e3))));
    wanted.push(("speed-up".to_owned(), Box::new(move |c| full.map(|f| f / c.frame_secs))));
    wanted.push(("references, ms together".to_owned(), Box::new(|c| Some(c.reference_secs * 1e3))));
    wanted.push(("PSNR, dB".to_owned(), Box::new(|c| Some(c.psnr_db))));
    wanted.push(("FLIP, mean".to_owned(), Box::new(|c| Some(c.flip_mean))));
    wanted.push(("reused pixels that see through, %".to_owned(), Box::new(|c| Some(c.see_through_percent))));
    let row = |(name, of): &Of<'_>| {
        let values = columns.iter().map(|c| of(c).map_or(Value::Null, Value::from));
        std::iter::once(Value::from(name.clone())).chain(values).collect()
    };
    Table {
        title: "The same for every mode".to_owned(),
        columns: std::iter::once(String::new()).chain(columns.iter().map(Column::name)).collect(),
        rows: wanted.iter().map(row).collect(),
    }
}

fn figures(columns: &[Column]) -> Section {
    let picture = |file: &str, caption: &str| Picture::new(file, caption);
    let mut blocks = vec![
        Block::Pictures(vec![
            picture("reference-1.png", "Figure 2: the first reference image"),
            picture("reference-2.png", "the second"),
        ]),
        Block::Slider {
            title: "Figures 3 and 4: reused from two references, and traced in full".to_owned(),
            before: picture("paper-2.png", "mode paper, two references"),
            after: picture("full-0.png", "full ray tracing"),
        },
    ];
    for c in columns.iter().filter(|c| c.references > 0) {
        let stem = format!("{}-{}", c.mode, c.references);
        blocks.push(Block::Pictures(vec![
            Picture::new(format!("{stem}.png"), c.name()),
            Picture::new(format!("{stem}-types.png"), "Type 1 blue, Type 2 yellow, Type 3 orange"),
            Picture::new(
                format!("{stem}-error.png"),
                format!("FLIP against the truth, mean {:.4}", c.flip_mean),
            ),
        ]));
    }
    if columns.iter().any(|c| c.mode == "full") {
        blocks.push(Block::Pictures(vec![
            picture("full-0.png", "full"),
            picture("full-0-error.png", "FLIP of full against the truth: its noise"),
        ]));
    }
    Section { title: "Figures 2 to 4".to_owned(), blocks }
}
