//! The laws of rough lobes, from nearly smooth to fully rough, where a grid of directions would not
//! resolve them: everything is integrated over the normals of the microfacets.

use afterimage::bsdf::{Facing, Lobe, base_share};
use afterimage::math::key::Key;
use afterimage::math::sampling::lattice;
use afterimage::scene::{Material, MaterialKind};
use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};

const ROUGHNESSES: [f32; 7] = [0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0];
const COSINES: [f32; 5] = [1.0, 0.8, 0.5, 0.2, 0.05];

/// A sheet whose normal is +Z.
const SHEET: Facing = Facing { geometric_normal: Vec3::Z, shading_normal: Vec3::Z, enters_solid: None };

fn metal(reflectance: Vec3, roughness: f32) -> Material {
    let kind = MaterialKind::Glossy { reflectance, roughness };
    Material { kind, ..Material::diffuse("metal", Vec3::ZERO) }
}

fn frosted(eta: f32, roughness: f32) -> Material {
    let kind = MaterialKind::Frosted { eta, transmittance: Vec3::ONE, roughness };
    Material { kind, ..Material::diffuse("pane", Vec3::ZERO) }
}

fn incident(cos: f32) -> Vec3 {
    Vec3::new((1.0 - cos * cos).sqrt(), 0.0, -cos)
}

/// Cells of the hemisphere of normals, finer where a lobe of this slope is steep: normal and solid
/// angle of each.
fn normals(alpha: f64, side: u32) -> impl Iterator<Item = (DVec3, f64)> {
    let theta = move |i: f64| (alpha * i / (f64::from(side) - i)).atan();
    (0..side * side).map(move |cell| {
        let (ring, sector) = (f64::from(cell / side), f64::from(cell % side));
        let (low, high) = (theta(ring), theta(ring + 1.0).min(PI / 2.0));
        let (sin, cos) = theta(ring + 0.5).sin_cos();
        let (y, x) = (TAU * (sector + 0.5) / f64::from(side)).sin_cos();
        (DVec3::new(sin * x, sin * y, cos), (low.cos() - high.cos()) * TAU / f64::from(side))
    })
}

/// Light that a white lobe scatters once, by the formulas of the sources.
fn single_scattering(roughness: f32, cos: f32) -> f64 {
    let (alpha, outgoing) = (f64::from(roughness).powi(2), -incident(cos).as_dvec3());
    let hidden = |v: DVec3| ((1.0 + alpha * alpha * (1.0 / (v.z * v.z) - 1.0)).sqrt() - 1.0) / 2.0;
    normals(alpha, 512)
        .map(|(normal, solid_angle)| {
            let along = outgoing.dot(normal);
            let incoming = normal * (2.0 * along) - outgoing;
            if along <= 0.0 || incoming.z <= 0.0 {
                return 0.0;
            }
            let z2 = normal.z * normal.z;
            let density = alpha * alpha / (PI * (z2 * (alpha * alpha - 1.0) + 1.0).powi(2));
            density * along / outgoing.z / (1.0 + hidden(outgoing) + hidden(incoming)) * solid_angle
        })
        .sum()
}

/// The share of white light that the samples of a lobe carry.
fn furnace(material: &Material, facing: &Facing, cos: f32) -> f64 {
    const SAMPLES: u32 = 1 << 14;
    let weight =
        |i| f64::from(material.sample(facing, incident(cos), lattice(i, SAMPLES, [0.5; 2])).total_weight());
    (0..SAMPLES).map(weight).sum::<f64>() / f64::from(SAMPLES)
}

#[test]
fn a_white_lobe_keeps_at_least_what_is_scattered_once_and_never_gains_light() {
    for roughness in ROUGHNESSES {
        for cos in COSINES {
            let once = single_scattering(roughness, cos);
            let white = furnace(&metal(Vec3::ONE, roughness), &SHEET, cos);
            assert!(white <= 1.0 + 1e-4 && white >= once - 3e-3, "{roughness}, {cos}: {white} for {once}");
            // At least two fifths of what one scattering loses come back.
            assert!(white - once > 0.4 * (1.0 - once) - 3e-3, "{roughness}, {cos}: {white} for {once}");
            let pane = furnace(&frosted(1.5, roughness), &SHEET, cos);
            assert!(pane <= 1.0 + 1e-4 && pane >= once - 3e-3, "{roughness}, {cos}: {pane} for {once}");
        }
    }
}

#[test]
fn coat_and_base_together_never_gain_light() {
    for roughness in [0.0, 0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0] {
        for cos in COSINES {
            for f0 in [0.02, 0.04, 0.2, 0.9] {
                let kind = MaterialKind::Glossy { reflectance: Vec3::splat(f0), roughness };
                let floor = Material { kind, ..Material::diffuse("floor", Vec3::ONE) };
                let (coat, base) = (furnace(&floor, &SHEET, cos), f64::from(base_share(&floor, cos)));
                assert!(
                    coat + base > if f0 < 0.5 { 0.94 } else { 0.75 },
                    "{roughness}, {cos}, {f0}: {coat} and {base}"
                );
                assert!(coat + base < 1.0 + 1e-3, "{roughness}, {cos}, {f0}: {coat} and {base}");
            }
        }
    }
}

/// Pearson's chi-square of samples counted by the microfacet that scatters them, against the
/// density integrated over the same cells. `scattered` returns the direction that a microfacet
/// gives, and the solid angle of directions per solid angle of its normals.
fn chi_square(
    lobe: &Material,
    facing: &Facing,
    cos: f32,
    normal_of: impl Fn(Vec3) -> Option<DVec3>,
    scattered: impl Fn(DVec3) -> Option<(DVec3, f64)>,
) -> (f64, f64) {
    const RINGS: usize = 8;
    const SECTORS: usize = 8;
    const SAMPLES: u32 = 1 << 16;
    let (MaterialKind::Glossy { roughness, .. } | MaterialKind::Frosted { roughness, .. }) = lobe.kind else {
        panic!("{lobe:?}")
    };
    let alpha = f64::from(roughness).powi(2);
    let bin = |normal: DVec3| {
        let slope = normal.truncate().length() / normal.z / alpha;
        let ring = (slope / (1.0 + slope) * RINGS as f64) as usize;
        let around = normal.y.atan2(normal.x) / TAU + 0.5;
        ring.min(RINGS - 1) * SECTORS + ((around * SECTORS as f64) as usize).min(SECTORS - 1)
    };
    let mut expected = vec![0.0; RINGS * SECTORS];
    for (normal, solid_angle) in normals(alpha, 1024) {
        if let Some((direction, stretch)) = scattered(normal) {
            let density = lobe.pdf(facing, incident(cos), direction.as_vec3().normalize_or_zero());
            expected[bin(normal)] += f64::from(density) * stretch * solid_angle * f64::from(SAMPLES);
        }
    }
    let mut counts = vec![0u32; RINGS * SECTORS];
    for i in 0..SAMPLES {
        let set = lobe.sample(facing, incident(cos), Key::of_pixel(5, i).pair());
        for normal in set.heaviest_first().filter_map(|s| normal_of(s.direction)) {
            counts[bin(normal)] += 1;
        }
    }
    let used = counts.iter().zip(&expected).filter(|(_, e)| **e > 8.0);
    used.fold((0.0, 0.0), |(sum, n), (count, e)| (sum + (f64::from(*count) - e).powi(2) / e, n + 1.0))
}

#[test]
fn samples_follow_the_density_of_reflection_by_chi_square() {
    for roughness in ROUGHNESSES {
        for cos in COSINES {
            let outgoing = -incident(cos).as_dvec3();
            for lobe in [metal(Vec3::ONE, roughness), frosted(1.5, roughness)] {
                let normal_of = |d: Vec3| (d.z > 0.0).then(|| (d.as_dvec3() + outgoing).normalize_or_zero());
                let (sum, cells) = chi_square(&lobe, &SHEET, cos, normal_of, |normal| {
                    let along = outgoing.dot(normal);
                    let direction = normal * (2.0 * along) - outgoing;
                    (along > 0.0 && direction.z > 0.0).then_some((direction, 4.0 * along))
                });
                assert!(sum < cells + 5.0 * (2.0 * cells).sqrt(), "{roughness}, {cos}: {sum} for {cells}");
            }
        }
    }
}

#[test]
fn samples_follow_the_density_of_refraction_by_chi_square() {
    for (enters, eta) in [(true, 1.0 / 1.5), (false, 1.5f64)] {
        let facing = Facing { enters_solid: Some(enters), ..SHEET };
        for roughness in [0.1, 0.3, 0.6, 1.0] {
            // Where most light is reflected totally, the density of the rest has no bound.
            for cos in COSINES.into_iter().filter(|cos| enters || *cos > 0.75) {
                let outgoing = -incident(cos).as_dvec3();
                let normal_of = |d: Vec3| {
                    let normal = (outgoing * eta + d.as_dvec3()).normalize_or_zero();
                    (d.z < 0.0).then(|| if normal.z < 0.0 { -normal } else { normal })
                };
                let through = |normal: DVec3| {
                    let along = outgoing.dot(normal);
                    let cos2 = 1.0 - eta * eta * (1.0 - along * along);
                    let direction = normal * (eta * along - cos2.max(0.0).sqrt()) - outgoing * eta;
                    let into = direction.dot(normal);
                    let stretch = (eta * along + into).powi(2) / -into;
                    (along > 0.0 && cos2 > 0.0).then_some((direction, stretch))
                };
                let (sum, cells) = chi_square(&frosted(1.5, roughness), &facing, cos, normal_of, through);
                assert!(sum < cells + 5.0 * (2.0 * cells).sqrt(), "{roughness}, {cos}: {sum} for {cells}");
            }
        }
    }
}

#[test]
fn the_value_of_a_narrow_lobe_is_the_weight_of_its_samples_times_their_density() {
    for roughness in ROUGHNESSES {
        for lobe in [metal(Vec3::new(0.9, 0.6, 0.2), roughness), frosted(1.5, roughness)] {
            for (cos, i) in COSINES.iter().flat_map(|cos| (0..256).map(move |i| (*cos, i))) {
                let set = lobe.sample(&SHEET, incident(cos), lattice(i, 256, [0.5; 2]));
                for s in set.heaviest_first() {
                    let value = lobe.evaluate(&SHEET, incident(cos), s.direction) * s.direction.z.abs();
                    let expected = s.weight * lobe.pdf(&SHEET, incident(cos), s.direction);
                    let off = (value - expected).abs().max_element();
                    assert!(off <= 2e-3 * expected.max_element(), "{roughness}, {cos}: {value} {expected}");
                }
            }
        }
    }
}

#[test]
fn a_nearly_smooth_lobe_is_the_smooth_one() {
    let (rough, smooth) = (metal(Vec3::splat(0.5), 0.01), metal(Vec3::splat(0.5), 0.0));
    assert!(rough.is_specular() && !metal(Vec3::splat(0.5), 0.04).is_specular());
    let seen = incident(0.7);
    assert_eq!(rough.sample(&SHEET, seen, [0.3; 2]), smooth.sample(&SHEET, seen, [0.3; 2]));
    let mirror = Material {
        kind: MaterialKind::Mirror { reflectance: Vec3::splat(0.5), fresnel: true },
        ..smooth.clone()
    };
    let [a, b] = [&smooth, &mirror].map(|m| m.sample(&SHEET, seen, [0.3; 2]).total_weight());
    assert!((a - b).abs() < 1e-5);
}
