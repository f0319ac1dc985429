//! Estimates of the light of single lamps at a point, many at a time.
//!
//! Numbers of lamps lie in arrays, and each step is a plain operation on all lamps of a few, so the
//! compiler makes vectors of them; nothing is fused, so every width has the same bits.

use super::emission::Emission;
use crate::scene::Light;
use glam::Vec3;

/// Number of lamps that are estimated together.
const LANES: usize = 8;

/// Least factor of a flat lamp seen from its side, whose cosine there is zero.
const FROM_THE_SIDE: f32 = 1.0 / 64.0;

/// Part of the light of a lamp that may lie partly below the horizon while its middle does.
const BELOW_HORIZON: f32 = 1.0 / 8.0;

/// Lamps in the order of a tree.
#[derive(Debug, Default)]
pub(super) struct LampArrays {
    /// Blocks of lamps; the last one is filled up with lamps without power.
    blocks: Vec<Block>,
}

/// A few lamps: spheres around them, their power, and how it depends on the cosine between their
/// axis and the way to the point: `slope * cos + base`, at least `least` and at most one.
#[derive(Clone, Debug)]
struct Block {
    centre: [[f32; LANES]; 3],
    axis: [[f32; LANES]; 3],
    radius: [f32; LANES],
    power: [f32; LANES],
    slope: [f32; LANES],
    base: [f32; LANES],
    least: [f32; LANES],
    /// 1 where the opposite of each direction counts as well, else 0.
    two_sides: [f32; LANES],
}

impl LampArrays {
    /// Appends a lamp in a sphere.
    pub(super) fn push(&mut self, at: usize, (centre, radius, power): (Vec3, f32, f32), light: &Light) {
        if at.is_multiple_of(LANES) {
            let [zero, one] = [[0.0; LANES], [1.0; LANES]];
            self.blocks.push(Block {
                centre: [zero; 3],
                axis: [zero; 3],
                radius: zero,
                power: zero,
                slope: zero,
                base: one,
                least: one,
                two_sides: zero,
            });
        }
        let (Some(block), lane) = (self.blocks.last_mut(), at % LANES) else { return };
        let emission = Emission::of(light);
        let [slope, base, least] = shape(light, &emission);
        for axis in 0..3 {
            block.centre[axis][lane] = centre[axis];
            block.axis[axis][lane] = emission.axis()[axis];
        }
        block.radius[lane] = radius;
        block.power[lane] = power;
        [block.slope[lane], block.base[lane], block.least[lane]] = [slope, base, least];
        block.two_sides[lane] = f32::from(u8::from(emission.has_two_sides()));
    }

    /// Estimates the irradiance that each of the lamps from place `first` to `end` brings to a
    /// surface point, times a factor, and appends it to `estimates`. It is zero only where there is
    /// none.
    pub(super) fn append(
        &self,
        [first, end]: [usize; 2],
        (position, normal): (Vec3, Vec3),
        factor: f32,
        estimates: &mut Vec<f32>,
    ) {
        for at in first / LANES..end.div_ceil(LANES) {
            let found = self.blocks[at].estimate(position, normal);
            let lanes = first.saturating_sub(at * LANES)..(end - at * LANES).min(LANES);
            estimates.extend(found[lanes].iter().map(|estimate| (estimate * factor).min(f32::MAX)));
        }
    }
}

/// Slope, base and least factor of a lamp's light by the cosine to its axis.
fn shape(light: &Light, emission: &Emission) -> [f32; 3] {
    match light {
        Light::Point { beam: Some(beam), profile: None, .. } => {
            /// Cosines by which rounding may leave out a lamp.
            const SLACK: f32 = 1.0 / 256.0;
            let slope = 1.0 / (beam.cos_inner - beam.cos_outer).max(SLACK);
            [slope, slope * (SLACK - beam.cos_outer), 0.0]
        }
        Light::Quad { .. } | Light::Triangles { .. } if emission.is_flat() => [1.0, 0.0, FROM_THE_SIDE],
        _ => [0.0, 1.0, 1.0],
    }
}

impl Block {
    #[inline(always)]
    fn estimate(&self, position: Vec3, normal: Vec3) -> [f32; LANES] {
        let mut estimates = [0.0; LANES];
        for (lane, estimate) in estimates.iter_mut().enumerate() {
            let [x, y, z] = [0, 1, 2].map(|axis| self.centre[axis][lane] - position[axis]);
            let distance2 = x * x + y * y + z * z;
            let radius = self.radius[lane];
            let bounded = distance2.max(radius * radius).max(f32::MIN_POSITIVE);
            let inverse = 1.0 / bounded.sqrt();
            // The cosine at the surface, of the middle or of a part that is above the horizon.
            let along_normal = x * normal.x + y * normal.y + z * normal.z;
            let received = along_normal.max(BELOW_HORIZON * (along_normal + radius)).max(0.0) * inverse;
            // The cosine at the lamp.
            let [ax, ay, az] = [0, 1, 2].map(|axis| self.axis[axis][lane]);
            let along_axis = -(x * ax + y * ay + z * az) * inverse;
            let other_side = -along_axis * self.two_sides[lane];
            let emitted = self.slope[lane] * along_axis.max(other_side) + self.base[lane];
            let emitted = emitted.max(self.least[lane]).min(1.0);
            *estimate = self.power[lane] * received * emitted * (inverse * inverse);
        }
        estimates
    }
}
