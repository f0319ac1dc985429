//! The garden around the building: lawn, paths, hedges and trees.

use super::palette::Palette;
use super::planting::{cypress, hedge, tree};
use crate::scene::SceneBuilder;
use crate::scene::builtin::shapes::{Faces, Local, block, floor};
use glam::DVec3;

/// Extent of the lawn as x0, x1, z0, z1.
const LAWN: [f64; 4] = [-1.0, 44.0, -0.9, 33.0];
const LAWN_Y: f64 = -0.12;
const HEDGE_M: [f64; 2] = [0.9, 2.3];

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    floor(b, LAWN, LAWN_Y, p.lawn);
    // Terraces along the south and the east side, the path from the entrance, and the path along
    // the hedge. They lie in the lawn and do not overlap.
    for ([x0, x1, z0, z1], top, material) in [
        ([10.0, 24.0, 24.0, 27.0], -0.03, p.gravel),
        ([34.0, 36.6, 8.6, 24.0], -0.05, p.gravel),
        ([15.8, 18.2, 27.0, 30.6], -0.08, p.gravel),
        ([36.6, 42.4, 14.2, 16.0], -0.08, p.gravel),
    ] {
        let corners = [DVec3::new(x0, LAWN_Y - 0.1, z0), DVec3::new(x1, top, z1)];
        block(b, &Local::WORLD, corners, Faces::ALL.without(Faces::BOTTOM), material);
    }
    hedges(b, p);
    trees(b, p);
}

fn hedges(b: &mut SceneBuilder, p: &Palette) {
    let [x0, x1, z0, z1] = LAWN;
    let inset = HEDGE_M[0] / 2.0 + 0.1;
    let at = |x: f64, z: f64| DVec3::new(x, LAWN_Y, z);
    let (east, south, west) = (x1 - inset, z1 - inset, x0 + inset);
    for ends in [
        [at(east, z1), at(east, z0)],
        [at(x0, south), at(x1, south)],
        [at(34.0, z0 + inset), at(x1, z0 + inset)],
        [at(west, 24.0), at(west, z1)],
    ] {
        hedge(b, ends, HEDGE_M, p.leaves[1]);
    }
}

fn trees(b: &mut SceneBuilder, p: &Palette) {
    let at = |x: f64, z: f64| DVec3::new(x, LAWN_Y, z);
    for (x, z, height) in
        [(39.3, 10.6, 5.2), (40.6, 19.4, 5.6), (38.6, 24.6, 4.6), (9.4, 29.3, 4.8), (25.5, 29.6, 5.4)]
    {
        tree(b, at(x, z), height, [p.bark, p.leaves[0]]);
    }
    for (x, z, height) in
        [(14.6, 29.8, 5.0), (19.4, 29.8, 5.2), (2.6, 29.4, 4.4), (6.0, 30.0, 5.0), (41.6, 6.4, 5.2)]
    {
        cypress(b, at(x, z), height, p.leaves[1]);
    }
}
