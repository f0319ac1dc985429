//! What must hold for the choice among many lamps.

use super::direct::{GroupLight, LightKinds};
use super::sample::sample;
use super::share::{CellLights, LightTurn, MAX_LIGHTS, Part};
use super::tree::LightTree;
use crate::math::key::Key;
use crate::scene::{Beam, Light, Scene, builtin};
use crate::trace::{RayCounts, SurfacePoint, Tracer};
use crate::{Camera, View};
use glam::{DVec3, Vec3};
use std::sync::Arc;

/// The Cornell box with `count` lamps of all kinds at random places, some in one place. The
/// brightest is up to `contrast` times as bright as the faintest.
fn many_lamps(count: u32, contrast: f32) -> Scene {
    let mut scene = builtin::build("cornell").unwrap();
    let [low, high] = scene.bounds_m.map(|p| scene.frame.scene_from_world_f64(p).as_vec3());
    let size = (high - low).length() / 40.0;
    scene.lights = (0..count)
        .map(|i| {
            let key = Key::of_pixel(5, if i % 31 == 0 { 0 } else { i });
            let ([x, y], [z, bright]) = (key.pair(), key.with(1).pair());
            let at = low + Vec3::new(x, y, z) * (high - low);
            let [u, v] = [2, 3].map(|k| Vec3::from(point_of(key.with(k))) * size);
            let light = Vec3::splat(1.0 + bright.powi(8) * (contrast - 1.0));
            match i % 3 {
                0 => Light::Quad {
                    corner: at,
                    edge_u: u,
                    edge_v: v,
                    radiance: light,
                    has_one_side: i % 2 == 0,
                },
                1 => Light::Point { position: at, intensity: light, beam: None, profile: None },
                _ => {
                    let beam = Some(Beam::new(u, 0.2, 0.5));
                    Light::Point { position: at, intensity: light, beam, profile: None }
                }
            }
        })
        .collect();
    scene
}

fn point_of(key: Key) -> [f32; 3] {
    let ([x, y], [z, _]) = (key.pair(), key.with(9).pair());
    [x - 0.5, y - 0.5, z - 0.5]
}

/// Points on the surfaces of a scene.
fn points(tracer: &Tracer) -> Vec<SurfacePoint> {
    let start = tracer.scene().start();
    let eye: DVec3 = start.eye;
    let views = [start, &Camera::look_at(eye, eye + DVec3::new(0.3, 0.4, -1.0), 60.0)];
    let views = views.map(|camera| View::new(camera, &tracer.scene().frame, [3, 3]));
    let rays = views.iter().flat_map(|view| (0..9).map(|pixel| Tracer::primary_ray(view, pixel)));
    rays.filter_map(|ray| Some(tracer.surface(&ray, &tracer.closest(&ray)?))).collect()
}

fn all_parts(tree: &LightTree) -> CellLights {
    let parts = tree.roots().iter().map(|&node| Part { node, visible: 1.0 }).collect();
    CellLights::new(tree, Vec::new(), parts)
}

#[test]
fn every_lamp_is_in_the_tree_once_and_its_nodes_bound_it() {
    for count in [1, 2, 3, 65, 1000] {
        let scene = many_lamps(count, 1e4);
        let tree = LightTree::new(&scene);
        let mut lamps: Vec<u32> =
            tree.roots().iter().flat_map(|&root| tree.lamps_of(root)).copied().collect();
        lamps.sort_unstable();
        assert!(lamps.iter().copied().eq(0..count));
        let mut open = tree.roots().to_vec();
        while let Some(node) = open.pop() {
            let Some(halves) = tree.children(node) else {
                assert_eq!(tree.lamps_of(node).len(), 1);
                continue;
            };
            let both: Vec<u32> = halves.iter().flat_map(|&half| tree.lamps_of(half)).copied().collect();
            assert_eq!(both, tree.lamps_of(node));
            for half in halves.map(|half| tree.node(half)) {
                let node = tree.node(node);
                let reach = node.centre.distance(half.centre);
                assert!(reach <= node.radius * 1.0001 + half.radius, "the middle of a half lies outside");
            }
            open.extend(halves);
        }
    }
}

#[test]
fn the_mean_weight_of_a_lamp_is_one_wherever_it_can_bring_light() {
    for count in [300, 1000] {
        weights_are_one(count);
    }
}

fn weights_are_one(count: usize) {
    const OFFSETS: u16 = 4096;
    let scene = many_lamps(count as u32, 10.0);
    let tracer = Tracer::new(Arc::new(scene));
    let tree = LightTree::new(tracer.scene());
    let cell = all_parts(&tree);
    for point in points(&tracer) {
        for samples in [16, 64, 512] {
            let (mut weights, mut largest) = (vec![0.0f64; count], vec![0.0f64; count]);
            for offset in 0..OFFSETS {
                let random = (f32::from(offset) + 0.5) / f32::from(OFFSETS);
                let turns = cell.chosen_turns(&tree, &point, samples, random);
                let all: u32 = turns.iter().map(|turn| turn.samples).sum();
                assert!(all <= samples + 1, "{all} candidates");
                for LightTurn { index, weight, .. } in turns {
                    let (sum, most) = (&mut weights[index as usize], &mut largest[index as usize]);
                    *sum += f64::from(weight) / f64::from(OFFSETS);
                    *most = most.max(f64::from(weight));
                }
            }
            for ((light, weight), most) in tracer.scene().lights.iter().zip(&weights).zip(largest) {
                let brings = (0..64).any(|i| {
                    let u = Key::of_pixel(1, i).pair();
                    let sample = sample(tracer.scene(), light, &point, point.origin_in_front(), u);
                    sample.is_some_and(|sample| sample.irradiance != Vec3::ZERO)
                });
                // The offsets are a grid, which counts each lamp once more or less.
                let is_one = (weight - 1.0).abs() <= 1.01 * most / f64::from(OFFSETS) + 1e-3;
                assert!(is_one || !brings && *weight == 0.0, "{weight} for {light:?} ({samples} samples)");
            }
        }
    }
}

/// Slow twin: each lamp on its own.
fn sum_of_all(tracer: &Tracer, point: &SurfacePoint) -> f64 {
    let light = |(index, light): (u32, &Light)| {
        let shift = Key::of_pixel(77, index).pair();
        let irradiance = tracer.irradiance_of_light(light, point, 256, shift, &mut RayCounts::default());
        f64::from(irradiance.x)
    };
    (0..).zip(&tracer.scene().lights).map(light).sum()
}

#[test]
fn the_mean_over_seeds_is_the_sum_of_all_lamps_and_its_noise_is_bounded() {
    const SEEDS: u16 = 400;
    let tracer = Tracer::new(Arc::new(many_lamps(1000, 1e4)));
    for (number, point) in (0..).zip(points(&tracer)) {
        let whole = sum_of_all(&tracer, &point);
        for samples in [1u32, 4] {
            let mut rays = RayCounts::default();
            let estimates: Vec<f64> = (0..SEEDS)
                .map(|seed| {
                    let key = Key::of_pixel(u64::from(seed), number);
                    f64::from(tracer.irradiance(&point, samples, key, &mut rays).x)
                })
                .collect();
            assert!(rays.shadow <= u64::from(SEEDS) * 16 * u64::from(samples), "{} rays", rays.shadow);
            let count = f64::from(SEEDS);
            let mean = estimates.iter().sum::<f64>() / count;
            let variance = estimates.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / (count - 1.0);
            let error = (variance / count).sqrt();
            // Parts that are left out of a cell may bring 0.4 % of the light.
            let allowed = 4.0 * error + 0.004 * whole;
            assert!((mean - whole).abs() <= allowed, "{samples} samples: {mean}, {whole} +- {error}");
            let most = if samples == 1 { 0.9 } else { 0.6 };
            assert!(variance.sqrt() < most * whole, "{samples} samples: {whole} +- {}", variance.sqrt());
        }
    }
    assert!(tracer.light_grid().cuts().sharing_cells > 0);
}

#[test]
fn lamps_of_one_group_lie_together_and_groups_add_up_to_all() {
    let mut scene = many_lamps(300, 10.0);
    scene.light_groups.of_light = (0..300u16).map(|i| (i % 3) as u8).collect();
    let tree = LightTree::new(&scene);
    assert_eq!(tree.roots().len(), 3);
    for (group, &root) in (0..).zip(tree.roots()) {
        assert!(tree.lamps_of(root).iter().all(|light| light % 3 == group));
    }
    let tracer = Tracer::new(Arc::new(scene));
    for tracer in [tracer.by_groups(), tracer] {
        for point in points(&tracer) {
            let shift = |light| Key::of_pixel(3, 3).with(light).pair();
            let (mut groups, mut rays) = (GroupLight::default(), RayCounts::default());
            let found = (&mut rays, &mut groups);
            tracer.add_irradiance_by_group(LightKinds::All, &point, 4, shift, found);
            let all = tracer.irradiance_of(LightKinds::All, &point, 4, shift, &mut rays);
            let sum: Vec3 = groups.iter().sum();
            assert!((sum - all).length() <= 1e-5 * all.length(), "{sum}, {all}");
        }
    }
}

#[test]
fn a_few_lamps_get_all_their_samples() {
    for (count, is_shared) in [(MAX_LIGHTS as u32, false), (MAX_LIGHTS as u32 + 1, true)] {
        let tree = LightTree::new(&many_lamps(count, 1e4));
        let cell = all_parts(&tree);
        assert_eq!((cell.is_shared(), cell.len(&tree)), (is_shared, count as usize));
        assert!((0..count).all(|light| cell.contains(&tree, light)) && !cell.contains(&tree, count));
        assert_eq!(cell.own_turns(3).count(), if is_shared { 0 } else { count as usize });
    }
}
