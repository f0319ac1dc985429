//! `render -o FILE.jpg`: how a JPEG file is written.

use super::failure::Failure;
use crate::picture::restore::is_jpeg;
use afterimage::raster::jpeg::DEFAULT_QUALITY;
use afterimage::raster::save::{Notes, SaveError, Target, save_png};
use afterimage::raster::stream::{Contents, PictureFile, Rows};
use clap::Args;
use std::path::Path;

#[derive(Args, Clone, Copy, Debug)]
pub(super) struct JpegArgs {
    /// Quality of a .jpg, 1 to 100 [default: 90].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(1..=100))]
    jpeg_quality: Option<u8>,
}

impl JpegArgs {
    /// True where a quality is given.
    pub(super) fn is_given(self) -> bool {
        self.jpeg_quality.is_some()
    }

    /// Returns the quality, 1 to 100.
    pub(super) fn quality(self) -> u8 {
        self.jpeg_quality.unwrap_or(DEFAULT_QUALITY)
    }

    /// Checks the arguments against the name of the picture.
    pub(super) fn check(self, output: &Path, no_background: bool) -> Result<(), Failure> {
        let usage = |message: &str| Err(Failure::Usage(message.to_owned()));
        match is_jpeg(output) {
            false if self.jpeg_quality.is_some() => {
                usage("--jpeg-quality is for a picture whose name ends in .jpg or .jpeg")
            }
            true if no_background => {
                usage("a JPEG picture has no transparency; with --no-background, use .png or .exr")
            }
            _ => Ok(()),
        }
    }
}

/// Writes an 8-bit picture as the format that its name ends in: JPEG or PNG.
pub(super) fn save_display(
    path: &Path,
    size: [u32; 2],
    srgb: Vec<[u8; 3]>,
    notes: Notes<'_>,
) -> Result<(), SaveError> {
    if !is_jpeg(path) {
        return save_png(path, size, &srgb, notes);
    }
    let contents = Contents::Jpeg(DEFAULT_QUALITY);
    let mut file = PictureFile::begin(Target::File(path.to_owned()), contents, size, notes)?;
    file.write(Rows::Srgb(srgb))?;
    file.finish(true).map(drop)
}
