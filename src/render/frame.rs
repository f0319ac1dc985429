//! A finished frame: what the window shows, files keep and experiments record.

use super::audit::statistics::AuditEstimate;
use super::refine::RefineState;
use crate::camera::{Camera, View};
use crate::raster::pixel_types::{PixelMap, TypeCounts};
use crate::render::temporal_stability::TemporalStability;
use crate::trace::RayCounts;
use glam::Vec3;
use serde::Serialize;

/// No reference supplied the pixel.
pub const NO_SUPPLIER: u8 = u8::MAX;

/// A picture with all that is known of each pixel. Row-major, top row first.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Where it was taken.
    pub camera: Camera,
    /// The same in scene space, with the size.
    pub view: View,
    /// Linear, scene-referred Rec. 709.
    pub radiance: Vec<Vec3>,
    /// 1 / depth along the viewing axis in scene units; 0 where the sky is seen.
    pub disparity: Vec<f32>,
    /// First triangle, [`crate::trace::NO_TRIANGLE`] for the sky.
    pub triangle: Vec<u32>,
    /// How each pixel came to its colour.
    pub types: PixelMap,
    /// Which of the frame's references supplied it, by position in the list; [`NO_SUPPLIER`] for none.
    pub supplier: Vec<u8>,
    /// Times and counts.
    pub stats: FrameStats,
}

/// Seconds by stage; `frame` is all of them, loading and references left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct StageSecs {
    /// Choosing references, and judging afterwards what they gave and whether another is wanted.
    pub select: f64,
    /// Finding what each pixel shows and the light known for it: in mode `paper` the warp,
    /// classification and copying of Type 1; in modes that look up, primary hits and look-ups.
    #[serde(rename = "warp")]
    pub visibility_and_lookup: f64,
    /// Type 2.
    pub secondary: f64,
    /// Type 3, or every pixel of the full tracer.
    pub trace: f64,
    /// Checking a few pixels, where that is asked for.
    pub audit: f64,
    /// From start to end.
    pub frame: f64,
}

/// What a frame took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameStats {
    /// Pixels of each type.
    pub types: TypeCounts,
    /// Seconds by stage.
    pub secs: StageSecs,
    /// Rays by purpose.
    pub rays: RayCounts,
    /// References warped.
    pub references_used: usize,
    /// Reference pixels warped.
    pub warped_pixels: usize,
    /// False where the frame was stopped before every pixel was done.
    pub is_complete: bool,
    /// How far the picture was refined at rest; times and types are those of the frame before it.
    pub refined: RefineState,
    /// What checks say of this frame and those before it; `None` where nothing is checked.
    pub audit: Option<AuditEstimate>,
    /// What it has in common with the frame before it; `None` where that is not asked for.
    pub temporal_stability: Option<TemporalStability>,
}

impl Frame {
    /// A frame of no pixels.
    pub fn empty() -> Self {
        let camera = Camera::look_at(glam::DVec3::ZERO, glam::DVec3::NEG_Z, 60.0);
        let frame = crate::scene::SceneFrame { origin_in_world_m: glam::DVec3::ZERO, units_per_metre: 1.0 };
        Self {
            camera,
            view: View::new(&camera, &frame, [0, 0]),
            radiance: Vec::new(),
            disparity: Vec::new(),
            triangle: Vec::new(),
            types: Vec::new(),
            supplier: Vec::new(),
            stats: FrameStats::default(),
        }
    }

    /// Makes room for a view, keeping allocations.
    pub(super) fn reset(&mut self, camera: &Camera, view: &View) {
        let count = view.pixel_count();
        (self.camera, self.view) = (*camera, *view);
        self.stats = FrameStats::default();
        self.radiance.resize(count, Vec3::ZERO);
        self.disparity.resize(count, 0.0);
        self.triangle.resize(count, 0);
        self.types.resize(count, crate::raster::pixel_types::PixelType::Unseen);
        self.supplier.resize(count, NO_SUPPLIER);
    }

    /// The share of pixels that each of the frame's `count` references supplied.
    pub fn supplier_shares(&self, count: usize) -> Vec<f32> {
        let mut counts = vec![0usize; count];
        for &s in self.supplier.iter().filter(|s| **s != NO_SUPPLIER) {
            counts[s as usize] += 1;
        }
        counts.iter().map(|&c| c as f32 / self.supplier.len().max(1) as f32).collect()
    }
}
