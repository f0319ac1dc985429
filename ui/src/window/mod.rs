//! The window: walks through a scene, and shows which pixels are reused.
//!
//! The window's thread only reads input and shows the newest finished frame; it never waits for the
//! renderer.

mod app;
mod export;
pub mod gpu;
pub mod input;
pub mod panels;
pub mod rendering;
mod request;
mod run;
pub mod state;

pub use app::App;
pub use rendering::scene_loading::SceneSource;
pub use request::WindowRequest;
pub use run::{has_display, run};
