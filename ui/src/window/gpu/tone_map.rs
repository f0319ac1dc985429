//! The tone mapping pass: radiance to display colour. It runs once per frame and exposure, because
//! the window is redrawn far more often than either changes.

use crate::window::gpu::full_screen_pass as pass;
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

/// The pass and its pipeline.
pub(crate) struct ToneMapPass {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    params: wgpu::Buffer,
}

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
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("tone map"),
            entries: &[
                pass::texture_entry(0, wgpu::TextureSampleType::Float { filterable: false }),
                pass::uniform_entry(1),
            ],
        });
        let shader = device.create_shader_module(wgpu::include_wgsl!("tone_map.wgsl"));
        Self {
            pipeline: pass::pipeline(device, "tone map", &layout, &shader, &[], DISPLAY_FORMAT),
            layout,
            params: pass::uniform_buffer(device, "tone map", size_of::<ToneMapping>()),
        }
    }

    /// Creates the textures of a picture.
    pub(crate) fn make_textures(&self, device: &wgpu::Device, size: [u32; 2]) -> ToneMapped {
        let texture = |format, usage| pass::texture(device, "tone map", size, format, usage);
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let radiance = texture(wgpu::TextureFormat::Rgb9e5Ufloat, wgpu::TextureUsages::COPY_DST);
        let display = texture(DISPLAY_FORMAT, wgpu::TextureUsages::RENDER_ATTACHMENT);
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("tone map"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: wgpu::BindingResource::TextureView(&view(&radiance)),
                },
                wgpu::BindGroupEntry { binding: 1, resource: self.params.as_entire_binding() },
            ],
        });
        ToneMapped { radiance, size, display: view(&display), bind_group, done: None }
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
        queue.write_buffer(&self.params, 0, bytemuck::bytes_of(&parameters));
        pass::draw(encoder, "tone map", &picture.display, &self.pipeline, &picture.bind_group);
    }
}

impl ToneMapped {
    /// Uploads radiance, rgb9e5; the pass runs when the picture is next shown.
    pub(crate) fn write(&mut self, queue: &wgpu::Queue, radiance: &[u32]) {
        pass::write(queue, &self.radiance, 0, self.size, bytemuck::cast_slice(radiance));
        self.done = None;
    }
}
