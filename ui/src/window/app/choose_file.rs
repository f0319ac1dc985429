//! Choosing a file or a folder: with the system's dialog, or in the program's own list where there
//! is none. Folders are read off the window's thread.

use super::{Parts, Services, model_folder, open_path, open_sky};
use crate::window::export::destination::pictures_folder;
use crate::window::files::{Asked, Listing, Reached, ask_system, home, listing, path_of, system, typed};
use crate::window::rendering::{TaskError, spawn_activity, spawn_task, take_result};
use crate::window::state::{AppState, FileList, ListCommand, PictureCommand, Purpose};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Applies a command about the list of files.
pub(super) fn handle_list(app: &mut Parts, command: ListCommand) {
    let list = &mut app.state.files.list;
    match (command, list) {
        (ListCommand::Ask(purpose), _) => ask(&app.state, &mut app.services, purpose),
        (ListCommand::Take(path), list) => {
            if let Some(closed) = list.take() {
                take(app, closed.purpose, path);
            }
        }
        (ListCommand::Close, list) => *list = None,
        (ListCommand::Go(path), Some(list)) => go(&mut app.services, list, path),
        (ListCommand::Filter(text), Some(list)) => list.filter_by(text),
        (ListCommand::Choose(index), Some(list)) => list.chosen = index,
        (_, None) => {}
    }
}

/// Asks with the system's dialog in the background: it blocks its thread.
fn ask(state: &AppState, services: &mut Services, purpose: Purpose) {
    if services.choosing.dialog.is_some() || state.files.list.is_some() {
        return;
    }
    let is_own = services.launch.has_own_file_list;
    let question = system::Question {
        title: purpose.title(),
        endings: purpose.endings(),
        folder: model_folder(state).or_else(|| state.files.last_folder.clone()),
    };
    services.choosing.dialog = Some(spawn_task("dialog", services.wake.clone(), move |_| {
        Ok((purpose, if is_own { Asked::Missing } else { ask_system(&question) }))
    }));
}

/// Takes over what was chosen, and folders that were read.
pub(super) fn poll_files(app: &mut Parts) {
    match take_result(&mut app.services.choosing.dialog) {
        Some(Ok((purpose, Asked::Chosen(path)))) => take(app, purpose, path),
        Some(Ok((purpose, Asked::Missing))) => show_list(&mut app.state, &mut app.services, purpose),
        Some(Err(TaskError::Failed(text))) => {
            app.state.error(format!("the file dialog cannot be started: {text}"));
        }
        Some(Ok((_, Asked::Closed)) | Err(TaskError::Cancelled)) | None => {}
    }
    if let Some(result) = take_result(&mut app.services.choosing.folder) {
        show_folder(app, result);
    }
    if let Some(Ok(Reached::Folder(listing))) = take_result(&mut app.services.choosing.nearby) {
        app.state.files.nearby = Arc::new(listing);
    }
}

/// Shows the program's own list.
fn show_list(state: &mut AppState, services: &mut Services, purpose: Purpose) {
    let last = state.files.last_folder.clone();
    let start = last.or_else(|| model_folder(state)).or_else(|| std::env::current_dir().ok());
    let start = start.or_else(home).unwrap_or_else(|| PathBuf::from("/"));
    let mut list = FileList::new(purpose, start.clone(), places(state));
    go(services, &mut list, start);
    state.files.list = Some(list);
}

/// Folders that are offered beside the list.
fn places(state: &AppState) -> Vec<(String, PathBuf)> {
    let known = [("Home", home()), ("Pictures", pictures_folder()), ("Model's folder", model_folder(state))];
    let here = [("Start folder", std::env::current_dir().ok())];
    known.into_iter().chain(here).filter_map(|(name, path)| Some((name.to_owned(), path?))).collect()
}

fn go(services: &mut Services, list: &mut FileList, path: PathBuf) {
    list.is_reading = true;
    let endings = list.purpose.endings();
    let look = move || Reached::look(&path, &|path| listing::has_ending(path, &endings));
    let task = spawn_activity("folder", "reading a folder", services.wake.clone(), move |_| {
        look().map_err(TaskError::Failed)
    });
    services.choosing.folder = Some(task);
}

fn show_folder(app: &mut Parts, result: Result<Reached, TaskError>) {
    let Some(list) = &mut app.state.files.list else { return };
    list.is_reading = false;
    match result {
        Ok(Reached::Folder(listing)) => list.show(listing),
        Ok(Reached::File(path)) if list.purpose != Purpose::PictureFolder => {
            handle_list(app, ListCommand::Take(path));
        }
        Ok(Reached::File(path)) => list.error = Some(format!("{} is not a folder", path.display())),
        Err(TaskError::Failed(text)) => list.error = Some(text),
        Err(TaskError::Cancelled) => {}
    }
}

/// Uses what was chosen.
fn take(app: &mut Parts, purpose: Purpose, path: PathBuf) {
    app.state.files.last_folder = match purpose {
        Purpose::PictureFolder => app.state.files.last_folder.take(),
        Purpose::Open | Purpose::Sky => path.parent().map(Path::to_owned),
    };
    match purpose {
        Purpose::Open => open_path(app, path),
        Purpose::Sky => open_sky(app, path),
        Purpose::PictureFolder => {
            let text = path.display().to_string();
            super::handle_picture(app, PictureCommand::SetFolderText(text));
            app.state.picture.settings.folder = Some(path);
        }
    }
}

/// Changes the text of the path field, and reads the folder that it names for suggestions.
pub(super) fn set_path_text(state: &mut AppState, services: &mut Services, text: String) {
    let folder = typed::split(&text).0;
    let folder = if folder.is_empty() { PathBuf::from(".") } else { path_of(folder) };
    state.files.path_text = text;
    let is_known = std::path::absolute(&folder).is_ok_and(|folder| folder == state.files.nearby.folder);
    if is_known {
        return;
    }
    state.files.nearby = Arc::new(Listing::default());
    let endings = Purpose::Open.endings();
    let look = move || Reached::look(&folder, &|path| listing::has_ending(path, &endings));
    // A folder that cannot be read suggests nothing; opening says why.
    services.choosing.nearby =
        Some(spawn_task("folder", services.wake.clone(), move |_| look().map_err(TaskError::Failed)));
}
