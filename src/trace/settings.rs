//! The settings that decide the noise of a picture.

/// How many rays a pixel takes, and the seed of its random numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TraceSettings {
    /// Shadow rays per light and pixel.
    pub samples: u32,
    /// Diffuse bounces; 0 is direct light only.
    pub bounces: u32,
    /// Seed of all random numbers.
    pub seed: u64,
}

/// Noise of light from diffuse bounces (one path per sample) over that of direct light (one shadow
/// ray per sample). With 3, half of the pixels of a sunlit room were taken for shadow edges.
const BOUNCE_NOISE: f32 = 8.0;

impl TraceSettings {
    /// Shadow rays per light for a surface that covers only a share (0..1) of the pixel; at least
    /// one.
    pub fn samples_for(&self, share: f32) -> u32 {
        ((self.samples as f32 * share).ceil() as u32).clamp(1, self.samples.max(1))
    }

    /// Noise of the light, relative to sixteen shadow rays and no bounce; at least 1.
    ///
    /// A threshold that separates signal from noise at that sample count is multiplied by this.
    pub(crate) fn noise(&self) -> f32 {
        let of_bounces = if self.bounces > 0 { BOUNCE_NOISE } else { 1.0 };
        (of_bounces * (16.0 / self.samples.max(1) as f32).sqrt()).max(1.0)
    }
}

impl Default for TraceSettings {
    fn default() -> Self {
        Self { samples: 16, bounces: 0, seed: 0 }
    }
}
