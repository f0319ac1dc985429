//! Renders a camera path as a film, frame after frame as a walkthrough does, and encodes it at the
//! same time. Numbered pictures can be kept beside it; those that are there already are not
//! rendered again.

pub use super::film_writer::FilmFormat;

use super::film_writer::FilmWriter;
use super::numbered::{description, open, picture_path, read, text_of};
use super::{PictureJob, memory};
use afterimage::experiment::run::ExperimentError;
use afterimage::experiment::tour::{TourEvent, TourSettings, cameras, fly};
use afterimage::raster::film::{FilmQuality, FilmSettings, FilmSizeError};
use afterimage::raster::save::{Target, save_png};
use afterimage::raster::stream::COMPLETE;
use afterimage::render::aov::{display_rows, types_rows};
use afterimage::{Camera, Frame, Tracer, WalkthroughSettings, camera::CameraPath};
use afterimage::{store::StoreSettings, trace::parallel::Stop};
use glam::Vec3;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Numbers of rays for each pixel of a film: squares, because a pixel is divided evenly.
pub const RAYS: [u32; 4] = [1, 4, 9, 16];

/// Rays for each pixel of a film of a quality, where nothing else is chosen.
pub fn rays_of(quality: FilmQuality) -> u32 {
    match quality {
        FilmQuality::Small => 1,
        FilmQuality::Good => 4,
        FilmQuality::Best => 9,
    }
}

/// A film to render.
#[derive(Clone, Debug)]
pub struct Film {
    /// Settings of every frame; its camera is replaced. Its anti-aliasing is one of [`RAYS`].
    pub job: PictureJob,
    /// Camera path; its number of frames is that of the film.
    pub walk: CameraPath,
    /// Placement and memory of references.
    pub walkthrough: WalkthroughSettings,
    /// Frames per second.
    pub rate: u32,
    /// Format of the file.
    pub format: FilmFormat,
    /// How coarsely the film is coded.
    pub quality: FilmQuality,
    /// Whether the types of the pixels are shown.
    pub heatmap: FilmHeatmap,
    /// Folder in which every frame is kept as a numbered picture.
    pub pictures: Option<PathBuf>,
    /// The store that references are read from and written to.
    pub store: Option<StoreSettings>,
}

/// How the types of pixels are shown in a film.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FilmHeatmap {
    /// Not at all.
    #[default]
    Off,
    /// Blended with the picture.
    Over,
    /// In the right half of a film of double width.
    Beside,
}

impl FilmHeatmap {
    /// All of them, with their names.
    pub const ALL: [(Self, &'static str); 3] =
        [(Self::Off, "off"), (Self::Over, "over"), (Self::Beside, "beside")];
}

/// Progress of a film.
#[derive(Debug)]
pub enum FilmEvent<'a> {
    /// This number of frames is rendered or found.
    Frames(u32),
    /// The film is stopped early, and this number of frames is being completed.
    Ending(u32),
    /// Something of the store of references is damaged or cannot be used.
    StoreProblem(&'a str),
}

/// Result of rendering a film.
#[derive(Debug)]
pub struct MadeFilm {
    /// Path of the film.
    pub path: PathBuf,
    /// Number of its frames.
    pub frames: u32,
    /// Number of frames that were asked for.
    pub wanted: u32,
    /// Number of frames that were found as pictures.
    pub found: u32,
    /// Frames per second.
    pub rate: u32,
    /// Size in bytes.
    pub bytes: u64,
    /// Why the film ends early, where a failure is the cause.
    pub problem: Option<anyhow::Error>,
}

impl MadeFilm {
    /// True if the film has all of its frames.
    pub fn is_complete(&self) -> bool {
        self.frames == self.wanted
    }

    /// A message about the result for the user.
    pub fn text(&self) -> String {
        let (frames, wanted) = (self.frames, self.wanted);
        let what = match self.is_complete() {
            true => format!("{frames} frames"),
            false => format!("the first {frames} of {wanted} frames"),
        };
        let secs = f64::from(frames) / f64::from(self.rate);
        let megabytes = self.bytes as f64 / 1e6;
        let found = match self.found {
            0 => String::new(),
            found => format!("; {found} pictures existed already"),
        };
        format!("saved {what}, {secs:.1} s, in {} ({megabytes:.1} MB{found})", self.path.display())
    }
}

impl Film {
    /// Checks size and memory before anything is rendered.
    ///
    /// # Errors
    /// A message for the user with a size that is possible.
    pub fn check(&self) -> anyhow::Result<()> {
        if self.format == FilmFormat::Mp4 {
            self.coding().check()?;
        }
        memory::check(self.rendered_size().map(u64::from).iter().product(), 1).map_err(FilmTooLarge)?;
        Ok(())
    }

    /// Renders and encodes the film. If it is stopped, the film ends early; `None` where no frame
    /// was complete, and then no file is left.
    ///
    /// # Errors
    /// If the path has no frames, the folder of pictures holds others, or the film cannot be
    /// written at all. A later failure is [`MadeFilm::problem`].
    pub fn make(
        &self,
        tracer: &Arc<Tracer>,
        target: Target,
        stop: Stop<'_>,
        observe: &mut dyn FnMut(FilmEvent<'_>),
    ) -> anyhow::Result<Option<MadeFilm>> {
        self.check()?;
        let wanted = self.walk.frames.max(1);
        let cameras = cameras(&self.walk, wanted)?;
        if let Some(folder) = &self.pictures {
            open(folder, &self.description(tracer))?;
        }
        let file = FilmWriter::begin(self.format, self.coding(), target)?;
        let mut frames = Frames { film: self, tracer, file, written: 0, found: 0 };
        let outcome = frames.fly(&cameras, stop, observe);
        let (found, written) = (frames.found, frames.written);
        if written > 0 && written < wanted {
            observe(FilmEvent::Ending(written));
        }
        let finished = match (frames.file.finish(), outcome) {
            (Ok(Some(mut film)), outcome) => {
                let problem = outcome.err().or(film.problem.take().map(Into::into));
                Some((film, problem))
            }
            (_, Err(error)) => return Err(error),
            (Ok(None), Ok(())) => None,
            (Err(error), Ok(())) => return Err(error.into()),
        };
        Ok(finished.map(|(film, problem)| MadeFilm {
            path: film.path,
            frames: film.frames,
            wanted,
            found,
            rate: self.rate,
            bytes: film.bytes,
            problem,
        }))
    }

    /// Width and height of the film in pixels.
    pub fn size(&self) -> [u32; 2] {
        let [width, height] = self.job.size;
        let columns = if self.heatmap == FilmHeatmap::Beside { 2 } else { 1 };
        [width.saturating_mul(columns), height]
    }

    /// Number of rays of all frames.
    pub fn rays_in_all(&self) -> f64 {
        let rays: f64 = self.rendered_size().map(f64::from).iter().product();
        rays * f64::from(self.walk.frames)
    }

    fn coding(&self) -> FilmSettings {
        FilmSettings {
            size: self.size(),
            rate: self.rate,
            quality: self.quality,
            threads: rayon::current_num_threads(),
        }
    }

    /// Rays of a pixel along each side.
    fn rays(&self) -> u32 {
        self.job.antialias.unwrap_or(1).isqrt()
    }

    /// Size at which frames are rendered, with a pixel for each ray.
    fn rendered_size(&self) -> [u32; 2] {
        self.job.size.map(|side| side.saturating_mul(self.rays()))
    }

    /// Text that identifies the pictures of the film. Speed and coding are left out: they do not
    /// change the pictures.
    fn description(&self, tracer: &Tracer) -> String {
        let mut description = description(&self.job, &self.walk, tracer);
        description["mode"] = self.job.settings.mode.name().into();
        description["heatmap"] = format!("{:?}", self.heatmap).to_lowercase().into();
        text_of(&description)
    }

    fn tour(&self) -> TourSettings {
        TourSettings {
            walkthrough: WalkthroughSettings {
                render: self.job.settings,
                measures_stability: false,
                audits: false,
                ..self.walkthrough
            },
            size: self.rendered_size(),
            frames: self.walk.frames.max(1),
            budget: None,
            measure: None,
            store: self.store.clone(),
            warms_up: false,
        }
    }

    /// The picture of a frame.
    fn picture(&self, frame: &Frame) -> Vec<[u8; 3]> {
        let (width, rays) = (self.job.size[0] as usize, self.rays() as usize);
        let radiance = averaged(&frame.radiance, width, rays);
        let picture = display_rows(&radiance, self.job.exposure_ev, self.job.tone_map);
        if self.heatmap == FilmHeatmap::Off {
            return picture;
        }
        let types: Vec<Vec3> = types_rows(&frame.types).iter().map(|color| color_of(*color)).collect();
        let types: Vec<[u8; 3]> =
            averaged(&types, width, rays).iter().map(|color| bytes_of(*color)).collect();
        if self.heatmap == FilmHeatmap::Over {
            let both = picture.iter().zip(&types);
            return both.map(|(color, kind)| bytes_of(color_of(*color).midpoint(color_of(*kind)))).collect();
        }
        let rows = picture.chunks(width).zip(types.chunks(width));
        rows.flat_map(|(left, right)| left.iter().chain(right)).copied().collect()
    }
}

fn color_of(color: [u8; 3]) -> Vec3 {
    Vec3::from(color.map(f32::from))
}

fn bytes_of(color: Vec3) -> [u8; 3] {
    color.round().to_array().map(|channel| channel as u8)
}

/// Averages squares of rays to pixels, in rows of `width` pixels.
fn averaged(rays: &[Vec3], width: usize, side: usize) -> Vec<Vec3> {
    if side == 1 {
        return rays.to_vec();
    }
    let row = width * side;
    let pixel = |lines: &[Vec3], x: usize| -> Vec3 {
        lines.chunks(row).flat_map(|line| &line[x * side..(x + 1) * side]).sum::<Vec3>()
            / (side * side) as f32
    };
    rays.chunks_exact(row * side).flat_map(|lines| (0..width).map(move |x| pixel(lines, x))).collect()
}

/// A film of which some frames are written.
struct Frames<'a> {
    film: &'a Film,
    tracer: &'a Arc<Tracer>,
    file: FilmWriter,
    /// Number of frames given to the encoder.
    written: u32,
    found: u32,
}

impl Frames<'_> {
    /// Renders the frames whose pictures are missing, and writes all of them in order.
    fn fly(
        &mut self,
        cameras: &[Camera],
        stop: Stop<'_>,
        observe: &mut dyn FnMut(FilmEvent<'_>),
    ) -> anyhow::Result<()> {
        let (count, has_failed) = (cameras.len() as u32, AtomicBool::new(false));
        let missing: Vec<u32> = (0..count).filter(|frame| self.picture_of(*frame).is_none()).collect();
        let poses: Vec<Camera> = missing.iter().map(|frame| cameras[*frame as usize]).collect();
        let mut outcome = self.write_found(missing.first().copied().unwrap_or(count), stop, observe);
        if outcome.is_err() || poses.is_empty() {
            return outcome;
        }
        let stop_all = || stop() || has_failed.load(Ordering::Relaxed);
        let flown: Result<_, ExperimentError> =
            fly(self.tracer, &poses, &self.film.tour(), &stop_all, |event| match event {
                TourEvent::StoreProblem(problem) => observe(FilmEvent::StoreProblem(problem)),
                TourEvent::Frame(record, walk) if outcome.is_ok() => {
                    let next = missing.get(record.frame as usize + 1).copied().unwrap_or(count);
                    outcome = self
                        .write_rendered(missing[record.frame as usize], walk.frame(), observe)
                        .and_then(|()| self.write_found(next, stop, observe));
                    has_failed.store(outcome.is_err(), Ordering::Relaxed);
                }
                _ => {}
            });
        flown?;
        outcome
    }

    /// Path of the numbered picture of a frame, if it exists.
    fn picture_of(&self, frame: u32) -> Option<PathBuf> {
        let path = picture_path(self.film.pictures.as_ref()?, frame);
        path.exists().then_some(path)
    }

    /// Writes the frames before `end` from their pictures.
    fn write_found(
        &mut self,
        end: u32,
        stop: Stop<'_>,
        observe: &mut dyn FnMut(FilmEvent<'_>),
    ) -> anyhow::Result<()> {
        while self.written < end
            && !stop()
            && let Some(path) = self.picture_of(self.written)
        {
            let picture = read(&path, self.film.size())?;
            self.found += 1;
            self.write(&picture, observe)?;
        }
        Ok(())
    }

    fn write_rendered(
        &mut self,
        number: u32,
        frame: &Frame,
        observe: &mut dyn FnMut(FilmEvent<'_>),
    ) -> anyhow::Result<()> {
        let picture = self.film.picture(frame);
        if let Some(folder) = &self.film.pictures {
            let job = PictureJob { camera: frame.camera, ..self.film.job.clone() };
            let mut notes = job.metadata(self.tracer, frame.stats.refined);
            notes.push((COMPLETE, "yes".to_owned()));
            save_png(&picture_path(folder, number), self.film.size(), &picture, &notes)?;
        }
        self.write(&picture, observe)
    }

    fn write(&mut self, picture: &[[u8; 3]], observe: &mut dyn FnMut(FilmEvent<'_>)) -> anyhow::Result<()> {
        self.file.write(picture)?;
        self.written += 1;
        observe(FilmEvent::Frames(self.written));
        Ok(())
    }
}

/// A frame with all its rays is larger than the limits allow.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FilmTooLarge(pub memory::TooLarge);

impl std::error::Error for FilmTooLarge {}

impl std::fmt::Display for FilmTooLarge {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}, or use fewer rays for each pixel (--antialias)", self.0)
    }
}

/// True where no film of this size can be made: the error is one of size, not of the disk.
pub fn is_size_error(error: &anyhow::Error) -> bool {
    error.is::<FilmSizeError>() || error.is::<FilmTooLarge>()
}
