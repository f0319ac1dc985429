//! Floor plan: a horizontal cut through the building.

use afterimage::Scene;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Number of lines of a plan; the longest are kept. More cannot be told apart, and take visible
/// time to draw.
const MAX_LINES: usize = 20_000;

/// Horizontal cut through a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Height of the cut in world metres.
    pub height_m: f64,
    /// Lines as (x, z) of both ends, in metres from `origin_m`.
    pub lines: Vec<[[f32; 2]; 2]>,
    /// Origin of the lines as (x, z), in world metres.
    pub origin_m: DVec2,
    /// Half the building's extent along x and z, in metres.
    pub half_extent_m: DVec2,
}

impl Plan {
    /// Cuts all triangles of a scene at a height in world metres, on the current thread pool.
    pub fn cut(scene: &Scene, height_m: f64) -> Self {
        let [low, high] = scene.building_m;
        let centre = low + (high - low) / 2.0;
        let origin_m = DVec2::new(centre.x, centre.z);
        let level = scene.frame.scene_from_world_f64(DVec3::new(centre.x, height_m, centre.z));
        let per_unit = 1.0 / scene.frame.units_per_metre;
        let mut lines: Vec<[[f32; 2]; 2]> = (0..scene.triangles.len() as u32)
            .into_par_iter()
            .filter_map(|t| crossing(scene.corners(t).map(|p| p.as_dvec3() - level)))
            .map(|ends| ends.map(|p| [(p.x * per_unit) as f32, (p.y * per_unit) as f32]))
            .collect();
        if lines.len() > MAX_LINES {
            let squared = |l: &[[f32; 2]; 2]| (l[1][0] - l[0][0]).powi(2) + (l[1][1] - l[0][1]).powi(2);
            lines.sort_by(|a, b| squared(b).total_cmp(&squared(a)));
            lines.truncate(MAX_LINES);
        }
        let half = (high - low) / 2.0;
        Self { height_m, lines, origin_m, half_extent_m: DVec2::new(half.x, half.z) }
    }

    /// Returns (x, z) of a world position, in metres from the plan's origin.
    pub fn place(&self, world_m: DVec3) -> DVec2 {
        DVec2::new(world_m.x, world_m.z) - self.origin_m
    }
}

/// Returns the segment in which a triangle crosses the plane y = 0, as (x, z). A corner on the
/// plane counts as above it, so a triangle that only touches the plane gives none.
fn crossing(corners: [DVec3; 3]) -> Option<[DVec2; 2]> {
    let [a, b, c] = corners;
    let mut ends = [(a, b), (b, c), (c, a)].into_iter().filter_map(|(p, q)| {
        let is_crossed = (p.y < 0.0) != (q.y < 0.0);
        is_crossed.then(|| {
            let at = p + (q - p) * (p.y / (p.y - q.y));
            DVec2::new(at.x, at.z)
        })
    });
    Some([ends.next()?, ends.next()?])
}

/// The part of the plan that is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlanView {
    /// Centre as (x, z), in metres from the plan's origin.
    pub centre_m: DVec2,
    /// Magnification relative to the view of the whole building; 0 until the user zooms.
    pub zoom: f64,
    /// The centre follows the camera.
    pub follows: bool,
}

impl PlanView {
    /// Range of the zoom, from more than the whole building to a part of a room.
    pub const ZOOM: std::ops::RangeInclusive<f64> = 0.5..=200.0;

    /// Returns the zoom, 1 until the user zooms.
    pub fn zoom(&self) -> f64 {
        if self.zoom > 0.0 { self.zoom } else { 1.0 }
    }

    /// Returns the view enlarged by a factor; the point `fixed_m` keeps its place.
    #[must_use]
    pub fn zoomed(&self, factor: f64, fixed_m: DVec2) -> Self {
        let zoom = (self.zoom() * factor).clamp(*Self::ZOOM.start(), *Self::ZOOM.end());
        let centre_m = fixed_m + (self.centre_m - fixed_m) * (self.zoom() / zoom);
        Self { centre_m, zoom, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use afterimage::scene::{Material, SceneBuilder};
    use glam::{Vec2, Vec3};

    #[test]
    fn the_cut_of_a_room_is_its_outline() {
        let mut b = SceneBuilder::new("walls");
        let m = b.add_material(Material::diffuse("m", Vec3::ONE));
        let p = |x: f64, y: f64, z: f64| DVec3::new(x + 100.0, y + 7.0, z);
        let corners = [(-4.0, -3.0), (4.0, -3.0), (4.0, 3.0), (-4.0, 3.0)];
        for i in 0..4 {
            let ((ax, az), (bx, bz)) = (corners[i], corners[(i + 1) % 4]);
            b.add_quad([p(ax, 0.0, az), p(bx, 0.0, bz), p(bx, 3.0, bz), p(ax, 3.0, az)], Vec2::ONE, m);
        }
        b.add_quad(
            [p(-4.0, 0.0, -3.0), p(4.0, 0.0, -3.0), p(4.0, 0.0, 3.0), p(-4.0, 0.0, 3.0)],
            Vec2::ONE,
            m,
        );
        let scene = b.finish().unwrap();
        let plan = Plan::cut(&scene, 8.5);
        let length: f64 = plan.lines.iter().map(|[a, b]| f64::from((a[0] - b[0]).hypot(a[1] - b[1]))).sum();
        assert_eq!(plan.lines.len(), 8, "two triangles a wall, none of the floor");
        assert!((length - 28.0).abs() < 1e-4, "{length}");
        assert!(plan.lines.iter().flatten().all(|[x, z]| {
            ((x.abs() - 4.0).abs() < 1e-4 && z.abs() <= 3.001) || ((z.abs() - 3.0).abs() < 1e-4)
        }));
        assert_eq!(plan.place(DVec3::new(101.0, 0.0, 2.0)), DVec2::new(1.0, 2.0));
        assert_eq!(Plan::cut(&scene, 20.0).lines.len(), 0);
    }

    #[test]
    fn ground_does_not_change_the_frame() {
        let plan = |side: f64| {
            let mut b = SceneBuilder::new("house");
            let m = b.add_material(Material::diffuse("m", Vec3::ONE));
            afterimage::scene::shapes::cuboid(&mut b, [DVec3::ZERO, DVec3::new(9.0, 3.0, 7.0)], m, false);
            let corner = DVec3::new(-side / 2.0, -0.1, -side / 2.0);
            afterimage::scene::shapes::quad(&mut b, corner, DVec3::Z * side, DVec3::X * side, m);
            let plan = Plan::cut(&b.finish().unwrap(), 1.6);
            (plan.origin_m, plan.half_extent_m)
        };
        assert_eq!(plan(221.0), (DVec2::new(4.5, 3.5), DVec2::new(4.5, 3.5)));
        assert_eq!(plan(221.0), plan(1.0));
    }

    #[test]
    fn zooming_keeps_the_point_under_the_cursor() {
        let view = PlanView { centre_m: DVec2::new(3.0, 1.0), zoom: 2.0, follows: false };
        let fixed = DVec2::new(5.0, -1.0);
        let zoomed = view.zoomed(4.0, fixed);
        let on_screen = |v: &PlanView| (fixed - v.centre_m) * v.zoom();
        assert!((on_screen(&view) - on_screen(&zoomed)).length() < 1e-12);
        assert_eq!(PlanView::default().zoomed(1e9, fixed).zoom(), *PlanView::ZOOM.end());
    }
}
