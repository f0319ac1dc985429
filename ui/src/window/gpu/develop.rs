//! Radiance made fit for display, once a frame and exposure: the window is drawn far more often than either changes.

use crate::window::gpu::full_screen_pass as pass;
use afterimage::raster::color::ToneMap;
use egui_wgpu::wgpu;

/// Gamma-encoded, as every display's own pixels.
const DEVELOPED_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// How radiance becomes colour. As `Params` of develop.wgsl is laid out.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Development {
    exposure: f32,
    tone_map: u32,
    unused: [u32; 2],
}

const _: () = assert!(size_of::<Development>() == 16);

// The shader knows these by number.
const _: () = assert!(ToneMap::Aces as u32 == 0 && ToneMap::Linear as u32 == 1);

impl Development {
    /// Exposure in stops.
    pub(crate) fn new(exposure_ev: f32, tone_map: ToneMap) -> Self {
        Self { exposure: exposure_ev.exp2(), tone_map: tone_map as u32, unused: [0; 2] }
    }
}

/// The pass that develops.
pub(crate) struct Developer {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    params: wgpu::Buffer,
}

/// A picture's radiance, rgb9e5, and what becomes of it.
pub(crate) struct Negative {
    radiance: wgpu::Texture,
    size: [u32; 2],
    pub(crate) developed: wgpu::TextureView,
    bind_group: wgpu::BindGroup,
    /// How it was developed since radiance was last written.
    done: Option<Development>,
}

impl Developer {
    pub(crate) fn new(device: &wgpu::Device) -> Self {
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("develop"),
            entries: &[
                pass::texture_entry(0, wgpu::TextureSampleType::Float { filterable: false }),
                pass::uniform_entry(1),
            ],
        });
        let shader = device.create_shader_module(wgpu::include_wgsl!("develop.wgsl"));
        Self {
            pipeline: pass::pipeline(device, "develop", &layout, &shader, &[], DEVELOPED_FORMAT),
            layout,
            params: pass::uniform_buffer(device, "develop", size_of::<Development>()),
        }
    }

    /// Room for a picture.
    pub(crate) fn make_negative(&self, device: &wgpu::Device, size: [u32; 2]) -> Negative {
        let texture = |format, usage| pass::texture(device, "develop", size, format, usage);
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let radiance = texture(wgpu::TextureFormat::Rgb9e5Ufloat, wgpu::TextureUsages::COPY_DST);
        let developed = texture(DEVELOPED_FORMAT, wgpu::TextureUsages::RENDER_ATTACHMENT);
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("develop"),
            layout: &self.layout,
            entries: &[
                wgpu::BindGroupEntry {
                    binding: 0,
                    resource: wgpu::BindingResource::TextureView(&view(&radiance)),
                },
                wgpu::BindGroupEntry { binding: 1, resource: self.params.as_entire_binding() },
            ],
        });
        Negative { radiance, size, developed: view(&developed), bind_group, done: None }
    }

    /// Develops what is not developed so yet. All that are drawn at a time are developed alike: they share parameters.
    pub(crate) fn develop(
        &self,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        negative: &mut Negative,
        development: Development,
    ) {
        if negative.done == Some(development) {
            return;
        }
        negative.done = Some(development);
        queue.write_buffer(&self.params, 0, bytemuck::bytes_of(&development));
        pass::draw(encoder, "develop", &negative.developed, &self.pipeline, &negative.bind_group);
    }
}

impl Negative {
    /// Sends radiance, rgb9e5; it is developed when it is next shown.
    pub(crate) fn write(&mut self, queue: &wgpu::Queue, radiance: &[u32]) {
        pass::write(queue, &self.radiance, 0, self.size, bytemuck::cast_slice(radiance));
        self.done = None;
    }
}
