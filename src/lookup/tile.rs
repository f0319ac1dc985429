//! A tile of eight by eight pixels: the surfaces it shows, and the light found for them.

use super::policy::{MAX_AVERAGED_BEST, MAX_JUMP, MAX_LOSS, MIN_COVERAGE, WHOLE_COVERAGE};
use crate::camera::View;
use crate::math::Ray;
use crate::raster::pixel_types::NO_SUPPLIER;
use crate::scene::{MaterialId, Scene};
use crate::trace::{
    Hit, NO_TRIANGLE, RayTile, SurfacePoint, TILE_RAYS, TILE_SIDE, TileHits, Tracer, VisibilityBuffer,
    primary_tile, section::Cap,
};
use arrayvec::ArrayVec;
use glam::Vec3;

/// The surface points of a tile's pixels.
#[derive(Clone, Debug)]
pub struct TilePoints {
    /// Top left pixel.
    pub corner: [u32; 2],
    /// 1 / depth along the viewing axis, in scene units.
    pub disparity: [f32; TILE_RAYS],
    /// Triangle of each point.
    pub triangle: [u32; TILE_RAYS],
    /// Unit normals on the viewer's side, by axis.
    pub normal: [[f32; TILE_RAYS]; 3],
    /// Component along the normal of the vector from the eye to the point; negative.
    pub height: [f32; TILE_RAYS],
    /// One bit per pixel whose light is needed.
    pub wanted: u64,
}

impl TilePoints {
    /// A tile without points.
    pub const NONE: Self = Self {
        corner: [0; 2],
        disparity: [0.0; TILE_RAYS],
        triangle: [NO_TRIANGLE; TILE_RAYS],
        normal: [[0.0; TILE_RAYS]; 3],
        height: [0.0; TILE_RAYS],
        wanted: 0,
    };

    pub(super) fn normal_at(&self, pixel: usize) -> Vec3 {
        Vec3::new(self.normal[0][pixel], self.normal[1][pixel], self.normal[2][pixel])
    }
}

/// The surfaces that the primary rays of a tile meet.
#[derive(Clone, Debug)]
pub struct TileSurfaces {
    rays: RayTile,
    /// First hits.
    pub hits: TileHits,
    /// Points of the surfaces. Light is wanted for those with a diffuse part.
    pub points: TilePoints,
    /// Material of each pixel that shows a surface.
    pub material: [MaterialId; TILE_RAYS],
    /// One bit per pixel whose normal a normal map tilts: its direct light is traced.
    pub tilted: u64,
}

/// What all pixels of a triangle have in common.
#[derive(Clone, Copy)]
struct Facet {
    triangle: u32,
    material: MaterialId,
    is_diffuse: bool,
    normal: Vec3,
}

impl TileSurfaces {
    /// Memory for the tiles of a view.
    pub fn new(view: &View) -> Self {
        Self {
            rays: primary_tile(view, [0, 0]),
            hits: TileHits::NONE,
            points: TilePoints::NONE,
            material: [MaterialId(0); TILE_RAYS],
            tilted: 0,
        }
    }

    /// Finds the surfaces of the tile whose top left pixel is `corner`, of a picture whose
    /// visibility is known. Pixels outside the picture want no light.
    pub fn settle(&mut self, tracer: &Tracer, visible: &VisibilityBuffer, view: &View, corner: [u32; 2]) {
        visible.hits_of_tile(tracer, view, corner, &mut self.rays, &mut self.hits);
        self.describe(tracer, view, corner);
    }

    /// The cap of the tracer's section that a pixel shows instead of a surface.
    pub(super) fn cap(&self, tracer: &Tracer, view: &View, ray: usize) -> Option<Cap> {
        let is_open = tracer.section().is_some() && self.hits.triangle[ray] == NO_TRIANGLE;
        is_open.then(|| tracer.cap(&Ray::new(view.eye, self.direction(ray)))).flatten()
    }

    /// Traces the surfaces of one tile as if clear glass were absent, for an estimate that needs
    /// few tiles.
    pub fn trace_behind_glass(&mut self, tracer: &Tracer, view: &View, corner: [u32; 2]) {
        tracer.closest_behind_glass_in_tile(view, corner, &mut self.rays, &mut self.hits);
        self.describe(tracer, view, corner);
    }

    fn describe(&mut self, tracer: &Tracer, view: &View, corner: [u32; 2]) {
        self.points.corner = corner;
        self.points.wanted = 0;
        let scene = tracer.scene();
        let mut facet =
            Facet { triangle: NO_TRIANGLE, material: MaterialId(0), is_diffuse: false, normal: Vec3::Y };
        for ray in 0..TILE_RAYS {
            let triangle = self.hits.triangle[ray];
            self.points.disparity[ray] = 1.0 / self.hits.t[ray];
            self.points.triangle[ray] = triangle;
            if triangle == NO_TRIANGLE {
                continue;
            }
            if triangle != facet.triangle {
                facet = facet_of(scene, triangle, view.eye);
            }
            self.material[ray] = facet.material;
            self.set_plane(ray, facet.normal);
            self.points.wanted |= u64::from(facet.is_diffuse) << ray;
        }
        self.points.wanted &= inside_mask(view, corner);
        self.tilted = if scene.features.normal_maps { self.tilted_pixels(scene) } else { 0 };
    }

    /// The wanted pixels, one bit each, whose normal a normal map tilts.
    fn tilted_pixels(&self, scene: &Scene) -> u64 {
        let is_tilted = |&ray: &usize| {
            let is_mapped = || scene.materials[self.material[ray].0 as usize].detail.normal.is_some();
            self.points.wanted >> ray & 1 == 1 && is_mapped() && {
                let Hit { triangle, b1, b2, .. } = self.hit(ray);
                SurfacePoint::new(scene, triangle, [b1, b2], self.direction(ray)).is_tilted()
            }
        };
        (0..TILE_RAYS).filter(is_tilted).fold(0, |pixels, ray| pixels | 1 << ray)
    }

    fn set_plane(&mut self, ray: usize, normal: Vec3) {
        (self.points.normal[0][ray], self.points.normal[1][ray], self.points.normal[2][ray]) = normal.into();
        self.points.height[ray] = normal.dot(self.direction(ray)) * self.hits.t[ray];
    }

    /// The hit of a ray, without its distance.
    #[inline(always)]
    pub(crate) fn hit(&self, ray: usize) -> Hit {
        let [b1, b2] = [self.hits.b1[ray], self.hits.b2[ray]];
        Hit { t: 0.0, triangle: self.hits.triangle[ray], b1, b2 }
    }

    /// Direction of a ray; its component along the viewing axis is one.
    pub fn direction(&self, ray: usize) -> Vec3 {
        let d = &self.rays.directions;
        Vec3::new(d[0][ray], d[1][ray], d[2][ray])
    }
}

/// One bit per pixel of a tile that lies inside the picture.
pub(super) fn inside_mask(view: &View, [x0, y0]: [u32; 2]) -> u64 {
    let columns = (view.size[0] - x0).min(8);
    let rows = (view.size[1] - y0).min(8);
    let row = 0xffu64 >> (8 - columns);
    (0..rows).fold(0, |mask, y| mask | row << (8 * y))
}

/// The pixels of a tile that lie inside a picture: index in the tile, and row-major index in the
/// picture.
#[inline(always)]
pub(crate) fn pixels_of_tile(
    [x0, y0]: [u32; 2],
    [width, height]: [u32; 2],
) -> impl Iterator<Item = (usize, usize)> {
    (0..TILE_RAYS).filter_map(move |i| {
        let (x, y) = (x0 + (i % TILE_SIDE) as u32, y0 + (i / TILE_SIDE) as u32);
        (x < width && y < height).then(|| (i, y as usize * width as usize + x as usize))
    })
}

fn facet_of(scene: &Scene, triangle: u32, eye: Vec3) -> Facet {
    let material = scene.triangle_materials[triangle as usize];
    let m = &scene.materials[material.0 as usize];
    let [a, b, c] = scene.corners(triangle);
    let normal = (b - a).cross(c - a).normalize_or(Vec3::Y);
    let normal = if normal.dot(a - eye) > 0.0 { -normal } else { normal };
    Facet { triangle, material, is_diffuse: m.has_base(), normal }
}

/// The references chosen for a pixel. The next tile most likely shows the same surface and reuses
/// the choice.
#[derive(Clone, Debug)]
pub(super) struct Choice {
    /// The directory's cell of the pixel's point.
    pub(super) cell: u32,
    /// Unit normal of the point.
    pub(super) normal: Vec3,
    /// Slots of the references, finest first.
    pub(super) best: ArrayVec<u8, MAX_AVERAGED_BEST>,
}

/// The light that arrives at a tile's surface points.
#[derive(Clone, Debug)]
pub struct TileLight {
    /// Radiance of a white surface in light straight from the lights, by channel; undefined for
    /// pixels that are not `known`.
    pub light: [[f32; TILE_RAYS]; 3],
    /// Smooth light in the same units; zero without bounces.
    pub smooth: [[f32; TILE_RAYS]; 3],
    pub(super) weight: [f32; TILE_RAYS],
    /// The largest share of bilinear weight that any reference's samples had, 0..1: below one near
    /// an edge, where light is extrapolated.
    pub coverage: [f32; TILE_RAYS],
    /// By how much samples differ, as a share of the brightest, where they fall into two groups as
    /// on both sides of a shadow's edge; zero where they vary smoothly, as in noise and penumbra,
    /// or by too little to matter.
    pub jump: [f32; TILE_RAYS],
    /// By how much samples differ times how much of that interpolation smooths away: the least of
    /// all references read.
    pub smoothed: [f32; TILE_RAYS],
    /// The slot of the reference with the largest weight; [`NO_SUPPLIER`] where none of the tile's
    /// references knows the pixel.
    pub slot: [u8; TILE_RAYS],
    pub(super) best_weight: [f32; TILE_RAYS],
    /// One bit per pixel whose light was found.
    pub known: u64,
    /// One bit per pixel whose light was interpolated, so that no further reference is read.
    pub(super) covered: u64,
    pub(super) choice: Option<Choice>,
    /// Noise of the references, relative to that of sixteen shadow rays.
    pub(super) noise: f32,
}

impl TileLight {
    /// A tile without light.
    pub const NONE: Self = Self {
        light: [[0.0; TILE_RAYS]; 3],
        smooth: [[0.0; TILE_RAYS]; 3],
        weight: [0.0; TILE_RAYS],
        coverage: [0.0; TILE_RAYS],
        jump: [0.0; TILE_RAYS],
        smoothed: [f32::INFINITY; TILE_RAYS],
        slot: [NO_SUPPLIER; TILE_RAYS],
        best_weight: [0.0; TILE_RAYS],
        known: 0,
        covered: 0,
        choice: None,
        noise: 1.0,
    };

    /// Sets the light of a pixel, which is known from then on.
    pub(super) fn set(&mut self, pixel: usize, light: Vec3, smooth: Vec3) {
        (self.light[0][pixel], self.light[1][pixel], self.light[2][pixel]) = light.into();
        (self.smooth[0][pixel], self.smooth[1][pixel], self.smooth[2][pixel]) = smooth.into();
        self.known |= 1 << pixel;
    }

    /// The pixels, one bit each, for which all samples around them were found.
    pub(super) fn whole(&self) -> u64 {
        let is_whole = |&pixel: &usize| self.coverage[pixel] >= WHOLE_COVERAGE;
        (0..TILE_RAYS).filter(is_whole).fold(0, |pixels, pixel| pixels | 1 << pixel)
    }

    /// True where the light of a known pixel is a guess: extrapolated beyond the samples, or
    /// interpolated between samples that differ.
    #[inline(always)]
    pub fn is_guess(&self, pixel: usize) -> bool {
        self.is_extrapolated(pixel)
            || self.jump[pixel] > MAX_JUMP * self.noise
            || self.smoothed[pixel] > MAX_LOSS * self.noise
    }

    /// The known pixels, one bit each, whose light is a guess.
    pub(super) fn guesses(&self) -> u64 {
        let is_guess = |&pixel: &usize| self.known >> pixel & 1 == 1 && self.is_guess(pixel);
        (0..TILE_RAYS).filter(is_guess).fold(0, |pixels, pixel| pixels | 1 << pixel)
    }

    /// True where the light of a known pixel is extrapolated beyond the samples.
    #[inline(always)]
    pub(super) fn is_extrapolated(&self, pixel: usize) -> bool {
        self.coverage[pixel] < MIN_COVERAGE
    }

    /// The smooth light of a known pixel, as the radiance of a white surface.
    #[inline(always)]
    pub fn smooth_at(&self, pixel: usize) -> Vec3 {
        Vec3::new(self.smooth[0][pixel], self.smooth[1][pixel], self.smooth[2][pixel])
    }

    /// The light straight from the lights of a known pixel, as the radiance of a white surface.
    pub fn at(&self, pixel: usize) -> Vec3 {
        Vec3::new(self.light[0][pixel], self.light[1][pixel], self.light[2][pixel])
    }
}
