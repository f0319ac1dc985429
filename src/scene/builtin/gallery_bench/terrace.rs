//! The raised platform with its stairs and its railing of thin balusters.

use super::{palette::Palette, plan::RoomName};
use crate::scene::SceneBuilder;
use crate::scene::builtin::parts::{Platform, railing, stairs_up};
use crate::scene::builtin::shapes::floor;
use glam::{DVec3, Vec2};

/// Height of the platform in metres.
pub(super) const PLATFORM_M: f64 = 0.6;
/// World z of the edge of the platform.
pub(super) const EDGE_Z: f64 = 17.4;
const STAIRS_X: [f64; 2] = [27.8, 30.2];

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    let [x0, x1, _, z1] = RoomName::Terrace.room().area;
    floor(b, [x0, x1, EDGE_Z, z1], PLATFORM_M, p.wood_floor);
    let front = [[x1, 0.0], [x0, 0.0], [x0, PLATFORM_M], [x1, PLATFORM_M]];
    let size = Vec2::new((x1 - x0) as f32, PLATFORM_M as f32);
    b.add_quad(front.map(|[x, y]| DVec3::new(x, y, EDGE_Z)), size, p.stone);
    let platform = Platform { height_m: PLATFORM_M, edge_z: EDGE_Z };
    stairs_up(b, &p.parts(), platform, STAIRS_X);
    railing(b, &p.parts(), platform, [x0 + 0.1, STAIRS_X[0] - 0.06]);
    railing(b, &p.parts(), platform, [STAIRS_X[1] + 0.06, x1 - 0.1]);
}
