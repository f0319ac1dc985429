//! The light arriving at a surface point, from references that saw the point.
//!
//! The reverse of the warp: the point is projected into a reference, and of the four samples around it those that lie
//! on the point's own surface are gathered with bilinear weights. Source: Nehab et al., "Accelerating Real-Time
//! Shading with Reverse Reprojection Caching", Graphics Hardware 2007. We differ: several references are averaged,
//! the finer ones counting more, and what is gathered is the arriving light alone.

use super::ReferenceFrame;
use super::cache::CachedReference;
use super::directory::{Directory, MOST_SLOTS, PackedNormal, SlotMask};
use super::frame::NEAREST_DEPTH;
use super::light::{LightScale, UNLIT};
use crate::trace::SceneEpoch;
use glam::{Mat3, Vec3};

/// A sample belongs to the point's surface where it lies off the plane of the point by less than this share of the
/// distance between samples: a bend of six degrees from one sample to the next. Relative to the sample distance, so it
/// means the same at every depth, size of picture and scale of scene.
pub const PLANE_TOLERANCE: f32 = 0.1;

/// Added to it, relative to depth: the rounding of a distance along a ray, some 64 steps of an f32.
pub const DEPTH_ROUNDING: f32 = 4e-6;

/// Bilinear weights that agree must sum to this in a reference.
pub const LEAST_WEIGHT: f32 = 1.0 / 16.0;

/// A reference whose samples are farther apart than so many pixels of the view, in area, knows nothing of a pixel.
pub const MOST_MAGNIFICATION: f32 = 1024.0;

/// References averaged for a point met after a mirror or behind glass; more would cost more than their noise is worth.
const ENOUGH: usize = 3;

/// A reference made ready for look-ups.
#[derive(Debug)]
pub(super) struct LookupReference<'a> {
    pub(super) frame: &'a ReferenceFrame,
    pub(super) disparity: &'a [f32],
    pub(super) light: &'a [u32],
    triangle: &'a [u32],
    normals: &'a [PackedNormal],
    pub(super) scale: LightScale,
    /// Picture coordinates from an offset from the eye, homogeneous; their third is depth.
    pixel_from_scene: Mat3,
    scene_from_pixel: Mat3,
    eye: Vec3,
    /// Distance of two samples at depth one.
    pub(super) step: f32,
    pub(super) size: [f32; 2],
}

impl<'a> LookupReference<'a> {
    fn new(frame: &'a ReferenceFrame, normals: &'a [PackedNormal]) -> Self {
        let view = &frame.view;
        let (light, scale) = frame.packed_light();
        Self {
            frame,
            disparity: frame.disparity(),
            light,
            triangle: frame.triangle(),
            normals,
            scale,
            pixel_from_scene: view.scene_from_pixel_f64.inverse().as_mat3(),
            scene_from_pixel: view.scene_from_pixel,
            eye: view.eye,
            step: view.scene_from_pixel.x_axis.length(),
            size: view.size.map(|s| s as f32),
        }
    }

    /// True where a sample lies on a triangle, or on one that is turned like it.
    #[inline(always)]
    pub(super) fn is_alike(&self, sample: usize, triangle: u32) -> bool {
        let other = self.triangle[sample];
        other == triangle
            || match (self.normals.get(other as usize), self.normals.get(triangle as usize)) {
                (Some(a), Some(b)) => a.is_like(*b),
                _ => false,
            }
    }

    /// The light at a point with a unit normal on the side that is asked for, and how much it is worth: samples per unit
    /// of surface, in scene units, squared. `None` where this reference does not see that side of the point.
    #[inline]
    pub(super) fn light_at(&self, position: Vec3, normal: Vec3, triangle: u32) -> Option<(Vec3, f32)> {
        let offset = position - self.eye;
        let height = normal.dot(offset);
        let q = self.pixel_from_scene * offset;
        if !(q.z > NEAREST_DEPTH && height < 0.0) {
            return None;
        }
        let (x, y) = (q.x / q.z, q.y / q.z);
        if !(x >= 0.0 && y >= 0.0 && x < self.size[0] && y < self.size[1]) {
            return None;
        }
        let tolerance = PLANE_TOLERANCE * self.step * q.z / -height + DEPTH_ROUNDING;
        let plane = self.scene_from_pixel.transpose() * (normal / height);
        let (sum, weight) = self.gather(x, y, plane, tolerance, triangle);
        let density = -height / (self.step * self.step * q.z * q.z * q.z);
        (weight >= LEAST_WEIGHT).then(|| (sum / weight, weight * density * density))
    }

    /// Sums the light of the samples around (x, y) that lie on a plane, given as disparity by picture coordinates.
    #[inline]
    fn gather(&self, x: f32, y: f32, plane: Vec3, tolerance: f32, triangle: u32) -> (Vec3, f32) {
        let ([x0, wx], [y0, wy]) = (corner(x, self.size[0]), corner(y, self.size[1]));
        let base = y0 as usize * self.size[0] as usize + x0 as usize;
        let (mut sum, mut total) = (Vec3::ZERO, 0.0);
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let at = base + dy * self.size[0] as usize + dx;
            let expected = plane.dot(Vec3::new(x0 + 0.5 + dx as f32, y0 + 0.5 + dy as f32, 1.0));
            let agrees = (self.disparity[at] - expected).abs() <= tolerance * expected;
            if agrees && self.light[at] != UNLIT && self.is_alike(at, triangle) {
                let weight = (if dx == 0 { 1.0 - wx } else { wx }) * (if dy == 0 { 1.0 - wy } else { wy });
                sum += weight * self.scale.unpack(self.light[at]);
                total += weight;
            }
        }
        (sum, total)
    }
}

/// The first of the two samples around a picture coordinate, and the weight of the second.
#[inline(always)]
fn corner(x: f32, size: f32) -> [f32; 2] {
    let at = (x - 0.5).clamp(0.0, size - 1.0);
    let first = at.floor().min(size - 2.0);
    [first, at - first]
}

/// The references that a frame may ask.
#[derive(Debug)]
pub struct LookupSet<'a> {
    pub(super) directory: &'a Directory,
    /// By slot.
    pub(super) references: Vec<Option<LookupReference<'a>>>,
    pub(super) usable: SlotMask,
}

impl<'a> LookupSet<'a> {
    /// All references of an epoch that are switched on. Those smaller than two pixels a side are of no use.
    pub fn new(directory: &'a Directory, entries: &'a [CachedReference], epoch: SceneEpoch) -> Self {
        let mut references = Vec::new();
        references.resize_with(MOST_SLOTS, || None);
        let mut usable = 0;
        for entry in entries.iter().filter(|e| e.is_usable(epoch)) {
            if entry.frame.view.size.iter().all(|&s| s >= 2) {
                references[entry.slot] = Some(LookupReference::new(&entry.frame, directory.normals()));
                usable |= 1 << entry.slot;
            }
        }
        Self { directory, references, usable }
    }

    /// References that may be asked.
    pub fn len(&self) -> usize {
        self.usable.count_ones() as usize
    }

    /// True where there is nothing to ask.
    pub fn is_empty(&self) -> bool {
        self.usable == 0
    }

    /// The light arriving at a point in scene space with a unit normal on the side that is asked for, as the radiance of
    /// a white surface: the mean over the first three references that see it, weighted by the square of their sample density.
    /// `None` where no reference does.
    pub fn light_at(&self, position: Vec3, normal: Vec3, triangle: u32) -> Option<Vec3> {
        let mut mask = self.directory.mask(self.directory.cell_of(position)) & self.usable;
        let (mut sum, mut total, mut found) = (Vec3::ZERO, 0.0, 0);
        while mask != 0 && found < ENOUGH {
            let slot = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            let Some(reference) = &self.references[slot] else { continue };
            if let Some((light, weight)) = reference.light_at(position, normal, triangle) {
                sum += weight * light;
                total += weight;
                found += 1;
            }
        }
        (total > 0.0).then(|| sum / total)
    }
}
