//! The viewport: textures of the newest frame, and the pipelines that show them.

use crate::window::gpu::timewarp::{Reprojection, Timewarp, WarpMap};
use crate::window::gpu::tone_map::{ToneMapPass, ToneMapped, ToneMapping};
use crate::window::state::{FILLED_COLOR, Heatmap, Overlay, Presentation};
use crate::window::{gpu::full_screen_pass as pass, rendering::exchange::PublishedFrame};
use afterimage::raster::pixel_types::TYPE_SRGB;
use egui_wgpu::{CallbackResources, CallbackTrait, RenderState, ScreenDescriptor, wgpu};

#[repr(C)]
#[derive(Clone, Copy, bytemuck::Pod, bytemuck::Zeroable)]
struct Params {
    size: [u32; 2],
    map_size: [u32; 2],
    uv_scale: [f32; 2],
    heatmap: u32,
    coloring: u32,
    outline: u32,
    pixels_per_point: f32,
    overlay: u32,
    split: f32,
}

// The layout is that of `Params` in present.wgsl; the size of a uniform is a multiple of 16 bytes.
const _: () = assert!(size_of::<Params>() == 48);

/// Parts of the shader that a picture needs. Each combination has its own pipeline, created on
/// first use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct ShaderFeatures {
    is_warped: bool,
    shows_types: bool,
    is_overlaid: bool,
}

struct ViewGpu {
    pipelines: Vec<(ShaderFeatures, wgpu::RenderPipeline)>,
    shader: wgpu::ShaderModule,
    target: wgpu::TextureFormat,
    layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    params: wgpu::Buffer,
    tone_map: ToneMapPass,
    timewarp: Option<Timewarp>,
    /// Texture bound in place of the map if nothing is reprojected.
    no_map: wgpu::TextureView,
    textures: Option<Textures>,
}

/// Parts of a frame that only some pictures need.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Parts {
    types: bool,
    depths: bool,
}

struct Textures {
    size: [u32; 2],
    /// What of the newest frame is uploaded besides its colours.
    uploaded: Parts,
    color: ToneMapped,
    types: wgpu::Texture,
    suppliers: wgpu::Texture,
    full: ToneMapped,
    errors: wgpu::Texture,
    warp: Option<WarpMap>,
    bind_group: wgpu::BindGroup,
}

/// Creates the passes. Called once, before the first frame.
pub fn install(state: &RenderState) {
    let gpu = ViewGpu::new(&state.adapter, &state.device, state.target_format);
    state.renderer.write().callback_resources.insert(gpu);
}

/// Uploads the colours of a frame to the graphics card.
pub fn upload(state: &RenderState, frame: &PublishedFrame) {
    if frame.size.contains(&0) {
        return;
    }
    let mut renderer = state.renderer.write();
    let Some(gpu) = renderer.callback_resources.get_mut::<ViewGpu>() else { return };
    if gpu.textures.as_ref().is_none_or(|t| t.size != frame.size) {
        gpu.textures = Some(gpu.make_textures(&state.device, frame.size));
    }
    if let Some(textures) = &mut gpu.textures {
        textures.color.write(&state.queue, &frame.radiance);
        textures.uploaded = Parts::default();
    }
}

/// Uploads what a picture of the frame needs besides its colours, unless it is there: its types for
/// a heatmap, and its depths where it is reprojected.
pub fn upload_for(
    state: &RenderState,
    frame: &PublishedFrame,
    presentation: &Presentation,
    reprojection: Option<&Reprojection>,
) {
    let mut renderer = state.renderer.write();
    let textures = renderer.callback_resources.get_mut::<ViewGpu>().and_then(|gpu| gpu.textures.as_mut());
    if let Some(textures) = textures.filter(|t| t.size == frame.size) {
        let needed = Parts { types: shows_types(presentation), depths: reprojection.is_some() };
        textures.complete(&state.queue, frame, needed);
    }
}

fn shows_types(presentation: &Presentation) -> bool {
    presentation.heatmap != Heatmap::Off || presentation.has_outline
}

/// Uploads the full tracer's picture of the frame's view; a picture of another size is ignored.
pub fn upload_full(state: &RenderState, full: &PublishedFrame) {
    let mut renderer = state.renderer.write();
    let textures = renderer.callback_resources.get_mut::<ViewGpu>().and_then(|gpu| gpu.textures.as_mut());
    if let Some(textures) = textures.filter(|t| t.size == full.size) {
        textures.full.write(&state.queue, &full.radiance);
    }
}

/// Uploads the error map, sRGB; a map of another size than the frame's is ignored.
pub fn upload_errors(state: &RenderState, size: [u32; 2], map: &[[u8; 3]]) {
    let renderer = state.renderer.read();
    let textures = renderer.callback_resources.get::<ViewGpu>().and_then(|gpu| gpu.textures.as_ref());
    if let Some(textures) = textures.filter(|t| t.size == size) {
        let rgba: Vec<[u8; 4]> = map.iter().map(|&[r, g, b]| [r, g, b, u8::MAX]).collect();
        pass::write(&state.queue, &textures.errors, 0, textures.size, bytemuck::cast_slice(&rgba));
    }
}

/// A shape that shows the newest frame in a rectangle, reprojected if `reprojection` is given.
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
    fn features(&self, has_map: bool) -> ShaderFeatures {
        let p = &self.presentation;
        ShaderFeatures {
            is_warped: has_map && self.reprojection.is_some(),
            shows_types: shows_types(p),
            is_overlaid: p.overlay != Overlay::None,
        }
    }

    fn params(&self, size: [u32; 2], map_size: [u32; 2]) -> Params {
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
            map_size,
            // The height always fits: a frame with another aspect ratio is cropped, or has borders
            // on the left and right.
            uv_scale: [self.aspect / frame_aspect, 1.0],
            heatmap: p.heatmap as u32,
            coloring: p.coloring as u32,
            outline: p.has_outline.into(),
            pixels_per_point: self.pixels_per_point,
            overlay,
            split,
        }
    }
}

impl CallbackTrait for Show {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        _screen: &ScreenDescriptor,
        encoder: &mut wgpu::CommandEncoder,
        resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        if let Some(gpu) = resources.get_mut::<ViewGpu>()
            && let Some(textures) = &mut gpu.textures
        {
            let features = self.features(textures.warp.is_some());
            let tone_mapping = ToneMapping::new(&self.presentation);
            gpu.tone_map.run(queue, encoder, &mut textures.color, tone_mapping);
            if features.is_overlaid {
                gpu.tone_map.run(queue, encoder, &mut textures.full, tone_mapping);
            }
            let map = textures.warp.as_ref();
            if let Some(((reprojection, timewarp), map)) =
                self.reprojection.as_ref().zip(gpu.timewarp.as_ref()).zip(map)
            {
                timewarp.draw(queue, encoder, map, reprojection);
            }
            let params = self.params(textures.size, map.map_or([1, 1], |map| map.size));
            queue.write_buffer(&gpu.params, 0, bytemuck::bytes_of(&params));
            gpu.make_pipeline(device, features);
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
            && let Some(pipeline) = gpu.pipeline(self.features(textures.warp.is_some()))
        {
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &textures.bind_group, &[]);
            pass.draw(0..3, 0..1);
        }
    }
}

impl ViewGpu {
    fn new(adapter: &wgpu::Adapter, device: &wgpu::Device, target: wgpu::TextureFormat) -> Self {
        let filtered = pass::texture_type(wgpu::TextureSampleType::Float { filterable: true });
        let indices = pass::texture_type(wgpu::TextureSampleType::Uint);
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let (unfiltered, uniform) = (pass::UNFILTERED, pass::UNIFORM);
        let bindings = [filtered, sampler, indices, indices, uniform, unfiltered, filtered, filtered];
        let layout = pass::layout(device, "viewport", &bindings);
        Self {
            pipelines: Vec::new(),
            shader: device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("viewport"),
                source: wgpu::ShaderSource::Wgsl(shader_source().into()),
            }),
            target,
            layout,
            sampler: device.create_sampler(&wgpu::SamplerDescriptor {
                label: Some("viewport"),
                mag_filter: wgpu::FilterMode::Linear,
                min_filter: wgpu::FilterMode::Linear,
                ..Default::default()
            }),
            params: pass::uniform_buffer(device, "viewport", size_of::<Params>()),
            tone_map: ToneMapPass::new(device),
            timewarp: Timewarp::new(adapter, device),
            no_map: pass::view(&texture(device, [1, 1], wgpu::TextureFormat::Rgba16Float)),
            textures: None,
        }
    }

    fn pipeline(&self, features: ShaderFeatures) -> Option<&wgpu::RenderPipeline> {
        self.pipelines.iter().find(|(has, _)| *has == features).map(|(_, pipeline)| pipeline)
    }

    fn make_pipeline(&mut self, device: &wgpu::Device, features: ShaderFeatures) {
        if self.pipeline(features).is_none() {
            let constants = [
                ("IS_WARPED", features.is_warped),
                ("SHOWS_TYPES", features.shows_types),
                ("IS_OVERLAID", features.is_overlaid),
                ("DECODES", self.target.is_srgb()),
            ]
            .map(|(name, is_on)| (name, f64::from(u8::from(is_on))));
            let pipeline =
                pass::pipeline(device, "viewport", &self.layout, &self.shader, &constants, self.target);
            self.pipelines.push((features, pipeline));
        }
    }

    fn make_textures(&self, device: &wgpu::Device, size: [u32; 2]) -> Textures {
        let texture = |format| texture(device, size, format);
        let [color, full] = [(); 2].map(|()| self.tone_map.make_textures(device, size));
        let errors = texture(wgpu::TextureFormat::Rgba8Unorm);
        let (types, suppliers) = (texture(wgpu::TextureFormat::R8Uint), texture(wgpu::TextureFormat::R8Uint));
        let warp = self.timewarp.as_ref().map(|timewarp| timewarp.make_map(device, size));
        let map = warp.as_ref().map(|warp| pass::view(&warp.map));
        let [types_view, suppliers_view, errors_view] = [&types, &suppliers, &errors].map(pass::view);
        let resource = wgpu::BindingResource::TextureView;
        let resources = [
            resource(&color.display),
            wgpu::BindingResource::Sampler(&self.sampler),
            resource(&types_view),
            resource(&suppliers_view),
            self.params.as_entire_binding(),
            resource(map.as_ref().unwrap_or(&self.no_map)),
            resource(&full.display),
            resource(&errors_view),
        ];
        let bind_group = pass::bind(device, "viewport", &self.layout, resources);
        let uploaded = Parts::default();
        Textures { size, uploaded, color, types, suppliers, full, errors, warp, bind_group }
    }
}

impl Textures {
    fn complete(&mut self, queue: &wgpu::Queue, frame: &PublishedFrame, needed: Parts) {
        if needed.types && !self.uploaded.types {
            pass::write(queue, &self.types, 0, self.size, &frame.types);
            pass::write(queue, &self.suppliers, 0, self.size, &frame.suppliers);
            self.uploaded.types = true;
        }
        if needed.depths
            && !self.uploaded.depths
            && let Some(warp) = &self.warp
        {
            warp.write(queue, &frame.depth_ranges);
            self.uploaded.depths = true;
        }
    }
}

/// The shader with the colours of pixel types.
fn shader_source() -> String {
    let [r, g, b, _] = FILLED_COLOR.to_array();
    let [type1, type2, type3] = TYPE_SRGB;
    let colors = [("TYPE1", type1), ("TYPE2", type2), ("TYPE3", type3), ("FILLED", [r, g, b])];
    let constant = |(name, [r, g, b]): (&str, [u8; 3])| {
        format!("const {name}: vec3<f32> = vec3<f32>({r}.0, {g}.0, {b}.0) / 255.0;\n")
    };
    colors.map(constant).concat() + include_str!("present.wgsl")
}

/// A texture that is uploaded and read by shaders.
fn texture(device: &wgpu::Device, size: [u32; 2], format: wgpu::TextureFormat) -> wgpu::Texture {
    pass::texture(device, "viewport", size, format, wgpu::TextureUsages::COPY_DST)
}
