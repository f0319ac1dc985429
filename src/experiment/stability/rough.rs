//! Cases D of the catalogue that concern rough surfaces: all of the range of roughness, from
//! straight on to grazing, and values out of range.

use super::case::{Case, Outcome, Trial, case};
use super::pictures::{TRACE, bad_values, exact, full};
use super::rooms::{Room, dvec, quad, tracer};
use crate::camera::{Camera, View};
use crate::experiment::run::ExperimentError;
use crate::scene::{Gradient, Material, MaterialKind, SceneBuilder, Sky};
use crate::trace::{RayCounts, TraceSettings, Tracer};
use glam::{DVec3, Vec3};

pub(super) const CASES: &[Case] = &[
    case("D15 rough metal in white light, roughness 0 to 1", "light gained", 0.02, |_| gained(metal)),
    case("D15 a coat over white paint, roughness 0 to 1", "light gained", 0.02, |_| gained(coat)),
    case("D15 frosted glass in white light, roughness 0 to 1", "light gained", 0.02, |_| gained(pane)),
    case("D15 the metal, which loses what meets further facets", "light lost", 0.3, |_| lost(metal)),
    case("D16 rough surfaces at grazing views", "bad values, full and exact", 0.0, grazing),
    case("D16 roughness of NaN, -1 and 1e9", "values outside 0 to 1, bad values", 0.0, odd_roughness),
];

/// Elevations of the viewer above the surface, degrees.
const ELEVATIONS: [f64; 6] = [90.0, 45.0, 20.0, 8.0, 2.0, 0.5];

fn metal(roughness: f32) -> Material {
    let kind = MaterialKind::Glossy { reflectance: Vec3::ONE, roughness };
    Material { kind, ..Material::diffuse("metal", Vec3::ZERO) }
}

fn coat(roughness: f32) -> Material {
    let kind = MaterialKind::Glossy { reflectance: Vec3::splat(0.04), roughness };
    Material { kind, ..Material::diffuse("coat", Vec3::ONE) }
}

fn pane(roughness: f32) -> Material {
    let kind = MaterialKind::Frosted { eta: 1.5, transmittance: Vec3::ONE, roughness };
    Material { kind, ..Material::diffuse("pane", Vec3::ZERO) }
}

/// A floor of a material in light of one from everywhere.
fn in_white_light(material: Material) -> Result<Tracer, ExperimentError> {
    let mut b = SceneBuilder::new("white");
    let floor = b.add_material(material);
    quad(&mut b, dvec(-50.0, 0.0, 50.0), DVec3::X * 100.0, DVec3::Z * -100.0, floor);
    let white = Vec3::ONE;
    b.sky = Some(Sky::Gradient(Gradient { zenith: white, horizon: white, ground: white }));
    Ok(tracer(b)?)
}

/// What a viewer at an elevation sees of a floor around its middle.
fn seen(tracer: &Tracer, elevation_deg: f64) -> f64 {
    let (sin, cos) = elevation_deg.to_radians().sin_cos();
    let camera = Camera::look_at(dvec(0.1 * sin, sin, cos), DVec3::ZERO, 0.1);
    let view = View::new(&camera, &tracer.scene().frame, [1, 1]);
    let settings = TraceSettings { samples: 1024, ..TRACE };
    f64::from(tracer.pixel(&view, 0, &settings, &mut RayCounts::default()).radiance.max_element())
}

/// The light that is seen for all roughnesses and elevations.
fn all_seen(material: fn(f32) -> Material) -> Result<Vec<f64>, ExperimentError> {
    let mut found = Vec::new();
    for step in 0..=10u8 {
        let tracer = in_white_light(material(f32::from(step) / 10.0))?;
        found.extend(ELEVATIONS.map(|elevation| seen(&tracer, elevation)));
    }
    Ok(found)
}

fn gained(material: fn(f32) -> Material) -> Outcome {
    Ok(all_seen(material)?.into_iter().fold(0.0, |most: f64, light| most.max(light - 1.0)).into())
}

fn lost(material: fn(f32) -> Material) -> Outcome {
    Ok(all_seen(material)?.into_iter().fold(0.0, |most: f64, light| most.max(1.0 - light)).into())
}

/// The room with walls of a material.
fn room(material: Material) -> SceneBuilder {
    let mut b = Room::PLAIN.builder();
    b.materials[0] = material;
    b
}

fn grazing(_: &Trial) -> Outcome {
    let mut bad = 0;
    for roughness in [0.0, 0.03, 0.04, 0.2, 1.0] {
        for material in [metal(roughness), coat(roughness), pane(roughness)] {
            let tracer = tracer(room(material))?;
            // Along the floor, a thousandth of its length above it.
            let eye = |x: f64| Room::PLAIN.at(x, 0.005, 3.9);
            let camera = |x: f64| Camera::look_at(eye(x), Room::PLAIN.at(0.0, 0.0, -3.0), 60.0);
            bad += bad_values(&full(&tracer, &camera(0.0)));
            bad += bad_values(&exact(&tracer, &camera(0.0), &camera(0.1), 0.0));
        }
    }
    Ok(bad.into())
}

fn odd_roughness(_: &Trial) -> Outcome {
    let mut wrong = 0;
    for roughness in [f32::NAN, -1.0, 1e9, f32::INFINITY] {
        for material in [metal(roughness), pane(roughness)] {
            let tracer = tracer(room(material))?;
            let is_right = |m: &Material| match m.kind {
                MaterialKind::Glossy { roughness, .. } | MaterialKind::Frosted { roughness, .. } => {
                    (0.0..=1.0).contains(&roughness)
                }
                _ => true,
            };
            wrong += tracer.scene().materials.iter().filter(|m| !is_right(m)).count();
            wrong += bad_values(&full(&tracer, &Room::PLAIN.camera()));
        }
    }
    Ok(wrong.into())
}
