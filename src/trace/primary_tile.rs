//! The primary rays of a tile of neighbouring pixels, and their nearest hits.

use super::bvh::{RayTile, TILE_RAYS, TILE_SIDE, TileHits};
use super::{Hit, Tracer};
use crate::camera::View;
use glam::Vec3;

impl Tracer {
    /// Writes the nearest hits through the pixel centres of the tile whose top left pixel is
    /// `corner`.
    ///
    /// The hits are those of [`Self::closest_seen`], found several times as fast. Rays beyond the edge
    /// of the picture are traced too. `tile` is overwritten.
    pub fn closest_in_tile(&self, view: &View, corner: [u32; 2], tile: &mut RayTile, hits: &mut TileHits) {
        aim(view, corner, tile);
        if self.section().is_some() {
            return (0..TILE_RAYS).for_each(|ray| hits.set(ray, self.closest_seen(&tile.ray(ray))));
        }
        let stands = |ray: usize, hit: &Hit| self.stands(&tile.ray(ray), hit);
        self.bvh().closest_in_tile(tile, !self.scene().features.checks_hits(), stands, hits);
    }

    /// [`Self::closest_in_tile`] without the surfaces of glass that have no diffuse part.
    pub fn closest_behind_glass_in_tile(
        &self,
        view: &View,
        corner: [u32; 2],
        tile: &mut RayTile,
        hits: &mut TileHits,
    ) {
        if !self.scene().features.glass {
            return self.closest_in_tile(view, corner, tile, hits);
        }
        aim(view, corner, tile);
        if self.section().is_some() {
            let is_there = |hit: &Hit| !self.is_clear_glass(hit.triangle);
            let seen = |ray| self.closest_seen_where(&tile.ray(ray), is_there);
            return (0..TILE_RAYS).for_each(|ray| hits.set(ray, seen(ray)));
        }
        let is_there =
            |ray: usize, hit: &Hit| !self.is_clear_glass(hit.triangle) && self.stands(&tile.ray(ray), hit);
        self.bvh().closest_in_tile(tile, false, is_there, hits);
    }

    /// True for a triangle of clear glass without a diffuse part.
    pub(super) fn is_clear_glass(&self, triangle: u32) -> bool {
        let material = self.scene().material_of(triangle);
        material.is_glass() && !material.is_frosted() && !material.has_base()
    }
}

/// Returns the primary rays of the tile whose top left pixel is `corner`.
pub fn primary_tile(view: &View, corner: [u32; 2]) -> RayTile {
    let directions = [[0.0; TILE_RAYS]; 3];
    let mut tile = RayTile { origin: Vec3::ZERO, forward: Vec3::ZERO, directions, corners: [Vec3::ZERO; 4] };
    aim(view, corner, &mut tile);
    tile
}

/// Makes a tile that of the primary rays whose top left pixel is (x0, y0).
pub(super) fn aim(view: &View, [x0, y0]: [u32; 2], tile: &mut RayTile) {
    let (x0, y0, side) = (x0 as f32, y0 as f32, TILE_SIDE as f32);
    let corner = |dx: f32, dy: f32| view.direction_of_point(x0 + dx * side, y0 + dy * side);
    tile.origin = view.eye;
    tile.forward = view.scene_from_camera * Vec3::Z;
    tile.corners = [corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)];
    // The arithmetic of `View::direction_of_point`, written so that it is vectorised.
    let m = view.scene_from_pixel;
    for (axis, of_axis) in tile.directions.iter_mut().enumerate() {
        for (row, of_row) in of_axis.as_chunks_mut::<TILE_SIDE>().0.iter_mut().enumerate() {
            let (dx, dz) = (m.x_axis[axis], m.z_axis[axis]);
            let along_y = m.y_axis[axis] * (y0 + row as f32 + 0.5);
            for (column, d) in of_row.iter_mut().enumerate() {
                *d = dx * (x0 + column as f32 + 0.5) + along_y + dz;
            }
        }
    }
}
