//! The window: walks through a scene, and shows which pixels are reused.
//!
//! The window's thread only reads input and shows the newest finished frame; it never waits for the
//! renderer.

mod app;
mod export;
pub mod files;
pub mod gpu;
pub mod input;
mod launch;
pub mod panels;
pub mod rendering;
mod run;
pub mod state;

pub use app::App;
pub use launch::LaunchOptions;
pub use rendering::scene_loading::SceneSource;
pub use run::{has_display, run};
