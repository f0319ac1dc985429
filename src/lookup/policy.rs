//! Every threshold of the look-up, with its unit and the reason for its value.
//!
//! Thresholds that compare light are shares of the brightest channel for light of sixteen shadow
//! rays per sample; noisier references scale them by [`TraceSettings::noise`].

use crate::trace::TraceSettings;
use glam::Vec3;

/// How a mode trades noise for time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LookupQuality {
    /// References that a pixel is averaged over at most. Noise falls and time grows with it.
    pub max_averaged: usize,
    /// True where a guess is checked by tracing, false where it is shown as it is.
    pub checks_guesses: bool,
    /// The sample count of pixels that no reference knows is divided by this.
    pub unseen_sample_divisor: u32,
}

impl LookupQuality {
    /// Mode `exact`.
    pub const EXACT: Self = Self { max_averaged: 2, checks_guesses: true, unseen_sample_divisor: 1 };

    /// Mode `fast`: pixels that no reference knows are noisy until the next reference covers them.
    pub const FAST: Self = Self { max_averaged: 1, checks_guesses: false, unseen_sample_divisor: 4 };

    /// The settings that pixels unknown to all references are shaded with.
    pub fn unseen_trace(self, trace: &TraceSettings) -> TraceSettings {
        TraceSettings { samples: (trace.samples / self.unseen_sample_divisor).max(1), ..*trace }
    }
}

// Which samples of a reference belong to the surface of a point.

/// A sample lies on the surface of a point where its distance to the point's plane is below this
/// share of the distance between samples: a bend of six degrees from one sample to the next.
/// Relative to the sample distance, so it means the same at every depth, picture size and scale.
pub(super) const PLANE_TOLERANCE: f32 = 0.1;

/// Added to [`PLANE_TOLERANCE`], relative to depth: the rounding of a distance along a ray, about
/// 64 steps of an f32.
pub(super) const DEPTH_ROUNDING: f32 = 4e-6;

/// A reference knows the light of a point where the bilinear weights of the samples on its surface
/// sum to at least this, 0..1.
pub(super) const MIN_WEIGHT: f32 = 1.0 / 16.0;

/// A reference is not used where one of its samples covers more than this many pixels of the view.
pub(super) const MAX_MAGNIFICATION: f32 = 1024.0;

// When looked-up light is a guess.

/// Light is extrapolated where less than this share of bilinear weight was found: the nearest
/// samples lie beyond an edge, and a shadow along the edge is not known. On a view of fluted
/// columns, with all such pixels traced, 0.5 gave 40.9 dB with 3 % of the pixels traced, 0.65
/// 43.8 dB with 6 %, and 0.8 45.5 dB with 8 %.
pub(super) const MIN_COVERAGE: f32 = 0.8;

/// All samples around a point were found where bilinear weights sum to this, less than one by
/// rounding alone.
pub(super) const WHOLE_COVERAGE: f32 = 0.999;

/// Height above its surface at which a point must see a sample, as a share of their distance: more
/// than surfaces bend within [`PLANE_TOLERANCE`], less than the height of walls.
pub(super) const LIFT: f32 = 1.0 / 16.0;

/// Four samples fall into two groups, as on both sides of a shadow's edge, where one gap between
/// them is at least this share of their range. Four samples that differ only by noise have such a
/// gap once in eight times.
pub(super) const EDGE_GAP: f32 = 0.8;

/// Samples of sixteen shadow rays that differ by more than this share of the brightest lie on both
/// sides of a shadow's edge, however they are distributed.
pub(super) const MAX_NOISE_SPREAD: f32 = 0.5;

/// Light is a guess where the samples on both sides of a shadow's edge differ by more than this
/// share of the brightest.
pub(super) const MAX_JUMP: f32 = 0.25;

/// A reference does not know the smooth light of a point where the samples around it differ by more
/// than this share of the brightest: smooth light changes so fast only from one side of a wall to
/// the other.
pub(super) const MAX_SMOOTH_SPREAD: f32 = 0.5;

/// Light is a guess where interpolation smooths away more than this share of the brightest sample.
pub(super) const MAX_LOSS: f32 = 0.12;

/// A sparse reference traces a pixel's light again where interpolation smooths away more than this
/// share: an error that light of sixteen shadow rays has as well.
pub(super) const MAX_SMOOTHED: f32 = 0.08;

/// Light is not traced between two pixels that differ by less than this share of the brighter.
/// On six frames of the gallery's walk at 640x360, these three thresholds left 46 % of the shadow
/// rays of references, and changed PSNRs by -1.0 (at 51 dB, above mode `full`) to +0.4 dB. A range
/// of 0.25 and a bend of 0.06 left 35 %, and took 1.7 dB from one frame.
pub(super) const MAX_BETWEEN: f32 = 0.06;

/// The same for the range of four pixels, in two pairs that are opposite ...
pub(super) const MAX_RANGE_BETWEEN: f32 = 0.12;

/// ... whose means differ by less than this share: light that varies evenly needs no rays.
pub(super) const MAX_BEND_BETWEEN: f32 = 0.04;

// How many references are read.

/// A planned reference leaves a surface to an earlier one that has at least this share of its
/// samples there, inverted: half as many per axis. The store takes the same value for how fine a
/// stored reference has to be.
pub(super) const COMPARABLE: f32 = 4.0;

/// References averaged, at most, for a point seen in a mirror or through glass. More would cost
/// more time than the noise that they remove is worth.
pub(super) const MAX_AVERAGED_REFERENCES: usize = 3;

/// References averaged, at most, for such a point while all references found so far are coarser
/// than the picture.
pub(super) const MAX_FOUND: usize = 8;

/// References chosen for one group of pixels of a tile, at most.
pub(super) const MAX_AVERAGED_BEST: usize = 4;

/// Times that a tile chooses references, each time for a pixel that the earlier choices do not
/// cover. Pixels still unknown then read every reference of their cell.
pub(super) const MAX_ROUNDS: usize = 4;

/// One tile in this many per axis is examined where a view is only estimated: 900 tiles of
/// 1280x720.
pub(super) const ESTIMATE_STEP: usize = 4;

// Rows interpolated in tiles that show one plane.

/// Pixels show one plane where normals differ by less than this, and distances to the plane by less
/// than this share: the rounding of points seen at a grazing angle.
pub(super) const ONE_PLANE: f32 = 1e-4;

/// A row is interpolated where the light above and below differs by less than this share: less
/// than the noise of sixteen shadow rays. On two views of the gallery it reduced the error of
/// reused pixels by 0.4 and 0.7 dB, and the pictures of the error show no rows.
pub(super) const MAX_STEP: f32 = 1.0 / 32.0;

// Checking a guess.

/// A guess is replaced where it differs from the traced light by more than this share of the
/// brighter of the two. Below it the look-up, a mean over references, has less noise than sixteen
/// rays. 0.15, 0.1 and 0.06 gave ever less error on a frame of the gallery's walk that has little
/// noise; with 0.06 noisy frames stay below the error of the full tracer.
pub(super) const BAD_GUESS: f32 = 0.06;

/// True where a guess differs from traced light by more than `most` times [`BAD_GUESS`] for light
/// of this noise.
pub(super) fn is_bad_guess(guess: Vec3, traced: Vec3, most: f32, noise: f32) -> bool {
    (traced - guess).abs().max_element() > most * BAD_GUESS * noise * traced.max(guess).max_element()
}

/// Light traced within this many footprints of a point may confirm a guess there, where no shadow's
/// edge is near. In 200 frames of the gallery's walk, with one footprint 3.5 % of the pixels are
/// checked by rays, with two 2.7 %, with four 2.5 %; with two, PSNR changes by -0.5 to +0.2 dB and
/// stays 0.1 to 3.6 dB above mode `full` in ten frames.
pub(super) const CONFIRMED_WITHIN: f32 = 2.0;

/// Where traced direct light is below this share of the guess, the samples that the guess came from
/// lie on the other side of an edge, and their smooth light is not used either.
pub(super) const OTHER_SIDE: f32 = 0.1;

/// A point keeps showing what it showed when it was traced, the guess or the traced light, until
/// the guess is off by this factor more, or less, than [`BAD_GUESS`]. References come and go and
/// guesses change with them; with a single threshold the colour would alternate.
pub(super) const HYSTERESIS: f32 = 1.5;

/// Points that the mirrors and glass of one pixel store per frame at most, so that memory is
/// bounded. The next frame finds these and stores the following ones.
pub(crate) const MAX_POINTS_PER_PIXEL: usize = 4;

// The cache of traced points.

/// Buckets of the point cache. A bucket is the place of a cell in the hash table. It holds [`WAYS`]
/// points, of that cell and of others that share the bucket. All buckets take 64 MB, allocated when
/// the first point is inserted. A picture of 1280x720 of which a third shows a mirror fills a sixth
/// of them.
pub(super) const BUCKETS: usize = 1 << 19;

/// Points in a bucket. A new point replaces the oldest.
pub(super) const WAYS: usize = 4;

/// Cells along each side of a block, a power of two. A block is a cube of cells whose buckets are
/// adjacent in memory, because neighbouring cells are read one after the other, and a cache miss
/// takes about a fifth of a microsecond.
pub(super) const BLOCK: usize = 4;

/// Buckets of a block, one for each of its cells.
pub(super) const BLOCK_BUCKETS: usize = BLOCK * BLOCK * BLOCK;

/// Cell sizes that are read, from the size of the footprint down, so that points traced from
/// nearby are found from afar.
pub(super) const LEVELS_READ: i32 = 2;

/// Exponents of the smallest and largest cells: 2^-12 scene units, four steps of an f32 at the
/// scene's border, and the size of the scene.
pub(super) const LEVELS: [i32; 2] = [-12, 10];

/// A point's light is reused at points whose distance to its plane is below this share of the cell.
pub(super) const PLANE_SHARE: f32 = 0.25;

/// Light of neighbouring cells that differs by more than this share of the brighter is separated
/// by the edge of a shadow. Two points of sixteen shadow rays each differ this much by noise alone
/// so rarely that the only cost is that a few more points are traced.
pub(super) const CELL_EDGE: f32 = 0.5;

/// Moves the borders of cells, in cells, off the round coordinates that walls tend to have, where
/// rounding would decide the cell.
pub(super) const BORDER: Vec3 = Vec3::new(0.371, 0.619, 0.453);
