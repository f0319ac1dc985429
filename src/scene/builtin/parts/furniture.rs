//! Plinths, framed panels and benches.

use super::materials::Materials;
use crate::scene::builtin::shapes::{Faces, Local, block};
use crate::scene::{MaterialId, SceneBuilder};
use glam::{DVec3, Vec2};

const FRAME_M: [f64; 2] = [0.07, 0.05];
const CANVAS_DEPTH_M: f64 = 0.025;

/// Adds a plinth with base and cap. Returns the frame on top of it.
pub(in crate::scene::builtin) fn plinth(
    b: &mut SceneBuilder,
    p: &Materials,
    frame: &Local,
    height: f64,
) -> Local {
    const BASE_M: f64 = 0.1;
    const CAP_M: f64 = 0.05;
    let slab = |half: f64, y0: f64, y1: f64| [DVec3::new(-half, y0, -half), DVec3::new(half, y1, half)];
    let body = Faces::ALL.without(Faces::BOTTOM).without(Faces::TOP);
    block(b, frame, slab(0.42, 0.0, BASE_M), Faces::ALL.without(Faces::BOTTOM), p.stone);
    block(b, frame, slab(0.36, BASE_M, height - CAP_M), body, p.white);
    block(b, frame, slab(0.40, height - CAP_M, height), Faces::ALL, p.stone);
    frame.moved(DVec3::Y * height)
}

/// Adds a framed panel to a wall, with its middle at the origin of `wall`. The bars of the frame
/// cover the edges of the panel.
pub(in crate::scene::builtin) fn framed(
    b: &mut SceneBuilder,
    wall: &Local,
    size: [f64; 2],
    panel: MaterialId,
    border: MaterialId,
) {
    let [width, depth] = FRAME_M;
    let [w, h] = size.map(|s| s / 2.0);
    let at = |x, y| wall.point(DVec3::new(x, y, CANVAS_DEPTH_M));
    b.add_quad([at(-w, -h), at(w, -h), at(w, h), at(-w, h)], Vec2::ONE, panel);
    let faces = Faces::ALL.without(Faces::BACK);
    let mut bar = |low: [f64; 2], high: [f64; 2], faces| {
        let corners = [DVec3::new(low[0], low[1], 0.0), DVec3::new(high[0], high[1], depth)];
        block(b, wall, corners, faces, border);
    };
    bar([-w - width, h], [w + width, h + width], faces);
    bar([-w - width, -h - width], [w + width, -h], faces);
    let upright = faces.without(Faces::BOTTOM).without(Faces::TOP);
    bar([-w - width, -h], [-w, h], upright);
    bar([w, -h], [w + width, h], upright);
}

/// Adds a bench along the x axis of the frame.
pub(in crate::scene::builtin) fn bench(b: &mut SceneBuilder, p: &Materials, frame: &Local) {
    const HALF_M: [f64; 2] = [0.8, 0.22];
    const HEIGHT_M: f64 = 0.45;
    let [x, z] = HALF_M;
    let seat = [DVec3::new(-x, HEIGHT_M - 0.06, -z), DVec3::new(x, HEIGHT_M, z)];
    block(b, frame, seat, Faces::ALL, p.wood);
    let leg = Faces::ALL.without(Faces::BOTTOM).without(Faces::TOP);
    for side in [-1.0, 1.0] {
        let middle = side * (x - 0.15);
        let low = DVec3::new(middle - 0.04, 0.0, -z + 0.04);
        let high = DVec3::new(middle + 0.04, HEIGHT_M - 0.06, z - 0.04);
        block(b, frame, [low, high], leg, p.iron);
    }
}
