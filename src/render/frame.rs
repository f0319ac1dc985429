//! A finished frame: what the window shows, files store and experiments record.

use super::audit::AuditEstimate;
use crate::camera::{Camera, View};
use crate::lookup::FrameRows;
pub use crate::raster::pixel_types::NO_SUPPLIER;
use crate::raster::pixel_types::{PixelMap, PixelType, TypeCounts};
use crate::scene::SceneFrame;
use crate::trace::RayCounts;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use serde::Serialize;

/// A picture with all that is known of each pixel. Row-major, top row first.
#[derive(Clone, Debug)]
pub struct Frame {
    /// The pose that it shows.
    pub camera: Camera,
    /// The same pose in scene space, with the size.
    pub view: View,
    /// Linear, scene-referred Rec. 709 radiance.
    pub radiance: Vec<Vec3>,
    /// 1 / depth along the viewing axis in scene units; 0 where the sky is seen.
    pub disparity: Vec<f32>,
    /// First triangle, [`crate::trace::NO_TRIANGLE`] for the sky.
    pub triangle: Vec<u32>,
    /// How each pixel came to its colour.
    pub types: PixelMap,
    /// The reference that supplied each pixel, by position in the frame's list of references;
    /// [`NO_SUPPLIER`] for none.
    pub supplier: Vec<u8>,
    /// Times and counts.
    pub stats: FrameStats,
}

/// Seconds by stage. `frame` is the total without loading the scene and tracing references.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct StageSecs {
    /// Choosing references, and deciding after the frame whether a new one is wanted.
    pub select: f64,
    /// Finding what each pixel shows and the light known for it: in mode `paper` the warp,
    /// classification and copying of Type 1; in modes that look up, primary hits and look-ups.
    #[serde(rename = "warp")]
    pub visibility_and_lookup: f64,
    /// Type 2.
    pub secondary: f64,
    /// Type 3: unseen pixels and checks of guesses; every pixel in mode `full`.
    pub trace: f64,
    /// Auditing a few pixels, if enabled.
    pub audit: f64,
    /// From start to end.
    pub frame: f64,
}

/// Progress of a picture that is refined while the camera is stationary.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RefineState {
    /// Passes that every pixel has had.
    pub pass: u32,
    /// Passes after which the picture counts as converged; there are more where it is refined
    /// without end. 0 where the picture is not refined.
    pub of: u32,
    /// Paths per pixel of the smooth light that the picture looks up; 0 where it looks none up.
    pub light_samples: u32,
    /// True where nothing is left to do.
    pub is_complete: bool,
}

/// How much of the last frame's surface points look the same in the next frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct TemporalStability {
    /// Points compared.
    pub compared: u32,
    /// Share of them, in percent, whose colour came from references in one frame and was traced in
    /// the other.
    pub flips_percent: f64,
    /// PSNR between the display values of matte, untextured points in both frames, in decibels;
    /// infinite where nothing changed.
    pub psnr_db: f64,
}

/// Times and counts of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FrameStats {
    /// Pixels of each type.
    pub types: TypeCounts,
    /// Seconds by stage.
    pub secs: StageSecs,
    /// Rays by purpose.
    pub rays: RayCounts,
    /// References that the frame could use.
    pub references_used: usize,
    /// Share of the pixels, 0..1, whose light came from a store of references; `None` without one.
    pub stored_share: Option<f32>,
    /// Reference pixels warped.
    pub warped_pixels: usize,
    /// False where the frame was stopped before every pixel was done.
    pub is_complete: bool,
    /// Progress of refinement. Times and types are those of the frame before refinement.
    pub refined: RefineState,
    /// Error estimated from audits of this frame and earlier ones; `None` where audits are
    /// disabled.
    pub audit: Option<AuditEstimate>,
    /// Comparison with the previous frame; `None` where it is disabled.
    pub temporal_stability: Option<TemporalStability>,
}

impl Default for Frame {
    /// A frame without pixels.
    fn default() -> Self {
        let camera = Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 60.0);
        let frame = SceneFrame { origin_in_world_m: DVec3::ZERO, units_per_metre: 1.0 };
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
}

impl Frame {
    /// Resizes the frame for a view, keeping its memory.
    pub(super) fn reset(&mut self, camera: &Camera, view: &View) {
        let count = view.pixel_count();
        (self.camera, self.view) = (*camera, *view);
        self.stats = FrameStats { is_complete: true, ..FrameStats::default() };
        self.radiance.resize(count, Vec3::ZERO);
        self.disparity.resize(count, 0.0);
        self.triangle.resize(count, 0);
        self.types.resize(count, PixelType::Unseen);
        self.supplier.resize(count, NO_SUPPLIER);
    }

    /// The frame in bands of `rows` rows, to be written in parallel.
    pub(super) fn par_rows_mut(&mut self, rows: usize) -> impl IndexedParallelIterator<Item = FrameRows<'_>> {
        let count = (self.view.size[0] as usize * rows).max(1);
        let parts = (
            self.radiance.par_chunks_mut(count),
            self.disparity.par_chunks_mut(count),
            self.triangle.par_chunks_mut(count),
            self.types.par_chunks_mut(count),
            self.supplier.par_chunks_mut(count),
        );
        parts.into_par_iter().map(|(radiance, disparity, triangle, types, supplier)| FrameRows {
            radiance,
            disparity,
            triangle,
            types,
            supplier,
        })
    }

    /// The share of pixels, 0..1, that each of the frame's `count` references supplied.
    pub fn supplier_shares(&self, count: usize) -> Vec<f32> {
        let mut counts = vec![0usize; count];
        for &s in self.supplier.iter().filter(|s| **s != NO_SUPPLIER) {
            counts[s as usize] += 1;
        }
        counts.iter().map(|&c| c as f32 / self.supplier.len().max(1) as f32).collect()
    }
}
