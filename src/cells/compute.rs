//! The light of one cell, a function of the scene and the key alone.

use super::key::CellKey;
use crate::bsdf::Diffuse;
use crate::math::{Ray, key::Key, sequence::Sequence};
use crate::trace::{LightKinds, RayCounts, SmoothSettings, SurfacePoint, Tracer};
use arrayvec::ArrayVec;
use glam::Vec3;

/// Points of a cell whose light is traced. Each takes one ray to every light and one path.
const POINTS: usize = 16;

/// Surfaces, one behind the other, that one line through a cell may find.
const MAX_LAYERS: usize = 4;

/// Height above the surface, in sides of the cell, at which points of a cell must see each other.
const LIFT: f32 = 1.0 / 16.0;

/// Dimensions of the sequence of a cell beyond those of its paths.
const PLACE: u32 = 3 << 26;
const LIGHT: u32 = 7 << 24;

/// What is known of a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Cell {
    /// All light that arrives at its surfaces, as the radiance of a white one.
    Lit(Vec3),
    /// Its surfaces do not see each other, as on both sides of a wall, or are too small to be found.
    Divided,
}

/// Bits of a mantissa of a packed cell, and its largest value.
const MANTISSA: u32 = 18;
const MAX_MANTISSA: f32 = ((1 << MANTISSA) - 1) as f32;

impl Cell {
    const DIVIDED: u64 = 1;

    /// Packs the cell into a word that is never zero: three mantissas of 18 bits, the exponent of
    /// the largest channel, and a bit that is set.
    pub(super) fn to_bits(self) -> u64 {
        let Self::Lit(light) = self else { return Self::DIVIDED };
        let exponent = (light.max_element().to_bits() >> 23).clamp(MANTISSA, 0xfe);
        // 2^(MANTISSA + 126 - exponent) in two factors, because it may be too large for one.
        let scale = |x: f32| x * power(126 - exponent as i32) * power(MANTISSA as i32);
        let mantissa = |x: f32| u64::from(scale(x).clamp(0.0, MAX_MANTISSA) as u32);
        let [r, g, b] = light.to_array().map(mantissa);
        1 << 63 | r | g << MANTISSA | b << (2 * MANTISSA) | u64::from(exponent) << (3 * MANTISSA)
    }

    pub(super) fn from_bits(bits: u64) -> Self {
        if bits >> 63 == 0 {
            return Self::Divided;
        }
        let exponent = (bits >> (3 * MANTISSA) & 0xff) as i32;
        let step = power(exponent - 126) * power(-(MANTISSA as i32));
        let channel = |i: u32| (bits >> (i * MANTISSA) & ((1 << MANTISSA) - 1)) as f32;
        Self::Lit(Vec3::new(channel(0), channel(1), channel(2)) * step)
    }
}

/// Two to the power of an exponent from -126 to 127.
fn power(exponent: i32) -> f32 {
    f32::from_bits(((exponent.clamp(-126, 127) + 127) as u32) << 23)
}

/// Traces the light of a cell, with up to `bounces` diffuse surfaces on the way.
pub(super) fn compute(tracer: &Tracer, key: &CellKey, bounces: u32, seed: u64) -> Cell {
    let sequence =
        Sequence::of_key(Key::of_pixel(seed, 0).with(key.hash() as u32).with((key.hash() >> 32) as u32));
    let points = points_in(tracer, key, &sequence);
    if points.is_empty() || !see_each_other(tracer, &points, key.length() * LIFT) {
        return Cell::Divided;
    }
    // Rays of cells are not counted: which thread traces them is left to chance.
    let mut rays = RayCounts::default();
    let mut sum = Vec3::ZERO;
    for sample in 0..POINTS as u32 {
        let point = &points[sample as usize % points.len()];
        let shift = |light: u32| sequence.pair(sample, LIGHT.wrapping_add(light));
        let irradiance = tracer.irradiance_of(LightKinds::AllButSky, point, 1, shift, &mut rays);
        let settings = SmoothSettings { bounces, cache: None, footprint: 0.0, samples: 1 };
        let smooth = tracer.smooth_light(point, sample..sample + 1, sequence, settings, &mut rays);
        sum += Diffuse::WHITE.radiance(irradiance) + smooth[0] + smooth[1];
    }
    let light = sum / POINTS as f32;
    if light.is_finite() { Cell::Lit(light) } else { Cell::Divided }
}

/// Points of the surfaces in a cell that face its side, found along lines through the cube.
fn points_in(tracer: &Tracer, key: &CellKey, sequence: &Sequence) -> ArrayVec<SurfacePoint, POINTS> {
    let (axis, sign) = key.facing();
    let (low, length) = (key.low(), key.length());
    let mut direction = Vec3::ZERO;
    direction[axis] = -sign;
    let mut points = ArrayVec::new();
    for line in 0..POINTS as u32 {
        let [u, v] = sequence.pair(line, PLACE);
        let mut origin = low;
        origin[(axis + 1) % 3] += u * length;
        origin[(axis + 2) % 3] += v * length;
        origin[axis] += if sign > 0.0 { length } else { 0.0 };
        let end = origin[axis] - sign * length;
        for _ in 0..MAX_LAYERS {
            let t_max = (end - origin[axis]) * -sign;
            let ray = Ray { t_max, ..Ray::new(origin, direction) };
            let Some(hit) = tracer.closest(&ray).filter(|_| t_max > 0.0 && !points.is_full()) else { break };
            let point = tracer.surface(&ray, &hit);
            origin = point.origin_behind();
            if key.faces_like(point.geometric_normal) && point.albedo(tracer.scene()) != Vec3::ZERO {
                points.push(point);
            }
        }
    }
    points
}

/// True where the first point sees all others from a little above the surface.
fn see_each_other(tracer: &Tracer, points: &[SurfacePoint], lift: f32) -> bool {
    let lifted = |point: &SurfacePoint| point.position + point.geometric_normal * lift;
    let from = lifted(&points[0]);
    let mut occluder = Default::default();
    points[1..].iter().all(|point| {
        let ray = Ray { t_max: 1.0, ..Ray::new(from, lifted(point) - from) };
        tracer.transmittance(&ray, &mut occluder) != Vec3::ZERO
    })
}
