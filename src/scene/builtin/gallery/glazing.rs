//! Windows and the glazed entrance: frames, panes of thin glass, sills and casings.

use super::palette::Palette;
use super::plan::{GAPS, RoomName, SILL_M};
use crate::scene::SceneBuilder;
use crate::scene::builtin::parts::{Facing, Gap, WALL_M};
use crate::scene::builtin::shapes::{Faces, Local, block};
use glam::{DVec2, DVec3, Vec2};

/// Bars of a frame: width and depth in metres, and how far the frame reaches into the wall, so that
/// no face of it lies on one of the wall.
const FRAME_M: [f64; 3] = [0.07, 0.09, 0.01];
const BAR_M: [f64; 2] = [0.045, 0.06];
const TRANSOM_M: [f64; 2] = [0.06, 0.07];

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    for gap in &GAPS {
        let [x, z] = gap.middle;
        let is_outside = if gap.in_wall_along_x { z > 23.0 } else { x > 33.0 };
        if is_outside {
            glaze(b, p, gap);
        }
    }
    for name in [RoomName::LongGallery, RoomName::GardenRoom] {
        for facing in Facing::ALL {
            for window in name.room().side(facing).openings.iter().filter(|o| o.height[0] == SILL_M) {
                sill(b, p, &name.room().side(facing).frame, window.along);
            }
        }
    }
}

/// Adds frame and glass in the middle of a wall's thickness.
fn glaze(b: &mut SceneBuilder, p: &Palette, gap: &Gap) {
    let x = if gap.in_wall_along_x { DVec3::X } else { DVec3::Z };
    let frame = Local { origin: DVec3::new(gap.middle[0], 0.0, gap.middle[1]), x };
    let (half, [foot, head]) = (gap.width / 2.0, gap.height);
    let is_door = foot == 0.0;
    let mut bar = |low: DVec2, high: DVec2, depth: f64| {
        let corners = [low.extend(-depth / 2.0), high.extend(depth / 2.0)];
        block(b, &frame, corners, Faces::ALL, p.parts.black);
    };
    let at = DVec2::new;
    let [width, depth, into] = FRAME_M;
    bar(at(-half - into, foot - into), at(-half + width, head + into), depth);
    bar(at(half - width, foot - into), at(half + into, head + into), depth);
    bar(at(-half + width, head - width), at(half - width, head + into), depth);
    bar(at(-half + width, foot - into), at(half - width, foot + width), depth);
    let transom = if is_door { 2.35 } else { foot + 0.68 * (head - foot) };
    let [height, depth] = TRANSOM_M;
    bar(at(-half + width, transom - height / 2.0), at(half - width, transom + height / 2.0), depth);
    let [width, depth] = BAR_M;
    for share in if is_door { &[-0.5, 0.0, 0.5][..] } else { &[-0.333, 0.333][..] } {
        let x = share * gap.width;
        bar(at(x - width / 2.0, foot), at(x + width / 2.0, head), depth);
    }
    if is_door {
        bar(at(-half, 0.03), at(half, 0.3), 0.05);
    }
    // People who hang drawings want even light: the window of the long gallery is frosted.
    let glass = if gap.middle[0] < 10.0 { p.frosted_glass } else { p.window_glass };
    let pane = [[-half, foot], [half, foot], [half, head], [-half, head]];
    b.add_quad(pane.map(|[x, y]| frame.point(DVec3::new(x, y, 0.0))), Vec2::ONE, glass);
}

/// Adds a sill to the inside of a wall, with a board below it.
fn sill(b: &mut SceneBuilder, p: &Palette, side: &Local, [x0, x1]: [f64; 2]) {
    let over = 0.16;
    let top = [DVec3::new(x0 - over, SILL_M - 0.045, 0.0), DVec3::new(x1 + over, SILL_M + 0.003, 0.17)];
    let faces = Faces::ALL.without(Faces::BACK);
    block(b, side, top, faces, p.parts.wood);
    let apron = [DVec3::new(x0 - 0.12, SILL_M - 0.16, 0.0), DVec3::new(x1 + 0.12, SILL_M - 0.045, 0.03)];
    block(b, side, apron, faces.without(Faces::TOP), p.trim);
    // The stool of the reveal, from the sill to the frame.
    let reveal = WALL_M / 2.0 - FRAME_M[1] / 2.0;
    let stool = [DVec3::new(x0, SILL_M, -reveal), DVec3::new(x1, SILL_M + 0.003, 0.0)];
    block(b, side, stool, Faces::ALL.without(Faces::BOTTOM), p.parts.wood);
}
