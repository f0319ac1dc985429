//! Renders a picture and writes its files.

use super::memory::{TooLarge, check, check_banded};
use super::metadata::{PictureOrigin, metadata};
use afterimage::raster::save::{Channel, ChannelValues, SaveError, Target};
use afterimage::raster::stream::{Contents, PictureFile, Rows};
use afterimage::raster::{color::ToneMap, pixel_types::TypeCounts};
use afterimage::reference::{ReferenceCache, ReferenceFrame};
use afterimage::render::aov::{Aov, display_rows, display_rows_alpha, types_rows};
use afterimage::render::bands::{Background, Band, BandedPicture};
use afterimage::render::outlines::outlines_of_view;
use afterimage::render::{FrameStats, RefineState};
use afterimage::trace::parallel::Stop;
use afterimage::{Camera, FrameRequest, Mode, RenderSettings, Renderer, Tracer};
use std::sync::atomic::{AtomicU64, Ordering};
use std::{path::PathBuf, sync::Arc, time::Instant};

/// A picture to render, from a pose and with settings.
#[derive(Clone, Debug)]
pub struct PictureJob {
    /// Name of the scene as given by the user.
    pub scene_name: String,
    /// Pose and field of view of the camera.
    pub camera: Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Mode, samples, bounces and seed.
    pub settings: RenderSettings,
    /// Number of primary rays through different points of each pixel, all traced in full; `None`
    /// for one ray through its centre.
    pub antialias: Option<u32>,
    /// Whether the sky is shown.
    pub background: Background,
    /// Exposure in stops: radiance is multiplied by two to this power.
    pub exposure_ev: f32,
    /// Tone map from radiance to display.
    pub tone_map: ToneMap,
    /// Width in pixels of the lines along the edges of surfaces; `None` for no lines.
    pub outlines: Option<u32>,
    /// Session that a reader needs to show the scene with its changes; `None` where there are
    /// none.
    pub document: Option<Arc<str>>,
}

/// Contents of a picture file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Shows {
    /// The tone-mapped picture as it is displayed (PNG).
    Display,
    /// The same as JPEG, with a quality from 1 to 100. A background that is left out is black.
    Jpeg(u8),
    /// The type of every pixel (PNG).
    Types,
    /// Linear radiance with additional layers (OpenEXR).
    Linear(Vec<Aov>),
}

/// A picture file to write.
#[derive(Clone, Debug)]
pub struct Output {
    /// Path of the file, or the folder and stem from which its name is made.
    pub target: Target,
    /// Which picture or layers the file contains.
    pub shows: Shows,
}

/// A rendered picture.
#[derive(Clone, Debug)]
pub struct MadePicture {
    /// Paths of the files, in the order of the outputs.
    pub paths: Vec<PathBuf>,
    /// Times and counts of the frame.
    pub stats: FrameStats,
}

impl PictureJob {
    /// True if every pixel is traced on its own. The picture is then rendered in bands, and no
    /// buffer of its size is allocated.
    pub fn is_banded(&self, references: &[Arc<ReferenceFrame>]) -> bool {
        self.antialias.is_some() || self.settings.mode.traces_all(references.is_empty())
    }

    /// Checks the size of the picture before anything is allocated.
    ///
    /// # Errors
    /// [`TooLarge`] with the limit that it exceeds.
    pub fn check(&self, references: &[Arc<ReferenceFrame>]) -> Result<(), TooLarge> {
        let pixels = self.size.map(u64::from).iter().product();
        if self.is_banded(references) { check_banded(pixels) } else { check(pixels, references.len() as u64) }
    }

    /// Renders the picture and writes its files. `progress` is called from several threads with the
    /// finished part, 0..1. If it is stopped, the files contain the finished part of the picture
    /// and are marked as incomplete.
    ///
    /// # Errors
    /// [`SaveError`] of the first file that cannot be written; then no file is left.
    pub fn make(
        &self,
        tracer: &Tracer,
        references: &[Arc<ReferenceFrame>],
        outputs: &[Output],
        stop: Stop<'_>,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<MadePicture, SaveError> {
        let (files, stats) = self.make_files(tracer, references, outputs, stop, progress)?;
        MadePicture::finish(files, stats)
    }

    /// Like [`Self::make`], but returns `None` and leaves no files if it is stopped.
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
        if stats.is_complete { MadePicture::finish(files, stats).map(Some) } else { Ok(None) }
    }

    fn make_files(
        &self,
        tracer: &Tracer,
        references: &[Arc<ReferenceFrame>],
        outputs: &[Output],
        stop: Stop<'_>,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<(Vec<PictureFile>, FrameStats), SaveError> {
        let mut files = self.begin_all(outputs, &self.metadata(tracer, self.refined()))?;
        let lines = self.lines(tracer);
        let stats = if self.is_banded(references) {
            self.in_bands(tracer, (outputs, &lines), &mut files, stop, progress)?
        } else {
            let frame = self.whole(tracer, references, stop);
            let stats = frame.stats;
            self.write(tracer, outputs, &mut files, &drawn(frame.into(), &lines))?;
            stats
        };
        Ok((files, stats))
    }

    fn in_bands(
        &self,
        tracer: &Tracer,
        (outputs, lines): (&[Output], &[f32]),
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
            self.write(tracer, outputs, files, &drawn(band, lines))?;
        }
        let pixels = self.size.map(|side| side as usize).iter().product();
        stats.types = TypeCounts { unseen: pixels, ..TypeCounts::of(&[]) };
        stats.refined = self.refined();
        stats.secs.trace = start.elapsed().as_secs_f64();
        stats.secs.frame = stats.secs.trace;
        Ok(stats)
    }

    /// Renders a picture that reuses references in one piece: a reference may contain points of all
    /// of it.
    fn whole(
        &self,
        tracer: &Tracer,
        references: &[Arc<ReferenceFrame>],
        stop: Stop<'_>,
    ) -> afterimage::Frame {
        let mut renderer = Renderer::default();
        let request = FrameRequest::new(tracer, &self.camera, self.size, &self.settings).with_stop(stop);
        if self.settings.mode == Mode::Paper {
            // A cache would evict some of many references; mode `paper` warps all that are given.
            let frames: Vec<&ReferenceFrame> = references.iter().map(|r| &**r).collect();
            renderer.render(&request.warping(&frames));
        } else {
            let mut cache = ReferenceCache::new(tracer.scene(), usize::MAX);
            for reference in references {
                cache.insert(Arc::clone(reference));
            }
            renderer.render(&request.reusing(&cache));
        }
        renderer.into_frame()
    }

    /// How much of each pixel is covered by lines; empty without lines.
    pub(super) fn lines(&self, tracer: &Tracer) -> Vec<f32> {
        self.outlines.map_or(Vec::new(), |width| outlines_of_view(tracer, &self.camera, self.size, width))
    }

    fn refined(&self) -> RefineState {
        let of = self.antialias.unwrap_or(0);
        RefineState { pass: of, of, light_samples: 0, is_complete: of > 0 }
    }

    pub(super) fn metadata(&self, tracer: &Tracer, refined: RefineState) -> Vec<(&'static str, String)> {
        metadata(&PictureOrigin {
            scene_name: &self.scene_name,
            scene: tracer.scene(),
            camera: &self.camera,
            size: self.size,
            settings: &self.settings,
            refined,
            background: self.background,
            exposure_ev: self.exposure_ev,
            tone_map: self.tone_map,
            section: tracer.section().map_or(&[], |section| section.planes()),
            outlines: self.outlines,
            document: self.document.as_deref(),
        })
    }

    pub(super) fn begin_all(
        &self,
        outputs: &[Output],
        metadata: &[(&'static str, String)],
    ) -> Result<Vec<PictureFile>, SaveError> {
        outputs.iter().map(|output| self.begin(output, metadata)).collect()
    }

    fn begin(&self, output: &Output, metadata: &[(&'static str, String)]) -> Result<PictureFile, SaveError> {
        let contents = match &output.shows {
            Shows::Display if self.background == Background::LeftOut => Contents::PngAlpha,
            Shows::Display | Shows::Types => Contents::Png,
            Shows::Jpeg(quality) => Contents::Jpeg(*quality),
            Shows::Linear(layers) => Contents::Exr(self.channel_names(layers)),
        };
        PictureFile::begin(output.target.clone(), contents, self.size, metadata)
    }

    /// Names of a file's channels; true for channels of indices.
    fn channel_names(&self, layers: &[Aov]) -> Vec<(String, bool)> {
        let rgb = ["R", "G", "B"].map(|name| (name.to_owned(), false));
        let alpha = (self.background == Background::LeftOut).then(|| ("A".to_owned(), false));
        let further = layers.iter().flat_map(|l| l.channel_names());
        let further = further.map(|(name, is_index)| ((*name).to_owned(), *is_index));
        rgb.into_iter().chain(alpha).chain(further).collect()
    }

    pub(super) fn write(
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
                Shows::Display | Shows::Jpeg(_) => {
                    Rows::Srgb(display_rows(&band.radiance, self.exposure_ev, self.tone_map))
                }
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

/// Darkens a band where it is covered by lines.
pub(super) fn drawn(mut band: Band, lines: &[f32]) -> Band {
    let first = band.first_row as usize * band.view.size[0] as usize;
    for (i, covered) in lines.iter().skip(first).take(band.radiance.len()).enumerate() {
        band.radiance[i] *= 1.0 - covered;
        band.coverage[i] = band.coverage[i].max(*covered);
    }
    band
}

impl MadePicture {
    pub(super) fn finish(files: Vec<PictureFile>, stats: FrameStats) -> Result<Self, SaveError> {
        let paths = files.into_iter().map(|file| file.finish(stats.is_complete)).collect::<Result<_, _>>()?;
        Ok(Self { paths, stats })
    }
}
