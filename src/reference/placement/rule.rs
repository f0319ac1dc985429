//! Data type of a placement rule, and the input that a rule decides by.

use crate::camera::Camera;
use crate::trace::Tracer;
use glam::Vec2;

/// A rule that places references, as data. Its decision depends on the [`Situation`] alone.
#[derive(Clone, Copy, Debug)]
pub struct PlacementRule {
    /// Name on the command line and in records.
    pub name: &'static str,
    /// Description in a few words, shown next to the name.
    pub about: &'static str,
    /// True if the rule uses the percentage of its policy.
    pub has_threshold: bool,
    /// Returns poses whose references are traced before the first frame, once per scene state. Most
    /// rules have none: [`PlacementRule::no_prefetch`].
    pub prefetch_poses: fn(&Tracer, &PrefetchRequest) -> Vec<Camera>,
    /// Returns the pose at which a new reference should be traced after a frame, if any.
    pub decide: fn(&mut Situation<'_>) -> Option<Camera>,
    /// Returns true if a frame that had to light `lit_percent` of its pixels is kept as a sparse
    /// reference. `percent` is the policy's threshold.
    pub keeps_frame: fn(lit_percent: f64, percent: f64) -> bool,
}

/// Facts about the last frame.
#[derive(Clone, Copy, Debug)]
pub struct Observation {
    /// Camera of the frame.
    pub camera: Camera,
    /// Camera of the frame before, or the same camera if there was none.
    pub previous: Camera,
    /// Pixels, in percent, that a reference at this pose would have to light: all of Type 3 where
    /// references light every pixel, and only those known to no reference where references are
    /// sparse.
    pub open_percent: f64,
    /// True if references light only pixels whose light older references do not hold.
    pub is_sparse: bool,
    /// True if the frame was stopped before it was complete; its light is then not kept as a
    /// reference.
    pub was_cut: bool,
    /// Number of references in the cache.
    pub held: usize,
}

/// A part of a picture that no reference covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OpenSpot {
    /// Centre of the part, pixels from the top left corner.
    pub point: Vec2,
    /// Open area of the part, in percent of the picture.
    pub percent: f64,
}

/// Predicts which percentage of the pixels is open at a pose, given the references in the cache.
/// Appends the open parts of the picture to the list, if one is passed.
pub type OpenPrediction<'a> = &'a mut dyn FnMut(&Camera, Option<&mut Vec<OpenSpot>>) -> f64;

/// Everything a rule may decide by.
pub struct Situation<'a> {
    /// Facts about the last frame.
    pub seen: &'a Observation,
    /// Threshold of the policy, percent of the pixels.
    pub percent: f64,
    /// Width and height of the pictures in pixels.
    pub size: [u32; 2],
    /// Tracer of the scene, for visibility queries.
    pub tracer: &'a Tracer,
    /// Prediction of the open pixels at any pose.
    pub predict_open: OpenPrediction<'a>,
}

/// Limits for references that are traced before the first frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrefetchRequest {
    /// Width and height of the references in pixels.
    pub size: [u32; 2],
    /// Vertical field of view in radians.
    pub fov_y: f64,
    /// Maximum number of references.
    pub max_references: usize,
}

impl PlacementRule {
    /// Returns no poses, for rules that trace nothing before the first frame.
    pub fn no_prefetch(_: &Tracer, _: &PrefetchRequest) -> Vec<Camera> {
        Vec::new()
    }
}

/// Minimum open pixels, in percent, for a dense reference while the viewer moves, whatever the
/// threshold: such a reference costs as much as tracing a whole frame. On the gallery's walk this
/// gives 71 references with 5.7 % Type 3 in the median, against 102 with 4.0 % where 5 % open ahead
/// suffice.
const MIN_OPEN_PERCENT_MOVING: f64 = 20.0;

/// Minimum open pixels, in percent, for a sparse reference. It costs little more than the pixels it
/// lights, and those would otherwise be shaded in frame after frame.
pub(super) const MIN_OPEN_PERCENT_SPARSE: f64 = 1.0;

impl Observation {
    /// Returns true if the viewer has not moved.
    pub fn is_still(&self) -> bool {
        self.camera == self.previous
    }

    /// Returns the percentage of open pixels above which a reference is worth its cost.
    pub(super) fn worthwhile_percent(&self, percent: f64) -> f64 {
        match (self.is_sparse, self.is_still() || self.held == 0) {
            (true, _) => MIN_OPEN_PERCENT_SPARSE.min(percent),
            (false, true) => percent,
            (false, false) => percent.max(MIN_OPEN_PERCENT_MOVING),
        }
    }
}

impl Situation<'_> {
    /// Returns true if the last frame had few enough open pixels that a dense reference is not
    /// considered.
    pub(super) fn is_covered(&self) -> bool {
        !self.seen.is_sparse && self.seen.open_percent <= self.percent
    }

    /// Returns true if a sparse reference is needed at the present pose: the last frame was stopped
    /// with open pixels, and the next frames would be stopped in the same way.
    pub(super) fn needs_reference_here(&self) -> bool {
        let seen = self.seen;
        seen.is_sparse && seen.was_cut && seen.open_percent > seen.worthwhile_percent(self.percent)
    }
}
