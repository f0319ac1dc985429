//! Films: AV1 in an MP4 file, written while frames are rendered. No other program is needed.
//!
//! The file has a temporary name until it is finished; dropping an unfinished one removes it.

mod encode;
mod mp4;
mod settings;
mod yuv;

pub use settings::{FilmQuality, FilmSettings, FilmSizeError, even};
pub use yuv::Yuv420;

use super::atomic_file::{SaveError, Target};
use encode::RunningGroup;
use mp4::Mp4;
use std::collections::VecDeque;
use std::path::PathBuf;
use tempfile::NamedTempFile;

/// Maximum memory in bytes of the frames that wait for the encoder; two groups of 1080p fit.
const MAX_WAITING_BYTES: u64 = 400 << 20;

/// Minimum number of frames that may wait for a group's encoder.
const MIN_QUEUE: u64 = 2;

/// A film that is being written.
#[derive(Debug)]
pub struct FilmFile {
    target: Target,
    file: NamedTempFile,
    film: Mp4,
    settings: FilmSettings,
    /// The groups that are encoded, in order. Frames go to the last one until it is full.
    running: VecDeque<RunningGroup>,
    is_broken: bool,
}

/// A finished film.
#[derive(Debug)]
pub struct FinishedFilm {
    /// Path of the file.
    pub path: PathBuf,
    /// Number of its frames.
    pub frames: u32,
    /// Size in bytes.
    pub bytes: u64,
    /// Why frames that were given to it are missing at its end.
    pub problem: Option<SaveError>,
}

impl FilmFile {
    /// Starts a film. Its settings must have passed [`FilmSettings::check`].
    ///
    /// # Errors
    /// [`SaveError`] if its folder cannot be written to.
    pub fn begin(target: Target, settings: FilmSettings) -> Result<Self, SaveError> {
        let file = target.begin()?;
        let failed = |cause| SaveError::Write { path: target.path(), cause };
        let film = file.as_file().try_clone().and_then(|file| Mp4::begin(file, settings)).map_err(failed)?;
        Ok(Self { target, file, film, settings, running: VecDeque::new(), is_broken: false })
    }

    /// Adds a frame of 8-bit sRGB colours, row-major from the top. Waits if the encoder is behind.
    ///
    /// # Errors
    /// [`SaveError`] if frames cannot be encoded or written. The film then takes no more frames;
    /// [`Self::finish`] keeps what was complete.
    pub fn write(&mut self, srgb: &[[u8; 3]]) -> Result<(), SaveError> {
        let is_full = |group: &RunningGroup| group.count >= self.settings.key_interval();
        if self.running.back().is_none_or(is_full) {
            self.begin_group()?;
        }
        let frame = Yuv420::of_srgb(self.settings.size, srgb);
        let is_written = self.running.back_mut().is_some_and(|group| group.write(frame));
        if is_written { Ok(()) } else { self.drain(0) }
    }

    /// Finishes the film with the frames that were written, or with the first of them after a
    /// failure. `None` where there are none; then no file is left.
    ///
    /// # Errors
    /// [`SaveError`]; then the film was not written, and an existing one is unchanged.
    pub fn finish(mut self) -> Result<Option<FinishedFilm>, SaveError> {
        let encoded = self.drain(0);
        if self.film.frames() == 0 {
            return encoded.map(|()| None);
        }
        let failed = |cause| SaveError::Write { path: self.target.path(), cause };
        let (frames, cut) = self.film.finish().map_err(failed)?;
        let problem = encoded.err().or(cut.map(failed));
        let bytes = self.file.as_file().metadata().map_or(0, |file| file.len());
        let path = self.target.finish(self.file)?;
        Ok(Some(FinishedFilm { path, frames, bytes, problem }))
    }

    fn begin_group(&mut self) -> Result<(), SaveError> {
        let (parallel, queue) = self.share();
        self.drain(parallel - 1)?;
        if self.is_broken {
            return Err(self.refusal("it has failed already"));
        }
        let group = RunningGroup::begin(self.settings, queue);
        let group = group.map_err(|cause| SaveError::Write { path: self.target.path(), cause })?;
        self.running.push_back(group);
        Ok(())
    }

    /// Number of groups that are encoded at once, and of frames that may wait for each of them.
    fn share(&self) -> (usize, usize) {
        let frame_bytes = (self.settings.size.map(u64::from).iter().product::<u64>() * 3 / 2).max(1);
        let (most, group) = (MAX_WAITING_BYTES / frame_bytes, u64::from(self.settings.key_interval()));
        let parallel = (most / group).clamp(1, self.settings.threads.max(1) as u64);
        // A thread more than the last one needs no queue: all but one group have all their frames.
        (parallel as usize, (most / parallel).clamp(MIN_QUEUE, group) as usize)
    }

    /// Writes groups to the file, the first ones first, until `left` are still being encoded.
    fn drain(&mut self, left: usize) -> Result<(), SaveError> {
        while self.running.len() > left
            && let Some(group) = self.running.pop_front()
        {
            let count = group.count;
            let outcome = match group.finish() {
                Ok(group) if group.samples.len() == count as usize => self
                    .film
                    .append(&group)
                    .map_err(|cause| SaveError::Write { path: self.target.path(), cause }),
                Ok(_) => Err(self.refusal("the encoder has lost frames")),
                Err(cause) => Err(SaveError::Encode { path: self.target.path(), cause }),
            };
            if outcome.is_err() {
                // Without this group, those after it would be in the wrong place.
                self.is_broken = true;
                self.running.clear();
                return outcome;
            }
        }
        Ok(())
    }

    fn refusal(&self, cause: &str) -> SaveError {
        SaveError::Encode { path: self.target.path(), cause: cause.into() }
    }
}
