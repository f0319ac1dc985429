//! Panels around and over the viewport. A panel reads the state and requests changes by commands.

pub mod comparison;
pub mod daylight;
pub mod file_list;
pub mod help;
pub mod inspector;
pub mod legend;
pub mod lights;
pub mod material;
pub mod menu;
pub mod notices;
pub mod object;
pub mod overlay;
pub mod path;
pub mod picture;
pub mod plan;
mod plan_marks;
pub mod plots;
pub mod quality;
pub mod questions;
pub mod references;
pub mod scene;
pub mod settings;
pub mod side;
pub mod statistics;
pub mod views;
pub mod widgets;
