//! Sessions and recent files: saved, kept and restored.

use super::{AppEvent, EXTENSION, Parts, Services, SessionFile, is_recovery, left_behind, recovery_file};
use crate::settings;
use crate::window::export::Destination;
use crate::window::rendering::TaskError;
use crate::window::state::AppState;
use afterimage::raster::save::{SaveError, write_atomically};
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

/// Saves the session in its file, or in a new one where it has none.
pub(super) fn save_session(app: &mut Parts) {
    let Some(content) = SessionFile::of(&app.state, &app.current.unknown_keys) else {
        return app.state.error("there is no scene to save a session of");
    };
    let (file, destination) = (app.current.file.clone(), app.services.destination(&app.state));
    app.services.spawn("saving the session", move || {
        let text = content.text().map_err(|error| TaskError::Failed(format!("{error:#}")))?;
        write_session(&text, file, &destination).map(AppEvent::SavedSession)
    });
}

fn write_session(text: &str, file: Option<PathBuf>, destination: &Destination) -> Result<PathBuf, TaskError> {
    let failed = |error: SaveError| {
        TaskError::Failed(format!(
            "{error}; free some space, or choose another folder in Scene, Picture settings"
        ))
    };
    match file {
        Some(path) => write_atomically(&path, text.as_bytes()).map(|()| path).map_err(failed),
        None => destination.write_new(EXTENSION, text.as_bytes()).map_err(|error| {
            error.map_or(TaskError::failed("there is no folder to save sessions in"), failed)
        }),
    }
}

/// Restores the session that has waited for its scene. Another scene than before has no session
/// file: that of the old scene is not overwritten.
pub(super) fn restore_session(app: &mut Parts, awaited: Option<(SessionFile, PathBuf)>, is_reload: bool) {
    if let Some((content, file)) = awaited {
        app.current.unknown_keys = content.restore(&mut app.state);
        if is_recovery(&file) {
            // The session is kept under another name from now on. If this fails it is offered
            // again.
            let _ = std::fs::remove_file(&file);
            app.current.file = None;
        } else {
            app.current.file = Some(file);
        }
    } else if !is_reload {
        (app.current.file, app.current.unknown_keys) = (None, Table::new());
    }
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
    let folder = app.services.launch.state_folder.as_ref()?;
    let (text, rest) = app.current.autosave.due(&app.state, &app.current.unknown_keys);
    if let Some(text) = text {
        let file = recovery_file(folder).file_name()?.to_string_lossy().into_owned();
        keep(&mut app.services, &file, text, "the session is not kept in case of a crash");
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

/// Removes the kept session: the program ends normally.
pub(super) fn end_autosave(services: &Services) {
    if let Some(folder) = &services.launch.state_folder {
        // There may be none.
        let _ = std::fs::remove_file(recovery_file(folder));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn a_full_disk_is_reported_with_a_remedy() {
        let full = PathBuf::from("/dev/full");
        assert!(full.exists(), "every Linux has one");
        let destination = Destination { folders: Vec::new(), stem: String::new() };
        let result = write_session("version = 1\n", Some(full), &destination);
        let Err(TaskError::Failed(text)) = result else { panic!("a full disk accepts no session") };
        assert!(text.contains("No space") && text.contains("free some space"), "{text}");
    }
}
