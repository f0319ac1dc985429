use super::*;
use crate::lookup::policy::BAD_GUESS;
use crate::reference::ReferenceCache;
use crate::scene::builtin;
use std::sync::Arc;

/// Whether traced light is shown for three guesses, each off by a multiple of the noise, after
/// the point was first traced for a guess that was off by `first_off`.
fn is_traced(first_off: f32, off: [f32; 3]) -> [bool; 3] {
    let scene = Arc::new(builtin::build("furnace").unwrap());
    let tracer = Tracer::new(scene.clone());
    let view = View::new(scene.start(), &scene.frame, [9, 9]);
    let (pixel, trace) = (40, TraceSettings::default());
    let triangle = tracer.closest(&Tracer::primary_ray(&view, pixel)).expect("a hit").triangle;
    let cache = ReferenceCache::new(&scene, 0);
    let lookup = LookupSet::new(&cache, tracer.epoch());
    let (mut points, mut tally) = (PointCache::default(), Tally::default());
    let quality = LookupQuality::EXACT;
    let plain = |radiance| Guess { radiance, certain: Vec3::ZERO, between: None };
    let first =
        PixelResolver { tracer: &tracer, lookup: &lookup, view: &view, points: &points, trace, quality };
    let truth = first.check_guess(pixel, triangle, plain(Vec3::ZERO), &mut Tally::default()).radiance;
    let guess = |off: f32| truth * (1.0 - off * BAD_GUESS * trace.noise());
    assert_eq!(
        first.check_guess(pixel, triangle, plain(guess(first_off)), &mut tally).is_traced,
        first_off > 1.0,
        "at first there is one threshold"
    );
    points.insert(tracer.epoch(), &mut tally.points);
    let resolver =
        PixelResolver { tracer: &tracer, lookup: &lookup, view: &view, points: &points, trace, quality };
    off.map(|off| resolver.check_guess(pixel, triangle, plain(guess(off)), &mut tally).is_traced)
}

#[test]
fn a_point_keeps_showing_what_it_showed_until_the_guess_is_clearly_better_or_worse() {
    assert_eq!(is_traced(0.5, [0.9, 1.2, 1.7]), [false, false, true]);
    assert_eq!(is_traced(2.0, [1.1, 0.8, 0.5]), [true, true, false]);
}
