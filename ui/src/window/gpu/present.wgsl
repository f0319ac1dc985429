// Shows a finished frame that was developed, and the types of its pixels.

// What a picture does not need is not in its shader: a processor that draws runs both sides of every branch.
override IS_WARPED: bool;        // the map says where in the frame a pixel is found
override SHOWS_TYPES: bool;      // heatmap or outline
override IS_OVERLAID: bool;      // with the full tracer's picture or the map of errors
override DECODES: bool;          // the target encodes what it is given, so it wants linear colour

struct Params {
    size: vec2<u32>,         // of the frame, pixels
    map_size: vec2<u32>,     // of the map, pixels
    uv_scale: vec2<f32>,     // viewport uv -> frame uv about the centre: the frame keeps its shape
    heatmap: u32,            // 0 off, 1 blended, 2 only
    coloring: u32,           // 0 by type, 1 by reference
    outline: u32,            // 1: Type 3 is outlined
    pixels_per_point: f32,
    overlay: u32,            // 1 the full tracer's picture, 2 the map of errors
    split: f32,              // overlays begin at this part of the width
};

@group(0) @binding(0) var color: texture_2d<f32>;
@group(0) @binding(1) var color_sampler: sampler;
@group(0) @binding(2) var types: texture_2d<u32>;
@group(0) @binding(3) var suppliers: texture_2d<u32>;
@group(0) @binding(4) var<uniform> given: array<vec4<u32>, 3>; // Params as the program lays them out
@group(0) @binding(5) var map: texture_2d<f32>;
@group(0) @binding(6) var full: texture_2d<f32>;
@group(0) @binding(7) var errors: texture_2d<f32>;

struct Vertex {
    @builtin(position) position: vec4<f32>,
    @location(0) uv: vec2<f32>,
    @location(1) @interpolate(flat) p0: vec4<u32>,
    @location(2) @interpolate(flat) p1: vec4<u32>,
    @location(3) @interpolate(flat) p2: vec4<u32>,
};

// Lavapipe (Mesa 22) compiles a fragment shader anew for each value of a uniform that it branches on, at every draw, half
// a megabyte each. What comes from the vertex shader it leaves alone.
var<private> p: Params;

fn unpack(v: Vertex) {
    p.size = v.p0.xy;
    p.map_size = v.p0.zw;
    p.uv_scale = bitcast<vec2<f32>>(v.p1.xy);
    p.heatmap = v.p1.z;
    p.coloring = v.p1.w;
    p.outline = v.p2.x;
    p.pixels_per_point = bitcast<f32>(v.p2.y);
    p.overlay = v.p2.z;
    p.split = bitcast<f32>(v.p2.w);
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
    return v;
}

fn linear_from_srgb(c: vec3<f32>) -> vec3<f32> {
    return select(pow((c + 0.055) / 1.055, vec3<f32>(2.4)), c / 12.92, c <= vec3<f32>(0.04045));
}

// A pixel that the frame did not see: filled from beside it until the next frame.
const FILLED: vec3<f32> = vec3<f32>(204.0, 121.0, 167.0) / 255.0;

fn pixel_at(uv: vec2<f32>, size: vec2<u32>) -> vec2<i32> {
    return clamp(vec2<i32>(uv * vec2<f32>(size)), vec2<i32>(0), vec2<i32>(size) - vec2<i32>(1));
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
    return textureSampleLevel(full, color_sampler, uv, 0.0).rgb;
}

fn with_types(shown: vec3<f32>, pixel: vec2<i32>, position: vec2<f32>, is_filled: bool) -> vec3<f32> {
    var mixed = shown;
    let t = textureLoad(types, pixel, 0).x;
    if (p.heatmap != 0u) {
        var tint = color_of_type(t, position);
        if (p.coloring == 1u) {
            tint = color_of_reference(textureLoad(suppliers, pixel, 0).x, position);
        }
        if (is_filled) {
            tint = FILLED * hatch(position);
        }
        mixed = select(tint, mix(mixed, tint, 0.5), p.heatmap == 1u);
    }
    if (p.outline == 1u && is_on_edge(pixel, t)) {
        mixed = vec3<f32>(213.0, 94.0, 0.0) / 255.0;
    }
    return mixed;
}

@fragment
fn fragment(v: Vertex) -> @location(0) vec4<f32> {
    unpack(v);
    var uv = (v.uv - 0.5) * p.uv_scale + 0.5;
    let is_beside = any(uv < vec2<f32>(0.0)) || any(uv > vec2<f32>(1.0));
    var is_filled = false;
    if (IS_WARPED) {
        let moved = textureLoad(map, pixel_at(uv, p.map_size), 0);
        uv += moved.xy / vec2<f32>(p.size);
        is_filled = moved.z > 0.5;
    }
    var shown = textureSampleLevel(color, color_sampler, uv, 0.0).rgb;
    if (SHOWS_TYPES) {
        shown = with_types(shown, pixel_at(uv, p.size), v.position.xy, is_filled);
    }
    if (IS_OVERLAID && v.uv.x >= p.split) {
        shown = overlaid(uv);
    }
    if (DECODES) {
        shown = linear_from_srgb(shown);
    }
    return vec4<f32>(select(shown, vec3<f32>(0.0), is_beside), 1.0);
}
