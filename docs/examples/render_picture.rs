//! Renders one picture of an embedded scene and writes it as PNG.
//!
//! `cargo run --release -p afterimage --example render_picture -- [FILE.png]`

#![allow(clippy::print_stdout, reason = "an example reports on the terminal")]

use afterimage::raster::color::ToneMap;
use afterimage::raster::save::save_png;
use afterimage::render::aov::display_rows;
use afterimage::scene::builtin;
use afterimage::trace::parallel::NEVER;
use afterimage::{Tracer, Walkthrough, WalkthroughSettings};
use std::path::PathBuf;
use std::sync::Arc;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file =
        std::env::args_os().nth(1).map_or_else(|| std::env::temp_dir().join("cornell.png"), PathBuf::from);

    // A scene is plain data; the tracer adds the acceleration structure.
    let scene = builtin::build("cornell")?;
    let camera = *scene.start();
    let tracer = Arc::new(Tracer::new(Arc::new(scene)));

    // For each pixel, 16 shadow rays to each light and 16 paths of one diffuse bounce: the walls
    // light each other.
    let mut settings = WalkthroughSettings::default();
    settings.render.trace.samples = 16;
    settings.render.trace.bounces = 1;

    // The cache is still empty, so that every pixel is traced. `NEVER`: no other thread can stop
    // this frame.
    let size = [400, 400];
    let mut walk = Walkthrough::new(tracer, settings);
    let frame = walk.render(&camera, size, NEVER);

    // Radiance is linear and unbounded. Exposure (stops) and tone map make it 8-bit sRGB.
    let picture = display_rows(&frame.radiance, 0.0, ToneMap::Aces);
    save_png(&file, size, &picture, &[("Software", "Afterimage".to_owned())])?;
    println!("{}: {:.2} s, {} rays", file.display(), frame.stats.secs.frame, frame.stats.rays.total());
    Ok(())
}
