//! The selected pixel, distance, material and reference.

use afterimage::Camera;
use afterimage::raster::pixel_types::PixelType;
use afterimage::reference::ReferenceId;
use afterimage::scene::{MaterialId, ObjectKey};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// The surface that was clicked on.
#[derive(Clone, Debug, PartialEq)]
pub struct Inspection {
    /// Hit point in world metres.
    pub position_m: DVec3,
    /// Distance from the eye in metres.
    pub distance_m: f64,
    /// Distance along the viewing axis in metres.
    pub depth_m: f64,
    /// Geometric normal of the triangle, towards the eye.
    pub normal: Vec3,
    /// Index of the triangle in the scene.
    pub triangle: u32,
    /// Corners of the triangle in world metres.
    pub corners_m: [DVec3; 3],
    /// Material of the triangle in the scene's list.
    pub material: MaterialId,
    /// Object that the triangle belongs to, if it has a name.
    pub object: Option<ObjectKey>,
    /// The camera through which it was clicked.
    pub camera: Camera,
    /// What the shown frame knows about the pixel; `None` where the frame has another pose.
    pub pixel: Option<PixelFacts>,
}

/// What a frame knows about a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelFacts {
    /// Column and row of the pixel.
    pub at: [u32; 2],
    /// Type of the pixel: how its colour was computed.
    pub kind: PixelType,
    /// Reference that supplied the pixel.
    pub supplier: Option<ReferenceId>,
    /// Linear radiance of the pixel.
    pub radiance: Vec3,
}

/// Kind of place that a measured point lies on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SnapKind {
    /// A corner of a triangle.
    Vertex,
    /// An edge of a triangle.
    Edge,
    /// Any other point of a triangle.
    Surface,
}

/// A point that can be measured from or to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snap {
    /// Position of the point in world metres.
    pub position_m: DVec3,
    /// Kind of place it lies on.
    pub kind: SnapKind,
}

/// A distance that is being measured with two clicks. Complete ones are in the document.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measure {
    /// True while clicks set points.
    pub is_on: bool,
    /// The first point, once it is set.
    pub first: Option<Snap>,
    /// The point that a click would set.
    pub hover: Option<Snap>,
}

impl Measure {
    /// Returns both ends in world metres. The second one is under the cursor.
    pub fn ends(&self) -> Option<[DVec3; 2]> {
        let second = self.hover.as_ref().filter(|_| self.is_on)?;
        Some([self.first.as_ref()?.position_m, second.position_m])
    }

    /// Begins or ends measuring. A pair that is half finished is dropped, so that the next click
    /// sets a first point.
    pub fn switch(&mut self, is_on: bool) {
        *self = Self { is_on, ..Self::default() };
    }

    /// Ends measuring; returns whether it was on.
    pub fn end(&mut self) -> bool {
        let was_on = self.is_on;
        self.switch(false);
        was_on
    }

    /// Sets the next point; the second one completes a pair, which is returned in world metres.
    pub fn set(&mut self, point: Snap) -> Option<[DVec3; 2]> {
        match self.first.take() {
            Some(first) => Some([first.position_m, point.position_m]),
            None => {
                self.first = Some(point);
                None
            }
        }
    }
}

/// The next click copies the material of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dropper {
    /// The material that becomes like the one that is picked.
    pub into: MaterialId,
    /// The material that was picked, until it is copied.
    pub from: Option<MaterialId>,
}

/// The selected pixel, distance, material and reference.
#[derive(Clone, Debug, Default)]
pub struct Selection {
    /// The surface that was clicked on last.
    pub inspection: Option<Inspection>,
    /// Triangle of the surface that was clicked, and the outline of the plane around it: lines in
    /// world metres.
    pub outline: Option<(u32, Arc<Vec<[DVec3; 2]>>)>,
    /// The material whose properties are shown.
    pub material: Option<MaterialId>,
    /// Set while a surface is picked whose material is copied.
    pub dropper: Option<Dropper>,
    /// The object that can be moved, hidden and deleted.
    pub object: Option<ObjectKey>,
    /// The distance that is being measured.
    pub measure: Measure,
    /// The reference that was selected in the plan or the list.
    pub reference: Option<ReferenceId>,
    /// The reference that is shown over the viewport.
    pub reference_view: Option<ReferenceView>,
    /// Only import warnings that contain this text are listed.
    pub report_filter: String,
}

/// The light that a reference holds, as a picture.
#[derive(Clone)]
pub struct ReferenceView {
    /// Identity of the reference in the cache.
    pub id: ReferenceId,
    /// Pose at which the reference was traced.
    pub camera: Camera,
    /// Share of its pixels that hold light, 0..1.
    pub lit: f32,
    /// The picture, displayed with the viewport's exposure.
    pub texture: egui::TextureHandle,
}

impl std::fmt::Debug for ReferenceView {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ReferenceView").field("id", &self.id).field("lit", &self.lit).finish_non_exhaustive()
    }
}
