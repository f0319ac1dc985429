//! The file format of sessions: scene, pose, the whole document and the settings. Keys that this
//! version does not know are kept when the session is saved again.

use super::sun::SunTable;
use crate::settings;
use crate::window::rendering::SceneSource;
use crate::window::state::{AppState, Document, Quality, SavedView};
use afterimage::camera::CameraPath;
use afterimage::import::{EditFolder, apply_edit_text, edit_text};
use afterimage::raster::exposure::Exposure;
use afterimage::reference::PlacementPolicy;
use afterimage::scene::{Scene, SceneEdit};
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

/// Content of a session file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(in crate::window::app) struct SessionFile {
    version: i64,
    /// Scene of the session: `builtin:NAME`, or a path relative to the folder of the session.
    scene: String,
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
    #[serde(default)]
    views: Vec<View>,
    /// Camera path, where the user has set its keys.
    #[serde(default)]
    path: Option<CameraPath>,
    #[serde(default)]
    sun: Option<SunTable>,
    /// Materials, objects and light that differ from the files of the model, as in a sidecar.
    #[serde(default)]
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
        ensure!(self.sun.as_ref().is_none_or(SunTable::is_valid), "the sun in it is impossible");
        Ok(())
    }

    /// Restores everything but the scene, which must be shown already, and but the pose. Returns
    /// the unknown keys, and messages about changes that the model does not allow.
    pub(in crate::window::app) fn restore(
        &self,
        state: &mut AppState,
        scene: &Scene,
    ) -> (Table, Vec<String>) {
        self.restore_quality(&mut state.quality);
        let (Some(open), Some(info)) = (&mut state.document, &state.scene) else {
            return (self.other.clone(), Vec::new());
        };
        let (edit, messages) = self.edit(scene, &open.files().scene, &info.source, true);
        let mut sun = open.files().sun.clone();
        sun.show(&edit.daylight);
        let view = |v: &View| SavedView { name: v.name.clone(), key: v.key, camera: v.camera };
        let views: Vec<SavedView> = self.views.iter().map(view).collect();
        open.restore(Document {
            sun: self.sun.as_ref().map_or(sun, |table| table.controls(scene.nits_per_unit())),
            scene: edit,
            // One view must remain.
            views: if views.is_empty() { open.files().views.clone() } else { views },
            path: self.path.clone().filter(|path| !path.keyframes.is_empty()),
            measures: self.measures.clone(),
        });
        (self.other.clone(), messages)
    }

    /// Returns what the session makes of a scene whose files hold `files`. Where a change cannot be
    /// made, a message says so, and the others are made.
    pub(in crate::window::app) fn edit(
        &self,
        scene: &Scene,
        files: &SceneEdit,
        source: &SceneSource,
        allow_outside: bool,
    ) -> (SceneEdit, Vec<String>) {
        let folder = EditFolder { model: model_of(source), allow_outside };
        let Some(edits) = &self.edits else { return (files.clone(), Vec::new()) };
        match apply_edit_text(&edits.to_string(), folder, scene, files) {
            Ok(applied) => applied,
            Err(cause) => (files.clone(), vec![cause]),
        }
    }

    fn restore_quality(&self, quality: &mut Quality) {
        let walk = &mut quality.walk;
        walk.render.mode = self.mode;
        walk.render.trace.samples = self.samples.max(1);
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
        let source = SceneSource::named(&self.scene, Default::default());
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

fn absolute(source: &SceneSource) -> String {
    match model_of(source).map(std::path::absolute) {
        Some(Ok(path)) => path.display().to_string(),
        _ => source.label(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::state::SunControls;

    pub(super) fn session() -> SessionFile {
        let camera = Camera::look_at(DVec3::new(0.1, 1.6, 1.0 / 3.0), DVec3::ZERO, 60.0);
        let path = CameraPath::still(&camera);
        SessionFile {
            version: VERSION,
            scene: "builtin:gallery".to_owned(),
            session: None,
            render_scale: Some(0.5),
            budget_ms: None,
            keep_improving: None,
            placement: Some(("grid".to_owned(), 5.0)),
            max_references: Some(8),
            cache_mb: Some(512),
            measures: vec![[DVec3::ZERO, DVec3::new(0.1, 2.0, 1.0 / 3.0)]],
            sun: Some(SunTable::of(&SunControls::default())),
            edits: Some("[[object]]\nname = 'a'\nhidden = true\n".parse().unwrap()),
            mode: Mode::Exact,
            samples: 4,
            bounces: BounceLimit::ALL,
            exposure: Exposure::Stops(-0.5),
            tone_map: "linear".to_owned(),
            camera,
            views: vec![View { name: "r\u{e4}um \"1\"".to_owned(), key: Some(2), camera }],
            path: Some(path),
            other: Table::new(),
        }
    }

    fn parse(text: &str) -> anyhow::Result<SessionFile> {
        SessionFile::parse(text, Path::new("a.afterimage-session.toml"))
    }

    #[test]
    fn a_session_comes_back_bit_for_bit_and_keeps_what_it_does_not_know() {
        let text = session().text(None).unwrap();
        assert_eq!(parse(&text).unwrap(), session());
        let numbered = parse(&text.replace("bounces = \"all\"", "bounces = 1")).unwrap();
        assert_eq!(numbered.bounces, BounceLimit(1), "as older versions have written it");
        let automatic = SessionFile { exposure: Exposure::Auto, ..session() };
        assert_eq!(parse(&automatic.text(None).unwrap()).unwrap(), automatic);
        let older = text.replace("exposure = ", "exposure_ev = ");
        assert_eq!(parse(&older).unwrap(), session());
        let first = text.replace("version = 2", "version = 1");
        assert_eq!(parse(&first).unwrap().camera, session().camera);
        let newer = format!("guests = 3\n{text}\n[weather]\nrain = true\n");
        let read = parse(&newer).unwrap();
        assert_eq!(read.camera, session().camera);
        let again = read.text(None).unwrap();
        assert!(again.contains("guests = 3") && again.contains("[weather]"), "{again}");
    }

    #[test]
    fn other_versions_and_broken_files_are_reported() {
        let text = session().text(None).unwrap();
        let error = |text: &str| parse(text).unwrap_err().to_string();
        assert!(error(&text.replace("version = 2", "version = 3")).contains("newer program"));
        assert!(error("hello = 1").contains("not a session"));
        assert!(error("version = 1\nscene =\n").contains("line 2"));
        assert!(
            error(&text.replace("samples = 4", "samples = 'many'"))
                .contains("a.afterimage-session.toml, line")
        );
        assert!(error(&text.replace("yaw = ", "yaw = nan # ")).contains("impossible"));
        assert!(error(&text.replace("hours = ", "hours = nan # ")).contains("sun"));
        let many = format!("measures = [{}]", "[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]],".repeat(MAX_ENTRIES + 1));
        let line = text.lines().find(|line| line.starts_with("measures")).unwrap();
        assert!(error(&text.replace(line, &many)).contains("at most"));
        assert!(error(&text.replace("bounces = \"all\"", "bounces = 65")).contains("from 0 to 64"));
        assert!(is_session(Path::new("x/a.afterimage-session.toml")) && !is_session(Path::new("a.toml")));
    }
}
