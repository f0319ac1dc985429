//! The file of a film, in one of the formats.

use afterimage::raster::animation::AnimationFile;
use afterimage::raster::film::{FilmFile, FilmSettings, FinishedFilm};
use afterimage::raster::save::{SaveError, Target};

/// Format of a film.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FilmFormat {
    /// AV1 in MP4.
    #[default]
    Mp4,
    /// An animated picture, for pages that show no films.
    Gif,
}

/// The file of a film, in one of the formats.
pub(super) enum FilmWriter {
    Mp4(FilmFile),
    /// And the number of its frames.
    Gif(AnimationFile, u32),
}

impl FilmWriter {
    pub(super) fn begin(format: FilmFormat, coding: FilmSettings, target: Target) -> Result<Self, SaveError> {
        Ok(match format {
            FilmFormat::Mp4 => Self::Mp4(FilmFile::begin(target, coding)?),
            FilmFormat::Gif => Self::Gif(AnimationFile::begin(target, coding.size, coding.rate)?, 0),
        })
    }

    pub(super) fn write(&mut self, picture: &[[u8; 3]]) -> Result<(), SaveError> {
        match self {
            Self::Mp4(file) => file.write(picture),
            Self::Gif(file, frames) => file.write(picture).map(|()| *frames += 1),
        }
    }

    /// Finishes the film; `None` without frames, and then no file is left.
    pub(super) fn finish(self) -> Result<Option<FinishedFilm>, SaveError> {
        match self {
            Self::Mp4(file) => file.finish(),
            Self::Gif(_, 0) => Ok(None),
            Self::Gif(file, frames) => {
                let (path, bytes) = file.finish()?;
                Ok(Some(FinishedFilm { path, frames, bytes, problem: None }))
            }
        }
    }
}
