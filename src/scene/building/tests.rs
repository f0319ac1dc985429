//! The building of small models of known content.

use crate::scene::shapes::{cuboid, quad, sphere};
use crate::scene::{Material, MaterialId, Scene, SceneBuilder};
use glam::{DVec3, Vec3};

fn dvec(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// The building of a model that `fill` makes.
fn building_of(fill: impl Fn(&mut SceneBuilder, MaterialId)) -> [DVec3; 2] {
    built(fill).building_m
}

fn built(fill: impl Fn(&mut SceneBuilder, MaterialId)) -> Scene {
    let mut b = SceneBuilder::new("model");
    let m = b.add_material(Material::diffuse("m", Vec3::splat(0.5)));
    fill(&mut b, m);
    b.finish().unwrap()
}

/// A house of 9 x 4 x 7 m with a table and a pitched roof, which overhangs.
fn house(b: &mut SceneBuilder, m: MaterialId) {
    cuboid(b, [dvec(0.0, 0.0, 0.0), dvec(9.0, 3.0, 7.0)], m, false);
    cuboid(b, [dvec(0.2, 0.2, 0.2), dvec(8.8, 2.8, 6.8)], m, true);
    cuboid(b, [dvec(3.0, 0.2, 3.0), dvec(4.5, 0.9, 4.0)], m, false);
    quad(b, dvec(-0.5, 3.0, -0.5), dvec(0.0, 2.0, 4.0), dvec(10.0, 0.0, 0.0), m);
    quad(b, dvec(-0.5, 5.0, 3.5), dvec(0.0, -2.0, 4.0), dvec(10.0, 0.0, 0.0), m);
}

/// A level square of side `side` around the house.
fn ground(b: &mut SceneBuilder, m: MaterialId, side: f64, y: f64) {
    quad(b, dvec(4.5 - side / 2.0, y, 3.5 - side / 2.0), DVec3::Z * side, DVec3::X * side, m);
}

#[test]
fn a_model_without_surroundings_is_all_building() {
    let scene = built(house);
    assert_eq!(scene.building_m, scene.bounds_m);
    assert_eq!(scene.building_m, [dvec(-0.5, 0.0, -0.5), dvec(9.5, 5.0, 7.5)]);
}

#[test]
fn ground_of_any_size_and_kind_leaves_every_bit() {
    let alone = building_of(house);
    for side in [12.0, 20.0, 225.0, 1e4, 1e6] {
        for y in [0.0, -0.3, 1.2] {
            let plane = building_of(|b, m| (house(b, m), ground(b, m, side, y)).0);
            assert_eq!(plane, alone, "a plane of {side} m at {y}");
        }
        let half = side / 2.0;
        let plate = building_of(|b, m| {
            house(b, m);
            cuboid(b, [dvec(4.5 - half, -0.2, 3.5 - half), dvec(4.5 + half, 0.0, 3.5 + half)], m, false);
        });
        assert_eq!(plate, alone, "a plate of {side} m");
    }
}

#[test]
fn ground_of_tiles_and_rolling_ground_leave_every_bit() {
    let alone = building_of(house);
    let tiles = building_of(|b, m| {
        house(b, m);
        for i in 0..40 * 40 {
            let (x, z) = (f64::from(i % 40) * 5.0 - 100.0, f64::from(i / 40) * 5.0 - 100.0);
            quad(b, dvec(x, -0.01, z), DVec3::Z * 4.98, DVec3::X * 4.98, m);
        }
    });
    assert_eq!(tiles, alone);
    let rolling = building_of(|b, m| {
        house(b, m);
        let height = |x: f64, z: f64| -2.0 + (x / 15.0).sin() + (z / 20.0).cos();
        let point = |i: i32, j: i32| {
            let (x, z) = (f64::from(i) * 5.0 - 100.0, f64::from(j) * 5.0 - 100.0);
            dvec(x, height(x, z), z)
        };
        for i in 0..40 * 40 {
            let (i, j) = (i % 40, i / 40);
            let corners = [point(i, j), point(i, j + 1), point(i + 1, j + 1), point(i + 1, j)];
            b.add_quad(corners, glam::Vec2::ONE, m);
        }
    });
    assert_eq!(rolling, alone);
}

#[test]
fn walls_drawn_on_the_ground_are_told_from_it() {
    // The plane shares the corners of the walls: four strips around the house.
    let walls = |b: &mut SceneBuilder, m| cuboid(b, [DVec3::ZERO, dvec(9.0, 3.0, 7.0)], m, false);
    let drawn = building_of(|b, m| {
        walls(b, m);
        let (inner, outer) = ([[0.0, 0.0], [0.0, 7.0], [9.0, 7.0], [9.0, 0.0]], 80.0);
        let outwards = [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]];
        let near = |i: usize| dvec(inner[i][0], 0.0, inner[i][1]);
        let far = |i: usize| near(i) + dvec(outwards[i][0], 0.0, outwards[i][1]) * outer;
        for i in 0..4 {
            b.add_quad([far(i), far((i + 1) % 4), near((i + 1) % 4), near(i)], glam::Vec2::ONE, m);
        }
    });
    assert_eq!(drawn, building_of(walls));
}

#[test]
fn a_few_far_objects_leave_every_bit() {
    let alone = building_of(house);
    for distance in [40.0, 500.0, 1e5] {
        let with = building_of(|b, m| {
            house(b, m);
            for at in [dvec(distance, 0.0, 0.0), dvec(-distance, 3.0, distance), dvec(0.0, distance, 0.0)] {
                cuboid(b, [at, at + DVec3::ONE], m, false);
                sphere(b, at, 1.0, 64, true, m);
            }
        });
        assert_eq!(with, alone, "objects at {distance} m");
    }
}

#[test]
fn a_sky_above_is_left_out_and_a_roof_on_columns_is_not() {
    let sky = building_of(|b, m| (house(b, m), ground(b, m, 400.0, 9.0)).0);
    assert_eq!(sky, building_of(house));
    let pavilion = building_of(|b, m| {
        for [x, z] in [[0.0, 0.0], [12.0, 0.0], [0.0, 8.0], [12.0, 8.0]] {
            cuboid(b, [dvec(x, 0.0, z), dvec(x + 0.3, 3.0, z + 0.3)], m, false);
        }
        quad(b, dvec(-1.0, 3.0, -1.0), DVec3::Z * 10.0, DVec3::X * 14.0, m);
        ground(b, m, 300.0, 0.0);
    });
    assert_eq!(pavilion, [dvec(-1.0, 0.0, -1.0), dvec(13.0, 3.0, 9.0)]);
}

#[test]
fn a_street_of_houses_is_one_building_and_so_is_a_scatter() {
    let street = built(|b, m| {
        for i in 0..8 {
            let x = f64::from(i) * 14.0;
            cuboid(b, [dvec(x, 0.0, 0.0), dvec(x + 9.0, 6.0, 8.0)], m, false);
        }
    });
    assert_eq!(street.building_m, street.bounds_m);
    let scatter = built(|b, m| {
        for i in 0..9 {
            let at = dvec(f64::from(i % 3) * 40.0, 0.0, f64::from(i / 3) * 40.0);
            cuboid(b, [at, at + DVec3::ONE], m, false);
        }
    });
    assert_eq!(scatter.building_m, scatter.bounds_m);
}

#[test]
fn the_floor_of_a_room_that_lacks_walls_belongs_to_it() {
    let corner = built(|b, m| {
        quad(b, DVec3::ZERO, DVec3::Z * 6.0, DVec3::X * 6.0, m);
        quad(b, DVec3::ZERO, DVec3::X * 6.0, DVec3::Y * 3.0, m);
    });
    assert_eq!(corner.building_m, corner.bounds_m);
}

#[test]
fn a_plane_a_triangle_and_terrain_are_buildings_as_a_whole() {
    let plane = built(|b, m| ground(b, m, 50.0, 0.0));
    let triangle = built(|b, m| {
        let v = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| b.add_vertex(p, Vec3::ZERO, glam::Vec2::ZERO));
        b.add_triangle(v, m);
    });
    let needle = built(|b, m| quad(b, DVec3::ZERO, DVec3::X * 100.0, DVec3::Y * 0.01, m));
    for scene in [plane, triangle, needle] {
        assert_eq!(scene.building_m, scene.bounds_m);
    }
}

#[test]
fn the_building_scales_and_moves_with_the_model() {
    let alone = building_of(|b, m| (house(b, m), ground(b, m, 300.0, 0.0)).0);
    for scale in [2f64.powi(-40), 0.25, 2f64.powi(60)] {
        let scaled = building_of(|b, m| {
            house(b, m);
            ground(b, m, 300.0, 0.0);
            b.positions.iter_mut().for_each(|p| *p *= scale);
        });
        assert_eq!(scaled, alone.map(|p| p * scale), "scale {scale}");
    }
    let by = dvec(4096.0, -128.0, 1e6);
    let moved = building_of(|b, m| {
        house(b, m);
        ground(b, m, 300.0, 0.0);
        b.positions.iter_mut().for_each(|p| *p += by);
    });
    assert_eq!(moved, [dvec(-0.5, 0.0, -0.5) + by, dvec(9.5, 5.0, 7.5) + by]);
}
