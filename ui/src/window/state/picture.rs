//! Settings and progress of saved pictures.

use crate::window::rendering::Progress;
use afterimage::Mode;
use afterimage::raster::film::FilmQuality;
use afterimage::raster::jpeg::DEFAULT_QUALITY;
use afterimage::render::FrameStats;
use afterimage::render::bands::Background;
use std::path::PathBuf;
use std::time::Instant;

/// Size of a saved picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureSize {
    /// Size of the viewport in pixels.
    Viewport,
    /// Width and height in pixels.
    Pixels([u32; 2]),
}

/// File format of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// As displayed, 8 bits per channel.
    Png,
    /// As displayed, with small losses and without transparency.
    Jpeg,
    /// Linear radiance with depth, normal, type, reference and primitive.
    Exr,
}

/// Settings with which pictures are saved.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureSettings {
    /// Size of the saved picture.
    pub size: PictureSize,
    /// Light samples per pixel; `None` for the window's.
    pub samples: Option<u32>,
    /// `Full` traces every pixel, with anti-aliasing; the other modes reuse the references that the
    /// window holds.
    pub mode: Mode,
    /// Number of rays through different points of each pixel, in mode `full`.
    pub antialias: u32,
    /// File format of the saved picture.
    pub format: PictureFormat,
    /// Quality of JPEG files, 1 to 100.
    pub jpeg_quality: u8,
    /// Whether the background is visible.
    pub background: Background,
    /// Folder; `None` for the folder of the model or the user's folder for pictures.
    pub folder: Option<PathBuf>,
    /// Whether the background is visible in films.
    pub film_background: Background,
    /// Pictures per second of a film.
    pub film_rate: u32,
    /// Rays and coding of films.
    pub film_quality: FilmQuality,
    /// Width of a panorama in pixels; it is half as high.
    pub panorama_width: u32,
}

/// How well a picture is traced: a number of rays per pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureQuality {
    /// For a look at the frame: edges are smooth, light is noisy.
    Draft,
    /// As a picture at rest that has converged.
    Good,
    /// A quarter of the variance of [`Self::Good`].
    Best,
}

impl PictureQuality {
    /// All of them, with their names.
    pub const ALL: [(Self, &'static str); 3] =
        [(Self::Draft, "Draft"), (Self::Good, "Good"), (Self::Best, "Best")];

    /// Rays through different points of each pixel.
    pub fn antialias(self) -> u32 {
        match self {
            Self::Draft => 4,
            Self::Good => afterimage::render::CONVERGED_PASSES,
            Self::Best => 4 * afterimage::render::CONVERGED_PASSES,
        }
    }
}

impl Default for PictureSettings {
    fn default() -> Self {
        Self {
            size: PictureSize::Viewport,
            samples: None,
            mode: Mode::Full,
            // The same as for a picture at rest that has converged.
            antialias: afterimage::render::CONVERGED_PASSES,
            format: PictureFormat::Png,
            jpeg_quality: DEFAULT_QUALITY,
            background: Background::Shown,
            folder: None,
            film_background: Background::Shown,
            film_rate: crate::picture::sequence::FRAMES_PER_SEC,
            film_quality: FilmQuality::Good,
            panorama_width: 4096,
        }
    }
}

/// Saved pictures, as panels show them.
#[derive(Clone, Debug, Default)]
pub struct PictureState {
    /// Settings of the next picture.
    pub settings: PictureSettings,
    /// Text of the folder field.
    pub folder_text: String,
    /// True while the dialog of picture settings is open.
    pub is_open: bool,
    /// Progress of the picture that is being saved.
    pub exporting: Option<Progress>,
    /// Shell command that makes a film of the last sequence.
    pub film_command: Option<String>,
    /// Seconds that a sample of a traced pixel takes, as last measured; `None` before that.
    pub secs_per_sample: Option<f64>,
    /// The export that is running: its begin, and its number of samples.
    pub running: Option<(Instant, f64)>,
    /// Number of rays of the film that is being saved.
    pub running_film: Option<f64>,
    /// Seconds that a ray of a film takes, coding included, as last measured.
    pub secs_per_film_ray: Option<f64>,
    /// Pixels of the panorama that is being saved.
    pub panorama_pixels: Option<f64>,
    /// Seconds that a pixel of a panorama takes, as last measured; `None` before that.
    pub secs_per_panorama_pixel: Option<f64>,
}

/// Pixels that a frame must have traced for its time to count.
const MIN_TIMED_PIXELS: usize = 2000;

impl PictureState {
    /// Notes the time that the traced pixels of a frame took, with `samples` each.
    pub fn note_frame(&mut self, stats: &FrameStats, samples: u32) {
        let (traced, secs) = (stats.types.unseen, stats.secs.trace);
        if traced >= MIN_TIMED_PIXELS && secs > 0.0 {
            self.secs_per_sample = Some(secs / (traced as f64 * f64::from(samples.max(1))));
        }
    }

    /// Notes that the running export has ended; `is_whole` where it made everything.
    pub fn end_export(&mut self, is_whole: bool) {
        let (running, film, panorama) =
            (self.running.take(), self.running_film.take(), self.panorama_pixels.take());
        let Some((begun, samples)) = running.filter(|_| is_whole) else { return };
        let secs = begun.elapsed().as_secs_f64();
        if let Some(rays) = film {
            self.secs_per_film_ray = Some(secs / rays.max(1.0));
        } else if let Some(pixels) = panorama {
            self.secs_per_panorama_pixel = Some(secs / pixels);
        } else if samples >= MIN_TIMED_PIXELS as f64 {
            self.secs_per_sample = Some(begun.elapsed().as_secs_f64() / samples);
        }
    }

    /// Returns the seconds that a number of samples will take; `None` before anything was measured.
    pub fn expected_secs(&self, samples: f64) -> Option<f64> {
        Some(self.secs_per_sample? * samples)
    }

    /// Returns the seconds until the running export is done; `None` where it has just begun.
    pub fn secs_left(&self) -> Option<f64> {
        // Earlier the guess would jump.
        const MIN_PART: f64 = 0.02;
        let part = f64::from(self.exporting.as_ref()?.fraction?);
        let secs = self.running?.0.elapsed().as_secs_f64();
        (part >= MIN_PART).then(|| secs * (1.0 - part) / part)
    }
}

/// A command about saved pictures.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the names say it")]
pub enum PictureCommand {
    Save,
    SaveWithoutBackground,
    SaveSequence,
    SaveFilm,
    SavePanorama,
    ShowDialog(bool),
    Set(PictureSettings),
    SetFolderText(String),
    Cancel,
}
