//! What is looked at more closely: a pixel, a distance, a reference.

use afterimage::Camera;
use afterimage::raster::pixel_types::PixelType;
use afterimage::reference::ReferenceId;
use afterimage::scene::MaterialId;
use glam::{DVec3, Vec3};

/// What a click found.
#[derive(Clone, Debug, PartialEq)]
pub struct Inspection {
    /// World metres.
    pub position_m: DVec3,
    /// From the eye.
    pub distance_m: f64,
    /// Along the viewing axis.
    pub depth_m: f64,
    /// Of the triangle, towards the eye.
    pub normal: Vec3,
    /// Its number in the scene.
    pub triangle: u32,
    /// Its corners, world metres.
    pub corners_m: [DVec3; 3],
    /// Of the triangle.
    pub material: MaterialId,
    /// What the shown frame knows of the pixel; `None` where the frame is of another pose.
    pub pixel: Option<PixelFacts>,
}

/// What a frame knows of a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelFacts {
    /// Column and row.
    pub at: [u32; 2],
    /// How it came to its colour.
    pub kind: PixelType,
    /// Who supplied it.
    pub supplier: Option<ReferenceId>,
    /// Linear radiance.
    pub radiance: Vec3,
}

/// What a point that is measured lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SnapKind {
    /// A corner of a triangle.
    Vertex,
    /// An edge of a triangle.
    Edge,
    /// Anywhere on a triangle.
    Surface,
}

/// A point that can be measured from or to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snap {
    /// World metres.
    pub position_m: DVec3,
    /// What it lies on.
    pub kind: SnapKind,
}

/// Measuring by two clicks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measure {
    /// Clicks set points.
    pub is_on: bool,
    /// None, one or two.
    pub points: Vec<Snap>,
    /// Where a click would set the next.
    pub hover: Option<Snap>,
}

impl Measure {
    /// Both ends, the second one under the cursor until it is set.
    pub fn ends(&self) -> Option<[DVec3; 2]> {
        let second = self.points.get(1).or(self.hover.as_ref().filter(|_| self.is_on))?;
        Some([self.points.first()?.position_m, second.position_m])
    }

    /// Sets the next point; a third one begins anew.
    pub fn set(&mut self, point: Snap) {
        if self.points.len() >= 2 {
            self.points.clear();
        }
        self.points.push(point);
    }
}

/// What is looked at more closely.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// What the last click found.
    pub inspection: Option<Inspection>,
    /// The material whose properties are shown.
    pub material: Option<MaterialId>,
    /// Distances.
    pub measure: Measure,
    /// The reference chosen in the plan or the list.
    pub reference: Option<ReferenceId>,
    /// A reference's own picture over the viewport.
    pub reference_view: Option<ReferenceView>,
    /// Only import warnings with this text are listed.
    pub report_filter: String,
}

/// What a reference holds, as a picture.
#[derive(Clone)]
pub struct ReferenceView {
    /// Whose.
    pub id: ReferenceId,
    /// Where it was taken.
    pub camera: Camera,
    /// Share of its pixels that hold light, 0..1.
    pub lit: f32,
    /// The picture.
    pub texture: egui::TextureHandle,
}

impl std::fmt::Debug for ReferenceView {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ReferenceView").field("id", &self.id).field("lit", &self.lit).finish_non_exhaustive()
    }
}
