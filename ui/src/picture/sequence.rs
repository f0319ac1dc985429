//! Renders a camera path into a folder of numbered pictures, from which a film can be encoded. An
//! interrupted sequence is resumed: finished pictures are kept.

use super::numbered::{DESCRIPTION, description, is_described, picture_path, text_of};
use super::{Output, PictureJob, Shows};
use afterimage::raster::save::{Target, write_atomically};
use afterimage::{Tracer, camera::CameraPath, trace::parallel::Stop};
use anyhow::{anyhow, bail};
use std::path::{Path, PathBuf};

/// Frames per second of a film. The window plays camera paths at the same rate.
pub const FRAMES_PER_SEC: u32 = 30;

/// Maximum number of sequences in one folder.
const MAX_FOLDERS: u32 = 10_000;

/// A camera path to render as numbered pictures.
#[derive(Clone, Debug)]
pub struct Sequence {
    /// Settings of every picture; its camera is replaced.
    pub job: PictureJob,
    /// Camera path of the sequence.
    pub walk: CameraPath,
    /// Pictures per second of the film.
    pub rate: u32,
}

/// Result of rendering a sequence.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MadeSequence {
    /// Folder that contains the pictures.
    pub folder: PathBuf,
    /// Number of pictures rendered now, without those found in the folder.
    pub made: u32,
    /// Number of pictures of the sequence.
    pub count: u32,
    /// Pictures per second of the film.
    pub rate: u32,
}

impl MadeSequence {
    /// A message about the result for the user.
    pub fn text(&self) -> String {
        let found = self.count - self.made;
        let found = if found > 0 { format!(" ({found} existed already)") } else { String::new() };
        format!("saved {} pictures in {}{found}", self.count, self.folder.display())
    }

    /// Shell command that encodes the sequence as a film.
    pub fn film_command(&self) -> String {
        film_command(&self.folder, self.rate)
    }
}

/// Shell command that encodes a folder's pictures `frame_0000.png`, ... as a film with `rate`
/// pictures per second.
pub fn film_command(folder: &Path, rate: u32) -> String {
    let quoted = |name: &str| format!("'{}'", folder.join(name).display().to_string().replace('\'', r"'\''"));
    // Most players need an even width and height, and this pixel format.
    format!(
        "ffmpeg -framerate {rate} -i {} -vf 'pad=ceil(iw/2)*2:ceil(ih/2)*2' -c:v libx264 -crf 18 \
         -pix_fmt yuv420p {}",
        quoted("frame_%04d.png"),
        quoted("film.mp4")
    )
}

impl Sequence {
    /// Renders the missing pictures of the sequence, below the first of `folders` that can be
    /// written.
    ///
    /// # Errors
    /// If the pictures are too large, or cannot be written; finished pictures are kept.
    pub fn make(
        &self,
        tracer: &Tracer,
        folders: &[PathBuf],
        stem: &str,
        stop: Stop<'_>,
        progress: &(dyn Fn(f64) + Sync),
    ) -> anyhow::Result<MadeSequence> {
        self.job.check(&[])?;
        let folder = self.folder(tracer, folders, stem)?;
        let (count, mut made) = (self.walk.frames.max(1), 0);
        for frame in 0..count {
            let path = picture_path(&folder, frame);
            let Some(camera) = self.walk.camera(frame, count).filter(|_| !stop()) else { break };
            if path.exists() {
                continue;
            }
            let job = PictureJob { camera, ..self.job.clone() };
            let output = Output { target: Target::File(path), shows: Shows::Display };
            let note = |part: f64| progress((f64::from(frame) + part) / f64::from(count));
            let picture = job.make_whole(tracer, &[], &[output], stop, &note);
            let picture = picture.map_err(|error| {
                anyhow!("{error}; {made} pictures were saved before it. Save the sequence again to resume it")
            })?;
            made += u32::from(picture.is_some());
        }
        Ok(MadeSequence { folder, made, count, rate: self.rate })
    }

    /// The folder of the same sequence begun earlier, or a new one.
    fn folder(&self, tracer: &Tracer, folders: &[PathBuf], stem: &str) -> anyhow::Result<PathBuf> {
        let description = text_of(&description(&self.job, &self.walk, tracer));
        let mut result = Err(anyhow!("there is no folder to save pictures in"));
        for parent in folders {
            result = self.folder_in(parent, stem, &description);
            if result.is_ok() {
                break;
            }
        }
        result
    }

    fn folder_in(&self, parent: &Path, stem: &str, description: &str) -> anyhow::Result<PathBuf> {
        for number in 1..MAX_FOLDERS {
            let folder = parent.join(format!("{stem}-sequence-{number:04}"));
            match std::fs::create_dir(&folder) {
                Ok(()) => {
                    let path = folder.join(DESCRIPTION);
                    write_atomically(&path, description.as_bytes())?;
                    return Ok(folder);
                }
                Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {
                    if is_described(&folder, description) && !self.is_whole(&folder) {
                        return Ok(folder);
                    }
                }
                Err(error) => {
                    let folder = folder.display();
                    bail!("cannot create the folder {folder}: {error}; choose another folder");
                }
            }
        }
        bail!("{} contains too many sequences; choose another folder", parent.display())
    }

    fn is_whole(&self, folder: &Path) -> bool {
        (0..self.walk.frames.max(1)).all(|frame| picture_path(folder, frame).exists())
    }
}
