//! A camera path as numbered pictures in a folder, to be made into a film. What was made stays: an interrupted sequence
//! goes on where it was.

use super::{Output, PictureJob, Shows};
use afterimage::Tracer;
use afterimage::camera::CameraPath;
use afterimage::raster::load::read_bounded;
use afterimage::raster::save::write_atomically;
use afterimage::raster::stream::Target;
use afterimage::trace::parallel::Stop;
use std::path::{Path, PathBuf};

/// What is played per second; the window plays paths at this rate too.
pub const FRAMES_PER_SEC: u32 = 30;

/// A folder is tried with so many numbers before giving up.
const MAX_FOLDERS: u32 = 10_000;

/// Says in its folder what a sequence is.
const DESCRIPTION: &str = "sequence.json";

/// A sequence to be made.
#[derive(Clone, Debug)]
pub struct Sequence {
    /// Every picture, the pose left aside.
    pub job: PictureJob,
    /// Where it goes.
    pub walk: CameraPath,
}

/// A sequence that was made.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MadeSequence {
    /// Where it is.
    pub folder: PathBuf,
    /// Pictures made now, those found left aside.
    pub made: u32,
    /// Pictures in all.
    pub count: u32,
}

impl MadeSequence {
    /// For people.
    pub fn text(&self) -> String {
        let found = self.count - self.made;
        let found = if found > 0 { format!(" ({found} were there already)") } else { String::new() };
        format!("saved {} pictures in {}{found}", self.count, self.folder.display())
    }

    /// A line for the shell that makes a film of it.
    pub fn film_command(&self) -> String {
        film_command(&self.folder)
    }
}

/// A line for the shell that makes a film of a folder's pictures `frame_0000.png`, ...
pub fn film_command(folder: &Path) -> String {
    let quoted = |name: &str| format!("'{}'", folder.join(name).display().to_string().replace('\'', r"'\''"));
    // Most players want even sides and this arrangement of colours.
    format!(
        "ffmpeg -framerate {FRAMES_PER_SEC} -i {} -vf 'pad=ceil(iw/2)*2:ceil(ih/2)*2' -c:v libx264 -crf 18 \
         -pix_fmt yuv420p {}",
        quoted("frame_%04d.png"),
        quoted("film.mp4")
    )
}

impl Sequence {
    /// Makes what is missing of the sequence, in the first folder that takes it.
    ///
    /// # Errors
    /// A message for people; pictures made before stay.
    pub fn make(
        &self,
        tracer: &Tracer,
        folders: &[PathBuf],
        stem: &str,
        stop: Stop<'_>,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<MadeSequence, String> {
        self.job.check(&[])?;
        let folder = self.folder(tracer, folders, stem)?;
        let (count, mut made) = (self.walk.frames.max(1), 0);
        for frame in 0..count {
            let path = folder.join(format!("frame_{frame:04}.png"));
            let Some(camera) = self.walk.camera(frame, count).filter(|_| !stop()) else { break };
            if path.exists() {
                continue;
            }
            let job = PictureJob { camera, ..self.job.clone() };
            let output = Output { target: Target::File(path), shows: Shows::Display };
            let note = |part: f64| progress((f64::from(frame) + part) / f64::from(count));
            let picture = job.make_whole(tracer, &[], &[output], stop, &note);
            let picture = picture.map_err(|error| {
                format!("{error}; pictures made before it: {made}. Save the sequence again to go on")
            })?;
            made += u32::from(picture.is_some());
        }
        Ok(MadeSequence { folder, made, count })
    }

    /// What makes two sequences the same.
    fn description(&self, tracer: &Tracer) -> String {
        let job = &self.job;
        let [width, height] = job.size;
        let description = serde_json::json!({
            "scene": job.scene_name,
            "scene_hash": tracer.scene().hash,
            "size": [width, height],
            "samples": job.settings.trace.samples,
            "bounces": job.settings.trace.bounces,
            "seed": job.settings.trace.seed,
            "antialias": job.antialias,
            "has_background": job.background == afterimage::render::bands::Background::Shown,
            "exposure_ev": job.exposure_ev,
            "tone_map": job.tone_map.name(),
            "walk": self.walk,
        });
        format!("{description:#}\n")
    }

    /// The folder of this very sequence, or a new one.
    fn folder(&self, tracer: &Tracer, folders: &[PathBuf], stem: &str) -> Result<PathBuf, String> {
        let description = self.description(tracer);
        let mut refusal = "there is no folder to save pictures in".to_owned();
        for parent in folders {
            match self.folder_in(parent, stem, &description) {
                Ok(folder) => return Ok(folder),
                Err(cause) => refusal = cause,
            }
        }
        Err(refusal)
    }

    fn folder_in(&self, parent: &Path, stem: &str, description: &str) -> Result<PathBuf, String> {
        for number in 1..MAX_FOLDERS {
            let folder = parent.join(format!("{stem}-sequence-{number:04}"));
            match std::fs::create_dir(&folder) {
                Ok(()) => {
                    let path = folder.join(DESCRIPTION);
                    write_atomically(&path, description.as_bytes()).map_err(|e| e.to_string())?;
                    return Ok(folder);
                }
                Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => {
                    let found = read_bounded(&folder.join(DESCRIPTION), description.len() as u64);
                    if found.is_ok_and(|bytes| bytes == description.as_bytes()) && !self.is_whole(&folder) {
                        return Ok(folder);
                    }
                }
                Err(error) => {
                    let folder = folder.display();
                    return Err(format!("cannot make the folder {folder}: {error}; choose another folder"));
                }
            }
        }
        Err(format!("{} holds too many sequences", parent.display()))
    }

    fn is_whole(&self, folder: &Path) -> bool {
        (0..self.walk.frames.max(1)).all(|frame| folder.join(format!("frame_{frame:04}.png")).exists())
    }
}
