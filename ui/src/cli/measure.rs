//! `afterimage measure`: the illuminance of a work plane, or at points of a file.

use super::flags::{Flags, number_in};
use super::scene::{Loaded, load};
use super::{failure::Failure, interrupt, output, pose::camera, progress::SharedProgress};
use crate::settings;
use crate::work_plane::{MeasuredPlane, Unit};
use afterimage::raster::save::write_atomically;
use afterimage::render::lighting::{
    LightMeter, MAX_POINTS, PlaneArea, PlaneError, PlaneStatistics, Sensor, WorkPlane, sun_hours,
    under_overcast_sky,
};
use afterimage::scene::place::PlaceAndTime;
use clap::Args;
use glam::{DVec3, Vec3};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Size limit of a file of points, bytes: enough for all points that can be measured.
const MAX_BYTES: u64 = 64 << 20;

/// Samples of a pass at each point.
const PASS_SAMPLES: u32 = 64;

/// Minutes from one look at the sun to the next.
const STEP_MINUTES: f64 = 5.0;

/// Passes after which a measurement ends, however large its error is.
const MAX_PASSES: u32 = 1024;

#[derive(Args, Clone, Debug)]
pub(crate) struct MeasureArgs {
    /// A model (.obj, .gltf, .glb) or builtin:NAME [default: the embedded gallery].
    pub(super) scene: Option<String>,
    /// A horizontal plane: its height above the floor in metres, and optionally a rectangle in
    /// world metres and the distance from walls. Without a rectangle it covers the room around the
    /// start view, --view or --eye [default: height=0.85].
    #[arg(long, value_name = "height=H[,x=A..B,z=A..B][,margin=M]", value_parser = str::parse::<PlaneText>)]
    #[arg(allow_hyphen_values = true, conflicts_with = "points")]
    plane: Option<PlaneText>,
    /// Distance between points of the plane, metres.
    #[arg(long, value_name = "M", default_value_t = 0.5, value_parser = number_in(0.001..=100.0, " metres"))]
    grid: f64,
    /// Measure at the points of a text file instead: in each line a position in world metres and
    /// the direction that the sensor faces, as x y z dx dy dz.
    #[arg(long, value_name = "FILE")]
    points: Option<PathBuf>,
    /// Standard error at which the measurement ends, percent of the reading, at 95 % of the points.
    #[arg(long, value_name = "PERCENT", default_value_t = 2.0, value_parser = number_in(0.05..=100.0, " percent"))]
    error: f64,
    /// Stop after this time, whatever the error is, seconds.
    #[arg(long, value_name = "S", value_parser = number_in(0.001..=604_800.0, " seconds"))]
    seconds: Option<f64>,
    /// Measure daylight factors in percent instead of lux: light in percent of that on open level
    /// ground, under the overcast sky of the CIE alone, whatever the sun, sky and lamps of the model.
    #[arg(long)]
    daylight_factor: bool,
    /// Count the hours of direct sun on the day of --sun-time at --sun-place instead.
    #[arg(long, conflicts_with = "daylight_factor")]
    sun_hours: bool,
    /// Write the points as a table: x, y, z, lux (or percent) and its standard error.
    #[arg(long, value_name = "FILE.csv")]
    csv: Option<PathBuf>,
}

/// A plane as the flag gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PlaneText {
    height_m: f64,
    margin_m: f64,
    rectangle_m: Option<[[f64; 2]; 2]>,
}

impl Default for PlaneText {
    fn default() -> Self {
        Self { height_m: 0.85, margin_m: 0.0, rectangle_m: None }
    }
}

impl std::str::FromStr for PlaneText {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (mut plane, mut x_m, mut z_m) = (Self::default(), None, None);
        for part in text.split(',') {
            let (key, value) = part.split_once('=').ok_or(format!("'{part}' is no KEY=VALUE"))?;
            match key.trim() {
                "height" => plane.height_m = metres(value)?,
                "margin" => plane.margin_m = metres(value)?,
                "x" => x_m = Some(range(value)?),
                "z" => z_m = Some(range(value)?),
                other => {
                    return Err(format!("a plane has height, margin, x and z, and no '{other}'"));
                }
            }
        }
        plane.rectangle_m = match (x_m, z_m) {
            (Some(x), Some(z)) => Some([x, z]),
            (None, None) => None,
            _ => return Err("a rectangle needs both x=A..B and z=A..B".to_owned()),
        };
        Ok(plane)
    }
}

fn metres(text: &str) -> Result<f64, String> {
    let value: f64 = text.trim().parse().map_err(|_| format!("'{text}' is no number of metres"))?;
    let is_usable = (0.0..=100.0).contains(&value);
    if is_usable { Ok(value) } else { Err(format!("{value} is not from 0 to 100 metres")) }
}

fn range(text: &str) -> Result<[f64; 2], String> {
    let ends = text.split_once("..").and_then(|(from, to)| {
        let number = |text: &str| text.trim().parse().ok().filter(|v: &f64| v.abs() < 1e7);
        Some([number(from)?, number(to)?])
    });
    match ends {
        Some([from, to]) if from < to => Ok([from, to]),
        _ => Err(format!("'{text}' is no range A..B of metres with A below B")),
    }
}

pub(crate) fn run(args: &MeasureArgs, flags: &Flags) -> Result<(), Failure> {
    let given = args.points.as_deref().map(read_points).transpose()?;
    let suns = if args.sun_hours { Some(suns(flags)?) } else { None };
    let loaded = load(args.scene.as_deref(), flags)?;
    let sensors = match given {
        Some(sensors) => sensors,
        None => sensors(args, flags, &loaded)?,
    };
    if let Some(suns) = suns {
        let readings = sun_hours(&loaded.tracer, &sensors, &suns, STEP_MINUTES / 60.0);
        let plane = MeasuredPlane::new(sensors, readings, Unit::Hours).ok_or(Failure::Interrupted)?;
        return answer_sun_hours(&plane, args, flags, &loaded);
    }
    let start = Instant::now();
    let trace =
        afterimage::trace::TraceSettings { samples: flags.samples.unwrap_or(PASS_SAMPLES), ..flags.trace() };
    let tracer = match args.daylight_factor {
        true => Arc::new(under_overcast_sky(&loaded.tracer)),
        false => loaded.tracer.clone(),
    };
    let mut meter = LightMeter::new(&tracer, sensors, trace);
    measure(&mut meter, args, start);
    let is_photometric = loaded.scene().is_photometric;
    let unit = Unit::new(args.daylight_factor, is_photometric);
    let plane = MeasuredPlane::new(meter.sensors().to_vec(), meter.readings(), unit)
        .filter(|_| meter.passes() > 0)
        .ok_or(Failure::Interrupted)?;
    if let Some(path) = &args.csv {
        write_atomically(path, plane.csv().as_bytes())?;
    }
    if unit == Unit::RelativeLux {
        output::say(
            "note: the model gives its lights without photometric units, so that lux are relative: \
             only their ratios mean something",
        );
    }
    loaded.say_bounds();
    let object = object(&loaded, &meter, &plane, start);
    output::result(flags.json, &object, || table(&meter, &plane, start));
    if interrupt::is_cancelled() { Err(Failure::Interrupted) } else { loaded.verdict(flags) }
}

/// The directions to the sun in the middle of equal steps of the day of `--sun-time`.
fn suns(flags: &Flags) -> Result<Vec<DVec3>, Failure> {
    let daylight = flags.daylight().map_err(Failure::Usage)?;
    let Some(day) = daylight.sun else {
        let message = "--sun-hours needs the place and the day: --sun-place LATITUDE,LONGITUDE --sun-time \
                       2026-06-21T12:00[Europe/Berlin]";
        return Err(Failure::Usage(message.to_owned()));
    };
    let steps = (24.0 * 60.0 / STEP_MINUTES) as u32;
    let at = |step: u32| {
        let hours = (f64::from(step) + 0.5) * STEP_MINUTES / 60.0;
        PlaceAndTime { hours, ..day.clone() }.sun().map(|sun| sun.direction(daylight.north_deg))
    };
    (0..steps).map(at).collect::<Result<_, _>>().map_err(|error| Failure::Failed(error.to_string()))
}

/// Writes and prints hours of direct sun.
fn answer_sun_hours(
    plane: &MeasuredPlane,
    args: &MeasureArgs,
    flags: &Flags,
    loaded: &Loaded,
) -> Result<(), Failure> {
    if let Some(path) = &args.csv {
        write_atomically(path, plane.csv().as_bytes())?;
    }
    let mut object = json!({ "scene": loaded.name, "step_minutes": STEP_MINUTES });
    output::extend(&mut object, plane.json());
    object["is_photometric"] = loaded.scene().is_photometric.into();
    output::result(flags.json, &object, || output::table(&plane.rows()));
    loaded.verdict(flags)
}

/// The points of the plane that the flags describe.
fn sensors(args: &MeasureArgs, flags: &Flags, loaded: &Loaded) -> Result<Vec<Sensor>, Failure> {
    let text = args.plane.unwrap_or_default();
    let eye = camera(flags, loaded.scene())?.eye;
    let area = match text.rectangle_m {
        Some([x_m, z_m]) => PlaneArea::Rectangle { x_m, z_m, above_m: eye.y },
        None => PlaneArea::Room(eye),
    };
    let plane = WorkPlane { height_m: text.height_m, grid_m: args.grid, margin_m: text.margin_m, area };
    plane.sensors(&loaded.tracer).map_err(|error| match error {
        PlaneError::BadNumbers => Failure::Usage(error.to_string()),
        _ => Failure::Failed(error.to_string()),
    })
}

/// Measures until the error is small, the time is over, or the user interrupts.
fn measure(meter: &mut LightMeter<'_>, args: &MeasureArgs, start: Instant) {
    let limit = args.seconds.map(Duration::from_secs_f64);
    let is_over = || limit.is_some_and(|limit| start.elapsed() >= limit);
    // The first passes count even where the time is short: without them there is no result.
    let stop = interrupt::is_cancelled;
    let progress = SharedProgress::new("measuring");
    while meter.passes() < MAX_PASSES && !meter.is_within(args.error / 100.0) {
        if (meter.passes() >= 2 && is_over()) || !meter.pass(&stop) {
            break;
        }
        // The error falls with the square root of the passes.
        let part = match limit {
            Some(limit) => start.elapsed().as_secs_f64() / limit.as_secs_f64(),
            None => f64::from(meter.passes()) / f64::from(MAX_PASSES),
        };
        let error = PlaneStatistics::new(&meter.readings()).map_or(0.0, |s| s.point_error_percent);
        progress.note(part.min(1.0), &format!("pass {}, +-{error:.1} % at a point", meter.passes()));
    }
}

/// Reads points and directions.
fn read_points(path: &Path) -> Result<Vec<Sensor>, Failure> {
    let text = settings::read_text(path, MAX_BYTES).map_err(|error| Failure::Failed(format!("{error:#}")))?;
    let lines = text.lines().enumerate().filter(|(_, line)| {
        let line = line.trim();
        !line.is_empty() && !line.starts_with('#')
    });
    let sensors: Result<Vec<Sensor>, Failure> = lines
        .map(|(number, line)| {
            sensor(line).ok_or_else(|| {
                Failure::Failed(format!(
                    "{}, line {}: not six finite numbers x y z dx dy dz with a direction",
                    path.display(),
                    number + 1
                ))
            })
        })
        .collect();
    let sensors = sensors?;
    match sensors.len() {
        0 => Err(Failure::Failed(format!("{} has no points", path.display()))),
        n if n > MAX_POINTS => {
            Err(Failure::Failed(format!("{} has {n} points; {MAX_POINTS} can be measured", path.display())))
        }
        _ => Ok(sensors),
    }
}

fn sensor(line: &str) -> Option<Sensor> {
    let separated = line.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty());
    let numbers: Vec<f64> = separated.map(|word| word.parse().ok()).collect::<Option<_>>()?;
    let &[x, y, z, dx, dy, dz] = numbers.as_slice() else { return None };
    let facing = Vec3::new(dx as f32, dy as f32, dz as f32).try_normalize()?;
    let position_m = DVec3::new(x, y, z);
    (position_m.is_finite() && facing.is_finite()).then_some(Sensor { position_m, facing })
}

fn object(loaded: &Loaded, meter: &LightMeter<'_>, plane: &MeasuredPlane, start: Instant) -> Value {
    let mut object = json!({
        "scene": loaded.name,
        "passes": meter.passes(),
        "rays": meter.rays,
        "secs": start.elapsed().as_secs_f64(),
    });
    output::extend(&mut object, plane.json());
    // Whatever was measured, this says it of the scene.
    object["is_photometric"] = loaded.scene().is_photometric.into();
    object
}

fn table(meter: &LightMeter<'_>, plane: &MeasuredPlane, start: Instant) -> String {
    let secs = start.elapsed().as_secs_f64();
    let mut rows = plane.rows().to_vec();
    rows.push(("time", format!("{secs:.1} s, {} passes", meter.passes())));
    output::table(&rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_are_parsed_and_faults_named() {
        let plane: PlaneText = "height=0.75,x=-1..2.5,z=0..4,margin=0.5".parse().unwrap();
        let rectangle_m = Some([[-1.0, 2.5], [0.0, 4.0]]);
        assert_eq!(plane, PlaneText { height_m: 0.75, margin_m: 0.5, rectangle_m });
        for (text, part) in [
            ("0.85", "KEY=VALUE"),
            ("height=x", "no number"),
            ("height=-1", "0 to 100"),
            ("depth=1", "no 'depth'"),
            ("x=0..1", "both"),
            ("x=1..0,z=0..1", "range"),
            ("x=nan..1,z=0..1", "range"),
        ] {
            let error = text.parse::<PlaneText>().unwrap_err();
            assert!(error.contains(part), "{text}: {error}");
        }
    }

    #[test]
    fn points_are_read_with_their_directions() {
        let found = sensor("1 2,3  0 0 -2").unwrap();
        assert_eq!(found, Sensor { position_m: DVec3::new(1.0, 2.0, 3.0), facing: Vec3::NEG_Z });
        for line in ["1 2 3", "1 2 3 0 0 0", "1 2 x 0 0 1", "1 2 inf 0 1 0", "1 2 3 0 1 0 9"] {
            assert_eq!(sensor(line), None, "{line}");
        }
    }
}
