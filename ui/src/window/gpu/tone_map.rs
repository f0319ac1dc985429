//! The tone mapping pass: radiance, or values, to display colour. It runs once per frame and exposure, because
//! the window is redrawn far more often than either changes.

use crate::window::gpu::full_screen_pass::{self as pass, TexturePass};
use crate::window::state::{FalseColors, Presentation};
use afterimage::raster::color::ToneMap;
use afterimage::raster::false_color::{BRIGHT, NO_VALUE, STOPS};
use egui_wgpu::wgpu;

/// Format of tone-mapped pictures; the shader encodes sRGB.
const DISPLAY_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// Parameters of the pass, laid out as `Params` in tone_map.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct ToneMapping {
    scale: f32,
    tone_map: u32,
    kind: u32,
    line_step: f32,
}

const _: () = assert!(size_of::<ToneMapping>() == 16);

// The shader compares these numbers.
const _: () = assert!(ToneMap::Aces as u32 == 0 && ToneMap::Linear as u32 == 1);

/// Kinds of frames, as the shader numbers them.
const PICTURE: u32 = 0;
const VALUES: u32 = 1;
const CLAY: u32 = 2;

impl ToneMapping {
    /// Parameters for how a frame is shown.
    pub(crate) fn new(shown: &Presentation) -> Self {
        let tone_map = shown.tone_map as u32;
        match shown.false_colors {
            Some(FalseColors { scale, line_step }) => Self { scale, tone_map, kind: VALUES, line_step },
            None => {
                let kind = if shown.is_clay { CLAY } else { PICTURE };
                Self { scale: shown.exposure_ev.exp2(), tone_map, kind, line_step: 0.0 }
            }
        }
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
        let shader = wgpu::ShaderModuleDescriptor {
            label: Some("tone map"),
            source: wgpu::ShaderSource::Wgsl(shader_source().into()),
        };
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

/// The shader with the colours of values.
fn shader_source() -> String {
    let vector = |[r, g, b]: &[u8; 3]| format!("vec3<f32>({r}.0, {g}.0, {b}.0) / 255.0");
    let stops: Vec<String> = STOPS.iter().map(vector).collect();
    let (count, list, none) = (STOPS.len(), stops.join(", "), vector(&NO_VALUE));
    format!(
        "const STOP_COUNT: u32 = {count}u;\nconst BRIGHT: f32 = {BRIGHT:?};\n\
         fn no_value_color() -> vec3<f32> {{ return {none}; }}\n\
         fn stop(i: u32) -> vec3<f32> {{ var stops = array<vec3<f32>, {count}>({list}); return stops[i]; }}\n"
    ) + include_str!("tone_map.wgsl")
}

impl ToneMapped {
    /// Uploads radiance, rgb9e5; the pass runs when the picture is next shown.
    pub(crate) fn write(&mut self, queue: &wgpu::Queue, radiance: &[u32]) {
        pass::write(queue, &self.radiance, 0, self.size, bytemuck::cast_slice(radiance));
        self.done = None;
    }
}
