//! The file format of sessions: scene, pose, views, camera path and settings. Keys that this
//! version does not know are kept when the session is saved again.

use crate::settings;
use crate::window::input::Playback;
use crate::window::rendering::SceneSource;
use crate::window::state::{AppState, SavedView};
use afterimage::camera::CameraPath;
use afterimage::raster::exposure::Exposure;
use afterimage::trace::BounceLimit;
use afterimage::{Camera, Mode};
use anyhow::{Context, anyhow, bail, ensure};
use serde::{Deserialize, Serialize};
use std::path::Path;
use toml::Table;

/// Extension of session files.
pub(super) const EXTENSION: &str = "afterimage-session.toml";

/// Version of the format that is written and read.
const VERSION: i64 = 1;

/// Content of a session file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct SessionFile {
    version: i64,
    /// Scene of the session: `builtin:NAME` or a path.
    scene: String,
    mode: Mode,
    samples: u32,
    bounces: BounceLimit,
    #[serde(alias = "exposure_ev")]
    exposure: Exposure,
    tone_map: String,
    camera: Camera,
    #[serde(default)]
    views: Vec<View>,
    /// Camera path, where the user has set its keys.
    #[serde(default)]
    path: Option<CameraPath>,
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
pub(super) fn is_session(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().ends_with(&format!(".{EXTENSION}")))
}

impl SessionFile {
    /// The session of the state that is shown; `None` without a scene. `other` has the unknown keys
    /// of the session that was loaded.
    pub(super) fn of(state: &AppState, other: &Table) -> Option<Self> {
        let (scene, quality) = (state.scene.as_ref()?, &state.quality);
        let view = |v: &SavedView| View { name: v.name.clone(), key: v.key, camera: v.camera };
        let render = &quality.walk.render;
        Some(Self {
            version: VERSION,
            scene: scene.source.label(),
            mode: render.mode,
            samples: render.trace.samples,
            bounces: render.trace.bounce_limit(),
            exposure: quality.exposure,
            tone_map: quality.tone_map.name().to_owned(),
            camera: *state.navigation.fly.camera(),
            views: state.views().iter().map(view).collect(),
            path: state.has_own_path().then(|| state.path().clone()),
            other: other.clone(),
        })
    }

    /// Returns the text of the file.
    ///
    /// # Errors
    /// A message for the user, where a value cannot be written as TOML.
    pub(super) fn text(&self) -> anyhow::Result<String> {
        toml::to_string(self).context("the session cannot be written")
    }

    /// Reads the text of the file `path`.
    ///
    /// # Errors
    /// A message for the user, with file and line.
    pub(super) fn parse(text: &str, path: &Path) -> anyhow::Result<Self> {
        let name = path.display();
        let broken = |error| anyhow!(settings::broken(path, text, &error));
        let table: Table = text.parse().map_err(broken)?;
        match table.get("version").and_then(toml::Value::as_integer) {
            Some(VERSION) => {}
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
        let cameras = session.views.iter().map(|v| &v.camera).chain([&session.camera]);
        let is_valid = cameras.into_iter().all(Camera::is_valid) && !session.scene.is_empty();
        ensure!(is_valid, "{name}: a pose in it is impossible, or it names no scene");
        Ok(session)
    }

    /// Restores everything but the scene, which must be shown already. Returns the unknown keys.
    pub(super) fn restore(&self, state: &mut AppState) -> Table {
        let quality = &mut state.quality;
        quality.walk.render.mode = self.mode;
        quality.walk.render.trace.samples = self.samples.max(1);
        quality.walk.render.trace.bounces = self.bounces.0;
        quality.exposure = self.exposure;
        quality.tone_map = settings::named(&self.tone_map).unwrap_or(quality.tone_map);
        state.navigation.fly.jump_to(self.camera);
        if let Some(open) = &mut state.document {
            let view = |v: &View| SavedView { name: v.name.clone(), key: v.key, camera: v.camera };
            let mut document = open.now().clone();
            document.views = self.views.iter().map(view).collect();
            document.path.clone_from(&self.path);
            open.restore(document);
            state.navigation.view_index = 0;
            state.navigation.playback = Playback::default();
        }
        self.other.clone()
    }

    /// The scene of the session in `path`. A model that was moved together with its session is
    /// found next to it.
    pub(super) fn source(&self, path: &Path) -> SceneSource {
        let source = SceneSource::named(&self.scene, Default::default());
        let SceneSource::File { path: model, options } = source else { return source };
        let moved = path.parent().zip(model.file_name()).map(|(folder, name)| folder.join(name));
        let found = moved.filter(|moved| !model.exists() && moved.exists()).unwrap_or(model);
        SceneSource::File { path: found, options }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn session() -> SessionFile {
        let camera = Camera::look_at(DVec3::new(0.1, 1.6, 1.0 / 3.0), DVec3::ZERO, 60.0);
        let path = CameraPath::still(&camera);
        SessionFile {
            version: VERSION,
            scene: "builtin:gallery".to_owned(),
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
        let text = session().text().unwrap();
        assert_eq!(parse(&text).unwrap(), session());
        let numbered = parse(&text.replace("bounces = \"all\"", "bounces = 1")).unwrap();
        assert_eq!(numbered.bounces, BounceLimit(1), "as older versions have written it");
        let automatic = SessionFile { exposure: Exposure::Auto, ..session() };
        assert_eq!(parse(&automatic.text().unwrap()).unwrap(), automatic);
        let older = text.replace("exposure = ", "exposure_ev = ");
        assert_eq!(parse(&older).unwrap(), session());
        let newer = format!("guests = 3\n{text}\n[weather]\nrain = true\n");
        let read = parse(&newer).unwrap();
        assert_eq!(read.camera, session().camera);
        let again = read.text().unwrap();
        assert!(again.contains("guests = 3") && again.contains("[weather]"), "{again}");
    }

    #[test]
    fn other_versions_and_broken_files_are_reported() {
        let text = session().text().unwrap();
        let error = |text: &str| parse(text).unwrap_err().to_string();
        assert!(error(&text.replace("version = 1", "version = 2")).contains("newer program"));
        assert!(error("hello = 1").contains("not a session"));
        assert!(error("version = 1\nscene =\n").contains("line 2"));
        assert!(
            error(&text.replace("samples = 4", "samples = 'many'"))
                .contains("a.afterimage-session.toml, line")
        );
        assert!(error(&text.replace("yaw = ", "yaw = nan # ")).contains("impossible"));
        assert!(error(&text.replace("bounces = \"all\"", "bounces = 65")).contains("from 0 to 64"));
        assert!(is_session(Path::new("x/a.afterimage-session.toml")) && !is_session(Path::new("a.toml")));
    }
}
