//! The file format of sessions: scene, pose, the whole document and the settings. Keys that this
//! version does not know are kept when the session is saved again.

use super::sun::SunTable;
use crate::settings;
use crate::window::rendering::SceneSource;
use crate::window::state::{AppState, Document, Quality, SavedView, SectionView, SunControls};
use afterimage::camera::CameraPath;
use afterimage::import::{AppliedEdit, EditFolder, ImportOptions, Unit, Up, apply_edit_text, edit_text};
use afterimage::raster::exposure::Exposure;
use afterimage::reference::PlacementPolicy;
use afterimage::scene::{Daylight, Scene, SceneEdit, Sky, SkyKind};
use afterimage::trace::BounceLimit;
use afterimage::{Camera, Mode};
use anyhow::{Context, anyhow, bail, ensure};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use toml::Table;

/// Extension of session files.
pub(in crate::window::app) const EXTENSION: &str = "afterimage-session.toml";

/// Version of the format that is written. Older ones are read.
const VERSION: i64 = 2;

/// Maximum number of views, and of measured distances, in a file.
const MAX_ENTRIES: usize = 10_000;

/// Maximum number of keys of a path: a walk of a day at ten poses a second.
const MAX_KEYS: usize = 1_000_000;

/// Maximum number of samples of a pixel that is restored: a frame with more would not end.
const MAX_SAMPLES: u32 = 1 << 16;

/// Content of a session file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::window::app) struct SessionFile {
    version: i64,
    /// Scene of the session: `builtin:NAME`, or a path relative to the folder of the session.
    scene: String,
    /// Unit and upward axis of the model, where they were given by hand: its files may not say
    /// them.
    #[serde(default)]
    unit: Option<String>,
    #[serde(default)]
    up: Option<String>,
    /// File of the session, in one that is kept in case of a crash.
    #[serde(default)]
    session: Option<PathBuf>,
    mode: Mode,
    samples: u32,
    bounces: BounceLimit,
    #[serde(alias = "exposure_ev")]
    exposure: Exposure,
    tone_map: String,
    render_scale: Option<f32>,
    budget_ms: Option<f32>,
    keep_improving: Option<bool>,
    /// Name and threshold of the rule that places references.
    #[serde(default)]
    placement: Option<(String, f64)>,
    #[serde(default)]
    max_references: Option<usize>,
    #[serde(default)]
    cache_mb: Option<usize>,
    /// Distances that were measured, by their ends in world metres.
    #[serde(default)]
    measures: Vec<[DVec3; 2]>,
    camera: Camera,
    section: Option<SectionView>,
    #[serde(default)]
    views: Vec<View>,
    /// Camera path, where the user has set its keys.
    path: Option<CameraPath>,
    sun: Option<SunTable>,
    /// Materials, objects and light that differ from the files of the model, as in a sidecar.
    edits: Option<Table>,
    /// Keys that other versions of the program have written.
    #[serde(flatten)]
    other: Table,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct View {
    name: String,
    #[serde(default)]
    key: Option<u8>,
    camera: Camera,
}

/// True for the names of session files.
pub(in crate::window::app) fn is_session(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().ends_with(&format!(".{EXTENSION}")))
}

fn options_of(source: &SceneSource) -> Option<&ImportOptions> {
    match source {
        SceneSource::File { options, .. } => Some(options),
        _ => None,
    }
}

/// Returns the path of the model of a scene; `None` where it has no file.
fn model_of(source: &SceneSource) -> Option<&Path> {
    match source {
        SceneSource::File { path, .. } => Some(path),
        _ => None,
    }
}

impl SessionFile {
    /// The session of the state that is shown. `other` has the unknown keys of the session that was
    /// loaded.
    ///
    /// # Errors
    /// A message for the user, where there is no scene, or a change cannot be written.
    pub(in crate::window::app) fn of(state: &AppState, other: &Table) -> anyhow::Result<Self> {
        let edits = Self::edits_of(state, true)?;
        Self::with_edits(state, other, edits)
    }

    /// The session as a picture holds it: without views, path and measures. `None` where the scene
    /// is as the files of the model have it, or a change cannot be written.
    pub(in crate::window::app) fn note_of(state: &AppState) -> Option<String> {
        state.document.as_ref().filter(|document| document.differs_from_files())?;
        let session = Self::with_edits(state, &Table::new(), Self::edits_of(state, false).ok()?).ok()?;
        Self { views: Vec::new(), path: None, measures: Vec::new(), ..session }.text(None).ok()
    }

    fn edits_of(state: &AppState, allow_outside: bool) -> anyhow::Result<Table> {
        let none = "there is no scene to save a session of";
        let (document, scene) = (state.document.as_ref().context(none)?, state.scene.as_ref().context(none)?);
        let folder = EditFolder { model: model_of(&scene.source), allow_outside };
        let text = edit_text(folder, &document.files().scene, document.scene());
        text.map_err(|cause| anyhow!("the session cannot be written: {cause}"))?
            .parse()
            .context("the session")
    }

    fn with_edits(state: &AppState, other: &Table, edits: Table) -> anyhow::Result<Self> {
        let (document, scene) = state.document.as_ref().zip(state.scene.as_ref()).context("no scene")?;
        let quality = &state.quality;
        let view = |v: &SavedView| View { name: v.name.clone(), key: v.key, camera: v.camera };
        let (walk, render, now) = (&quality.walk, &quality.walk.render, document.now());
        Ok(Self {
            version: VERSION,
            scene: absolute(&scene.source),
            unit: options_of(&scene.source).and_then(|o| o.unit).map(|unit| unit.name().to_owned()),
            up: options_of(&scene.source).and_then(|o| o.up).map(|up| up.name().to_owned()),
            session: None,
            mode: render.mode,
            samples: render.trace.samples,
            bounces: render.trace.bounce_limit(),
            exposure: quality.exposure,
            tone_map: quality.tone_map.name().to_owned(),
            render_scale: Some(quality.render_scale),
            budget_ms: Some(quality.budget_ms),
            keep_improving: Some(quality.keeps_improving),
            placement: Some((walk.placement.rule.name.to_owned(), walk.placement.percent)),
            max_references: Some(walk.max_references),
            cache_mb: Some(walk.cache_bytes >> 20),
            measures: now.measures.clone(),
            camera: *state.navigation.fly.camera(),
            section: now.section,
            views: now.views.iter().map(view).collect(),
            path: now.path.clone(),
            sun: Some(SunTable::of(&now.sun)),
            edits: Some(edits).filter(|edits| !edits.is_empty()),
            other: other.clone(),
        })
    }

    /// Returns this session with a note of the file that it is saved in otherwise.
    pub(in crate::window::app) fn kept_for(mut self, file: Option<&Path>) -> Self {
        self.session = file.map(|file| std::path::absolute(file).unwrap_or_else(|_| file.to_owned()));
        self
    }

    /// Returns the file that the session is saved in otherwise.
    pub(in crate::window::app) fn own_file(&self) -> Option<PathBuf> {
        self.session.clone()
    }

    /// Returns the text of the file. The path of the model is relative to `folder` where it lies
    /// there or below.
    ///
    /// # Errors
    /// A message for the user, where a value cannot be written as TOML.
    pub(in crate::window::app) fn text(&self, folder: Option<&Path>) -> anyhow::Result<String> {
        let folder = folder.map(|folder| if folder.as_os_str().is_empty() { Path::new(".") } else { folder });
        let relative = folder.filter(|_| !self.scene.starts_with("builtin:")).and_then(|folder| {
            let (folder, model) = (folder.canonicalize().ok()?, Path::new(&self.scene).canonicalize().ok()?);
            let parts: Option<Vec<&str>> =
                model.strip_prefix(folder).ok()?.iter().map(|part| part.to_str()).collect();
            Some(parts?.join("/"))
        });
        let written = Self { scene: relative.unwrap_or_else(|| self.scene.clone()), ..self.clone() };
        toml::to_string(&written).context("the session cannot be written")
    }

    /// Reads the text of the file `path`.
    ///
    /// # Errors
    /// A message for the user, with file and line.
    pub(in crate::window::app) fn parse(text: &str, path: &Path) -> anyhow::Result<Self> {
        let name = path.display();
        let broken = |error| anyhow!(settings::broken(path, text, &error));
        let table: Table = text.parse().map_err(broken)?;
        match table.get("version").and_then(toml::Value::as_integer) {
            Some(1..=VERSION) => {}
            Some(newer) if newer > VERSION => {
                bail!(
                    "{name} was saved by a newer program (version {newer} of the format, this one reads {VERSION}); \
                     use that program, or save the session again"
                );
            }
            _ => {
                bail!("{name} is not a session of this program: it has no known version");
            }
        }
        let session: Self = toml::from_str(text).map_err(broken)?;
        session.check().map_err(|cause| anyhow!("{name}: {cause}"))?;
        Ok(session)
    }

    fn check(&self) -> anyhow::Result<()> {
        let cameras = self.views.iter().map(|v| &v.camera).chain([&self.camera]);
        let is_valid = cameras.into_iter().all(Camera::is_valid) && !self.scene.is_empty();
        ensure!(is_valid, "a pose in it is impossible, or it names no scene");
        let count = self.views.len().max(self.measures.len());
        ensure!(count <= MAX_ENTRIES, "it has {count} views or distances; at most {MAX_ENTRIES} are read");
        let ends = self.measures.iter().flatten();
        ensure!(ends.into_iter().all(|p| p.is_finite()), "a distance in it is impossible");
        if let Some(path) = &self.path {
            ensure!(path.keyframes.len() <= MAX_KEYS, "its path has more than {MAX_KEYS} keys");
            ensure!(path.keyframes.is_empty() || path.is_valid(), "its camera path is impossible");
        }
        ensure!(self.exposure.is_valid(), "its exposure is impossible");
        let has_unit = self.unit.as_ref().is_none_or(|unit| unit.parse::<Unit>().is_ok());
        let has_up = self.up.as_ref().is_none_or(|up| up.parse::<Up>().is_ok());
        ensure!(has_unit && has_up, "its unit or its upward axis is unknown");
        ensure!(self.sun.as_ref().is_none_or(SunTable::is_valid), "the sun in it is impossible");
        ensure!(self.exposure.is_valid(), "its exposure is impossible");
        ensure!(self.section.is_none_or(|section| section.is_valid()), "the section in it is impossible");
        Ok(())
    }

    /// Restores everything but the scene, which must be shown already, and but the pose. `edit` is
    /// what the session makes of the scene.
    pub(in crate::window::app) fn restore(&self, state: &mut AppState, edit: SceneEdit) {
        self.restore_quality(&mut state.quality);
        let Some(open) = &mut state.document else { return };
        let mut of_files = open.files().sun.clone();
        of_files.show(&edit.daylight);
        let own = self.sun.as_ref().map(|table| table.controls(of_files.nits_per_unit));
        let sun = own.map_or(of_files, |sun| with_sky_of(sun, &edit.daylight));
        let key_of = |v: &View| v.key.filter(|key| (1..=9).contains(key));
        let view = |v: &View| SavedView { name: v.name.clone(), key: key_of(v), camera: v.camera };
        let views: Vec<SavedView> = self.views.iter().map(view).collect();
        open.restore(Document {
            sun,
            scene: edit,
            // One view must remain.
            views: if views.is_empty() { open.files().views.clone() } else { views },
            path: self.path.clone().filter(|path| !path.keyframes.is_empty()),
            measures: self.measures.clone(),
            section: self.section,
        });
    }

    /// Returns the keys that this version does not know.
    pub(in crate::window::app) fn unknown_keys(&self) -> &Table {
        &self.other
    }

    /// Returns what the session makes of a scene whose files hold `files`. Where a change cannot be
    /// made, a message says so, and the others are made. A picture of the sky is read from the disk,
    /// with `allow_outside` also from outside the folder of the model.
    pub(in crate::window::app) fn edit(
        &self,
        scene: &Scene,
        files: &SceneEdit,
        source: &SceneSource,
        allow_outside: bool,
    ) -> AppliedEdit {
        let unchanged = |messages| AppliedEdit { edit: files.clone(), messages, outside: None };
        let folder = EditFolder { model: model_of(source), allow_outside };
        let Some(edits) = &self.edits else { return unchanged(Vec::new()) };
        let applied = apply_edit_text(&edits.to_string(), folder, scene, files);
        applied.unwrap_or_else(|cause| unchanged(vec![cause]))
    }

    fn restore_quality(&self, quality: &mut Quality) {
        let walk = &mut quality.walk;
        walk.render.mode = self.mode;
        walk.render.trace.samples = self.samples.clamp(1, MAX_SAMPLES);
        walk.render.trace.bounces = self.bounces.0;
        let placement = self.placement.as_ref().filter(|(_, percent)| (0.0..=100.0).contains(percent));
        let placement = placement.and_then(|(name, percent)| PlacementPolicy::named(name, *percent));
        walk.placement = placement.unwrap_or(walk.placement);
        walk.max_references = self.max_references.unwrap_or(walk.max_references).clamp(1, 1024);
        let cache = self.cache_mb.map(|mb| mb.clamp(1, 1 << 20) << 20);
        walk.cache_bytes = cache.unwrap_or(walk.cache_bytes);
        quality.exposure = self.exposure;
        quality.tone_map = settings::named(&self.tone_map).unwrap_or(quality.tone_map);
        let scale = self.render_scale.filter(|scale| (0.1..=1.0).contains(scale));
        quality.render_scale = scale.unwrap_or(quality.render_scale);
        let budget = self.budget_ms.filter(|ms| (1.0..=10_000.0).contains(ms));
        quality.budget_ms = budget.unwrap_or(quality.budget_ms);
        quality.keeps_improving = self.keep_improving.unwrap_or(quality.keeps_improving);
    }

    /// Pose of the camera.
    pub(in crate::window::app) fn camera(&self) -> Camera {
        self.camera
    }

    /// The scene of the session in `path`. A model that was moved together with its session is
    /// found next to it.
    pub(in crate::window::app) fn source(&self, path: &Path) -> SceneSource {
        let unit = self.unit.as_ref().and_then(|unit| unit.parse().ok());
        let up = self.up.as_ref().and_then(|up| up.parse().ok());
        let source = SceneSource::named(&self.scene, ImportOptions { unit, up, ..Default::default() });
        let SceneSource::File { path: model, options } = source else { return source };
        let folder = path.parent().unwrap_or(Path::new(""));
        let beside = model.file_name().map(|name| folder.join(name)).unwrap_or_default();
        let mut places = [folder.join(&model), model.clone(), beside];
        if self.version == 1 {
            // It holds the path as it was typed.
            places.swap(0, 1);
        }
        let found = places.into_iter().find(|place| place.exists()).unwrap_or(model);
        SceneSource::File { path: found, options }
    }

    /// A session for tests.
    #[cfg(test)]
    pub(super) fn example() -> Self {
        tests::session()
    }
}

/// Returns the controls, which do not show a picture that is not there.
fn with_sky_of(mut sun: SunControls, daylight: &Daylight) -> SunControls {
    let kind = daylight.sky.as_ref().map(Sky::kind);
    if sun.kind == SkyKind::Picture && kind != Some(SkyKind::Picture) {
        sun.kind = kind.unwrap_or_default();
    }
    sun
}

fn absolute(source: &SceneSource) -> String {
    match model_of(source).map(std::path::absolute) {
        Some(Ok(path)) => path.display().to_string(),
        _ => source.label(),
    }
}

#[cfg(test)]
mod tests;
