//! Floor plan: a horizontal cut through the building.

use afterimage::Scene;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Number of lines of a plan; the longest are kept. More cannot be told apart, and take visible
/// time to draw.
const MAX_LINES: usize = 20_000;

/// Height of the cut of a storey above its floor, in metres: through windows and doors, as
/// architects cut.
pub const CUT_M: f64 = 1.2;

/// Largest height of an eye above the floor of its storey, in metres.
const STOREY_M: f64 = 4.0;

/// Floors are nearer to each other in the same storey: steps, platforms, in metres.
const LEAST_STOREY_M: f64 = 2.0;

/// Floors within this height are counted together, in metres.
const STEP_M: f64 = 0.1;

/// A floor has this share of the area of the largest one, at least.
const LEAST_SHARE: f64 = 0.2;

/// Number of steps of height that are counted: a tower of a thousand metres.
const MOST_STEPS: f64 = 10_000.0;

/// Returns the heights of a building's floors in world metres, the lowest first: where most
/// horizontal area that faces upwards lies.
pub fn storeys(scene: &Scene) -> Vec<f64> {
    let [low, high] = scene.building_m;
    let count = (((high.y - low.y) / STEP_M).ceil() + 1.0).clamp(1.0, MOST_STEPS) as usize;
    // Area and area times height of each step of height.
    let mut steps = vec![[0.0, 0.0]; count];
    let own = |t: &u32| !scene.is_added_ground(*t);
    for t in (0..scene.triangles.len() as u32).filter(own) {
        let [a, b, c] = scene.corners(t).map(|p| scene.frame.world_from_scene(p));
        let area = (b - a).cross(c - a) / 2.0;
        let middle = (a + b + c) / 3.0;
        let is_inside = (low - STEP_M).cmple(middle).all() && middle.cmple(high + STEP_M).all();
        if is_inside && area.y > 0.99 * area.length() {
            let at = ((middle.y - low.y) / STEP_M).clamp(0.0, count as f64 - 1.0) as usize;
            steps[at][0] += area.y;
            steps[at][1] += area.y * middle.y;
        }
    }
    floors_of(steps)
}

/// Returns the heights of the largest areas that are a storey apart.
fn floors_of(mut steps: Vec<[f64; 2]>) -> Vec<f64> {
    steps.sort_by(|a, b| b[0].total_cmp(&a[0]));
    let largest = steps.first().map_or(0.0, |step| step[0]);
    let mut floors: Vec<f64> = Vec::new();
    for [area, moment] in steps {
        if area <= 0.0 || area < LEAST_SHARE * largest {
            break;
        }
        let height = moment / area;
        if floors.iter().all(|floor| (floor - height).abs() >= LEAST_STOREY_M) {
            floors.push(height);
        }
    }
    floors.sort_by(f64::total_cmp);
    floors
}

/// Horizontal cut through a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Height of the cut in world metres.
    pub height_m: f64,
    /// Heights of the building's floors in world metres, the lowest first; empty where it has none.
    pub storeys_m: Vec<f64>,
    /// The floor below the cut.
    pub floor_m: Option<f64>,
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
        let half_extent_m = DVec2::new(half.x, half.z);
        Self { height_m, storeys_m: Vec::new(), floor_m: None, lines, origin_m, half_extent_m }
    }

    /// Cuts the storey above a floor, or the one that the eye is in; where there is none, at the
    /// height of the eye.
    pub fn of_storey(scene: &Scene, floor_m: Option<f64>, eye_m: f64) -> Self {
        let storeys_m = storeys(scene);
        let below = storeys_m.iter().rev().find(|floor| (0.0..STOREY_M).contains(&(eye_m - *floor)));
        let floor_m = floor_m.or(below.copied());
        let plan = Self::cut(scene, floor_m.map_or(eye_m, |floor| floor + CUT_M));
        if floor_m.is_none() && plan.lines.is_empty() {
            // From above a house, or below it, its nearest storey is of interest.
            let off = |floor: &f64| (eye_m - floor).abs();
            let nearest = storeys_m.iter().copied().min_by(|a, b| off(a).total_cmp(&off(b)));
            if let Some(floor) = nearest {
                return Self { storeys_m, floor_m: nearest, ..Self::cut(scene, floor + CUT_M) };
            }
        }
        Self { storeys_m, floor_m, ..plan }
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
    fn the_storeys_of_a_house_are_its_floors() {
        let mut b = SceneBuilder::new("house");
        let m = b.add_material(Material::diffuse("m", Vec3::ONE));
        let side = DVec3::new(8.0, 0.0, 0.0);
        for (height, depth) in [(0.0, 6.0), (2.9, 6.0), (0.75, 1.0), (5.8, 5.0)] {
            afterimage::scene::shapes::quad(&mut b, DVec3::new(0.0, height, 0.0), DVec3::Z * depth, side, m);
            // Its ceiling from below.
            afterimage::scene::shapes::quad(
                &mut b,
                DVec3::new(0.0, height - 0.2, 0.0),
                side,
                DVec3::Z * depth,
                m,
            );
        }
        let scene = b.finish().unwrap();
        let floors = storeys(&scene);
        assert_eq!(floors.len(), 3, "{floors:?}");
        assert!(floors.iter().zip([0.0, 2.9, 5.8]).all(|(a, b)| (a - b).abs() < 1e-3), "{floors:?}");
        let plan = Plan::of_storey(&scene, None, 4.5);
        assert!((plan.height_m - 4.1).abs() < 1e-3, "{plan:?}");
        let plan = Plan::of_storey(&scene, Some(floors[0]), 4.5);
        assert!((plan.height_m - 1.2).abs() < 1e-3 && plan.floor_m == Some(floors[0]));
        let from_above = Plan::of_storey(&scene, None, 30.0);
        assert!((from_above.height_m - 7.0).abs() < 1e-3, "the nearest storey: {from_above:?}");
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
