//! What a job will need in memory, said before anything is reserved: a failed allocation cannot be caught.

use super::MAX_PIXELS;
use afterimage::reference::ReferenceFrame;
use afterimage::render::Renderer;
use afterimage::warp::splat::MAX_REFERENCE_PIXELS;

/// A picture may need this much, bytes.
const LIMIT: u64 = 8 << 30;

/// Refuses a picture that is made band by band where it is too large for a file to be of use.
pub(crate) fn check_banded(pixels: u64) -> Result<(), String> {
    if pixels <= MAX_PIXELS {
        return Ok(());
    }
    let side = MAX_PIXELS.isqrt();
    Err(format!(
        "a picture has at most {MAX_PIXELS} pixels ({side}x{side}), this would have {pixels}; make --size smaller"
    ))
}

/// Refuses a picture that is too large, with the number. `references` of the same size are held beside it.
pub(crate) fn check(pixels: u64, references: u64) -> Result<(), String> {
    // Beside the renderer's own: the 8-bit picture, the types picture, a copy for the file's channels.
    const OUTPUT: u64 = 3 + 3 + 12;
    let tracing = if references > 0 { ReferenceFrame::TRACING_BYTES_PER_PIXEL as u64 } else { 0 };
    let held = references * ReferenceFrame::BYTES_PER_PIXEL as u64;
    let bytes = pixels.saturating_mul(Renderer::BYTES_PER_PIXEL as u64 + OUTPUT + tracing + held);
    if bytes > LIMIT {
        return Err(format!(
            "this needs {:.1} GB of memory, at most {} GB are used for a picture; make --size smaller",
            bytes as f64 / f64::from(1 << 30),
            LIMIT >> 30
        ));
    }
    if references > 0 && pixels > MAX_REFERENCE_PIXELS as u64 {
        return Err(format!("a reference has at most {MAX_REFERENCE_PIXELS} pixels"));
    }
    Ok(())
}
