//! The flags that every command knows, and how their values are read.

use crate::settings::Settings;
use afterimage::import::{Unit, Up};
use afterimage::raster::color::ToneMap;
use afterimage::trace::TraceSettings;
use afterimage::{Mode, RenderSettings};
use clap::Args;
use glam::DVec3;
use std::path::PathBuf;

/// What every command knows. A command takes from it what it needs.
#[derive(Args, Clone, Debug)]
pub(crate) struct Flags {
    /// Picture size in pixels; 1280x720.
    #[arg(long = "size", global = true, value_name = "WxH", value_parser = size)]
    pub(crate) given_size: Option<[u32; 2]>,
    /// How frames are made: `full` traces every pixel, `paper` reuses references as the paper does, `fast` and `exact`
    /// look light up in them.
    #[arg(long, global = true, value_name = "full|paper|fast|exact", default_value = "exact", value_parser = mode)]
    pub(crate) mode: Mode,
    /// Shadow rays per light and pixel; 16, in the window 4.
    #[arg(long, global = true, value_name = "N")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub(crate) samples: Option<u32>,
    /// Diffuse bounces; 0, direct light only.
    #[arg(long, global = true, value_name = "N")]
    #[arg(value_parser = clap::value_parser!(u32).range(0..=64))]
    pub(crate) bounces: Option<u32>,
    /// Of all random numbers: the same seed gives the same bits.
    #[arg(long, global = true, value_name = "N", default_value_t = 0)]
    pub(crate) seed: u64,
    /// Threads that trace; all of the machine's when absent.
    #[arg(long, global = true, value_name = "N", value_parser = threads)]
    pub(crate) threads: Option<usize>,
    /// What the number 1 stands for in the model; else what the model says.
    #[arg(long, global = true, value_name = "mm|cm|m|in|ft", value_parser = str::parse::<Unit>)]
    pub(crate) unit: Option<Unit>,
    /// Which axis of the model points up.
    #[arg(long, global = true, value_name = "+Y|+Z", value_parser = str::parse::<Up>)]
    pub(crate) up: Option<Up>,
    /// Lets a model open textures and libraries outside its own folder.
    #[arg(long, global = true)]
    pub(crate) allow_outside: bool,
    /// Prints exactly one JSON object on stdout.
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// Ends with code 4 where the scene has warnings.
    #[arg(long, global = true)]
    pub(crate) strict: bool,
    /// Where to stand, metres.
    #[arg(long, global = true, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    #[arg(conflicts_with = "view")]
    pub(crate) eye: Option<DVec3>,
    /// A point to look at, metres.
    #[arg(long, global = true, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    #[arg(conflicts_with = "view")]
    pub(crate) look_at: Option<DVec3>,
    /// Vertical field of view, degrees.
    #[arg(long, global = true, value_name = "DEG", value_parser = fov_y)]
    pub(crate) fov_y: Option<f64>,
    /// A saved view of the scene; the first one when neither this nor a pose is given.
    #[arg(long, global = true, value_name = "NAME")]
    pub(crate) view: Option<String>,
    /// Exposure of display-referred pictures, stops; 0, in the window what suits an opened model.
    #[arg(long, global = true, value_name = "EV", value_parser = exposure, allow_hyphen_values = true)]
    pub(crate) exposure: Option<f32>,
    /// Tone map of display-referred pictures.
    #[arg(long, global = true, value_name = "aces|linear", default_value = "aces", value_parser = tone_map)]
    pub(crate) tone_map: ToneMap,
    /// The user's settings; AFTERIMAGE_CONFIG, or settings.toml in the system's folder for them, when absent.
    #[arg(long, global = true, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
}

impl Flags {
    /// Fills in from the settings what was not given as a flag.
    pub(crate) fn fill_in(&mut self, settings: &Settings, is_given: impl Fn(&str) -> bool) {
        fn fill<T: Clone>(flag: &mut Option<T>, setting: &Option<T>) {
            *flag = flag.take().or_else(|| setting.clone());
        }
        fn replace<T: Copy>(flag: &mut T, setting: Option<T>, is_given: bool) {
            *flag = setting.filter(|_| !is_given).unwrap_or(*flag);
        }
        fill(&mut self.given_size, &settings.size);
        fill(&mut self.samples, &settings.samples);
        fill(&mut self.bounces, &settings.bounces);
        fill(&mut self.threads, &settings.threads);
        fill(&mut self.exposure, &settings.exposure_ev);
        replace(&mut self.mode, settings.mode, is_given("mode"));
        replace(&mut self.seed, settings.seed, is_given("seed"));
        replace(&mut self.tone_map, settings.tone_map, is_given("tone_map"));
    }

    /// Samples, bounces, seed.
    pub(crate) fn trace(&self) -> TraceSettings {
        let usual = TraceSettings::default();
        TraceSettings {
            samples: self.samples.unwrap_or(usual.samples),
            bounces: self.bounces.unwrap_or(usual.bounces),
            seed: self.seed,
        }
    }

    /// Mode and the above.
    pub(crate) fn render(&self) -> RenderSettings {
        RenderSettings { mode: self.mode, trace: self.trace() }
    }

    /// Exposure in stops where nothing is metered.
    pub(crate) fn exposure_ev(&self) -> f32 {
        self.exposure.unwrap_or(0.0)
    }

    /// Picture size in pixels.
    pub(crate) fn size(&self) -> [u32; 2] {
        self.given_size.unwrap_or([1280, 720])
    }

    /// Number of pixels of a picture.
    pub(crate) fn pixels(&self) -> u64 {
        self.size().map(u64::from).iter().product()
    }
}

/// `1280x720`.
pub(crate) fn size(text: &str) -> Result<[u32; 2], String> {
    let wanted = || "a size is two whole numbers from 1 to 65536, like 1280x720".to_owned();
    let (w, h) = text.split_once(['x', 'X']).ok_or_else(wanted)?;
    let side = |t: &str| t.parse().ok().filter(|n| (1..=65536).contains(n)).ok_or_else(wanted);
    Ok([side(w)?, side(h)?])
}

pub(crate) fn mode(text: &str) -> Result<Mode, String> {
    match text {
        "full" => Ok(Mode::Full),
        "paper" => Ok(Mode::Paper),
        "fast" => Ok(Mode::Fast),
        "exact" => Ok(Mode::Exact),
        _ => Err("there are 'full', 'paper', 'fast' and 'exact'".to_owned()),
    }
}

pub(crate) fn threads(text: &str) -> Result<usize, String> {
    let number = text.parse().ok().filter(|n| (1..=1024).contains(n));
    number.ok_or_else(|| "a number of threads is from 1 to 1024".to_owned())
}

pub(crate) fn tone_map(text: &str) -> Result<ToneMap, String> {
    match text {
        "aces" => Ok(ToneMap::Aces),
        "linear" => Ok(ToneMap::Linear),
        _ => Err("there are 'aces' and 'linear'".to_owned()),
    }
}

fn fov_y(text: &str) -> Result<f64, String> {
    let degrees = text.parse().ok().filter(|d| afterimage::Camera::FOV_Y_DEGREES.contains(d));
    degrees.ok_or_else(|| "a field of view is from 1 to 170 degrees".to_owned())
}

pub(crate) fn exposure(text: &str) -> Result<f32, String> {
    let stops = text.parse().ok().filter(|ev: &f32| ev.abs() <= 64.0);
    stops.ok_or_else(|| "an exposure is from -64 to 64 stops".to_owned())
}

/// `-1.5,2,0.25`.
pub(crate) fn point(text: &str) -> Result<DVec3, String> {
    // Beyond 1e12 m a position has no millimetres left even in f64.
    let number = |t: &str| t.trim().parse::<f64>().ok().filter(|n| n.abs() <= 1e12);
    let numbers: Option<Vec<f64>> = text.split(',').map(number).collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) => Ok(DVec3::new(x, y, z)),
        _ => Err("a point is three finite numbers, like -1.5,1.6,0".to_owned()),
    }
}
