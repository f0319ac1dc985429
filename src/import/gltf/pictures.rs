//! Images: found beside the file, in a buffer or in a `data:` address, and decoded like all others.

use crate::import::decoding::decode_all;
use crate::import::gltf::buffers::Buffers;
use crate::import::gltf::document::{Document, Found, List};
use crate::import::gltf::{schema, uri};
use crate::import::picture::Picture;
use crate::import::report::{Tally, Trouble};
use crate::import::search::Finder;
use crate::import::{Limits, Steps, files};
use crate::scene::SceneError;
use std::borrow::Cow;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Decoded images by their number in the file.
pub(crate) struct Pictures {
    pictures: HashMap<usize, Picture>,
}

/// Where an image's bytes are.
enum Source<'a, 't> {
    File(PathBuf),
    Bytes(&'a [u8]),
    Data(Cow<'t, str>),
}

impl Pictures {
    /// Takes the numbers of the images that are needed. One that cannot be had is noted and left out.
    pub(crate) fn read(
        images: &[usize],
        document: &Document,
        buffers: &Buffers,
        finder: &mut Finder,
        (limits, steps): (&Limits, &Steps),
        tally: &mut Tally,
    ) -> Result<Self, SceneError> {
        let mut sources = Vec::new();
        for &image in images {
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
                Ok(picture) => drop(pictures.insert(*image, picture)),
                Err(cause) => {
                    document.note(document.fault(List::Images, *image, Trouble::PICTURE, &cause), tally);
                }
            }
        }
        Ok(Self { pictures })
    }

    /// An image, where it could be read.
    pub(crate) fn get(&self, image: usize) -> Option<&Picture> {
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

fn bytes_of<'s>(source: &'s Source, limits: &Limits) -> Result<(Cow<'s, [u8]>, &'s Path), String> {
    let unnamed = Path::new("");
    match source {
        Source::File(path) => {
            let bytes = files::read_limited(path, limits.texture_bytes).map_err(|(cause, _)| cause)?;
            Ok((Cow::Owned(bytes), path))
        }
        Source::Bytes(bytes) => Ok((Cow::Borrowed(*bytes), unnamed)),
        Source::Data(uri) => {
            let bytes = uri::data(uri).flatten().ok_or("its data: address cannot be read")?;
            Ok((Cow::Owned(bytes), unnamed))
        }
    }
}
