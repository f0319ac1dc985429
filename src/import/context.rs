//! The context of one import, shared by the readers of all formats.

use super::files::{Jail, unreadable};
use super::progress::{Phase, Steps};
use super::units::{self, Unit, Up};
use super::{options::ImportOptions, search::Finder, sidecar::Sidecar, tally::Tally};
use crate::scene::{Scene, SceneBuilder, SceneError, SourceFile};
use std::path::{Path, PathBuf};

/// What to do about a file that has content but nothing to show.
const CORRECT: &str = "correct the file or export it again";

/// One import in progress. A reader fills `builder`; everything else serves it.
pub(super) struct Import<'a> {
    /// Path of the model as the user gave it, for messages.
    pub(super) path: &'a Path,
    /// Canonical path of the model.
    pub(super) file: PathBuf,
    /// File name of the model with its extension: name of the scene, and of the file in warnings
    /// about the model.
    pub(super) name: String,
    pub(super) options: &'a ImportOptions,
    pub(super) steps: Steps<'a>,
    pub(super) sidecar: Sidecar,
    pub(super) finder: Finder,
    pub(super) builder: SceneBuilder,
    /// Names of materials that the model defines but may not use. The sidecar may override
    /// them too.
    pub(super) defined_materials: Vec<String>,
}

impl<'a> Import<'a> {
    pub(super) fn new(
        path: &'a Path,
        options: &'a ImportOptions,
        steps: Steps<'a>,
    ) -> Result<Self, SceneError> {
        let file = path.canonicalize().map_err(|e| unreadable(path, e.to_string(), "check the path"))?;
        if file.is_dir() {
            return Err(unreadable(path, "this is a folder", "name the model file in it"));
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let mut builder = SceneBuilder::new(&name);
        // Before they are read: what changes meanwhile has another stamp afterwards.
        let own = [path, &path.with_extension("afterimage.toml")];
        builder.files.extend(own.map(SourceFile::now));
        let sidecar = Sidecar::of_model(path, &mut builder);
        let folder = file.parent().unwrap_or(Path::new("")).to_owned();
        let finder = Finder::new(Jail { folder, allow_outside: options.allow_outside });
        Ok(Self { path, file, name, options, steps, sidecar, finder, builder, defined_materials: Vec::new() })
    }

    /// Returns the unit that the user or the sidecar gives.
    pub(super) fn unit(&self) -> Option<Unit> {
        self.options.unit.or(self.sidecar.unit)
    }

    /// Returns the up axis that the user or the sidecar gives.
    pub(super) fn up(&self) -> Option<Up> {
        self.options.up.or(self.sidecar.up)
    }

    /// Warns where the model seems to lie on its side and no option or sidecar says which axis is
    /// up. It is not turned: a slab of a building has the shape of a hall that lies on its side.
    pub(super) fn hint_up(&mut self) {
        if self.up().is_none() && units::looks_z_up(&self.builder.positions, &self.builder.triangles) {
            let file = &self.sidecar.file_name;
            self.warn(format!(
                "the model seems to lie on its side; if so, use --up +Z, or up = \"+Z\" in {file}"
            ));
        }
    }

    /// Adds a warning about the model as a whole.
    pub(super) fn warn(&mut self, message: impl Into<String>) {
        self.builder.warn(&self.name, 0, message);
    }

    /// Returns an error about the model as a whole.
    pub(super) fn failed(&self, cause: impl Into<String>, remedy: impl Into<String>) -> SceneError {
        unreadable(self.path, cause, remedy)
    }

    /// Adds the troubles of the model to the warnings. Where no triangle was made, the first of
    /// them is the error.
    pub(super) fn report(&mut self, troubles: Tally) -> Result<(), SceneError> {
        let troubles = troubles.warnings(&self.name);
        if !self.builder.triangles.is_empty() {
            self.builder.warnings.extend(troubles);
            return Ok(());
        }
        let Some(first) = troubles.into_iter().next() else {
            return Err(self.failed("it holds no faces", "check that the model is complete"));
        };
        let cause = format!("no face is left to show: {}", first.message);
        Err(match first.line {
            0 => self.failed(cause, CORRECT),
            line => SceneError::Line { file: self.path.to_owned(), line, cause, remedy: CORRECT.to_owned() },
        })
    }

    /// Applies the sidecar, and makes the scene.
    pub(super) fn finish(self) -> Result<Scene, SceneError> {
        let Self { path, steps, mut sidecar, mut finder, mut builder, defined_materials, .. } = self;
        sidecar.override_materials(&defined_materials, &mut builder);
        sidecar.apply(&mut finder, &mut builder);
        builder.add_daylight_to_weak_lamps();
        steps.at(Phase::Building, 1.0)?;
        builder.files.extend(finder.into_files());
        let scene = builder.finish().map_err(|error| match error {
            SceneError::Empty { cause, .. } => unreadable(path, cause, CORRECT),
            other => other,
        })?;
        Ok(sidecar.edit_objects(scene))
    }
}
