//! Dimensions of the random numbers of one surface point. Its lights take their index in the scene.

/// First dimension of the surfaces met after a specular bounce: one per surface.
pub(super) const SPECULAR: u32 = 2 << 24;

/// Dimension of the sample of the viewer-dependent lobe.
pub(super) const LOBE: u32 = 3 << 24;

/// Dimension of the lights that a rough lobe scatters straight; each takes its index below that.
pub(super) const LOBE_LIGHT: u32 = 4 << 24;

/// First dimension of the samples of lights that are added later to those of a point: one per
/// light.
pub(super) const LATER: u32 = 1 << 26;

/// First dimension of the points of a [`Sequence`](crate::math::sequence::Sequence) that choose the
/// directions of a path: one per bounce.
pub(super) const DIRECTION: u32 = 0;

/// Dimension of the rays of a pixel's rough lobe.
pub(super) const LOBE_RAY: u32 = 1 << 27;

/// First dimension for Russian roulette, one per bounce.
pub(super) const ROULETTE: u32 = 1 << 24;

/// First dimension of the lights at the vertices of a path: one per bounce and light.
pub(super) const LIGHT: u32 = 1 << 25;
