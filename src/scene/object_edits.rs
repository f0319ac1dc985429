//! What is changed about the objects of a scene.

use super::{MaterialId, ObjectKey, Objects};
use glam::{DVec3, Vec2, Vec3};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Longest way of an object, in diagonals of the model's box. Farther away, its shape would be lost
/// to rounding.
const MAX_WAY: f64 = 1e4;

/// What is changed about an object.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ObjectEdit {
    /// True where it is not shown for now.
    pub is_hidden: bool,
    /// True where it is no longer part of the scene.
    pub is_deleted: bool,
    /// Way from where the model has it, metres.
    pub moved_m: DVec3,
    /// Angle by which it is turned about the vertical through the middle of its box, degrees.
    pub turned_deg: f64,
}

/// Edits by object.
pub type ObjectEdits = BTreeMap<ObjectKey, ObjectEdit>;

/// The geometry of a scene as it was loaded.
#[derive(Clone, Debug)]
pub(super) struct LoadedGeometry {
    pub(super) positions: Arc<Vec<Vec3>>,
    pub(super) normals: Arc<Vec<Vec3>>,
    pub(super) uvs: Arc<Vec<Vec2>>,
    pub(super) triangles: Arc<Vec<[u32; 3]>>,
    pub(super) triangle_materials: Arc<Vec<MaterialId>>,
    pub(super) objects: Arc<Objects>,
    pub(super) hidden: Vec<u32>,
    pub(super) coincident: Arc<Vec<bool>>,
}

/// The edits of a scene's objects, and what was there before.
#[derive(Debug)]
pub struct EditedObjects {
    pub(super) loaded: LoadedGeometry,
    pub(super) edits: ObjectEdits,
}

impl ObjectEdit {
    /// True where nothing is changed.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }

    /// True where the object is not in the scene.
    pub fn is_gone(&self) -> bool {
        self.is_hidden || self.is_deleted
    }

    /// True where way and angle are finite, and the way is at most ten thousand times as long as a
    /// box of these corners.
    pub fn is_possible(&self, [low, high]: [DVec3; 2]) -> bool {
        self.turned_deg.is_finite() && self.moved_m.length() <= MAX_WAY * low.distance(high)
    }
}
