//! Mode `exact`: a pixel shows the surface that its primary ray meets, in light traced there.

use crate::rooms::{cuboid, dvec, leafy_scene, quad, room_camera, room_tracer};
use afterimage::import::{ImportOptions, load};
use afterimage::reference::{PlacementPolicy, ReferenceCache, ReferenceFrame};
use afterimage::scene::{Material, Scene, SceneBuilder, Sky, builtin};
use afterimage::{
    Camera, FrameRequest, Mode, RenderSettings, Renderer, Tracer, Walkthrough, WalkthroughSettings,
    camera::View, lookup::LookupSet, raster::pixel_types::PixelType, reference::placement::THRESHOLD,
    trace::TraceSettings, trace::parallel::NEVER, warp::ReferenceSelector,
};
use glam::{DVec3, Vec3};
use std::{path::Path, sync::Arc};

const SIZE: [u32; 2] = [77, 50];
const TRACE: TraceSettings = TraceSettings { samples: 2, bounces: 0, seed: 3 };

fn settings(mode: Mode) -> RenderSettings {
    RenderSettings { mode, trace: TRACE }
}

fn walkthrough(tracer: &Arc<Tracer>) -> Walkthrough {
    let placement = PlacementPolicy::new(&THRESHOLD, 2.0);
    let settings = WalkthroughSettings { render: settings(Mode::Exact), placement, ..Default::default() };
    Walkthrough::new(tracer.clone(), settings)
}

/// Traces the reference that a walk wants after a frame, if any.
fn add_wanted(walk: &mut Walkthrough) {
    if let Some(pose) = walk.wanted_reference() {
        let size = walk.frame().view.size;
        let reference = walk.reference_job(pose, size).trace(NEVER).unwrap();
        walk.insert(reference).unwrap();
    }
}

fn full(tracer: &Tracer, camera: &Camera) -> afterimage::Frame {
    Renderer::default().render(&FrameRequest::new(tracer, camera, SIZE, &settings(Mode::Full))).clone()
}

fn exact(tracer: &Tracer, camera: &Camera, cache: &ReferenceCache) -> afterimage::Frame {
    let mut renderer = Renderer::default();
    renderer.render(&FrameRequest::new(tracer, camera, SIZE, &settings(Mode::Exact)).reusing(cache)).clone()
}

fn cache_with(tracer: &Tracer, poses: &[Camera], trace: &TraceSettings) -> ReferenceCache {
    let mut cache = ReferenceCache::new(tracer.scene(), 1 << 30);
    for pose in poses {
        cache.insert(Arc::new(ReferenceFrame::trace(tracer, pose, SIZE, trace, NEVER).unwrap()));
    }
    cache
}

fn studio() -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scenes/studio/studio.obj");
    load(&path, &ImportOptions::default(), &|_, _| true).unwrap()
}

#[test]
fn every_pixel_shows_the_surface_that_its_ray_meets() {
    let builtins = builtin::NAMES.iter().map(|name| builtin::build(name).unwrap());
    for scene in builtins.chain([studio(), leafy_scene()]) {
        let tracer = Arc::new(Tracer::new(Arc::new(scene)));
        let mut walk = walkthrough(&tracer);
        let (mut wrong, mut pixels, mut looked_up) = (0, 0, 0);
        for i in [0, 3, 6, 70, 73, 180] {
            let camera = tracer.scene().walk.camera(i, 300).unwrap();
            let full = full(&tracer, &camera);
            let frame = walk.render(&camera, SIZE, NEVER);
            let same = |i: &usize| {
                frame.triangle[*i] == full.triangle[*i]
                    && frame.disparity[*i].to_bits() == full.disparity[*i].to_bits()
            };
            wrong += (0..full.triangle.len()).filter(|i| !same(i)).count();
            pixels += full.triangle.len();
            looked_up += frame.supplier.iter().filter(|s| **s != u8::MAX).count();
            add_wanted(&mut walk);
        }
        let name = &tracer.scene().name;
        assert_eq!(wrong, 0, "{name}: of {pixels} pixels");
        // At least the second frame of each place is looked up, except for sky and mirrors.
        assert!(looked_up * 8 > pixels, "{name}: {looked_up} of {pixels} pixels looked up");
    }
}

#[test]
fn without_a_reference_it_is_the_full_tracer_bit_for_bit() {
    let on_walk = |scene: Scene| {
        let cameras = [0, 100, 200].map(|i| scene.walk.camera(i, 300).unwrap());
        (Tracer::new(Arc::new(scene)), cameras.to_vec())
    };
    let gallery = builtin::build("gallery-bench").unwrap();
    let room = (room_tracer(true, true), vec![room_camera()]);
    for (tracer, cameras) in [room, on_walk(studio()), on_walk(gallery), on_walk(leafy_scene())] {
        for (i, camera) in cameras.into_iter().enumerate() {
            let none = ReferenceCache::new(tracer.scene(), 1 << 30);
            let (exact, full) = (exact(&tracer, &camera, &none), full(&tracer, &camera));
            assert!(exact.radiance == full.radiance, "{} at {i}", tracer.scene().name);
            assert!(
                full.radiance.iter().any(|r| *r != full.radiance[0]),
                "a picture of one colour proves nothing"
            );
        }
    }
}

/// Two closed rooms with a lamp in each, farther apart than the samples of a small picture: a floor
/// that continues behind a thinner wall cannot be distinguished from the floor in front of it.
fn two_rooms() -> Tracer {
    let mut b = SceneBuilder::new("two rooms");
    let wall = b.add_material(Material::diffuse("wall", Vec3::new(0.7, 0.6, 0.5)));
    let lamp = b.add_material(Material::emissive("lamp", Vec3::splat(8.0)));
    for x in [0.0, 5.0] {
        cuboid(&mut b, dvec(x, 0.0, 0.0), dvec(x + 3.9, 3.0, 4.0), wall, true);
        quad(&mut b, dvec(x + 1.5, 2.9, 1.5), DVec3::X, DVec3::Z, lamp);
    }
    Tracer::new(Arc::new(b.finish().unwrap()))
}

#[test]
fn in_another_room_it_is_the_full_tracer_bit_for_bit() {
    let tracer = two_rooms();
    let [here, there] =
        [0.0, 5.0].map(|x| Camera::look_at(dvec(x + 1.0, 1.5, 3.5), dvec(x + 2.0, 1.0, 0.0), 70.0));
    let cache = cache_with(&tracer, &[here], &TRACE);
    assert!(exact(&tracer, &there, &cache).radiance == full(&tracer, &there).radiance);
    let known = exact(&tracer, &here, &cache).stats.types;
    assert!(known.reused * 10 > known.total() * 9, "{known:?}");
}

#[test]
fn the_same_bits_at_any_number_of_threads() {
    let tracer = Arc::new(room_tracer(true, true));
    let pictures = [1, 4].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut walk = walkthrough(&tracer);
            let mut pictures = Vec::new();
            for i in 0..6 {
                let start = room_camera();
                let eye = start.eye + start.forward() * (0.2 * f64::from(i));
                let frame =
                    walk.render(&Camera { eye, yaw: start.yaw + 0.1 * f64::from(i), ..start }, SIZE, NEVER);
                pictures.push((frame.radiance.clone(), frame.types.clone(), frame.supplier.clone()));
                add_wanted(&mut walk);
            }
            assert!(walk.cache().entries().len() > 1, "several references take part");
            pictures
        })
    });
    assert!(pictures[0] == pictures[1]);
}

#[test]
fn light_of_another_epoch_is_never_used() {
    let (old, new) = (Arc::new(room_tracer(false, false)), Arc::new(room_tracer(true, true)));
    let cache = cache_with(&old, &[room_camera()], &TRACE);
    assert_eq!([&old, &new].map(|t| LookupSet::new(&cache, t.epoch()).len()), [1, 0]);
    let mut walk = walkthrough(&old);
    let stale = walk.reference_job(room_camera(), SIZE).trace(NEVER).unwrap();
    walk.set_tracer(new.clone());
    assert!(walk.insert(stale).is_none());
    assert!(walk.render(&room_camera(), SIZE, NEVER).radiance == full(&new, &room_camera()).radiance);
}

/// A sheet between a lit and a dark side, with a mirror on the dark side that shows the sheet's
/// back.
fn sheet() -> Tracer {
    let mut b = SceneBuilder::new("sheet");
    let white = b.add_material(Material::diffuse("white", Vec3::splat(0.8)));
    let mirror = b.add_material(Material::mirror("mirror", Vec3::splat(0.9)));
    quad(&mut b, dvec(-4.0, -4.0, 0.0), dvec(8.0, 0.0, 0.0), dvec(0.0, 8.0, 0.0), white);
    quad(&mut b, dvec(0.5, -1.0, -3.0), dvec(0.0, 2.0, 0.0), dvec(2.0, 0.0, 0.0), mirror);
    b.point_lights.push((dvec(0.0, 1.0, 2.0), Vec3::splat(20.0)));
    Tracer::new(Arc::new(b.finish().unwrap()))
}

#[test]
fn light_of_one_side_of_a_sheet_is_not_reused_on_the_other() {
    let tracer = sheet();
    let lit = Camera::look_at(dvec(0.3, 0.2, 1.5), dvec(0.0, 0.0, 0.0), 75.0);
    let dark = Camera::look_at(dvec(0.3, 0.2, -1.5), dvec(0.0, 0.0, 0.0), 75.0);
    let by_mirror = Camera::look_at(dvec(-1.0, 0.0, -1.5), dvec(1.5, 0.0, -3.0), 50.0);
    let cache = cache_with(&tracer, &[lit], &TRACE);
    assert!(exact(&tracer, &lit, &cache).radiance.iter().all(|r| r.min_element() > 0.0));
    for camera in [dark, by_mirror] {
        let frame = exact(&tracer, &camera, &cache);
        assert!(frame.radiance.iter().all(|r| *r == Vec3::ZERO), "light came through the sheet");
    }
    assert!(exact(&tracer, &by_mirror, &cache).types.contains(&PixelType::Secondary));
    // Nor is the darkness of the other side reused.
    let cache = cache_with(&tracer, &[dark, by_mirror], &TRACE);
    assert!(exact(&tracer, &lit, &cache).radiance == full(&tracer, &lit).radiance);
}

/// Under a uniform sky the light on a convex body is the same everywhere, and free of noise.
#[test]
fn uniform_light_is_shown_as_uniform() {
    let even = Vec3::new(0.731, 0.4127, 0.219);
    let mut b = SceneBuilder::new("furnace");
    let matte = b.add_material(Material::diffuse("matte", Vec3::splat(0.6)));
    cuboid(&mut b, DVec3::ZERO, dvec(2.0, 1.0, 1.5), matte, false);
    b.sky = Some(Sky::even(even));
    let tracer = Arc::new(Tracer::new(Arc::new(b.finish().unwrap())));
    let mut walk = walkthrough(&tracer);
    let (mut seen, mut reused) = (0, 0);
    for i in 0..10 {
        let angle = 0.15 * f64::from(i);
        let eye = dvec(1.0 + 2.5 * angle.sin(), 1.2 + angle, 0.7 + (2.5 - angle) * angle.cos());
        let frame = walk.render(&Camera::look_at(eye, dvec(1.0, 0.5, 0.7), 45.0), [160, 104], NEVER);
        for ((shown, &triangle), t) in frame.radiance.iter().zip(&frame.triangle).zip(&frame.types) {
            let expected = if triangle == u32::MAX { even } else { even * 0.6 };
            // The error of packing, and the rounding of a few sums.
            let allowed = expected.max_element() * (1.0 / 512.0 + 1e-5);
            assert!((*shown - expected).abs().max_element() <= allowed, "{shown} for {expected}");
            seen += usize::from(triangle != u32::MAX);
            reused += usize::from(triangle != u32::MAX && *t == PixelType::Reused);
        }
        add_wanted(&mut walk);
    }
    assert!(seen > 10_000 && reused * 2 > seen, "{reused} of {seen} reused");
}

#[test]
fn a_disabled_reference_is_used_no_more_than_a_removed_one() {
    let tracer = room_tracer(false, false);
    let poses = [room_camera(), Camera { yaw: room_camera().yaw + 0.4, ..room_camera() }];
    let mut cache = cache_with(&tracer, &poses, &TRACE);
    let (both, first) = (exact(&tracer, &poses[1], &cache), cache.entries()[0].id);
    assert!(cache.set_enabled(first, false));
    let without = exact(&tracer, &poses[1], &cache);
    let mut gone = cache_with(&tracer, &poses, &TRACE);
    let id = gone.entries()[0].id;
    gone.remove(id);
    let removed = exact(&tracer, &poses[1], &gone);
    assert_eq!((&without.radiance, &without.types), (&removed.radiance, &removed.types));
    assert_ne!(without.radiance, both.radiance);
    let view = View::new(&poses[0], &tracer.scene().frame, SIZE);
    let selected = ReferenceSelector::default().select(&mut cache, &view, tracer.epoch(), 8);
    assert_eq!(selected.len(), 1, "nor is it warped");
    assert!(cache.set_enabled(first, true));
    assert_eq!(exact(&tracer, &poses[1], &cache).radiance, both.radiance);
    cache.remove(first);
    assert!(!cache.set_enabled(first, true));
}

/// Without references, all points that the mirror and the glass show are shaded, once.
#[test]
fn what_mirrors_and_glass_show_is_shaded_once() {
    let tracer = room_tracer(true, true);
    let none = ReferenceCache::new(tracer.scene(), 1 << 30);
    let mut renderer = Renderer::default();
    let mut render = || {
        renderer
            .render(&FrameRequest::new(&tracer, &room_camera(), SIZE, &settings(Mode::Exact)).reusing(&none))
            .clone()
    };
    let [first, second, third] = [render(), render(), render()];
    // First surfaces are shaded in every frame here, because no frame becomes a reference.
    let saved = first.stats.rays.shadow - second.stats.rays.shadow;
    assert!(saved > 0, "{:?} {:?}", first.stats.rays, second.stats.rays);
    assert!(third.stats.rays.shadow <= second.stats.rays.shadow, "cached points stay");
    assert_eq!(first.stats.rays.secondary, second.stats.rays.secondary, "reflected and refracted alike");
    let mean = |frame: &afterimage::Frame| frame.radiance.iter().map(|r| r.element_sum()).sum::<f32>();
    let off = (mean(&second) / mean(&first) - 1.0).abs();
    assert!(off < 0.01, "the light is that of the first frame: {off}");
}

/// A post on a floor in front of a mirror, under a point light: its shadow has sharp edges and no
/// noise.
fn post_and_mirror() -> Arc<Tracer> {
    let mut b = SceneBuilder::new("post");
    let matte = b.add_material(Material::diffuse("matte", Vec3::splat(0.6)));
    let mirror = b.add_material(Material::mirror("mirror", Vec3::splat(0.9)));
    quad(&mut b, dvec(-6.0, 0.0, 6.0), dvec(12.0, 0.0, 0.0), dvec(0.0, 0.0, -9.0), matte);
    quad(&mut b, dvec(-6.0, 0.0, -3.0), dvec(12.0, 0.0, 0.0), dvec(0.0, 4.0, 0.0), mirror);
    cuboid(&mut b, dvec(-0.1, 0.0, -0.1), dvec(0.1, 1.2, 0.1), matte, false);
    b.point_lights.push((dvec(2.1, 2.7, 1.3), Vec3::splat(9.0)));
    Arc::new(Tracer::new(Arc::new(b.finish().unwrap())))
}

/// A point traced for another pixel may be on the other side of the edge, so at an edge only light
/// of the same point is reused.
#[test]
fn the_edge_of_a_shadow_stays_in_place_seen_directly_and_in_a_mirror() {
    let tracer = post_and_mirror();
    let trace = TraceSettings { samples: 16, ..TRACE };
    let mut walk = walkthrough(&tracer);
    let render = RenderSettings { mode: Mode::Exact, trace };
    walk.set_settings(WalkthroughSettings { render, ..*walk.settings() });
    let mut off = 0;
    for i in 0..12 {
        // A third of a pixel a frame.
        let eye = dvec(0.3 + 0.03 * f64::from(i), 1.7, 4.2);
        let camera = Camera::look_at(eye, dvec(-0.6, 0.3, -1.0), 50.0);
        let frame = walk.render(&camera, SIZE, NEVER).clone();
        add_wanted(&mut walk);
        let settings = RenderSettings { mode: Mode::Full, trace };
        let mut renderer = Renderer::default();
        let truth = renderer.render(&FrameRequest::new(&tracer, &camera, SIZE, &settings));
        for pixel in (0..frame.radiance.len()).filter(|_| i >= 3) {
            let (shown, right) = (frame.radiance[pixel], truth.radiance[pixel]);
            off += u32::from((shown - right).abs().max_element() > 0.2 * shown.max(right).max_element());
        }
    }
    // With light reused within a whole footprint there were 7, and unchecked in the mirror 46.
    assert_eq!(off, 0, "pixels in nine frames");
}
