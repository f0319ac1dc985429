//! Applies commands: dispatches those of a part of the window to its handler, and handles the
//! others.

use super::{
    AppEvent, Parts, Services, answer_outside, cancel_loading, forget_recent, go_to, handle_answer,
    handle_edit, handle_inspect, handle_lighting, handle_list, handle_navigation, handle_picture, open_new,
    open_path, open_session, reload, save_session, set_path_text, toggle_bake,
};
use crate::picture::pose_text::pose_flags;
use crate::settings::{self, Theme};
use crate::window::input::ViewChange;
use crate::window::input::keymap::{Action, keys_of};
use crate::window::panels::regions;
use crate::window::rendering::{Quantity, RenderCommand, TaskError};
use crate::window::state::{AppState, Appearance, Command, Compare, FileCommand, Options};
use afterimage::raster::exposure::Exposure;
use egui::ViewportCommand;
use std::path::PathBuf;
use std::process::Stdio;

/// Applies a command of a panel or a key.
pub(super) fn apply(app: &mut Parts, command: Command) {
    let (state, services) = (&mut app.state, &mut app.services);
    let fly = &mut state.navigation.fly;
    match command {
        Command::Open(source) => open_new(app, source),
        Command::OpenPath(path) => open_path(app, path),
        Command::CancelLoading => cancel_loading(app),
        Command::Reload => reload(app),
        Command::Navigate(command) => handle_navigation(state, services, command),
        Command::Edit(command) => handle_edit(app, command),
        Command::Inspect(command) => handle_inspect(state, services, command),
        Command::Picture(command) => handle_picture(app, command),
        Command::List(command) => handle_list(app, command),
        Command::Files(command) => handle_files(app, command),
        Command::Answer(answer) => handle_answer(app, answer),
        Command::ReadOutside(is_agreed) => answer_outside(app, is_agreed),
        Command::SetAppearance(appearance) => set_appearance(state, services, appearance),
        Command::AddReference => {
            services.render.send(RenderCommand::AddReference(*fly.camera()));
        }
        Command::Bake => toggle_bake(app),
        Command::Lighting(command) => handle_lighting(app, command),
        Command::Remove(id) => {
            services.render.send(RenderCommand::Remove(id));
        }
        Command::Clear => {
            state.dialogs.asks_to_clear = false;
            services.render.send(RenderCommand::Clear);
        }
        Command::Quit => services.ctx.send_viewport_cmd(ViewportCommand::Close),
        Command::FullScreen => set_full_screen(services, !is_full_screen(services)),
        Command::FocusRegion(forward) => {
            // The help keeps the focus.
            if !state.options.shows_help {
                regions::move_focus(&services.ctx, forward);
            }
        }
        Command::Escape => escape(state, services),
        Command::CopyPose => {
            let flags = pose_flags(fly.camera());
            state.info(format!("copied {flags}"));
            services.ctx.copy_text(flags);
        }
        Command::OpenOutside(path) => open_outside(services, path),
        Command::CopyText(text) => services.ctx.copy_text(text),
        Command::SetPathText(text) => set_path_text(state, services, text),
        Command::SetQuality(quality) => state.quality = quality,
        Command::SetOptions(options) => set_options(state, options),
        Command::SetSpeed(speed) => fly.set_speed(speed),
        Command::SetFovDegrees(degrees) => fly.set_fov_degrees(degrees),
        Command::ChangeFov(steps) => fly.change_fov(steps),
        Command::EaseTo(camera) => go_to(&mut state.navigation, camera),
        Command::Level => fly.level(),
        Command::Say(text) => state.info(text),
        Command::ExposeForView => expose_for_view(state),
        Command::AskToClear => state.dialogs.asks_to_clear = true,
        Command::KeepReferences => state.dialogs.asks_to_clear = false,
        Command::ShowSettings(is_shown) => state.dialogs.shows_settings = is_shown,
        Command::Compare(shows, split) => compare(state, shows, split),
        Command::Dismiss(id) => state.notices.retain(|n| n.id != id),
    }
    // The window shows the change, even if no event follows.
    app.services.ctx.request_repaint();
}

/// Changes switches of the window. A pause ends a change of view and a path that is played, or
/// these would end the pause. The full tracer makes pictures: nothing else is compared with it.
fn set_options(state: &mut AppState, options: Options) {
    let fly = &mut state.navigation.fly;
    if options.is_paused && !options.is_frozen && !state.options.is_paused {
        fly.jump_to(*fly.camera());
        state.navigation.playback.is_playing = false;
    }
    if options.quantity != Quantity::Picture {
        state.comparison.shows = Compare::Off;
    }
    state.navigation.fly.set_view_change(options.view_change);
    state.options = options;
}

/// Shows or hides the comparison, which is one of pictures.
fn compare(state: &mut AppState, shows: Compare, split: f32) {
    (state.comparison.shows, state.comparison.split) = (shows, split);
    if shows != Compare::Off {
        state.options.quantity = Quantity::Picture;
    }
}

/// Sets the exposure that suits the view, where it stays.
fn expose_for_view(state: &mut AppState) {
    match state.view_exposure.metered_ev() {
        Some(ev) => {
            state.quality.exposure = Exposure::Stops(ev);
            let keys = keys_of(Action::ResetExposure);
            state.info(format!("exposure {ev:+.1} EV for this view; {keys} goes back"));
        }
        None => state.info("the view is black, so that there is no light to expose for"),
    }
}

fn handle_files(app: &mut Parts, command: FileCommand) {
    match command {
        FileCommand::SaveSession => save_session(app),
        FileCommand::Recover => {
            if let Some(path) = app.state.files.recovery.take() {
                open_session(app, path);
            }
        }
        FileCommand::DiscardRecovery => {
            if let Some(path) = app.state.files.recovery.take() {
                // If this fails, the session is offered again with the next start.
                let _ = std::fs::remove_file(path);
            }
        }
        FileCommand::ForgetRecent => forget_recent(app),
    }
}

/// Changes the appearance of the window, and writes the changes to the settings file.
fn set_appearance(state: &mut AppState, services: &mut Services, appearance: Appearance) {
    let changes = appearance.changes(&state.appearance);
    show_appearance(state, services, appearance);
    let Some(path) = services.launch.settings_file.clone() else { return };
    services.spawn("saving the settings", move || {
        let write = |(name, value)| settings::write(&path, name, value);
        changes.into_iter().try_for_each(write).map_err(TaskError::failed)?;
        Ok(AppEvent::Kept)
    });
}

/// Changes the appearance of the window.
pub(super) fn show_appearance(state: &mut AppState, services: &Services, appearance: Appearance) {
    services.ctx.set_theme(match appearance.theme {
        Theme::System => egui::ThemePreference::System,
        Theme::Dark => egui::ThemePreference::Dark,
        Theme::Light => egui::ThemePreference::Light,
    });
    services.ctx.set_zoom_factor(appearance.ui_scale);
    if appearance.has_reduced_motion != state.appearance.has_reduced_motion {
        let change = if appearance.has_reduced_motion { ViewChange::AtOnce } else { ViewChange::Eased };
        state.options.view_change = change;
        state.navigation.fly.set_view_change(change);
    }
    state.appearance = appearance;
}

fn is_full_screen(services: &Services) -> bool {
    services.ctx.input(|i| i.viewport().fullscreen.unwrap_or(false))
}

fn set_full_screen(services: &Services, is_full: bool) {
    services.ctx.send_viewport_cmd(ViewportCommand::Fullscreen(is_full));
}

/// Closes what is open, the last opened first; never quits.
fn escape(state: &mut AppState, services: &Services) {
    let is_set = |flag: &mut bool| std::mem::take(flag);
    let has_closed = is_set(&mut state.dialogs.asks_to_clear)
        || is_set(&mut state.options.shows_help)
        || std::mem::take(&mut state.comparison.shows) != Compare::Off
        || is_set(&mut state.dialogs.shows_settings)
        || is_set(&mut state.picture.is_open)
        || state.selection.reference_view.take().is_some()
        || state.selection.dropper.take().is_some()
        || state.selection.measure.end()
        || state.selection.inspection.take().is_some()
        || state.notices.pop().is_some();
    if !has_closed && is_full_screen(services) {
        set_full_screen(services, false);
    }
}

/// Opens a file or folder with the system's program for it, off the window's thread.
fn open_outside(services: &mut Services, path: PathBuf) {
    let opener = services.launch.opener.clone();
    services.spawn("opening a file", move || {
        let status = std::process::Command::new(&opener).arg(&path).stdin(Stdio::null()).status();
        let cause = match status {
            // Windows' Explorer reports a failure where there was none.
            Ok(status) if status.success() || cfg!(windows) => return Ok(AppEvent::Kept),
            Ok(status) => status.to_string(),
            Err(error) => error.to_string(),
        };
        Err(TaskError::Failed(format!(
            "{} cannot be opened: {}: {cause}; open it in your file manager",
            path.display(),
            opener.display()
        )))
    });
}
