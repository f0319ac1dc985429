//! Animated pictures for pages that show no films: GIF, with a palette for each frame.

use super::atomic_file::{SaveError, Target};
use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, Frame, ImageError, RgbaImage};
use std::io::Write;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

/// How long the encoder searches for a palette, 1 (best) to 30.
const PALETTE_SPEED: i32 = 10;

/// Maximum size in bytes: the file is made in memory, so that it is written completely or not at
/// all.
const MAX_BYTES: usize = 256 << 20;

/// Bytes that the encoder writes and that are taken from it in the end.
#[derive(Clone, Debug, Default)]
struct SharedBytes(Arc<Mutex<Vec<u8>>>);

impl Write for SharedBytes {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if all.len() + bytes.len() > MAX_BYTES {
            let megabytes = MAX_BYTES >> 20;
            return Err(std::io::Error::other(format!(
                "an animated picture has at most {megabytes} MB; make it smaller, shorter or a film (.mp4)"
            )));
        }
        all.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

/// An animated picture that is being made.
pub struct AnimationFile {
    target: Target,
    bytes: SharedBytes,
    encoder: GifEncoder<SharedBytes>,
    size: [u32; 2],
    rate: u32,
}

impl std::fmt::Debug for AnimationFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("AnimationFile").field("target", &self.target).finish_non_exhaustive()
    }
}

impl AnimationFile {
    /// Starts a picture of a size in pixels with `rate` frames per second, which repeats forever. A
    /// frame lasts a multiple of 10 ms.
    ///
    /// # Errors
    /// [`SaveError`] if its folder cannot be written to.
    pub fn begin(target: Target, size: [u32; 2], rate: u32) -> Result<Self, SaveError> {
        target.probe()?;
        let bytes = SharedBytes::default();
        let mut encoder = GifEncoder::new_with_speed(bytes.clone(), PALETTE_SPEED);
        encoder.set_repeat(Repeat::Infinite).map_err(|error| failure(&target, error))?;
        Ok(Self { target, bytes, encoder, size, rate })
    }

    /// Adds a frame of 8-bit sRGB colours, row-major from the top.
    ///
    /// # Errors
    /// [`SaveError`] if it cannot be encoded, or makes the picture too large.
    pub fn write(&mut self, srgb: &[[u8; 3]]) -> Result<(), SaveError> {
        let pixels = srgb.iter().flat_map(|[r, g, b]| [*r, *g, *b, u8::MAX]).collect();
        let picture = RgbaImage::from_raw(self.size[0], self.size[1], pixels);
        let picture = picture.ok_or_else(|| SaveError::Encode {
            path: self.target.path(),
            cause: "the frame has another size".into(),
        })?;
        let delay = Delay::from_numer_denom_ms(1000, self.rate.max(1));
        let frame = Frame::from_parts(picture, 0, 0, delay);
        self.encoder.encode_frame(frame).map_err(|error| failure(&self.target, error))
    }

    /// Writes the file. Returns its path and its size in bytes.
    ///
    /// # Errors
    /// [`SaveError`]; then it was not written, and an existing one is unchanged.
    pub fn finish(self) -> Result<(PathBuf, u64), SaveError> {
        // The encoder ends the picture when it is dropped.
        drop(self.encoder);
        let bytes = std::mem::take(&mut *self.bytes.0.lock().unwrap_or_else(PoisonError::into_inner));
        Ok((self.target.write(&bytes)?, bytes.len() as u64))
    }
}

fn failure(target: &Target, error: ImageError) -> SaveError {
    let cause = match error {
        ImageError::IoError(cause) => cause.into(),
        other => other.into(),
    };
    SaveError::Encode { path: target.path(), cause }
}
