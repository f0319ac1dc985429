// Where each pixel of a new view is found in the last frame. Coordinates are pixels of the frame's size; see timewarp.rs.

struct Warp {
    source_from_target: mat3x3<f32>, // frame pixel (x, y, 1) from a pixel of the new view, infinitely far
    epipole: vec3<f32>,              // what inverse depth adds to it
    target_from_source: mat3x3<f32>, // the way back
    back: vec3<f32>,                 // what disparity adds on the way back
    size: vec2<u32>,
    most_steps: u32,
    nearest: f32,                    // the frame's largest disparity
    pixels_per_texel: f32,           // pixels of the frame for one of the map, along each axis
};

// The largest and the smallest disparity of each square of 2^level pixels a side.
@group(0) @binding(0) var ranges: texture_2d<f32>;
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
    warp.pixels_per_texel = bitcast<f32>(v.w3.w);
    warp.target_from_source = mat3x3<f32>(floats(v.w4), floats(v.w5), floats(v.w6));
    warp.back = floats(v.w7);
    warp.size = v.w8.xy;
    warp.most_steps = v.w8.z;
    warp.nearest = bitcast<f32>(v.w8.w);
}

// A source pixel covers a target pixel where it lands no farther from its centre, in pixels: room for surfaces that
// motion enlarges by three quarters (half a diagonal is 0.7).
const REACH: f32 = 1.25;

// A step over the border of a cell ends so far behind it, in pixels.
const OVER: f32 = 1.0 / 64.0;

// What stands in for a hidden surface is taken so far beside what hid it, in pixels.
const BESIDE: f32 = 0.5;

// Stands for zero where it is divided by: less than any way over a frame, in pixels, and than any disparity.
const LEAST: f32 = 1.0e-20;

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

// A line on the frame, in pixels; disparity of the ray falls evenly along it.
struct Line {
    start: vec2<f32>,
    way: vec2<f32>,
    first: f32, // disparity at its start
    last: f32,
};

fn point(line: Line, part: f32) -> vec2<f32> {
    return clamp(line.start + line.way * part, vec2<f32>(0.0), vec2<f32>(warp.size) - OVER);
}

// The way with no part of it zero.
fn divisible(way: vec2<f32>) -> vec2<f32> {
    return select(way, vec2<f32>(LEAST), abs(way) < vec2<f32>(LEAST));
}

// What is left of a line within the frame; nothing where x > y.
fn part_inside(line: Line) -> vec2<f32> {
    let way = divisible(line.way);
    let t0 = -line.start / way;
    let t1 = (vec2<f32>(warp.size) - line.start) / way;
    let near = min(t0, t1);
    let far = max(t0, t1);
    return vec2<f32>(max(max(near.x, near.y), 0.0), min(min(far.x, far.y), 1.0));
}

// How far from a target pixel a surface of the frame is seen in the new view, in pixels.
fn missed(source: vec2<f32>, d: f32, target_pixel: vec2<f32>) -> vec2<f32> {
    let q = warp.target_from_source * vec3<f32>(source, 1.0) + d * warp.back;
    if (q.z <= 0.0) {
        return vec2<f32>(3.0 * REACH);
    }
    return q.xy / q.z - target_pixel;
}

fn filled(source: vec2<f32>, at: vec2<f32>) -> vec4<f32> {
    return vec4<f32>(source - at, 1.0, 1.0);
}

fn depth_at(source: vec2<f32>) -> f32 {
    return textureLoad(ranges, vec2<i32>(source), 0).x;
}

// The surface that the line's ray meets first. Cells of pixels in which it stays before all surfaces, or behind all, are
// passed in one step.
fn found(line: Line, at: vec2<f32>) -> vec4<f32> {
    let pixel = 1.0 / max(length(line.way), OVER);
    let over = OVER * pixel;
    let side = select(vec2<f32>(0.0), vec2<f32>(1.0), divisible(line.way) > vec2<f32>(0.0));
    let parts_per_pixel = 1.0 / divisible(line.way);
    let top = textureNumLevels(ranges) - 1u;
    var level = 0u;
    var part = 0.0;
    var was_before = true;
    // Where it went behind a surface that it did not meet, and where it came out: what is beside them stands in.
    var entry = 1.0;
    var exit = 1.0;
    for (var i = 0u; i < warp.most_steps && part < 1.0; i++) {
        let side_pixels = f32(1u << level);
        let cell = floor(point(line, part + over) / side_pixels);
        let range = textureLoad(ranges, vec2<i32>(cell), i32(level)).xy;
        let ends = ((cell + side) * side_pixels - line.start) * parts_per_pixel;
        let end = clamp(min(ends.x, ends.y), part + over, 1.0);
        let r_in = mix(line.first, line.last, part);
        let r_out = mix(line.first, line.last, end);
        if (select(r_in <= range.y, r_out > range.x, was_before)) {
            part = end;
            level = min(level + 1u, top);
        } else if (level > 0u) {
            level -= 1u;
        } else {
            let d = range.x;
            if (!was_before && r_in > d) {
                exit = part + BESIDE * pixel;
                was_before = true;
            }
            if (was_before && r_out <= d) {
                let crossing = (line.first - d) / max(line.first - line.last, LEAST);
                let hit = point(line, clamp(crossing, part, end));
                let off = missed(hit, d, at);
                if (length(off) <= REACH) {
                    return vec4<f32>(hit - off - at, 0.0, 1.0);
                }
                entry = part - BESIDE * pixel;
                was_before = false;
            }
            part = end;
        }
    }
    let before = point(line, entry);
    let behind = point(line, exit);
    return filled(select(before, behind, depth_at(behind) < depth_at(before)), at);
}

@fragment
fn fragment(v: Vertex) -> @location(0) vec4<f32> {
    unpack(v);
    let at = v.position.xy * warp.pixels_per_texel;
    let far = warp.source_from_target * vec3<f32>(at, 1.0);
    if (far.z <= 0.0) {
        return filled(vec2<f32>(warp.size) * 0.5, at);
    }
    let left = max(1.0 - warp.nearest * warp.epipole.z, LEAST_LEFT);
    let near = far + warp.epipole * (warp.nearest * far.z / left);
    let first = warp.nearest * far.z / left / near.z;
    let start = near.xy / near.z;
    let whole = Line(start, far.xy / far.z - start, first, 0.0);
    let inside = part_inside(whole);
    if (inside.x > inside.y) {
        return filled(start + whole.way, at);
    }
    let shorter = whole.way * (inside.y - inside.x);
    return found(
        Line(start + whole.way * inside.x, shorter, first * (1.0 - inside.x), first * (1.0 - inside.y)),
        at,
    );
}
