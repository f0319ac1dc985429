//! The app: applies commands, takes over results, and draws the window. Nothing else imports it.

mod autosave;
mod canvas;
mod comparison;
mod inspect;
mod navigation;
mod open_scene;
mod persistence;
mod pictures;
mod poll;
mod render_request;
mod scene_edits;
mod services;
mod session;
mod session_file;
mod update;
mod watch;
mod window_app;

pub use window_app::App;
