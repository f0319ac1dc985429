//! Placement of references: decisions of the rules, and poses at which a person can stand.

use crate::rooms::{cuboid, dvec, quad, room_tracer};
use afterimage::camera::{CameraKey, CameraPath};
use afterimage::math::Ray;
use afterimage::reference::placement::{GREEDY, GRID, OpenSpot, PrefetchRequest, RULES, walkable};
use afterimage::reference::{Observation, PlacementPolicy};
use afterimage::scene::{Material, SceneBuilder};
use afterimage::{Camera, FrameRequest, Mode, RenderSettings, Tracer, Walkthrough, WalkthroughSettings};
use glam::{DVec3, Vec2, Vec3};
use std::sync::Arc;

const SIZE: [u32; 2] = [96, 54];

/// Two rooms of 4 x 4 m with a lamp in each, joined by a door of 0.9 m. The second has a plinth,
/// and four steps of 0.2 m lead from it to a platform.
fn two_rooms() -> Tracer {
    let mut b = SceneBuilder::new("two rooms");
    let wall = b.add_material(Material::diffuse("wall", Vec3::splat(0.7)));
    let lamp = b.add_material(Material::emissive("lamp", Vec3::splat(8.0)));
    cuboid(&mut b, dvec(-2.0, 0.0, -12.0), dvec(2.0, 5.0, 2.0), wall, true);
    cuboid(&mut b, dvec(-2.0, 0.0, -2.1), dvec(-0.45, 5.0, -1.9), wall, false);
    cuboid(&mut b, dvec(0.45, 0.0, -2.1), dvec(2.0, 5.0, -1.9), wall, false);
    cuboid(&mut b, dvec(1.0, 0.0, -5.0), dvec(1.6, 2.2, -4.4), wall, false);
    for step in 1..=4 {
        let z = -6.0 - 0.6 * f64::from(step);
        cuboid(&mut b, dvec(-2.0, 0.0, -12.0), dvec(2.0, 0.2 * f64::from(step), z), wall, false);
    }
    for z in [0.0, -5.0] {
        quad(&mut b, dvec(-0.5, 4.9, z), dvec(1.0, 0.0, 0.0), dvec(0.0, 0.0, 1.0), lamp);
    }
    let key = |z: f64| CameraKey::new(dvec(0.0, 1.6, z), dvec(0.0, 1.6, z - 1.0));
    b.walk = Some(CameraPath { fov_y_deg: 60.0, frames: 20, keyframes: vec![key(1.5), key(-4.0)] });
    Tracer::new(Arc::new(b.finish().unwrap()))
}

fn sees(tracer: &Tracer, from: DVec3, to: DVec3) -> bool {
    let [from, to] = [from, to].map(|p| tracer.scene().frame.scene_from_world_f64(p).as_vec3());
    tracer.closest(&Ray::segment(from, to)).is_none()
}

#[test]
fn every_rule_is_found_by_its_name() {
    for rule in RULES {
        let policy = PlacementPolicy::named(rule.name, 7.0).unwrap();
        assert_eq!((policy.rule.name, policy.percent), (rule.name, 7.0));
    }
    assert_eq!(PlacementPolicy::named("elsewhere", 7.0), None);
}

#[test]
fn a_person_can_stand_behind_doors_and_on_stairs_but_not_inside_objects() {
    let tracer = two_rooms();
    let places = walkable(&tracer);
    let at = |x: f64, z: f64| places.iter().find(|p| p.eye.x == x && p.eye.z == z).map(|p| p.eye.y);
    let stands = |x: f64, z: f64, y: f64| at(x, z).is_some_and(|found| (found - y).abs() < 1e-3);
    assert!(stands(0.0, 0.0, 1.6) && stands(-1.5, -5.0, 1.6), "both rooms");
    assert!(stands(0.0, -10.0, 2.4), "up four steps: {:?}", at(0.0, -10.0));
    assert_eq!(at(1.5, -4.5), None, "not within the plinth");
    assert!(places.iter().all(|p| p.eye.x.abs() < 2.0 && p.eye.z.abs() < 12.0), "not outside");
    for (i, place) in places.iter().enumerate() {
        assert!(!places[..i].contains(place), "{place:?} twice");
    }
}

#[test]
fn a_grid_looks_all_around_at_every_position_and_keeps_its_limit() {
    let tracer = two_rooms();
    let ahead = |most| {
        (GRID.prefetch_poses)(&tracer, &PrefetchRequest { size: SIZE, fov_y: 1.0, max_references: most })
    };
    for most in [8, 40, 96] {
        let poses = ahead(most);
        assert!(!poses.is_empty() && poses.len() <= most, "{} of {most}", poses.len());
        let around = |pose: &Camera| poses.iter().filter(|p| p.eye == pose.eye).count();
        // 1 radian high at 16:9 is 1.54 radians wide, so a full turn takes five pictures.
        assert!(poses.iter().all(|pose| around(pose) == 5));
        assert_eq!(poses, ahead(most));
    }
    assert!(ahead(96).len() >= ahead(40).len() && ahead(40).len() > ahead(8).len());
}

#[test]
fn a_greedy_reference_covers_open_pixels_of_the_next_frames() {
    let tracer = room_tracer(false, false);
    let camera = Camera::look_at(dvec(0.2, 1.5, 3.0), dvec(0.2, 1.5, 0.0), 60.0);
    let previous = Camera { eye: camera.eye + dvec(0.0, 0.0, 0.2), yaw: camera.yaw - 0.08, ..camera };
    let seen =
        Observation { camera, previous, open_percent: 30.0, is_sparse: false, was_cut: false, held: 2 };
    // The left third of every extrapolated picture is open.
    let mut predict_open = |_: &Camera, spots: Option<&mut Vec<OpenSpot>>| {
        let spot = |i: u32| OpenSpot {
            point: Vec2::new((i % 32) as f32 + 0.5, (i / 32) as f32 + 0.5),
            percent: 100.0 / 5184.0,
        };
        if let Some(spots) = spots {
            spots.extend((0..32 * 54).map(spot));
        }
        100.0 / 3.0
    };
    let policy = PlacementPolicy::new(&GREEDY, 5.0);
    let pose = policy.decide(&seen, SIZE, &tracer, &mut predict_open).unwrap();
    assert!(pose.yaw > camera.yaw, "it must look left, where the open pixels are: {pose:?}");
    assert!(sees(&tracer, camera.eye, pose.eye), "it must stand in the room");
    assert_eq!(
        policy.decide(&seen, SIZE, &tracer, &mut predict_open),
        Some(pose),
        "the decision must be repeatable"
    );
    let quiet = Observation { open_percent: 5.0, ..seen };
    assert_eq!(policy.decide(&quiet, SIZE, &tracer, &mut predict_open), None);
    let mut known = |_: &Camera, _: Option<&mut Vec<OpenSpot>>| 0.0;
    assert_eq!(
        policy.decide(&seen, SIZE, &tracer, &mut known),
        None,
        "nothing is open at the extrapolated poses"
    );
}

#[test]
fn prefetched_references_are_traced_once_and_reused() {
    let tracer = Arc::new(two_rooms());
    for mode in [Mode::Paper, Mode::Exact] {
        let render = RenderSettings { mode, ..Default::default() };
        let placement = PlacementPolicy::new(&GRID, 0.0);
        let cache_bytes = 40 * 96 * 54 * 16;
        let settings = WalkthroughSettings { render, placement, cache_bytes, ..Default::default() };
        let mut walk = Walkthrough::new(Arc::clone(&tracer), settings);
        let start = tracer.scene().walk.camera(0, 20).unwrap();
        let mut made = Vec::new();
        while let Some(pose) = walk.wanted_ahead(&start, SIZE) {
            assert!(!made.contains(&pose), "{pose:?} twice");
            assert!(made.is_empty() || made[0].eye.distance(start.eye) <= pose.eye.distance(start.eye));
            made.push(pose);
            let reference = walk.reference_job(pose, SIZE).trace(&|| false).unwrap();
            walk.insert(reference).unwrap();
        }
        assert!(made.len() >= 8 && walk.cache().evicted() == 0, "{} made", made.len());
        let open = walk.render(&start, SIZE, &|| false).stats.types.percentages().unseen_percent;
        assert!(open < 50.0, "{open} % are open, 100 without a reference");
        assert_eq!(walk.wanted_reference(), None, "a grid adds no reference during the walk");
    }
}

#[test]
fn a_power_law_is_found_with_its_uncertainty() {
    use afterimage::experiment::statistics::power_law;
    let exact: Vec<[f64; 2]> = [1.0, 2.0, 8.0].map(|x: f64| [x, 3.0 * x.powf(0.7)]).to_vec();
    let law = power_law(&exact).unwrap();
    assert!((law.exponent - 0.7).abs() < 1e-12 && law.standard_error < 1e-7, "{law:?}");
    // By hand: the logarithms (0, 0), (1, 2), (2, 2) have slope 1 and residuals 1/3, 2/3, 1/3, so
    // the standard error is sqrt(2/3 / 1 / 2).
    let e = std::f64::consts::E;
    let law = power_law(&[[1.0, 1.0], [e, e * e], [e * e, e * e]]).unwrap();
    assert!(
        (law.exponent - 1.0).abs() < 1e-12 && (law.standard_error - (1.0f64 / 3.0).sqrt()).abs() < 1e-12,
        "{law:?}"
    );
    assert_eq!(power_law(&exact[..2]), None);
    assert_eq!(power_law(&[[1.0, 1.0], [1.0, 2.0], [1.0, 3.0]]), None);
}

#[test]
fn statues_behind_the_viewer_do_not_change_the_picture() {
    use afterimage::render::Renderer;
    use afterimage::scene::builtin::statue_hall;
    let picture = |triangles: usize| {
        let scene = statue_hall(triangles, 2).unwrap();
        assert!(scene.triangles.len() >= triangles);
        let tracer = Tracer::new(Arc::new(scene));
        let settings = RenderSettings { mode: Mode::Full, ..Default::default() };
        let mut renderer = Renderer::default();
        let camera = *tracer.scene().start();
        renderer.render(&FrameRequest::new(&tracer, &camera, SIZE, &settings)).radiance.clone()
    };
    let few = picture(0);
    assert!(few.iter().all(|r| r.is_finite()) && few.iter().any(|r| r.max_element() > 0.05));
    assert_eq!(few, picture(200_000));
}
