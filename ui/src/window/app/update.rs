//! Commands as deeds: the only place where a panel's or a key's wish changes anything.

use crate::picture::pose_text::pose_flags;
use crate::settings::{self, Theme};
use crate::window::app::App;
use crate::window::app::event::AppEvent;
use crate::window::input::fly_camera::ViewChange;
use crate::window::rendering::render_thread::RenderCommand;
use crate::window::rendering::scene_loading::SceneSource;
use crate::window::state::{Appearance, Command, Compare};
use egui::{Context, ViewportCommand};

impl App {
    /// Does what was asked for.
    pub(crate) fn apply(&mut self, ctx: &Context, command: Command) {
        let state = &mut self.state;
        match command {
            Command::Open(source) => self.open_anew(source),
            Command::OpenPath(path) => self.open_path(path),
            Command::Browse => self.browse(),
            Command::CancelLoading => self.cancel_loading(),
            Command::Reload => self.reload(),
            Command::SetPathText(text) => state.files.path_text = text,
            Command::SetQuality(quality) => state.quality = quality,
            Command::SetOptions(options) => {
                state.options = options;
                state.navigation.fly.set_view_change(options.view_change);
            }
            Command::SetSpeed(speed) => state.navigation.fly.set_speed(speed),
            Command::SetFovDegrees(degrees) => state.navigation.fly.set_fov_degrees(degrees),
            Command::EaseTo(camera) => state.navigation.fly.ease_to(camera),
            Command::Navigate(moving) => self.move_on(moving),
            Command::Edit(editing) => self.edit(editing),
            Command::Inspect(seeing) => self.look_closer(seeing),
            Command::Say(text) => state.info(text),
            Command::Level => state.navigation.fly.level(),
            Command::ChangeFov(steps) => state.navigation.fly.change_fov(steps),
            Command::AskToClear => state.dialogs.asks_to_clear = true,
            Command::KeepReferences => state.dialogs.asks_to_clear = false,
            Command::Clear => {
                state.dialogs.asks_to_clear = false;
                self.threads.send(RenderCommand::Clear);
            }
            Command::AddReference => {
                drop(self.threads.send(RenderCommand::AddReference(*self.state.navigation.fly.camera())))
            }
            Command::Remove(id) => drop(self.threads.send(RenderCommand::Remove(id))),
            Command::Answer(answer) => self.answer(ctx, answer),
            Command::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
            Command::Picture(command) => self.picture(command),
            Command::Files(command) => self.keep(command),
            Command::SetAppearance(appearance) => self.set_appearance(ctx, appearance),
            Command::ShowSettings(is_shown) => state.dialogs.shows_settings = is_shown,
            Command::CopyPose => {
                let flags = pose_flags(state.navigation.fly.camera());
                state.info(format!("copied {flags}"));
                ctx.copy_text(flags);
            }
            Command::Compare(shows, split) => {
                (state.comparison.shows, state.comparison.split) = (shows, split)
            }
            Command::CopyText(text) => ctx.copy_text(text),
            Command::Dismiss(id) => state.notices.retain(|n| n.id != id),
            Command::FullScreen => {
                let is_full = ctx.input(|i| i.viewport().fullscreen.unwrap_or(false));
                ctx.send_viewport_cmd(ViewportCommand::Fullscreen(!is_full));
            }
            Command::Escape => self.escape(ctx),
        }
        // What a command changed is shown, though no event may follow.
        ctx.request_repaint();
    }

    /// Changes the looks of the window, and keeps them for the next start.
    fn set_appearance(&mut self, ctx: &Context, appearance: Appearance) {
        let changes = appearance.changes(&self.state.appearance);
        self.show_appearance(ctx, appearance);
        let Some(path) = self.request.settings_file.clone() else { return };
        self.in_background("afterimage-settings", move || {
            let write = |(name, value)| settings::write(&path, name, value).map_err(|e| e.to_string());
            AppEvent::Kept(changes.into_iter().try_for_each(write))
        });
    }

    /// Makes the window appearance so.
    pub(crate) fn show_appearance(&mut self, ctx: &Context, appearance: Appearance) {
        ctx.set_theme(match appearance.theme {
            Theme::System => egui::ThemePreference::System,
            Theme::Dark => egui::ThemePreference::Dark,
            Theme::Light => egui::ThemePreference::Light,
        });
        ctx.set_zoom_factor(appearance.ui_scale);
        if appearance.has_reduced_motion != self.state.appearance.has_reduced_motion {
            let change = if appearance.has_reduced_motion { ViewChange::AtOnce } else { ViewChange::Eased };
            self.state.options.view_change = change;
            self.state.navigation.fly.set_view_change(change);
        }
        self.state.appearance = appearance;
    }

    /// Does something slow on a thread of its own.
    pub(crate) fn in_background(&mut self, name: &str, work: impl FnOnce() -> AppEvent + Send + 'static) {
        let (news, wake) = (self.news.0.clone(), self.wake.clone());
        let work = move || {
            // The window may be gone.
            let _ = news.send(work());
            wake();
        };
        if let Err(error) = std::thread::Builder::new().name(name.to_owned()).spawn(work) {
            self.state.error(format!("a thread cannot be started: {error}"));
        }
    }

    /// Leaves what is open, the last opened first; never quits.
    fn escape(&mut self, ctx: &Context) {
        let state = &mut self.state;
        if state.dialogs.asks_to_clear {
            state.dialogs.asks_to_clear = false;
        } else if state.options.shows_help {
            state.options.shows_help = false;
        } else if state.comparison.shows != Compare::Off {
            state.comparison.shows = Compare::Off;
        } else if state.dialogs.shows_settings {
            state.dialogs.shows_settings = false;
        } else if state.picture.is_open {
            state.picture.is_open = false;
        } else if state.selection.reference_view.take().is_some() {
        } else if state.selection.measure.is_on {
            state.selection.measure.is_on = false;
        } else if state.selection.inspection.take().is_some() {
        } else if state.notices.pop().is_none() && ctx.input(|i| i.viewport().fullscreen.unwrap_or(false)) {
            ctx.send_viewport_cmd(ViewportCommand::Fullscreen(false));
        }
    }

    /// Asks for a file on a thread of its own: the system's dialog blocks.
    fn browse(&mut self) {
        if std::mem::replace(&mut self.is_browsing, true) {
            return;
        }
        let (news, wake) = (self.news.0.clone(), self.wake.clone());
        let work = move || {
            let dialog = rfd::FileDialog::new()
                .set_title("Open a model, a session or a picture")
                .add_filter("Models, sessions, pictures", &["obj", "gltf", "glb", "toml", "png", "exr"]);
            // The window may be gone.
            let _ = news.send(AppEvent::Chosen(dialog.pick_file()));
            wake();
        };
        if let Err(error) = std::thread::Builder::new().name("afterimage-dialog".to_owned()).spawn(work) {
            self.is_browsing = false;
            self.state.error(format!("the file dialog cannot be started: {error}"));
        }
    }
}

impl App {
    /// What is being loaded, if anything.
    pub fn loading(&self) -> Option<&SceneSource> {
        self.loader.as_ref().map(crate::window::rendering::scene_loading::Loader::source)
    }
}
