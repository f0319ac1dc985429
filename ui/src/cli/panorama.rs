//! `render --projection equirectangular|orthographic`: renders a panorama, plan or elevation.

use super::flags::Flags;
use super::pose::camera;
use super::projection::{Projection, ProjectionArgs};
use super::scene::{Loaded, load};
use super::{failure::Failure, interrupt, output, progress::SharedProgress};
use crate::picture::memory;
use crate::picture::panorama::{OtherProjection, PanoramaJob, PanoramaOutput, looked_up_points};
use afterimage::raster::exposure::decimal;
use afterimage::raster::save::Target;
use afterimage::render::orthographic::fitting_width_m;
use afterimage::render::panorama::{Panorama, PanoramaStats};
use afterimage::{Camera, Mode};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Size of a panorama in pixels where none is given: 11 pixels a degree.
const DEFAULT_SIZE: [u32; 2] = [4096, 2048];

/// A panorama as the command line describes it.
#[derive(Clone, Copy, Debug)]
pub(super) struct PanoramaRun<'a> {
    /// A model or builtin:NAME; `None` for the embedded gallery.
    pub(super) scene: Option<&'a str>,
    /// Picture to write: .png or .exr.
    pub(super) output: &'a Path,
    /// Linear radiance in addition to the picture.
    pub(super) linear: Option<&'a PathBuf>,
    /// Rays through different points of each pixel, all traced in full.
    pub(super) antialias: Option<u32>,
    /// Projection, and the width of an orthographic picture.
    pub(super) projection: &'a ProjectionArgs,
}

impl PanoramaRun<'_> {
    /// Renders the panorama and writes its files.
    pub(super) fn run(&self, flags: &Flags) -> Result<(), Failure> {
        let size = if self.is_panorama() { flags.given_size.unwrap_or(DEFAULT_SIZE) } else { flags.size() };
        self.check(flags, size)?;
        let loaded = load(self.scene, flags)?;
        let flags = &Flags { given_size: Some(size), ..loaded.expose(flags)? };
        let job = self.job(flags, &loaded)?;
        let progress = SharedProgress::new("rendering");
        let (stop, note) = (interrupt::is_cancelled, |part| progress.at(part));
        let (_, stats) = job.make(&loaded.tracer, &self.outputs(), &stop, &note)?;
        drop(progress);
        loaded.say_bounds();
        output::result(flags.json, &self.object(flags, &loaded, &job, &stats), || self.table(&job, &stats));
        if stats.is_complete { loaded.verdict(flags) } else { Err(Failure::Interrupted) }
    }

    fn is_panorama(&self) -> bool {
        self.projection.projection == Projection::Equirectangular
    }

    /// Checks size and mode before the scene is loaded.
    fn check(&self, flags: &Flags, size: [u32; 2]) -> Result<(), Failure> {
        if flags.mode == Mode::Paper {
            let message =
                "mode paper reprojects pinhole pictures, which this is not; use exact, fast or full";
            return Err(Failure::Usage(message.to_owned()));
        }
        if self.is_panorama() {
            let is_fit = self.projection.width.is_none();
            let message = || Failure::Usage("--width is for --projection orthographic".to_owned());
            is_fit.then_some(()).ok_or_else(message)?;
            return Panorama::check(size).map_err(|error| Failure::Usage(error.to_string()));
        }
        Ok(memory::check_banded(size.map(u64::from).iter().product())?)
    }

    /// The projection, and the camera: one that looks straight down or up has the model's -Z at the
    /// top of a plan.
    fn projected(&self, flags: &Flags, loaded: &Loaded) -> Result<(OtherProjection, Camera), Failure> {
        let camera = camera(flags, loaded.scene())?;
        if self.is_panorama() {
            return Ok((OtherProjection::Equirectangular, camera));
        }
        let is_plan = camera.pitch.cos() < 1e-6 && flags.look_at.is_some();
        let camera = if is_plan { Camera { yaw: 0.0, ..camera } } else { camera };
        let bounds = || fitting_width_m(&camera, flags.size(), loaded.scene().building_m);
        let width_m = self.projection.width.unwrap_or_else(bounds);
        Ok((OtherProjection::Orthographic { width_m }, camera))
    }

    fn job(&self, flags: &Flags, loaded: &Loaded) -> Result<PanoramaJob, Failure> {
        let (projection, camera) = self.projected(flags, loaded)?;
        let is_traced = flags.mode == Mode::Full || !self.is_panorama();
        let default = if is_traced { 1 } else { looked_up_points(flags.size()) };
        Ok(PanoramaJob {
            projection,
            scene_name: loaded.name.clone(),
            camera,
            size: flags.size(),
            settings: flags.render(),
            points: self.antialias.unwrap_or(default),
            exposure_ev: flags.exposure_ev(),
            tone_map: flags.tone_map,
            document: None,
        })
    }

    fn outputs(&self) -> Vec<PanoramaOutput> {
        let is_linear = |path: &Path| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"));
        let to = |path: &Path| PanoramaOutput {
            target: Target::File(path.to_owned()),
            is_linear: is_linear(path),
        };
        std::iter::once(self.output).chain(self.linear.map(PathBuf::as_path)).map(to).collect()
    }

    fn object(&self, flags: &Flags, loaded: &Loaded, job: &PanoramaJob, stats: &PanoramaStats) -> Value {
        json!({
            "scene": loaded.name,
            "projection": if self.is_panorama() { "equirectangular" } else { "orthographic" },
            "mode": flags.mode.name(),
            "size": flags.size(),
            "samples": flags.trace().samples,
            "antialias": self.antialias,
            "points": job.points,
            "bounces": flags.trace().bounce_limit(),
            "seed": flags.seed,
            "exposure_ev": decimal(flags.exposure_ev()),
            "threads": rayon::current_num_threads(),
            "is_complete": stats.is_complete,
            "secs": {
                "load": loaded.load_secs,
                "build": loaded.tracer.build_secs(),
                "references": stats.reference_secs,
                "frame": stats.secs - stats.reference_secs,
                "all": stats.secs,
            },
            "rays_with_references": stats.rays,
        })
    }

    fn table(&self, job: &PanoramaJob, stats: &PanoramaStats) -> String {
        let [w, h] = job.size;
        output::table(&[
            ("picture", format!("{}, {w}x{h}", self.output.display())),
            ("references", format!("{:.1} s", stats.reference_secs)),
            ("time", format!("{:.1} s", stats.secs)),
            ("rays", format!("{}", stats.rays.total())),
        ])
    }
}
