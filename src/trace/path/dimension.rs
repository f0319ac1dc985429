//! Dimensions of the random numbers of one surface point. Its lights take their index in the scene.

/// First dimension of diffuse bounces: one per path and one per bounce.
pub(super) const INDIRECT: u32 = 1 << 24;

/// First dimension of the surfaces met after a specular bounce: one per surface.
pub(super) const SPECULAR: u32 = 2 << 24;

/// Dimension of the sample of the viewer-dependent lobe.
pub(super) const LOBE: u32 = 3 << 24;
