//! The meaning of coordinates in a file: the length unit, and the axis that points up.

use glam::{DVec3, Vec3};

/// Length unit of a model.
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
    /// All units in the order of the enum, with their names and lengths in metres.
    const ALL: [(Self, &'static str, f64); 5] = [
        (Self::Millimetre, "mm", 0.001),
        (Self::Centimetre, "cm", 0.01),
        (Self::Metre, "m", 1.0),
        (Self::Inch, "in", 0.0254),
        (Self::Foot, "ft", 0.3048),
    ];

    /// Returns the length of the unit in metres.
    pub fn metres(self) -> f64 {
        Self::ALL[self as usize].2
    }

    /// Returns the abbreviation that the command line and `.afterimage.toml` files use.
    pub fn name(self) -> &'static str {
        Self::ALL[self as usize].1
    }
}

/// Error of parsing a word that must be one of a few.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{word}' is not {expected}; use one of {allowed}")]
pub struct UnknownWord {
    /// The word found.
    pub word: String,
    /// What it should be, with its article.
    pub expected: &'static str,
    /// The words that are allowed.
    pub allowed: &'static str,
}

impl UnknownWord {
    pub(super) fn new(word: &str, expected: &'static str, allowed: &'static str) -> Self {
        Self { word: word.to_owned(), expected, allowed }
    }
}

impl std::str::FromStr for Unit {
    type Err = UnknownWord;

    fn from_str(text: &str) -> Result<Self, UnknownWord> {
        let found = Self::ALL.iter().find(|(_, name, _)| name.eq_ignore_ascii_case(text.trim()));
        let unknown = || UnknownWord::new(text, "a length unit", "mm, cm, m, in, ft");
        found.map(|(unit, ..)| *unit).ok_or_else(unknown)
    }
}

/// Axis of a model that points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Up {
    /// +Y, as in most OBJ files.
    PlusY,
    /// +Z, as in CAD and BIM programs.
    PlusZ,
}

impl Up {
    /// Returns the spelling that the command line and `.afterimage.toml` files use.
    pub fn name(self) -> &'static str {
        match self {
            Self::PlusY => "+Y",
            Self::PlusZ => "+Z",
        }
    }

    pub(super) fn world_from_model(self, p: DVec3) -> DVec3 {
        match self {
            Self::PlusY => p,
            Self::PlusZ => DVec3::new(p.x, p.z, -p.y),
        }
    }
}

impl std::str::FromStr for Up {
    type Err = UnknownWord;

    fn from_str(text: &str) -> Result<Self, UnknownWord> {
        match text.trim().trim_start_matches('+').to_ascii_lowercase().as_str() {
            "y" => Ok(Self::PlusY),
            "z" => Ok(Self::PlusZ),
            _ => Err(UnknownWord::new(text, "an up axis", "+Y, +Z")),
        }
    }
}

/// Number of lines at the start of a file that may declare its unit.
const HEADER_LINES: usize = 64;

/// Returns the unit that a comment at the start of the file declares (`# Units: millimeters`), as
/// several exporters write.
pub(super) fn declared(text: &str) -> Option<Unit> {
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

/// A unit that the user did not give, with a message about it.
pub(super) struct Guess {
    pub(super) unit: Unit,
    pub(super) message: Option<String>,
}

/// Units across beyond which metres are doubtful: the largest buildings are about a kilometre long.
const DOUBTFUL_LARGE: f64 = 2_000.0;
/// Size in units above which a model is taken as millimetres: in metres it would be as large as a
/// country, in millimetres as a house.
const SURELY_MILLIMETRES: f64 = 50_000.0;
/// Units across below which metres make a model too small to walk in.
const DOUBTFUL_SMALL: f64 = 0.5;

/// Guesses the unit from what the file declares and from its size in units. `how_to_set` ends every
/// message.
pub(super) fn guess(declared: Option<Unit>, size: Option<Size>, how_to_set: &str) -> Guess {
    let across = size.map_or(0.0, |size| size.across);
    if let Some(unit) = declared {
        let message =
            format!("the file's header declares the unit {}, which is used. {how_to_set}", unit.name());
        return Guess { unit, message: (unit != Unit::Metre).then_some(message) };
    }
    let metre = |message| Guess { unit: Unit::Metre, message };
    if across > SURELY_MILLIMETRES {
        let message = format!(
            "the model is {across:.0} units across, which is taken as millimetres ({:.1} m). {how_to_set}",
            across * Unit::Millimetre.metres()
        );
        return Guess { unit: Unit::Millimetre, message: Some(message) };
    }
    if let Some(unit) = size.and_then(absurd_in_metres) {
        return Guess { unit, message: Some(taken_as(across, unit, how_to_set)) };
    }
    if across > DOUBTFUL_LARGE {
        return metre(Some(format!(
            "the model is {across:.0} m across if its unit is the metre, which is used; in mm it would be {:.1} m, in \
             cm {:.0} m. {how_to_set}",
            across * Unit::Millimetre.metres(),
            across * Unit::Centimetre.metres()
        )));
    }
    if across < DOUBTFUL_SMALL {
        return metre(Some(format!(
            "the model is only {across:.3} m across if its unit is the metre, which is used. {how_to_set}"
        )));
    }
    metre(None)
}

/// Size of a model in its units, with +Y up.
#[derive(Clone, Copy, Debug)]
pub(super) struct Size {
    /// Diagonal of the box without a few outliers.
    pub(super) across: f64,
    height: f64,
    /// Median length of an edge.
    edge: f64,
}

/// Measures a model without its outermost vertices, so that a stray one does not decide. `None`
/// without triangles.
pub(super) fn measure(positions: &[DVec3], triangles: &[[u32; 3]]) -> Option<Size> {
    /// Share of the triangles' corners that is left out at each end of each axis.
    const TRIMMED: usize = 1000;
    /// Largest number of triangles that are looked at.
    const LOOKED_AT: usize = 1 << 16;
    let step = triangles.len().div_ceil(LOOKED_AT).max(1);
    let corner = |v: &u32| positions.get(*v as usize).copied().filter(|p| p.is_finite());
    let looked_at: Vec<[DVec3; 3]> = triangles
        .iter()
        .step_by(step)
        .filter_map(|[a, b, c]| Some([corner(a)?, corner(b)?, corner(c)?]))
        .collect();
    let nth = |mut values: Vec<f64>, n: usize| *values.select_nth_unstable_by(n, f64::total_cmp).1;
    let last = looked_at.len().checked_mul(3)?.checked_sub(1)?;
    let trimmed = last / TRIMMED;
    let extent = [0, 1, 2].map(|axis| {
        let along = || looked_at.iter().flatten().map(|p| p[axis]).collect::<Vec<f64>>();
        nth(along(), last - trimmed) - nth(along(), trimmed)
    });
    let edges: Vec<f64> = looked_at.iter().map(|[a, b, _]| a.distance(*b)).collect();
    let middle = edges.len() / 2;
    // Where the model lies on its side, its height is along Z.
    let [x, y, z] = extent;
    let height = if z > 0.0 && z < x.min(y) * 0.75 { z } else { y };
    Some(Size { across: DVec3::from(extent).length(), height, edge: nth(edges, middle) })
}

/// Returns the unit of a model that no building, no street and no landscape would be in metres:
/// the one in which its storeys are as high as storeys are. `None` where metres are possible.
pub(super) fn absurd_in_metres(size: Size) -> Option<Unit> {
    /// Metres across from which a model may be absurd.
    const LARGE: f64 = 1000.0;
    /// Height in metres of no building.
    const TOO_HIGH: f64 = 400.0;
    /// Length of an edge in metres that is usual in landscapes only, which are flat.
    const LONG_EDGE: f64 = 25.0;
    /// Height over its size, at most, of a valley, a city of towers or a viaduct.
    const FLAT: f64 = 0.2;
    /// The same of a long house, and what is too high and too coarse for a landscape of that shape.
    const LONG: f64 = 0.05;
    const OF_LONG: (f64, f64) = (1000.0, 250.0);
    let is_huge = size.height > TOO_HIGH || size.edge > LONG_EDGE;
    let is_long = size.height >= LONG * size.across && size.height > OF_LONG.0 && size.edge > OF_LONG.1;
    let is_absurd = size.height >= FLAT * size.across && is_huge || is_long;
    if size.across <= LARGE || !is_absurd {
        return None;
    }
    // A house of one to four storeys first, then a tower; anything else is millimetres.
    let heights = [2.0..14.0, 14.0..120.0];
    let fits = |range: &std::ops::Range<f64>| {
        let units = [Unit::Millimetre, Unit::Centimetre, Unit::Inch, Unit::Foot];
        units.into_iter().find(|unit| range.contains(&(size.height * unit.metres())))
    };
    Some(heights.iter().find_map(fits).unwrap_or(Unit::Millimetre))
}

/// Returns the warning about a model that was taken as another unit.
pub(super) fn taken_as(across: f64, unit: Unit, how_to_set: &str) -> String {
    format!(
        "the model would be {across:.0} m across in metres; it is taken as {} ({:.1} m). {how_to_set}",
        unit.name(),
        across * unit.metres()
    )
}

/// Converts positions and normals to world space: metres, +Y up.
pub(super) fn to_world(positions: &mut [DVec3], normals: &mut [Vec3], unit: Unit, up: Up) {
    if up != Up::PlusY {
        for p in &mut *positions {
            *p = up.world_from_model(*p);
        }
        for n in normals {
            *n = up.world_from_model(n.as_dvec3()).as_vec3();
        }
    }
    if unit != Unit::Metre {
        // Dividing by 1000 rounds once; multiplying by 0.001 would round twice.
        let per_metre = (1.0 / unit.metres()).round();
        let exact = (per_metre * unit.metres() - 1.0).abs() < 1e-12;
        let scale = |p: DVec3| if exact { p / per_metre } else { p * unit.metres() };
        for p in positions {
            *p = scale(*p);
        }
    }
}

/// True where a model taken as +Y up seems to lie on its side: by far the most area faces along Z,
/// and the model is flatter along Z than along both other axes.
pub(super) fn looks_z_up(positions_m: &[DVec3], triangles: &[[u32; 3]]) -> bool {
    /// Ratio of the area of floors and ceilings of a building to that of the walls across one axis.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// The unit of a model by its horizontal sides, its height and the median length of its edges.
    fn unit([x, z, height, edge]: [f64; 4]) -> Option<Unit> {
        absurd_in_metres(Size { across: DVec3::new(x, height, z).length(), height, edge })
    }

    #[test]
    fn cities_valleys_and_viaducts_stay_in_metres() {
        let blocks_with_towers = [1100.0, 1100.0, 200.0, 30.0];
        let midtown = [1500.0, 1500.0, 380.0, 30.0];
        let alpine_valley = [5000.0, 5000.0, 1000.0, 100.0];
        let viaduct = [2400.0, 30.0, 343.0, 40.0];
        for site in [blocks_with_towers, midtown, alpine_valley, viaduct] {
            assert_eq!(unit(site), None, "{site:?}");
        }
    }

    #[test]
    fn houses_in_millimetres_are_found_by_their_storeys() {
        let house = [8000.0, 6000.0, 3000.0, 900.0];
        let long_house = [30_000.0, 12_000.0, 3000.0, 900.0];
        for model in [house, long_house] {
            assert_eq!(unit(model), Some(Unit::Millimetre), "{model:?}");
        }
        assert_eq!(unit([1200.0, 900.0, 500.0, 80.0]), Some(Unit::Centimetre), "a house of 12 m");
    }
}
