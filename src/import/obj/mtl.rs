//! Parsing MTL text into materials as written; `interpret` gives them a meaning.
//!
//! Why not the parser of `tobj`: it panics on `Kd 0.5`, and rejects a whole library for one line
//! that it does not know.

use crate::import::text::{self, Lines};
use crate::import::{options::Limits, tally::Tally, trouble::Trouble};
use crate::scene::{Sampling, Wrap};
use glam::{Vec2, Vec3};

/// Texture of a material, as written.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MapSpec {
    /// File name as written, without options and quotes.
    pub(super) file: String,
    pub(super) scale: Vec2,
    pub(super) offset: Vec2,
    pub(super) sampling: Sampling,
    /// Factor of a relief (`-bm`).
    pub(super) strength: f32,
    pub(super) line: u64,
}

/// A material as written; what the file does not give is `None`.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct MtlMaterial {
    pub(super) name: String,
    /// Index of its library.
    pub(super) library: usize,
    pub(super) line: u64,
    pub(super) diffuse: Option<Vec3>,
    pub(super) specular: Option<Vec3>,
    pub(super) emission: Option<Vec3>,
    pub(super) filter: Option<Vec3>,
    pub(super) eta: Option<f32>,
    pub(super) opacity: Option<f32>,
    pub(super) transparency: Option<f32>,
    pub(super) illum: Option<u32>,
    pub(super) roughness: Option<f32>,
    pub(super) metallic: Option<f32>,
    /// Share of a clear coat.
    pub(super) coat: Option<f32>,
    /// Roughness of the clear coat.
    pub(super) coat_roughness: Option<f32>,
    pub(super) map_diffuse: Option<MapSpec>,
    /// Used where there is no `map_diffuse`.
    pub(super) map_ambient: Option<MapSpec>,
    pub(super) map_opacity: Option<MapSpec>,
    pub(super) map_emission: Option<MapSpec>,
    pub(super) map_roughness: Option<MapSpec>,
    pub(super) map_metallic: Option<MapSpec>,
    /// Heights or directions.
    pub(super) map_bump: Option<MapSpec>,
    /// Directions, which count before `map_bump`.
    pub(super) map_normal: Option<MapSpec>,
}

/// Parses the text of a library and adds its materials. A line that cannot be read is counted and
/// skipped.
pub(super) fn parse(text: &str, library: usize, materials: &mut Vec<MtlMaterial>, tally: &mut Tally) {
    let start = materials.len();
    for line in Lines::new(text, 1) {
        let (key, rest) = text::keyword(&line.text);
        let key = key.to_ascii_lowercase();
        if key == "newmtl" {
            materials.push(named(rest, library, line.number, tally));
        } else if !is_known(&key) {
            tally.add(Trouble::UNKNOWN_LINE, line.number, || key.clone());
        } else if let Some(material) = materials[start..].last_mut() {
            note_unused(&key, rest, line.number, tally);
            let mut read = set(material, &key, rest, line.number, tally);
            if read.is_none()
                && let Some(points) = text::with_decimal_points(rest)
            {
                read = set(material, &key, &points, line.number, tally);
                if read.is_some() {
                    tally.add(Trouble::DECIMAL_COMMA, line.number, || format!("{key} {rest}"));
                }
            }
            if read.is_none() {
                tally.add(Trouble::VALUE_UNREADABLE, line.number, || format!("{key} {rest}"));
            }
        } else if !key.is_empty() {
            tally.add(Trouble::BEFORE_FIRST_MATERIAL, line.number, || key.clone());
        }
    }
    for material in &mut materials[start..] {
        if material.map_diffuse.is_none() && material.map_ambient.is_some() {
            tally.add(Trouble::AMBIENT_PICTURE, material.line, || material.name.clone());
            material.map_diffuse = material.map_ambient.take();
        }
    }
}

fn named(rest: &str, library: usize, line: u64, tally: &mut Tally) -> MtlMaterial {
    let mut name = text::name(rest).to_owned();
    if name.len() > Limits::NAME_BYTES {
        tally.add(Trouble::NAME_TOO_LONG, line, String::new);
        name.clear(); // its lines must not change the material before it
    }
    MtlMaterial { name, library, line, ..MtlMaterial::default() }
}

/// True for the keywords of MTL and of its PBR extension, and for blank lines and comments (empty).
fn is_known(key: &str) -> bool {
    let is_colour = matches!(key, "ka" | "kd" | "ks" | "ke" | "tf" | "km");
    let is_scalar = matches!(key, "ni" | "ns" | "d" | "tr" | "illum" | "sharpness");
    let is_pbr = matches!(key, "pr" | "pm" | "ps" | "pc" | "pcr" | "aniso" | "anisor");
    let is_map = matches!(key, "bump" | "disp" | "decal" | "norm" | "refl") || key.starts_with("map_");
    key.is_empty() || key == "halo" || is_colour || is_scalar || is_pbr || is_map
}

/// Counts a keyword that is known and has no effect. `Ka` is not among them: light is traced, so
/// there is no ambient light that it could reflect.
fn note_unused(key: &str, rest: &str, line: u64, tally: &mut Tally) {
    let trouble = match key {
        "disp" | "map_disp" => Trouble::DISPLACEMENT,
        "map_ks" | "map_ns" | "map_ps" | "map_ni" => Trouble::GLOSS_PICTURE,
        "decal" | "map_decal" | "refl" | "map_refl" => Trouble::DECAL,
        "ps" | "aniso" | "anisor" if scalar(rest) != Some(0.0) => Trouble::FINISH,
        _ => return,
    };
    if !rest.is_empty() {
        tally.add(trouble, line, || format!("{key} {rest}"));
    }
}

/// Sets the value of a keyword. `None` where the value cannot be read.
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
        "pc" => m.coat = Some(scalar(rest)?),
        "pcr" => m.coat_roughness = Some(scalar(rest)?),
        // Exporters write a map without a file for "no texture".
        "map_kd" => m.map_diffuse = map(rest, line, tally),
        "map_ka" => m.map_ambient = map(rest, line, tally),
        "map_d" | "map_tr" | "map_opacity" => m.map_opacity = map(rest, line, tally),
        "map_ke" | "map_emissive" => m.map_emission = map(rest, line, tally),
        "map_pr" => m.map_roughness = map(rest, line, tally),
        "map_pm" => m.map_metallic = map(rest, line, tally),
        "bump" | "map_bump" => m.map_bump = map(rest, line, tally),
        "norm" | "map_norm" | "map_kn" => m.map_normal = map(rest, line, tally),
        _ => {}
    }
    Some(())
}

/// Parses a colour: one number for grey, or three. Two numbers, a spectral file and `xyz` are not
/// supported.
fn color(rest: &str, line: u64, tally: &mut Tally) -> Option<Vec3> {
    let mut found = [0.0f32; 3];
    let mut count = 0;
    for token in rest.split_ascii_whitespace().take_while(|t| !t.starts_with('#')) {
        if count == 3 {
            break; // some exporters write alpha too
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

/// Returns the minimum and maximum number of operands of an option before the file name.
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

/// Parses the operand of a `map_` line; `None` where it names no file.
fn map(rest: &str, line: u64, tally: &mut Tally) -> Option<MapSpec> {
    let sampling = Sampling::default();
    let file = String::new();
    let (scale, offset, strength) = (Vec2::ONE, Vec2::ZERO, 1.0);
    let mut spec = MapSpec { file, scale, offset, sampling, strength, line };
    let mut left = rest.trim();
    loop {
        let (option, after) = first_word(left);
        let Some((least, most)) = option_operands(&option.to_ascii_lowercase()) else { break };
        let mut operands = Vec::new();
        left = after;
        while operands.len() < most {
            let (word, after) = first_word(left);
            // Optional operands end where the numbers end, and never include the file name.
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
            "-bm" => spec.strength = value(0, 1.0),
            "-clamp" => {
                let is_on = operands.first().is_some_and(|word| word.eq_ignore_ascii_case("on"));
                spec.sampling.wrap = [if is_on { Wrap::Clamp } else { Wrap::Repeat }; 2];
            }
            other if !is_default(other, &operands) => {
                tally.add(Trouble::MAP_OPTION, line, || format!("{other} {}", operands.join(" ")));
            }
            _ => {}
        }
    }
    spec.file = text::name(left).to_owned();
    (!spec.file.is_empty() && spec.file.len() <= Limits::NAME_BYTES).then_some(spec)
}

/// True for an option that asks for what is done anyway.
fn is_default(option: &str, operands: &[&str]) -> bool {
    let expected = match option {
        "-blendu" | "-blendv" => "on",
        "-cc" => "off",
        "-mm" => "0",
        "-boost" => "0",
        "-texres" | "-type" => return true,
        "-imfchan" => "l",
        _ => "0",
    };
    let is_zero = |text: &str| text::number(text) == text::number(expected) && text::number(text).is_some();
    operands.first().is_none_or(|given| given.eq_ignore_ascii_case(expected) || is_zero(given))
}

fn first_word(text: &str) -> (&str, &str) {
    let text = text.trim_ascii_start();
    let end = text.bytes().position(|b| b.is_ascii_whitespace()).unwrap_or(text.len());
    (&text[..end], text[end..].trim_ascii_start())
}
