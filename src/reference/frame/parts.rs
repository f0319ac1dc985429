//! References made from what was stored of earlier ones.

use super::ReferenceFrame;
use crate::camera::{Camera, View};
use crate::raster::rgb9e5::Rgb9e5Scale;
use crate::reference::DisparityTiles;
use crate::reference::light::UNLIT;
use crate::trace::{RayCounts, TraceSettings, Tracer};

/// The pixels of a reference, and what is needed to read them. The columns are row-major and have
/// an entry per pixel, or none where the reference holds no such data.
#[derive(Debug)]
pub(crate) struct ReferenceParts {
    pub(crate) camera: Camera,
    pub(crate) view: View,
    pub(crate) settings: TraceSettings,
    pub(crate) disparity: Vec<f32>,
    pub(crate) triangle: Vec<u32>,
    pub(crate) light: Vec<u32>,
    pub(crate) light_scale: Rgb9e5Scale,
    pub(crate) smooth: Vec<u32>,
    pub(crate) smooth_scale: Rgb9e5Scale,
    pub(crate) reflections: Vec<u8>,
    pub(crate) is_dense: bool,
    pub(crate) is_refined: bool,
}

impl ReferenceFrame {
    /// Makes a reference of the tracer's scene. It took no time and no rays. Where a dense one has
    /// lost the light of pixels, because their surfaces are gone, their disparity is NaN, so that
    /// they are not used.
    pub(crate) fn from_parts(tracer: &Tracer, parts: ReferenceParts) -> Self {
        let tiles = match parts.is_dense {
            true => DisparityTiles::new(&parts.disparity, parts.view.size),
            false => DisparityTiles::default(),
        };
        Self {
            camera: parts.camera,
            view: parts.view,
            epoch: tracer.epoch(),
            origin: tracer.scene().clone(),
            settings: parts.settings,
            secs: 0.0,
            rays: RayCounts::default(),
            tiles,
            disparity: parts.disparity,
            triangle: parts.triangle,
            lit: parts.light.iter().filter(|word| **word != UNLIT).count(),
            light: parts.light,
            light_scale: parts.light_scale,
            smooth: parts.smooth,
            smooth_scale: parts.smooth_scale,
            reflections: parts.reflections,
            is_dense: parts.is_dense,
            is_refined: parts.is_refined,
            stale: None,
            lost: Vec::new(),
            layers: None,
            traced: None,
            moves: 0,
        }
    }

    /// True where reflections are counted: in scenes with mirrors or glass.
    pub(crate) fn has_reflections(&self) -> bool {
        !self.reflections.is_empty()
    }
}
