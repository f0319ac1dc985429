//! Making picture files: the one way that the command line and the window share, so that both write the same bits.

pub(crate) mod memory;
mod notes;
pub mod restore;
pub mod sequence;

pub(crate) use notes::{Made, notes};

use afterimage::raster::color::ToneMap;
use afterimage::raster::pixel_types::TypeCounts;
use afterimage::raster::save::{Channel, ChannelValues, SaveError};
use afterimage::raster::stream::{Contents, PictureFile, Rows, Target};
use afterimage::reference::{ReferenceCache, ReferenceFrame};
use afterimage::render::aov::{Aov, display_rows, display_rows_alpha, types_rows};
use afterimage::render::bands::{Background, Band, BandedPicture};
use afterimage::render::{FrameStats, RefineState};
use afterimage::trace::parallel::Stop;
use afterimage::{Camera, FrameRequest, RenderSettings, Renderer, Tracer};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// A picture has at most so many pixels: 16384 squared.
pub const MAX_PIXELS: u64 = 1 << 28;

/// The longest side of a picture that the window makes.
pub const LONGEST_SIDE: u32 = 16384;

/// A picture to be made.
#[derive(Clone, Debug)]
pub struct PictureJob {
    /// The scene as it was asked for.
    pub scene_name: String,
    /// Where it is seen from.
    pub camera: Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Mode, samples, bounces, seed.
    pub settings: RenderSettings,
    /// Rays through different points of every pixel, each traced in full; `None` for one through its centre.
    pub antialias: Option<u32>,
    /// Whether the sky is seen.
    pub background: Background,
    /// In stops.
    pub exposure_ev: f32,
    /// From radiance to display.
    pub tone_map: ToneMap,
}

/// What a file shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Shows {
    /// The picture as a screen shows it (PNG).
    Display,
    /// The type of every pixel (PNG).
    Types,
    /// Linear radiance with further layers (OpenEXR).
    Linear(Vec<Aov>),
}

/// A file to be written.
#[derive(Clone, Debug)]
pub struct Output {
    /// Its name.
    pub target: Target,
    /// What it shows.
    pub shows: Shows,
}

/// What was made.
#[derive(Clone, Debug)]
pub struct MadePicture {
    /// The files, in the order asked for.
    pub paths: Vec<PathBuf>,
    /// Times and counts.
    pub stats: FrameStats,
}

impl PictureJob {
    /// True where it is traced pixel by pixel, and therefore band by band: nothing of the size of the picture is held.
    pub fn is_banded(&self, references: &[Arc<ReferenceFrame>]) -> bool {
        self.antialias.is_some() || self.settings.mode.traces_all(references.is_empty())
    }

    /// Refuses a picture that is too large, before anything is reserved.
    ///
    /// # Errors
    /// A message for people, with the remedy.
    pub fn check(&self, references: &[Arc<ReferenceFrame>]) -> Result<(), String> {
        let pixels = self.size.map(u64::from).iter().product();
        if self.is_banded(references) {
            memory::check_banded(pixels)
        } else {
            memory::check(pixels, references.len() as u64)
        }
    }

    /// Makes the picture and its files. `progress` is told from several threads what part is done, 0..1. After a stop the
    /// files hold what was made, and say that they are not complete.
    ///
    /// # Errors
    /// [`SaveError`] of the first file that cannot be written; then there are none.
    pub fn make(
        &self,
        tracer: &Tracer,
        references: &[Arc<ReferenceFrame>],
        outputs: &[Output],
        stop: Stop<'_>,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<MadePicture, SaveError> {
        let (files, stats) = self.make_files(tracer, references, outputs, stop, progress)?;
        finish(files, stats)
    }

    /// The same, but after a stop there are no files and the answer is `None`.
    ///
    /// # Errors
    /// As [`Self::make`].
    pub fn make_whole(
        &self,
        tracer: &Tracer,
        references: &[Arc<ReferenceFrame>],
        outputs: &[Output],
        stop: Stop<'_>,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Option<MadePicture>, SaveError> {
        let (files, stats) = self.make_files(tracer, references, outputs, stop, progress)?;
        if stats.is_complete { finish(files, stats).map(Some) } else { Ok(None) }
    }

    fn make_files(
        &self,
        tracer: &Tracer,
        references: &[Arc<ReferenceFrame>],
        outputs: &[Output],
        stop: Stop<'_>,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<(Vec<PictureFile>, FrameStats), SaveError> {
        let notes = self.notes(tracer);
        let mut files = outputs.iter().map(|o| self.begin(o, &notes)).collect::<Result<Vec<_>, _>>()?;
        let stats = if self.is_banded(references) {
            self.in_bands(tracer, outputs, &mut files, stop, progress)?
        } else {
            let frame = self.whole(tracer, references, stop);
            let stats = frame.stats;
            self.write(tracer, outputs, &mut files, &Band::from(frame))?;
            stats
        };
        Ok((files, stats))
    }

    fn in_bands(
        &self,
        tracer: &Tracer,
        outputs: &[Output],
        files: &mut [PictureFile],
        stop: Stop<'_>,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<FrameStats, SaveError> {
        let picture = BandedPicture {
            tracer,
            camera: &self.camera,
            size: self.size,
            trace: self.settings.trace,
            passes: self.antialias.unwrap_or(1),
            background: self.background,
        };
        let start = Instant::now();
        let (done, work) = (AtomicU64::new(0), picture.work().max(1) as f64);
        let note = |more| {
            let done = done.fetch_add(more, Ordering::Relaxed) + more;
            progress(done as f64 / work);
        };
        let mut stats = FrameStats { is_complete: true, ..FrameStats::default() };
        for rows in picture.bands() {
            let Some((band, rays)) = picture.render(rows, stop, &note) else {
                stats.is_complete = false;
                break;
            };
            stats.rays += rays;
            self.write(tracer, outputs, files, &band)?;
        }
        let pixels = self.size.map(|side| side as usize).iter().product();
        stats.types = TypeCounts { unseen: pixels, ..TypeCounts::of(&[]) };
        stats.refined = self.refined();
        stats.secs.trace = start.elapsed().as_secs_f64();
        stats.secs.frame = stats.secs.trace;
        Ok(stats)
    }

    /// A picture that reuses references is made in one piece: a reference knows points all over it.
    fn whole(
        &self,
        tracer: &Tracer,
        references: &[Arc<ReferenceFrame>],
        stop: Stop<'_>,
    ) -> afterimage::Frame {
        let mut cache = ReferenceCache::new(tracer.scene(), usize::MAX);
        for reference in references {
            cache.insert(Arc::clone(reference));
        }
        let mut renderer = Renderer::default();
        let request = FrameRequest::new(tracer, &self.camera, self.size, &self.settings);
        renderer.render(&request.reusing(&cache).with_stop(stop));
        renderer.into_frame()
    }

    fn refined(&self) -> RefineState {
        let of = self.antialias.unwrap_or(0);
        RefineState { pass: of, of, is_complete: of > 0 }
    }

    fn notes(&self, tracer: &Tracer) -> Vec<(&'static str, String)> {
        notes(&Made {
            scene_name: &self.scene_name,
            scene: tracer.scene(),
            camera: &self.camera,
            size: self.size,
            settings: &self.settings,
            refined: self.refined(),
            background: self.background,
            exposure_ev: self.exposure_ev,
            tone_map: self.tone_map,
        })
    }

    fn begin(&self, output: &Output, notes: &[(&'static str, String)]) -> Result<PictureFile, SaveError> {
        let contents = match &output.shows {
            Shows::Display if self.background == Background::LeftOut => Contents::PngAlpha,
            Shows::Display | Shows::Types => Contents::Png,
            Shows::Linear(layers) => Contents::Exr(self.channel_names(layers)),
        };
        PictureFile::begin(output.target.clone(), contents, self.size, notes)
    }

    /// Names of the channels of a file, and which of them are indices.
    fn channel_names(&self, layers: &[Aov]) -> Vec<(String, bool)> {
        let rgb = ["R", "G", "B"].map(|name| (name.to_owned(), false));
        let alpha = (self.background == Background::LeftOut).then(|| ("A".to_owned(), false));
        let further = layers.iter().flat_map(|l| l.channel_names());
        let further = further.map(|(name, is_index)| ((*name).to_owned(), *is_index));
        rgb.into_iter().chain(alpha).chain(further).collect()
    }

    fn write(
        &self,
        tracer: &Tracer,
        outputs: &[Output],
        files: &mut [PictureFile],
        band: &Band,
    ) -> Result<(), SaveError> {
        for (output, file) in outputs.iter().zip(files) {
            file.write(match &output.shows {
                Shows::Display if self.background == Background::LeftOut => {
                    Rows::SrgbAlpha(display_rows_alpha(band, self.exposure_ev, self.tone_map))
                }
                Shows::Display => Rows::Srgb(display_rows(&band.radiance, self.exposure_ev, self.tone_map)),
                Shows::Types => Rows::Srgb(types_rows(&band.types)),
                Shows::Linear(layers) => Rows::Channels(self.channels(tracer, layers, band)),
            })?;
        }
        Ok(())
    }

    fn channels(&self, tracer: &Tracer, layers: &[Aov], band: &Band) -> Vec<ChannelValues> {
        let rgb = Channel::rgb(&band.radiance).into_iter().map(|c| c.values);
        let has_alpha = self.background == Background::LeftOut;
        let alpha = has_alpha.then(|| ChannelValues::Real(band.coverage.clone()));
        let further = layers.iter().flat_map(|l| l.channels(band, tracer)).map(|c| c.values);
        rgb.chain(alpha).chain(further).collect()
    }
}

fn finish(files: Vec<PictureFile>, stats: FrameStats) -> Result<MadePicture, SaveError> {
    let paths = files.into_iter().map(|file| file.finish(stats.is_complete)).collect::<Result<_, _>>()?;
    Ok(MadePicture { paths, stats })
}
