//! Keys, pointer and camera paths, turned into motion and commands.

pub(crate) mod aim;
pub(crate) mod commands;
pub mod fly_camera;
pub(crate) mod inspect;
pub mod keymap;
mod object_keys;
pub mod playback;
pub(crate) mod pointer;
mod section_keys;
pub mod walking;

pub(crate) use commands::key_commands;
pub use fly_camera::{FlyCamera, Motion, MoveMode, SPEED_FACTOR, ViewChange};
use inspect::{inspect, probe_at, snap_at};
pub use playback::{Playback, Recording};
pub(crate) use pointer::{Click, Input, steer};
pub use walking::{EYE_HEIGHT_M, Obstacles, Walker};
