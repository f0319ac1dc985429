//! The light of one cell, a function of the scene and the key alone.

use super::key::CellKey;
use crate::bsdf::Diffuse;
use crate::math::{Ray, key::Key, sequence::Sequence};
use crate::trace::bvh::Occluder;
use crate::trace::{LightKinds, RayCounts, SmoothSettings, SurfacePoint, Tracer};
use arrayvec::ArrayVec;
use glam::Vec3;

/// Points of a cell whose light is traced. Each takes one ray to every light and one path.
pub(super) const POINTS: usize = 16;

/// Surfaces, one behind the other, that one line through a cell may find.
const MAX_LAYERS: usize = 4;

/// Height above the surface, in sides of the cell, at which points of a cell must see each other.
const LIFT: f32 = 1.0 / 16.0;

/// Dimensions of the sequence of a cell beyond those of its paths.
const PLACE: u32 = 3 << 26;
const LIGHT: u32 = 7 << 24;

/// The light of a cell, or that it has no light of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cell {
    /// All light that arrives at its surfaces, as the radiance of a white one, and the point that
    /// sees all others.
    Lit(Vec3, Anchor),
    /// Its surfaces do not see each other, as on both sides of a wall, are close to a lamp, or are too
    /// small to be found.
    Divided,
}

/// The first point of a cell: the line that found it, and its depth along the line in steps of a
/// 4096th of the cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Anchor {
    line: u16,
    depth: u16,
}

/// Steps of [`Anchor::depth`] in a cell.
const DEPTH_STEPS: f32 = 4096.0;

/// Bits of a mantissa of a packed cell, and its largest value.
const MANTISSA: u32 = 13;
const MAX_MANTISSA: f32 = ((1 << MANTISSA) - 1) as f32;

impl Cell {
    const DIVIDED: u64 = 1;

    /// Packs the cell into a word that is never zero: three mantissas of 13 bits, the exponent of
    /// the largest channel, the anchor, and a bit that is set.
    pub(super) fn to_bits(self) -> u64 {
        let Self::Lit(light, anchor) = self else { return Self::DIVIDED };
        let exponent = (light.max_element().to_bits() >> 23).clamp(MANTISSA, 0xfe);
        // 2^(MANTISSA + 126 - exponent) in two factors, because it may be too large for one.
        let scale = |x: f32| x * power(126 - exponent as i32) * power(MANTISSA as i32);
        let mantissa = |x: f32| u64::from(scale(x).clamp(0.0, MAX_MANTISSA) as u32);
        let [r, g, b] = light.to_array().map(mantissa);
        let anchor = u64::from(anchor.line) << 12 | u64::from(anchor.depth);
        let color = r | g << MANTISSA | b << (2 * MANTISSA) | u64::from(exponent) << (3 * MANTISSA);
        1 << 63 | anchor << (3 * MANTISSA + 8) | color
    }

    pub(super) fn from_bits(bits: u64) -> Self {
        if bits >> 63 == 0 {
            return Self::Divided;
        }
        let exponent = (bits >> (3 * MANTISSA) & 0xff) as i32;
        let step = power(exponent - 126) * power(-(MANTISSA as i32));
        let channel = |i: u32| (bits >> (i * MANTISSA) & ((1 << MANTISSA) - 1)) as f32;
        let word = (bits >> (3 * MANTISSA + 8)) as u16;
        let anchor = Anchor { line: word >> 12 & 0xf, depth: word & 0xfff };
        Self::Lit(Vec3::new(channel(0), channel(1), channel(2)) * step, anchor)
    }
}

/// Two to the power of an exponent from -126 to 127.
fn power(exponent: i32) -> f32 {
    f32::from_bits(((exponent.clamp(-126, 127) + 127) as u32) << 23)
}

/// Traces the light of a cell, with up to `bounces` diffuse surfaces on the way.
pub(super) fn compute(tracer: &Tracer, key: &CellKey, bounces: u32, seed: u64) -> Cell {
    let (mut sum, kinds) = (Vec3::ZERO, kinds_by_rays(bounces));
    let anchor = for_each_sample(tracer, key, seed, |point, sample, sequence, rays| {
        let shift = light_shift(sequence, sample);
        let irradiance = tracer.irradiance_of(kinds, point, 1, shift, rays);
        let settings = SmoothSettings { bounces, cache: None, footprint: 0.0, samples: 1, finds_near: true };
        let smooth = tracer.smooth_light(point, sample..sample + 1, sequence, settings, rays);
        sum += Diffuse::WHITE.radiance(irradiance) + smooth[0] + smooth[1];
    });
    let light = sum / POINTS as f32;
    match anchor {
        Some(anchor) if light.is_finite() => Cell::Lit(light, anchor),
        _ => Cell::Divided,
    }
}

/// The lights that shadow rays bring to the points of a cell: near lamps are left to their paths.
pub(super) fn kinds_by_rays(bounces: u32) -> LightKinds {
    if bounces > 0 { LightKinds::FarButSky } else { LightKinds::AllButSky }
}

/// Passes the samples of a cell to `sample`, [`POINTS`] in number: each has a point, and a number
/// in the sequence of the cell. Returns the anchor; `None` where the cell is divided.
pub(super) fn for_each_sample(
    tracer: &Tracer,
    key: &CellKey,
    seed: u64,
    mut sample: impl FnMut(&SurfacePoint, u32, Sequence, &mut RayCounts),
) -> Option<Anchor> {
    let sequence = sequence_of(key, seed);
    let points = points_in(tracer, key, &sequence);
    let is_whole = |(first, anchor): &(SurfacePoint, Anchor)| {
        points.iter().all(|(p, _)| sees(tracer, key, p.position, first.position))
            && sees(tracer, key, first.position, position_of(key, &sequence, *anchor))
    };
    let (_, anchor) = points.first().filter(|first| is_whole(first)).copied()?;
    if points.iter().any(|(point, _)| is_close_to_lamp(tracer, key, point)) {
        return None;
    }
    // Rays of cells are not counted: which thread traces them is left to chance.
    let mut rays = RayCounts::default();
    for number in 0..POINTS as u32 {
        sample(&points[number as usize % points.len()].0, number, sequence, &mut rays);
    }
    Some(anchor)
}

/// True where a lamp is nearer in front of a point than the cell is wide. It may light that part of
/// the cell alone, which the rest of the room does not see, as the ceiling above a hanging panel.
fn is_close_to_lamp(tracer: &Tracer, key: &CellKey, point: &SurfacePoint) -> bool {
    if !tracer.scene().features.area_lights {
        return false;
    }
    let ray = Ray { t_max: key.length(), ..Ray::new(point.origin_in_front(), point.geometric_normal) };
    tracer.closest(&ray).is_some_and(|hit| tracer.scene().material_of(hit.triangle).is_emissive())
}

/// The random shift of each light for a sample of a cell.
pub(super) fn light_shift(sequence: Sequence, sample: u32) -> impl Fn(u32) -> [f32; 2] {
    move |light| sequence.pair(sample, LIGHT.wrapping_add(light))
}

fn sequence_of(key: &CellKey, seed: u64) -> Sequence {
    let hash = key.hash();
    Sequence::of_key(Key::of_pixel(seed, 0).with(hash as u32).with((hash >> 32) as u32))
}

/// Start of one of the lines through a cell, on the face that its surfaces look at, and its
/// direction.
fn line_through(key: &CellKey, sequence: &Sequence, line: u32) -> (Vec3, Vec3) {
    let (axis, sign) = key.facing();
    let [u, v] = sequence.pair(line, PLACE);
    let (mut origin, mut direction) = (key.low(), Vec3::ZERO);
    origin[(axis + 1) % 3] += u * key.length();
    origin[(axis + 2) % 3] += v * key.length();
    origin[axis] += if sign > 0.0 { key.length() } else { 0.0 };
    direction[axis] = -sign;
    (origin, direction)
}

fn position_of(key: &CellKey, sequence: &Sequence, anchor: Anchor) -> Vec3 {
    let (origin, direction) = line_through(key, sequence, u32::from(anchor.line));
    origin + direction * ((f32::from(anchor.depth) + 0.5) / DEPTH_STEPS * key.length())
}

/// Points of the surfaces in a cell that face its side, found along lines through the cube.
fn points_in(
    tracer: &Tracer,
    key: &CellKey,
    sequence: &Sequence,
) -> ArrayVec<(SurfacePoint, Anchor), POINTS> {
    let (axis, sign) = key.facing();
    let mut points = ArrayVec::new();
    for line in 0..POINTS as u32 {
        let (start, direction) = line_through(key, sequence, line);
        let (mut origin, end) = (start, start[axis] - sign * key.length());
        for _ in 0..MAX_LAYERS {
            let t_max = (end - origin[axis]) * -sign;
            let ray = Ray { t_max, ..Ray::new(origin, direction) };
            let Some(hit) = tracer.closest(&ray).filter(|_| t_max > 0.0 && !points.is_full()) else { break };
            let point = tracer.surface(&ray, &hit);
            origin = point.origin_behind();
            if key.faces_like(point.geometric_normal) && !point.is_black(tracer.scene()) {
                let depth = (start[axis] - point.position[axis]) * sign / key.length() * DEPTH_STEPS;
                let depth = depth.clamp(0.0, DEPTH_STEPS - 1.0) as u16;
                points.push((point, Anchor { line: line as u16, depth }));
            }
        }
    }
    points
}

/// True where two points of a cell see each other from a little above its surfaces.
fn sees(tracer: &Tracer, key: &CellKey, from: Vec3, to: Vec3) -> bool {
    let (axis, sign) = key.facing();
    let mut lift = Vec3::ZERO;
    lift[axis] = sign * key.length() * LIFT;
    let ray = Ray { t_max: 1.0, ..Ray::new(from + lift, to - from) };
    tracer.transmittance(&ray, &mut Occluder::default()) != Vec3::ZERO
}

/// True where the light of a cell with this anchor is that of a point in it: nothing stands between
/// the two.
pub(super) fn serves(tracer: &Tracer, key: &CellKey, seed: u64, anchor: Anchor, point: Vec3) -> bool {
    sees(tracer, key, point, position_of(key, &sequence_of(key, seed), anchor))
}
