// Shows a tone-mapped frame and the types of its pixels. viewport.rs prepends the constants TYPE1,
// TYPE2, TYPE3 and FILLED, the colours of the heatmap.

// Each combination is a pipeline of its own, because software rasterizers execute both sides of
// every branch.
override IS_WARPED: bool;        // the frame is reprojected by the map
override SHOWS_TYPES: bool;      // heatmap or outline is shown
override IS_OVERLAID: bool;      // the full tracer's picture or the error map is shown
override DECODES: bool;          // the target encodes sRGB itself, so output is linear

struct Params {
    size: vec2<u32>,         // size of the frame, pixels
    map_size: vec2<u32>,     // size of the map, pixels
    uv_scale: vec2<f32>,     // viewport uv to frame uv about the centre; keeps the aspect ratio
    heatmap: u32,            // 0 off, 1 blended, 2 only
    coloring: u32,           // 0 by type, 1 by reference
    outline: u32,            // 1: outline Type 3
    pixels_per_point: f32,
    overlay: u32,            // 1 the full tracer's picture, 2 the error map
    split: f32,              // overlays begin at this fraction of the width
};

@group(0) @binding(0) var color: texture_2d<f32>;
@group(0) @binding(1) var color_sampler: sampler;
@group(0) @binding(2) var types: texture_2d<u32>;
@group(0) @binding(3) var suppliers: texture_2d<u32>;
@group(0) @binding(4) var<uniform> given: array<vec4<u32>, 3>; // bits of Params
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

// The vertex shader passes the uniforms on, because lavapipe (Mesa 22) recompiles a fragment shader
// at every draw for each value of a uniform that it branches on, at half a megabyte each.
var<private> p: Params;

// Restores the parameters from their bits.
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

// Decodes sRGB.
fn linear_from_srgb(c: vec3<f32>) -> vec3<f32> {
    return select(pow((c + 0.055) / 1.055, vec3<f32>(2.4)), c / 12.92, c <= vec3<f32>(0.04045));
}

// The pixel that contains a uv coordinate.
fn pixel_at(uv: vec2<f32>, size: vec2<u32>) -> vec2<i32> {
    return clamp(vec2<i32>(uv * vec2<f32>(size)), vec2<i32>(0), vec2<i32>(size) - vec2<i32>(1));
}

fn is_type3(t: u32) -> bool {
    return t != 1u && t != 2u;
}

// Distinct under colour blindness; in greyscale, the hatch marks Type 3.
fn color_of_type(t: u32, at: vec2<f32>) -> vec3<f32> {
    if (t == 1u) {
        return TYPE1;
    }
    if (t == 2u) {
        return TYPE2;
    }
    return TYPE3 * hatch(at);
}

// Diagonal stripes with a period of 8 points.
fn hatch(at: vec2<f32>) -> f32 {
    let period = 8.0 * p.pixels_per_point;
    return select(1.0, 0.55, fract((at.x + at.y) / period) < 0.3);
}

// Hues are spaced by the golden ratio, so that consecutive references have distinct colours.
fn color_of_reference(supplier: u32, at: vec2<f32>) -> vec3<f32> {
    if (supplier == 255u) {
        return vec3<f32>(0.3) * hatch(at);
    }
    let hue = fract(f32(supplier) * 0.618034 + 0.58);
    let rgb = clamp(abs(fract(vec3<f32>(hue) + vec3<f32>(0.0, 2.0 / 3.0, 1.0 / 3.0)) * 6.0 - 3.0) - 1.0,
        vec3<f32>(0.0), vec3<f32>(1.0));
    return mix(vec3<f32>(1.0), rgb, 0.7) * 0.9;
}

// True if a pixel of Type 3 has a neighbour of another type.
fn is_on_edge(pixel: vec2<i32>, t: u32) -> bool {
    if (!is_type3(t)) {
        return false;
    }
    let last = vec2<i32>(p.size) - vec2<i32>(1);
    var steps = array<vec2<i32>, 4>(vec2<i32>(1, 0), vec2<i32>(-1, 0), vec2<i32>(0, 1), vec2<i32>(0, -1));
    for (var i = 0; i < 4; i++) {
        let neighbour = clamp(pixel + steps[i], vec2<i32>(0), last);
        if (!is_type3(textureLoad(types, neighbour, 0).x)) {
            return true;
        }
    }
    return false;
}

// The overlay for comparison with the full tracer.
fn overlaid(uv: vec2<f32>) -> vec3<f32> {
    if (p.overlay == 2u) {
        return textureSampleLevel(errors, color_sampler, uv, 0.0).rgb;
    }
    return textureSampleLevel(full, color_sampler, uv, 0.0).rgb;
}

// Adds heatmap and outline to a colour.
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
        mixed = TYPE3;
    }
    return mixed;
}

@fragment
fn fragment(v: Vertex) -> @location(0) vec4<f32> {
    unpack(v);
    // Fit the frame into the viewport.
    var uv = (v.uv - 0.5) * p.uv_scale + 0.5;
    let is_outside = any(uv < vec2<f32>(0.0)) || any(uv > vec2<f32>(1.0));
    var is_filled = false;
    // Follow the map to the source pixel.
    if (IS_WARPED) {
        let moved = textureLoad(map, pixel_at(uv, p.map_size), 0);
        uv += moved.xy / vec2<f32>(p.size);
        is_filled = moved.z > 0.5;
    }
    // Sample the frame, then add types and overlay.
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
    return vec4<f32>(select(shown, vec3<f32>(0.0), is_outside), 1.0);
}
