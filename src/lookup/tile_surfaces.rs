//! The surfaces that a tile of pixels sees, ready for the look-up.

use crate::camera::View;
use crate::lookup::TilePoints;
use crate::scene::{MaterialId, Scene};
use crate::trace::{RayTile, TILE_RAYS, TileHits, Tracer, primary_tile};
use glam::Vec3;

/// What a tile of pixels sees.
#[derive(Clone, Debug)]
pub struct TileSurfaces {
    rays: RayTile,
    /// First hits.
    pub hits: TileHits,
    /// Points whose light is wanted: of surfaces that reflect some of it.
    pub points: TilePoints,
    /// Of each pixel that sees a surface.
    pub material: [MaterialId; TILE_RAYS],
}

/// What is the same for all pixels of a triangle.
#[derive(Clone, Copy)]
struct Facet {
    triangle: u32,
    material: MaterialId,
    reflects: bool,
    normal: Vec3,
}

impl TileSurfaces {
    /// Room for the tiles of a view.
    pub fn new(view: &View) -> Self {
        Self {
            rays: primary_tile(view, [0, 0]),
            hits: TileHits::NONE,
            points: TilePoints::NONE,
            material: [MaterialId(0); TILE_RAYS],
        }
    }

    /// Finds what the tile whose top left pixel is `corner` sees. Pixels beyond the picture's edge want no light.
    pub fn see(&mut self, tracer: &Tracer, view: &View, corner: [u32; 2]) {
        tracer.closest_in_tile(view, corner, &mut self.rays, &mut self.hits);
        self.describe(tracer, view, corner);
    }

    /// The same as if clear glass were not there: what a sparse reference keeps, so that things in a glass case are known
    /// to those who look through it.
    pub fn see_behind_glass(&mut self, tracer: &Tracer, view: &View, corner: [u32; 2]) {
        tracer.closest_behind_glass_in_tile(view, corner, &mut self.rays, &mut self.hits);
        self.describe(tracer, view, corner);
    }

    fn describe(&mut self, tracer: &Tracer, view: &View, corner: [u32; 2]) {
        self.points.corner = corner;
        self.points.wanted = 0;
        let inside = inside_mask(view, corner);
        let scene = tracer.scene();
        let mut facet =
            Facet { triangle: u32::MAX, material: MaterialId(0), reflects: false, normal: Vec3::Y };
        for ray in 0..TILE_RAYS {
            let triangle = self.hits.triangle[ray];
            self.points.disparity[ray] = 1.0 / self.hits.t[ray];
            self.points.triangle[ray] = triangle;
            if triangle == u32::MAX {
                continue;
            }
            if triangle != facet.triangle {
                facet = facet_of(scene, triangle, view.eye);
            }
            self.material[ray] = facet.material;
            self.set_plane(ray, facet.normal);
            self.points.wanted |= u64::from(facet.reflects) << ray;
        }
        self.points.wanted &= inside;
    }

    fn set_plane(&mut self, ray: usize, normal: Vec3) {
        (self.points.normal[0][ray], self.points.normal[1][ray], self.points.normal[2][ray]) = normal.into();
        self.points.height[ray] = normal.dot(self.direction(ray)) * self.hits.t[ray];
    }

    /// The direction of a ray; its component along the viewing axis is one.
    pub fn direction(&self, ray: usize) -> Vec3 {
        let d = &self.rays.directions;
        Vec3::new(d[0][ray], d[1][ray], d[2][ray])
    }
}

/// Bit per pixel of a tile that lies in the picture.
pub(crate) fn inside_mask(view: &View, [x0, y0]: [u32; 2]) -> u64 {
    let columns = (view.size[0] - x0).min(8);
    let rows = (view.size[1] - y0).min(8);
    let row = 0xffu64 >> (8 - columns);
    (0..rows).fold(0, |mask, y| mask | row << (8 * y))
}

fn facet_of(scene: &Scene, triangle: u32, eye: Vec3) -> Facet {
    let material = scene.triangle_materials[triangle as usize];
    let m = &scene.materials[material.0 as usize];
    let [a, b, c] = scene.corners(triangle);
    let normal = (b - a).cross(c - a).normalize_or(Vec3::Y);
    let normal = if normal.dot(a - eye) > 0.0 { -normal } else { normal };
    Facet { triangle, material, reflects: m.diffuse != Vec3::ZERO, normal }
}
