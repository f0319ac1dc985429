//! Sessions and recent files: saved, kept and restored.

use super::{
    AppEvent, Parts, SavedSession, Services, SessionFile, is_recovery, is_session, keep_session, left_behind,
    write_session,
};
use crate::settings;
use crate::window::input::Playback;
use crate::window::rendering::{TaskError, TaskHandle, spawn_activity, spawn_task};
use crate::window::state::AppState;
use afterimage::import::AppliedEdit;
use afterimage::raster::save::write_atomically;
use std::path::{Path, PathBuf};
use std::time::Duration;
use toml::Table;

/// Number of recent files that are remembered.
const MAX_RECENT: usize = 10;

/// Reads what the last start has left behind.
pub(super) fn read_state_folder(state: &mut AppState, folder: &Path) {
    let text = settings::read_text(&folder.join("recent.toml"), settings::MAX_BYTES);
    let table: Option<Table> = text.ok().and_then(|text| text.parse().ok());
    let files = table.as_ref().and_then(|t| t.get("files")).and_then(toml::Value::as_array);
    let paths = files.into_iter().flatten().filter_map(|f| f.as_str().map(PathBuf::from));
    state.files.recent = paths.take(MAX_RECENT).collect();
    state.files.recovery = left_behind(folder);
}

/// Saves the whole document in its session file, or in a new one where it has none.
pub(super) fn save_session(app: &mut Parts) {
    if app.services.saving.is_some() {
        app.current.saves_again = true;
        return;
    }
    let content = SessionFile::of(&app.state, &app.current.unknown_keys);
    let (content, document) = match (content, &app.state.document) {
        (Ok(content), Some(document)) => (content, document.now().clone()),
        (Err(error), _) => {
            let failure = TaskError::Failed(format!("{error:#}"));
            let wake = app.services.wake.clone();
            app.services.saving = Some(spawn_task("saving", wake, |_| Err(failure)));
            return;
        }
        (Ok(_), None) => return,
    };
    let Some(source) = app.state.scene.as_ref().map(|scene| scene.source.clone()) else { return };
    let (file, destination) = (app.current.file.clone(), app.services.destination(&app.state));
    let (quality, scene) = (app.state.quality, app.current.number);
    let work = move |_: &TaskHandle| {
        let path = write_session(&content, file, &destination)?;
        Ok(SavedSession { path, source, scene, document, quality })
    };
    let wake = app.services.wake.clone();
    app.services.saving = Some(spawn_activity("saving", "saving the session", wake, work));
}

/// Restores the session that has waited for its scene, but not the pose. Another scene than before
/// has no session file: that of the old scene is not overwritten.
pub(super) fn restore_session(
    app: &mut Parts,
    awaited: Option<(SessionFile, PathBuf)>,
    edit: Option<AppliedEdit>,
    is_reload: bool,
) {
    let (Some((content, file)), Some(edit)) = (awaited, edit) else {
        if !is_reload {
            (app.current.file, app.current.unknown_keys) = (None, Table::new());
        }
        return;
    };
    content.restore(&mut app.state, edit.edit);
    app.current.unknown_keys.clone_from(content.unknown_keys());
    (app.state.navigation.view_index, app.state.navigation.playback) = (0, Playback::default());
    for message in edit.messages {
        app.state.error(format!("{}: {message}", file.display()));
    }
    if is_own_recovery(&app.services, &file) {
        // A file that a session names is overwritten by the next save: only another session.
        app.current.file = content.own_file().filter(|path| is_session(path));
        // From now on it is the session of this process: at no time is there none on the disk.
        if let Some(folder) = &app.services.launch.state_folder {
            // If this fails it is offered again.
            if let Ok(place) = app.current.autosave.place(folder) {
                let _ = std::fs::rename(&file, place.file());
            }
        }
    } else {
        let quality = app.state.quality;
        if let Some(open) = &mut app.state.document {
            open.set_saved(open.now().clone(), quality);
        }
        app.current.file = Some(file);
    }
    app.state.navigation.fly.jump_to(content.camera());
}

/// True for a session that this program has kept itself: what it names was agreed to.
pub(super) fn is_own_recovery(services: &Services, file: &Path) -> bool {
    is_recovery(file, services.launch.state_folder.as_deref())
}

/// Puts a model first in the list of recent files.
pub(super) fn remember_model(app: &mut Parts, path: &Path) {
    let full = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    app.state.files.recent.retain(|p| *p != full);
    app.state.files.recent.insert(0, full);
    app.state.files.recent.truncate(MAX_RECENT);
    write_recent(app);
}

/// Empties the list of recent files.
pub(super) fn forget_recent(app: &mut Parts) {
    app.state.files.recent.clear();
    write_recent(app);
}

fn write_recent(app: &mut Parts) {
    let files = app.state.files.recent.iter().map(|p| toml::Value::String(p.display().to_string()));
    let table = Table::from_iter([("files".to_owned(), toml::Value::Array(files.collect()))]);
    keep(&mut app.services, "recent.toml", table.to_string(), "recent files are not remembered");
}

/// Keeps the session in case of a crash. Returns the time until it may be kept again.
pub(super) fn autosave(app: &mut Parts) -> Option<Duration> {
    let folder = app.services.launch.state_folder.clone()?;
    if let Some(Err(TaskError::Failed(cause))) = app.current.autosave.finished() {
        app.state.error(format!("the session is not kept in case of a crash: {cause}"));
    }
    let (is_due, rest) = app.current.autosave.due(&app.state);
    if is_due && let Ok(session) = SessionFile::of(&app.state, &app.current.unknown_keys) {
        let session = session.kept_for(app.current.file.as_deref());
        if let Err(TaskError::Failed(cause)) =
            app.current.autosave.keep(session, &folder, app.services.wake.clone())
        {
            app.state.error(format!("the session is not kept in case of a crash: {cause}"));
        }
    }
    rest
}

/// Writes a file of the state folder in the background.
fn keep(services: &mut Services, name: &str, text: String, failure: &'static str) {
    let Some(folder) = services.launch.state_folder.clone() else { return };
    let path = folder.join(name);
    services.spawn(&format!("keeping {}", path.display()), move || {
        let made = std::fs::create_dir_all(&folder)
            .map_err(|error| format!("cannot make the folder {}: {error}", folder.display()));
        let written = made.and_then(|()| write_atomically(&path, text.as_bytes()).map_err(|e| e.to_string()));
        written.map_err(|cause| TaskError::Failed(format!("{failure}: {cause}")))?;
        Ok(AppEvent::Kept)
    });
}

/// Ends keeping the session: it is removed where the program ends normally, and written once more
/// where the system ends it and something is not saved.
pub(super) fn end_autosave(app: &mut Parts) {
    let Some(folder) = app.services.launch.state_folder.clone() else { return };
    app.current.autosave.wait();
    let is_kept = app.services.is_ended_from_outside() && app.state.is_unsaved();
    if is_kept && let Ok(session) = SessionFile::of(&app.state, &app.current.unknown_keys) {
        // The one that was kept before stays where this fails.
        if let Ok(place) = app.current.autosave.place(&folder) {
            let _ = keep_session(&session.kept_for(app.current.file.as_deref()), place.file());
        }
    } else {
        app.current.autosave.remove();
    }
}
