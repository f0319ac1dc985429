//! Nothing is lost: sessions are saved and brought back, also after a crash; recent files are remembered, and a model that
//! changes on the disk is loaded again.

use crate::settings;
use crate::window::app::App;
use crate::window::app::event::AppEvent;
use crate::window::app::session::{EXTENSION, Session};
use crate::window::export::screenshot;
use crate::window::rendering::render_thread::Wake;
use crate::window::rendering::scene_loading::SceneSource;
use crate::window::state::FileCommand;
use afterimage::Camera;
use afterimage::raster::save::{SaveError, write_atomically, write_new_atomically};
use crossbeam_channel::{RecvTimeoutError, Sender, bounded};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};
use toml::Table;

/// What is not saved by the user is kept so often.
const KEEP_EVERY: Duration = Duration::from_secs(20);

/// Files of a scene are looked at so often.
const WATCH_EVERY: Duration = Duration::from_secs(1);

/// So many files are remembered.
const MAX_RECENT: usize = 10;

/// A session is refused beyond this: hours of a recorded walk, thirty poses a second, are less.
const MAX_SESSION_BYTES: u64 = 64 << 20;

/// How the names of sessions begin that are kept for the case of a crash.
const RECOVERY: &str = "recovery-";

/// What is kept of a session beside the state.
#[derive(Debug)]
pub(crate) struct Keeping {
    /// The session's file, where it has one.
    file: Option<PathBuf>,
    /// What its file has that this version does not know.
    other: Table,
    /// To be brought back once its scene is there, with its file.
    pub(crate) awaited: Option<(Session, PathBuf)>,
    /// As it was kept last.
    kept: String,
    kept_camera: Option<Camera>,
    kept_at: Instant,
    /// Ends the thread that watches the scene's files.
    watch: Option<Sender<()>>,
}

impl Default for Keeping {
    fn default() -> Self {
        let (file, other, awaited, kept) = (None, Table::new(), None, String::new());
        Self { file, other, awaited, kept, kept_camera: None, kept_at: Instant::now(), watch: None }
    }
}

impl App {
    /// Does what was asked for.
    pub(crate) fn keep(&mut self, command: FileCommand) {
        match command {
            FileCommand::SaveSession => self.save_session(),
            FileCommand::Recover => {
                if let Some(path) = self.state.files.recovery.take() {
                    self.open_session(path);
                }
            }
            FileCommand::DiscardRecovery => {
                if let Some(path) = self.state.files.recovery.take() {
                    // It is offered once more where it cannot be removed.
                    let _ = std::fs::remove_file(path);
                }
            }
            FileCommand::ForgetRecent => {
                self.state.files.recent.clear();
                self.write_recent();
            }
        }
    }

    /// Reads what the last start left behind.
    pub(crate) fn begin_keeping(&mut self) {
        let Some(folder) = self.request.state_folder.clone() else { return };
        self.state.files.recent = read_recent(&folder.join("recent.toml"));
        self.state.files.recovery = left_behind(&folder);
    }

    fn save_session(&mut self) {
        let Some(session) = Session::of(&self.state, &self.keeping.other) else {
            return self.state.error("there is no scene to save a session of");
        };
        let stem = screenshot::stem(self.state.scene.as_ref().map_or("session", |s| &s.name));
        let (file, folders) = (self.keeping.file.clone(), self.picture_folders());
        self.in_background("afterimage-save", move || {
            let saved = session.text().and_then(|text| save_session(&text, file, &folders, &stem));
            AppEvent::Session(saved)
        });
    }

    /// Takes in where a session was saved.
    pub(crate) fn session_saved(&mut self, saved: Result<PathBuf, String>) {
        match saved {
            Ok(path) => {
                self.state.info(format!("saved {}", path.display()));
                self.keeping.file = Some(path);
            }
            Err(message) => self.state.error(message),
        }
    }

    /// Opens a session; one that is kept for a crash and broken is put aside, so that it is not offered for ever.
    pub(crate) fn open_session(&mut self, path: PathBuf) {
        let text = settings::read_text(&path, MAX_SESSION_BYTES).map_err(|e| e.to_string());
        let is_recovery = is_recovery(&path);
        match text.and_then(|text| Session::parse(&text, &path)) {
            Ok(session) => {
                let here = session_source(&session, &path);
                self.keeping.awaited = Some((session, path));
                self.open(here);
            }
            Err(message) => {
                let aside = is_recovery.then(|| path.with_extension("toml.bad"));
                let is_aside = aside.as_ref().is_some_and(|bad| std::fs::rename(&path, bad).is_ok());
                let more = if is_aside { "; it was renamed to end in .bad" } else { "" };
                self.state.error(format!("{message}{more}"));
            }
        }
    }

    /// Goes on with a scene that has just been shown: the session that waits for it, the list of recent files, the watch
    /// over its files.
    pub(crate) fn keep_scene(&mut self, source: &SceneSource, is_reload: bool) {
        if let Some((session, file)) = self.keeping.awaited.take() {
            self.keeping.other = session.restore(&mut self.state);
            self.meters_from = None;
            self.keeping.file = (!is_recovery(&file)).then_some(file.clone());
            if is_recovery(&file) {
                // From here on it is kept anew.
                let _ = std::fs::remove_file(&file);
            }
        } else if !is_reload {
            // The session of another scene is not to be written over.
            (self.keeping.file, self.keeping.other) = (None, Table::new());
        }
        self.keeping.watch = None;
        let SceneSource::File { path, .. } = source else { return };
        let full = std::path::absolute(path).unwrap_or_else(|_| path.clone());
        self.state.files.recent.retain(|p| *p != full);
        self.state.files.recent.insert(0, full);
        self.state.files.recent.truncate(MAX_RECENT);
        self.write_recent();
        let (news, wake, path) = (self.news.0.clone(), self.wake.clone(), path.clone());
        self.keeping.watch = watch(path, move |path| news.send(AppEvent::Changed(path)).is_ok(), wake);
    }

    /// Loads a scene again whose files have changed; the camera stays, and the old scene where the new one is broken.
    pub(crate) fn reload_changed(&mut self, path: &Path) {
        let source = self.state.scene.as_ref().map(|s| s.source.clone());
        if let Some(source @ SceneSource::File { .. }) = source
            && matches!(&source, SceneSource::File { path: shown, .. } if shown == path)
        {
            self.state.info(format!("{} has changed and is loaded again", path.display()));
            self.open(source);
        }
    }

    fn write_recent(&mut self) {
        let Some(folder) = self.request.state_folder.clone() else { return };
        let files: Vec<toml::Value> =
            self.state.files.recent.iter().map(|p| toml::Value::String(p.display().to_string())).collect();
        let table = Table::from_iter([("files".to_owned(), toml::Value::Array(files))]);
        self.in_background("afterimage-recent", move || {
            let written = make_folder(&folder).and_then(|()| {
                let text = table.to_string();
                write_atomically(&folder.join("recent.toml"), text.as_bytes()).map_err(|e| e.to_string())
            });
            AppEvent::Kept(written.map_err(|cause| format!("recent files are not remembered: {cause}")))
        });
    }

    /// Keeps the session for the case of a crash; returns how long it may wait for the next time.
    pub(crate) fn keep_session(&mut self) -> Option<Duration> {
        let folder = self.request.state_folder.as_ref()?;
        let camera = *self.state.navigation.fly.camera();
        let rest = KEEP_EVERY.saturating_sub(self.keeping.kept_at.elapsed());
        if !rest.is_zero() {
            return (self.keeping.kept_camera != Some(camera)).then_some(rest);
        }
        (self.keeping.kept_camera, self.keeping.kept_at) = (Some(camera), Instant::now());
        let text = Session::of(&self.state, &self.keeping.other)?.text().ok()?;
        if text == self.keeping.kept {
            return None;
        }
        self.keeping.kept.clone_from(&text);
        let folder = folder.clone();
        self.in_background("afterimage-keep", move || {
            let written = make_folder(&folder).and_then(|()| {
                write_atomically(&recovery_file(&folder), text.as_bytes()).map_err(|e| e.to_string())
            });
            AppEvent::Kept(
                written.map_err(|cause| format!("the session is not kept for the case of a crash: {cause}")),
            )
        });
        None
    }

    /// The program ends as it should: there is nothing to recover.
    pub(crate) fn end_keeping(&mut self) {
        self.keeping.watch = None;
        if let Some(folder) = &self.request.state_folder {
            // Where there is none nothing is lost.
            let _ = std::fs::remove_file(recovery_file(folder));
        }
    }
}

fn make_folder(folder: &Path) -> Result<(), String> {
    std::fs::create_dir_all(folder)
        .map_err(|error| format!("cannot make the folder {}: {error}", folder.display()))
}

fn save_session(
    text: &str,
    file: Option<PathBuf>,
    folders: &[PathBuf],
    stem: &str,
) -> Result<PathBuf, String> {
    let mut result = Err("there is no folder to save sessions in".to_owned());
    if let Some(path) = file {
        return write_atomically(&path, text.as_bytes()).map(|()| path).map_err(not_saved);
    }
    for folder in folders {
        result = write_new_atomically(folder, stem, EXTENSION, text.as_bytes()).map_err(not_saved);
        if result.is_ok() {
            break;
        }
    }
    result
}

fn not_saved(error: SaveError) -> String {
    format!("{error}; free some space, or choose another folder in Scene, Picture settings")
}

/// A session may have been moved together with its model.
fn session_source(session: &Session, path: &Path) -> SceneSource {
    let source = SceneSource::named(&session.scene, Default::default());
    let SceneSource::File { path: model, options } = source else { return source };
    let moved = path.parent().zip(model.file_name()).map(|(folder, name)| folder.join(name));
    let found = moved.filter(|moved| !model.exists() && moved.exists()).unwrap_or(model);
    SceneSource::File { path: found, options }
}

fn read_recent(path: &Path) -> Vec<PathBuf> {
    let text = settings::read_text(path, settings::MAX_BYTES);
    let table: Option<Table> = text.ok().and_then(|text| text.parse().ok());
    let files = table.as_ref().and_then(|t| t.get("files")).and_then(toml::Value::as_array);
    let paths = files.into_iter().flatten().filter_map(|f| f.as_str().map(PathBuf::from));
    paths.take(MAX_RECENT).collect()
}

fn recovery_file(folder: &Path) -> PathBuf {
    folder.join(format!("{RECOVERY}{}.{EXTENSION}", std::process::id()))
}

fn is_recovery(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(RECOVERY))
}

/// The newest session whose program has gone without a word.
fn left_behind(folder: &Path) -> Option<PathBuf> {
    let entries = std::fs::read_dir(folder).ok()?.filter_map(|e| e.ok().map(|e| e.path()));
    let is_orphan = |path: &PathBuf| {
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let id = name.strip_prefix(RECOVERY).and_then(|n| n.strip_suffix(&format!(".{EXTENSION}")));
        id.and_then(|id| id.parse().ok()).is_some_and(|id: u32| !is_running(id))
    };
    entries.filter(is_orphan).max_by_key(|path| modified(path))
}

fn is_running(process: u32) -> bool {
    // Elsewhere two windows at once may offer each other's sessions: nothing is lost by that.
    cfg!(target_os = "linux") && Path::new("/proc").join(process.to_string()).exists()
}

fn modified(path: &Path) -> Option<SystemTime> {
    std::fs::metadata(path).and_then(|m| m.modified()).ok()
}

/// When the files of a model were written: itself, what stands beside it under its name, material libraries.
fn stamps(model: &Path) -> Vec<(PathBuf, Option<SystemTime>)> {
    let folder = model.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let entries = std::fs::read_dir(folder).into_iter().flatten().filter_map(|e| e.ok().map(|e| e.path()));
    let side = model.with_extension("afterimage.toml");
    let is_part = |p: &PathBuf| {
        let is_library = p.extension().is_some_and(|e| e.eq_ignore_ascii_case("mtl") || e == "bin");
        p.file_name() == model.file_name() || is_library || p.file_name() == side.file_name()
    };
    let mut files: Vec<_> = entries.filter(is_part).map(|p| (p.clone(), modified(&p))).collect();
    files.sort();
    files
}

/// Tells when a model's files have changed and rest again. Ends with what is returned.
fn watch(path: PathBuf, tell: impl Fn(PathBuf) -> bool + Send + 'static, wake: Wake) -> Option<Sender<()>> {
    let (end, ended) = bounded::<()>(0);
    let mut known = stamps(&path);
    let run = move || {
        let mut is_moving = false;
        while let Err(RecvTimeoutError::Timeout) = ended.recv_timeout(WATCH_EVERY) {
            let now = stamps(&path);
            let has_changed = std::mem::replace(&mut known, now) != known;
            // A program that writes a file does not write it at once.
            if is_moving && !has_changed {
                if !tell(path.clone()) {
                    break;
                }
                wake();
            }
            is_moving = has_changed;
        }
    };
    let started = std::thread::Builder::new().name("afterimage-watch".to_owned()).spawn(run);
    started.is_ok().then_some(end)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn a_full_disk_is_told_with_what_to_do() {
        let full = PathBuf::from("/dev/full");
        assert!(full.exists(), "every Linux has one");
        let told = save_session("version = 1\n", Some(full), &[], "a").unwrap_err();
        assert!(told.contains("No space") && told.contains("free some space"), "{told}");
    }
}
