//! Where the inside of the scene's closed bodies is: which points of a section are cut material.

use crate::math::Ray;
use crate::scene::{ClosedBodies, Scene};
use crate::trace::bvh::Bvh;
use glam::Vec3;

/// What a closed body is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    /// A piece of material, whatever its winding.
    Material,
    /// A hollow in a piece of material.
    Cavity,
    /// A shell around a room, whose inside is air.
    Room,
}

/// The closed bodies of a scene, and what each of them is.
#[derive(Debug)]
pub(in crate::trace) struct Solids {
    bodies: ClosedBodies,
    roles: Vec<Role>,
}

/// Directions in which the crossings beyond a point are counted. They are along no axis or diagonal
/// of a building, so that they rarely pass through an edge, where a crossing may count twice.
const DIRECTIONS: [Vec3; 3] = [
    Vec3::new(0.371_390_67, 0.917_285_3, 0.143_823_3),
    Vec3::new(-0.623_489_8, 0.412_873_6, -0.663_921_7),
    Vec3::new(0.184_772_6, -0.561_837_3, 0.806_355_5),
];

impl Solids {
    /// Finds the closed bodies of a scene.
    pub(in crate::trace) fn find(scene: &Scene, bvh: &Bvh) -> Self {
        let bodies = ClosedBodies::find(scene);
        let roles = vec![Role::Material; bodies.list.len()];
        let mut solids = Self { bodies, roles };
        solids.find_rooms(scene, bvh);
        solids.find_inverted(scene, bvh);
        solids
    }

    /// Number of closed bodies that are pieces of material.
    pub(in crate::trace) fn count(&self) -> usize {
        self.roles.iter().filter(|role| **role == Role::Material).count()
    }

    /// A closed body around the eye of a view is a room.
    fn find_rooms(&mut self, scene: &Scene, bvh: &Bvh) {
        for view in &scene.views {
            let eye = scene.frame.scene_from_world_f64(view.camera.eye).as_vec3();
            for body in self.around(scene, bvh, eye) {
                self.roles[body as usize] = Role::Room;
            }
        }
    }

    /// A body that is wound inwards is a room where it holds other bodies, a cavity where it lies in
    /// a body that is wound outwards, and otherwise a piece of material with the wrong winding.
    fn find_inverted(&mut self, scene: &Scene, bvh: &Bvh) {
        let list = &self.bodies.list;
        let inverted: Vec<usize> = (0..list.len())
            .filter(|&i| list[i].is_wound && list[i].volume < 0.0 && self.roles[i] == Role::Material)
            .collect();
        let is_in = |outer: [Vec3; 2], inner: [Vec3; 2]| {
            outer[0].cmple(inner[0]).all() && inner[1].cmple(outer[1]).all()
        };
        for body in inverted {
            let bounds = self.bodies.list[body].bounds;
            let others = || self.bodies.list.iter().enumerate().filter(|(i, _)| *i != body);
            let around_middle = |[low, high]: [Vec3; 2]| self.around(scene, bvh, (low + high) / 2.0);
            let holds_others = others().any(|(_, other)| {
                is_in(bounds, other.bounds) && around_middle(other.bounds).contains(&(body as u32))
            });
            let around = around_middle(bounds);
            let is_held = others().any(|(i, other)| {
                is_in(other.bounds, bounds) && other.volume > 0.0 && around.contains(&(i as u32))
            });
            self.roles[body] = match (is_held, holds_others) {
                (true, _) => Role::Cavity,
                (false, true) => Role::Room,
                (false, false) => Role::Material,
            };
        }
    }

    /// The piece of material or the cavity that a triangle bounds, and whether it counts as wound the
    /// other way.
    pub(super) fn material_at(&self, triangle: u32) -> Option<(u32, bool)> {
        self.bodies.of(triangle).filter(|(body, _)| self.roles[*body as usize] != Role::Room)
    }

    /// What a body adds to the depth of a point in material, from the sum of the signs of the
    /// crossings beyond the point, and their number. A body that does not exist adds nothing.
    pub(super) fn depth_in(&self, body: u32, signed: i32, count: i32) -> i32 {
        let Some(known) = self.bodies.list.get(body as usize) else { return 0 };
        let is_in = if known.is_wound { signed != 0 } else { count % 2 != 0 };
        match self.roles[body as usize] {
            Role::Material => i32::from(is_in),
            Role::Cavity => -i32::from(is_in),
            Role::Room => 0,
        }
    }

    /// True where a point (scene space) lies in material: the slow twin of a profile.
    #[cfg(test)]
    pub(super) fn is_inside(&self, scene: &Scene, bvh: &Bvh, point: Vec3) -> bool {
        let depth = |body: &u32| match self.roles[*body as usize] {
            Role::Material => 1,
            Role::Cavity => -1,
            Role::Room => 0,
        };
        self.around(scene, bvh, point).iter().map(depth).sum::<i32>() > 0
    }

    /// The bodies that a point lies in, ascending. Two directions must agree; where they do not, a
    /// third decides.
    fn around(&self, scene: &Scene, bvh: &Bvh, point: Vec3) -> Vec<u32> {
        let [a, b, c] = DIRECTIONS;
        let first = self.around_along(scene, bvh, point, a);
        let second = self.around_along(scene, bvh, point, b);
        if first == second {
            return first;
        }
        let third = self.around_along(scene, bvh, point, c);
        let votes = |body: &u32| {
            let found =
                [&first, &second, &third].map(|around| usize::from(around.binary_search(body).is_ok()));
            found.iter().sum::<usize>()
        };
        let mut agreed: Vec<u32> =
            first.iter().chain(&second).copied().filter(|body| votes(body) > 1).collect();
        agreed.sort_unstable();
        agreed.dedup();
        agreed
    }

    /// The bodies that a point lies in by the crossings along one direction, ascending: where their
    /// signs do not cancel, or where the winding says nothing, where their number is odd.
    fn around_along(&self, scene: &Scene, bvh: &Bvh, point: Vec3, direction: Vec3) -> Vec<u32> {
        let mut counts: Vec<(u32, i32)> = Vec::with_capacity(16);
        bvh.any(&Ray::new(point, direction), |hit| {
            if let Some((body, is_turned)) = self.bodies.of(hit.triangle) {
                let [a, b, c] = scene.corners(hit.triangle);
                let leaves = ((b - a).cross(c - a).dot(direction) > 0.0) != is_turned;
                let sign = if leaves || !self.bodies.list[body as usize].is_wound { 1 } else { -1 };
                match counts.iter_mut().find(|(known, _)| *known == body) {
                    Some((_, count)) => *count += sign,
                    None => counts.push((body, sign)),
                }
            }
            false
        });
        let is_in = |(body, count): &(u32, i32)| match self.bodies.list[*body as usize].is_wound {
            true => *count != 0,
            false => count % 2 != 0,
        };
        let mut around: Vec<u32> = counts.iter().filter(|c| is_in(c)).map(|(body, _)| *body).collect();
        around.sort_unstable();
        around
    }
}
