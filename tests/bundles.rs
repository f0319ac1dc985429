//! Shadow rays traced as a bundle against the same rays traced one by one.

use super::bvh::{random, triangle_soup};
use afterimage::math::key::Key;
use afterimage::math::sampling::lattice;
use afterimage::scene::{Material, SceneBuilder, builtin};
use afterimage::trace::{BUNDLE_RAYS, Bvh, Hit, RayBundle, RayCounts, SurfacePoint, TraceSettings, Tracer};
use glam::{Vec2, Vec3};
use std::sync::Arc;

/// Random triangles, moved by `offset`.
fn soup(count: u32, size: f32, offset: Vec3) -> Vec<[Vec3; 3]> {
    triangle_soup(count, size, 5).into_iter().map(|corners| corners.map(|corner| corner + offset)).collect()
}

/// Rays from one point to a parallelogram: narrow or wide, ending there or without an end, some
/// aimed at vertices of the soup or along axes, some with NaN or infinity.
fn bundle(i: u32, mesh: &[[Vec3; 3]], offset: Vec3) -> RayBundle {
    let key = Key::of_pixel(6, i);
    let size = [1e-4, 0.02, 0.2, 1.0][i as usize % 4];
    let origin = random(key, 0) + offset;
    let (corner, u, v) = (random(key, 1) + offset, random(key, 2) * size, random(key, 3) * size);
    let mut bundle = RayBundle::new(origin);
    for k in 0..BUNDLE_RAYS as u32 - i % 17 {
        let [x, y] = lattice(k, BUNDLE_RAYS as u32, key.pair());
        let target = match (i % 7, k % 4) {
            (3, 1) => mesh[(i as usize * 31 + k as usize) % mesh.len()][0],
            (4, 2) => origin + Vec3::AXES[k as usize % 3],
            (5, 3) => Vec3::NAN,
            (6, 3) => Vec3::INFINITY,
            (2, 3) => origin,
            (1, 2) => Vec3::new(origin.x, corner.y, corner.z),
            _ => corner + u * x + v * y,
        };
        let direction = if (i % 7, k % 4) == (1, 2) {
            (target - origin) * Vec3::new(-1.0, 1.0, 1.0)
        } else {
            target - origin
        };
        let t_max = [1.0 - 1.0 / 4096.0, f32::INFINITY, 1.0, -1.0, f32::NAN];
        bundle.push(direction, t_max[if i.is_multiple_of(11) { k as usize % 5 } else { i as usize % 2 }]);
    }
    bundle
}

/// Asserts that each ray of many bundles is blocked as it is alone. Returns the number of blocked
/// rays and of all rays.
fn count(bvh: &Bvh, mesh: &[[Vec3; 3]], offset: Vec3, accept: impl Fn(&Hit) -> bool) -> [u32; 2] {
    let mut counts = [0; 2];
    for i in 0..6000 {
        let bundle = bundle(i, mesh, offset);
        let blocked = bvh.any_in_bundle(&bundle, |_: usize, hit: &Hit| accept(hit));
        for ray in 0..bundle.len() {
            let expected = bvh.any(&bundle.ray(ray), &accept);
            assert_eq!(blocked >> ray & 1 == 1, expected, "bundle {i}, ray {ray}: {:?}", bundle.ray(ray));
            counts[0] += u32::from(expected);
        }
        assert_eq!(blocked >> bundle.len(), 0, "bundle {i}: a ray beyond its length");
        counts[1] += bundle.len() as u32;
    }
    counts
}

#[test]
fn bundles_are_blocked_where_their_rays_are() {
    for (offset, size) in [(Vec3::ZERO, 0.1), (Vec3::ZERO, 1.0), (Vec3::new(900.0, -3.0, 1e4), 0.2)] {
        let mesh = soup(if size < 0.5 { 4000 } else { 40 }, size, offset);
        let bvh = Bvh::build(&mesh);
        for bvh in [&bvh, &Bvh::build(&mesh).with_baseline_simd()] {
            let [blocked, all] = count(bvh, &mesh, offset, |_| true);
            assert!(blocked > all / 20 && blocked < all - all / 20, "{blocked} of {all} are blocked");
            let [fewer, _] = count(bvh, &mesh, offset, |hit| hit.triangle % 3 == 0 && hit.b1 < 0.5);
            assert!(fewer > 100 && fewer < blocked, "{fewer} and {blocked}");
        }
        for i in 0..6000 {
            let bundle = bundle(i, &mesh, offset);
            assert_eq!(
                bvh.any_at_all_in_bundle(&bundle),
                bvh.any_in_bundle(&bundle, |_: usize, _: &Hit| true),
                "bundle {i}"
            );
        }
    }
}

/// Rays that lie in the plane of a triangle or end on one: rounding decides them as it does for
/// single rays.
#[test]
fn rays_in_planes_and_rays_that_end_on_walls_are_blocked_as_alone() {
    let grid = |i: u32, k: u32| (Key::of_pixel(8, i).with(k).pair()[0] * 8.0).floor() / 4.0 - 1.0;
    let at = |i: u32, k: u32| Vec3::new(grid(i, k), grid(i, k + 1), grid(i, k + 2));
    let mesh: Vec<[Vec3; 3]> = (0..40).map(|i| [at(i, 0), at(i, 3), at(i, 6)]).collect();
    let bvh = Bvh::build(&mesh);
    let [mut blocked, mut all] = [0; 2];
    for i in 0..20_000 {
        let mut bundle = RayBundle::new(at(i, 10));
        for k in 0..1 + i % 16 {
            let step = Vec3::new(0.0, grid(i, 20 + k), grid(i, 40 + k)) * 0.125;
            let direction = at(i, 13) - bundle.origin() + step;
            bundle.push(
                if i.is_multiple_of(3) { direction * Vec3::new(-0.0, 1.0, 1.0) } else { direction },
                1.0,
            );
        }
        let together = bvh.any_at_all_in_bundle(&bundle);
        for ray in 0..bundle.len() {
            let alone = bvh.any(&bundle.ray(ray), |_| true);
            assert_eq!(together >> ray & 1 == 1, alone, "bundle {i}, ray {ray}: {:?}", bundle.ray(ray));
            blocked += u32::from(alone);
            all += 1;
        }
    }
    assert!(blocked > all / 10 && blocked < all - all / 10, "{blocked} of {all}");
}

#[test]
fn no_ray_is_tested_against_a_triangle_twice() {
    let mesh = soup(400, 0.5, Vec3::ZERO);
    let bvh = Bvh::build(&mesh);
    for i in 0..2000 {
        let mut asked = std::collections::HashSet::new();
        bvh.any_in_bundle(&bundle(i, &mesh, Vec3::ZERO), |ray: usize, hit: &Hit| {
            assert!(asked.insert((ray, hit.triangle)), "bundle {i}: ray {ray}, triangle {}", hit.triangle);
            false
        });
    }
}

#[test]
fn an_empty_tree_blocks_nothing() {
    let bundle = bundle(0, &soup(1, 1.0, Vec3::ZERO), Vec3::ZERO);
    assert_eq!(Bvh::build(&[]).any_at_all_in_bundle(&bundle), 0);
}

/// A sheet of glass dims, whatever lies in front of it; an opaque surface behind it blocks.
#[test]
fn light_that_passes_along_a_bundle_is_that_of_its_rays() {
    let tracer = Tracer::new(Arc::new(builtin::build("gallery-bench").unwrap()));
    let scene = tracer.scene().clone();
    let view = afterimage::camera::View::new(&scene.walk.camera(200, 300).unwrap(), &scene.frame, [48, 27]);
    let [mut dimmed, mut blocked, mut all] = [0; 3];
    for pixel in 0..48 * 27 {
        let ray = Tracer::primary_ray(&view, pixel);
        let Some(hit) = tracer.closest(&ray) else { continue };
        let point = tracer.surface(&ray, &hit);
        for bundle in shadow_bundles(&tracer, &point, pixel) {
            let mut passed = [Vec3::ZERO; BUNDLE_RAYS];
            tracer.transmittances(&bundle, &mut passed);
            for (ray, &passed) in passed.iter().enumerate().take(bundle.len()) {
                let alone = tracer.transmittance(&bundle.ray(ray), &mut Default::default());
                // The order in which sheets are multiplied may differ, and with it the last bit.
                assert!((passed - alone).abs().max_element() <= 1e-6, "{passed} {alone}");
                blocked += u32::from(alone == Vec3::ZERO);
                dimmed += u32::from(alone != Vec3::ZERO && alone != Vec3::ONE);
                all += 1;
            }
        }
    }
    assert!(dimmed > 100 && blocked > 100 && dimmed + blocked < all, "{dimmed}, {blocked} of {all}");
}

/// Through one face of glass there is no order, so a bundle's rays lose what each loses alone, to
/// the bit.
#[test]
fn a_face_of_glass_dims_the_rays_of_a_bundle_as_it_dims_each_alone() {
    for (i, index) in [1.1, 1.5, 2.4].into_iter().enumerate() {
        let key = Key::of_pixel(8, i as u32);
        let mut builder = SceneBuilder::new("face of glass");
        let glass = builder.add_material(Material::glass("g", index, Vec3::new(0.9, 1.0, 0.3)));
        let corners = [0, 1, 2].map(|k| random(key, k).as_dvec3());
        let vertices = corners.map(|corner| builder.add_vertex(corner, Vec3::ZERO, Vec2::ZERO));
        builder.add_triangle(vertices, glass);
        let tracer = Tracer::new(Arc::new(builder.finish().unwrap()));
        let [a, b, c] = tracer.scene().corners(0);
        let (centre, side) = ((a + b + c) / 3.0, (b - a).length());
        let mut dimmed = 0;
        for k in 2..200 {
            let key = Key::of_pixel(9, k);
            let origin = centre + side * random(key, 0);
            let mut bundle = RayBundle::new(origin);
            for ray in 0..BUNDLE_RAYS as u32 {
                let target = centre + 0.02 * side * random(key, 1 + ray);
                bundle.push(2.5 * (target - origin), f32::INFINITY);
            }
            let mut passed = [Vec3::ZERO; BUNDLE_RAYS];
            tracer.transmittances(&bundle, &mut passed);
            for (ray, &passed) in passed.iter().enumerate() {
                assert_eq!(passed, tracer.transmittance(&bundle.ray(ray), &mut Default::default()));
                dimmed += u32::from(passed != Vec3::ONE && passed != Vec3::ZERO);
            }
        }
        assert!(dimmed > 500, "{dimmed} rays are dimmed");
    }
}

/// The shadow rays of a point, with their count checked.
fn shadow_bundles(tracer: &Tracer, point: &SurfacePoint, pixel: u32) -> Vec<RayBundle> {
    let settings = TraceSettings::default();
    let key = Key::of_pixel(settings.seed, pixel);
    let (mut bundles, mut counts) = (Vec::new(), RayCounts::default());
    tracer.shadow_bundles(point, settings.samples, key, &mut bundles);
    tracer.irradiance(point, settings.samples, key, &mut counts);
    let rays: usize = bundles.iter().map(RayBundle::len).sum();
    assert_eq!(counts.shadow as usize, rays, "not every ray of a bundle is counted");
    bundles
}
