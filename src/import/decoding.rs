//! Decoding many pictures: two at a time, all together within a budget of bytes.

use super::options::Limits;
use super::picture::{self, Picture, PictureError};
use super::progress::{Phase, Steps};
use crate::scene::SceneError;
use rayon::prelude::*;
use std::{borrow::Cow, path::Path};

/// The bytes of a picture file, and its name for formats without a signature.
pub(super) type File<'a> = (Cow<'a, [u8]>, &'a Path);

/// Takes the number of pictures and a function that reads the file of each; returns each picture,
/// or why there is none.
pub(super) fn decode_all<'a>(
    count: usize,
    limits: &Limits,
    steps: &Steps,
    read: impl Fn(usize) -> Result<File<'a>, PictureError>,
) -> Result<Vec<Result<Picture, PictureError>>, SceneError> {
    /// Pictures decoded at a time. Decoders need several times a picture's size; with one per core,
    /// memory would depend on the number of cores.
    const AT_ONCE: usize = 2;
    let mut budget = limits.textures_bytes;
    let mut pictures = Vec::new();
    for first in (0..count).step_by(AT_ONCE) {
        steps.at(Phase::Textures, first as f32 / count as f32)?;
        let pair = first..count.min(first + AT_ONCE);
        let files: Vec<_> = pair.map(|i| within(read(i)?, limits, &mut budget)).collect();
        let decode = |file: Result<File, PictureError>| {
            let (bytes, path) = file?;
            picture::decode(&bytes, path, limits)
        };
        pictures.par_extend(files.into_par_iter().map(decode));
    }
    Ok(pictures)
}

/// Returns the file where its texels still fit the budget of all textures together.
fn within<'a>((bytes, path): File<'a>, limits: &Limits, budget: &mut u64) -> Result<File<'a>, PictureError> {
    let [width, height] = picture::dimensions(&bytes, path, limits)?;
    let texels = u64::from(width) * u64::from(height) * 4;
    *budget = budget
        .checked_sub(texels)
        .ok_or(PictureError::AllTooLarge { megabytes: limits.textures_bytes >> 20 })?;
    Ok((bytes, path))
}
