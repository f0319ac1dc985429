//! Walks through a scene and prints how much of each frame is reused. Needs none of the crate's
//! features.
//!
//! `cargo run --release -p afterimage --example walk_with_cache`

#![allow(clippy::print_stdout, reason = "an example reports on the terminal")]

use afterimage::scene::builtin;
use afterimage::trace::parallel::NEVER;
use afterimage::{Tracer, Walkthrough, WalkthroughSettings};
use std::sync::Arc;

const FRAMES: u32 = 20;
const SIZE: [u32; 2] = [240, 135];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Arc::new(builtin::build("cornell")?);
    let mut walk =
        Walkthrough::new(Arc::new(Tracer::new(Arc::clone(&scene))), WalkthroughSettings::default());

    for index in 0..FRAMES {
        // Every scene has a walk: its own, or one around it.
        let camera = scene.walk.camera(index, FRAMES).ok_or("the scene's walk has no key frames")?;
        let frame = walk.render(&camera, SIZE, NEVER);

        // Default mode `exact`: every pixel has a primary ray. Its light is looked up in references
        // (reused), or computed where no reference has it (unseen).
        let percent = frame.stats.types.percentages();
        println!(
            "frame {index:2}: {:5.1} % of the pixels newly lit, {:4.1} ms, {} references in {} kB",
            percent.unseen_percent,
            frame.stats.secs.frame * 1e3,
            walk.cache().entries().len(),
            walk.cache().bytes() / 1024
        );

        // The placement policy may want a reference from another pose. An interactive program
        // traces it on another thread and inserts it when it is finished.
        if let Some(pose) = walk.wanted_reference() {
            let job = walk.reference_job(pose, SIZE);
            if let Some(reference) = job.trace(NEVER) {
                walk.insert(reference);
            }
        }
    }
    Ok(())
}
