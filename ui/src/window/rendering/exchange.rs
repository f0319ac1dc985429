//! Finished frames on their way from the render thread to the window, without waiting and without allocating.

use crate::window::rendering::depth_ranges::DepthRanges;
use crate::window::rendering::lock::locked;
use afterimage::Camera;
use afterimage::camera::SceneFrame;
use afterimage::raster::color::metered_exposure_ev;
use afterimage::raster::rgb9e5;
use afterimage::reference::{ReferenceCache, ReferenceId};
use afterimage::render::frame::{Frame, FrameStats, NO_SUPPLIER};
use rayon::prelude::*;
use std::sync::Mutex;
use std::time::Instant;

/// The supplier byte of a pixel that no reference supplied.
pub const SUPPLIED_BY_NONE: u8 = u8::MAX;

/// A reference as the window lists it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReferenceInfo {
    /// Its name.
    pub id: ReferenceId,
    /// Where it was taken.
    pub camera: Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Share of recent frames' pixels that it supplied, 0..1.
    pub contribution: f32,
    /// True where the last frame used it.
    pub is_used: bool,
    /// False where it was switched off.
    pub is_enabled: bool,
    /// When it was added.
    pub added: Instant,
}

/// A frame as the window shows it.
#[derive(Debug)]
pub struct PublishedFrame {
    /// The state of all wishes when it was begun; a later frame never has a smaller one.
    pub generation: u64,
    /// Where it was taken.
    pub camera: Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// The space of its disparities.
    pub scene_frame: SceneFrame,
    /// 1 / depth along the viewing axis in scene units, of pixels and of squares of them.
    pub depth_ranges: DepthRanges,
    /// Radiance as shared-exponent colour, the layout of `Rgb9e5Ufloat`.
    pub radiance: Vec<u32>,
    /// [`afterimage::raster::pixel_types::PixelType`] as numbers.
    pub types: Vec<u8>,
    /// Which reference supplied a pixel, by its name modulo 255; [`SUPPLIED_BY_NONE`] for none. By name rather than
    /// by place in the frame's list, so that a reference keeps its colour from frame to frame.
    pub suppliers: Vec<u8>,
    /// Times and counts.
    pub stats: FrameStats,
    /// The same frame as the one before it, its picture refined.
    pub is_refinement: bool,
    /// All references held, oldest first.
    pub references: Vec<ReferenceInfo>,
    /// Memory that references hold, and may hold.
    pub cache_bytes: [usize; 2],
    /// The exposure that would suit it, in stops; of a complete frame that is not black.
    pub metered_ev: Option<f32>,
    /// When it was finished.
    pub finished: Instant,
}

impl PublishedFrame {
    /// A frame of no pixels.
    pub fn empty() -> Self {
        Self {
            generation: 0,
            camera: Frame::default().camera,
            size: [0, 0],
            scene_frame: SceneFrame { origin_in_world_m: glam::DVec3::ZERO, units_per_metre: 1.0 },
            depth_ranges: DepthRanges::default(),
            radiance: Vec::new(),
            types: Vec::new(),
            suppliers: Vec::new(),
            stats: FrameStats::default(),
            is_refinement: false,
            references: Vec::new(),
            cache_bytes: [0, 0],
            metered_ev: None,
            finished: Instant::now(),
        }
    }

    /// Takes over a rendered frame on the current thread pool, keeping allocations.
    pub fn fill(&mut self, frame: &Frame, scene: &SceneFrame, used: &[ReferenceId], generation: u64) {
        (self.generation, self.is_refinement) = (generation, false);
        (self.camera, self.size, self.stats) = (frame.camera, frame.view.size, frame.stats);
        self.scene_frame = *scene;
        self.depth_ranges.fill(&frame.disparity, self.size);
        frame.radiance.par_iter().map(|&c| rgb9e5::pack(c)).collect_into_vec(&mut self.radiance);
        self.types.clear();
        self.types.extend(frame.types.iter().map(|&t| t as u8));
        self.suppliers.clear();
        self.suppliers.extend(frame.supplier.iter().map(|&slot| match used.get(slot as usize) {
            Some(id) if slot != NO_SUPPLIER => supplier_byte(*id),
            _ => SUPPLIED_BY_NONE,
        }));
        self.metered_ev = self.stats.is_complete.then(|| metered_exposure_ev(&frame.radiance)).flatten();
        self.finished = Instant::now();
    }

    /// Lists the references held.
    pub fn list(&mut self, cache: &ReferenceCache, used: &[ReferenceId], added: &[(ReferenceId, Instant)]) {
        self.cache_bytes = [cache.bytes(), cache.budget_bytes()];
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

/// The byte that stands for a reference in [`PublishedFrame::suppliers`].
pub fn supplier_byte(id: ReferenceId) -> u8 {
    (id.0 % u32::from(SUPPLIED_BY_NONE)) as u8
}

/// Three frames: one is written, one is ready, one is shown.
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
    /// A frame to write to.
    pub fn spare(&self) -> PublishedFrame {
        locked(&self.slots).spare.pop().unwrap_or_else(PublishedFrame::empty)
    }

    /// Makes a frame the newest; one that nobody took is written to next.
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
    fn the_newest_frame_is_taken_and_the_others_are_used_again() {
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
