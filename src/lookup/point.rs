//! The light arriving at a surface point, from references that saw the point.
//!
//! The reverse of the warp: the point is projected into a reference, and those of the four samples
//! around it that lie on the point's surface are averaged with bilinear weights. Source: Nehab et
//! al., "Accelerating Real-Time Shading with Reverse Reprojection Caching", Graphics Hardware 2007.
//! We differ: several references are averaged, finer ones with larger weights, and only the
//! arriving light is reused, not the reflected radiance.

use super::found::{FoundLight, Sampled, Sums, spread_and_jump};
use super::point_cache::SurfaceKey;
use super::policy::{
    DEPTH_ROUNDING, MAX_AVERAGED_REFERENCES, MAX_FOUND, MAX_JUMP, MAX_LOSS, MAX_NOISE_SPREAD,
    MAX_SMOOTH_SPREAD, MIN_COVERAGE, MIN_WEIGHT, PLANE_TOLERANCE,
};
use crate::camera::NEAREST_DEPTH;
use crate::cells::SurfaceCells;
use crate::math::rounding::floor;
use crate::raster::rgb9e5::Rgb9e5Scale;
use crate::reference::directory::{Directory, MAX_SLOTS, PackedNormal, SlotMask};
use crate::reference::{CachedReference, ReferenceCache, ReferenceFrame, ReferenceSnapshot, light::UNLIT};
use crate::trace::{CachedLight, LightSettings, SceneEpoch, TraceSettings, Tracer};
use arrayvec::ArrayVec;
use glam::{Mat3, Vec3};

/// A reference prepared for look-ups.
#[derive(Debug)]
pub(super) struct LookupReference<'a> {
    pub(super) frame: &'a ReferenceFrame,
    pub(super) disparity: &'a [f32],
    pub(super) light: &'a [u32],
    /// Smooth light; empty where the reference holds none.
    pub(super) smooth: &'a [u32],
    pub(super) triangle: &'a [u32],
    normals: &'a [PackedNormal],
    pub(super) scale: Rgb9e5Scale,
    pub(super) smooth_scale: Rgb9e5Scale,
    /// Homogeneous picture coordinates from an offset from the eye; the third is depth.
    pub(super) pixel_from_scene: Mat3,
    pub(super) scene_from_pixel: Mat3,
    pub(super) eye: Vec3,
    /// Distance between two samples at depth one.
    pub(super) step: f32,
    pub(super) size: [f32; 2],
    /// Samples that differ by more than this share lie on both sides of a shadow's edge:
    /// [`MAX_NOISE_SPREAD`], scaled by the noise of the reference.
    pub(super) wide: f32,
    /// Samples of a pixel over those of the best reference of the set, 0..1: the weight of its
    /// light among that of others.
    pub(super) quality: f32,
}

impl<'a> LookupReference<'a> {
    /// Prepares the direct light of some pixels of a reference, with their smooth light where
    /// `has_smooth`.
    pub(super) fn new(
        frame: &'a ReferenceFrame,
        (light, has_smooth): (&'a [u32], bool),
        normals: &'a [PackedNormal],
        most_samples: u32,
    ) -> Self {
        let view = &frame.view;
        let scale = frame.packed_light().1;
        let (smooth, smooth_scale) = frame.packed_smooth();
        let smooth = if has_smooth { smooth } else { &[] };
        Self {
            frame,
            disparity: frame.disparity(),
            light,
            smooth,
            triangle: frame.triangle(),
            normals,
            scale,
            smooth_scale,
            pixel_from_scene: view.scene_from_pixel_f64.inverse().as_mat3(),
            scene_from_pixel: view.scene_from_pixel,
            eye: view.eye,
            step: view.scene_from_pixel.x_axis.length(),
            size: view.size.map(|s| s as f32),
            wide: MAX_NOISE_SPREAD * frame.settings.noise(),
            quality: frame.settings.samples as f32 / most_samples.max(1) as f32,
        }
    }

    /// True where a sample lies on a triangle, or on one with nearly the same normal.
    #[inline(always)]
    pub(super) fn is_alike(&self, sample: usize, triangle: u32) -> bool {
        let other = self.triangle[sample];
        other == triangle
            || match (self.normals.get(other as usize), self.normals.get(triangle as usize)) {
                (Some(a), Some(b)) => a.is_like(*b),
                _ => false,
            }
    }

    /// The light at a point whose unit normal points to the side that is viewed. `None` where this
    /// reference does not see that side of the point. Spread and jump are zero unless `CHECKS`.
    /// Samples whose position `serves` refuses are left out.
    #[inline]
    pub(super) fn light_at<const CHECKS: bool>(
        &self,
        position: Vec3,
        normal: Vec3,
        triangle: u32,
        serves: impl Fn(Vec3) -> bool,
    ) -> Option<Sampled> {
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
        let sums = self.gather::<CHECKS>([x, y], plane, tolerance, triangle, serves);
        let Sums { coverage, spread_and_jump: [spread, jump], open, .. } = sums;
        let density = -height / (self.step * self.step * q.z * q.z * q.z);
        let weight = coverage * density * density * self.quality;
        let [light, smooth] = [sums.light, sums.smooth].map(|sum| sum / coverage);
        let sampled = Sampled { light, smooth, weight, density, coverage, spread, jump, open };
        (coverage >= MIN_WEIGHT).then_some(sampled)
    }

    /// Sums the direct and the smooth light of the samples around (x, y) that lie on a plane, given
    /// as disparity by picture coordinates.
    #[inline]
    fn gather<const CHECKS: bool>(
        &self,
        [x, y]: [f32; 2],
        plane: Vec3,
        tolerance: f32,
        triangle: u32,
        serves: impl Fn(Vec3) -> bool,
    ) -> Sums {
        let ([x0, wx], [y0, wy]) = (corner(x, self.size[0]), corner(y, self.size[1]));
        let base = y0 as usize * self.size[0] as usize + x0 as usize;
        let ([mut sum, mut smooth], [mut total, mut open]) = ([Vec3::ZERO; 2], [0.0; 2]);
        let (mut least, mut most) = (f32::INFINITY, 0.0f32);
        let mut brightness = ArrayVec::<f32, 4>::new();
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let at = base + dy * self.size[0] as usize + dx;
            let in_picture = Vec3::new(x0 + 0.5 + dx as f32, y0 + 0.5 + dy as f32, 1.0);
            let expected = plane.dot(in_picture);
            let agrees = (self.disparity[at] - expected).abs() <= tolerance * expected;
            let place = || self.eye + self.scene_from_pixel * in_picture / self.disparity[at];
            let weight = (if dx == 0 { 1.0 - wx } else { wx }) * (if dy == 0 { 1.0 - wy } else { wy });
            if agrees && self.light[at] != UNLIT && self.is_alike(at, triangle) && serves(place()) {
                let light = self.scale.unpack(self.light[at]);
                sum += weight * light;
                if let Some(&word) = self.smooth.get(at) {
                    let light = self.smooth_scale.unpack(word);
                    smooth += weight * light;
                    (least, most) = (least.min(light.max_element()), most.max(light.max_element()));
                }
                total += weight;
                if CHECKS {
                    brightness.push(light.max_element());
                }
            } else if self.disparity[at] < expected && !agrees {
                open += weight;
            }
        }
        if most - least > most * MAX_SMOOTH_SPREAD {
            return Sums::default();
        }
        let smooth_brightness = smooth.max_element() / f32::max(total, f32::MIN_POSITIVE);
        let spread_and_jump = spread_and_jump(&mut brightness, self.wide, smooth_brightness);
        Sums { light: sum, smooth, coverage: total, open, spread_and_jump }
    }
}

/// The first of the two samples around a picture coordinate, and the bilinear weight of the second.
#[inline(always)]
fn corner(x: f32, size: f32) -> [f32; 2] {
    let at = (x - 0.5).clamp(0.0, size - 1.0);
    let first = (floor(at) as f32).min(size - 2.0);
    [first, at - first]
}

/// Packed direct light of the pixels of a reference that a set holds, and whether it holds their
/// smooth light too.
type Words<'a> = fn(&'a ReferenceFrame) -> (&'a [u32], bool);

/// The references that a frame may look light up in.
#[derive(Debug)]
pub struct LookupSet<'a> {
    pub(super) directory: &'a Directory,
    /// References by slot.
    pub(super) references: Vec<Option<LookupReference<'a>>>,
    pub(super) usable: SlotMask,
    /// Noise of the noisiest reference, relative to that of sixteen shadow rays.
    pub(super) noise: f32,
    /// Where the paths of smooth light may end.
    pub(super) cells: Option<&'a SurfaceCells>,
    /// Direct light that holds, also where smooth light is stale; `None` where it nowhere is.
    pub(super) held: Option<Box<Self>>,
    /// Light that no longer holds, to be shown until there is other; `None` where there is none.
    preview: Option<Box<Self>>,
}

impl<'a> LookupSet<'a> {
    /// All enabled references of a cache that belong to an epoch. References smaller than two
    /// pixels a side are left out, because a look-up interpolates between two samples per axis.
    pub fn new(cache: &'a ReferenceCache, epoch: SceneEpoch) -> Self {
        Self::from_parts(cache.directory(), cache.entries(), cache.cells(), epoch)
    }

    /// No references, with the cells of a cache: for light that is to be traced again.
    pub(crate) fn without_references(cache: &'a ReferenceCache, epoch: SceneEpoch) -> Self {
        Self { usable: 0, ..Self::from_parts(cache.directory(), &[], cache.cells(), epoch) }
    }

    /// The same references as [`Self::new`], from a snapshot of a cache that another thread may
    /// use.
    pub fn of_snapshot(known: &'a ReferenceSnapshot, epoch: SceneEpoch) -> Self {
        Self::from_parts(known.directory(), known.entries(), known.cells(), epoch)
    }

    fn from_parts(
        directory: &'a Directory,
        entries: &'a [CachedReference],
        cells: Option<&'a SurfaceCells>,
        epoch: SceneEpoch,
    ) -> Self {
        let of = |words: Words<'a>| Self::of_words(directory, entries, cells, (epoch, words));
        let mut set = of(|frame| (frame.packed_light().0, true));
        if entries.iter().any(|e| e.is_usable(epoch) && e.frame.stale() > 0) {
            set.held = Some(Box::new(of(|frame| (frame.held_direct(), false))));
            set.preview = Some(Box::new(of(|frame| (frame.stale_words(), true))));
        }
        set
    }

    /// The pixels of references that `words` returns.
    fn of_words(
        directory: &'a Directory,
        entries: &'a [CachedReference],
        cells: Option<&'a SurfaceCells>,
        (epoch, words): (SceneEpoch, Words<'a>),
    ) -> Self {
        let mut references = Vec::new();
        references.resize_with(MAX_SLOTS, || None);
        let (mut usable, mut noise) = (0, 1.0f32);
        let entries = || entries.iter().filter(|e| e.is_usable(epoch) && !words(&e.frame).0.is_empty());
        let most = entries().map(|e| e.frame.settings.samples).max().unwrap_or(1);
        for entry in entries() {
            if entry.frame.view.size.iter().all(|&s| s >= 2) {
                references[entry.slot] =
                    Some(LookupReference::new(&entry.frame, words(&entry.frame), directory.normals(), most));
                usable |= 1 << entry.slot;
                noise = noise.max(entry.frame.settings.noise());
            }
        }
        Self { directory, references, usable, noise, cells, held: None, preview: None }
    }

    /// How light that is not known is traced for a pixel of this size on the surface, scene units.
    pub(crate) fn light_settings(&self, trace: &TraceSettings, footprint: f32) -> LightSettings<'_> {
        let cache = self.cells.map(|cells| cells as &dyn CachedLight);
        LightSettings { trace: *trace, cache, footprint, direct: None }
    }

    /// True where references hold light that is stale.
    pub(crate) fn has_preview(&self) -> bool {
        self.preview.is_some()
    }

    /// The light that arrived at a point before the scene changed.
    pub(crate) fn preview_at(&self, point: &SurfaceKey, triangle: u32) -> Option<Vec3> {
        let found = self.preview.as_ref()?.light_at(point, triangle)?;
        Some(found.light + found.smooth)
    }

    /// Packed normal of each triangle.
    pub(crate) fn normals(&self) -> &'a [PackedNormal] {
        self.directory.normals()
    }

    /// True where a reference holds smooth light.
    pub(super) fn holds_smooth(&self) -> bool {
        self.references.iter().flatten().any(|reference| !reference.smooth.is_empty())
    }

    /// The number of references.
    pub fn len(&self) -> usize {
        self.usable.count_ones() as usize
    }

    /// True where there are no references.
    pub fn is_empty(&self) -> bool {
        self.usable == 0
    }

    /// The light arriving at a point of a triangle: the mean over references that see the point,
    /// weighted by the square of their sample density. Three references are averaged, and more
    /// while none is as fine as the point's footprint. `None` where no reference sees it.
    pub fn light_at(&self, point: &SurfaceKey, triangle: u32) -> Option<FoundLight> {
        let SurfaceKey { position, normal, .. } = *point;
        self.find::<true>(point, |reference| reference.light_at::<true>(position, normal, triangle, |_| true))
    }

    /// The light as [`Self::light_at`] finds it in three references at most, never marked a guess,
    /// and without that of samples that a wall hides from the point.
    pub fn unchecked_light_at(
        &self,
        tracer: &Tracer,
        point: &SurfaceKey,
        triangle: u32,
    ) -> Option<FoundLight> {
        self.find::<false>(point, |reference| reference.light_seen_at(tracer, point, triangle))
    }

    /// The mean of the light that `light_at` finds in the references of a point's cell.
    #[inline]
    fn find<const CHECKS: bool>(
        &self,
        point: &SurfaceKey,
        light_at: impl Fn(&LookupReference<'a>) -> Option<Sampled>,
    ) -> Option<FoundLight> {
        let SurfaceKey { position, footprint, .. } = *point;
        let mut mask = self.directory.mask(self.directory.cell_of(position)) & self.usable;
        let ([mut sum, mut smooth], mut total, mut found) = ([Vec3::ZERO; 2], 0.0, 0);
        let (mut coverage, mut jump, mut loss) = (0.0f32, 0.0f32, f32::INFINITY);
        let mut finest = 0.0f32;
        while mask != 0 && (found < MAX_AVERAGED_REFERENCES || CHECKS && finest < 0.5 && found < MAX_FOUND) {
            let slot = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            let Some(reference) = &self.references[slot] else { continue };
            if let Some(sampled) = light_at(reference) {
                sum += sampled.weight * sampled.light;
                smooth += sampled.weight * sampled.smooth;
                total += sampled.weight;
                found += 1;
                let fine = (sampled.density * footprint * footprint).min(1.0);
                finest = finest.max(fine);
                coverage = coverage.max(sampled.coverage);
                jump = jump.max(sampled.jump);
                loss = loss.min(sampled.spread * (1.0 - fine));
            }
        }
        let is_far_off = jump > MAX_JUMP * self.noise || loss > MAX_LOSS * self.noise;
        let is_guess = CHECKS && (coverage < MIN_COVERAGE || is_far_off);
        (total > 0.0).then(|| FoundLight { light: sum / total, smooth: smooth / total, is_guess })
    }
}
