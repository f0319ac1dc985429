//! Which surfaces the pixels of a reference show, by which a walk finds the records that serve a
//! view without reading their pixels.

use crate::camera::{Camera, View};
use crate::reference::ReferenceFrame;
use crate::scene::Scene;
use crate::trace::{NO_TRIANGLE, Tracer};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Side of a cell in scene units: a 32nd to a 64th of the diagonal of the scene.
const SIDE: f64 = 16.0;

/// Largest number of cells that a record may name. Cells are found in the pixels, so a picture of
/// the whole scene has at most some thousands.
pub(super) const MAX_CELLS: usize = 1 << 16;

/// Size of the coarse picture that finds out what a view shows, pixels.
const COARSE: [u32; 2] = [48, 27];

/// The surfaces in a cube of space that face one of six directions, so that both sides of a wall
/// are told apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Cell {
    /// Coordinates of the cube, in multiples of the side from the origin of the world.
    pub(super) cube: [i32; 3],
    /// The axis that the surfaces face: +X, -X, +Y, -Y, +Z, -Z.
    pub(super) face: u32,
}

/// How many pixels of a reference show a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CellCount {
    pub(super) cell: Cell,
    /// Pixels whose light is stored.
    pub(super) lit: u32,
    /// All pixels.
    pub(super) seen: u32,
}

/// The cells that a reference shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct CellCounts {
    /// Side of a cube in world metres.
    pub(super) side_m: f64,
    /// Cells with lit pixels, ascending.
    pub(super) counts: Vec<CellCount>,
}

impl CellCounts {
    /// Counts the pixels of a reference.
    pub(super) fn of(frame: &ReferenceFrame, scene: &Scene) -> Self {
        let side_m = side_m(scene);
        let mut counts = BTreeMap::<Cell, [u32; 2]>::new();
        // Neighbours mostly show the same cell.
        let mut run: Option<(Cell, [u32; 2])> = None;
        for pixel in 0..frame.view.pixel_count() as u32 {
            let (triangle, disparity) = (frame.triangle()[pixel as usize], frame.disparity()[pixel as usize]);
            if triangle != NO_TRIANGLE && disparity > 0.0 {
                let offset = frame.offset_from_eye(pixel);
                let cell = cell_of(scene, triangle, frame.view.eye + offset, offset, side_m);
                if run.is_none_or(|(same, _)| same != cell) {
                    add(&mut counts, run.replace((cell, [0; 2])));
                }
                if let Some((_, [lit, seen])) = &mut run {
                    (*lit, *seen) = (*lit + u32::from(frame.has_light(pixel)), *seen + 1);
                }
            }
        }
        add(&mut counts, run);
        let counts = counts.into_iter().filter(|(_, [lit, _])| *lit > 0);
        let counts = counts.map(|(cell, [lit, seen])| CellCount { cell, lit, seen });
        Self { side_m, counts: counts.take(MAX_CELLS).collect() }
    }
}

fn add(counts: &mut BTreeMap<Cell, [u32; 2]>, run: Option<(Cell, [u32; 2])>) {
    if let Some((cell, [lit, seen])) = run {
        let sum = counts.entry(cell).or_default();
        *sum = [sum[0] + lit, sum[1] + seen];
    }
}

/// Side of the cubes of a scene in world metres.
pub(super) fn side_m(scene: &Scene) -> f64 {
    SIDE / scene.frame.units_per_metre
}

/// The cell of a point on a triangle in scene space, seen along a direction.
fn cell_of(scene: &Scene, triangle: u32, position: Vec3, direction: Vec3, side_m: f64) -> Cell {
    let [a, b, c] = scene.corners(triangle);
    let normal = (b - a).cross(c - a);
    let normal = if normal.dot(direction) > 0.0 { -normal } else { normal };
    let axis = normal.abs().max_position();
    let cube: DVec3 = (scene.frame.world_from_scene(position) / side_m).floor();
    let face = 2 * axis as u32 + u32::from(normal[axis] < 0.0);
    Cell { cube: cube.to_array().map(|coordinate| coordinate as i32), face }
}

/// The cells that a view shows, ascending, with the share of the picture of each, 0..1. What is
/// behind glass or in mirrors is left out.
pub(super) fn cells_of_view(tracer: &Tracer, camera: &Camera) -> Vec<(Cell, f32)> {
    let scene = tracer.scene();
    let (view, side_m) = (View::new(camera, &scene.frame, COARSE), side_m(scene));
    let mut seen: Vec<Cell> = (0..view.pixel_count() as u32)
        .into_par_iter()
        .with_min_len(64)
        .filter_map(|pixel| {
            let ray = Tracer::primary_ray(&view, pixel);
            let hit = tracer.closest(&ray)?;
            Some(cell_of(scene, hit.triangle, ray.origin + ray.direction * hit.t, ray.direction, side_m))
        })
        .collect();
    seen.sort_unstable();
    let share = 1.0 / view.pixel_count() as f32;
    seen.chunk_by(|a, b| a == b).map(|same| (same[0], share * same.len() as f32)).collect()
}
