//! Settings and progress of saved pictures.

use crate::window::rendering::Progress;
use afterimage::Mode;
use afterimage::render::bands::Background;
use std::path::PathBuf;

/// Size of a saved picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureSize {
    /// Size of the viewport in pixels.
    Viewport,
    /// Width and height in pixels.
    Pixels([u32; 2]),
}

/// File format of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PictureFormat {
    /// As displayed, 8 bits per channel.
    Png,
    /// Linear radiance with depth, normal, type, reference and primitive.
    Exr,
}

/// Settings with which pictures are saved.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureSettings {
    /// Size of the saved picture.
    pub size: PictureSize,
    /// Light samples per pixel; `None` for the window's.
    pub samples: Option<u32>,
    /// `Full` traces every pixel, with anti-aliasing; the other modes reuse the references that the
    /// window holds.
    pub mode: Mode,
    /// Number of rays through different points of each pixel, in mode `full`.
    pub antialias: u32,
    /// File format of the saved picture.
    pub format: PictureFormat,
    /// Whether the background is visible.
    pub background: Background,
    /// Folder; `None` for the current folder or the user's folder for pictures.
    pub folder: Option<PathBuf>,
}

impl Default for PictureSettings {
    fn default() -> Self {
        Self {
            size: PictureSize::Viewport,
            samples: None,
            mode: Mode::Full,
            // The same as for a picture at rest that has converged.
            antialias: afterimage::render::CONVERGED_PASSES,
            format: PictureFormat::Png,
            background: Background::Shown,
            folder: None,
        }
    }
}

/// Saved pictures, as panels show them.
#[derive(Clone, Debug, Default)]
pub struct PictureState {
    /// Settings of the next picture.
    pub settings: PictureSettings,
    /// Text of the folder field.
    pub folder_text: String,
    /// True while the dialog of picture settings is open.
    pub is_open: bool,
    /// Progress of the picture that is being saved.
    pub exporting: Option<Progress>,
    /// Shell command that makes a film of the last sequence.
    pub film_command: Option<String>,
}

/// A command about saved pictures.
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
