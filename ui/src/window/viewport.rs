//! The picture on the screen: textures of the newest frame and the pipeline that shows them.

use super::frames::PublishedFrame;
use super::full_screen_pass as pass;
use super::presentation::{Overlay, Presentation};
use super::timewarp::{Reprojection, Timewarp, WarpMap};
use afterimage::raster::color::ToneMap;
use egui_wgpu::{CallbackResources, CallbackTrait, RenderState, ScreenDescriptor, wgpu};

#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Params {
    size: [u32; 2],
    heatmap: u32,
    coloring: u32,
    uv_scale: [f32; 2],
    exposure: f32,
    tone_map: u32,
    outline: u32,
    pixels_per_point: f32,
    encode: u32,
    is_warped: u32,
    overlay: u32,
    split: f32,
    unused: [u32; 2],
}

// As `Params` of present.wgsl is laid out; a uniform's size is a multiple of 16.
const _: () = assert!(size_of::<Params>() == 64);

struct ViewGpu {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    params: wgpu::Buffer,
    encode: bool,
    timewarp: Option<Timewarp>,
    /// Bound where nothing is warped.
    no_map: wgpu::TextureView,
    textures: Option<Textures>,
}

struct Textures {
    size: [u32; 2],
    color: wgpu::Texture,
    types: wgpu::Texture,
    suppliers: wgpu::Texture,
    full: wgpu::Texture,
    errors: wgpu::Texture,
    warp: Option<WarpMap>,
    bind_group: wgpu::BindGroup,
}

/// Makes the pipeline. Once, before the first frame.
pub fn install(state: &RenderState) {
    let gpu = ViewGpu::new(&state.adapter, &state.device, state.target_format);
    state.renderer.write().callback_resources.insert(gpu);
}

/// Sends a frame to the graphics card.
pub fn upload(state: &RenderState, frame: &PublishedFrame) {
    if frame.size.contains(&0) {
        return;
    }
    let mut renderer = state.renderer.write();
    let Some(gpu) = renderer.callback_resources.get_mut::<ViewGpu>() else { return };
    if gpu.textures.as_ref().is_none_or(|t| t.size != frame.size) {
        gpu.textures = Some(gpu.make_textures(&state.device, frame.size));
    }
    if let Some(textures) = &gpu.textures {
        textures.write(&state.queue, frame);
    }
}

/// Sends the full tracer's picture of the frame's view; one of another size is left out.
pub fn upload_full(state: &RenderState, full: &PublishedFrame) {
    let renderer = state.renderer.read();
    let textures = renderer.callback_resources.get::<ViewGpu>().and_then(|gpu| gpu.textures.as_ref());
    if let Some(textures) = textures.filter(|t| t.size == full.size) {
        textures.put(&state.queue, &textures.full, bytemuck::cast_slice(&full.radiance), 4);
    }
}

/// Sends the map of errors, sRGB; one of another size than the frame's is left out.
pub fn upload_errors(state: &RenderState, size: [u32; 2], map: &[[u8; 3]]) {
    let renderer = state.renderer.read();
    let textures = renderer.callback_resources.get::<ViewGpu>().and_then(|gpu| gpu.textures.as_ref());
    if let Some(textures) = textures.filter(|t| t.size == size) {
        let rgba: Vec<[u8; 4]> = map.iter().map(|&[r, g, b]| [r, g, b, u8::MAX]).collect();
        textures.put(&state.queue, &textures.errors, bytemuck::cast_slice(&rgba), 4);
    }
}

/// The shape that shows the newest frame in a rectangle, as seen from elsewhere where `reprojection` says so.
pub fn shape(
    rect: egui::Rect,
    pixels_per_point: f32,
    presentation: Presentation,
    reprojection: Option<Reprojection>,
) -> egui::Shape {
    let aspect = rect.width() / rect.height().max(1.0);
    let show = Show { presentation, reprojection, aspect, pixels_per_point };
    egui_wgpu::Callback::new_paint_callback(rect, show).into()
}

struct Show {
    presentation: Presentation,
    reprojection: Option<Reprojection>,
    aspect: f32,
    pixels_per_point: f32,
}

impl Show {
    fn params(&self, size: [u32; 2], encode: bool, is_warped: bool) -> Params {
        let frame_aspect = size[0] as f32 / size[1].max(1) as f32;
        let p = &self.presentation;
        let (overlay, split) = match p.overlay {
            Overlay::None => (0, 0.0),
            Overlay::Full => (1, 0.0),
            Overlay::RightOf(split) => (1, split),
            Overlay::Errors => (2, 0.0),
        };
        Params {
            size,
            heatmap: p.heatmap as u32,
            coloring: p.coloring as u32,
            // The height always fits: a frame made for the window's old shape is cut or bordered left and right.
            uv_scale: [self.aspect / frame_aspect, 1.0],
            exposure: p.exposure_ev.exp2(),
            tone_map: p.tone_map as u32,
            outline: p.has_outline.into(),
            pixels_per_point: self.pixels_per_point,
            encode: encode.into(),
            is_warped: is_warped.into(),
            overlay,
            split,
            unused: [0; 2],
        }
    }
}

// The shader knows these by number.
const _: () = assert!(ToneMap::Aces as u32 == 0 && ToneMap::Linear as u32 == 1);

impl CallbackTrait for Show {
    fn prepare(
        &self,
        _device: &wgpu::Device,
        queue: &wgpu::Queue,
        _screen: &ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        if let Some(gpu) = resources.get::<ViewGpu>()
            && let Some(textures) = &gpu.textures
        {
            let warp = self.reprojection.as_ref().zip(gpu.timewarp.as_ref()).zip(textures.warp.as_ref());
            if let Some(((reprojection, timewarp), map)) = warp {
                timewarp.draw(queue, encoder, map, reprojection);
            }
            let params = self.params(textures.size, gpu.encode, warp.is_some());
            queue.write_buffer(&gpu.params, 0, bytemuck::bytes_of(&params));
        }
        Vec::new()
    }

    fn paint(
        &self,
        _info: egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        resources: &CallbackResources,
    ) {
        if let Some(gpu) = resources.get::<ViewGpu>()
            && let Some(textures) = &gpu.textures
        {
            pass.set_pipeline(&gpu.pipeline);
            pass.set_bind_group(0, &textures.bind_group, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}

impl ViewGpu {
    fn new(adapter: &wgpu::Adapter, device: &wgpu::Device, target: wgpu::TextureFormat) -> Self {
        let layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("viewport"),
            entries: &[
                pass::texture_entry(0, wgpu::TextureSampleType::Float { filterable: true }),
                pass::entry(1, wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering)),
                pass::texture_entry(2, wgpu::TextureSampleType::Uint),
                pass::texture_entry(3, wgpu::TextureSampleType::Uint),
                pass::uniform_entry(4),
                pass::texture_entry(5, wgpu::TextureSampleType::Float { filterable: false }),
                pass::texture_entry(6, wgpu::TextureSampleType::Float { filterable: true }),
                pass::texture_entry(7, wgpu::TextureSampleType::Float { filterable: true }),
            ],
        });
        Self {
            pipeline: pass::pipeline(
                device,
                "viewport",
                &layout,
                wgpu::include_wgsl!("present.wgsl"),
                target,
            ),
            layout,
            sampler: device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("viewport"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
            params: pass::uniform_buffer(device, "viewport", size_of::<Params>()),
            encode: !target.is_srgb(),
            timewarp: Timewarp::new(adapter, device),
            no_map: texture(device, [1, 1], wgpu::TextureFormat::Rgba16Float)
                .create_view(&wgpu::TextureViewDescriptor::default()),
            textures: None,
        }
    }

    fn make_textures(&self, device: &wgpu::Device, size: [u32; 2]) -> Textures {
        let texture = |format| texture(device, size, format);
        let (color, full) =
            (texture(wgpu::TextureFormat::Rgb9e5Ufloat), texture(wgpu::TextureFormat::Rgb9e5Ufloat));
        let errors = texture(wgpu::TextureFormat::Rgba8Unorm);
        let (types, suppliers) = (texture(wgpu::TextureFormat::R8Uint), texture(wgpu::TextureFormat::R8Uint));
        let warp = self.timewarp.as_ref().map(|timewarp| timewarp.make_map(device, size));
        let view = |texture: &wgpu::Texture| texture.create_view(&wgpu::TextureViewDescriptor::default());
        let map = warp.as_ref().map(|warp| view(&warp.map));
        let bind = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("viewport"),
            layout: &self.layout,
            entries: &[
                bind(0, wgpu::BindingResource::TextureView(&view(&color))),
                bind(1, wgpu::BindingResource::Sampler(&self.sampler)),
                bind(2, wgpu::BindingResource::TextureView(&view(&types))),
                bind(3, wgpu::BindingResource::TextureView(&view(&suppliers))),
                bind(4, self.params.as_entire_binding()),
                bind(5, wgpu::BindingResource::TextureView(map.as_ref().unwrap_or(&self.no_map))),
                bind(6, wgpu::BindingResource::TextureView(&view(&full))),
                bind(7, wgpu::BindingResource::TextureView(&view(&errors))),
            ],
        });
        Textures { size, color, types, suppliers, full, errors, warp, bind_group }
    }
}

impl Textures {
    fn write(&self, queue: &wgpu::Queue, frame: &PublishedFrame) {
        self.put(queue, &self.color, bytemuck::cast_slice(&frame.radiance), 4);
        self.put(queue, &self.types, &frame.types, 1);
        self.put(queue, &self.suppliers, &frame.suppliers, 1);
        if let Some(warp) = &self.warp {
            self.put(queue, &warp.disparity, bytemuck::cast_slice(&frame.disparity), 4);
        }
    }

    fn put(&self, queue: &wgpu::Queue, texture: &wgpu::Texture, bytes: &[u8], bytes_per_pixel: u32) {
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(self.size[0] * bytes_per_pixel),
            rows_per_image: None,
        };
        let [width, height] = self.size;
        let extent = wgpu::Extent3d { width, height, depth_or_array_layers: 1 };
        queue.write_texture(texture.as_image_copy(), bytes, layout, extent);
    }
}

/// A texture that is written from the processor and read in shaders.
fn texture(device: &wgpu::Device, size: [u32; 2], format: wgpu::TextureFormat) -> wgpu::Texture {
    pass::texture(device, "viewport", size, format, wgpu::TextureUsages::COPY_DST)
}
