//! Pictures decoded two at a time, all together within a budget of bytes.

use crate::import::picture;
use crate::import::picture::Picture;
use crate::import::{Limits, Phase, Steps};
use crate::scene::SceneError;
use rayon::prelude::*;
use std::borrow::Cow;
use std::path::Path;

/// A picture file's bytes, and its name for formats without a signature.
pub(crate) type File<'a> = (Cow<'a, [u8]>, &'a Path);

/// Takes the number of pictures and how to get each one's file; returns each as texels, or why there are none.
pub(crate) fn decode_all<'a>(
    count: usize,
    limits: &Limits,
    steps: &Steps,
    read: impl Fn(usize) -> Result<File<'a>, String>,
) -> Result<Vec<Result<Picture, String>>, SceneError> {
    /// Decoders need several times a picture's size; more at once would make memory depend on the core count.
    const AT_ONCE: usize = 2;
    let mut budget = limits.textures_bytes;
    let mut pictures = Vec::new();
    for first in (0..count).step_by(AT_ONCE) {
        steps.at(Phase::Textures, first as f32 / count as f32)?;
        let pair = first..count.min(first + AT_ONCE);
        let files: Vec<_> = pair.map(|i| within(read(i)?, limits, &mut budget)).collect();
        let decode = |file: Result<File, String>| {
            let (bytes, path) = file?;
            picture::decode(&bytes, path, limits)
        };
        pictures.par_extend(files.into_par_iter().map(decode));
    }
    Ok(pictures)
}

/// The file, where its texels still fit the budget of all textures together.
fn within<'a>((bytes, path): File<'a>, limits: &Limits, budget: &mut u64) -> Result<File<'a>, String> {
    let [width, height] = picture::dimensions(&bytes, path, limits)?;
    let texels = u64::from(width) * u64::from(height) * 4;
    *budget = budget
        .checked_sub(texels)
        .ok_or_else(|| format!("all textures together exceed {} MB", limits.textures_bytes >> 20))?;
    Ok((bytes, path))
}
