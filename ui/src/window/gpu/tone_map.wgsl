// Tone-maps radiance for display, one pixel of the frame per pixel of the target. The operations
// are those of src/raster/color.rs.

struct Params {
    exposure: f32, // scale factor of radiance
    tone_map: u32, // 0 ACES, 1 linear
};

@group(0) @binding(0) var radiance: texture_2d<f32>;
@group(0) @binding(1) var<uniform> given: vec4<u32>; // bits of Params

struct Vertex {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) params: vec4<u32>, // see present.wgsl
};

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> Vertex {
    let xy = vec2<f32>(f32((i << 1u) & 2u), f32(i & 2u));
    return Vertex(vec4<f32>(xy * 2.0 - 1.0, 0.0, 1.0), given);
}

// Applies exposure and tone map.
fn tone_mapped(radiance: vec3<f32>, p: Params) -> vec3<f32> {
    let x = clamp(radiance * p.exposure, vec3<f32>(0.0), vec3<f32>(65504.0));
    if (p.tone_map == 1u) {
        return min(x, vec3<f32>(1.0));
    }
    let aces = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
    return clamp(aces, vec3<f32>(0.0), vec3<f32>(1.0));
}

// Encodes sRGB.
fn srgb_from_linear(c: vec3<f32>) -> vec3<f32> {
    return select(1.055 * pow(c, vec3<f32>(1.0 / 2.4)) - 0.055, 12.92 * c, c <= vec3<f32>(0.0031308));
}

@fragment
fn fragment(v: Vertex) -> @location(0) vec4<f32> {
    let p = Params(bitcast<f32>(v.params.x), v.params.y);
    let texel = textureLoad(radiance, vec2<i32>(v.position.xy), 0).rgb;
    return vec4<f32>(srgb_from_linear(tone_mapped(texel, p)), 1.0);
}
