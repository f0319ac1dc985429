//! The page of a tour: its pictures, which lie next to it, and charts of all frames. It has no
//! scripts and needs no network access.

use super::{
    chart::inline,
    page::{STYLE, render},
};
use crate::cli::{failure::Failure, flags::Flags};
use afterimage::{
    experiment::{
        FrameRecord, TourRecord,
        run::{
            Machine,
            report::{Axis, Chart, Drawn, Point, Series},
        },
    },
    raster::{pixel_types::TYPE_SRGB, save::write_atomically},
};
use serde_json::{Value, json};
use std::path::Path;

const TEMPLATE: &str = include_str!("tour.html");

/// What the page of a tour shows.
#[derive(Clone, Copy, Debug)]
pub(in crate::cli) struct TourPage<'a> {
    pub(in crate::cli) scene: &'a str,
    pub(in crate::cli) flags: &'a Flags,
    pub(in crate::cli) record: &'a TourRecord,
    /// Frames from one picture to the next.
    pub(in crate::cli) picture_every: u32,
    /// Time of the last frame in mode `full`, seconds.
    pub(in crate::cli) full_secs: Option<f64>,
}

/// Writes the page into the folder of its tour.
pub(in crate::cli) fn write_tour_page(path: &Path, page: &TourPage<'_>) -> Result<(), Failure> {
    let TourPage { scene, record, .. } = *page;
    let frames: Vec<Value> = page.pictured().map(figure).collect();
    let html = render(
        TEMPLATE,
        &json!({
            "style": STYLE,
            "scene": scene,
            "is_complete": record.is_complete,
            "frame_count": record.frames.len(),
            "headline": headline(page),
            "types": types(),
            "frames": frames,
            "charts": charts(&record.frames).map(|chart| inline(&chart)),
            "facts": facts(page),
        }),
    )?;
    Ok(write_atomically(path, html.as_bytes())?)
}

impl TourPage<'_> {
    /// The frames that were written as pictures.
    fn pictured(&self) -> impl Iterator<Item = &FrameRecord> {
        self.record.frames.iter().filter(|f| f.frame.is_multiple_of(self.picture_every.max(1)))
    }
}

fn ms(secs: f64) -> String {
    let ms = secs * 1e3;
    if ms < 10.0 { format!("{ms:.1} ms") } else { format!("{ms:.0} ms") }
}

fn headline(page: &TourPage<'_>) -> Vec<String> {
    let (record, mode) = (page.record, page.flags.mode.name());
    let summary = &record.summary;
    let mut lines = Vec::new();
    if let Some(secs) = summary.frame_secs_median {
        lines.push(format!("A frame of mode {mode} takes {} in the median.", ms(secs)));
    }
    if let Some(secs) = page.full_secs {
        lines.push(format!("Tracing every pixel of the last one, as mode full does, takes {}.", ms(secs)));
    }
    if record.references_added > 0 {
        let (count, secs) = (record.references_added, record.reference_secs_total);
        lines.push(format!("{count} reference images were traced on the way, in {secs:.1} s."));
    }
    if let Some(percent) = summary.type3_percent_median {
        lines.push(format!("In the median, {percent:.1} % of a frame's pixels had to be traced (Type 3)."));
    }
    lines
}

/// Names and colours of the pixel types.
fn types() -> Vec<Value> {
    let names = ["Type 1: light reused", "Type 2: mirror or glass", "Type 3: traced"];
    let color = |[r, g, b]: [u8; 3]| format!("#{r:02x}{g:02x}{b:02x}");
    names.iter().zip(TYPE_SRGB).map(|(name, srgb)| json!({ "name": name, "color": color(srgb) })).collect()
}

/// Links and caption of a frame.
fn figure(frame: &FrameRecord) -> Value {
    let (number, types) = (frame.frame, &frame.types);
    let measured = frame.measurement.map(|m| format!("; {:.1} dB measured", m.psnr_db));
    let estimated = || frame.audit.and_then(|a| a.psnr_db).map(|db| format!("; about {db:.0} dB PSNR"));
    json!({
        "number": number,
        "picture": format!("images/frame_{number:04}.png"),
        "types": format!("images/types_{number:04}.png"),
        "caption": format!(
            "Frame {number}: {}; Type 1 {:.1} %, Type 2 {:.1} %, Type 3 {:.1} %{}",
            ms(frame.frame_secs),
            types.type1_percent,
            types.type2_percent,
            types.type3_percent,
            measured.or_else(estimated).unwrap_or_default()
        ),
    })
}

/// Time and types of every frame.
fn charts(frames: &[FrameRecord]) -> [Chart; 2] {
    let series = |name: &str, unit: &str, value: &dyn Fn(&FrameRecord) -> f64| {
        let point = |f: &FrameRecord| {
            let y = value(f);
            Point::new(f.frame.into(), y, format!("frame {}: {name} {y:.1} {unit}", f.frame))
        };
        Series::new(name, Drawn::Line, frames.iter().map(point))
    };
    let chart = |name: &str, title: &str, y: &str, series: Vec<Series>| Chart {
        name: name.to_owned(),
        title: title.to_owned(),
        x: Axis::linear("frame"),
        y: Axis::linear(y),
        series,
    };
    let times = vec![
        series("frame", "ms", &|f| f.frame_secs * 1e3),
        series("reference traced after it", "ms", &|f| f.reference_secs * 1e3),
    ];
    let percents = vec![
        series("Type 1", "%", &|f| f.types.type1_percent).in_color("#0072b2"),
        series("Type 2", "%", &|f| f.types.type2_percent).in_color("#a87900"),
        series("Type 3", "%", &|f| f.types.type3_percent).in_color("#d55e00"),
    ];
    [
        chart("times", "Time of the frames", "milliseconds", times),
        chart("types", "Types of the pixels", "percent", percents),
    ]
}

/// Settings and machine that the times depend on.
fn facts(page: &TourPage<'_>) -> Vec<[String; 2]> {
    let (flags, machine) = (page.flags, Machine::here());
    let ([width, height], trace) = (flags.size(), flags.trace());
    let settings = format!(
        "mode {}, {width}x{height}, {} samples per light, bounces {}, seed {}",
        flags.mode.name(),
        trace.samples,
        trace.bounce_limit(),
        trace.seed
    );
    let processor = format!(
        "{} ({} logical cores), {} {}, {} threads",
        machine.processor,
        machine.logical_cores,
        machine.os,
        machine.arch,
        rayon::current_num_threads()
    );
    let pictures = page.pictured().count();
    vec![
        ["frames".to_owned(), format!("{}, of which {pictures} are shown", page.record.frames.len())],
        ["settings".to_owned(), settings],
        ["ran on".to_owned(), processor],
        ["version".to_owned(), env!("CARGO_PKG_VERSION").to_owned()],
        ["command".to_owned(), std::env::args().collect::<Vec<_>>().join(" ")],
    ]
}
