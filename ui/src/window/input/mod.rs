//! Keys, pointer and walks as motion and commands.

pub mod aim;
pub mod fly_camera;
pub mod keymap;
pub mod navigation;
pub mod playback;
pub mod pointer;
pub mod walking;
