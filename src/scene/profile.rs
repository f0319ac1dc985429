//! How the light of a lamp depends on direction, as measured: photometric profiles.

use glam::Vec3;
use std::f32::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

/// The two angles by which a profile names directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProfileAngles {
    /// Type C: the angle from the aim, and the one around it. Most lamps of buildings.
    AroundAim,
    /// Type B: the height over the axis to the side, and the angle around that axis. Floodlights.
    AroundSide,
    /// Type A: the height over the plane of the axis to the side, and the angle within it.
    /// Headlights.
    AroundUp,
}

/// Intensities of a lamp on a grid of directions, relative to the largest.
#[derive(Clone, Debug, PartialEq)]
pub struct LightProfile {
    /// The pair of angles that names a direction, as in types A, B and C of LM-63.
    angles: ProfileAngles,
    /// Radians, ascending: 0 to 2 pi around the aim, -pi/2 to pi/2 else.
    horizontal: Vec<f32>,
    /// Radians, ascending: 0 to pi from the aim, -pi/2 to pi/2 else.
    vertical: Vec<f32>,
    /// Shares (0..1) of the largest intensity, by horizontal, then by vertical angle.
    shares: Vec<f32>,
    /// Integral of the share over all directions, in steradians.
    flux: f32,
}

/// A profile with the orientation of the lamp that it belongs to.
#[derive(Clone, Debug, PartialEq)]
pub struct AimedProfile {
    profile: Arc<LightProfile>,
    /// Unit vector to where both angles are zero.
    aim: Vec3,
    /// Unit vector across, towards which the vertical angle grows where the other is zero.
    front: Vec3,
}

/// A lamp with a profile: position in world metres, and its largest intensity in radiance times
/// square metres.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileLight {
    /// Position, world metres.
    pub position_m: glam::DVec3,
    /// Largest intensity.
    pub intensity: Vec3,
    /// Share of the largest intensity in each direction around the lamp.
    pub profile: AimedProfile,
}

impl LightProfile {
    /// Takes angles in degrees, ascending, and intensities in any unit by horizontal, then by
    /// vertical angle, none negative and not all zero. Returns the profile and the largest
    /// intensity; `None` where the numbers do not fit.
    pub fn new(
        angles: ProfileAngles,
        [horizontal, vertical]: [&[f64]; 2],
        intensities: &[f64],
    ) -> Option<(Self, f64)> {
        let rises = |list: &[f64]| !list.is_empty() && list.windows(2).all(|pair| pair[0] < pair[1]);
        let most = intensities.iter().copied().fold(0.0, f64::max);
        let fits = horizontal.len().checked_mul(vertical.len()) == Some(intensities.len());
        let is_valid = fits && rises(horizontal) && rises(vertical) && most > 0.0 && most.is_finite();
        let radians = |list: &[f64]| list.iter().map(|a| a.to_radians() as f32).collect();
        is_valid.then(|| {
            let shares = intensities.iter().map(|i| (i / most).clamp(0.0, 1.0) as f32).collect();
            let (horizontal, vertical) = (radians(horizontal), radians(vertical));
            let mut profile = Self { angles, horizontal, vertical, shares, flux: 0.0 };
            profile.flux = profile.integral();
            (profile, most)
        })
    }

    /// Returns the share (0..1) of the largest intensity in a direction, by its parts along the
    /// front, the side and the aim; their squares add up to one. It is zero outside the angles that
    /// were measured.
    fn share(&self, [front, side, aim]: [f32; 3]) -> f32 {
        let height = |part: f32| part.clamp(-1.0, 1.0).asin();
        let [horizontal, vertical] = match self.angles {
            ProfileAngles::AroundAim => {
                let turn = side.atan2(front);
                let turn = if turn < 0.0 { turn + TAU } else { turn };
                [turn, front.hypot(side).atan2(aim)]
            }
            // Horizontal angles of these run clockwise.
            ProfileAngles::AroundSide => [height(-side), front.atan2(aim)],
            ProfileAngles::AroundUp => [(-side).atan2(aim), height(front)],
        };
        let (Some(h), Some(v)) = (place(&self.horizontal, horizontal), place(&self.vertical, vertical))
        else {
            return 0.0;
        };
        let columns = self.vertical.len();
        let along = |row: usize| {
            let [a, b] = [0, 1].map(|k| self.shares[row * columns + (v.0 + k).min(columns - 1)]);
            a + (b - a) * v.1
        };
        let [a, b] = [along(h.0), along((h.0 + 1).min(self.horizontal.len() - 1))];
        a + (b - a) * h.1
    }

    /// Returns the integral of the share over all directions: luminous flux over largest intensity,
    /// in steradians.
    pub fn flux(&self) -> f32 {
        self.flux
    }

    fn integral(&self) -> f32 {
        /// Number of directions around the aim and from it: enough for an error of a thousandth on
        /// a grid of degrees.
        const STEPS: u32 = 256;
        let mut sum = 0.0f64;
        for row in 0..STEPS {
            // Rings of equal area.
            let aim = 1.0 - (2.0 * row as f32 + 1.0) / STEPS as f32;
            let around = (1.0 - aim * aim).max(0.0).sqrt();
            for column in 0..STEPS {
                let turn = (column as f32 + 0.5) / STEPS as f32 * TAU;
                sum += f64::from(self.share([around * turn.cos(), around * turn.sin(), aim]));
            }
        }
        (sum / f64::from(STEPS * STEPS)) as f32 * 4.0 * PI
    }

    /// All numbers of the profile, for hashes.
    pub(crate) fn numbers(&self) -> impl Iterator<Item = f32> + '_ {
        self.horizontal.iter().chain(&self.vertical).chain(&self.shares).copied()
    }

    /// Number that stands for the kind of angles.
    pub(crate) fn code(&self) -> u32 {
        match self.angles {
            ProfileAngles::AroundAim => 1,
            ProfileAngles::AroundSide => 2,
            ProfileAngles::AroundUp => 3,
        }
    }
}

/// Returns the last of ascending angles that is not above an angle, and the share (0..1) of the way
/// to the next one; `None` outside them. One angle stands for all.
fn place(angles: &[f32], angle: f32) -> Option<(usize, f32)> {
    /// Angles by which a direction may lie outside by rounding.
    const SLACK: f32 = PI / (1 << 20) as f32;
    let (first, last) = (*angles.first()?, *angles.last()?);
    if angles.len() == 1 {
        return Some((0, 0.0));
    }
    if !(first - SLACK..=last + SLACK).contains(&angle) {
        return None;
    }
    let below = angles.partition_point(|a| *a <= angle).clamp(1, angles.len() - 1) - 1;
    let width = angles[below + 1] - angles[below];
    Some((below, ((angle - angles[below]) / width.max(f32::MIN_POSITIVE)).clamp(0.0, 1.0)))
}

impl AimedProfile {
    /// Orients a profile by the direction of its aim and one roughly to the front, of any length.
    /// Where the front is along the aim, any direction across serves.
    pub fn new(profile: Arc<LightProfile>, aim: Vec3, front: Vec3) -> Self {
        let aim = aim.normalize_or(Vec3::NEG_Y);
        let across = |v: Vec3| (v - aim * aim.dot(v)).try_normalize();
        let front = across(front).unwrap_or_else(|| aim.any_orthonormal_vector());
        Self { profile, aim, front }
    }

    /// The profile.
    pub fn profile(&self) -> &LightProfile {
        &self.profile
    }

    /// Unit vectors to the aim and to the front.
    pub fn axes(&self) -> [Vec3; 2] {
        [self.aim, self.front]
    }

    /// Returns the share (0..1) of the largest intensity towards a direction (any length).
    pub fn share(&self, towards: Vec3) -> f32 {
        let d = towards.normalize_or_zero();
        // Counter-clockwise, seen along the aim from behind.
        let side = self.front.cross(self.aim);
        self.profile.share([self.front.dot(d), side.dot(d), self.aim.dot(d)])
    }

    /// Cosine of the largest angle from the aim at which it may shine.
    pub(crate) fn cos_reach(&self) -> f32 {
        let profile = &self.profile;
        let last = profile.vertical.last().copied().unwrap_or(PI);
        match profile.angles {
            // One angle stands for all.
            ProfileAngles::AroundAim if profile.vertical.len() > 1 && last <= FRAC_PI_2 => last.cos(),
            _ => -1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn aimed(angles: ProfileAngles, grid: [&[f64]; 2], intensities: &[f64]) -> AimedProfile {
        let (profile, _) = LightProfile::new(angles, grid, intensities).unwrap();
        AimedProfile::new(Arc::new(profile), Vec3::NEG_Z, Vec3::X)
    }

    #[test]
    fn an_even_profile_is_one_everywhere_and_its_flux_that_of_the_sphere() {
        let even = aimed(ProfileAngles::AroundAim, [&[0.0, 360.0], &[0.0, 45.0, 180.0]], &[7.0; 6]);
        for i in 0..1000 {
            let key = crate::math::key::Key::of_pixel(1, i);
            let ([x, y], [z, _]) = (key.pair(), key.with(1).pair());
            assert_eq!(even.share(Vec3::new(x, y, z) - 0.5), 1.0);
        }
        assert!((even.profile().flux() / (4.0 * PI) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn angles_are_those_of_the_standard() {
        // Around the aim, which is -Z: the first plane is towards +X, and a quarter turn is +Y.
        let shares = [0.0, 1.0, 0.0, 0.5, 0.0, 0.2, 0.0, 0.1, 0.0, 1.0];
        let turned =
            aimed(ProfileAngles::AroundAim, [&[0.0, 90.0, 180.0, 270.0, 360.0], &[0.0, 90.0]], &shares);
        for (towards, expected) in
            [(Vec3::X, 1.0), (Vec3::Y, 0.5), (Vec3::NEG_X, 0.2), (Vec3::NEG_Y, 0.1), (Vec3::NEG_Z, 0.0)]
        {
            assert!((turned.share(towards) - expected).abs() < 1e-6, "{towards}: {}", turned.share(towards));
        }
        assert_eq!(turned.share(Vec3::Z), 0.0);
        // Floodlights: 30 degrees up is towards the front, 30 degrees to the side is clockwise.
        for angles in [ProfileAngles::AroundSide, ProfileAngles::AroundUp] {
            let flood = aimed(
                angles,
                [&[-30.0, 0.0, 30.0], &[-30.0, 0.0, 30.0]],
                &[0.0, 0.0, 0.0, 0.0, 1.0, 0.5, 0.0, 0.25, 0.0],
            );
            let (sin, cos) = 30f32.to_radians().sin_cos();
            let close = |towards: Vec3, expected: f32| (flood.share(towards) - expected).abs() < 1e-5;
            assert!(close(Vec3::NEG_Z, 1.0) && close(Vec3::new(sin, 0.0, -cos), 0.5));
            assert!(close(Vec3::new(0.0, -sin, -cos), 0.25) && close(Vec3::new(0.0, sin, -cos), 0.0));
            assert!(close(Vec3::Z, 0.0) && close(Vec3::X, 0.0));
        }
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let of = |grid: [&[f64]; 2], intensities: &[f64]| {
            LightProfile::new(ProfileAngles::AroundAim, grid, intensities).is_some()
        };
        assert!(of([&[0.0], &[0.0, 90.0]], &[1.0, 0.0]));
        assert!(!of([&[0.0], &[0.0, 90.0]], &[1.0]) && !of([&[], &[]], &[]));
        assert!(!of([&[0.0], &[90.0, 0.0]], &[1.0, 1.0]) && !of([&[0.0], &[0.0]], &[0.0]));
        assert!(!of([&[0.0], &[0.0]], &[f64::INFINITY]) && !of([&[0.0], &[f64::NAN, 1.0]], &[1.0; 2]));
    }
}
