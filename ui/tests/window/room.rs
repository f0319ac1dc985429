//! A plain room with a mirror, a lamp and a few boxes.

use afterimage::Camera;
use afterimage::scene::{Material, MaterialId, NamedView, Scene, SceneBuilder, SceneError};
use glam::{DVec3, Vec2, Vec3};

/// Builds the room: 8 x 3 x 6 metres.
///
/// # Errors
/// Those of [`SceneBuilder::finish`].
pub(super) fn room(name: &str) -> Result<Scene, SceneError> {
    let mut b = SceneBuilder::new(&format!("builtin:{name}"));
    let white = b.add_material(Material::diffuse("plaster", Vec3::splat(0.75)));
    let red = b.add_material(Material::diffuse("red", Vec3::new(0.6, 0.12, 0.1)));
    let green = b.add_material(Material::diffuse("green", Vec3::new(0.15, 0.45, 0.2)));
    let wood = b.add_material(Material::diffuse("wood", Vec3::new(0.5, 0.33, 0.2)));
    let mirror = b.add_material(Material::mirror("mirror", Vec3::splat(0.9)));
    let lamp = b.add_material(Material::emissive("lamp", Vec3::new(12.0, 11.0, 9.0)));
    let (low, high) = (DVec3::new(-4.0, 0.0, -3.0), DVec3::new(4.0, 3.0, 3.0));
    inside_of_box(&mut b, low, high, [red, green, wood, white, white, white]);
    let at = |x, y, z| DVec3::new(x, y, z);
    let lamp_y = 2.98;
    for x in [-2.0, 2.0] {
        b.add_quad(
            [
                at(x - 0.5, lamp_y, -0.5),
                at(x + 0.5, lamp_y, -0.5),
                at(x + 0.5, lamp_y, 0.5),
                at(x - 0.5, lamp_y, 0.5),
            ],
            Vec2::ONE,
            lamp,
        );
    }
    b.add_quad(
        [at(-1.5, 0.6, -2.98), at(1.5, 0.6, -2.98), at(1.5, 2.4, -2.98), at(-1.5, 2.4, -2.98)],
        Vec2::ONE,
        mirror,
    );
    for (name, x, z, side, height, material) in [
        ("tall box", -2.4, -1.2, 0.9, 1.6, white),
        ("low box", 2.3, -1.6, 0.8, 0.8, green),
        ("cube", 0.6, -0.6, 0.5, 0.5, red),
    ] {
        let half = side / 2.0;
        b.begin_object(name);
        outside_of_box(&mut b, at(x - half, 0.0, z - half), at(x + half, height, z + half), material);
    }
    b.end_object();
    let view = |name: &str, eye, target| NamedView {
        name: name.to_owned(),
        camera: Camera::look_at(eye, target, 60.0),
    };
    b.views.push(view("entrance", at(1.8, 1.6, 2.6), at(-0.3, 1.1, -1.5)));
    b.views.push(view("mirror", at(-0.5, 1.6, 0.5), at(0.2, 1.4, -3.0)));
    b.views.push(view("corner", at(-3.5, 2.2, 2.5), at(2.0, 0.6, -1.5)));
    b.finish()
}

/// Six quads: left, right, floor, ceiling, back, front, in the order of `materials`.
fn faces([lo, hi]: [DVec3; 2]) -> [[DVec3; 4]; 6] {
    let p = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    [
        [p(lo.x, lo.y, lo.z), p(lo.x, lo.y, hi.z), p(lo.x, hi.y, hi.z), p(lo.x, hi.y, lo.z)],
        [p(hi.x, lo.y, hi.z), p(hi.x, lo.y, lo.z), p(hi.x, hi.y, lo.z), p(hi.x, hi.y, hi.z)],
        [p(lo.x, lo.y, lo.z), p(hi.x, lo.y, lo.z), p(hi.x, lo.y, hi.z), p(lo.x, lo.y, hi.z)],
        [p(lo.x, hi.y, hi.z), p(hi.x, hi.y, hi.z), p(hi.x, hi.y, lo.z), p(lo.x, hi.y, lo.z)],
        [p(hi.x, lo.y, lo.z), p(lo.x, lo.y, lo.z), p(lo.x, hi.y, lo.z), p(hi.x, hi.y, lo.z)],
        [p(lo.x, lo.y, hi.z), p(hi.x, lo.y, hi.z), p(hi.x, hi.y, hi.z), p(lo.x, hi.y, hi.z)],
    ]
}

fn outside_of_box(b: &mut SceneBuilder, low: DVec3, high: DVec3, material: MaterialId) {
    faces([low, high]).into_iter().for_each(|corners| b.add_quad(corners, Vec2::ONE, material));
}

fn inside_of_box(b: &mut SceneBuilder, low: DVec3, high: DVec3, materials: [MaterialId; 6]) {
    for (mut corners, material) in faces([low, high]).into_iter().zip(materials) {
        corners.reverse();
        b.add_quad(corners, Vec2::ONE, material);
    }
}
