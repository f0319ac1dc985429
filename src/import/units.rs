//! What a number in the file means: the length unit and the axis that points up.

use crate::import::obj::Model;
use glam::{DVec3, Vec3};

/// The length that the number 1 stands for in a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// 0.001 m.
    Millimetre,
    /// 0.01 m.
    Centimetre,
    /// 1 m.
    Metre,
    /// 0.0254 m.
    Inch,
    /// 0.3048 m.
    Foot,
}

impl Unit {
    const ALL: [Self; 5] = [Self::Millimetre, Self::Centimetre, Self::Metre, Self::Inch, Self::Foot];

    /// Metres per unit.
    pub fn metres(self) -> f64 {
        match self {
            Self::Millimetre => 0.001,
            Self::Centimetre => 0.01,
            Self::Metre => 1.0,
            Self::Inch => 0.0254,
            Self::Foot => 0.3048,
        }
    }

    /// The abbreviation used on the command line and in a scene's `.afterimage.toml`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Millimetre => "mm",
            Self::Centimetre => "cm",
            Self::Metre => "m",
            Self::Inch => "in",
            Self::Foot => "ft",
        }
    }
}

impl std::str::FromStr for Unit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|u| u.name().eq_ignore_ascii_case(text.trim()));
        found.ok_or_else(|| format!("'{text}' is no unit; there are mm, cm, m, in, ft"))
    }
}

/// The axis of a model that points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Up {
    /// +Y, as most OBJ files have it.
    PlusY,
    /// +Z, as CAD and BIM programs have it.
    PlusZ,
}

impl Up {
    /// The spelling used on the command line and in a scene's `.afterimage.toml`.
    pub fn name(self) -> &'static str {
        match self {
            Self::PlusY => "+Y",
            Self::PlusZ => "+Z",
        }
    }

    pub(crate) fn world_from_model(self, p: DVec3) -> DVec3 {
        match self {
            Self::PlusY => p,
            Self::PlusZ => DVec3::new(p.x, p.z, -p.y),
        }
    }
}

impl std::str::FromStr for Up {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim().trim_start_matches('+').to_ascii_lowercase().as_str() {
            "y" => Ok(Self::PlusY),
            "z" => Ok(Self::PlusZ),
            _ => Err(format!("'{text}' is no up axis; there are +Y and +Z")),
        }
    }
}

/// How many of a file's first lines may declare its unit.
const HEADER_LINES: usize = 64;

/// The unit that a comment at the head of the file declares (`# Units: millimeters`), as several exporters write.
pub(crate) fn declared(text: &str) -> Option<Unit> {
    let header = text.lines().take(HEADER_LINES).filter_map(|l| l.trim_start().strip_prefix('#'));
    header.map(str::to_ascii_lowercase).find_map(|comment| {
        let (_, after) = comment.split_once("unit")?;
        let word =
            after.trim_start_matches(|c: char| !(c == ':' || c == '=')).trim_start_matches([':', '=', ' ']);
        let word: String = word.chars().take_while(|c| c.is_ascii_alphabetic()).collect();
        match word.as_str() {
            "mm" | "millimeters" | "millimetres" | "millimeter" | "millimetre" => Some(Unit::Millimetre),
            "cm" | "centimeters" | "centimetres" | "centimeter" | "centimetre" => Some(Unit::Centimetre),
            "m" | "meters" | "metres" | "meter" | "metre" => Some(Unit::Metre),
            "in" | "inches" | "inch" => Some(Unit::Inch),
            "ft" | "feet" | "foot" => Some(Unit::Foot),
            _ => None,
        }
    })
}

/// A unit nobody gave, and what to tell the user about it.
pub(crate) struct Guess {
    pub(crate) unit: Unit,
    pub(crate) said: Option<String>,
}

/// Beyond this many units across, metres are doubtful: the largest buildings are about a kilometre long.
const DOUBTFUL_LARGE: f64 = 2_000.0;
/// Beyond this many, metres would be a country and millimetres a house.
const SURELY_MILLIMETRES: f64 = 50_000.0;
/// Below this many, nobody can walk in it.
const DOUBTFUL_SMALL: f64 = 0.5;

/// Takes what the file declares and how many units it is across; returns the unit to use.
pub(crate) fn guess(declared: Option<Unit>, across: f64, how_to_say: &str) -> Guess {
    if let Some(unit) = declared {
        let said =
            format!("the file's header says that lengths are in {}; that is used. {how_to_say}", unit.name());
        return Guess { unit, said: (unit != Unit::Metre).then_some(said) };
    }
    let metre = |said| Guess { unit: Unit::Metre, said };
    if across > SURELY_MILLIMETRES {
        let said = format!(
            "the model is {across:.0} units across, which is taken as millimetres ({:.1} m). {how_to_say}",
            across * Unit::Millimetre.metres()
        );
        return Guess { unit: Unit::Millimetre, said: Some(said) };
    }
    if across > DOUBTFUL_LARGE {
        return metre(Some(format!(
            "the model is {across:.0} m across if its unit is the metre, which is used; in mm it would be {:.1} m, in \
             cm {:.0} m. {how_to_say}",
            across * Unit::Millimetre.metres(),
            across * Unit::Centimetre.metres()
        )));
    }
    if across < DOUBTFUL_SMALL {
        return metre(Some(format!(
            "the model is only {across:.3} m across if its unit is the metre, which is used. {how_to_say}"
        )));
    }
    metre(None)
}

/// Diagonal of the box round all vertices, in the file's units; zero where there are none.
pub(crate) fn across(model: &Model) -> f64 {
    let mut finite = model.positions.iter().filter(|p| p.is_finite());
    let Some(first) = finite.next() else { return 0.0 };
    let (low, high) = finite.fold((*first, *first), |(low, high), p| (low.min(*p), high.max(*p)));
    (high - low).length()
}

/// Turns a model's positions and normals into the world's: metres, +Y up.
pub(crate) fn to_world(model: &mut Model, unit: Unit, up: Up) -> Vec<DVec3> {
    let mut positions = std::mem::take(&mut model.positions);
    if up != Up::PlusY {
        positions.iter_mut().for_each(|p| *p = up.world_from_model(*p));
        model.normals.iter_mut().for_each(|n| *n = up.world_from_model(n.as_dvec3()).as_vec3());
    }
    if unit != Unit::Metre {
        // Dividing by 1000 rounds once; multiplying by 0.001 would round twice.
        let per_metre = (1.0 / unit.metres()).round();
        let exact = (per_metre * unit.metres() - 1.0).abs() < 1e-12;
        let scale = |p: DVec3| if exact { p / per_metre } else { p * unit.metres() };
        positions.iter_mut().for_each(|p| *p = scale(*p));
    }
    positions
}

/// True where a model that is taken as +Y up looks as if it lay on its side: by far the most area faces along Z, and
/// it is flatter along Z than along both other axes.
pub(crate) fn looks_z_up(positions_m: &[DVec3], triangles: &[[u32; 3]]) -> bool {
    /// Floors and ceilings of a building show this many times the area of the walls across one axis.
    const CLEARLY: f32 = 2.0;
    let mut facing = Vec3::ZERO;
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for t in triangles {
        let [a, b, c] = t.map(|v| positions_m[v as usize]);
        facing += (b - a).cross(c - a).abs().as_vec3();
        low = low.min(a).min(b).min(c);
        high = high.max(a).max(b).max(c);
    }
    let size = high - low;
    let flat = size.z > 0.0 && size.z < size.x.min(size.y) * 0.75;
    flat && facing.z > CLEARLY * facing.x.max(facing.y)
}
