//! The tone mapping pass: radiance to display colour. It runs once per frame and exposure, because
//! the window is redrawn far more often than either changes.

use crate::window::gpu::full_screen_pass::{self as pass, TexturePass};
use afterimage::raster::color::ToneMap;
use egui_wgpu::wgpu;

/// Format of tone-mapped pictures; the shader encodes sRGB.
const DISPLAY_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Parameters of the pass, laid out as `Params` in tone_map.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct ToneMapping {
    exposure: f32,
    tone_map: u32,
    unused: [u32; 2],
}

const _: () = assert!(size_of::<ToneMapping>() == 16);

// The shader compares these numbers.
const _: () = assert!(ToneMap::Aces as u32 == 0 && ToneMap::Linear as u32 == 1);

impl ToneMapping {
    /// Parameters for an exposure in stops.
    pub(crate) fn new(exposure_ev: f32, tone_map: ToneMap) -> Self {
        Self { exposure: exposure_ev.exp2(), tone_map: tone_map as u32, unused: [0; 2] }
    }
}

/// The pass.
pub(crate) struct ToneMapPass(TexturePass);

/// Radiance of a picture, rgb9e5, and its tone-mapped colours.
pub(crate) struct ToneMapped {
    radiance: wgpu::Texture,
    size: [u32; 2],
    pub(crate) display: wgpu::TextureView,
    bind_group: wgpu::BindGroup,
    /// Parameters of the last run; `None` after new radiance was written.
    done: Option<ToneMapping>,
}

impl ToneMapPass {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        let shader = wgpu::include_wgsl!("tone_map.wgsl");
        Self(TexturePass::new(device, "tone map", shader, DISPLAY_FORMAT, size_of::<ToneMapping>()))
    }

    /// Creates the textures of a picture.
    pub(crate) fn make_textures(&self, device: &wgpu::Device, size: [u32; 2]) -> ToneMapped {
        let texture = |format, usage| pass::texture(device, "tone map", size, format, usage);
        let radiance = texture(wgpu::TextureFormat::Rgb9e5Ufloat, wgpu::TextureUsages::COPY_DST);
        let display = texture(DISPLAY_FORMAT, wgpu::TextureUsages::RENDER_ATTACHMENT);
        let (display, bind_group) = (pass::view(&display), self.0.bind(device, &radiance));
        ToneMapped { radiance, size, display, bind_group, done: None }
    }

    /// Runs the pass unless its result is current. All pictures of one draw share the parameters.
    pub(crate) fn run(
        &self,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        picture: &mut ToneMapped,
        parameters: ToneMapping,
    ) {
        if picture.done == Some(parameters) {
            return;
        }
        picture.done = Some(parameters);
        let bytes = bytemuck::bytes_of(&parameters);
        self.0.draw(queue, encoder, &picture.display, &picture.bind_group, bytes);
    }
}

impl ToneMapped {
    /// Uploads radiance, rgb9e5; the pass runs when the picture is next shown.
    pub(crate) fn write(&mut self, queue: &wgpu::Queue, radiance: &[u32]) {
        pass::write(queue, &self.radiance, 0, self.size, bytemuck::cast_slice(radiance));
        self.done = None;
    }
}
