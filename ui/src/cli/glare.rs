//! `afterimage glare`: vertical illuminance at the eye, glare sources, and the daylight glare
//! probability of a view.

use super::flags::Flags;
use super::scene::{Loaded, load};
use super::{failure::Failure, interrupt, output, pose::camera, progress::SharedProgress};
use afterimage::Camera;
use afterimage::render::lighting::glare::{
    GlareSource, GlareThreshold, MIN_VALID_LUX, VALID_DGP, daylight_glare_probability, describe,
};
use afterimage::render::lighting::{Fisheye, LightMeter, Reading, SeenSun, Sensor};
use afterimage::trace::TraceSettings;
use clap::Args;
use serde_json::{Value, json};
use std::time::Instant;

/// Samples of each ray, and of each pass of the sensor at the eye.
const SAMPLES: u32 = 8;
const SENSOR_SAMPLES: u32 = 64;

/// Passes of the sensor at the eye, at most.
const MAX_SENSOR_PASSES: u32 = 512;

/// Standard error of the vertical illuminance at which its measurement ends.
const SENSOR_ERROR: f64 = 0.01;

/// Groups of passes from whose spread the error of DGP is estimated.
const GROUPS: usize = 4;

/// Standard errors of a 95 % confidence interval, to each side.
const CONFIDENCE: f64 = 1.96;

#[derive(Args, Clone, Debug)]
pub(crate) struct GlareArgs {
    /// A model (.obj, .gltf, .glb) or builtin:NAME [default: the embedded gallery].
    pub(super) scene: Option<String>,
    /// Luminance above which a part of the view is a glare source: a number of cd/m2, or a multiple
    /// of the mean luminance of the view, such as 5x [default: 2000, as Evalglare 2].
    #[arg(long, value_name = "CD/M2|Nx", value_parser = threshold)]
    threshold: Option<GlareThreshold>,
    /// Width of the picture of the half sphere before the eye, in directions.
    #[arg(long, value_name = "N", default_value_t = 400)]
    #[arg(value_parser = clap::value_parser!(u16).range(32..=2048))]
    directions: u16,
    /// Rays in each direction.
    #[arg(long, value_name = "N", default_value_t = 16)]
    #[arg(value_parser = clap::value_parser!(u32).range(4..=4096))]
    rays: u32,
}

fn threshold(text: &str) -> Result<GlareThreshold, &'static str> {
    const WRONG: &str = "a threshold is a luminance above 0, such as 2000, or a multiple, such as 5x";
    let number = text.strip_suffix('x').unwrap_or(text);
    let value: f32 = number.parse().map_err(|_| WRONG)?;
    match value.is_finite() && value > 0.0 {
        true if number.len() < text.len() => Ok(GlareThreshold::TimesMean(value)),
        true => Ok(GlareThreshold::Luminance(value)),
        false => Err(WRONG),
    }
}

/// What was found.
struct Glare {
    ev: Reading,
    dgp: f64,
    /// Half the width of the 95 % confidence interval.
    dgp_error: f64,
    sources: Vec<GlareSource>,
    view: Fisheye,
    limit: f32,
}

pub(crate) fn run(args: &GlareArgs, flags: &Flags) -> Result<(), Failure> {
    let loaded = load(args.scene.as_deref(), flags)?;
    let camera = camera(flags, loaded.scene())?;
    let start = Instant::now();
    let glare = find(args, flags, &loaded, &camera)?;
    if !loaded.scene().is_photometric {
        output::say(
            "note: the model gives its lights without photometric units, so that lux, cd/m2 and DGP are those of \
             10,000 cd/m2 for a radiance of one, and not of the room",
        );
    }
    let notes = notes(&glare);
    notes.iter().for_each(|note| output::say(&format!("note: {note}")));
    loaded.say_bounds();
    let object = object(&loaded, &glare, &notes, start);
    output::result(flags.json, &object, || table(&glare, start));
    loaded.verdict(flags)
}

fn find(args: &GlareArgs, flags: &Flags, loaded: &Loaded, camera: &Camera) -> Result<Glare, Failure> {
    let threshold = args.threshold.unwrap_or_default();
    let progress = SharedProgress::new("tracing the view");
    let ev = vertical_illuminance(flags, loaded, camera)?;
    let (groups, view) = trace(args, flags, loaded, camera, &progress)?;
    let sun = sun(loaded, camera, &view);
    let of = |view: &Fisheye| {
        let (sources, limit) = view.sources(threshold, sun.as_ref());
        (daylight_glare_probability(ev.lux, &sources), sources, limit)
    };
    let spread: Vec<f64> = groups.iter().map(|view| of(view).0).collect();
    let (dgp, sources, limit) = of(&view);
    let mean = spread.iter().sum::<f64>() / GROUPS as f64;
    let variance = spread.iter().map(|dgp| (dgp - mean).powi(2)).sum::<f64>() / (GROUPS - 1) as f64;
    // The part of the illuminance, by its derivative without the contrast.
    let of_ev = 5.87e-5 * finite(ev.standard_error_lux).unwrap_or(ev.lux);
    let dgp_error = CONFIDENCE * (variance / GROUPS as f64 + of_ev * of_ev).sqrt();
    Ok(Glare { ev, dgp, dgp_error, sources, view, limit })
}

/// The illuminance of a sensor at the eye that faces along the line of sight.
fn vertical_illuminance(flags: &Flags, loaded: &Loaded, camera: &Camera) -> Result<Reading, Failure> {
    let facing = Fisheye::of_camera(camera, 1).ahead;
    let trace = TraceSettings { samples: SENSOR_SAMPLES, ..flags.trace() };
    let mut meter = LightMeter::new(&loaded.tracer, vec![Sensor { position_m: camera.eye, facing }], trace);
    while meter.passes() < MAX_SENSOR_PASSES && !meter.is_within(SENSOR_ERROR) {
        if !meter.pass(&interrupt::is_cancelled) {
            return Err(Failure::Interrupted);
        }
    }
    Ok(meter.readings()[0])
}

/// The views of the groups of passes, and their mean.
fn trace(
    args: &GlareArgs,
    flags: &Flags,
    loaded: &Loaded,
    camera: &Camera,
    progress: &SharedProgress,
) -> Result<(Vec<Fisheye>, Fisheye), Failure> {
    let empty = Fisheye::of_camera(camera, usize::from(args.directions));
    let eye = loaded.scene().frame.scene_from_world_f64(camera.eye).as_vec3();
    let settings = TraceSettings { samples: flags.samples.unwrap_or(SAMPLES), ..flags.trace() };
    let mut groups = vec![empty.clone(); GROUPS];
    let passes = args.rays.next_multiple_of(GROUPS as u32);
    for pass in 0..passes {
        let stop = &interrupt::is_cancelled;
        let seen =
            empty.trace_pass(&loaded.tracer, eye, &settings, pass, stop).ok_or(Failure::Interrupted)?;
        let group = &mut groups[pass as usize % GROUPS];
        let share = GROUPS as f32 / passes as f32;
        group.luminance.iter_mut().zip(seen).for_each(|(sum, luminance)| *sum += luminance * share);
        progress.at(f64::from(pass + 1) / f64::from(passes));
    }
    let mut mean = empty;
    for group in &groups {
        mean.luminance.iter_mut().zip(&group.luminance).for_each(|(sum, l)| *sum += l / GROUPS as f32);
    }
    Ok((groups, mean))
}

/// The disk of the sun, where it is before the eye and not hidden.
fn sun(loaded: &Loaded, camera: &Camera, view: &Fisheye) -> Option<SeenSun> {
    let eye = loaded.scene().frame.scene_from_world_f64(camera.eye).as_vec3();
    SeenSun::of(&loaded.tracer, eye).filter(|sun| sun.direction.dot(view.ahead) > 0.0)
}

/// What a reader must know about the numbers.
fn notes(glare: &Glare) -> Vec<String> {
    let mut notes = Vec::new();
    if glare.ev.lux < MIN_VALID_LUX {
        notes.push(format!(
            "DGP was developed for at least {MIN_VALID_LUX} lx at the eye; here are {:.0} lx, so that it says little",
            glare.ev.lux
        ));
    }
    let [low, high] = VALID_DGP;
    if !(low..=high).contains(&glare.dgp) {
        notes.push(format!("DGP was tested from {low} to {high}; {:.2} is outside", glare.dgp));
    }
    notes
}

fn object(loaded: &Loaded, glare: &Glare, notes: &[String], start: Instant) -> Value {
    let source = |source: &GlareSource| {
        json!({
            "luminance": source.luminance,
            "solid_angle_sr": source.solid_angle,
            "position_index": source.position_index,
            "direction": source.direction.to_array(),
            "is_sun": source.is_sun,
        })
    };
    let error = 100.0 * CONFIDENCE * glare.ev.standard_error_lux / glare.ev.lux;
    json!({
        "scene": loaded.name,
        "is_photometric": loaded.scene().is_photometric,
        "ev_lux": glare.ev.lux,
        "ev_error_percent": finite(error),
        "dgp": glare.dgp,
        "dgp_error": glare.dgp_error,
        "dgp_class": describe(glare.dgp),
        "is_valid": notes.is_empty(),
        "notes": notes,
        "threshold_cd_m2": glare.limit,
        "mean_luminance": glare.view.mean_luminance(),
        "sources": glare.sources.iter().map(source).collect::<Vec<_>>(),
        "secs": start.elapsed().as_secs_f64(),
    })
}

/// The number, or nothing where it is not known.
fn finite(number: f64) -> Option<f64> {
    Some(number).filter(|number| number.is_finite())
}

fn table(glare: &Glare, start: Instant) -> String {
    let error = 100.0 * CONFIDENCE * glare.ev.standard_error_lux / glare.ev.lux;
    let omega: f64 = glare.sources.iter().map(|source| source.solid_angle).sum();
    let strongest = glare.sources.first().map_or("none".to_owned(), |source| {
        let name = if source.is_sun { "the sun, " } else { "" };
        format!(
            "{name}{:.0} cd/m2, {:.4} sr, position index {:.1}",
            source.luminance, source.solid_angle, source.position_index
        )
    });
    output::table(&[
        ("vertical illuminance", format!("{:.0} lx at the eye, +-{error:.1} %", glare.ev.lux)),
        ("DGP", format!("{:.3} +-{:.3}, {}", glare.dgp, glare.dgp_error, describe(glare.dgp))),
        ("glare sources", format!("{} above {:.0} cd/m2, {omega:.3} sr", glare.sources.len(), glare.limit)),
        ("strongest", strongest),
        ("mean luminance", format!("{:.0} cd/m2", glare.view.mean_luminance())),
        ("time", format!("{:.1} s", start.elapsed().as_secs_f64())),
    ])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thresholds_are_parsed_and_faults_named() {
        assert_eq!(threshold("2000"), Ok(GlareThreshold::Luminance(2000.0)));
        assert_eq!(threshold("5x"), Ok(GlareThreshold::TimesMean(5.0)));
        for text in ["", "x", "-1", "0x", "nan", "inf"] {
            assert!(threshold(text).is_err(), "{text}");
        }
    }
}
