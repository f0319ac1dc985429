//! Compares two pictures: one with few samples against one with many.
//!
//! `cargo run --release -p afterimage --example compare_pictures -- [A B]`, with two PNG or OpenEXR
//! files or none.

#![allow(clippy::print_stdout, reason = "an example reports on the terminal")]

use afterimage::raster::load::{Picture, PictureKind};
use afterimage::raster::metrics::{flip, psnr_db, rel_mse, ssim};
use afterimage::scene::builtin;
use afterimage::trace::parallel::NEVER;
use afterimage::{Mode, Tracer, Walkthrough, WalkthroughSettings};
use std::path::Path;
use std::sync::Arc;

/// The Cornell box by the ordinary ray tracer, as linear radiance.
fn traced(tracer: &Arc<Tracer>, samples: u32) -> Picture {
    let size = [200, 200];
    let mut settings = WalkthroughSettings::default();
    settings.render.mode = Mode::Full;
    settings.render.trace.samples = samples;
    let mut walk = Walkthrough::new(Arc::clone(tracer), settings);
    let values = walk.render(tracer.scene().start(), size, NEVER).radiance.clone();
    Picture { size, kind: PictureKind::SceneLinear, values }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let files: Vec<String> = std::env::args().skip(1).collect();
    let (picture, truth) = match &files[..] {
        [a, b] => (Picture::load(Path::new(a))?, Picture::load(Path::new(b))?),
        _ => {
            let tracer = Arc::new(Tracer::new(Arc::new(builtin::build("cornell")?)));
            (traced(&tracer, 2), traced(&tracer, 64))
        }
    };
    if picture.size != truth.size {
        return Err(format!("the sizes differ: {:?} and {:?}", picture.size, truth.size).into());
    }

    // PSNR, SSIM and FLIP compare what a screen shows (sRGB, clipped at 1), relMSE compares linear
    // light.
    let (shown, shown_truth) = (picture.display(0.0), truth.display(0.0));
    println!("PSNR   {:.2} dB (999 for equal pictures)", psnr_db(&shown, &shown_truth));
    println!("SSIM   {:.4} (1 for equal pictures)", ssim(&shown, &shown_truth, truth.size));
    println!("FLIP   {:.4} (0 for equal pictures)", flip(&shown, &shown_truth, truth.size)?.mean);
    println!("relMSE {:.6}", rel_mse(&picture.linear(), &truth.linear()));
    Ok(())
}
