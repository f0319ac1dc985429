//! Renders panoramas and orthographic pictures, which are no pinhole views, and writes their files.

use super::metadata::{PictureOrigin, metadata};
use afterimage::raster::color::ToneMap;
use afterimage::raster::save::{Channel, SaveError, Target};
use afterimage::raster::stream::{Contents, PictureFile, Rows};
use afterimage::render::RefineState;
use afterimage::render::aov::display_rows;
use afterimage::render::bands::Background;
use afterimage::render::orthographic::OrthographicPicture;
use afterimage::render::panorama::{Panorama, PanoramaBand, PanoramaStats};
use afterimage::trace::parallel::Stop;
use afterimage::{Camera, RenderSettings, Tracer};
use std::{path::PathBuf, sync::Arc};

/// Points of each pixel of a panorama where light is looked up: up to four, so that edges are
/// smooth, and fewer in large ones, of which a screen shows several pixels as one.
pub fn looked_up_points([width, _]: [u32; 2]) -> u32 {
    (8192 / width.max(1)).clamp(1, 4)
}

/// How directions or places become points of a picture, other than by a pinhole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OtherProjection {
    /// All directions around the eye: columns are longitudes, rows are latitudes.
    Equirectangular,
    /// Parallel rays, of which the picture shows this width in metres. All are traced in full.
    Orthographic {
        /// Width of what the picture shows, metres.
        width_m: f64,
    },
}

/// A panorama or an orthographic picture to render, from an eye and with settings.
#[derive(Clone, Debug)]
pub struct PanoramaJob {
    /// How the picture is projected.
    pub projection: OtherProjection,
    /// Name of the scene as given by the user.
    pub scene_name: String,
    /// The eye, and the heading of the middle of the picture.
    pub camera: Camera,
    /// Width and height in pixels; the width is twice the height.
    pub size: [u32; 2],
    /// Mode, samples, bounces and seed.
    pub settings: RenderSettings,
    /// Points of each pixel that are sampled.
    pub points: u32,
    /// Exposure in stops: radiance is multiplied by two to this power.
    pub exposure_ev: f32,
    /// Tone map from radiance to display.
    pub tone_map: ToneMap,
    /// Session that a reader needs to show the scene with its changes; `None` where there are
    /// none.
    pub document: Option<Arc<str>>,
}

/// A file of a panorama.
#[derive(Clone, Debug)]
pub struct PanoramaOutput {
    /// Path of the file, or the folder and stem from which its name is made.
    pub target: Target,
    /// True for linear radiance in OpenEXR, false for the tone-mapped picture in PNG.
    pub is_linear: bool,
}

impl PanoramaJob {
    /// Renders the panorama and writes its files. `progress` is called, perhaps from several
    /// threads, with the finished part, 0..1. If it is stopped, the files contain the finished rows
    /// and are marked as incomplete.
    ///
    /// # Errors
    /// [`SaveError`] of the first file that cannot be written; then no file is left.
    pub fn make(
        &self,
        tracer: &Tracer,
        outputs: &[PanoramaOutput],
        stop: Stop<'_>,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<(Vec<PathBuf>, PanoramaStats), SaveError> {
        let (files, stats) = self.render(tracer, outputs, stop, progress)?;
        let paths = files.into_iter().map(|file| file.finish(stats.is_complete)).collect::<Result<_, _>>()?;
        Ok((paths, stats))
    }

    /// Like [`Self::make`], but returns `None` and leaves no files if it is stopped.
    ///
    /// # Errors
    /// As [`Self::make`].
    pub fn make_whole(
        &self,
        tracer: &Tracer,
        outputs: &[PanoramaOutput],
        stop: Stop<'_>,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Option<Vec<PathBuf>>, SaveError> {
        let (files, stats) = self.render(tracer, outputs, stop, progress)?;
        if !stats.is_complete {
            return Ok(None);
        }
        files.into_iter().map(|file| file.finish(true)).collect::<Result<_, _>>().map(Some)
    }

    fn render(
        &self,
        tracer: &Tracer,
        outputs: &[PanoramaOutput],
        stop: Stop<'_>,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<(Vec<PictureFile>, PanoramaStats), SaveError> {
        let notes = self.notes(tracer);
        let begin = |output: &PanoramaOutput| self.begin(output, &notes);
        let mut files = outputs.iter().map(begin).collect::<Result<Vec<_>, _>>()?;
        let mut write = |band: PanoramaBand| {
            for (output, file) in outputs.iter().zip(&mut files) {
                file.write(self.rows(output, &band))?;
            }
            Ok::<(), SaveError>(())
        };
        let stats = match self.projection {
            OtherProjection::Equirectangular => self.panorama(tracer).render(stop, progress, &mut write),
            OtherProjection::Orthographic { width_m } => {
                let Self { camera, size, settings, points, .. } = self;
                let (size, trace, points) = (*size, &settings.trace, *points);
                OrthographicPicture { tracer, camera, size, width_m, trace, points }
                    .render(stop, progress, &mut write)
            }
        }?;
        Ok((files, stats))
    }

    /// What the engine renders.
    pub fn panorama<'a>(&'a self, tracer: &'a Tracer) -> Panorama<'a> {
        let Self { camera, size, settings, points, .. } = self;
        Panorama { tracer, camera, size: *size, settings, points: *points }
    }

    fn begin(
        &self,
        output: &PanoramaOutput,
        notes: &[(&'static str, String)],
    ) -> Result<PictureFile, SaveError> {
        let target = output.target.clone();
        if output.is_linear {
            let channels = ["R", "G", "B"].map(|name| (name.to_owned(), false)).into();
            return PictureFile::begin(target, Contents::Exr(channels), self.size, notes);
        }
        let is_panorama = self.projection == OtherProjection::Equirectangular;
        let xmp = is_panorama.then(|| ("XML:com.adobe.xmp", photo_sphere(self.size)));
        let notes: Vec<_> = notes.iter().cloned().chain(xmp).collect();
        PictureFile::begin(target, Contents::Png, self.size, &notes)
    }

    fn rows(&self, output: &PanoramaOutput, band: &PanoramaBand) -> Rows {
        match output.is_linear {
            true => Rows::Channels(Channel::rgb(&band.radiance).into_iter().map(|c| c.values).collect()),
            false => Rows::Srgb(display_rows(&band.radiance, self.exposure_ev, self.tone_map)),
        }
    }

    fn notes(&self, tracer: &Tracer) -> Vec<(&'static str, String)> {
        let mut notes = metadata(&PictureOrigin {
            scene_name: &self.scene_name,
            scene: tracer.scene(),
            camera: &self.camera,
            size: self.size,
            settings: &self.settings,
            refined: RefineState::default(),
            background: Background::Shown,
            exposure_ev: self.exposure_ev,
            tone_map: self.tone_map,
            document: self.document.as_deref(),
            section: &[],
            outlines: None,
        });
        notes.retain(|(name, _)| *name != "Refined");
        if let Some((_, settings)) = notes.iter_mut().find(|(name, _)| *name == "Settings") {
            *settings += &match self.projection {
                OtherProjection::Equirectangular => " --projection equirectangular".to_owned(),
                OtherProjection::Orthographic { width_m } => {
                    format!(" --projection orthographic --width {width_m}")
                }
            };
        }
        notes
    }
}

/// Metadata by which viewers recognise a panorama of all directions.
///
/// Source: Google, "Photo Sphere XMP Metadata".
pub(crate) fn photo_sphere([width, height]: [u32; 2]) -> String {
    let fields = [
        ("ProjectionType", "equirectangular".to_owned()),
        ("UsePanoramaViewer", "True".to_owned()),
        ("CroppedAreaImageWidthPixels", width.to_string()),
        ("CroppedAreaImageHeightPixels", height.to_string()),
        ("FullPanoWidthPixels", width.to_string()),
        ("FullPanoHeightPixels", height.to_string()),
        ("CroppedAreaLeftPixels", "0".to_owned()),
        ("CroppedAreaTopPixels", "0".to_owned()),
    ];
    let fields: String = fields.iter().map(|(name, value)| format!("\n  GPano:{name}=\"{value}\"")).collect();
    format!(
        "<?xpacket begin=\"\u{feff}\" id=\"W5M0MpCehiHzreSzNTczkc9d\"?>\n\
         <x:xmpmeta xmlns:x=\"adobe:ns:meta/\">\n\
         <rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">\n\
         <rdf:Description rdf:about=\"\"\n  xmlns:GPano=\"http://ns.google.com/photos/1.0/panorama/\"{fields}/>\n\
         </rdf:RDF>\n</x:xmpmeta>\n<?xpacket end=\"r\"?>"
    )
}
