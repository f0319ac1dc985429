//! Limits on the size and the memory of a picture, checked before anything is allocated: a failed
//! allocation cannot be caught.

use afterimage::{reference::ReferenceFrame, render::Renderer, warp::MAX_REFERENCE_PIXELS};

/// Maximum number of pixels of a picture: 16384 squared.
const MAX_PIXELS: u64 = 1 << 28;

/// Maximum width and height, in pixels, of a picture that the window saves.
pub const LONGEST_SIDE: u32 = 16384;

/// Maximum memory of a picture that is rendered in one piece, in bytes.
const MAX_BYTES: u64 = 8 << 30;

/// A picture is larger than the limits allow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TooLarge {
    /// The picture would have this number of pixels.
    Picture(u64),
    /// Rendering would need this number of bytes.
    Memory(u64),
    /// A reference image would have too many pixels.
    Reference,
}

impl std::error::Error for TooLarge {}

impl std::fmt::Display for TooLarge {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Picture(pixels) => {
                let side = MAX_PIXELS.isqrt();
                write!(
                    f,
                    "the picture would have {pixels} pixels; the maximum is {MAX_PIXELS} ({side}x{side})"
                )?;
            }
            Self::Memory(bytes) => {
                let [needed, limit] = [*bytes, MAX_BYTES].map(|bytes| bytes as f64 / f64::from(1 << 30));
                write!(f, "the picture would need {needed:.1} GB of memory; the maximum is {limit} GB")?;
            }
            Self::Reference => {
                write!(f, "a reference would have more than {MAX_REFERENCE_PIXELS} pixels")?;
            }
        }
        f.write_str("; make --size smaller")
    }
}

/// Checks a picture that is rendered in bands: only the size of its file is limited.
pub(crate) fn check_banded(pixels: u64) -> Result<(), TooLarge> {
    if pixels <= MAX_PIXELS { Ok(()) } else { Err(TooLarge::Picture(pixels)) }
}

/// Checks a picture that is rendered in one piece, with `references` reference images of its size.
pub(crate) fn check(pixels: u64, references: u64) -> Result<(), TooLarge> {
    // In addition to the renderer: the 8-bit picture, the picture of types, a copy for EXR
    // channels.
    const OUTPUT: u64 = 3 + 3 + 12;
    let tracing = if references > 0 { ReferenceFrame::TRACING_BYTES_PER_PIXEL as u64 } else { 0 };
    let held = references * ReferenceFrame::BYTES_PER_PIXEL as u64;
    let bytes = pixels.saturating_mul(Renderer::BYTES_PER_PIXEL as u64 + OUTPUT + tracing + held);
    if bytes > MAX_BYTES {
        return Err(TooLarge::Memory(bytes));
    }
    if references > 0 && pixels > MAX_REFERENCE_PIXELS as u64 { Err(TooLarge::Reference) } else { Ok(()) }
}
