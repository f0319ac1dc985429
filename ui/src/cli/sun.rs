//! `afterimage sun`: pictures of a view through a day, or through a year at one hour.

use super::flags::Flags;
use super::pose::camera;
use super::progress::Progress;
use super::scene::{Loaded, load};
use super::{failure::Failure, interrupt, output};
use crate::picture::{Output, PictureJob, Shows, memory};
use afterimage::raster::save::{Target, write_atomically};
use afterimage::render::bands::Background;
use afterimage::scene::place::PlaceAndTime;
use afterimage::{Tracer, import::DaylightOptions};
use clap::Args;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

/// Pictures of a sweep, at most: every minute of a day.
const MAX_PICTURES: usize = 1440;

#[derive(Args, Clone, Debug)]
pub(crate) struct SunArgs {
    /// A model (.obj, .gltf, .glb) or builtin:NAME [default: the embedded gallery].
    pub(super) scene: Option<String>,
    /// Hours of the day of --sun-time, from, to and step [default: 8..20/1].
    #[arg(long, value_name = "FROM..TO[/STEP]", value_parser = str::parse::<Hours>, conflicts_with = "year")]
    hours: Option<Hours>,
    /// The same day and hour of each month of the year of --sun-time instead.
    #[arg(long)]
    year: bool,
    /// Folder for the pictures and sun.csv; created if it does not exist.
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
}

/// Hours of a day.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Hours {
    from: f64,
    to: f64,
    step: f64,
}

impl std::str::FromStr for Hours {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("'{text}' is no FROM..TO/STEP of hours from 0 to 24, such as 8..20/0.5");
        let (range, step) = text.split_once('/').unwrap_or((text, "1"));
        let (from, to) = range.split_once("..").ok_or_else(wrong)?;
        let number = |text: &str| text.trim().parse::<f64>().map_err(|_| wrong());
        let hours = Self { from: number(from)?, to: number(to)?, step: number(step)? };
        let is_usable =
            0.0 <= hours.from && hours.from <= hours.to && hours.to <= 24.0 && hours.step >= 1.0 / 60.0;
        if is_usable { Ok(hours) } else { Err(wrong()) }
    }
}

impl Hours {
    fn list(self) -> Vec<f64> {
        let count = ((self.to - self.from) / self.step + 1e-6) as usize + 1;
        (0..count.min(MAX_PICTURES)).map(|i| self.from + i as f64 * self.step).collect()
    }
}

/// A picture of the sweep.
struct Moment {
    time: PlaceAndTime,
    file: String,
}

pub(crate) fn run(args: &SunArgs, flags: &Flags) -> Result<(), Failure> {
    let daylight = flags.daylight().map_err(Failure::Usage)?;
    let Some(place) = daylight.sun.clone() else {
        let message = "a sweep needs the place and the day: --sun-place LATITUDE,LONGITUDE --sun-time \
                       2026-06-21T12:00[Europe/Berlin]";
        return Err(Failure::Usage(message.to_owned()));
    };
    memory::check(flags.pixels(), 1)?;
    std::fs::create_dir_all(&args.out)
        .map_err(|e| Failure::Failed(format!("cannot create the folder {}: {e}", args.out.display())))?;
    let loaded = load(args.scene.as_deref(), flags)?;
    // One exposure for all pictures, that of the given time, so that they can be compared.
    let flags = &loaded.expose(flags)?;
    let start = Instant::now();
    let moments = moments(args, &place);
    let mut progress = Progress::new("sun", moments.len() as u64);
    let mut rows = Vec::new();
    for (done, moment) in moments.iter().enumerate() {
        progress.at(done as u64, &moment.file);
        match render(args, flags, &loaded, &daylight, moment)? {
            Some(row) => rows.push(row),
            None => break,
        }
    }
    drop(progress);
    write_atomically(&args.out.join("sun.csv"), csv(&rows).as_bytes())?;
    let object = json!({
        "scene": loaded.name,
        "latitude_deg": place.latitude_deg,
        "longitude_deg": place.longitude_deg,
        "zone": place.zone,
        "pictures": rows,
        "secs": start.elapsed().as_secs_f64(),
    });
    output::result(flags.json, &object, || {
        output::table(&[
            ("pictures", format!("{} in {}", rows.len(), args.out.display())),
            ("time", format!("{:.1} s", start.elapsed().as_secs_f64())),
        ])
    });
    if interrupt::is_cancelled() { Err(Failure::Interrupted) } else { loaded.verdict(flags) }
}

/// The moments of the sweep. Days that a month does not have fall on its last.
fn moments(args: &SunArgs, place: &PlaceAndTime) -> Vec<Moment> {
    let named = |time: PlaceAndTime| {
        let minutes = (time.hours * 60.0).round() as u32;
        let (year, month, day) = (time.year, time.month, time.day);
        let file = format!("sun_{year:04}-{month:02}-{day:02}_{:02}{:02}.png", minutes / 60, minutes % 60);
        Moment { time, file }
    };
    if args.year {
        let of_month = |month| {
            let on = |day| PlaceAndTime { month, day, ..place.clone() };
            let last = (28..=place.day).rev().map(on).find(|time| time.sun().is_ok());
            named(last.unwrap_or_else(|| on(place.day.min(28))))
        };
        return (1..=12).map(of_month).collect();
    }
    let hours = args.hours.unwrap_or(Hours { from: 8.0, to: 20.0, step: 1.0 });
    hours.list().into_iter().map(|hours| named(PlaceAndTime { hours, ..place.clone() })).collect()
}

/// Renders the picture of a moment; `None` after an interrupt, which leaves no file of it.
fn render(
    args: &SunArgs,
    flags: &Flags,
    loaded: &Loaded,
    daylight: &DaylightOptions,
    moment: &Moment,
) -> Result<Option<Value>, Failure> {
    let sun = moment.time.sun().map_err(|error| Failure::Failed(error.to_string()))?;
    let options = DaylightOptions { sun: Some(moment.time.clone()), ..daylight.clone() };
    let lit = options.apply((**loaded.scene()).clone());
    let tracer: Tracer = loaded.tracer.with_state(Arc::new(lit));
    let job = PictureJob {
        outlines: None,
        document: None,
        scene_name: loaded.name.clone(),
        camera: camera(flags, loaded.scene())?,
        size: flags.size(),
        settings: flags.render(),
        antialias: None,
        background: Background::Shown,
        exposure_ev: flags.exposure_ev(),
        tone_map: flags.tone_map,
    };
    let output = Output { target: Target::File(args.out.join(&moment.file)), shows: Shows::Display };
    let made = job.make_whole(&tracer, &[], &[output], &interrupt::is_cancelled, &|_| ())?;
    let time = &moment.time;
    Ok(made.map(|_| {
        json!({
            "file": moment.file,
            "date": format!("{:04}-{:02}-{:02}", time.year, time.month, time.day),
            "hours": time.hours,
            "azimuth_deg": sun.azimuth_deg,
            "height_deg": sun.height_deg,
        })
    }))
}

fn csv(rows: &[Value]) -> String {
    let mut text = "file,date,hours,azimuth_deg,height_deg\n".to_owned();
    for row in rows {
        let word = |name: &str| row[name].as_str().map_or_else(|| row[name].to_string(), str::to_owned);
        let columns = ["file", "date", "hours", "azimuth_deg", "height_deg"].map(word);
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}", columns.join(","));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hours_are_parsed_and_faults_named() {
        let hours = |text: &str| text.parse::<Hours>().map(Hours::list);
        assert_eq!(hours("8..10/0.5"), Ok(vec![8.0, 8.5, 9.0, 9.5, 10.0]));
        assert_eq!(hours("12..12"), Ok(vec![12.0]));
        assert_eq!(hours("0..24").map(|list| list.len()), Ok(25));
        for text in ["", "8", "10..8", "8..25", "8..10/0", "nan..9", "8..10/x"] {
            assert!(hours(text).is_err_and(|error| error.contains("FROM..TO")), "{text}");
        }
    }
}
