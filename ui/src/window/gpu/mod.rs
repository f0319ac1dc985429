//! Passes on the graphics card: the newest frame is tone-mapped, reprojected to the current camera,
//! and drawn.

pub mod adapter;
pub mod full_screen_pass;
pub mod projection;
pub mod timewarp;
pub mod tone_map;
pub mod viewport;
