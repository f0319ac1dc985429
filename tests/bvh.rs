//! The hierarchy against a loop over all triangles in f64, and its watertightness.

use afterimage::math::Ray;
use afterimage::math::key::Key;
use afterimage::math::sampling::cosine_hemisphere;
use afterimage::trace::{Bvh, Hit};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// A random point of the cube from -1 to 1.
pub(super) fn random(key: Key, index: u32) -> Vec3 {
    let [x, y] = key.with(2 * index).pair();
    let [z, _] = key.with(2 * index + 1).pair();
    Vec3::new(x, y, z) * 2.0 - 1.0
}

/// Random triangles of about the given size, with their centres in the cube from -1 to 1.
pub(super) fn triangle_soup(count: u32, size: f32, seed: u64) -> Vec<[Vec3; 3]> {
    (0..count)
        .map(|i| {
            let key = Key::of_pixel(seed, i);
            let centre = random(key, 0);
            [1, 2, 3].map(|k| centre + random(key, k) * size)
        })
        .collect()
}

/// Returns the distance of a hit after Moeller and Trumbore in f64, and the smallest barycentric,
/// which tells how far inside the triangle it lies.
fn hit_f64(ray: &Ray, triangle: &[Vec3; 3]) -> Option<(f64, f64)> {
    let [a, b, c] = triangle.map(Vec3::as_dvec3);
    let (o, d): (DVec3, DVec3) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let (e1, e2) = (b - a, c - a);
    let p = d.cross(e2);
    let det = e1.dot(p);
    let s = o - a;
    let (u, q) = (s.dot(p) / det, s.cross(e1));
    let (v, t) = (d.dot(q) / det, e2.dot(q) / det);
    let least = u.min(v).min(1.0 - u - v);
    (t > 0.0 && det != 0.0).then_some((t, least))
}

#[test]
fn nearest_hit_equals_a_loop_over_all_triangles_in_f64() {
    let soup = triangle_soup(600, 0.15, 1);
    let bvh = Bvh::build(&soup);
    let mut checked = 0;
    for i in 0..20_000 {
        let key = Key::of_pixel(2, i);
        let ray = Ray::new(random(key, 0) * 1.5, random(key, 1));
        let hits: Vec<_> =
            soup.iter().enumerate().filter_map(|(k, t)| Some((k, hit_f64(&ray, t)?))).collect();
        // Leave out rays that graze an edge: rounding decides them.
        if hits.iter().any(|(_, (_, least))| least.abs() < 1e-5) {
            continue;
        }
        let slow = hits.iter().filter(|(_, (_, l))| *l > 0.0).min_by(|a, b| a.1.0.total_cmp(&b.1.0));
        let fast = bvh.closest(&ray, |_| true);
        assert_eq!(fast.map(|h| h.triangle as usize), slow.map(|(k, _)| *k), "ray {i}");
        if let (Some(h), Some((_, (t, _)))) = (fast, slow) {
            assert!((f64::from(h.t) - t).abs() <= 1e-4 * t.max(0.1), "ray {i}: {} {t}", h.t);
        }
        assert_eq!(bvh.any(&ray, |_| true), slow.is_some(), "ray {i}");
        checked += 1;
    }
    assert!(checked > 15_000, "only {checked} rays were clear cases");
}

#[test]
fn a_ray_ends_where_it_says() {
    let triangle = [Vec3::new(-1.0, -1.0, 2.0), Vec3::new(1.0, -1.0, 2.0), Vec3::new(0.0, 1.0, 2.0)];
    let bvh = Bvh::build(&[triangle]);
    let mut ray = Ray::new(Vec3::ZERO, Vec3::Z);
    assert!(bvh.closest(&ray, |_| true).is_some());
    for end in [2.0, 1.0] {
        ray.t_max = end;
        assert!(bvh.closest(&ray, |_| true).is_none(), "a hit at or beyond {end}");
        assert!(!bvh.any(&ray, |_| true));
    }
}

#[test]
fn of_equal_distances_the_lower_triangle_wins() {
    let triangle = [Vec3::new(-1.0, -1.0, 2.0), Vec3::new(1.0, -1.0, 2.0), Vec3::new(0.0, 1.0, 2.0)];
    let bvh = Bvh::build(&vec![triangle; 300]);
    let hit = bvh.closest(&Ray::new(Vec3::ZERO, Vec3::Z), |_| true).unwrap();
    assert_eq!(hit.triangle, 0);
}

/// Returns the nearest hit with all triangles, by the arithmetic of the tree but without the tree.
fn nearest_of_all(bvh: &Bvh, ray: &Ray, mesh: &[[Vec3; 3]]) -> Option<Hit> {
    let hits = (0..).zip(mesh).filter_map(|(i, corners)| bvh.on_triangle(ray, i, *corners));
    hits.min_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)))
}

#[test]
fn the_tree_does_not_decide_between_triangles_at_one_distance() {
    let ball = sphere(12, 300.0, Vec3::new(100.0, -50.0, 20.0));
    // The same triangles in another order make another tree.
    let turned: Vec<[Vec3; 3]> = ball.iter().copied().rev().collect();
    for mesh in [ball, turned] {
        let bvh = Bvh::build(&mesh);
        for i in 0..50_000 {
            let key = Key::of_pixel(31, i);
            let [a, b, _] = mesh[key.bits() as usize % mesh.len()];
            let origin = Vec3::new(100.0, -50.0, 20.0) + random(key, 0) * 400.0;
            let ray = Ray::new(origin, a.lerp(b, key.with(9).pair()[0]) - origin);
            assert_eq!(bvh.closest(&ray, |_| true), nearest_of_all(&bvh, &ray, &mesh), "ray {i}");
        }
    }
}

/// A closed sphere of triangles around the origin.
fn sphere(rings: u32, scale: f32, offset: Vec3) -> Vec<[Vec3; 3]> {
    use std::f32::consts::{PI, TAU};
    let at = |i: u32, j: u32| {
        let (theta, phi) = (PI * i as f32 / rings as f32, TAU * (j % rings) as f32 / rings as f32);
        // Each pole must be one point, or the mesh would not be closed.
        let sin = if i == 0 || i == rings { 0.0 } else { theta.sin() };
        offset + Vec3::new(sin * phi.cos(), theta.cos(), sin * phi.sin()) * scale
    };
    let mut triangles = Vec::new();
    for i in 0..rings {
        for j in 0..rings {
            let (a, b, c, d) = (at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1));
            triangles.extend(
                [[a, b, c], [c, b, d]].into_iter().filter(|t| t[0] != t[1] && t[1] != t[2] && t[0] != t[2]),
            );
        }
    }
    triangles
}

#[test]
fn no_ray_leaves_a_closed_sphere_even_aimed_at_edges_and_vertices() {
    for (scale, offset) in [(1.0, 0.0), (1e-3, 0.0), (1e5, 0.0), (1.0, 300.0), (100.0, -512.0)] {
        let offset = Vec3::new(offset, -offset, offset / 2.0);
        let triangles = sphere(24, scale, offset);
        let bvh = Bvh::build(&triangles);
        let misses: usize = (0..40_000u32)
            .into_par_iter()
            .filter(|&i| {
                let key = Key::of_pixel(3, i);
                let origin = offset + random(key, 0) * scale * 0.5;
                let t = triangles[i as usize % triangles.len()];
                let aim = match i % 3 {
                    0 => t[0],
                    1 => (t[0] + t[1]) / 2.0,
                    _ => t[0] + (t[2] - t[0]) * key.pair()[0],
                };
                bvh.closest(&Ray::new(origin, aim - origin), |_| true).is_none()
            })
            .count();
        assert_eq!(misses, 0, "scale {scale}, offset {offset}");
    }
}

#[test]
fn a_ray_from_a_surface_does_not_meet_that_surface() {
    use afterimage::scene::{Material, SceneBuilder};
    use afterimage::trace::{SurfacePoint, Tracer};
    let mut b = SceneBuilder::new("soup");
    let matte = b.add_material(Material::diffuse("matte", Vec3::splat(0.5)));
    for t in triangle_soup(2000, 0.2, 5) {
        let v = t.map(|p| b.add_vertex(p.as_dvec3() * 30.0, Vec3::ZERO, glam::Vec2::ZERO));
        b.add_triangle(v, matte);
    }
    let tracer = Tracer::new(std::sync::Arc::new(b.finish().unwrap()));
    let triangles = tracer.scene().triangles.len() as u32;
    let self_hits: usize = (0..200_000u32)
        .into_par_iter()
        .filter(|&i| {
            let key = Key::of_pixel(7, i);
            let [b1, b2] = afterimage::math::sampling::uniform_triangle(key.pair());
            let point = SurfacePoint::new(tracer.scene(), i % triangles, [b1, b2], random(key, 3));
            let up = cosine_hemisphere(key.with(9).pair());
            let direction = afterimage::math::sampling::frame_around(point.geometric_normal) * up;
            let ray = Ray::new(point.origin_in_front(), direction);
            tracer.closest(&ray).is_some_and(|h| h.triangle == point.triangle)
        })
        .count();
    assert_eq!(self_hits, 0);
}

#[test]
fn broken_rays_and_empty_trees_hit_nothing() {
    let empty = Bvh::build(&[]);
    assert!(empty.closest(&Ray::new(Vec3::ZERO, Vec3::Z), |_| true).is_none());
    assert!(!empty.any(&Ray::new(Vec3::ZERO, Vec3::Z), |_| true));
    let bvh = Bvh::build(&triangle_soup(100, 0.5, 4));
    for bad in [Vec3::NAN, Vec3::ZERO] {
        assert!(bvh.closest(&Ray::new(Vec3::ZERO, bad), |_| true).is_none());
        assert!(!bvh.any(&Ray::new(Vec3::ZERO, bad), |_| true));
    }
    assert!(bvh.closest(&Ray::new(Vec3::NAN, Vec3::Z), |_| true).is_none());
}

#[test]
fn degenerate_input_builds_a_shallow_tree() {
    // All boxes equal, and nested boxes that halve: both drive bottom-up builders deep.
    let equal = vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; 50_000];
    assert!(Bvh::build(&equal).any(&Ray::new(Vec3::new(0.2, 0.2, -1.0), Vec3::Z), |_| true));
    let nested: Vec<[Vec3; 3]> = (0..20_000)
        .map(|i| {
            let s = 0.9995f32.powi(i);
            [Vec3::ZERO, Vec3::X * s, Vec3::Y * s]
        })
        .collect();
    let hit = Bvh::build(&nested).closest(&Ray::new(Vec3::new(0.3, 0.3, -1.0), Vec3::Z), |_| true);
    assert!(hit.is_some_and(|h| (h.t - 1.0).abs() < 1e-6));
}

#[test]
fn boxes_whose_area_is_no_number_end_in_a_tree() {
    let flat = [[Vec3::ZERO, Vec3::X * 3e38, Vec3::X * -3e38]; 5];
    assert!(!Bvh::build(&flat).any(&Ray::new(Vec3::Z, Vec3::Y), |_| true));
}

#[test]
fn hits_are_the_same_bits_with_and_without_wide_simd() {
    let soup = triangle_soup(5000, 0.1, 8);
    let (wide, narrow) = (Bvh::build(&soup), Bvh::build(&soup).with_baseline_simd());
    let bits = |bvh: &Bvh, ray: &Ray| {
        bvh.closest(ray, |_| true).map(|h| (h.triangle, [h.t, h.b1, h.b2].map(f32::to_bits)))
    };
    let mut hits = 0;
    for i in 0..100_000 {
        let key = Key::of_pixel(9, i);
        let mut ray = Ray::new(random(key, 0), random(key, 1));
        // Every third ray is aimed at a vertex, where signs are zero.
        if i % 3 == 0 {
            ray.direction = soup[i as usize % soup.len()][0] - ray.origin;
        }
        let hit = bits(&wide, &ray);
        assert_eq!(hit, bits(&narrow, &ray), "ray {i}");
        assert_eq!(wide.any(&ray, |_| true), narrow.any(&ray, |_| true), "ray {i}");
        hits += u32::from(hit.is_some());
    }
    assert!(hits > 10_000, "only {hits} rays hit anything");
}
