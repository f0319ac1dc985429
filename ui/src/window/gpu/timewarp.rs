//! Reprojects the last frame to the current camera on the graphics card, so that the view follows
//! the user's input at the display's refresh rate even while the renderer is slower.
//!
//! Each pixel of the new view is traced through the depth image of the last frame. Along its ray,
//! source pixel and disparity change linearly in the image, so a march along a line from near to
//! far finds the first surface: relief mapping (Policarpo, Oliveira and Comba, I3D 2005) with the
//! depth image as the relief. Squares of pixels that the ray passes in front of or behind are
//! skipped in one step (Tevs, Ihrke and Seidel, I3D 2008, with minima as well as maxima), so no
//! surface is missed however far the camera has moved. If the last frame does not contain the first
//! surface, the pixel is filled from the surroundings of the surface that hides it, and marked as
//! filled. Source of the idea: positional timewarp (van Waveren, VRST 2016).

use crate::window::gpu::full_screen_pass::{self as pass, TexturePass};
use crate::window::rendering::depth_ranges::{DepthRanges, LEVELS};
use afterimage::Camera;
use afterimage::camera::{SceneFrame, View};
use egui_wgpu::wgpu;
use glam::{DMat3, DVec3};

/// Maximum number of steps of a march, which bounds the time of a draw for all depths.
pub const MAX_STEPS: u32 = 128;

/// Maximum number of texels of the map with a software rasterizer, which takes its time from the
/// renderer.
pub const MAX_TEXELS_IN_SOFTWARE: u32 = 96 * 1024;

/// Displacement in pixels, and whether the pixel is filled. Half floats represent a displacement of
/// 64 pixels to within 1/32.
const MAP_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Mapping from pixels of a new view to pixels of the last frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reprojection {
    /// Frame pixel (x, y, 1) of a pixel of the new view, for points at infinity.
    source_from_target: DMat3,
    /// Image of the new eye in the frame; multiplied by inverse depth, it is the parallax of a
    /// point.
    epipole: DVec3,
    size: [u32; 2],
    /// Largest disparity of the frame, in scene units.
    nearest: f32,
}

impl Reprojection {
    /// Mapping from the frame of one camera to the view of another. `nearest` is the largest
    /// disparity of the frame, in scene units.
    pub fn new(from: &Camera, to: &Camera, scene: &SceneFrame, size: [u32; 2], nearest: f32) -> Self {
        let [source, target] = [from, to].map(|camera| View::new(camera, scene, size));
        let source_pixel_from_scene = source.scene_from_pixel_f64.inverse();
        Self {
            source_from_target: source_pixel_from_scene * target.scene_from_pixel_f64,
            epipole: source_pixel_from_scene * (target.eye_f64 - source.eye_f64),
            size,
            nearest,
        }
    }

    fn params(&self, pixels_per_texel: u32) -> Params {
        let back = self.source_from_target.inverse();
        let column = |v: DVec3| v.as_vec3().extend(0.0).to_array();
        let columns = |m: DMat3| [m.x_axis, m.y_axis, m.z_axis].map(column);
        Params {
            source_from_target: columns(self.source_from_target),
            epipole: self.epipole.as_vec3().extend(pixels_per_texel as f32).to_array(),
            target_from_source: columns(back),
            back: column(back * -self.epipole),
            size: self.size,
            max_steps: MAX_STEPS,
            nearest: self.nearest,
        }
    }
}

/// Parameters of the pass, laid out as `Warp` in timewarp.wgsl.
#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Params {
    source_from_target: [[f32; 4]; 3],
    /// The epipole, and in the last component the frame pixels per texel of the map.
    epipole: [f32; 4],
    target_from_source: [[f32; 4]; 3],
    back: [f32; 4],
    size: [u32; 2],
    max_steps: u32,
    nearest: f32,
}

const _: () = assert!(size_of::<Params>() == 144);

/// The pass that computes a map: for every pixel of the new view, its displacement into the last
/// frame.
pub struct Timewarp {
    pass: TexturePass,
    max_texels: u32,
}

/// A map of the frame's size, or smaller by an integer factor, and the depths that it is computed
/// from.
pub struct WarpMap {
    /// Displacement in frame pixels; the third channel is 1 if the pixel is filled.
    pub map: wgpu::Texture,
    /// Size of the map in texels.
    pub size: [u32; 2],
    pixels_per_texel: u32,
    ranges: wgpu::Texture,
    view: wgpu::TextureView,
    bind_group: wgpu::BindGroup,
}

impl Timewarp {
    /// Creates the pipeline. `None` if the adapter cannot render to the map's format: frames are
    /// then shown without reprojection.
    pub fn new(adapter: &wgpu::Adapter, device: &wgpu::Device) -> Option<Self> {
        let uses = adapter.get_texture_format_features(MAP_FORMAT).allowed_usages;
        if !uses.contains(wgpu::TextureUsages::RENDER_ATTACHMENT) {
            return None;
        }
        let is_software = adapter.get_info().device_type == wgpu::DeviceType::Cpu;
        Some(Self {
            pass: TexturePass::new(
                device,
                "timewarp",
                wgpu::include_wgsl!("timewarp.wgsl"),
                MAP_FORMAT,
                size_of::<Params>(),
            ),
            max_texels: if is_software { MAX_TEXELS_IN_SOFTWARE } else { u32::MAX },
        })
    }

    /// Creates the textures for frames of a size.
    pub fn make_map(&self, device: &wgpu::Device, size: [u32; 2]) -> WarpMap {
        let pixels_per_texel = (1..).find(|n| self.is_affordable(size.map(|s| s.div_ceil(*n)))).unwrap_or(1);
        let map_size = size.map(|s| s.div_ceil(pixels_per_texel));
        let drawn = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
        let map = pass::texture(device, "timewarp", map_size, MAP_FORMAT, drawn);
        let ranges = pass::mipmapped_texture(
            device,
            "depth ranges",
            DepthRanges::padded(size),
            LEVELS,
            wgpu::TextureFormat::Rg32Float,
            wgpu::TextureUsages::COPY_DST,
        );
        let (view, bind_group) = (pass::view(&map), self.pass.bind(device, &ranges));
        WarpMap { map, size: map_size, pixels_per_texel, ranges, view, bind_group }
    }

    fn is_affordable(&self, [width, height]: [u32; 2]) -> bool {
        width.saturating_mul(height) <= self.max_texels
    }

    /// Computes the map of a reprojection.
    pub fn draw(
        &self,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        map: &WarpMap,
        reprojection: &Reprojection,
    ) {
        let params = reprojection.params(map.pixels_per_texel);
        self.pass.draw(queue, encoder, &map.view, &map.bind_group, bytemuck::bytes_of(&params));
    }
}

impl WarpMap {
    /// Uploads the depths of a frame.
    pub fn write(&self, queue: &wgpu::Queue, ranges: &DepthRanges) {
        for (level, (size, ranges)) in (0..).zip(ranges.levels()) {
            pass::write(queue, &self.ranges, level, size, bytemuck::cast_slice(ranges));
        }
    }
}
