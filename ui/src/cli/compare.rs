//! `afterimage compare`: error metrics of one picture against another.

use super::{failure::Failure, flags::Flags, output};
use afterimage::raster::color::metered_exposure_ev;
use afterimage::raster::exposure::{Exposure, decimal};
use afterimage::raster::load::{Picture, PictureKind};
use afterimage::raster::metrics::{CompareError, flip, max_abs, psnr_db, rel_mse, ssim};
use clap::Args;
use serde_json::json;
use std::path::{Path, PathBuf};

#[derive(Args, Debug)]
pub(crate) struct CompareArgs {
    /// Picture to measure: PNG or EXR.
    a: PathBuf,
    /// Ground-truth picture: PNG or EXR. Linear pictures are shown at --exposure [default: 0];
    /// `auto` is chosen for this one.
    b: PathBuf,
    /// Exit with code 1 if the PSNR is below this, dB.
    #[arg(long, value_name = "X")]
    fail_under_db: Option<f64>,
}

pub(crate) fn run(args: &CompareArgs, flags: &Flags) -> Result<(), Failure> {
    let (a, b) = (load(&args.a)?, load(&args.b)?);
    let failed = |e: CompareError| Failure::Failed(e.to_string());
    if a.size != b.size {
        return Err(failed(CompareError::Sizes { a: a.size, b: b.size }));
    }
    let size = a.size;
    // A display-referred picture has its exposure already.
    let exposure_ev = match flags.exposure {
        Some(Exposure::Auto) => metered_exposure_ev(&b.linear()).unwrap_or_default(),
        _ => flags.exposure_ev(),
    };
    let (shown_a, shown_b) = (a.display(exposure_ev), b.display(exposure_ev));
    // relMSE and the largest difference are measured in linear light unless both pictures are
    // display-referred.
    let both_display = a.kind == PictureKind::Display && b.kind == PictureKind::Display;
    let (value_a, value_b) = if both_display { (a.values, b.values) } else { (a.linear(), b.linear()) };
    let psnr = psnr_db(&shown_a, &shown_b);
    let flip = flip(&shown_a, &shown_b, size).map_err(failed)?;
    let (rel_mse, ssim, max_abs) =
        (rel_mse(&value_a, &value_b), ssim(&shown_a, &shown_b, size), max_abs(&value_a, &value_b));
    let object = json!({
        "psnr_db": psnr, "rel_mse": rel_mse, "ssim": ssim,
        "flip_mean": flip.mean, "flip_p95": flip.p95, "max_abs": max_abs, "exposure_ev": decimal(exposure_ev),
    });
    output::result(flags.json, &object, || {
        output::table(&[
            ("PSNR", format!("{psnr:.3} dB")),
            ("relMSE", format!("{rel_mse:.6}")),
            ("SSIM", format!("{ssim:.6}")),
            ("FLIP", format!("{:.6} mean, {:.6} p95", flip.mean, flip.p95)),
            ("largest", format!("{max_abs:.6}")),
        ])
    });
    match args.fail_under_db {
        Some(least) if psnr.is_nan() || psnr < least => {
            Err(Failure::Failed(format!("the PSNR of {psnr:.3} dB is below {least} dB")))
        }
        _ => Ok(()),
    }
}

/// Loads a picture and checks that all values are finite: others have no difference to compare.
fn load(path: &Path) -> Result<Picture, Failure> {
    let picture = Picture::load(path).map_err(|e| Failure::Failed(e.to_string()))?;
    let wrong = || picture.values.iter().enumerate().filter(|(_, v)| !v.is_finite()).map(|(i, _)| i);
    let Some(first) = wrong().next() else { return Ok(picture) };
    let (x, y) = (first % picture.size[0] as usize, first / picture.size[0] as usize);
    Err(Failure::Failed(format!(
        "{}: {} pixels are infinite or not a number, the first in column {x} of row {y}; remove them before comparing",
        path.display(),
        wrong().count()
    )))
}
