// Tone-maps radiance for display, one pixel of the frame per pixel of the target, or colours values.
// The operations are those of src/raster/color.rs and src/raster/false_color.rs. tone_map.rs
// prepends the colours of values.

struct Params {
    scale: f32,     // scale factor of radiance; share of the scale for a value of one
    tone_map: u32,  // 0 ACES, 1 linear
    kind: u32,      // 0 picture, 1 values, 2 clay
    line_step: f32, // distance of lines as a share of the scale, 0 for none
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
    let x = clamp(radiance * p.scale, vec3<f32>(0.0), vec3<f32>(65504.0));
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

// True for a pixel without a value: quantity.rs packs it as the largest green.
fn is_without_value(texel: vec3<f32>) -> bool {
    return texel.r == 0.0 && texel.g > 60000.0;
}

// The colour of a share of the scale.
fn color_of_share(share: f32) -> vec3<f32> {
    let at = clamp(share, 0.0, 1.0) * f32(STOP_COUNT - 1u);
    let below = min(u32(at), STOP_COUNT - 2u);
    return mix(stop(below), stop(below + 1u), at - f32(below));
}

// True where a line of equal value passes between a pixel and a neighbour of the same surface.
fn is_line(share: f32, to: vec2<i32>, p: Params) -> bool {
    let texel = textureLoad(radiance, to, 0).rgb;
    return !is_without_value(texel) && floor(share / p.line_step) != floor(texel.r * p.scale / p.line_step);
}

// The colour of a value, or of a line of equal value. Green and blue are zero where the surface
// ends to the right and below.
fn false_color(at: vec2<i32>, texel: vec3<f32>, p: Params) -> vec3<f32> {
    if (is_without_value(texel)) {
        return no_value_color();
    }
    let share = texel.r * p.scale;
    if (p.line_step > 0.0) {
        let right = texel.g == texel.r && is_line(share, at + vec2<i32>(1, 0), p);
        if (right || (texel.b == texel.r && is_line(share, at + vec2<i32>(0, 1), p))) {
            return select(vec3<f32>(1.0), vec3<f32>(0.0), share > BRIGHT);
        }
    }
    return color_of_share(share);
}

@fragment
fn fragment(v: Vertex) -> @location(0) vec4<f32> {
    let p = Params(bitcast<f32>(v.params.x), v.params.y, v.params.z, bitcast<f32>(v.params.w));
    let at = vec2<i32>(v.position.xy);
    let texel = textureLoad(radiance, at, 0).rgb;
    if (p.kind == 1u) {
        return vec4<f32>(false_color(at, texel, p), 1.0);
    }
    if (p.kind == 2u && is_without_value(texel)) {
        return vec4<f32>(vec3<f32>(0.85), 1.0);
    }
    return vec4<f32>(srgb_from_linear(tone_mapped(texel, p)), 1.0);
}
