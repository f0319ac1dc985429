//! Keys, pointer and camera paths, turned into motion and commands.

pub(crate) mod aim;
pub(crate) mod commands;
pub mod fly_camera;
pub(crate) mod inspect;
pub mod keymap;
pub mod playback;
pub(crate) mod pointer;
pub mod walking;
