//! References after an edit of the scene: what still holds is kept, what does not is marked.

mod edits;

use super::content::written_again;
use super::rooms::{RoomOptions, cuboid, dvec, room, room_camera, room_tracer};
use afterimage::reference::{ReferenceCache, ReferenceFrame, stale::MAX_CHANGE};
use afterimage::scene::{MaterialId, ObjectEdit, ObjectKey, SceneEdit, builtin};
use afterimage::trace::{TraceSettings, parallel::NEVER};
use afterimage::{Camera, Tracer, Walkthrough, WalkthroughSettings};
use glam::{DVec3, Vec3};
use std::sync::Arc;

const SMALL: [u32; 2] = [32, 24];
const SIZE: [u32; 2] = [96, 64];

fn edited(tracer: &Tracer, change: impl FnOnce(&mut SceneEdit)) -> Arc<Tracer> {
    let mut edit = tracer.scene().to_edit();
    change(&mut edit);
    Arc::new(tracer.with_same_geometry(Arc::new(tracer.scene().with_edit(&edit))))
}

fn traced(tracer: &Tracer, camera: &Camera, trace: &TraceSettings) -> ReferenceFrame {
    ReferenceFrame::trace(tracer, camera, SMALL, trace, NEVER).unwrap()
}

fn cache_of(tracer: &Tracer, frame: &ReferenceFrame) -> ReferenceCache {
    let mut cache = ReferenceCache::new(tracer.scene(), 1 << 30);
    cache.insert(Arc::new(frame.clone()));
    cache
}

/// Pixels whose light moved by more than the limit, those that are marked, and those that moved and
/// are not marked.
fn compare(before: &ReferenceFrame, after: &ReferenceFrame, now: &ReferenceFrame) -> [usize; 3] {
    let [mut moved, mut marked, mut missed] = [0; 3];
    for pixel in (0..SMALL[0] * SMALL[1]).filter(|&pixel| before.has_light(pixel)) {
        let (a, b) = (before.light(pixel), after.light(pixel));
        let has_moved = (b - a).abs().max_element() > MAX_CHANGE * a.max_element();
        moved += usize::from(has_moved);
        marked += usize::from(!now.has_light(pixel));
        missed += usize::from(has_moved && now.has_light(pixel));
    }
    [moved, marked, missed]
}

/// A change of a scene.
type Change<'a> = &'a dyn Fn(&mut SceneEdit);

#[test]
fn light_that_moved_is_marked_and_little_else() {
    let tracer = Tracer::new(Arc::new(builtin::build("cornell").unwrap()));
    let camera = *tracer.scene().start();
    let trace = TraceSettings { samples: 64, bounces: TraceSettings::ALL_BOUNCES, seed: 3 };
    let before = traced(&tracer, &camera, &trace);
    let named = |name: &str| tracer.scene().materials.iter().position(|m| m.name == name).unwrap();
    let (green, lamp) = (named("green"), named("lamp"));
    let edits: [(&str, Change<'_>); 3] = [
        ("a wall is darker", &|edit| edit.materials[green].diffuse *= 0.5),
        ("a wall has another colour", &|edit| edit.materials[green].diffuse = Vec3::new(0.5, 0.2, 0.6)),
        ("a lamp is dimmed", &|edit| edit.materials[lamp].emission *= 0.8),
    ];
    let mut sums = [0; 3];
    for (name, change) in edits {
        let new = edited(&tracer, change);
        let after = traced(&new, &camera, &trace);
        let mut cache = cache_of(&tracer, &before);
        cache.carry_to(&new, NEVER);
        let found = compare(&before, &after, &cache.entries()[0].frame);
        eprintln!("{name}: moved, marked, missed {found:?}");
        sums = [0, 1, 2].map(|k| sums[k] + found[k]);
    }
    let [moved, marked, missed] = sums;
    assert!(moved > 1000 && marked <= 3 * moved && missed * 100 <= moved, "{sums:?}");
}

/// Thirty edits of all kinds, and as many as the environment variable `AFTERIMAGE_EDITS` says.
#[test]
fn of_random_edits_of_all_kinds_nearly_all_light_that_moved_is_marked_and_not_much_else() {
    let wanted = std::env::var("AFTERIMAGE_EDITS").ok().and_then(|count| count.parse().ok());
    let sums = edits::run(0..wanted.unwrap_or(30), &mut |seed, kind, found, _| {
        eprintln!("edit {seed}, {kind}: {found:?}");
    });
    let mut all = edits::Found::default();
    for (kind, found) in sums {
        eprintln!("{kind}: {found:?}");
        // A pane changes little: the shadows that it dims are looked for on the safe side. A few
        // hundred pixels of one kind are a small sample.
        let most = if found.moved < 500 { 4 } else { 3 };
        assert!(found.marked <= most * found.moved, "{kind}: {found:?}");
        all += found;
    }
    assert!(all.moved > 1000 && all.marked <= 3 * all.moved && all.missed * 50 <= all.moved, "{all:?}");
}

#[test]
fn an_edit_without_effect_keeps_every_bit_and_an_undone_one_brings_them_back() {
    let tracer = room_tracer(true, true);
    let trace = TraceSettings { samples: 4, bounces: 4, seed: 3 };
    let before = traced(&tracer, &room_camera(), &trace);
    let words = |frame: &ReferenceFrame| -> Vec<Option<Vec3>> {
        let pixels = 0..SMALL[0] * SMALL[1];
        pixels.map(|pixel| frame.has_light(pixel).then(|| frame.light(pixel))).collect()
    };
    let mut cache = cache_of(&tracer, &before);
    let renamed = edited(&tracer, |edit| edit.materials[0].name.push('!'));
    assert_eq!(cache.carry_to(&renamed, NEVER).stale, 0);
    assert!(words(&cache.entries()[0].frame) == words(&before));
    let dark = edited(&tracer, |edit| edit.materials.iter_mut().for_each(|m| m.diffuse *= 0.1));
    let carried = cache.carry_to(&dark, NEVER);
    let frame = &cache.entries()[0].frame;
    assert!(carried.stale * 2 > carried.pixels && frame.stale() == carried.stale, "{carried:?}");
    assert_eq!(frame.lit() + frame.stale(), before.lit());
    let back = Arc::new(dark.with_same_geometry(tracer.scene().clone()));
    assert_eq!(cache.carry_to(&back, NEVER).stale, 0);
    assert!(words(&cache.entries()[0].frame) == words(&before));
    assert_eq!(cache.entries()[0].frame.epoch, back.epoch());
}

#[test]
fn a_colour_keeps_direct_light_and_walls_of_glass_keep_little() {
    let tracer = room_tracer(false, false);
    let trace = TraceSettings { samples: 4, bounces: 4, seed: 3 };
    let before = traced(&tracer, &room_camera(), &trace);
    let mut cache = cache_of(&tracer, &before);
    let dark = edited(&tracer, |edit| edit.materials.iter_mut().for_each(|m| m.diffuse *= 0.5));
    let carried = cache.carry_to(&dark, NEVER);
    assert!(carried.stale > 0 && carried.direct_holds == carried.stale, "{carried:?}");
    let mirror = afterimage::scene::Material::mirror("mirror", Vec3::splat(0.2)).kind;
    let mirrors = edited(&dark, |edit| edit.materials[0].kind = mirror);
    let carried = cache.carry_to(&mirrors, NEVER);
    assert_eq!((carried.stale, carried.direct_holds), (carried.pixels, carried.pixels));
    let glass = afterimage::scene::Material::glass("glass", 1.5, Vec3::ONE).kind;
    let panes = edited(&dark, |edit| edit.materials[0].kind = glass);
    let carried = cache.carry_to(&panes, NEVER);
    assert!(carried.dropped == 0 && carried.stale * 10 > carried.pixels * 9, "{carried:?}");
}

#[test]
fn a_walk_goes_on_with_the_light_that_holds() {
    let tracer = Arc::new(room_tracer(false, false));
    let mut settings = WalkthroughSettings::default();
    settings.render.trace = TraceSettings { samples: 4, bounces: 4, seed: 3 };
    let mut walk = Walkthrough::new(tracer.clone(), settings);
    walk.render(&room_camera(), SIZE, NEVER);
    assert!(walk.has_kept_frame());
    let shadow = |walk: &mut Walkthrough| walk.render(&room_camera(), SIZE, NEVER).stats.rays.shadow;
    let dark = edited(&tracer, |edit| edit.materials.iter_mut().for_each(|m| m.diffuse *= 0.5));
    let flushed = shadow(&mut Walkthrough::new(dark.clone(), settings));
    let mut carried = Walkthrough::new(dark.clone(), settings);
    let kept = carried.take_references(walk, NEVER);
    assert!(kept.stale > 0 && kept.dropped == 0, "{kept:?}");
    let held = shadow(&mut carried);
    assert!(held * 10 < flushed * 9, "{held} shadow rays, {flushed} without references");
    // A stop leaves them for later.
    let light = edited(&tracer, |edit| edit.materials.iter_mut().for_each(|m| m.diffuse *= 0.7));
    let mut stopped = Walkthrough::new(light.clone(), settings);
    stopped.take_references(carried, &|| true);
    assert!(stopped.cache().entries().iter().all(|entry| entry.frame.epoch != light.epoch()));
    let same = Arc::new(light.with_same_geometry(dark.scene().clone()));
    let mut again = Walkthrough::new(same.clone(), settings);
    assert!(again.take_references(stopped, NEVER).pixels > 0);
    assert!(again.cache().entries().iter().all(|entry| entry.frame.epoch == same.epoch()));
    // The same model is recognised, another one has nothing to give.
    let mut same = Walkthrough::new(Arc::new(room_tracer(false, false)), settings);
    assert!(same.take_references(again, NEVER).pixels > 0);
    let again = same;
    let cornell = Tracer::new(Arc::new(builtin::build("cornell").unwrap()));
    let mut other = Walkthrough::new(Arc::new(cornell), settings);
    assert_eq!(other.take_references(again, NEVER).pixels, 0);
    assert!(other.cache().entries().is_empty());
}

#[test]
fn a_model_loaded_again_in_another_order_keeps_all_light() {
    let tracer = Arc::new(Tracer::new(Arc::new(builtin::build("cornell").unwrap())));
    let camera = *tracer.scene().start();
    let mut settings = WalkthroughSettings::default();
    settings.render.trace = TraceSettings { samples: 4, bounces: 4, seed: 3 };
    let mut walk = Walkthrough::new(tracer.clone(), settings);
    let unseen = walk.render(&camera, SIZE, NEVER).stats.types.unseen;
    let lit = walk.cache().entries()[0].frame.lit();
    let again = Arc::new(Tracer::new(Arc::new(written_again(tracer.scene(), |_| {}))));
    assert_ne!(again.scene().triangles, tracer.scene().triangles);
    let mut next = Walkthrough::new(again.clone(), settings);
    let carried = next.take_references(walk, NEVER);
    assert_eq!((carried.pixels, carried.stale, carried.dropped), (lit, 0, 0), "{carried:?}");
    assert!(next.render(&camera, SIZE, NEVER).stats.types.unseen * 50 < unseen);
    // A darker wall is found though all numbers differ.
    let dark = edited(&again, |edit| edit.materials.iter_mut().for_each(|m| m.diffuse *= 0.5));
    let mut later = Walkthrough::new(dark, settings);
    let carried = later.take_references(next, NEVER);
    assert!(carried.stale * 2 > carried.pixels && carried.dropped == 0, "{carried:?}");
    // Most of another model is gone.
    let more = written_again(tracer.scene(), |builder| {
        let few = builder.triangles.len() / 3;
        builder.triangles.truncate(few);
        builder.triangle_materials.truncate(few);
    });
    let mut other = Walkthrough::new(Arc::new(Tracer::new(Arc::new(more))), settings);
    assert!(other.take_references(later, NEVER).dropped > 0 && other.cache().entries().is_empty());
}

#[test]
fn a_box_that_moves_leaves_the_direct_light_that_it_cannot_hide() {
    let empty = room(&RoomOptions { mirror: false, glass: false });
    // The materials are written backwards.
    let wall = MaterialId(2);
    let with_box = |x: f64, z: f64| {
        let add = |b: &mut _| cuboid(b, dvec(x, 0.0, z), dvec(x + 0.4, 0.7, z + 0.4), wall, false);
        Arc::new(Tracer::new(Arc::new(written_again(&empty, add))))
    };
    let mut sums = [0; 4];
    for (bounces, [x, z]) in [(0, [1.9, 1.0]), (0, [-2.4, 0.3]), (0, [-1.5, 2.0]), (4, [1.9, 1.0])] {
        let tracers = [with_box(-2.6, 1.4), with_box(x, z)];
        assert_eq!(tracers[0].scene().frame, tracers[1].scene().frame);
        let trace = TraceSettings { samples: 64, bounces, seed: 3 };
        let [before, after] = [0, 1].map(|k| traced(&tracers[k], &room_camera(), &trace));
        let settings = WalkthroughSettings::default();
        let mut walk = Walkthrough::new(tracers[0].clone(), settings);
        walk.cache_mut().insert(Arc::new(before.clone()));
        let mut next = Walkthrough::new(tracers[1].clone(), settings);
        let carried = next.take_references(walk, NEVER);
        assert_eq!(carried.dropped, 0);
        let now = &next.cache().entries()[0].frame;
        if bounces > 0 {
            let fully = carried.pixels - carried.stale;
            assert!(fully > 0 && carried.direct_holds + fully > carried.pixels / 2, "{carried:?}");
            continue;
        }
        for pixel in (0..SMALL[0] * SMALL[1]).filter(|&pixel| before.has_light(pixel)) {
            let is_same = before.disparity()[pixel as usize] == after.disparity()[pixel as usize];
            let (a, b) = (before.light(pixel), after.light(pixel));
            let has_moved = !is_same || (b - a).abs().max_element() > MAX_CHANGE * a.max_element();
            let is_marked = !now.has_light(pixel);
            sums[0] += usize::from(has_moved);
            sums[1] += usize::from(is_marked);
            sums[2] += usize::from(has_moved && is_same);
            sums[3] += usize::from(has_moved && is_same && !is_marked);
        }
    }
    // The last but one: shadows that moved on surfaces that did not.
    let [moved, marked, shadows, missed] = sums;
    assert!(shadows > 0 && marked >= shadows && marked <= 3 * moved && missed == 0, "{sums:?}");
}

/// A walk in the Cornell box, and a tracer of it with the short box elsewhere.
fn walk_and_moved(bounces: u32) -> (Walkthrough, Arc<Tracer>) {
    let tracer = Arc::new(Tracer::new(Arc::new(builtin::build("cornell").unwrap())));
    let mut settings = WalkthroughSettings::default();
    settings.render.trace = TraceSettings { samples: 4, bounces, seed: 3 };
    let mut walk = Walkthrough::new(tracer.clone(), settings);
    walk.render(tracer.scene().start(), SIZE, NEVER);
    let edit = ObjectEdit { moved_m: DVec3::new(0.4, 0.0, 0.3), ..ObjectEdit::default() };
    let mut to = tracer.scene().to_edit();
    to.objects.insert(ObjectKey::first("short box"), edit);
    let moved = tracer.with_state(Arc::new(tracer.scene().with_edit(&to)));
    (walk, Arc::new(moved))
}

#[test]
fn a_move_that_is_undone_brings_all_light_back() {
    let (walk, moved) = walk_and_moved(4);
    let (settings, tracer) = (*walk.settings(), walk.tracer().clone());
    let before = walk.cache().entries()[0].frame.clone();
    let mut there = Walkthrough::new(moved.clone(), settings);
    let carried = there.take_references(walk, NEVER);
    assert!(carried.stale > 0 && carried.dropped == 0, "{carried:?}");
    there.render(tracer.scene().start(), SIZE, NEVER);
    let undone = tracer.with_state(Arc::new(moved.scene().with_edit(&tracer.scene().to_edit())));
    let mut back = Walkthrough::new(Arc::new(undone), settings);
    let carried = back.take_references(there, NEVER);
    assert_eq!(carried.dropped, 0);
    let after = &back.cache().entries()[0].frame;
    let pixels = 0..SIZE[0] * SIZE[1];
    assert_eq!((after.stale(), after.lit()), (0, before.lit()));
    assert!(pixels.filter(|&p| before.has_light(p)).all(|p| before.light(p) == after.light(p)));
    // A few pixels at edges are known to no reference, as before the move.
    assert!(back.render(tracer.scene().start(), SIZE, NEVER).stats.types.unseen < 20);
}

#[test]
fn after_a_colour_no_direct_light_is_traced_again() {
    let tracer = Arc::new(room_tracer(false, false));
    let mut settings = WalkthroughSettings::default();
    settings.render.trace = TraceSettings { samples: 4, bounces: 0, seed: 3 };
    let mut walk = Walkthrough::new(tracer.clone(), settings);
    let mut shadow = [0; 5].map(|_| walk.render(&room_camera(), SIZE, NEVER).stats.rays.shadow);
    assert!(shadow[1] > 0, "guesses are checked: {shadow:?}");
    shadow.rotate_left(4);
    let dark = edited(&tracer, |edit| edit.materials.iter_mut().for_each(|m| m.diffuse *= 0.5));
    let mut next = Walkthrough::new(dark, settings);
    let carried = next.take_references(walk, NEVER);
    assert_eq!((carried.stale, carried.dropped), (0, 0));
    let after = next.render(&room_camera(), SIZE, NEVER).stats.rays.shadow;
    assert!(after <= shadow[0], "{after} shadow rays, {} before", shadow[0]);
}
