//! `render --projection equirectangular`: renders a panorama.

use super::flags::Flags;
use super::pose::camera;
use super::scene::{Loaded, load};
use super::{failure::Failure, interrupt, output, progress::SharedProgress};
use crate::picture::panorama::{LOOKED_UP_POINTS, PanoramaJob, PanoramaOutput};
use afterimage::Mode;
use afterimage::raster::exposure::decimal;
use afterimage::raster::save::Target;
use afterimage::render::panorama::{Panorama, PanoramaStats};
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
}

impl PanoramaRun<'_> {
    /// Renders the panorama and writes its files.
    pub(super) fn run(&self, flags: &Flags) -> Result<(), Failure> {
        let size = flags.given_size.unwrap_or(DEFAULT_SIZE);
        Panorama::check(size).map_err(|error| Failure::Usage(error.to_string()))?;
        if flags.mode == Mode::Paper {
            let message =
                "mode paper reprojects pinhole pictures, which a panorama is not; use exact, fast or full";
            return Err(Failure::Usage(message.to_owned()));
        }
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

    fn job(&self, flags: &Flags, loaded: &Loaded) -> Result<PanoramaJob, Failure> {
        let default = if flags.mode == Mode::Full { 1 } else { LOOKED_UP_POINTS };
        Ok(PanoramaJob {
            scene_name: loaded.name.clone(),
            camera: camera(flags, loaded.scene())?,
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
            "projection": "equirectangular",
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
            ("panorama", format!("{}, {w}x{h}", self.output.display())),
            ("references", format!("{:.1} s", stats.reference_secs)),
            ("time", format!("{:.1} s", stats.secs)),
            ("rays", format!("{}", stats.rays.total())),
        ])
    }
}
