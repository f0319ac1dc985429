use super::*;
use crate::camera::Camera;
use crate::raster::rgb9e5::Rgb9e5Scale;
use crate::render::WalkthroughSettings;
use crate::scene::{LightSetting, LightSettings, SceneEdit, Sky, Sun, builtin};
use crate::trace::{TraceSettings, Tracer, parallel::NEVER};
use glam::Vec3;

const SIZE: [u32; 2] = [48, 36];

/// Largest error of a packed word, relative to the largest channel.
const PACKING: f32 = 1.0 / 512.0;

fn tracer(change: impl FnOnce(&mut SceneEdit)) -> Arc<Tracer> {
    let scene = builtin::build("cornell").unwrap();
    let mut edit = scene.to_edit();
    change(&mut edit);
    Arc::new(Tracer::new(Arc::new(scene.with_edit(&edit))))
}

/// A box with a lamp, open to a sky and a sun that shines into it.
fn day() -> Arc<Tracer> {
    tracer(|edit| {
        let direction = Vec3::new(0.3, 0.5, 0.8).normalize_or(Vec3::Y);
        edit.daylight.sun = Some(Sun { direction, ..Sun::clear_day() });
        edit.daylight.sky = Some(Sky::even(Vec3::new(0.5, 0.7, 1.0)));
    })
}

fn set(tracer: &Tracer, settings: &[(&str, LightSetting)]) -> Arc<Tracer> {
    let mut edit = tracer.scene().to_edit();
    edit.lights = LightSettings::default();
    settings.iter().for_each(|(name, setting)| edit.lights.set(name, *setting));
    Arc::new(tracer.with_same_geometry(Arc::new(tracer.scene().with_edit(&edit))))
}

fn factor(intensity: f32) -> LightSetting {
    LightSetting { intensity, ..LightSetting::FULL }
}

const OFF: LightSetting = LightSetting { is_on: false, ..LightSetting::FULL };

fn camera(tracer: &Tracer) -> Camera {
    *tracer.scene().start()
}

/// A walk with one reference, whose pixels are all traced where there are bounces.
fn walk(tracer: &Arc<Tracer>, bounces: u32) -> Walkthrough {
    let mut settings = WalkthroughSettings::default();
    settings.render.trace = TraceSettings { samples: 16, bounces, seed: 5 };
    let mut walk = Walkthrough::new(tracer.clone(), settings);
    let job = walk.reference_job(camera(tracer), SIZE);
    walk.insert(job.trace(NEVER).unwrap());
    walk
}

fn layered(tracer: &Arc<Tracer>, bounces: u32) -> Walkthrough {
    let mut walk = walk(tracer, bounces);
    let traced = walk.layer_job().unwrap().trace(NEVER).unwrap();
    assert!(!walk.insert_layers(traced) && walk.layer_job().is_none());
    walk
}

fn carried(before: Walkthrough, tracer: &Arc<Tracer>) -> Walkthrough {
    let mut walk = Walkthrough::new(tracer.clone(), *before.settings());
    let carried = walk.take_references(before, NEVER);
    assert_eq!((carried.stale, carried.dropped), (0, 0));
    walk
}

fn frame(walk: &Walkthrough) -> &ReferenceFrame {
    &walk.cache.entries()[0].frame
}

type Words = [(Vec<u32>, Rgb9e5Scale); 2];

fn words(walk: &Walkthrough) -> Words {
    let frame = frame(walk);
    [frame.packed_light(), frame.packed_smooth()].map(|(words, scale)| (words.to_vec(), scale))
}

/// Direct and smooth light of the lit pixels.
fn lights(walk: &Walkthrough) -> Vec<[Vec3; 2]> {
    let [direct, smooth] = words(walk);
    let lit = (0..).zip(&direct.0).filter(|(pixel, _)| frame(walk).has_light(*pixel));
    lit.map(|(pixel, word)| [direct.1.unpack(*word), smooth.1.unpack(smooth.0[pixel as usize])]).collect()
}

/// The share of pixels whose direct light differs by more than packing, and the difference of
/// smooth light on average. Where lights are traced by groups, fewer of them are culled.
fn differences(a: &Walkthrough, b: &Walkthrough) -> [f32; 2] {
    let (a, b) = (lights(a), lights(b));
    assert!(a.len() == b.len() && a.len() > 1000, "{} and {}", a.len(), b.len());
    let pairs = || a.iter().zip(&b);
    let largest = pairs().map(|(a, b)| a[0].max_element().max(b[0].max_element())).fold(0.0, f32::max);
    let differs = |(a, b): &(&[Vec3; 2], &[Vec3; 2])| {
        let most = 4.0 * PACKING * a[0].max_element().max(1e-4 * largest);
        (a[0] - b[0]).abs().max_element() > most
    };
    let sum: f32 = b.iter().map(|b| b[1].element_sum()).sum();
    let smooth: f32 = pairs().map(|(a, b)| (a[1] - b[1]).abs().element_sum()).sum();
    [pairs().filter(differs).count() as f32 / a.len() as f32, smooth / sum]
}

/// Settings that dim, raise, colour and switch off groups.
fn examples() -> Vec<Vec<(&'static str, LightSetting)>> {
    let red = LightSetting { color: Vec3::new(1.0, 0.3, 0.1), ..LightSetting::FULL };
    vec![
        vec![("lamp", factor(0.3))],
        vec![("lamp", factor(2.0)), ("Sky", factor(0.1))],
        vec![("lamp", red), ("Sun", factor(0.5))],
        vec![("Sun", OFF), ("Sky", OFF)],
        vec![("lamp", OFF)],
    ]
}

#[test]
fn the_sum_of_the_groups_is_the_light_that_was_traced() {
    let tracer = day();
    let names: Vec<&str> = tracer.scene().light_groups.list.iter().map(|group| group.name.as_str()).collect();
    assert_eq!(names, ["Sky", "Sun", "lamp"]);
    let before = walk(&tracer, 3);
    let mut after = layered(&tracer, 3);
    assert!(words(&before) == words(&after), "light that holds keeps its bits");
    // Light that was traced in another state is shown as the sum of the groups.
    let dimmed = layered(&set(&tracer, &[("lamp", factor(0.5))]), 3);
    after = carried(dimmed, &set(&tracer, &[]));
    let [direct, smooth] = differences(&before, &after);
    assert!(direct < 0.01 && smooth < 0.05, "{direct} {smooth}");
}

#[test]
fn light_of_other_settings_is_that_which_would_be_traced() {
    let tracer = day();
    let mut walk_now = layered(&tracer, 3);
    for settings in examples() {
        let dimmed = set(&tracer, &settings);
        walk_now = carried(walk_now, &dimmed);
        let [direct, smooth] = differences(&walk_now, &walk(&dimmed, 3));
        assert!(direct < 0.01 && smooth < 0.05, "{settings:?}: {direct} {smooth}");
        // The light by groups is known, so none is traced again.
        assert!(walk_now.layer_job().is_none());
    }
}

#[test]
fn a_group_that_is_switched_off_and_on_again_has_the_very_bits_of_before() {
    for bounces in [0, 3] {
        let tracer = day();
        let mut walk = layered(&tracer, bounces);
        let before = words(&walk);
        for settings in examples() {
            walk = carried(walk, &set(&tracer, &settings));
            assert!(words(&walk) != before, "{settings:?}");
            let shown = words(&walk);
            walk = carried(walk, &set(&tracer, &[]));
            assert!(words(&walk) == before, "{settings:?}");
            walk = carried(walk, &set(&tracer, &settings));
            assert!(words(&walk) == shown, "{settings:?}");
        }
    }
}

#[test]
fn light_that_was_traced_while_lights_were_dimmed_is_raised_again() {
    let tracer = day();
    let dimmed = set(&tracer, &[("lamp", factor(0.1)), ("Sun", OFF)]);
    let before = words(&walk(&dimmed, 3));
    let walk_dimmed = layered(&dimmed, 3);
    assert!(words(&walk_dimmed) == before);
    let full = set(&dimmed, &[]);
    let raised = carried(walk_dimmed, &full);
    let [direct, smooth] = differences(&raised, &walk(&full, 3));
    assert!(direct < 0.01 && smooth < 0.05, "{direct} {smooth}");
    assert!(words(&carried(raised, &dimmed)) == before);
}

#[test]
fn one_group_is_scaled_and_needs_no_layers() {
    let tracer = tracer(|_| ());
    let mut walk_now = walk(&tracer, 3);
    assert!(walk_now.layer_job().is_none());
    let (before, bytes) = (words(&walk_now), frame(&walk_now).bytes());
    let dimmed = set(&tracer, &[("lamp", factor(0.3))]);
    walk_now = carried(walk_now, &dimmed);
    let [direct, smooth] = differences(&walk_now, &walk(&dimmed, 3));
    assert!(direct < 0.01 && smooth < 0.01, "{direct} {smooth}");
    walk_now = carried(walk_now, &set(&tracer, &[("lamp", OFF)]));
    assert!(lights(&walk_now).iter().flatten().all(|light| *light == Vec3::ZERO));
    walk_now = carried(walk_now, &set(&tracer, &[]));
    assert!(words(&walk_now) == before && frame(&walk_now).bytes() == bytes);
}

#[test]
fn other_edits_meet_the_light_that_is_shown() {
    let tracer = day();
    let dimmed = set(&tracer, &[("lamp", factor(0.5))]);
    let walk = carried(layered(&tracer, 3), &dimmed);
    let shown = words(&walk);
    let mut edit = dimmed.scene().to_edit();
    edit.materials.iter_mut().for_each(|material| material.diffuse *= 0.5);
    let dark = Arc::new(dimmed.with_same_geometry(Arc::new(dimmed.scene().with_edit(&edit))));
    assert_eq!(dark.scene().light_settings, dimmed.scene().light_settings);
    let mut edited = Walkthrough::new(dark.clone(), *walk.settings());
    let found = edited.take_references(walk, NEVER);
    assert!(found.stale > 0 && found.direct_holds > 0, "{found:?}");
    let edited_words = words(&edited);
    let back = Arc::new(dark.with_same_geometry(dimmed.scene().clone()));
    let undone = carried(edited, &back);
    assert!(words(&undone) == shown && edited_words != shown);
    // Light by groups makes stale light hold.
    let mut again = Walkthrough::new(dark.clone(), *undone.settings());
    again.take_references(undone, NEVER);
    let traced = again.layer_job().unwrap().trace(NEVER).unwrap();
    assert!(again.insert_layers(traced));
    assert_eq!((frame(&again).stale(), again.layer_job().is_none()), (0, true));
    let [direct, smooth] = differences(&again, &self::walk(&dark, 3));
    assert!(direct < 0.01 && smooth < 0.05, "{direct} {smooth}");
}

#[test]
fn the_exposure_stays_and_lights_that_are_off_take_no_rays() {
    let tracer = day();
    tracer.measure_light(&|_| (), NEVER);
    let dimmed = set(&tracer, &[("lamp", factor(0.01)), ("Sun", OFF)]);
    assert!(dimmed.metered().is_some() && dimmed.metered() == tracer.metered());
    let dark = set(&tracer, &[("lamp", OFF), ("Sun", OFF), ("Sky", OFF)]);
    let job = Walkthrough::new(dark, *walk(&tracer, 0).settings()).reference_job(camera(&tracer), SIZE);
    assert_eq!(job.trace(NEVER).unwrap().rays.shadow, 0);
    assert_eq!(set(&dimmed, &[]).scene().hash, tracer.scene().hash);
}
