//! A reference image.
//!
//! Source: the paper, section 3: a reference pixel holds diffuse radiance, the intersection point
//! of its primary ray and the number of reflections. We differ: the point is stored as disparity (1
//! / depth) along the pixel's ray, which is exact relative to the reference's own eye wherever the
//! scene lies, and turns a sky pixel into a direction (disparity zero). The triangle is stored,
//! which gives a pixel its normal and material. Of the diffuse radiance only the arriving light is
//! stored, so that textures are never resampled, and light straight from the lights apart from
//! smooth light. A reference may be sparse: pixels whose light older references hold are not lit
//! again.

mod damage;
mod layered;
mod marks;
mod merge;
mod parts;
mod stale_light;
mod traced_light;

pub(crate) use parts::ReferenceParts;
use stale_light::StaleLight;
use traced_light::TracedLight;

use crate::bsdf::albedo;
use crate::camera::{Camera, NEAREST_DEPTH, View};
use crate::raster::rgb9e5::Rgb9e5Scale;
use crate::reference::DisparityTiles;
use crate::reference::layers::LightLayers;
use crate::reference::light::{UNLIT, pack_light};
use crate::reference::stale::Mark;
use crate::reference::{sample_sums::SampleSums, smooth_samples::SmoothSamples};
use crate::scene::Scene;
use crate::trace::parallel::{Stop, tile_order, trace_pixels};
use crate::trace::{
    ILL_CONDITIONED, NO_TRIANGLE, PixelTrace, RayCounts, SceneEpoch, SurfacePoint, TraceSettings, Tracer,
    VisibilityBuffer, emission_of_hit,
};
use glam::Vec3;
use std::{sync::Arc, time::Instant};

/// Returns the trace settings of a reference by its number. Each has a seed of its own, so that the
/// noise of several references is independent. Numbers are added from bit 32 of the seed on; frames
/// use the seed itself.
pub fn settings_of_reference(settings: &TraceSettings, number: u64) -> TraceSettings {
    TraceSettings { seed: settings.seed.wrapping_add(number << 32), ..*settings }
}

/// The samples of smooth light of every pixel of a reference; none without bounces.
#[derive(Debug)]
pub(crate) struct DenseSamples {
    pixels: Vec<u32>,
    samples: Vec<SmoothSamples>,
}

/// A traced picture whose pixels are reused in other views. Structure of arrays, row-major.
#[derive(Clone, Debug)]
pub struct ReferenceFrame {
    /// Camera of the picture, world space.
    pub camera: Camera,
    /// The same camera in scene space, with the size in pixels.
    pub view: View,
    /// State of the scene that the picture shows.
    pub epoch: SceneEpoch,
    /// State of the scene that its light was traced in.
    pub(crate) origin: Arc<Scene>,
    /// Samples, bounces and seed.
    pub settings: TraceSettings,
    /// Time that tracing took, seconds.
    pub secs: f64,
    /// Rays that tracing took.
    pub rays: RayCounts,
    disparity: Vec<f32>,
    tiles: DisparityTiles,
    triangle: Vec<u32>,
    /// Light straight from the lights.
    light: Vec<u32>,
    light_scale: Rgb9e5Scale,
    /// Smooth light of the pixels that have light. Empty without bounces.
    smooth: Vec<u32>,
    smooth_scale: Rgb9e5Scale,
    /// Number of specular bounces of each pixel. Empty if no surface of the scene is specular.
    reflections: Vec<u8>,
    lit: usize,
    is_dense: bool,
    /// True if it includes the light of each reference of the view that was refined less.
    pub(crate) is_refined: bool,
    /// Light that no longer holds; `None` where all does.
    stale: Option<Box<StaleLight>>,
    /// What holds at most of each pixel, because an object moved; empty where none did.
    lost: Vec<Mark>,
    /// Light by groups of lights, where it was traced.
    layers: Option<Arc<LightLayers>>,
    /// Light as it was traced, where that of other settings of the lights is shown.
    traced: Option<Box<TracedLight>>,
    /// How often objects have moved since its light was traced.
    moves: u8,
}

impl ReferenceFrame {
    /// Maximum memory per pixel in bytes: disparity, triangle, direct light, with bounces smooth
    /// light, and in scenes with mirrors or glass a bounce count.
    pub const BYTES_PER_PIXEL: usize = size_of::<f32>() + 3 * size_of::<u32>() + size_of::<u8>();

    /// Additional memory per pixel, in bytes, while a reference is traced, or refined: its pixels,
    /// what was traced for them, and the filter. One that is refined keeps the sums of its samples,
    /// and its surfaces apart from the picture that frames read.
    pub const TRACING_BYTES_PER_PIXEL: usize = {
        const TRACED: usize = size_of::<Option<PixelTrace>>();
        const REFINED: usize = size_of::<SampleSums>() + size_of::<f32>() + ReferenceFrame::BYTES_PER_PIXEL;
        let samples = if TRACED > REFINED { TRACED } else { REFINED };
        size_of::<u32>() + samples + ReferenceFrame::FILTER_BYTES_PER_PIXEL
    };

    /// Traces every pixel of a reference on the current thread pool, as the paper does. `None`
    /// after a stop.
    pub fn trace(
        tracer: &Tracer,
        camera: &Camera,
        size: [u32; 2],
        settings: &TraceSettings,
        stop: Stop<'_>,
    ) -> Option<Self> {
        Self::trace_samples(tracer, camera, size, (settings, false), stop).map(|(frame, _)| frame)
    }

    /// Traces [`Self::trace`], and in addition the samples of its smooth light, from which
    /// [`Self::filtered`] makes the reference that look-ups read. Where a scene has normal maps,
    /// its light then has to be traced `for_look_ups`.
    pub(crate) fn trace_samples(
        tracer: &Tracer,
        camera: &Camera,
        size: [u32; 2],
        (settings, for_look_ups): (&TraceSettings, bool),
        stop: Stop<'_>,
    ) -> Option<(Self, DenseSamples)> {
        let start = Instant::now();
        let view = View::new(camera, &tracer.scene().frame, size);
        let order = tile_order(size);
        let mut traced = Vec::new();
        let mut visible = VisibilityBuffer::default();
        visible.find(tracer, &view, false);
        let (rays, complete) = trace_pixels(&order, &mut traced, stop, |pixel, rays| {
            let hit = visible.hit_of_pixel(tracer, &view, pixel);
            tracer.reference_pixel_of_hit(((&view, pixel), for_look_ups), hit, settings, rays)
        });
        if !complete {
            return None;
        }
        let mut frame = Self::empty(tracer, camera, view, settings);
        for (&pixel, traced) in order.iter().zip(traced.iter().flatten()) {
            frame.store_hit(pixel as usize, traced.hit.map(|hit| (hit.t, hit.triangle)), traced.reflections);
        }
        frame.store_lights(&order, traced.iter().flatten().map(|t| t.light.direct()));
        frame.store_smooth(&order, traced.iter().flatten().map(|t| t.light.smooth()));
        (frame.rays, frame.is_dense) = (rays, true);
        frame.forget_ill_conditioned(tracer);
        frame.bound_tiles();
        let samples = match settings.bounces {
            0 => Vec::new(),
            _ => traced.iter().flatten().map(|t| SmoothSamples::from(&t.light)).collect(),
        };
        frame.secs = start.elapsed().as_secs_f64();
        Some((frame, DenseSamples { pixels: order, samples }))
    }

    /// The same reference for look-ups: its smooth light is shared between neighbours.
    #[must_use]
    pub(crate) fn filtered(mut self, tracer: &Tracer, dense: &DenseSamples) -> Self {
        let start = Instant::now();
        self.store_filtered(tracer, &dense.pixels, &dense.samples);
        self.secs += start.elapsed().as_secs_f64();
        self
    }

    /// Traces every pixel of a reference for look-ups: its smooth light is shared between
    /// neighbours. `None` after a stop.
    pub fn trace_filtered(
        tracer: &Tracer,
        camera: &Camera,
        size: [u32; 2],
        settings: &TraceSettings,
        stop: Stop<'_>,
    ) -> Option<Self> {
        let (frame, samples) = Self::trace_samples(tracer, camera, size, (settings, true), stop)?;
        Some(frame.filtered(tracer, &samples))
    }

    /// Creates a reference whose pixels hold nothing yet.
    pub(crate) fn empty(tracer: &Tracer, camera: &Camera, view: View, settings: &TraceSettings) -> Self {
        let count = view.pixel_count();
        let features = tracer.scene().features;
        Self {
            camera: *camera,
            view,
            epoch: tracer.epoch(),
            origin: tracer.scene().clone(),
            settings: *settings,
            secs: 0.0,
            rays: RayCounts::default(),
            disparity: vec![f32::NAN; count],
            tiles: DisparityTiles::default(),
            triangle: vec![NO_TRIANGLE; count],
            light: vec![UNLIT; count],
            light_scale: Rgb9e5Scale::for_largest(1.0),
            smooth: if settings.bounces > 0 { vec![0; count] } else { Vec::new() },
            smooth_scale: Rgb9e5Scale::for_largest(1.0),
            reflections: if features.mirror || features.glass { vec![0; count] } else { Vec::new() },
            lit: 0,
            is_dense: false,
            is_refined: false,
            stale: None,
            lost: Vec::new(),
            layers: None,
            traced: None,
            moves: 0,
        }
    }

    /// Computes the disparity ranges of the tiles. To be called once all hits are stored.
    pub(crate) fn bound_tiles(&mut self) {
        self.tiles = DisparityTiles::new(&self.disparity, self.view.size);
    }

    /// Excludes hits on needle-like triangles from reuse: their position depends on rounding.
    /// Scenes without such triangles skip the test.
    pub(crate) fn forget_ill_conditioned(&mut self, tracer: &Tracer) {
        /// Ratio of height to longest side above which a triangle is ill-conditioned only when seen
        /// within half a degree of its plane.
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

    /// Stores the light straight from the lights of the listed pixels. A pixel whose light is not
    /// finite must not be reused: its disparity becomes NaN, which fails every comparison.
    pub(crate) fn store_lights(&mut self, pixels: &[u32], lights: impl Iterator<Item = Vec3> + Clone) {
        let largest = lights.clone().filter(|l| l.is_finite()).map(Vec3::max_element).fold(0.0, f32::max);
        self.light_scale = Rgb9e5Scale::for_largest(largest);
        for (&pixel, light) in pixels.iter().zip(lights) {
            let pixel = pixel as usize;
            if light.is_finite() {
                self.light[pixel] = pack_light(self.light_scale, light);
                self.lit += 1;
            } else {
                self.disparity[pixel] = f32::NAN;
            }
        }
    }

    /// Stores the smooth light of the listed pixels, where the reference holds any. Pixels whose
    /// light is not finite must not be reused.
    pub(crate) fn store_smooth(&mut self, pixels: &[u32], lights: impl Iterator<Item = Vec3> + Clone) {
        if self.smooth.is_empty() {
            return;
        }
        let largest = lights.clone().filter(|l| l.is_finite()).map(Vec3::max_element).fold(0.0, f32::max);
        self.smooth_scale = Rgb9e5Scale::for_largest(largest);
        for (&pixel, light) in pixels.iter().zip(lights) {
            let pixel = pixel as usize;
            if light.is_finite() {
                self.smooth[pixel] = self.smooth_scale.pack(light);
            } else {
                self.disparity[pixel] = f32::NAN;
            }
        }
    }

    /// Stores the hit of a pixel, as distance along its ray and triangle, without light.
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

    /// Memory of the picture in bytes.
    pub fn bytes(&self) -> usize {
        let picture = self.view.pixel_count() * 12 + 4 * self.smooth.len() + self.reflections.len();
        picture + self.stale_bytes() + self.layer_bytes()
    }

    /// Number of pixels whose light is stored.
    pub fn lit(&self) -> usize {
        self.lit
    }

    /// True if every pixel was lit, as in the paper's references.
    pub fn is_dense(&self) -> bool {
        self.is_dense
    }

    /// True if the light of a pixel is stored.
    #[inline(always)]
    pub fn has_light(&self, pixel: u32) -> bool {
        self.light[pixel as usize] != UNLIT
    }

    /// All light arriving at the surface of a pixel, as the radiance of a white diffuse surface.
    /// Meaningful only if [`Self::has_light`].
    #[inline(always)]
    pub fn light(&self, pixel: u32) -> Vec3 {
        let direct = self.light_scale.unpack(self.light[pixel as usize]);
        self.smooth.get(pixel as usize).map_or(direct, |&word| direct + self.smooth_scale.unpack(word))
    }

    /// True where smooth light is stored apart: with bounces.
    pub(crate) fn has_smooth_light(&self) -> bool {
        !self.smooth.is_empty()
    }

    /// Packed smooth light of all pixels, and the scale to unpack it; empty without bounces.
    pub(crate) fn packed_smooth(&self) -> (&[u32], Rgb9e5Scale) {
        (&self.smooth, self.smooth_scale)
    }

    /// Packed light straight from the lights of all pixels, and the scale to unpack it.
    pub(crate) fn packed_light(&self) -> (&[u32], Rgb9e5Scale) {
        (&self.light, self.light_scale)
    }

    /// Part of a lit pixel's radiance that does not depend on the viewer: emission and diffuse
    /// reflection, or the sky.
    #[inline(always)]
    pub fn diffuse_radiance(&self, tracer: &Tracer, pixel: u32) -> Vec3 {
        let triangle = self.triangle[pixel as usize];
        if triangle == NO_TRIANGLE {
            return tracer.sky(self.view.direction_of_pixel(pixel));
        }
        let scene = tracer.scene();
        let material = scene.material_of(triangle);
        let point = || {
            let offset = self.offset_from_eye(pixel);
            SurfacePoint::from_position(scene, triangle, self.view.eye + offset, offset)
        };
        let albedo = match material.is_glossy() || material.detail.mixes() {
            true => point().albedo(scene),
            false => albedo(material, &scene.textures, || point().uv),
        };
        let direction = self.view.direction_of_pixel(pixel);
        emission_of_hit(scene, triangle, || point().uv, direction) + albedo * self.light(pixel)
    }

    /// True if the stored triangle exists or is [`NO_TRIANGLE`]: always, unless memory is corrupt.
    #[inline(always)]
    pub fn is_sound(&self, tracer: &Tracer, pixel: u32) -> bool {
        let triangle = self.triangle[pixel as usize];
        triangle == NO_TRIANGLE || (triangle as usize) < tracer.scene().triangles.len()
    }

    /// Disparity of all pixels: 1 / depth along the viewing axis, per scene unit. 0 for the sky,
    /// NaN for a pixel that must not be used.
    pub fn disparity(&self) -> &[f32] {
        &self.disparity
    }

    /// Range of disparities in each tile, by which the warp skips tiles.
    pub fn tiles(&self) -> &DisparityTiles {
        &self.tiles
    }

    /// First triangle hit in each pixel, [`NO_TRIANGLE`] for the sky.
    pub fn triangle(&self) -> &[u32] {
        &self.triangle
    }

    /// Number of specular bounces of a pixel. Saturates at 255, so that it never wraps to 0.
    #[inline(always)]
    pub fn reflections(&self, pixel: u32) -> u8 {
        self.reflections.get(pixel as usize).copied().unwrap_or(0)
    }

    /// Hit point of a pixel relative to the reference's eye, scene space. Meaningless for the sky.
    pub fn offset_from_eye(&self, pixel: u32) -> Vec3 {
        self.view.direction_of_pixel(pixel) / self.disparity[pixel as usize]
    }
}
