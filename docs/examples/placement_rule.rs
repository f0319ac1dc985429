//! A placement rule of one's own: a new reference after every half metre. Needs none of the crate's
//! features.
//!
//! `cargo run --release -p afterimage --example placement_rule`

#![allow(clippy::print_stdout, reason = "an example reports on the terminal")]

use afterimage::camera::Camera;
use afterimage::reference::placement::{PlacementPolicy, PlacementRule, Situation};
use afterimage::scene::builtin;
use afterimage::trace::parallel::NEVER;
use afterimage::{Tracer, Walkthrough, WalkthroughSettings};
use std::sync::Arc;

/// A rule is data: a name and three functions. It has no state, so that a walk can be repeated
/// exactly.
static EVERY_HALF_METRE: PlacementRule = PlacementRule {
    name: "every-half-metre",
    about: "after every half metre",
    has_threshold: false,
    // No reference is traced before the walk begins.
    prefetch_poses: |_tracer, _request| Vec::new(),
    decide,
    // Frames of the walk itself are never kept as references.
    keeps_frame: |_lit_percent, _threshold_percent| false,
};

/// Returns the pose of the next reference, or `None`: the viewer's own pose where it crossed a
/// multiple of 0.5 m in x or z since the last frame, or where there is no reference yet.
fn decide(now: &mut Situation<'_>) -> Option<Camera> {
    let cell = |camera: &Camera| [camera.eye.x, camera.eye.z].map(|metres| (metres / 0.5).floor() as i64);
    let is_new_cell = cell(&now.seen.camera) != cell(&now.seen.previous);
    (is_new_cell || now.seen.held == 0).then_some(now.seen.camera)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    const FRAMES: u32 = 40;
    const SIZE: [u32; 2] = [160, 90];
    let scene = Arc::new(builtin::build("cornell")?);
    let placement = PlacementPolicy::new(&EVERY_HALF_METRE, 5.0);
    let settings = WalkthroughSettings { placement, ..WalkthroughSettings::default() };
    let mut walk = Walkthrough::new(Arc::new(Tracer::new(Arc::clone(&scene))), settings);
    for index in 0..FRAMES {
        let camera = scene.walk.camera(index, FRAMES).ok_or("the scene's walk has no key frames")?;
        let unseen = walk.render(&camera, SIZE, NEVER).stats.types.percentages().unseen_percent;
        let Some(pose) = walk.wanted_reference() else { continue };
        if let Some(reference) = walk.reference_job(pose, SIZE).trace(NEVER) {
            println!("frame {index:2}: a reference at {:.2} m; {unseen:.1} % was unseen", pose.eye);
            walk.insert(reference);
        }
    }
    Ok(())
}
