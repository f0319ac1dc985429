//! What runs on the graphics card: the newest frame, developed, re-projected to the newest pose and drawn.

pub mod adapter;
pub mod develop;
pub mod full_screen_pass;
pub mod presentation;
pub mod projection;
pub mod timewarp;
pub mod viewport;
