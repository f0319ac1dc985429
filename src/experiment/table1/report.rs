//! The paper's figures and ours in one table.

use super::run::CELLS;
use crate::experiment::run::report::{Block, Picture, Section, fields, row};
use crate::experiment::run::{Identity, Report, RunRecord, matching, median_of};
use serde_json::{Map, Value, json};

/// A column of the paper's Table 1: share in percent and seconds of each type, and the printed sum.
#[derive(Clone, Copy)]
struct Printed {
    percent: [f64; 3],
    secs: [f64; 3],
    sum_secs: f64,
}

/// The paper's Table 1: the columns for one and for two references.
const PAPER: [Printed; 2] = [
    Printed { percent: [56.55, 9.96, 33.49], secs: [3.01, 36.26, 171.61], sum_secs: 211.41 },
    Printed { percent: [66.74, 10.52, 22.74], secs: [4.32, 38.30, 125.23], sum_secs: 168.53 },
];
/// Seconds of full ray tracing in the paper.
const PAPER_RT_SECS: f64 = 550.72;
/// Milliseconds per pixel as printed below each type.
const PAPER_MS_PER_PIXEL: [f64; 3] = [0.25, 1.39, 2.1];
const PAPER_PIXELS: f64 = 65536.0;

/// Medians of one cell.
#[derive(Clone, Debug)]
struct Column {
    mode: &'static str,
    references: usize,
    percent: [f64; 3],
    secs: [f64; 3],
    ms_per_pixel: [Option<f64>; 3],
    frame_secs: f64,
    reference_secs: f64,
    speedup: Option<f64>,
    psnr_db: f64,
    flip_mean: f64,
    see_through_percent: f64,
}

impl Column {
    fn of(mode: &'static str, references: usize, records: &[RunRecord]) -> Option<Self> {
        let wanted = |mode: &str, n: usize| RunRecord::default().with("mode", mode).with("references", n);
        let found = matching(records, &wanted(mode, references));
        let middle = |name: &str| median_of(&found, name);
        let per_type = |unit: &str| [1, 2, 3].map(|t| middle(&format!("type{t}_{unit}")).unwrap_or(0.0));
        let (percent, secs, pixels) = (per_type("percent"), per_type("secs"), middle("pixels")?);
        let ms = |t: usize| (percent[t] > 0.0).then(|| 1e3 * secs[t] / (pixels * percent[t] / 100.0));
        let frame_secs = middle("frame_secs")?;
        let full_secs = median_of(&matching(records, &wanted("full", 0)), "frame_secs");
        Some(Self {
            mode,
            references,
            percent,
            secs,
            ms_per_pixel: [0, 1, 2].map(ms),
            frame_secs,
            reference_secs: middle("reference_secs")?,
            speedup: full_secs.map(|full| full / frame_secs),
            psnr_db: middle("psnr_db")?,
            flip_mean: middle("flip_mean")?,
            see_through_percent: middle("see_through_percent")?,
        })
    }

    fn name(&self) -> String {
        if self.references == 0 {
            self.mode.to_owned()
        } else {
            format!("{}, {} ref.", self.mode, self.references)
        }
    }

    fn sentence(&self, full: &Column) -> String {
        format!(
            "Mode {} with {} reference{} takes {:.1} ms, {:.2} times as fast as full ray tracing ({:.1} ms), at {:.1} dB \
             PSNR against {:.1} dB.",
            self.mode,
            self.references,
            if self.references == 1 { "" } else { "s" },
            self.frame_secs * 1e3,
            full.frame_secs / self.frame_secs,
            full.frame_secs * 1e3,
            self.psnr_db,
            full.psnr_db,
        )
    }

    /// Rows of the table of all modes.
    fn rows(&self) -> Vec<(String, Option<f64>)> {
        let of_type = |t: usize| {
            let name = |unit: &str| format!("Type {}, {unit}", t + 1);
            [
                (name("share in %"), Some(self.percent[t])),
                (name("ms"), Some(self.secs[t] * 1e3)),
                (name("us per pixel"), self.ms_per_pixel[t].map(|ms| ms * 1e3)),
            ]
        };
        let of_frame = [
            ("frame, ms", Some(self.frame_secs * 1e3)),
            ("speed-up", self.speedup),
            ("references, ms together", Some(self.reference_secs * 1e3)),
            ("PSNR, dB", Some(self.psnr_db)),
            ("FLIP, mean", Some(self.flip_mean)),
            ("reused pixels that see through, %", Some(self.see_through_percent)),
        ];
        (0..3).flat_map(of_type).chain(of_frame.map(|(name, value)| (name.to_owned(), value))).collect()
    }
}

pub(crate) fn report(identity: &Identity, records: &[RunRecord]) -> Report {
    let columns: Vec<Column> =
        CELLS.iter().filter_map(|(mode, n)| Column::of(mode.name(), *n, records)).collect();
    let full = columns.iter().find(|c| c.mode == "full");
    let reusing = columns.iter().filter(|c| c.mode != "full");
    let table =
        vec![with_the_paper(&columns), Block::text(inconsistency()), Block::text(OURS), all_modes(&columns)];
    Report {
        headline: full.map_or(Vec::new(), |full| reusing.map(|c| c.sentence(full)).collect()),
        summary: summary(&columns),
        sections: vec![Section::new("Table 1", table), Section::new("Figures 2 to 4", figures(&columns))],
        notes: Vec::from_iter(identity.light()),
        ..Report::default()
    }
}

const OURS: &str = "Seconds are medians over the repetitions, in wall time of all threads. Type 1 contains the warp, the \
    classification and the copying; in the look-up modes it contains the primary rays and look-ups of all pixels.";

fn summary(columns: &[Column]) -> Map<String, Value> {
    let column = |c: &Column| {
        json!({
            "mode": c.mode, "references": c.references,
            "type1_percent": c.percent[0], "type2_percent": c.percent[1], "type3_percent": c.percent[2],
            "type1_secs": c.secs[0], "type2_secs": c.secs[1], "type3_secs": c.secs[2],
            "type1_ms_per_pixel": c.ms_per_pixel[0], "type2_ms_per_pixel": c.ms_per_pixel[1],
            "type3_ms_per_pixel": c.ms_per_pixel[2],
            "frame_secs": c.frame_secs, "reference_secs": c.reference_secs, "speedup": c.speedup,
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
    fields(json!({
        "columns": columns.iter().map(column).collect::<Vec<_>>(),
        "paper": { "one_reference": paper(&PAPER[0]), "two_references": paper(&PAPER[1]),
                   "full_secs": PAPER_RT_SECS, "printed_ms_per_pixel": PAPER_MS_PER_PIXEL },
    }))
}

/// The rows of the paper's table, with its figures next to ours.
fn with_the_paper(columns: &[Column]) -> Block {
    type Value<'a> = &'a dyn Fn(&Column) -> Option<f64>;
    let ours = |mode: &str, n: usize| columns.iter().find(|c| c.mode == mode && c.references == n);
    let (full, one, two) = (ours("full", 0), ours("paper", 1), ours("paper", 2));
    let line = |name: String, paper: [f64; 2], value: Value<'_>, full: [Option<f64>; 2]| {
        let both = [Some(paper[0]), one.and_then(value), Some(paper[1]), two.and_then(value)];
        row(name, both.into_iter().chain(full))
    };
    let mut rows = Vec::new();
    for (t, printed_ms) in PAPER_MS_PER_PIXEL.into_iter().enumerate() {
        let mut add = |what: &str, paper: [f64; 2], value: Value<'_>| {
            rows.push(line(format!("Type {}, {what}", t + 1), paper, value, [None; 2]));
        };
        add("share in %", PAPER.map(|p| p.percent[t]), &|c| Some(c.percent[t]));
        add("seconds", PAPER.map(|p| p.secs[t]), &|c| Some(c.secs[t]));
        add("ms per pixel by the table", PAPER.map(|p| derived_ms(&p, t)), &|c| c.ms_per_pixel[t]);
        add("ms per pixel as printed", [printed_ms; 2], &|_| None);
    }
    let full_secs = [Some(PAPER_RT_SECS), full.map(|c| c.frame_secs)];
    rows.push(line("sum, seconds".into(), PAPER.map(|p| p.sum_secs), &|c| Some(c.frame_secs), full_secs));
    let paper_speedup = PAPER.map(|p| PAPER_RT_SECS / p.sum_secs);
    rows.push(line("speed-up".into(), paper_speedup, &|c| c.speedup, [Some(1.0); 2]));
    let columns =
        ["", "paper, 1 ref.", "ours, 1 ref.", "paper, 2 refs.", "ours, 2 refs.", "paper, full", "ours, full"];
    Block::table("The paper's Table 1 and mode paper", columns, rows)
}

/// Milliseconds per pixel of a type, from the seconds and the share in the paper's own table.
fn derived_ms(printed: &Printed, t: usize) -> f64 {
    1e3 * printed.secs[t] / (PAPER_PIXELS * printed.percent[t] / 100.0)
}

fn inconsistency() -> String {
    let derived = |p: &Printed| [0, 1, 2].map(|t| format!("{:.2}", derived_ms(p, t))).join(" / ");
    let [one, two] = &PAPER;
    format!(
        "The paper's table is not consistent. Below the types it prints 0.25 / 1.39 / 2.1 ms per pixel; its own seconds and \
         shares give {} ms with one reference and {} ms with two. Its seconds add up to {:.2} and {:.2}, not to the \
         printed {:.2} and {:.2}. Full tracing took {:.2} ms per pixel.",
        derived(one),
        derived(two),
        one.secs.iter().sum::<f64>(),
        two.secs.iter().sum::<f64>(),
        one.sum_secs,
        two.sum_secs,
        1e3 * PAPER_RT_SECS / PAPER_PIXELS,
    )
}

/// The same rows for every mode.
fn all_modes(columns: &[Column]) -> Block {
    let values: Vec<_> = columns.iter().map(Column::rows).collect();
    let names = values.first().into_iter().flatten().map(|(name, _)| name.clone());
    let rows = names.enumerate().map(|(i, name)| row(name, values.iter().map(|column| column[i].1)));
    let titles = std::iter::once(String::new()).chain(columns.iter().map(Column::name));
    Block::table("The same for every mode", titles, rows)
}

fn figures(columns: &[Column]) -> Vec<Block> {
    let picture = |file: &str, caption: &str| Picture::new(file, caption);
    let mut blocks = vec![
        Block::Pictures(vec![
            picture("reference-1.png", "Figure 2: the first reference"),
            picture("reference-2.png", "Figure 2: the second reference"),
        ]),
        Block::Slider {
            title: "Figures 3 and 4: reused from two references, and traced in full".to_owned(),
            before: picture("paper-2.png", "mode paper, two references"),
            after: picture("full-0.png", "full ray tracing"),
        },
    ];
    for c in columns.iter().filter(|c| c.references > 0) {
        let file = |what: &str| format!("{}-{}{what}.png", c.mode, c.references);
        let error = format!("FLIP error against the converged picture, mean {:.4}", c.flip_mean);
        blocks.push(Block::Pictures(vec![
            Picture::new(file(""), c.name()),
            Picture::new(file("-types"), "Type 1 blue, Type 2 yellow, Type 3 orange"),
            Picture::new(file("-error"), error),
        ]));
    }
    if columns.iter().any(|c| c.mode == "full") {
        blocks.push(Block::Pictures(vec![
            picture("full-0.png", "full"),
            picture("full-0-error.png", "FLIP error of full against the converged picture: its noise"),
        ]));
    }
    blocks
}
