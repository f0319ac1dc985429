//! The MTL reader: a library's text to its materials as written. What they mean is `materials`' business.
//!
//! Not `tobj`'s: it panics on `Kd 0.5`, and one line it does not understand costs the whole library.

use crate::import::Limits;
use crate::import::report::{Tally, Trouble};
use crate::import::text;
use crate::import::text::Lines;
use glam::{Vec2, Vec3};

/// A texture as a material names it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MapSpec {
    /// As written, without options and quotes.
    pub(crate) file: String,
    pub(crate) scale: Vec2,
    pub(crate) offset: Vec2,
    pub(crate) line: u64,
}

/// A material as written; what a file does not say is `None`.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct MtlMaterial {
    pub(crate) name: String,
    /// Which library it is from, for messages.
    pub(crate) library: usize,
    pub(crate) line: u64,
    pub(crate) diffuse: Option<Vec3>,
    pub(crate) specular: Option<Vec3>,
    pub(crate) emission: Option<Vec3>,
    pub(crate) filter: Option<Vec3>,
    pub(crate) eta: Option<f32>,
    pub(crate) opacity: Option<f32>,
    pub(crate) transparency: Option<f32>,
    pub(crate) illum: Option<u32>,
    pub(crate) roughness: Option<f32>,
    pub(crate) metallic: Option<f32>,
    pub(crate) map_diffuse: Option<MapSpec>,
    pub(crate) map_opacity: Option<MapSpec>,
    pub(crate) map_emission: Option<MapSpec>,
}

/// Takes a library's text; adds its materials. A line that cannot be read is counted and skipped.
pub(crate) fn parse(text: &str, library: usize, materials: &mut Vec<MtlMaterial>, tally: &mut Tally) {
    let start = materials.len();
    for line in Lines::new(text, 1) {
        let (key, rest) = text::keyword(&line.text);
        let (key, rest) = (key.to_ascii_lowercase(), rest);
        if key == "newmtl" {
            materials.push(named(rest, library, line.number, tally));
            continue;
        }
        let known = is_known(&key);
        if key.is_empty() || !known {
            if !key.is_empty() {
                tally.add(Trouble::UNKNOWN_LINE, line.number, || key.clone());
            }
            continue;
        }
        if materials.len() == start {
            tally.add(Trouble::BEFORE_FIRST_MATERIAL, line.number, || key.clone());
            continue;
        }
        let Some(material) = materials.last_mut() else { continue };
        if set(material, &key, rest, line.number, tally).is_none() {
            tally.add(Trouble::VALUE_UNREADABLE, line.number, || format!("{key} {rest}"));
        }
    }
}

fn named(rest: &str, library: usize, line: u64, tally: &mut Tally) -> MtlMaterial {
    let mut name = text::name(rest).to_owned();
    if name.len() > Limits::NAME_BYTES {
        tally.add(Trouble::NAME_TOO_LONG, line, String::new);
        name.clear(); // its lines must not fall to the material before it
    }
    MtlMaterial { name, library, line, ..MtlMaterial::default() }
}

fn is_known(key: &str) -> bool {
    const KNOWN: &[&str] = &[
        "ka",
        "kd",
        "ks",
        "ke",
        "tf",
        "ni",
        "ns",
        "d",
        "tr",
        "illum",
        "sharpness",
        "km",
        "pr",
        "pm",
        "ps",
        "pc",
        "pcr",
        "aniso",
        "anisor",
        "bump",
        "disp",
        "decal",
        "norm",
        "refl",
        "halo",
    ];
    key.starts_with("map_") || KNOWN.contains(&key)
}

/// `None` where the value cannot be read.
fn set(m: &mut MtlMaterial, key: &str, rest: &str, line: u64, tally: &mut Tally) -> Option<()> {
    match key {
        "kd" => m.diffuse = Some(color(rest, line, tally)?),
        "ks" => m.specular = Some(color(rest, line, tally)?),
        "ke" => m.emission = Some(color(rest, line, tally)?),
        "tf" => m.filter = Some(color(rest, line, tally)?),
        "ni" => m.eta = Some(scalar(rest)?),
        "d" => m.opacity = Some(scalar(rest)?.clamp(0.0, 1.0)),
        "tr" => m.transparency = Some(scalar(rest)?.clamp(0.0, 1.0)),
        "illum" => m.illum = Some(illum(rest, line, tally)?),
        "pr" => m.roughness = Some(scalar(rest)?),
        "pm" => m.metallic = Some(scalar(rest)?),
        // A map without a file is what exporters write for "no texture".
        "map_kd" => m.map_diffuse = map(rest, line),
        "map_d" | "map_tr" => m.map_opacity = map(rest, line),
        "map_ke" => m.map_emission = map(rest, line),
        _ => {}
    }
    Some(())
}

/// One number for grey, or three. Two, a spectral file or `xyz` are not colours we know.
fn color(rest: &str, line: u64, tally: &mut Tally) -> Option<Vec3> {
    let mut found = [0.0f32; 3];
    let mut count = 0;
    for token in rest.split_ascii_whitespace().take_while(|t| !t.starts_with('#')) {
        if count == 3 {
            break; // some exporters add alpha
        }
        found[count] = finite(token)?;
        count += 1;
    }
    let color = match count {
        1 => Vec3::splat(found[0]),
        3 => Vec3::from_array(found),
        _ => return None,
    };
    if color.min_element() < 0.0 {
        tally.add(Trouble::VALUE_NEGATIVE, line, || rest.to_owned());
    }
    Some(color.max(Vec3::ZERO))
}

fn scalar(rest: &str) -> Option<f32> {
    finite(rest.split_ascii_whitespace().next()?)
}

fn finite(token: &str) -> Option<f32> {
    text::number(token).map(|n| n as f32).filter(|n| n.is_finite())
}

fn illum(rest: &str, line: u64, tally: &mut Tally) -> Option<u32> {
    let token = rest.split_ascii_whitespace().next()?;
    let model: u32 = token.split('#').next()?.parse().ok()?;
    if model > 10 {
        tally.add(Trouble::UNKNOWN_ILLUM, line, || rest.to_owned());
        return Some(2);
    }
    Some(model)
}

/// Options before the file name, and how many operands they take.
fn option_operands(option: &str) -> Option<(usize, usize)> {
    match option {
        "-s" | "-o" | "-t" => Some((1, 3)),
        "-mm" => Some((2, 2)),
        "-blendu" | "-blendv" | "-cc" | "-clamp" | "-bm" | "-boost" | "-texres" | "-imfchan" | "-type" => {
            Some((1, 1))
        }
        _ => None,
    }
}

/// The operand of a `map_` line; `None` where it names no file.
fn map(rest: &str, line: u64) -> Option<MapSpec> {
    let mut spec = MapSpec { file: String::new(), scale: Vec2::ONE, offset: Vec2::ZERO, line };
    let mut left = rest.trim();
    loop {
        let (option, after) = first_word(left);
        let Some((least, most)) = option_operands(&option.to_ascii_lowercase()) else { break };
        let mut operands = Vec::new();
        left = after;
        while operands.len() < most {
            let (word, after) = first_word(left);
            // Optional operands end where the numbers do, and never with the file name itself.
            let is_optional = operands.len() >= least;
            if word.is_empty() || is_optional && (text::number(word).is_none() || after.is_empty()) {
                break;
            }
            operands.push(word);
            left = after;
        }
        let value = |i: usize, or: f32| operands.get(i).and_then(|w| finite(w)).unwrap_or(or);
        match option.to_ascii_lowercase().as_str() {
            "-s" => spec.scale = Vec2::new(value(0, 1.0), value(1, 1.0)),
            "-o" => spec.offset = Vec2::new(value(0, 0.0), value(1, 0.0)),
            _ => {}
        }
    }
    spec.file = text::name(left).to_owned();
    (!spec.file.is_empty() && spec.file.len() <= Limits::NAME_BYTES).then_some(spec)
}

fn first_word(text: &str) -> (&str, &str) {
    let text = text.trim_ascii_start();
    let end = text.bytes().position(|b| b.is_ascii_whitespace()).unwrap_or(text.len());
    (&text[..end], text[end..].trim_ascii_start())
}
