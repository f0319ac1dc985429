//! Camera poses that show a clicked surface or the whole model.

use super::EYE_HEIGHT_M;
use afterimage::Camera;
use afterimage::trace::Probe;
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// Cosine of 45 degrees: a surface whose normal rises more than this is a floor.
const FLOOR_COSINE: f32 = 0.707;

/// Distance in metres that is kept from a wall: an arm's length and a bit.
const BEFORE_WALL_M: f64 = 1.2;

/// Largest distance in metres from which a focused point is viewed.
const FOCUS_M: f64 = 3.0;

/// Pitch in radians of the view of a whole model: 25 degrees down shows floors and facades.
const OVERVIEW_PITCH: f64 = -0.436;

/// Returns the view after going to a surface: standing on a floor, or an arm's length before
/// anything else.
pub(crate) fn gone_to(probe: &Probe, camera: &Camera) -> Camera {
    if probe.normal.y > FLOOR_COSINE {
        return Camera { eye: probe.position_m + DVec3::Y * EYE_HEIGHT_M, ..*camera };
    }
    let offset = probe.position_m - camera.eye;
    let left = BEFORE_WALL_M.min(probe.distance_m / 2.0);
    let eye = camera.eye + offset * (1.0 - left / probe.distance_m.max(left));
    Camera { fov_y: camera.fov_y, ..Camera::look_at(eye, probe.position_m, camera.fov_y.to_degrees()) }
}

/// Returns the view with a surface in its centre, from at most [`FOCUS_M`].
pub(crate) fn focused_on(probe: &Probe, camera: &Camera) -> Camera {
    let offset = probe.position_m - camera.eye;
    let nearer = (1.0 - FOCUS_M / probe.distance_m.max(FOCUS_M)).max(0.0);
    let eye = camera.eye + offset * nearer;
    Camera { fov_y: camera.fov_y, ..Camera::look_at(eye, probe.position_m, camera.fov_y.to_degrees()) }
}

/// Returns the view of a whole box in world metres, seen in the current direction.
pub(crate) fn framing([low, high]: [DVec3; 2], camera: &Camera, aspect: f64) -> Camera {
    let centre = low + (high - low) / 2.0;
    let radius = (high - low).length() / 2.0;
    let half = camera.fov_y / 2.0;
    let half_across = (half.tan() * aspect.max(f64::MIN_POSITIVE)).atan();
    let distance = radius / half.min(half_across).clamp(f64::MIN_POSITIVE, FRAC_PI_2).sin();
    let framed = Camera { pitch: OVERVIEW_PITCH, ..*camera };
    Camera { eye: centre - framed.forward() * distance, ..framed }
}

#[cfg(test)]
mod tests {
    use super::*;
    use afterimage::scene::MaterialId;
    use glam::Vec3;

    fn probe(position_m: DVec3, normal: Vec3, from: DVec3) -> Probe {
        let distance_m = position_m.distance(from);
        Probe { distance_m, position_m, normal, triangle: 0, material: MaterialId(0), is_front: true }
    }

    fn camera() -> Camera {
        Camera::look_at(DVec3::new(0.0, 1.6, 0.0), DVec3::new(0.0, 1.0, -10.0), 60.0)
    }

    #[test]
    fn going_to_a_floor_stands_on_it_and_going_to_a_wall_stops_before_it() {
        let c = camera();
        let floor = gone_to(&probe(DVec3::new(1.0, 0.5, -4.0), Vec3::Y, c.eye), &c);
        assert_eq!((floor.eye, floor.yaw), (DVec3::new(1.0, 0.5 + EYE_HEIGHT_M, -4.0), c.yaw));
        let at = DVec3::new(0.0, 1.6, -8.0);
        let wall = gone_to(&probe(at, Vec3::Z, c.eye), &c);
        assert!((wall.eye.distance(at) - BEFORE_WALL_M).abs() < 1e-9 && wall.forward().z < -0.999);
        let near = gone_to(&probe(DVec3::new(0.0, 1.6, -1.0), Vec3::Z, c.eye), &c);
        assert!((near.eye.z + 0.5).abs() < 1e-9, "never through what is near: {near:?}");
    }

    #[test]
    fn a_focused_point_is_in_the_centre() {
        let c = camera();
        for at in [DVec3::new(3.0, 2.0, -9.0), DVec3::new(0.5, 1.0, -1.0)] {
            let focused = focused_on(&probe(at, Vec3::Z, c.eye), &c);
            let to = (at - focused.eye).normalize_or_zero();
            assert!(to.dot(focused.forward()) > 1.0 - 1e-9);
            assert!(at.distance(focused.eye) <= FOCUS_M.max(at.distance(c.eye).min(FOCUS_M)) + 1e-9);
        }
    }

    #[test]
    fn every_corner_of_a_framed_box_is_seen() {
        let bounds = [DVec3::new(-10.0, 0.0, -4.0), DVec3::new(30.0, 6.0, 9.0)];
        for aspect in [0.4, 1.0, 2.5] {
            let c = framing(bounds, &camera(), aspect);
            let camera_from_world = c.world_from_camera().transpose();
            for i in 0..8 {
                let corner = DVec3::new(bounds[i & 1].x, bounds[i >> 1 & 1].y, bounds[i >> 2 & 1].z) - c.eye;
                let p = camera_from_world * corner;
                let tan = (c.fov_y / 2.0).tan();
                assert!(p.z < 0.0 && (p.y / -p.z).abs() <= tan && (p.x / -p.z).abs() <= tan * aspect);
            }
        }
    }
}
