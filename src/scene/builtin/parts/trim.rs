//! Skirting boards, and architraves around openings.

use super::{Facing, Side};
use crate::scene::builtin::shapes::{Faces, Opening, block};
use crate::scene::{MaterialId, SceneBuilder};
use glam::DVec3;

const SKIRTING_M: [f64; 2] = [0.14, 0.02];
const ARCHITRAVE_M: [f64; 2] = [0.14, 0.035];

/// Adds a skirting board between the doorways of a side.
pub(in crate::scene::builtin) fn skirting(
    b: &mut SceneBuilder,
    side: &Side,
    facing: Facing,
    material: MaterialId,
) {
    let [height, depth] = SKIRTING_M;
    let faces =
        Faces::ALL.without(Faces::BACK).without(Faces::BOTTOM).without(Faces::LEFT).without(Faces::RIGHT);
    for [x0, x1] in stretches(side, facing, depth) {
        let corners = [DVec3::new(x0, 0.0, 0.0), DVec3::new(x1, height, depth)];
        block(b, &side.frame, corners, faces, material);
    }
}

/// Returns the parts of a side between the architraves of its doorways, for a board of a given
/// depth: in each corner the board along x is continuous, and the one along z ends at it.
pub(in crate::scene::builtin) fn stretches(side: &Side, facing: Facing, depth: f64) -> Vec<[f64; 2]> {
    let inset = if matches!(facing, Facing::East | Facing::West) { depth } else { 0.0 };
    let mut from = inset;
    let mut stretches = Vec::new();
    for door in side.doors() {
        stretches.push([from, door[0] - ARCHITRAVE_M[0]]);
        from = door[1] + ARCHITRAVE_M[0];
    }
    stretches.push([from, side.length - inset]);
    stretches
}

/// Adds the boards around an opening. Its foot stands on the floor or on a sill.
pub(in crate::scene::builtin) fn architrave(
    b: &mut SceneBuilder,
    side: &Side,
    opening: &Opening,
    material: MaterialId,
) {
    let [width, depth] = ARCHITRAVE_M;
    let ([x0, x1], [foot, head]) = (opening.along, opening.height);
    let mut bar = |low: [f64; 2], high: [f64; 2], faces: Faces| {
        let corners = [DVec3::new(low[0], low[1], 0.0), DVec3::new(high[0], high[1], depth)];
        block(b, &side.frame, corners, faces.without(Faces::BACK), material);
    };
    let jamb = Faces::ALL.without(Faces::BOTTOM).without(Faces::TOP);
    bar([x0 - width, foot], [x0, head], jamb);
    bar([x1, foot], [x1 + width, head], jamb);
    // The head has a part of its own over each jamb, so that no face of it lies on a jamb.
    let ends = Faces::ALL.without(Faces::BOTTOM);
    bar([x0 - width, head], [x0, head + width], ends.without(Faces::RIGHT));
    bar([x0, head], [x1, head + width], Faces::ALL.without(Faces::LEFT).without(Faces::RIGHT));
    bar([x1, head], [x1 + width, head + width], ends.without(Faces::LEFT));
}
