//! How pictures are saved, and the one that is being made.

use crate::window::rendering::task::Progress;
use afterimage::Mode;
use afterimage::render::bands::Background;
use std::path::PathBuf;

/// How large a picture is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureSize {
    /// As the viewport, pixel for pixel.
    Viewport,
    /// Width and height in pixels.
    Pixels([u32; 2]),
}

/// What kind of file a picture becomes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// As a screen shows it, 8 bits.
    Png,
    /// Linear, with depth, normal, type, reference and primitive.
    Exr,
}

/// How pictures are saved.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureSettings {
    /// How large.
    pub size: PictureSize,
    /// Shadow rays per light and pixel; the window's where nothing is said.
    pub samples: Option<u32>,
    /// `Full` is the ordinary ray tracer, anti-aliased; the others reuse the references that the window holds.
    pub mode: Mode,
    /// Rays through different points of each pixel, in mode `full`.
    pub antialias: u32,
    /// PNG or OpenEXR.
    pub format: PictureFormat,
    /// Whether the sky is seen.
    pub background: Background,
    /// Where; the current folder or the user's pictures where nothing is said.
    pub folder: Option<PathBuf>,
}

impl Default for PictureSettings {
    fn default() -> Self {
        Self {
            size: PictureSize::Viewport,
            samples: None,
            mode: Mode::Full,
            // What a picture at rest converges to.
            antialias: afterimage::render::CONVERGED_PASSES,
            format: PictureFormat::Png,
            background: Background::Shown,
            folder: None,
        }
    }
}

/// Pictures, as the panels see them.
#[derive(Clone, Debug, Default)]
pub struct PictureState {
    /// How they are saved.
    pub settings: PictureSettings,
    /// Text of the folder field.
    pub folder_text: String,
    /// The dialog is open.
    pub is_open: bool,
    /// What is being saved.
    pub exporting: Option<Progress>,
    /// How to make a film of the last sequence.
    pub film_command: Option<String>,
}

/// What is asked for of pictures.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the names say it")]
pub enum PictureCommand {
    Save,
    SaveWithoutBackground,
    SaveSequence,
    ShowDialog(bool),
    Set(PictureSettings),
    SetFolderText(String),
    Cancel,
}
