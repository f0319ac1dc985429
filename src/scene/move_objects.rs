//! Objects of a scene moved, hidden or deleted. What was loaded stays at hand, so that an edit that
//! is undone brings back its very bits.

use super::assemble::has_area;
use super::coincident;
use super::duplicates::Duplicates;
use super::object_edits::{EditedObjects, LoadedGeometry, ObjectEdits};
use super::{MaterialId, ObjectKey, Objects, Scene};
use glam::{DQuat, DVec3, Vec2, Vec3};
use std::collections::HashMap;
use std::sync::Arc;

/// An object on its way.
struct Motion {
    /// Middle of its box, scene space.
    middle: DVec3,
    rotation: DQuat,
    /// Scene units.
    way: DVec3,
    /// New vertex of each old one.
    vertices: HashMap<u32, u32>,
}

/// What becomes of an object.
enum Fate {
    Stays,
    Goes,
    Moves(Box<Motion>),
}

impl Scene {
    /// The objects of the model, also those that are hidden or deleted.
    pub fn all_objects(&self) -> &Arc<Objects> {
        self.edited_objects.as_ref().map_or(&self.objects, |edited| &edited.loaded.objects)
    }

    /// The object that a triangle belongs to.
    pub fn object_of(&self, triangle: u32) -> Option<&ObjectKey> {
        self.objects.of_triangle(triangle).map(|object| &self.objects.keys()[object])
    }

    /// The edits of objects that led to this scene.
    pub fn object_edits(&self) -> ObjectEdits {
        self.edited_objects.as_ref().map(|edited| edited.edits.clone()).unwrap_or_default()
    }

    /// The middle of an object's box where the model has it, world metres; `None` of an object
    /// without triangles.
    pub fn middle_of_object(&self, key: &ObjectKey) -> Option<DVec3> {
        let loaded = self.loaded();
        let object = loaded.objects.keys().iter().position(|known| known == key)?;
        Some(self.frame.world_from_scene(middle_of(&loaded, object)?.as_vec3()))
    }

    fn loaded(&self) -> LoadedGeometry {
        self.edited_objects.as_ref().map_or_else(|| self.bare_geometry(), |edited| edited.loaded.clone())
    }

    /// The geometry that is shown.
    pub(super) fn bare_geometry(&self) -> LoadedGeometry {
        LoadedGeometry {
            positions: self.positions.clone(),
            normals: self.normals.clone(),
            uvs: self.uvs.clone(),
            triangles: self.triangles.clone(),
            triangle_materials: self.triangle_materials.clone(),
            objects: self.objects.clone(),
            hidden: self.hidden.clone(),
            coincident: self.coincident.clone(),
        }
    }

    /// Shows another geometry. What follows from it must be derived afterwards.
    pub(super) fn set_geometry(&mut self, geometry: &LoadedGeometry) {
        let LoadedGeometry { positions, normals, uvs, triangles, triangle_materials, .. } = geometry.clone();
        (self.positions, self.normals, self.uvs) = (positions, normals, uvs);
        (self.triangles, self.triangle_materials) = (triangles, triangle_materials);
        self.objects.clone_from(&geometry.objects);
        self.hidden.clone_from(&geometry.hidden);
        self.coincident.clone_from(&geometry.coincident);
    }

    /// Returns this scene, which has no added ground, with other edits of its objects. Those of
    /// unknown objects, and impossible ones, are left out. Where nothing would be left, the
    /// geometry stays as it is. Frame, box and views stay, so that light that holds is recognised.
    /// What follows from the geometry must be derived afterwards.
    pub(super) fn with_objects(&self, edits: &ObjectEdits) -> Self {
        let known = self.all_objects().keys();
        let mut edits = edits.clone();
        edits.retain(|key, edit| !edit.is_none() && edit.is_possible(self.bounds_m) && known.contains(key));
        if edits == self.object_edits() {
            return self.clone();
        }
        let loaded = self.loaded();
        let mut scene = self.clone();
        if edits.is_empty() {
            scene.set_geometry(&loaded);
            scene.edited_objects = None;
            return scene;
        }
        let Some(moved) = self.moved(&loaded, &edits) else { return scene };
        (scene.positions, scene.normals, scene.uvs) =
            (Arc::new(moved.positions), Arc::new(moved.normals), Arc::new(moved.uvs));
        (scene.triangles, scene.triangle_materials, scene.objects) =
            (Arc::new(moved.triangles), Arc::new(moved.triangle_materials), Arc::new(moved.objects));
        scene.hidden = Duplicates::find(&scene).hidden;
        scene.coincident = Arc::new(coincident::find(&scene));
        scene.edited_objects = Some(Arc::new(EditedObjects { loaded, edits }));
        scene
    }

    /// The loaded geometry with edits; `None` where nothing is left of it.
    fn moved(&self, loaded: &LoadedGeometry, edits: &ObjectEdits) -> Option<Moved> {
        let keys = loaded.objects.keys();
        let mut fates: Vec<Fate> = (0..keys.len()).map(|_| Fate::Stays).collect();
        for (object, key) in keys.iter().enumerate() {
            let Some(edit) = edits.get(key) else { continue };
            fates[object] = match middle_of(loaded, object) {
                Some(middle) if !edit.is_gone() => Fate::Moves(Box::new(Motion {
                    middle,
                    rotation: DQuat::from_rotation_y(edit.turned_deg.to_radians()),
                    way: edit.moved_m * self.frame.units_per_metre,
                    vertices: HashMap::new(),
                })),
                _ => Fate::Goes,
            };
        }
        let mut moved = Moved {
            positions: loaded.positions.to_vec(),
            normals: loaded.normals.to_vec(),
            uvs: loaded.uvs.to_vec(),
            triangles: Vec::new(),
            triangle_materials: Vec::new(),
            objects: loaded.objects.without_triangles(),
        };
        for (run, object) in loaded.objects.runs(loaded.triangles.len() as u32) {
            moved.objects.begin(moved.triangles.len() as u32, object.map(|object| object as u32));
            let mut stays = Fate::Stays;
            let fate = object.map_or(&mut stays, |object| &mut fates[object]);
            for triangle in run {
                moved.add(loaded, triangle as usize, fate);
            }
        }
        (!moved.triangles.is_empty()).then_some(moved)
    }
}

/// A geometry in the making. Vertices of objects that move are appended.
struct Moved {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    triangles: Vec<[u32; 3]>,
    triangle_materials: Vec<MaterialId>,
    objects: Objects,
}

impl Moved {
    fn add(&mut self, loaded: &LoadedGeometry, triangle: usize, fate: &mut Fate) {
        let vertices = loaded.triangles[triangle];
        let vertices = match fate {
            Fate::Stays => vertices,
            Fate::Goes => return,
            Fate::Moves(motion) => vertices.map(|vertex| self.vertex(motion, vertex)),
        };
        let corners = vertices.map(|vertex| self.positions[vertex as usize]);
        if matches!(fate, Fate::Stays) || has_area(corners) {
            self.triangles.push(vertices);
            self.triangle_materials.push(loaded.triangle_materials[triangle]);
        }
    }

    /// The vertex at the new place of one of an object.
    fn vertex(&mut self, motion: &mut Motion, vertex: u32) -> u32 {
        let next = self.positions.len() as u32;
        let moved = *motion.vertices.entry(vertex).or_insert(next);
        if moved == next {
            let at = vertex as usize;
            self.positions.push(motion.position(self.positions[at]));
            if let Some(&normal) = self.normals.get(at) {
                self.normals.push((motion.rotation * normal.as_dvec3()).as_vec3());
            }
            if let Some(&uv) = self.uvs.get(at) {
                self.uvs.push(uv);
            }
        }
        moved
    }
}

impl Motion {
    /// Where a point goes. Without rotation, no bits are lost on the way to the middle and back.
    fn position(&self, position: Vec3) -> Vec3 {
        let at = position.as_dvec3();
        let turned = match self.rotation == DQuat::IDENTITY {
            true => at,
            false => self.middle + self.rotation * (at - self.middle),
        };
        (turned + self.way).as_vec3()
    }
}

/// The middle of the box of an object's triangles, scene space.
fn middle_of(loaded: &LoadedGeometry, object: usize) -> Option<DVec3> {
    let runs = loaded.objects.runs(loaded.triangles.len() as u32).filter(|(_, of)| *of == Some(object));
    let vertices = runs.flat_map(|(run, _)| run).flat_map(|t| loaded.triangles[t as usize]);
    let nothing = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    let (low, high) = vertices.fold(nothing, |(low, high), vertex| {
        let position = loaded.positions[vertex as usize];
        (low.min(position), high.max(position))
    });
    (low.x <= high.x).then(|| (low.as_dvec3() + high.as_dvec3()) / 2.0)
}
