//! Projects world points into the viewport, and snaps points on surfaces to corners and edges.

use crate::window::state::{Snap, SnapKind};
use afterimage::Camera;
use egui::{Pos2, Rect};
use glam::{DMat3, DVec3};

/// Maximum distance in points at which a point snaps to a corner or an edge.
const SNAP_POINTS: f32 = 12.0;

/// Depth in metres of the near plane: nothing nearer is drawn.
const NEAR_M: f64 = 1e-3;

/// Projection of a camera onto a rectangle of the window.
#[derive(Clone, Copy, Debug)]
pub struct Projection {
    eye: DVec3,
    camera_from_world: DMat3,
    tan: f64,
    rect: Rect,
}

impl Projection {
    /// Projection of a camera whose picture fills `rect`.
    pub fn new(camera: &Camera, rect: Rect) -> Self {
        let camera_from_world = camera.world_from_camera().transpose();
        Self { eye: camera.eye, camera_from_world, tan: (camera.fov_y / 2.0).tan(), rect }
    }

    /// Projects a world point; `None` if it is behind the camera.
    pub fn point(&self, world_m: DVec3) -> Option<Pos2> {
        self.on_screen(self.camera_from_world * (world_m - self.eye))
    }

    fn on_screen(&self, p: DVec3) -> Option<Pos2> {
        let depth = -p.z;
        let per_tan = f64::from(self.rect.height()) / 2.0 / self.tan;
        let offset = egui::vec2((p.x / depth * per_tan) as f32, (-p.y / depth * per_tan) as f32);
        (depth >= NEAR_M * 0.999).then(|| self.rect.center() + offset)
    }

    /// Projects the part of a world segment that is in front of the camera.
    pub fn segment(&self, [a, b]: [DVec3; 2]) -> Option<[Pos2; 2]> {
        let [p, q] = [a, b].map(|w| self.camera_from_world * (w - self.eye));
        let cut = |inside: DVec3, outside: DVec3| {
            inside + (outside - inside) * ((inside.z + NEAR_M) / (inside.z - outside.z))
        };
        let (p, q) = match (-p.z >= NEAR_M, -q.z >= NEAR_M) {
            (true, true) => (p, q),
            (true, false) => (p, cut(p, q)),
            (false, true) => (cut(q, p), q),
            (false, false) => return None,
        };
        Some([self.on_screen(p)?, self.on_screen(q)?])
    }

    /// Snaps a point on a triangle to a corner or, failing that, to an edge that is near it in the
    /// viewport.
    pub fn snapped(&self, on_surface_m: DVec3, corners_m: &[DVec3; 3]) -> Snap {
        let cursor = self.point(on_surface_m);
        let is_near = |p: &DVec3| match (cursor, self.point(*p)) {
            (Some(a), Some(b)) => a.distance(b) <= SNAP_POINTS,
            _ => false,
        };
        let nearest = |points: [DVec3; 3]| {
            let by_distance = |a: &DVec3, b: &DVec3| {
                a.distance_squared(on_surface_m).total_cmp(&b.distance_squared(on_surface_m))
            };
            points.into_iter().filter(|p| is_near(p)).min_by(by_distance)
        };
        if let Some(position_m) = nearest(*corners_m) {
            return Snap { position_m, kind: SnapKind::Vertex };
        }
        let [a, b, c] = *corners_m;
        match nearest([(a, b), (b, c), (c, a)].map(|(from, to)| nearest_on_edge(on_surface_m, from, to))) {
            Some(position_m) => Snap { position_m, kind: SnapKind::Edge },
            None => Snap { position_m: on_surface_m, kind: SnapKind::Surface },
        }
    }
}

fn nearest_on_edge(p: DVec3, from: DVec3, to: DVec3) -> DVec3 {
    let edge = to - from;
    let length_squared = edge.length_squared();
    // A degenerate edge is its corner.
    let t = if length_squared > 0.0 { (p - from).dot(edge) / length_squared } else { 0.0 };
    from + edge * t.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    fn projection() -> Projection {
        let camera = Camera::look_at(DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, 2.0, -7.0), 90.0);
        Projection::new(&camera, Rect::from_min_max(pos2(100.0, 0.0), pos2(500.0, 200.0)))
    }

    #[test]
    fn the_view_direction_is_the_centre_and_the_field_of_view_spans_the_height() {
        let p = projection();
        assert_eq!(p.point(DVec3::new(1.0, 2.0, -7.0)), Some(pos2(300.0, 100.0)));
        let top = p.point(DVec3::new(1.0, 4.0, 1.0)).unwrap();
        assert!(top.distance(pos2(300.0, 0.0)) < 1e-3, "{top}");
        assert_eq!(p.point(DVec3::new(1.0, 2.0, 4.0)), None, "behind the eye");
    }

    #[test]
    fn a_segment_is_clipped_at_the_near_plane() {
        let p = projection();
        let [a, b] = p.segment([DVec3::new(1.0, 2.0, -7.0), DVec3::new(2.0, 2.0, 4.0)]).unwrap();
        assert_eq!(a, pos2(300.0, 100.0));
        assert!(b.x > 1000.0 && b.x.is_finite(), "far to the right: {b}");
        assert!(p.segment([DVec3::new(0.0, 0.0, 4.0), DVec3::new(0.0, 0.0, 5.0)]).is_none());
    }

    #[test]
    fn corners_take_precedence_over_edges() {
        let p = projection();
        let corners = [DVec3::new(0.0, 1.0, -1.0), DVec3::new(3.0, 1.0, -1.0), DVec3::new(0.0, 4.0, -1.0)];
        let at = |x: f64, y: f64| p.snapped(DVec3::new(x, y, -1.0), &corners);
        // At that depth, a metre is 25 points.
        assert_eq!(at(0.3, 1.2), Snap { position_m: corners[0], kind: SnapKind::Vertex });
        assert_eq!(at(1.5, 1.1).kind, SnapKind::Edge);
        assert!(at(1.5, 1.1).position_m.distance(DVec3::new(1.5, 1.0, -1.0)) < 1e-12);
        assert_eq!(at(0.9, 1.9).kind, SnapKind::Surface);
    }
}
