//! A reference image.
//!
//! Source: the paper, section 3: a reference pixel holds diffuse radiance, the intersection point of its primary ray
//! and the number of reflections. We differ: the point is stored as disparity (1 / depth) along the pixel's ray,
//! which is exact relative to the reference's own eye wherever the scene lies and makes a sky pixel a direction
//! (disparity zero); the triangle is kept, so that a pixel knows its normal and material; and of the diffuse radiance
//! only the arriving light is stored, so that textures are never resampled. A reference may be sparse: pixels whose
//! light older references already know are not lit again.

mod damage;

use crate::camera::{Camera, NEAREST_DEPTH, View};
use crate::reference::DisparityTiles;
use crate::reference::light::{LightScale, UNLIT};
use crate::trace::parallel::{Stop, tile_order, trace_pixels};
use crate::trace::{
    ILL_CONDITIONED, NO_TRIANGLE, PixelTrace, RayCounts, SceneEpoch, SurfacePoint, TraceSettings, Tracer,
};
use glam::Vec3;
use std::time::Instant;

/// A traced picture that lends its pixels to other views. Structure of arrays, row-major.
#[derive(Clone, Debug)]
pub struct ReferenceFrame {
    /// Where it was taken.
    pub camera: Camera,
    /// The same in scene space, with the size.
    pub view: View,
    /// The state of the scene it shows.
    pub epoch: SceneEpoch,
    /// What it was traced with.
    pub settings: TraceSettings,
    /// Seconds it took.
    pub secs: f64,
    /// Rays it took.
    pub rays: RayCounts,
    disparity: Vec<f32>,
    tiles: DisparityTiles,
    triangle: Vec<u32>,
    light: Vec<u32>,
    light_scale: LightScale,
    /// Empty where no surface of the scene is specular.
    reflections: Vec<u8>,
    lit: usize,
    is_dense: bool,
}

impl ReferenceFrame {
    /// Memory per pixel at most: disparity, triangle, light, and in scenes with mirrors or glass a count.
    pub const BYTES_PER_PIXEL: usize =
        size_of::<f32>() + size_of::<u32>() + size_of::<u32>() + size_of::<u8>();

    /// Memory that tracing one takes per pixel, beside what it keeps.
    pub const TRACING_BYTES_PER_PIXEL: usize = size_of::<Option<PixelTrace>>() + size_of::<u32>();

    /// Traces a reference on the current thread pool, every pixel of it. `None` after a stop.
    pub fn trace(
        tracer: &Tracer,
        camera: &Camera,
        size: [u32; 2],
        settings: &TraceSettings,
        stop: Stop<'_>,
    ) -> Option<Self> {
        let start = Instant::now();
        let view = View::new(camera, &tracer.scene().frame, size);
        let order = tile_order(size);
        let mut traced = Vec::new();
        let (rays, complete) = trace_pixels(&order, &mut traced, stop, |pixel, rays| {
            tracer.reference_pixel(&view, pixel, settings, rays)
        });
        if !complete {
            return None;
        }
        let mut frame = Self::empty(tracer, camera, view, settings);
        for (&pixel, traced) in order.iter().zip(traced.iter().flatten()) {
            frame.store_hit(pixel as usize, traced.hit.map(|hit| (hit.t, hit.triangle)), traced.reflections);
        }
        frame.store_lights(&order, traced.iter().flatten().map(|t| t.light));
        (frame.rays, frame.is_dense) = (rays, true);
        frame.forget_ill_conditioned(tracer);
        frame.bound_tiles();
        frame.secs = start.elapsed().as_secs_f64();
        Some(frame)
    }

    /// A reference that knows nothing yet.
    pub(crate) fn empty(tracer: &Tracer, camera: &Camera, view: View, settings: &TraceSettings) -> Self {
        let count = view.pixel_count();
        let features = tracer.scene().features;
        Self {
            camera: *camera,
            view,
            epoch: tracer.epoch(),
            settings: *settings,
            secs: 0.0,
            rays: RayCounts::default(),
            disparity: vec![f32::NAN; count],
            tiles: DisparityTiles::default(),
            triangle: vec![NO_TRIANGLE; count],
            light: vec![UNLIT; count],
            light_scale: LightScale::for_largest(1.0),
            reflections: if features.mirror || features.glass { vec![0; count] } else { Vec::new() },
            lit: 0,
            is_dense: false,
        }
    }

    /// To be called once all hits are stored.
    pub(crate) fn bound_tiles(&mut self) {
        self.tiles = DisparityTiles::new(&self.disparity, self.view.size);
    }

    /// Hits on needles are not lent: where they lie is a matter of rounding. Scenes without needles pay nothing.
    pub(crate) fn forget_ill_conditioned(&mut self, tracer: &Tracer) {
        /// A triangle this thin is ill-conditioned only when seen within half a degree of its plane.
        const THIN: f64 = 1e-3;
        if tracer.scene().conditioning.thinnest >= THIN {
            return;
        }
        for (pixel, &triangle) in (0..).zip(&self.triangle) {
            let direction = self.view.direction_of_pixel(pixel);
            if triangle != NO_TRIANGLE && tracer.condition(direction, triangle) < ILL_CONDITIONED {
                self.disparity[pixel as usize] = f32::NAN;
            }
        }
    }

    /// The light of the pixels listed. One whose light is not a number must not be reused: it loses its disparity, and
    /// no comparison lets a disparity of NaN through.
    pub(crate) fn store_lights(&mut self, pixels: &[u32], lights: impl Iterator<Item = Vec3> + Clone) {
        let largest = lights.clone().filter(|l| l.is_finite()).map(Vec3::max_element).fold(0.0, f32::max);
        self.light_scale = LightScale::for_largest(largest);
        for (&pixel, light) in pixels.iter().zip(lights) {
            let pixel = pixel as usize;
            if light.is_finite() {
                self.light[pixel] = self.light_scale.pack(light);
                self.lit += 1;
            } else {
                self.disparity[pixel] = f32::NAN;
            }
        }
    }

    /// Forgets the light of a square of pixels; returns how many had some.
    pub(crate) fn forget_light(&mut self, [x0, y0]: [u32; 2], side: u32) -> usize {
        let [width, height] = self.view.size;
        let mut forgotten = 0;
        for y in y0..(y0 + side).min(height) {
            for x in x0..(x0 + side).min(width) {
                let word = &mut self.light[(y * width + x) as usize];
                forgotten += usize::from(std::mem::replace(word, UNLIT) != UNLIT);
            }
        }
        self.lit = self.lit.saturating_sub(forgotten);
        self.is_dense &= forgotten == 0;
        forgotten
    }

    /// What a pixel sees, by distance and triangle, without its light.
    pub(crate) fn store_hit(&mut self, pixel: usize, hit: Option<(f32, u32)>, reflections: u32) {
        match hit {
            None => self.disparity[pixel] = 0.0,
            Some((t, triangle)) if t >= NEAREST_DEPTH => {
                self.disparity[pixel] = 1.0 / t;
                self.triangle[pixel] = triangle;
                if let Some(count) = self.reflections.get_mut(pixel) {
                    *count = u8::try_from(reflections).unwrap_or(u8::MAX);
                }
            }
            Some(_) => {}
        }
    }

    /// Memory held, bytes.
    pub fn bytes(&self) -> usize {
        self.view.pixel_count() * 12 + self.reflections.len()
    }

    /// Pixels whose light this reference holds.
    pub fn lit(&self) -> usize {
        self.lit
    }

    /// True where every pixel was lit, as the paper's references are.
    pub fn is_dense(&self) -> bool {
        self.is_dense
    }

    /// True where a pixel's light is held.
    #[inline(always)]
    pub fn has_light(&self, pixel: u32) -> bool {
        self.light[pixel as usize] != UNLIT
    }

    /// The light arriving at a pixel's surface, as the radiance of a white one; of a pixel that has it.
    #[inline(always)]
    pub fn light(&self, pixel: u32) -> Vec3 {
        self.light_scale.unpack(self.light[pixel as usize])
    }

    /// The stored words and their scale.
    pub(crate) fn packed_light(&self) -> (&[u32], LightScale) {
        (&self.light, self.light_scale)
    }

    /// The part of a lit pixel's radiance that does not depend on the viewer.
    #[inline(always)]
    pub fn diffuse_radiance(&self, tracer: &Tracer, pixel: u32) -> Vec3 {
        let triangle = self.triangle[pixel as usize];
        if triangle == NO_TRIANGLE {
            return tracer.sky(self.view.direction_of_pixel(pixel));
        }
        let scene = tracer.scene();
        let material = scene.material_of(triangle);
        let albedo = match material.diffuse_texture {
            None => material.diffuse,
            Some(_) => {
                let offset = self.offset_from_eye(pixel);
                SurfacePoint::from_position(scene, triangle, self.view.eye + offset, offset).albedo(scene)
            }
        };
        material.emission + albedo * self.light(pixel)
    }

    /// True where a pixel names a triangle of the scene, or the sky: always, unless its memory was damaged.
    #[inline(always)]
    pub fn is_sound(&self, tracer: &Tracer, pixel: u32) -> bool {
        let triangle = self.triangle[pixel as usize];
        triangle == NO_TRIANGLE || (triangle as usize) < tracer.scene().triangles.len()
    }

    /// 1 / depth along the viewing axis in scene units; 0 for the sky, NaN for a pixel not to be used.
    pub fn disparity(&self) -> &[f32] {
        &self.disparity
    }

    /// The range of disparities in each tile, with which the warp passes over what it cannot need.
    pub fn tiles(&self) -> &DisparityTiles {
        &self.tiles
    }

    /// First triangle met, [`NO_TRIANGLE`] for the sky.
    pub fn triangle(&self) -> &[u32] {
        &self.triangle
    }

    /// Specular bounces of a pixel; saturates at 255, so a mirror's count never wraps to 0.
    #[inline(always)]
    pub fn reflections(&self, pixel: u32) -> u8 {
        self.reflections.get(pixel as usize).copied().unwrap_or(0)
    }

    /// The stored intersection point of a pixel relative to the reference's eye; meaningless for the sky.
    pub fn offset_from_eye(&self, pixel: u32) -> Vec3 {
        self.view.direction_of_pixel(pixel) / self.disparity[pixel as usize]
    }
}
