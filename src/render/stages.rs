//! The stages of a picture at rest.

/// Passes of the full tracer until the picture counts as converged.
pub(super) const PASSES: u32 = 64;

/// A stage of the picture: a reference of the view, and what follows it.
#[derive(Debug)]
pub(super) struct Stage {
    /// Pixels of the picture, along an edge, per pixel of the reference.
    pub(super) edge: u32,
    /// Samples of the reference's pixels, as a multiple of those of a frame.
    pub(super) samples: u32,
    /// Points of each pixel through which looked-up frames are rendered.
    pub(super) frames: u32,
    /// Passes of the full tracer when the stage ends.
    pub(super) passes: u32,
}

/// The stages: light first, then edges, then what has no bias. Samples double, so that half of the
/// time of lighting shows in the picture after it.
pub(super) const STAGES: [Stage; 6] = [
    Stage { edge: 2, samples: 1, frames: 1, passes: 0 },
    Stage { edge: 1, samples: 1, frames: 4, passes: 0 },
    Stage { edge: 1, samples: 2, frames: 4, passes: 0 },
    Stage { edge: 1, samples: 4, frames: 16, passes: 0 },
    Stage { edge: 1, samples: 8, frames: 16, passes: 0 },
    Stage { edge: 1, samples: 16, frames: 16, passes: PASSES },
];

/// The stages where an earlier visit has come to the end of [`STAGES`]: the light of that visit
/// with smooth edges, and then the means of its samples and as many new ones.
pub(super) const STAGES_OF_RETURN: [Stage; 3] = [
    Stage { edge: 1, samples: 0, frames: 16, passes: 0 },
    Stage { edge: 1, samples: 8, frames: 16, passes: 0 },
    Stage { edge: 1, samples: 16, frames: 16, passes: PASSES },
];

/// The number of the reference of a view at rest, by which it gets random numbers of its own: those
/// of other references count from 1. `edge` is that of its stage. Samples that are added to
/// `earlier` ones differ from these.
pub(super) fn number_of_reference(edge: u32, earlier: u32) -> u64 {
    const FIRST: u64 = 1 << 15;
    FIRST + u64::from(edge) + (u64::from(earlier) << 3)
}
