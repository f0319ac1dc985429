//! Loads the scene that is named on the command line.

use super::{failure::Failure, flags::Flags, interrupt, output, progress::SharedProgress};
use afterimage::import::{ImportOptions, Phase};
use afterimage::raster::exposure::{Exposure, Metered};
use afterimage::scene::{SceneError, Warning, builtin};
use afterimage::{Scene, Tracer, import};
use serde_json::{Value, json};
use std::{path::Path, sync::Arc, time::Instant};

/// A loaded scene.
#[derive(Debug)]
pub(crate) struct Loaded {
    /// Name of the scene as given by the user.
    pub(crate) name: String,
    /// Tracer of the scene, with its bounding volume hierarchy.
    pub(crate) tracer: Arc<Tracer>,
    /// Time in seconds to import or generate the scene, without its hierarchy.
    pub(crate) load_secs: f64,
}

impl Loaded {
    /// The scene.
    pub(crate) fn scene(&self) -> &Arc<Scene> {
        self.tracer.scene()
    }

    /// Returns the flags with a number of stops as exposure: the one given, else that of the scene.
    /// The automatic one measures the light in the scene.
    pub(crate) fn expose(&self, flags: &Flags) -> Result<Flags, Failure> {
        let exposure = flags.exposure.unwrap_or(self.scene().exposure);
        if exposure == Exposure::Auto {
            let progress = SharedProgress::new("measuring the light");
            if !self.tracer.measure_light(&|part| progress.at(part.into()), &interrupt::is_cancelled) {
                return Err(Failure::Interrupted);
            }
        }
        if self.tracer.metered() == Some(Metered::Dark) {
            output::say(&format!(
                "{}: no light was found; the automatic exposure is 0 EV, and --exposure sets another",
                self.name
            ));
        }
        let stops = self.tracer.stops(exposure).unwrap_or_default();
        Ok(Flags { exposure: Some(Exposure::Stops(stops)), ..flags.clone() })
    }

    /// Statistics of the light grid: how many of the scene's lights are sampled in the cells shaded
    /// so far.
    pub(crate) fn light_cuts(&self) -> Value {
        let cuts = self.tracer.light_grid().cuts();
        json!({
            "lights": cuts.lights, "cells": cuts.cells, "kept_mean": cuts.kept_mean,
            "sharing_cells": cuts.sharing_cells,
        })
    }

    /// Says on stderr what was bounded to render pictures of the scene.
    pub(crate) fn say_bounds(&self) {
        let cuts = self.tracer.light_grid().cuts();
        if cuts.sharing_cells > 0 {
            output::say(&format!(
                "note: in {} of the {} places shaded, more than 64 of the scene's {} lights matter; there they share \
                 16 rays for each sample, and --samples raises them",
                cuts.sharing_cells, cuts.cells, cuts.lights
            ));
        }
    }

    /// Result of a command that succeeded: with `--strict`, a scene with warnings is a failure.
    pub(crate) fn verdict(&self, flags: &Flags) -> Result<(), Failure> {
        match self.scene().warnings.len() {
            n if n > 0 && flags.strict => Err(Failure::Warnings(n)),
            _ => Ok(()),
        }
    }
}

/// Name of the scene that is used if none is given.
pub(crate) fn default_name() -> String {
    format!("builtin:{}", builtin::NAMES[0])
}

/// Loads a scene, builds its hierarchy, and reports its first warnings on stderr.
pub(crate) fn load(name: Option<&str>, flags: &Flags) -> Result<Loaded, Failure> {
    let name = name.map_or_else(default_name, str::to_owned);
    let start = Instant::now();
    let scene = match name.strip_prefix("builtin:") {
        Some(builtin) => builtin::build(builtin),
        None => import(Path::new(&name), flags),
    }?;
    let scene = flags.daylight().map_err(Failure::Usage)?.apply(scene);
    let load_secs = start.elapsed().as_secs_f64();
    report(&scene);
    let tracer = Arc::new(Tracer::new(Arc::new(scene)).with_start_view());
    if interrupt::is_cancelled() { Err(Failure::Interrupted) } else { Ok(Loaded { name, tracer, load_secs }) }
}

/// Maximum number of warnings that are printed; `inspect` lists all of them.
const WARNINGS_SHOWN: usize = 5;

fn report(scene: &Scene) {
    for w in scene.warnings.iter().take(WARNINGS_SHOWN) {
        output::say(&format!("warning: {}{}", place(w), w.message));
    }
    if let Some(more) = scene.warnings.len().checked_sub(WARNINGS_SHOWN).filter(|n| *n > 0) {
        output::say(&format!("and {more} more warnings; 'afterimage inspect' lists them"));
    }
}

/// File and line of a warning as a prefix of its message, as far as they are known.
pub(super) fn place(warning: &Warning) -> String {
    match (warning.file.as_str(), warning.line) {
        ("", _) => String::new(),
        (file, 0) => format!("{file}: "),
        (file, line) => format!("{file}, line {line}: "),
    }
}

/// Import options that the flags give.
pub(crate) fn import_options(flags: &Flags) -> ImportOptions {
    ImportOptions {
        unit: flags.unit,
        up: flags.up,
        allow_outside: flags.allow_outside,
        ..ImportOptions::default()
    }
}

fn import(path: &Path, flags: &Flags) -> Result<Scene, SceneError> {
    let progress = SharedProgress::new("loading");
    import::load(path, &import_options(flags), &|phase: Phase, part| {
        progress.note(f64::from(part), phase.label());
        !interrupt::is_cancelled()
    })
}
