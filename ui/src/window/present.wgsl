// Shows a finished frame: radiance developed as src/raster/color.rs does it, and the types of its pixels.

struct Params {
    size: vec2<u32>,         // of the frame, pixels
    heatmap: u32,            // 0 off, 1 blended, 2 only
    coloring: u32,           // 0 by type, 1 by reference
    uv_scale: vec2<f32>,     // viewport uv -> frame uv about the centre: the frame keeps its shape
    exposure: f32,           // a factor
    tone_map: u32,           // 0 ACES, 1 linear
    outline: u32,            // 1: Type 3 is outlined
    pixels_per_point: f32,
    encode: u32,             // 1: the target stores what it is given, so sRGB is encoded here
    is_warped: u32,          // 1: the map says where in the frame a pixel is found
    overlay: u32,            // 1 the full tracer's picture, 2 the map of errors
    split: f32,              // overlays begin at this part of the width
};

@group(0) @binding(0) var color: texture_2d<f32>;
@group(0) @binding(1) var color_sampler: sampler;
@group(0) @binding(2) var types: texture_2d<u32>;
@group(0) @binding(3) var suppliers: texture_2d<u32>;
@group(0) @binding(4) var<uniform> given: array<vec4<u32>, 4>; // Params as the program lays them out
@group(0) @binding(5) var map: texture_2d<f32>;
@group(0) @binding(6) var full: texture_2d<f32>;
@group(0) @binding(7) var errors: texture_2d<f32>;

struct Vertex {
    @builtin(position) position: vec4<f32>,
    @location(0) uv: vec2<f32>,
    @location(1) @interpolate(flat) p0: vec4<u32>,
    @location(2) @interpolate(flat) p1: vec4<u32>,
    @location(3) @interpolate(flat) p2: vec4<u32>,
    @location(4) @interpolate(flat) p3: vec4<u32>,
};

// Lavapipe (Mesa 22) compiles a fragment shader anew for each value of a uniform that it branches on, at every draw, half
// a megabyte each. What comes from the vertex shader it leaves alone.
var<private> p: Params;

fn unpack(v: Vertex) {
    p.size = v.p0.xy;
    p.heatmap = v.p0.z;
    p.coloring = v.p0.w;
    p.uv_scale = bitcast<vec2<f32>>(v.p1.xy);
    p.exposure = bitcast<f32>(v.p1.z);
    p.tone_map = v.p1.w;
    p.outline = v.p2.x;
    p.pixels_per_point = bitcast<f32>(v.p2.y);
    p.encode = v.p2.z;
    p.is_warped = v.p2.w;
    p.overlay = v.p3.x;
    p.split = bitcast<f32>(v.p3.y);
}

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> Vertex {
    let xy = vec2<f32>(f32((i << 1u) & 2u), f32(i & 2u));
    var v: Vertex;
    v.position = vec4<f32>(xy * 2.0 - 1.0, 0.0, 1.0);
    v.uv = vec2<f32>(xy.x, 1.0 - xy.y);
    v.p0 = given[0];
    v.p1 = given[1];
    v.p2 = given[2];
    v.p3 = given[3];
    return v;
}

fn developed(radiance: vec3<f32>) -> vec3<f32> {
    let x = clamp(radiance * p.exposure, vec3<f32>(0.0), vec3<f32>(65504.0));
    if (p.tone_map == 1u) {
        return min(x, vec3<f32>(1.0));
    }
    let aces = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
    return clamp(aces, vec3<f32>(0.0), vec3<f32>(1.0));
}

fn srgb_from_linear(c: vec3<f32>) -> vec3<f32> {
    return select(1.055 * pow(c, vec3<f32>(1.0 / 2.4)) - 0.055, 12.92 * c, c <= vec3<f32>(0.0031308));
}

fn linear_from_srgb(c: vec3<f32>) -> vec3<f32> {
    return select(pow((c + 0.055) / 1.055, vec3<f32>(2.4)), c / 12.92, c <= vec3<f32>(0.04045));
}

// A pixel that the frame did not see: filled from beside it until the next frame.
const FILLED: vec3<f32> = vec3<f32>(204.0, 121.0, 167.0) / 255.0;

fn pixel_at(uv: vec2<f32>) -> vec2<i32> {
    return clamp(vec2<i32>(uv * vec2<f32>(p.size)), vec2<i32>(0), vec2<i32>(p.size) - vec2<i32>(1));
}

fn is_type3(t: u32) -> bool {
    return t != 1u && t != 2u;
}

// Told apart by colour-blind people; in grey by the hatch.
fn color_of_type(t: u32, at: vec2<f32>) -> vec3<f32> {
    if (t == 1u) {
        return vec3<f32>(0.0, 114.0, 178.0) / 255.0;
    }
    if (t == 2u) {
        return vec3<f32>(240.0, 228.0, 66.0) / 255.0;
    }
    return vec3<f32>(213.0, 94.0, 0.0) / 255.0 * hatch(at);
}

fn hatch(at: vec2<f32>) -> f32 {
    let period = 8.0 * p.pixels_per_point;
    return select(1.0, 0.55, fract((at.x + at.y) / period) < 0.3);
}

// Hues by the golden ratio: neighbours in number are far apart in colour.
fn color_of_reference(supplier: u32, at: vec2<f32>) -> vec3<f32> {
    if (supplier == 255u) {
        return vec3<f32>(0.3) * hatch(at);
    }
    let hue = fract(f32(supplier) * 0.618034 + 0.58);
    let rgb = clamp(abs(fract(vec3<f32>(hue) + vec3<f32>(0.0, 2.0 / 3.0, 1.0 / 3.0)) * 6.0 - 3.0) - 1.0,
        vec3<f32>(0.0), vec3<f32>(1.0));
    return mix(vec3<f32>(1.0), rgb, 0.7) * 0.9;
}

fn is_on_edge(pixel: vec2<i32>, t: u32) -> bool {
    if (!is_type3(t)) {
        return false;
    }
    let last = vec2<i32>(p.size) - vec2<i32>(1);
    var steps = array<vec2<i32>, 4>(vec2<i32>(1, 0), vec2<i32>(-1, 0), vec2<i32>(0, 1), vec2<i32>(0, -1));
    for (var i = 0; i < 4; i++) {
        let beside = clamp(pixel + steps[i], vec2<i32>(0), last);
        if (!is_type3(textureLoad(types, beside, 0).x)) {
            return true;
        }
    }
    return false;
}

fn overlaid(uv: vec2<f32>) -> vec3<f32> {
    if (p.overlay == 2u) {
        return textureSampleLevel(errors, color_sampler, uv, 0.0).rgb;
    }
    return srgb_from_linear(developed(textureSampleLevel(full, color_sampler, uv, 0.0).rgb));
}

@fragment
fn fragment(v: Vertex) -> @location(0) vec4<f32> {
    unpack(v);
    var uv = (v.uv - 0.5) * p.uv_scale + 0.5;
    let is_beside = any(uv < vec2<f32>(0.0)) || any(uv > vec2<f32>(1.0));
    var is_filled = false;
    if (p.is_warped == 1u && !is_beside) {
        let moved = textureLoad(map, pixel_at(uv), 0);
        uv += moved.xy / vec2<f32>(p.size);
        is_filled = moved.z > 0.5;
    }
    let radiance = textureSampleLevel(color, color_sampler, uv, 0.0).rgb;
    if (is_beside) {
        return vec4<f32>(0.0, 0.0, 0.0, 1.0);
    }
    var shown = srgb_from_linear(developed(radiance));
    let pixel = pixel_at(uv);
    let t = textureLoad(types, pixel, 0).x;
    if (p.heatmap != 0u) {
        var tint = color_of_type(t, v.position.xy);
        if (p.coloring == 1u) {
            tint = color_of_reference(textureLoad(suppliers, pixel, 0).x, v.position.xy);
        }
        if (is_filled) {
            tint = FILLED * hatch(v.position.xy);
        }
        shown = select(tint, mix(shown, tint, 0.5), p.heatmap == 1u);
    }
    if (p.outline == 1u && is_on_edge(pixel, t)) {
        shown = vec3<f32>(213.0, 94.0, 0.0) / 255.0;
    }
    if (p.overlay != 0u && v.uv.x >= p.split) {
        shown = overlaid(uv);
    }
    if (p.encode == 0u) {
        shown = linear_from_srgb(shown);
    }
    return vec4<f32>(shown, 1.0);
}
