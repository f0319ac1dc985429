//! Finished frames, passed from the render thread to the window without waiting or allocating.

use super::{FrameValues, Quantity, locked, pack};
use crate::window::rendering::depth_ranges::DepthRanges;
use afterimage::Camera;
use afterimage::camera::SceneFrame;
use afterimage::cells::SurfaceCells;
use afterimage::reference::{ReferenceCache, ReferenceId};
use afterimage::render::frame::{Frame, FrameStats, NO_SUPPLIER};
use afterimage::scene::Scene;
use rayon::prelude::*;
use std::sync::Mutex;
use std::time::Instant;

/// Supplier byte of a pixel that was not supplied by a reference.
pub const SUPPLIED_BY_NONE: u8 = u8::MAX;

/// A reference, as the window lists it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceInfo {
    /// Identity of the reference in the cache.
    pub id: ReferenceId,
    /// Pose at which the reference was traced.
    pub camera: Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Share of recent frames' pixels that it supplied, 0..1.
    pub contribution: f32,
    /// True where the last frame used it.
    pub is_used: bool,
    /// False where the user has disabled it.
    pub is_enabled: bool,
    /// Time at which it was added.
    pub added: Instant,
}

/// A frame, as the window shows it.
#[derive(Debug)]
pub struct PublishedFrame {
    /// Generation of the request it was begun with; a later frame never has a smaller one.
    pub generation: u64,
    /// Pose at which the frame was rendered.
    pub camera: Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Scene space, in which its disparities are given.
    pub scene_frame: SceneFrame,
    /// Disparity: 1 / depth along the viewing axis in scene units, of pixels and of squares of
    /// pixels.
    pub depth_ranges: DepthRanges,
    /// Linear radiance of the pixels, packed as in a texture of format `Rgb9e5Ufloat`; where the
    /// frame shows values, these, as [`FrameValues`] reads them.
    pub radiance: Vec<u32>,
    /// What the frame shows.
    pub values: FrameValues,
    /// Types of the pixels: numbers of [`afterimage::raster::pixel_types::PixelType`].
    pub types: Vec<u8>,
    /// Reference that supplied each pixel: its number modulo 255; [`SUPPLIED_BY_NONE`] for none.
    /// The number stays the same from frame to frame, unlike the place in the frame's list, so that
    /// a reference keeps its colour.
    pub suppliers: Vec<u8>,
    /// Times and counts of the frame.
    pub stats: FrameStats,
    /// True for a refined picture of the frame before it.
    pub is_refinement: bool,
    /// All references in the cache, oldest first.
    pub references: Vec<ReferenceInfo>,
    /// Memory that references use, and their limit, in bytes.
    pub cache_bytes: [usize; 2],
    /// Pixels of references whose light was traced, and of these the stale ones: the scene has
    /// changed so that their light no longer holds.
    pub traced_and_stale: [usize; 2],
    /// Memory of the cells in which paths of smooth light end, bytes.
    pub cell_bytes: usize,
    /// Time at which the frame, or the step that refined it, was begun.
    pub begun: Instant,
    /// Time at which it was finished.
    pub finished: Instant,
}

impl PublishedFrame {
    /// A frame without pixels, as a buffer to be filled.
    pub fn empty() -> Self {
        Self {
            generation: 0,
            camera: Frame::default().camera,
            size: [0, 0],
            scene_frame: SceneFrame { origin_in_world_m: glam::DVec3::ZERO, units_per_metre: 1.0 },
            depth_ranges: DepthRanges::default(),
            radiance: Vec::new(),
            values: FrameValues::default(),
            types: Vec::new(),
            suppliers: Vec::new(),
            stats: FrameStats::default(),
            is_refinement: false,
            references: Vec::new(),
            cache_bytes: [0, 0],
            traced_and_stale: [0, 0],
            cell_bytes: 0,
            begun: Instant::now(),
            finished: Instant::now(),
        }
    }

    /// Copies a rendered frame on the current thread pool, and keeps allocations.
    pub fn fill(
        &mut self,
        (frame, scene): (&Frame, &Scene),
        quantity: Quantity,
        used: &[ReferenceId],
        generation: u64,
    ) {
        (self.generation, self.is_refinement) = (generation, false);
        (self.camera, self.size, self.stats) = (frame.camera, frame.view.size, frame.stats);
        self.scene_frame = scene.frame;
        let supplier = |&slot: &u8| match used.get(slot as usize) {
            Some(id) if slot != NO_SUPPLIER => supplier_byte(*id),
            _ => SUPPLIED_BY_NONE,
        };
        let Self { depth_ranges, radiance, values, types, suppliers, size, .. } = self;
        rayon::join(
            || depth_ranges.fill(&frame.disparity, *size),
            || {
                *values = pack(quantity, frame, scene, radiance);
                frame.types.par_iter().map(|&t| t as u8).collect_into_vec(types);
                frame.supplier.par_iter().map(supplier).collect_into_vec(suppliers);
            },
        );
        self.finished = Instant::now();
    }

    /// Draws the marked pixels black.
    pub fn darken(&mut self, marked: &[bool]) {
        let pixels = self.radiance.iter_mut().zip(marked);
        pixels.filter(|(_, is_marked)| **is_marked).for_each(|(pixel, _)| *pixel = 0);
    }

    /// Lists the references in the cache.
    pub fn list(&mut self, cache: &ReferenceCache, used: &[ReferenceId], added: &[(ReferenceId, Instant)]) {
        self.cache_bytes = [cache.bytes(), cache.budget_bytes()];
        self.cell_bytes = cache.cells().map_or(0, SurfaceCells::bytes);
        let frames = || cache.entries().iter().map(|entry| &entry.frame);
        let stale = frames().map(|frame| frame.stale()).sum();
        self.traced_and_stale = [frames().map(|frame| frame.lit()).sum::<usize>() + stale, stale];
        self.references.clear();
        self.references.extend(cache.entries().iter().map(|entry| ReferenceInfo {
            id: entry.id,
            camera: entry.frame.camera,
            size: entry.frame.view.size,
            contribution: entry.contribution,
            is_used: used.contains(&entry.id),
            is_enabled: entry.is_enabled,
            added: added.iter().find(|(id, _)| *id == entry.id).map_or(self.finished, |(_, at)| *at),
        }));
    }
}

/// Returns the byte of a reference in [`PublishedFrame::suppliers`].
pub fn supplier_byte(id: ReferenceId) -> u8 {
    (id.0 % u32::from(SUPPLIED_BY_NONE)) as u8
}

/// A triple buffer: one frame is written, one is ready, one is shown.
#[derive(Debug, Default)]
pub struct Exchange {
    slots: Mutex<Slots>,
}

#[derive(Debug, Default)]
struct Slots {
    ready: Option<PublishedFrame>,
    spare: Vec<PublishedFrame>,
}

impl Exchange {
    /// Returns a frame to write to.
    pub fn spare(&self) -> PublishedFrame {
        locked(&self.slots).spare.pop().unwrap_or_else(PublishedFrame::empty)
    }

    /// Makes a frame the newest. One that was never shown is written to next.
    pub fn publish(&self, frame: PublishedFrame) {
        let mut slots = locked(&self.slots);
        if let Some(missed) = slots.ready.replace(frame) {
            slots.spare.push(missed);
        }
    }

    /// Swaps the newest frame with the one shown; false where there is none newer.
    pub fn take(&self, shown: &mut Option<PublishedFrame>) -> bool {
        let mut slots = locked(&self.slots);
        let Some(newest) = slots.ready.take() else { return false };
        slots.spare.extend(shown.replace(newest));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_frame_is_taken_and_the_others_are_reused() {
        let exchange = Exchange::default();
        let mut shown = None;
        for generation in 1..=5 {
            let mut frame = exchange.spare();
            frame.generation = generation;
            exchange.publish(frame);
        }
        assert!(exchange.take(&mut shown));
        assert_eq!(shown.as_ref().map(|f| f.generation), Some(5));
        assert!(!exchange.take(&mut shown));
        assert_eq!(
            locked(&exchange.slots).spare.len(),
            1,
            "one written and one missed: two were made in all"
        );
    }
}
