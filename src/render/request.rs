//! What one frame is rendered from.

use super::settings::{Mode, RenderSettings};
use crate::camera::{Camera, View};
use crate::lookup::{LookupQuality, LookupSet, PixelResolver, PointCache};
use crate::reference::{ReferenceCache, ReferenceFrame, directory::PackedNormal};
use crate::trace::{
    Tracer,
    parallel::{NEVER, Stop},
};
use std::borrow::Cow;

/// The references that a frame may reuse.
#[derive(Clone, Copy, Debug, Default)]
pub enum References<'a> {
    /// No references: every pixel is traced in full.
    #[default]
    None,
    /// Frames that mode `paper` warps, in the order of [`super::Frame::supplier`]. All of them must
    /// belong to the tracer's epoch. Other modes ignore them.
    Warped(&'a [&'a ReferenceFrame]),
    /// The enabled references of a cache: modes `fast` and `exact` look light up in them, and mode
    /// `paper` warps those that store light for every pixel. Mode `full` ignores them.
    Cached(&'a ReferenceCache),
}

/// All that a frame is rendered from.
#[derive(Clone, Copy)]
pub struct FrameRequest<'a> {
    /// The scene, ready to be traced.
    pub tracer: &'a Tracer,
    /// The pose.
    pub camera: &'a Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Mode, sample count, bounces and seed.
    pub settings: &'a RenderSettings,
    /// What may be reused.
    pub references: References<'a>,
    /// The point of each pixel that is sampled, in pixels from its centre.
    pub offset: [f64; 2],
    /// Asked before each pixel whether to stop early.
    pub stop: Stop<'a>,
}

impl<'a> FrameRequest<'a> {
    /// A request that reuses nothing and never stops early.
    pub fn new(tracer: &'a Tracer, camera: &'a Camera, size: [u32; 2], settings: &'a RenderSettings) -> Self {
        Self { tracer, camera, size, settings, references: References::None, offset: [0.0; 2], stop: NEVER }
    }

    /// The same request with frames that mode `paper` warps.
    #[must_use]
    pub fn warping(self, frames: &'a [&'a ReferenceFrame]) -> Self {
        Self { references: References::Warped(frames), ..self }
    }

    /// The same request with the references of a cache.
    #[must_use]
    pub fn reusing(self, cache: &'a ReferenceCache) -> Self {
        Self { references: References::Cached(cache), ..self }
    }

    /// The same request for another point of each pixel, in pixels from its centre.
    #[must_use]
    pub fn shifted(self, offset: [f64; 2]) -> Self {
        Self { offset, ..self }
    }

    /// The view of the request.
    pub(super) fn view(&self) -> View {
        let view = View::new(self.camera, &self.tracer.scene().frame, self.size);
        if self.offset == [0.0; 2] { view } else { view.shifted(self.offset) }
    }

    /// The same request with another stop condition.
    #[must_use]
    pub fn with_stop(self, stop: Stop<'a>) -> Self {
        Self { stop, ..self }
    }

    /// The part of the references that the mode reuses.
    ///
    /// # Panics
    /// Where a reference to be warped belongs to another epoch.
    pub(super) fn source(&self) -> Source<'a> {
        let (mode, epoch) = (self.settings.mode, self.tracer.epoch());
        match (mode.lookup_quality(), self.references) {
            (Some(quality), References::Cached(cache)) => {
                Source::LookUp(LookupSet::new(cache, epoch), quality)
            }
            (None, References::Cached(cache)) if mode == Mode::Paper => {
                let entries = cache.entries().iter();
                let usable = entries.filter(|entry| entry.is_usable(epoch) && entry.frame.is_dense());
                Source::Warp(usable.map(|entry| &*entry.frame).collect())
            }
            (None, References::Warped(frames)) if mode == Mode::Paper => {
                assert!(frames.iter().all(|f| f.epoch == epoch), "a reference of another epoch");
                Source::Warp(Cow::Borrowed(frames))
            }
            _ => Source::Warp(Cow::Borrowed(&[])),
        }
    }
}

/// What a frame reuses: references to look up light in, or frames to warp.
pub(super) enum Source<'a> {
    /// References to look light up in.
    LookUp(LookupSet<'a>, LookupQuality),
    /// Frames to warp; none where every pixel is traced in full.
    Warp(Cow<'a, [&'a ReferenceFrame]>),
}

impl Source<'_> {
    /// The frames to warp.
    pub(super) fn warped(&self) -> &[&ReferenceFrame] {
        match self {
            Self::LookUp(..) => &[],
            Self::Warp(frames) => frames,
        }
    }

    /// Packed normal of each triangle, where light is looked up.
    pub(super) fn normals(&self) -> &[PackedNormal] {
        match self {
            Self::LookUp(lookup, _) => lookup.normals(),
            Self::Warp(_) => &[],
        }
    }

    /// What completes the pixels that a look-up leaves open; `None` where frames are warped.
    pub(super) fn resolver<'s>(
        &'s self,
        request: &FrameRequest<'s>,
        view: &'s View,
        points: &'s PointCache,
    ) -> Option<PixelResolver<'s>> {
        let (Self::LookUp(lookup, quality), trace) = (self, request.settings.trace) else { return None };
        Some(PixelResolver { tracer: request.tracer, lookup, view, points, trace, quality: *quality })
    }
}
