//! The laws that every lobe obeys. A new lobe gets a test that calls [`assert_lawful`].

use afterimage::bsdf::{Diffuse, Facing, Lobe, fresnel_dielectric};
use afterimage::math::sampling::{cosine_hemisphere, frame_around, lattice};
use afterimage::scene::{Material, MaterialKind, SolidSide};
use glam::Vec3;
use std::f32::consts::TAU;

const SAMPLES: u32 = 4096;

/// Side of the grid of directions, in cosine and azimuth, that integrals are taken over.
const GRID: u32 = 128;

/// Points of the unit square.
fn points() -> impl Iterator<Item = [f32; 2]> {
    (0..SAMPLES).map(|i| lattice(i, SAMPLES, [0.5; 2]))
}

/// Surfaces with equal and with different normals, each as a sheet and as both sides of a solid.
fn facings() -> Vec<Facing> {
    let normal = Vec3::new(0.36, 0.48, 0.8);
    let tilted = (normal + Vec3::new(0.3, -0.2, 0.1)).normalize_or_zero();
    let of = |shading_normal| {
        [None, Some(true), Some(false)].map(|enters_solid| Facing {
            geometric_normal: normal,
            shading_normal,
            enters_solid,
        })
    };
    [of(normal), of(tilted)].concat()
}

/// Directions of travel towards the viewer's side, from straight on to grazing.
fn incidents(facing: &Facing) -> Vec<Vec3> {
    let frame = frame_around(facing.geometric_normal);
    [[0.0, 0.1], [0.3, 0.2], [0.6, 0.5], [0.9, 0.9], [0.99, 0.4]]
        .map(|u| -(frame * cosine_hemisphere(u)))
        .to_vec()
}

/// Integrates over all directions.
fn integral(value: impl Fn(Vec3) -> Vec3) -> Vec3 {
    let mut sum = Vec3::ZERO;
    for i in 0..GRID * GRID {
        let z = 2.0 * ((i / GRID) as f32 + 0.5) / GRID as f32 - 1.0;
        let (sin, cos) = (TAU * ((i % GRID) as f32 + 0.5) / GRID as f32).sin_cos();
        let r = (1.0 - z * z).sqrt();
        sum += value(Vec3::new(r * cos, r * sin, z));
    }
    sum * (2.0 * TAU / (GRID * GRID) as f32)
}

fn assert_lawful(lobe: &impl Lobe) {
    for facing in facings() {
        for incident in incidents(&facing) {
            assert_conserves_energy(lobe, &facing, incident);
            if lobe.is_specular() {
                assert_has_no_density(lobe, &facing, incident);
            } else {
                assert_samples_its_density(lobe, &facing, incident);
                assert_reciprocal(lobe, &facing, incident);
            }
        }
    }
}

/// Of any light no more is scattered than arrives.
fn assert_conserves_energy(lobe: &impl Lobe, facing: &Facing, incident: Vec3) {
    let mean =
        points().map(|u| lobe.sample(facing, incident, u).total_weight()).sum::<f32>() / SAMPLES as f32;
    assert!((0.0..=1.0 + 1e-4).contains(&mean), "{facing:?}, {incident}: {mean}");
}

/// A specular lobe has neither value nor density, and the same directions for any random numbers.
fn assert_has_no_density(lobe: &impl Lobe, facing: &Facing, incident: Vec3) {
    let set = lobe.sample(facing, incident, [0.0; 2]);
    for u in points().step_by(64) {
        assert_eq!(lobe.sample(facing, incident, u), set);
    }
    for scatter in set.heaviest_first() {
        assert_eq!(lobe.evaluate(facing, incident, scatter.direction), Vec3::ZERO);
        assert_eq!(lobe.pdf(facing, incident, scatter.direction), 0.0);
        assert!((scatter.direction.length() - 1.0).abs() < 1e-5, "{}", scatter.direction);
        let is_behind = scatter.direction.dot(facing.geometric_normal) < 0.0;
        assert_eq!(is_behind, scatter.is_transmitted, "{facing:?}, {incident}: {scatter:?}");
    }
}

/// The weight of each sample is value times cosine over density; the density integrates to the
/// share of samples that are not absorbed, and so does its part in every octant.
fn assert_samples_its_density(lobe: &impl Lobe, facing: &Facing, incident: Vec3) {
    let octant = |d: Vec3| d.cmpgt(Vec3::ZERO).bitmask() as usize;
    let mut shares = [0.0; 8];
    for u in points() {
        for s in lobe.sample(facing, incident, u).heaviest_first() {
            shares[octant(s.direction)] += 1.0 / SAMPLES as f32;
            let cos = s.direction.dot(facing.shading_normal) * if s.is_transmitted { -1.0 } else { 1.0 };
            let value = lobe.evaluate(facing, incident, s.direction) * cos.max(0.0);
            let expected = s.weight * lobe.pdf(facing, incident, s.direction);
            assert!((value - expected).abs().max_element() < 1e-4 * (1.0 + expected.max_element()), "{s:?}");
        }
    }
    for (which, share) in shares.into_iter().enumerate() {
        let of_octant = |d: Vec3| if octant(d) == which { lobe.pdf(facing, incident, d) } else { 0.0 };
        let expected = integral(|d| Vec3::splat(of_octant(d))).x;
        assert!((share - expected).abs() < 0.01, "octant {which} of {facing:?}: {share} for {expected}");
    }
}

/// Light takes a path both ways with the same loss (Helmholtz). Interpolated normals break this law
/// for every lobe.
fn assert_reciprocal(lobe: &impl Lobe, facing: &Facing, incident: Vec3) {
    if facing.shading_normal != facing.geometric_normal {
        return;
    }
    for scattered in incidents(facing).into_iter().map(|d| -d) {
        let there = lobe.evaluate(facing, incident, scattered);
        let back = lobe.evaluate(facing, -scattered, -incident);
        assert!(
            (there - back).abs().max_element() <= 1e-5 * there.max_element().max(1.0),
            "{there} and {back}"
        );
    }
}

#[test]
fn a_diffuse_lobe_is_lawful() {
    assert_lawful(&Diffuse { albedo: Vec3::new(0.9, 0.5, 0.1) });
    assert_lawful(&Diffuse::WHITE);
    // A diffuse material has no second lobe.
    assert_lawful(&Material::diffuse("wall", Vec3::ONE));
}

#[test]
fn a_mirror_is_lawful() {
    for fresnel in [false, true] {
        let kind = MaterialKind::Mirror { reflectance: Vec3::new(0.9, 0.5, 0.1), fresnel };
        assert_lawful(&Material { kind, ..Material::diffuse("mirror", Vec3::ZERO) });
    }
}

#[test]
fn a_dielectric_is_lawful() {
    for eta in [1.0, 1.33, 1.5, 2.4] {
        assert_lawful(&Material::glass("glass", eta, Vec3::new(1.0, 0.8, 0.3)));
    }
}

#[test]
fn a_glossy_lobe_is_lawful() {
    for roughness in [0.0, 0.4, 0.7, 1.0] {
        for reflectance in [Vec3::new(0.9, 0.5, 0.1), Vec3::splat(0.04)] {
            let kind = MaterialKind::Glossy { reflectance, roughness };
            assert_lawful(&Material { kind, ..Material::diffuse("metal", Vec3::ZERO) });
        }
    }
}

#[test]
fn a_frosted_lobe_is_lawful() {
    for roughness in [0.0, 0.5, 1.0] {
        for eta in [1.33, 1.5, 2.4] {
            let kind = MaterialKind::Frosted { eta, transmittance: Vec3::new(1.0, 0.8, 0.3), roughness };
            assert_lawful(&Material { kind, ..Material::diffuse("pane", Vec3::ZERO) });
        }
    }
}

#[test]
fn a_refracted_path_runs_back_along_itself_with_the_same_loss() {
    let glass = Material::glass("glass", 1.5, Vec3::ONE);
    let there = facings()[1];
    let back = Facing { enters_solid: Some(false), ..there };
    let back =
        Facing { geometric_normal: -back.geometric_normal, shading_normal: -back.shading_normal, ..back };
    for incident in incidents(&there) {
        let through = |facing: &Facing, incident: Vec3| {
            glass.sample(facing, incident, [0.0; 2]).heaviest_first().find(|s| s.is_transmitted).unwrap()
        };
        let inside = through(&there, incident);
        let outside = through(&back, -inside.direction);
        assert!(
            (outside.direction + incident).abs().max_element() < 1e-5,
            "{} {incident}",
            outside.direction
        );
        assert!((outside.weight - inside.weight).abs().max_element() < 1e-5);
    }
}

#[test]
fn fresnel_keeps_energy_and_reflects_totally_beyond_the_critical_angle() {
    for i in 0..=1000 {
        let cos = i as f32 / 1000.0;
        for eta in [1.0 / 1.5, 1.5, 2.4, 1.0] {
            let r = fresnel_dielectric(cos, eta);
            assert!((0.0..=1.0).contains(&r), "cos {cos}, eta {eta}: {r}");
        }
    }
    assert_eq!(fresnel_dielectric(0.5, 2.4), 1.0);
    assert!((fresnel_dielectric(1.0, 1.0 / 1.5) - 0.04).abs() < 1e-6);
    assert_eq!(fresnel_dielectric(0.7, 1.0), 0.0);
}

#[test]
fn only_glass_lets_shadow_rays_pass() {
    let passage = |side| move || (1.0, side);
    let share = |material: &Material, side| material.straight_transmittance(passage(side));
    let glass = Material::glass("glass", 1.5, Vec3::splat(0.5));
    let face = share(&glass, SolidSide::InsideBehind).unwrap();
    let sheet = share(&glass, SolidSide::Thin).unwrap();
    assert!((face.x - 0.5 * 0.96).abs() < 1e-6 && (sheet.x - 0.5 * (1.0 - 0.08 / 1.04)).abs() < 1e-6);
    for opaque in [Material::diffuse("wall", Vec3::ONE), Material::mirror("mirror", Vec3::ONE)] {
        assert_eq!(share(&opaque, SolidSide::Thin), None);
    }
}
