//! Images: found next to the file, in a buffer or in a `data:` address, and decoded.

use super::document::{Document, Found, List};
use super::{buffers::Buffers, schema, uri};
use crate::import::decoding::{self, decode_all};
use crate::import::picture::{Picture, PictureError};
use crate::import::{
    files, options::Limits, progress::Phase, progress::Steps, search::Finder, tally::Tally, trouble::Trouble,
};
use crate::scene::SceneError;
use std::path::{Path, PathBuf};
use std::{borrow::Cow, collections::HashMap};

/// Decoded images by their index in the file.
pub(super) struct Pictures {
    pictures: HashMap<usize, Picture>,
}

/// Source of the bytes of an image.
enum Source<'a, 't> {
    File(PathBuf),
    Bytes(&'a [u8]),
    Data(Cow<'t, str>),
}

impl Pictures {
    /// Reads the images of these indices. An image that cannot be read is counted as a trouble and
    /// left out.
    pub(super) fn read(
        images: &[usize],
        document: &Document,
        buffers: &Buffers,
        finder: &mut Finder,
        (limits, steps): (&Limits, &Steps),
        tally: &mut Tally,
    ) -> Result<Self, SceneError> {
        let mut sources = Vec::new();
        for (i, &image) in images.iter().enumerate() {
            steps.at(Phase::Textures, i as f32 / images.len() as f32)?;
            match source(document, buffers, finder, image) {
                Ok(source) => sources.push((image, source)),
                Err(fault) => document.note(fault, tally),
            }
        }
        let read = |i: usize| bytes_of(&sources[i].1, limits);
        let decoded = decode_all(sources.len(), limits, steps, read)?;
        let mut pictures = HashMap::new();
        for ((image, _), picture) in sources.iter().zip(decoded) {
            match picture {
                Ok(picture) => {
                    pictures.insert(*image, picture);
                }
                Err(cause) => {
                    document.note(
                        document.fault(List::Images, *image, Trouble::PICTURE, &cause.to_string()),
                        tally,
                    );
                }
            }
        }
        Ok(Self { pictures })
    }

    /// Returns an image where it could be read.
    pub(super) fn get(&self, image: usize) -> Option<&Picture> {
        self.pictures.get(&image)
    }
}

fn source<'a, 't>(
    document: &Document<'t>,
    buffers: &'a Buffers,
    finder: &mut Finder,
    index: usize,
) -> Found<Source<'a, 't>> {
    let image: schema::Image = document.item(List::Images, index)?;
    let fault = |trouble, detail: &str| document.fault(List::Images, index, trouble, detail);
    match (image.buffer_view, image.uri) {
        (Some(view), _) => Ok(Source::Bytes(buffers.view(document, view)?.0)),
        (None, None) => Err(fault(Trouble::NO_PICTURE, "")),
        (None, Some(uri)) if uri.starts_with("data:") => Ok(Source::Data(uri)),
        (None, Some(uri)) => {
            let name = uri::file_name(&uri);
            let folder = finder.jail.folder.clone();
            let found = finder.texture(&name, &folder);
            let trouble = if found.outside { Trouble::PICTURE_OUTSIDE } else { Trouble::PICTURE_MISSING };
            found.file.map(Source::File).ok_or_else(|| fault(trouble, &format!("'{name}'")))
        }
    }
}

fn bytes_of<'s>(source: &'s Source, limits: &Limits) -> Result<decoding::File<'s>, PictureError> {
    let unnamed = Path::new("");
    match source {
        Source::File(path) => {
            let bytes = files::read_limited(path, limits.texture_bytes)
                .map_err(|error| PictureError::Unreadable(error.cause))?;
            Ok((Cow::Owned(bytes), path))
        }
        Source::Bytes(bytes) => Ok((Cow::Borrowed(*bytes), unnamed)),
        Source::Data(uri) => {
            let bytes = uri::data(uri).flatten().ok_or(PictureError::DataAddress)?;
            Ok((Cow::Owned(bytes), unnamed))
        }
    }
}
