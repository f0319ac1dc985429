//! Random edits of a room: what is marked, and what moves.

use afterimage::math::key::Key;
use afterimage::reference::ReferenceFrame;
use afterimage::reference::stale::MAX_CHANGE;
use afterimage::scene::shapes::{cuboid, quad};
use afterimage::scene::{Material, MaterialId, ObjectKey, Scene, SceneBuilder, Sky, Sun};
use afterimage::trace::{TraceSettings, parallel::NEVER};
use afterimage::{Camera, Tracer, Walkthrough, WalkthroughSettings};
use glam::{DVec3, Quat, Vec2, Vec3};
use std::collections::BTreeMap;
use std::sync::Arc;

const SIZE: [u32; 2] = [24, 16];

/// Samples of each of two independent pictures: the mean of both is the truth.
const SAMPLES: u32 = 256;

/// What an edit does, as it is counted.
pub(crate) const KINDS: [&str; 10] = [
    "colour",
    "lamp dimmed",
    "sun",
    "sky",
    "object moved",
    "object hidden",
    "loaded again",
    "lamp moved",
    "pane moved",
    "pane opaque",
];

/// Numbers of pixels.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Found {
    /// Whose converged light moved by more than the limit.
    pub(crate) moved: usize,
    pub(crate) marked: usize,
    /// That moved by both pictures, and are not marked.
    pub(crate) missed: usize,
    /// That held light and show the same surface in both states.
    pub(crate) all: usize,
}

impl std::ops::AddAssign for Found {
    fn add_assign(&mut self, more: Self) {
        self.moved += more.moved;
        self.marked += more.marked;
        self.missed += more.missed;
        self.all += more.all;
    }
}

fn dvec(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// Adds a part of the room.
type Part<'a> = Box<dyn Fn(&mut SceneBuilder) + 'a>;

/// A room of 6 x 3 x 8 m with an opening in one wall, a lamp, boxes and a pane, each an object.
/// `again` changes the order and the numbers of its triangles.
fn room(again: bool) -> Scene {
    let mut b = SceneBuilder::new("room");
    let names = [("wall", [0.7, 0.65, 0.6]), ("red", [0.6, 0.1, 0.1]), ("blue", [0.1, 0.2, 0.6])];
    let mut materials: Vec<Material> =
        names.map(|(name, colour)| Material::diffuse(name, Vec3::from(colour))).into();
    materials.push(Material::emissive("lamp", Vec3::splat(8.0)));
    materials.push(Material::glass("pane", 1.5, Vec3::splat(0.9)));
    if again {
        materials.reverse();
    }
    let ids: Vec<MaterialId> = materials.iter().map(|m| b.add_material(m.clone())).collect();
    let id = |k: usize| ids[if again { 4 - k } else { k }];
    let mut parts: Vec<Part<'_>> = vec![
        Box::new(|b| walls(b, id(0))),
        Box::new(|b| {
            named(b, "low box", |b| cuboid(b, [dvec(-1.9, 0.0, -2.0), dvec(-0.9, 1.0, -1.0)], id(1), false))
        }),
        Box::new(|b| {
            named(b, "tall box", |b| cuboid(b, [dvec(0.9, 0.0, -1.5), dvec(1.5, 1.8, -0.9)], id(0), false))
        }),
        Box::new(|b| {
            named(b, "cube", |b| cuboid(b, [dvec(-0.2, 0.0, 0.6), dvec(0.2, 0.4, 1.0)], id(2), false))
        }),
        Box::new(|b| {
            named(b, "lamp", |b| {
                quad(b, dvec(-0.5, 2.8, -0.5), dvec(1.0, 0.0, 0.0), dvec(0.0, 0.0, 1.0), id(3))
            })
        }),
        Box::new(|b| {
            named(b, "pane", |b| {
                quad(b, dvec(-0.8, 0.2, -2.6), dvec(1.2, 0.0, 0.0), dvec(0.0, 1.4, 0.0), id(4))
            })
        }),
    ];
    if again {
        parts.reverse();
    }
    parts.iter().for_each(|part| part(&mut b));
    drop(parts);
    b.sun = Some(Sun { direction: Vec3::new(0.8, 0.5, 0.2).normalize_or(Vec3::Y), ..Sun::clear_day() });
    b.sky = Some(Sky::even(Vec3::new(0.3, 0.4, 0.6)));
    if let Some(sun) = &mut b.sun {
        sun.irradiance = Vec3::splat(4.0);
    }
    b.finish().unwrap()
}

fn named(b: &mut SceneBuilder, name: &str, add: impl Fn(&mut SceneBuilder)) {
    b.begin_object(name);
    add(b);
    b.end_object();
}

/// Walls with an opening to the sun.
fn walls(b: &mut SceneBuilder, wall: MaterialId) {
    let [low, high] = [dvec(-3.0, 0.0, -4.0), dvec(3.0, 3.0, 4.0)];
    let at = dvec;
    let mut face = |corners: [DVec3; 4]| b.add_quad(corners, Vec2::ONE, wall);
    face([low, at(-3.0, 0.0, 4.0), at(3.0, 0.0, 4.0), at(3.0, 0.0, -4.0)]);
    face([at(-3.0, 3.0, -4.0), at(3.0, 3.0, -4.0), high, at(-3.0, 3.0, 4.0)]);
    face([low, at(3.0, 0.0, -4.0), at(3.0, 3.0, -4.0), at(-3.0, 3.0, -4.0)]);
    face([at(-3.0, 0.0, 4.0), at(-3.0, 3.0, 4.0), high, at(3.0, 0.0, 4.0)]);
    face([low, at(-3.0, 3.0, -4.0), at(-3.0, 3.0, 4.0), at(-3.0, 0.0, 4.0)]);
    // The wall at x = 3 around an opening of 2 x 1.4 m.
    let mut strip = |y: [f64; 2], z: [f64; 2]| {
        face([at(3.0, y[0], z[0]), at(3.0, y[0], z[1]), at(3.0, y[1], z[1]), at(3.0, y[1], z[0])]);
    };
    strip([0.0, 0.9], [-4.0, 4.0]);
    strip([2.3, 3.0], [-4.0, 4.0]);
    strip([0.9, 2.3], [-4.0, -1.0]);
    strip([0.9, 2.3], [1.0, 4.0]);
}

fn poses() -> [Camera; 3] {
    [
        Camera::look_at(dvec(0.2, 1.6, 3.6), dvec(-0.2, 1.0, -4.0), 65.0),
        Camera::look_at(dvec(-2.6, 2.2, 2.5), dvec(1.0, 0.4, -2.0), 70.0),
        Camera::look_at(dvec(2.4, 1.2, 0.4), dvec(-3.0, 0.8, -0.6), 75.0),
    ]
}

fn pictures(tracer: &Tracer, pose: &Camera) -> [ReferenceFrame; 2] {
    [3, 77].map(|seed| {
        let trace = TraceSettings { samples: SAMPLES, bounces: TraceSettings::ALL_BOUNCES, seed };
        ReferenceFrame::trace(tracer, pose, SIZE, &trace, NEVER).unwrap()
    })
}

/// The scene after a random edit of a kind, the same for every seed.
fn edited(scene: &Scene, kind: &str, seed: u64) -> Scene {
    let key = Key::of_pixel(seed, 77);
    let number = |k: u32| key.with(k).pair()[0];
    let base = if kind == "loaded again" { room(true) } else { scene.clone() };
    let mut edit = base.to_edit();
    let named = |name: &str| base.materials.iter().position(|m| m.name == name).unwrap();
    let sun = edit.daylight.sun.unwrap();
    let boxes = ["low box", "tall box", "cube"];
    let object = ObjectKey::first(boxes[(number(9) * 3.0) as usize]);
    let way = |k: u32, most: f32| f64::from((number(k) - 0.5) * 2.0 * most);
    match kind {
        "colour" => {
            let material = named(["wall", "red", "blue"][(number(1) * 3.0) as usize]);
            let colour = Vec3::new(number(2), number(3), number(4)) * 0.9;
            let diffuse = &mut edit.materials[material].diffuse;
            *diffuse = diffuse.lerp(colour, number(5));
        }
        "lamp dimmed" => edit.materials[named("lamp")].emission *= 0.01 + 2.0 * number(2),
        "sun" if number(1) < 0.5 => {
            edit.daylight.sun = Some(Sun { irradiance: sun.irradiance * (0.5 + number(2)), ..sun });
        }
        "sun" => {
            let turned = Quat::from_rotation_y(0.5 * (number(2) - 0.5)) * sun.direction;
            edit.daylight.sun = Some(Sun { direction: turned, ..sun });
        }
        "sky" => edit.daylight.sky = Some(Sky::even(Vec3::new(number(2), number(3), number(4)))),
        "object moved" => {
            let moved = edit.objects.entry(object).or_default();
            moved.moved_m = dvec(way(2, 1.0), 0.0, way(3, 1.0));
            moved.turned_deg = if number(4) < 0.5 { way(5, 90.0) } else { 0.0 };
        }
        "object hidden" => edit.objects.entry(object).or_default().is_hidden = true,
        "lamp moved" => {
            edit.objects.entry(ObjectKey::first("lamp")).or_default().moved_m =
                dvec(way(2, 1.5), 0.0, way(3, 1.5));
        }
        "pane moved" => {
            edit.objects.entry(ObjectKey::first("pane")).or_default().moved_m =
                dvec(way(2, 1.0), 0.0, way(3, 1.0));
        }
        "pane opaque" => {
            let diffuse = Vec3::new(number(2), number(3), number(4)) * 0.9;
            edit.materials[named("pane")] = Material::diffuse("pane", diffuse);
        }
        _ => {}
    }
    base.with_edit(&edit)
}

/// What the light of a pixel moved by, as a share of that before: its largest channel.
fn change(before: &ReferenceFrame, after: &ReferenceFrame, pixel: u32) -> Vec3 {
    (after.light(pixel) - before.light(pixel)) / before.light(pixel).max_element().max(f32::MIN_POSITIVE)
}

/// The edits of some seeds, counted by kind. `report` is called with each.
pub(crate) fn run(
    seeds: impl Iterator<Item = u64>,
    report: &mut dyn FnMut(u64, &'static str, Found, f64),
) -> BTreeMap<&'static str, Found> {
    let tracer = Arc::new(Tracer::new(Arc::new(room(false))));
    let before = poses().map(|pose| pictures(&tracer, &pose));
    let mut sums: BTreeMap<&'static str, Found> = BTreeMap::new();
    for seed in seeds {
        let kind = KINDS[seed as usize % KINDS.len()];
        let at = (seed as usize / KINDS.len()) % before.len();
        let new = Arc::new(tracer.with_state(Arc::new(edited(tracer.scene(), kind, seed))));
        let after = pictures(&new, &poses()[at]);
        let mut walk = Walkthrough::new(tracer.clone(), WalkthroughSettings::default());
        walk.cache_mut().insert(Arc::new(before[at][0].clone()));
        let mut next = Walkthrough::new(new.clone(), WalkthroughSettings::default());
        let start = std::time::Instant::now();
        next.take_references(walk, NEVER);
        let secs = start.elapsed().as_secs_f64();
        let now = next.cache().entries().first().map(|entry| entry.frame.clone());
        let found = compare(&before[at], &after, now.as_deref());
        report(seed, kind, found, secs);
        *sums.entry(kind).or_default() += found;
    }
    sums
}

fn compare(before: &[ReferenceFrame; 2], after: &[ReferenceFrame; 2], now: Option<&ReferenceFrame>) -> Found {
    let mut found = Found::default();
    for pixel in (0..SIZE[0] * SIZE[1]).filter(|&pixel| before[0].has_light(pixel)) {
        let [is, was] = [&after[0], &before[0]].map(|frame| frame.disparity()[pixel as usize]);
        if is != was || was == 0.0 || !after[0].has_light(pixel) {
            continue;
        }
        let [a, b] = [0, 1].map(|k| change(&before[k], &after[k], pixel));
        let largest = |change: Vec3| change.abs().max_element();
        let has_moved = largest((a + b) / 2.0) > MAX_CHANGE;
        let has_surely = has_moved && largest(a).min(largest(b)) > MAX_CHANGE;
        let is_marked = now.is_none_or(|now| !now.has_light(pixel));
        found.all += 1;
        found.moved += usize::from(has_moved);
        found.marked += usize::from(is_marked);
        found.missed += usize::from(has_surely && !is_marked);
    }
    found
}
