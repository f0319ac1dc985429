// Where each pixel of a new view is found in the last frame. Pixels of both have the frame's size; see timewarp.rs.

struct Warp {
    source_from_target: mat3x3<f32>, // frame pixel (x, y, 1) from a pixel of the new view, infinitely far
    epipole: vec3<f32>,              // what inverse depth adds to it
    target_from_source: mat3x3<f32>, // the way back
    back: vec3<f32>,                 // what disparity adds on the way back
    size: vec2<u32>,
    most_steps: u32,
    nearest: f32,                    // the frame's largest disparity
};

@group(0) @binding(0) var disparity: texture_2d<f32>;
@group(0) @binding(1) var<uniform> given: array<vec4<u32>, 9>; // Warp as the program lays it out

struct Vertex {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat) w0: vec4<u32>,
    @location(1) @interpolate(flat) w1: vec4<u32>,
    @location(2) @interpolate(flat) w2: vec4<u32>,
    @location(3) @interpolate(flat) w3: vec4<u32>,
    @location(4) @interpolate(flat) w4: vec4<u32>,
    @location(5) @interpolate(flat) w5: vec4<u32>,
    @location(6) @interpolate(flat) w6: vec4<u32>,
    @location(7) @interpolate(flat) w7: vec4<u32>,
    @location(8) @interpolate(flat) w8: vec4<u32>,
};

// As in present.wgsl: no uniform is read where the fragment shader branches on it.
var<private> warp: Warp;

fn floats(bits: vec4<u32>) -> vec3<f32> {
    return bitcast<vec3<f32>>(bits.xyz);
}

fn unpack(v: Vertex) {
    warp.source_from_target = mat3x3<f32>(floats(v.w0), floats(v.w1), floats(v.w2));
    warp.epipole = floats(v.w3);
    warp.target_from_source = mat3x3<f32>(floats(v.w4), floats(v.w5), floats(v.w6));
    warp.back = floats(v.w7);
    warp.size = v.w8.xy;
    warp.most_steps = v.w8.z;
    warp.nearest = bitcast<f32>(v.w8.w);
}

// A source pixel covers a target pixel where it lands no farther from its centre, in pixels: room for surfaces that
// motion enlarges by three quarters (half a diagonal is 0.7).
const REACH: f32 = 1.25;

// Halvings of a stride once a surface was passed: from three pixels to less than half a one.
const HALVINGS: u32 = 3u;

// Nearer than this part of the nearest depth nothing can be found: what is passed by is gone.
const LEAST_LEFT: f32 = 0.25;

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> Vertex {
    let xy = vec2<f32>(f32((i << 1u) & 2u), f32(i & 2u));
    return Vertex(
        vec4<f32>(xy * 2.0 - 1.0, 0.0, 1.0),
        given[0], given[1], given[2], given[3], given[4], given[5], given[6], given[7], given[8],
    );
}

fn is_inside(at: vec2<f32>) -> bool {
    return all(at >= vec2<f32>(0.0)) && all(at < vec2<f32>(warp.size));
}

fn surface(at: vec2<f32>) -> f32 {
    return textureLoad(disparity, vec2<i32>(at), 0).x;
}

// How far from a target pixel the surface at a point of the frame is seen in the new view, in pixels.
fn missed(source: vec2<f32>, target_pixel: vec2<f32>) -> vec2<f32> {
    let q = warp.target_from_source * vec3<f32>(source, 1.0) + surface(source) * warp.back;
    if (q.z <= 0.0) {
        return vec2<f32>(3.0 * REACH);
    }
    return q.xy / q.z - target_pixel;
}

fn filled(source: vec2<f32>, at: vec2<f32>) -> vec4<f32> {
    return vec4<f32>(source - at, 1.0, 1.0);
}

@fragment
fn fragment(v: Vertex) -> @location(0) vec4<f32> {
    unpack(v);
    let at = v.position.xy;
    let far = warp.source_from_target * vec3<f32>(at, 1.0);
    if (far.z <= 0.0) {
        return filled(vec2<f32>(warp.size) * 0.5, at);
    }
    let left = max(1.0 - warp.nearest * warp.epipole.z, LEAST_LEFT);
    let near = far + warp.epipole * (warp.nearest * far.z / left);
    let start = near.xy / near.z;
    let way = far.xy / far.z - start;
    // On the line, disparity falls evenly from the nearest there can be to zero.
    let first = warp.nearest * far.z / left / near.z;
    let steps = clamp(u32(ceil(length(way))), 1u, warp.most_steps);
    let stride = 1.0 / f32(steps);
    var was_before = true;
    var farthest = 3.4e38;
    var stand_in = start + way;
    var i = 0u;
    // Looking closer stands outside the walk: a processor that draws eight pixels at once looks closer for all of them
    // together, or at every step.
    loop {
        var passed = false;
        for (; i <= steps && !passed; i++) {
            let part = f32(i) * stride;
            let source = start + way * part;
            if (!is_inside(source)) {
                was_before = true;
                continue;
            }
            let d = surface(source);
            let is_before = first * (1.0 - part) > d;
            passed = !is_before && was_before;
            was_before = is_before;
            if (d < farthest) {
                farthest = d;
                stand_in = source;
            }
        }
        if (!passed) {
            break;
        }
        // Between the last step and the one before it the ray passed a surface, or the edge of one.
        var high = f32(i - 1u) * stride;
        var low = max(high - stride, 0.0);
        for (var j = 0u; j < HALVINGS; j++) {
            let middle = (low + high) * 0.5;
            let there = start + way * middle;
            if (is_inside(there) && first * (1.0 - middle) <= surface(there)) {
                high = middle;
            } else {
                low = middle;
            }
        }
        let hit = start + way * high;
        let off = missed(hit, at);
        if (length(off) <= REACH) {
            return vec4<f32>(hit - off - at, 0.0, 1.0);
        }
    }
    return filled(stand_in, at);
}
