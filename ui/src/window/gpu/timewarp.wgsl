// Finds each pixel of a new view in the last frame. Coordinates are in pixels of the frame; see
// timewarp.rs.

struct Warp {
    source_from_target: mat3x3<f32>, // frame pixel (x, y, 1) of a pixel of the new view, at infinity
    epipole: vec3<f32>,              // parallax per inverse depth
    target_from_source: mat3x3<f32>, // inverse mapping
    back: vec3<f32>,                 // parallax per disparity of the inverse mapping
    size: vec2<u32>,
    max_steps: u32,
    nearest: f32,                    // largest disparity of the frame
    pixels_per_texel: f32,           // frame pixels per texel of the map, along each axis
};

// Largest and smallest disparity of each square of 2^level by 2^level pixels.
@group(0) @binding(0) var ranges: texture_2d<f32>;
@group(0) @binding(1) var<uniform> given: array<vec4<u32>, 9>; // bits of Warp

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

// Restored from vertex outputs; see present.wgsl.
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
    warp.max_steps = v.w8.z;
    warp.nearest = bitcast<f32>(v.w8.w);
}

// Maximum distance in pixels at which a source pixel covers a target pixel. Half a diagonal is 0.7
// pixels; the rest allows for surfaces that motion enlarges by three quarters.
const REACH: f32 = 1.25;

// Distance in pixels by which a step ends beyond the border of a cell.
const OVER: f32 = 1.0 / 64.0;

// Distance in pixels from the edge of an occluder at which the fill for a hidden surface is taken.
const FILL_OFFSET: f32 = 0.5;

// Replaces zero in divisors: smaller than any displacement in pixels and than any disparity.
const TINY: f32 = 1.0e-20;

// Minimum remaining fraction of the nearest depth: surfaces that the camera has passed are not
// searched.
const MIN_DEPTH_LEFT: f32 = 0.25;

@vertex
fn vertex(@builtin(vertex_index) i: u32) -> Vertex {
    let xy = vec2<f32>(f32((i << 1u) & 2u), f32(i & 2u));
    return Vertex(
        vec4<f32>(xy * 2.0 - 1.0, 0.0, 1.0),
        given[0], given[1], given[2], given[3], given[4], given[5], given[6], given[7], given[8],
    );
}

// A line in the frame, in pixels. The disparity of the ray falls linearly along it.
struct Line {
    start: vec2<f32>,
    direction: vec2<f32>, // from start to end
    first: f32, // disparity at its start
    last: f32,  // disparity at its end
};

// The point at a fraction of a line.
fn point(line: Line, part: f32) -> vec2<f32> {
    return clamp(line.start + line.direction * part, vec2<f32>(0.0), vec2<f32>(warp.size) - OVER);
}

// A vector with zero components replaced, for division.
fn divisible(v: vec2<f32>) -> vec2<f32> {
    return select(v, vec2<f32>(TINY), abs(v) < vec2<f32>(TINY));
}

// Clips a line to the frame: fractions of its start and end, empty if x > y.
fn part_inside(line: Line) -> vec2<f32> {
    let direction = divisible(line.direction);
    let t0 = -line.start / direction;
    let t1 = (vec2<f32>(warp.size) - line.start) / direction;
    let near = min(t0, t1);
    let far = max(t0, t1);
    return vec2<f32>(max(max(near.x, near.y), 0.0), min(min(far.x, far.y), 1.0));
}

// Offset in pixels from a target pixel to the projection of a source pixel with disparity d in the
// new view.
fn missed(source: vec2<f32>, d: f32, target_pixel: vec2<f32>) -> vec2<f32> {
    let q = warp.target_from_source * vec3<f32>(source, 1.0) + d * warp.back;
    if (q.z <= 0.0) {
        return vec2<f32>(3.0 * REACH);
    }
    return q.xy / q.z - target_pixel;
}

// Displacement to a fill.
fn filled(source: vec2<f32>, at: vec2<f32>) -> vec4<f32> {
    return vec4<f32>(source - at, 1.0, 1.0);
}

// Disparity of a source pixel.
fn disparity_at(source: vec2<f32>) -> f32 {
    return textureLoad(ranges, vec2<i32>(source), 0).x;
}

// Finds the first surface on the ray of a line. Cells in which the ray stays in front of all
// surfaces, or behind all, are skipped in one step.
fn found(line: Line, at: vec2<f32>) -> vec4<f32> {
    let pixel = 1.0 / max(length(line.direction), OVER);
    let over = OVER * pixel;
    let side = select(vec2<f32>(0.0), vec2<f32>(1.0), divisible(line.direction) > vec2<f32>(0.0));
    let parts_per_pixel = 1.0 / divisible(line.direction);
    let top = textureNumLevels(ranges) - 1u;
    var level = 0u;
    var part = 0.0;
    var was_before = true;
    // Where the ray went behind a surface without meeting it, and where it came out again: the
    // candidates for filling.
    var entry = 1.0;
    var exit = 1.0;
    for (var i = 0u; i < warp.max_steps && part < 1.0; i++) {
        // Find the cell of the current level and the disparities in it.
        let side_pixels = f32(1u << level);
        let cell = floor(point(line, part + over) / side_pixels);
        let range = textureLoad(ranges, vec2<i32>(cell), i32(level)).xy;
        // Find where the ray leaves the cell, and its disparities there.
        let ends = ((cell + side) * side_pixels - line.start) * parts_per_pixel;
        let end = clamp(min(ends.x, ends.y), part + over, 1.0);
        let r_in = mix(line.first, line.last, part);
        let r_out = mix(line.first, line.last, end);
        if (select(r_in <= range.y, r_out > range.x, was_before)) {
            // Skip the cell and try a coarser level.
            part = end;
            level = min(level + 1u, top);
        } else if (level > 0u) {
            // Refine.
            level -= 1u;
        } else {
            // Test the pixel.
            let d = range.x;
            if (!was_before && r_in > d) {
                exit = part + FILL_OFFSET * pixel;
                was_before = true;
            }
            if (was_before && r_out <= d) {
                let crossing = (line.first - d) / max(line.first - line.last, TINY);
                let hit = point(line, clamp(crossing, part, end));
                let off = missed(hit, d, at);
                if (length(off) <= REACH) {
                    return vec4<f32>(hit - off - at, 0.0, 1.0);
                }
                entry = part - FILL_OFFSET * pixel;
                was_before = false;
            }
            part = end;
        }
    }
    // Nothing was met: fill from the farther side of the occluder.
    let before = point(line, entry);
    let behind = point(line, exit);
    return filled(select(before, behind, disparity_at(behind) < disparity_at(before)), at);
}

@fragment
fn fragment(v: Vertex) -> @location(0) vec4<f32> {
    unpack(v);
    let at = v.position.xy * warp.pixels_per_texel;
    // Map the far end of the ray.
    let far = warp.source_from_target * vec3<f32>(at, 1.0);
    if (far.z <= 0.0) {
        return filled(vec2<f32>(warp.size) * 0.5, at);
    }
    // Map its near end, at the nearest depth of the frame.
    let left = max(1.0 - warp.nearest * warp.epipole.z, MIN_DEPTH_LEFT);
    let near = far + warp.epipole * (warp.nearest * far.z / left);
    let first = warp.nearest * far.z / left / near.z;
    let start = near.xy / near.z;
    // Clip the line to the frame and march.
    let whole = Line(start, far.xy / far.z - start, first, 0.0);
    let inside = part_inside(whole);
    if (inside.x > inside.y) {
        return filled(start + whole.direction, at);
    }
    let shorter = whole.direction * (inside.y - inside.x);
    return found(
        Line(start + whole.direction * inside.x, shorter, first * (1.0 - inside.x), first * (1.0 - inside.y)),
        at,
    );
}
