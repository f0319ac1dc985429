//! From a scene's name on the command line to a scene that can be traced.

use super::failure::Failure;
use super::flags::Flags;
use super::progress::SharedProgress;
use super::{interrupt, output};
use afterimage::import;
use afterimage::import::{ImportOptions, Phase};
use afterimage::scene::{SceneError, Warning, builtin};
use afterimage::{Scene, Tracer};
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// A scene, ready to be traced.
#[derive(Debug)]
pub(crate) struct Loaded {
    /// As it was asked for.
    pub(crate) name: String,
    /// The scene with its hierarchy.
    pub(crate) tracer: Arc<Tracer>,
    /// Reading or making the scene, the hierarchy left out.
    pub(crate) load_secs: f64,
}

impl Loaded {
    /// The scene.
    pub(crate) fn scene(&self) -> &Arc<Scene> {
        self.tracer.scene()
    }

    /// How many of the scene's lights are sampled where something was shaded so far.
    pub(crate) fn light_cuts(&self) -> Value {
        let cuts = self.tracer.light_grid().cuts();
        json!({"lights": cuts.lights, "cells": cuts.cells, "kept_mean": cuts.kept_mean})
    }

    /// The end of a command that worked: under `--strict` the scene's warnings make it one that did not.
    pub(crate) fn verdict(&self, flags: &Flags) -> Result<(), Failure> {
        match self.scene().warnings.len() {
            n if n > 0 && flags.strict => Err(Failure::Warnings(n)),
            _ => Ok(()),
        }
    }
}

/// What is shown when no scene is named.
pub(crate) fn default_name() -> String {
    format!("builtin:{}", builtin::NAMES[0])
}

/// Loads a scene and builds its hierarchy; says on stderr what is doubtful in it.
pub(crate) fn load(name: Option<&str>, flags: &Flags) -> Result<Loaded, Failure> {
    let name = name.map_or_else(default_name, str::to_owned);
    let start = Instant::now();
    let scene = match name.strip_prefix("builtin:") {
        Some(builtin) => builtin::build(builtin),
        None => import(Path::new(&name), flags),
    }?;
    let load_secs = start.elapsed().as_secs_f64();
    report(&scene);
    let tracer = Arc::new(Tracer::new(Arc::new(scene)).beginning_indoors());
    if interrupt::is_cancelled() { Err(Failure::Interrupted) } else { Ok(Loaded { name, tracer, load_secs }) }
}

/// Warnings shown before the rest is only counted; `inspect` has them all.
const WARNINGS_SHOWN: usize = 5;

fn report(scene: &Scene) {
    for w in scene.warnings.iter().take(WARNINGS_SHOWN) {
        output::say(&format!("warning: {}{}", place(w), w.message));
    }
    if let Some(more) = scene.warnings.len().checked_sub(WARNINGS_SHOWN).filter(|n| *n > 0) {
        output::say(&format!("and {more} more warnings; 'afterimage inspect' lists them"));
    }
}

/// Where a warning comes from, as far as it is known.
pub(super) fn place(warning: &Warning) -> String {
    match (warning.file.as_str(), warning.line) {
        ("", _) => String::new(),
        (file, 0) => format!("{file}: "),
        (file, line) => format!("{file}, line {line}: "),
    }
}

/// How the flags say that a model is to be read.
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
