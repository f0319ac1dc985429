//! The flags that every command has, and the parsers of their values.

use super::paths;
use crate::picture::pose_text::parse_point;
use crate::settings::{DEFAULT_BOUNCES, named, picture_size};
use afterimage::import::{DaylightOptions, LightChoice, SkyChoice, Unit, Up};
use afterimage::raster::{color::ToneMap, exposure::Exposure};
use afterimage::scene::GroundChoice;
use afterimage::scene::place::{PlaceAndTime, parse_place};
use afterimage::store::StoreSettings;
use afterimage::trace::{BounceLimit, TraceSettings};
use afterimage::{Mode, RenderSettings};
use clap::Args;
use clap::builder::{PossibleValuesParser, RangedU64ValueParser, TypedValueParser};
use glam::DVec3;
use serde::de::DeserializeOwned;
use std::{fmt::Display, ops::RangeInclusive, path::PathBuf, str::FromStr};

/// Which store of references is used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum StoreChoice {
    /// None.
    Off,
    /// The one in the user's cache folder.
    Default,
    /// The one in a folder.
    Folder(PathBuf),
}

impl FromStr for StoreChoice {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "" => Err("a store is a folder, 'off' or 'default'"),
            "off" => Ok(Self::Off),
            "default" => Ok(Self::Default),
            folder => Ok(Self::Folder(folder.into())),
        }
    }
}

impl StoreChoice {
    /// Folder of the store; `None` for none, and where the system names no folder for caches.
    pub(crate) fn folder(&self) -> Option<PathBuf> {
        match self {
            Self::Off => None,
            Self::Default => paths::cache_folder().map(|folder| folder.join("store")),
            Self::Folder(folder) => Some(folder.clone()),
        }
    }
}

/// The flags of every command; each command uses those that apply to it.
#[derive(Args, Clone, Debug)]
pub(crate) struct Flags {
    /// Picture size in pixels [default: 1280x720].
    #[arg(long = "size", global = true, value_name = "WxH", value_parser = picture_size)]
    pub(crate) given_size: Option<[u32; 2]>,
    /// How frames are rendered: `full` traces every pixel, `paper` reprojects references as in the
    /// paper, `fast` and `exact` look up light in references.
    #[arg(long, global = true, value_name = "full|paper|fast|exact", default_value = "exact")]
    #[arg(value_parser = named_parser::<Mode>(["full", "paper", "fast", "exact"]), hide_possible_values = true)]
    pub(crate) mode: Mode,
    /// Light samples per pixel: N for each light that matters at a point, and N paths for light
    /// that surfaces scatter; more than 64 lights share 16 rays for each sample [default: 16;
    /// in the window 4].
    #[arg(long, global = true, value_name = "N")]
    #[arg(value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub(crate) samples: Option<u32>,
    /// Maximum number of diffuse bounces of light: `all` is as many as matter, 0 is direct light
    /// only, as in the paper [default: all].
    #[arg(long, global = true, value_name = "all|N", value_parser = str::parse::<BounceLimit>)]
    pub(crate) bounces: Option<BounceLimit>,
    /// Seed of all random numbers: the same seed gives the same bits.
    #[arg(long, global = true, value_name = "N", default_value_t = 0)]
    pub(crate) seed: u64,
    /// Number of threads that trace rays [default: all of the machine].
    #[arg(long, global = true, value_name = "N")]
    #[arg(value_parser = RangedU64ValueParser::<usize>::new().range(1..=1024))]
    pub(crate) threads: Option<usize>,
    /// Unit of length of the model [default: the unit that the model declares].
    #[arg(long, global = true, value_name = "mm|cm|m|in|ft", value_parser = str::parse::<Unit>)]
    pub(crate) unit: Option<Unit>,
    /// Axis of the model that points up.
    #[arg(long, global = true, value_name = "+Y|+Z", value_parser = str::parse::<Up>)]
    pub(crate) up: Option<Up>,
    /// Allow a model to read textures and libraries outside its own folder.
    #[arg(long, global = true)]
    pub(crate) allow_outside: bool,
    /// The sky: a model that follows from the position of the sun, or a picture of all directions
    /// (.hdr, .exr) [default: that of the scene].
    #[arg(long, global = true, value_name = "overcast|clear|physical|FILE|none|default")]
    #[arg(value_parser = str::parse::<SkyChoice>)]
    pub(crate) sky: Option<SkyChoice>,
    /// Place on earth from which, with --sun-time, the position of the sun follows, degrees.
    #[arg(long, global = true, value_name = "LATITUDE,LONGITUDE", allow_hyphen_values = true)]
    #[arg(value_parser = parse_place)]
    pub(crate) sun_place: Option<[f64; 2]>,
    /// Local time at --sun-place, like 2026-06-21T12:00[Europe/Berlin]; 2026-06-21T10:00Z is
    /// universal time.
    #[arg(long, global = true, value_name = "TIME[ZONE]")]
    pub(crate) sun_time: Option<String>,
    /// Angle of north, clockwise from the model's -Z towards its +X, degrees; turns the sun of
    /// --sun-time and the picture of --sky.
    #[arg(long, global = true, value_name = "DEG", default_value_t = 0.0, allow_hyphen_values = true)]
    #[arg(value_parser = number_in(-360.0..=360.0, " degrees"))]
    pub(crate) north: f64,
    /// A level ground that takes shadows: at a height in metres, or `auto` for one at the lowest
    /// point of a model that has none, where there is daylight [default: as the model's
    /// .afterimage.toml says, else off; in the window auto].
    #[arg(long, global = true, value_name = "auto|off|HEIGHT", allow_hyphen_values = true)]
    #[arg(value_parser = str::parse::<GroundChoice>)]
    pub(crate) ground: Option<GroundChoice>,
    /// Dims or raises a group of lights by a factor, or `off`; `inspect` lists the groups. May be
    /// given several times.
    #[arg(long, global = true, value_name = "NAME=FACTOR", value_parser = str::parse::<LightChoice>)]
    pub(crate) light: Vec<LightChoice>,
    /// Print exactly one JSON object on stdout.
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// Exit with code 4 if the scene has warnings.
    #[arg(long, global = true)]
    pub(crate) strict: bool,
    /// Position of the camera, metres.
    #[arg(long, global = true, value_name = "X,Y,Z", value_parser = parse_point, allow_hyphen_values = true)]
    #[arg(conflicts_with = "view")]
    pub(crate) eye: Option<DVec3>,
    /// Point that the camera looks at, metres.
    #[arg(long, global = true, value_name = "X,Y,Z", value_parser = parse_point, allow_hyphen_values = true)]
    #[arg(conflicts_with = "view")]
    pub(crate) look_at: Option<DVec3>,
    /// Vertical field of view, degrees.
    #[arg(long, global = true, value_name = "DEG")]
    #[arg(value_parser = number_in(afterimage::Camera::FOV_Y_DEGREES, " degrees"))]
    pub(crate) fov_y: Option<f64>,
    /// Focal length of the lens before a film 36 mm wide, mm, in place of --fov-y: 24 is wide, 50
    /// normal.
    #[arg(long, global = true, value_name = "MM", conflicts_with = "fov_y")]
    #[arg(value_parser = number_in(2.0..=1000.0, " mm"))]
    pub(crate) lens: Option<f64>,
    /// Lean of the camera to the right, degrees, with `--eye`.
    #[arg(long, global = true, value_name = "DEG", allow_hyphen_values = true)]
    #[arg(value_parser = number_in(-180.0..=180.0, " degrees"), requires = "eye")]
    pub(crate) roll: Option<f64>,
    /// A saved view of the scene [default: the first one, if no pose is given].
    #[arg(long, global = true, value_name = "NAME")]
    pub(crate) view: Option<String>,
    /// Exposure of display-referred pictures, stops; `auto` measures the light in the scene
    /// [default: auto; 0 for embedded scenes that choose no other].
    #[arg(long, global = true, value_name = "auto|EV", allow_hyphen_values = true)]
    #[arg(value_parser = str::parse::<Exposure>)]
    pub(crate) exposure: Option<Exposure>,
    /// Tone map of display-referred pictures.
    #[arg(long, global = true, value_name = "aces|linear", default_value = "aces")]
    #[arg(value_parser = named_parser::<ToneMap>(["aces", "linear"]), hide_possible_values = true)]
    pub(crate) tone_map: ToneMap,
    /// Store of references that last: a folder, `default` for one in the user's cache folder. It is
    /// read and added to [default: off; in the window default].
    #[arg(long, global = true, value_name = "DIR|off|default", value_parser = str::parse::<StoreChoice>)]
    pub(crate) store: Option<StoreChoice>,
    /// Maximum size of the store; what was not used for longest is removed, MB.
    #[arg(long, global = true, value_name = "MB", default_value_t = 2048)]
    #[arg(value_parser = clap::value_parser!(u64).range(1..=1 << 30))]
    pub(crate) store_mb: u64,
    /// Log to stderr what the program does: -v the main steps, -vv the details, -vvv also the
    /// graphics libraries. RUST_LOG selects by module instead.
    #[arg(short, long, global = true, action = clap::ArgAction::Count)]
    pub(crate) verbose: u8,
    /// File of the user's settings [default: AFTERIMAGE_CONFIG, else settings.toml in the system's
    /// configuration folder].
    #[arg(long, global = true, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,
}

impl Flags {
    /// Samples, bounces and seed.
    pub(crate) fn trace(&self) -> TraceSettings {
        let defaults = TraceSettings::default();
        TraceSettings {
            samples: self.samples.unwrap_or(defaults.samples),
            bounces: self.bounces.unwrap_or(DEFAULT_BOUNCES).0,
            seed: self.seed,
        }
    }

    /// Mode, samples, bounces and seed.
    pub(crate) fn render(&self) -> RenderSettings {
        RenderSettings { mode: self.mode, trace: self.trace() }
    }

    /// Sun, sky and settings of lights that replace those of the scene. The error is for the user.
    pub(crate) fn daylight(&self) -> Result<DaylightOptions, String> {
        let sun = match (self.sun_place, &self.sun_time) {
            (None, None) => None,
            (Some(place), Some(time)) => {
                Some(PlaceAndTime::at(place, time).map_err(|error| format!("--sun-time: {error}"))?)
            }
            _ => return Err("--sun-place and --sun-time need each other".to_owned()),
        };
        let (sky, lights) = (self.sky.clone(), self.light.clone());
        Ok(DaylightOptions { lights, sky, sun, north_deg: self.north, ground: self.ground })
    }

    /// The store of references; `default` is used where none is given.
    pub(crate) fn store(&self, default: &StoreChoice) -> Option<StoreSettings> {
        let folder = self.store.as_ref().unwrap_or(default).folder()?;
        Some(StoreSettings { folder, max_bytes: self.store_mb << 20 })
    }

    /// Exposure in stops, if it is given or [`super::scene::Loaded::expose`] has set it; else 0.
    pub(crate) fn exposure_ev(&self) -> f32 {
        self.exposure.and_then(Exposure::stops).unwrap_or(0.0)
    }

    /// Vertical field of view in degrees, if it or a lens is given. A lens sees as wide as it does
    /// on film, whatever the shape of the picture.
    pub(crate) fn fov_y_deg(&self) -> Option<f64> {
        /// Half the width of the film, mm.
        const HALF_FILM: f64 = 18.0;
        let [width, height] = self.size().map(f64::from);
        let of_lens = |lens: f64| 2.0 * (HALF_FILM / lens * height / width).atan().to_degrees();
        let range = afterimage::Camera::FOV_Y_DEGREES;
        self.fov_y.or(self.lens.map(|lens| of_lens(lens).clamp(*range.start(), *range.end())))
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

/// A parser of values that are serialized as one of `names`.
fn named_parser<T: DeserializeOwned + Clone + Send + Sync + 'static>(
    names: impl IntoIterator<Item = &'static str>,
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(names).try_map(|name| named::<T>(&name))
}

/// A parser of numbers in a range; `unit` completes its message.
pub(super) fn number_in<T>(
    range: RangeInclusive<T>,
    unit: &'static str,
) -> impl Fn(&str) -> Result<T, String> + Clone + Send + Sync + 'static
where
    T: FromStr + PartialOrd + Display + Clone + Send + Sync + 'static,
{
    move |text| {
        let number = text.parse().ok().filter(|n| range.contains(n));
        number.ok_or_else(|| format!("it must be from {} to {}{unit}", range.start(), range.end()))
    }
}
