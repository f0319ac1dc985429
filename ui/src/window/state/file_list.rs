//! The program's own list of files, for systems without a file dialog.

use crate::window::files::{Entry, Listing};
use afterimage::import;
use std::path::PathBuf;
use std::sync::Arc;

/// What a file or a folder is chosen for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// A model, a session or a picture is opened.
    Open,
    /// A picture is used as the sky.
    Sky,
    /// Pictures are saved in this folder.
    PictureFolder,
}

impl Purpose {
    /// Title of the dialog.
    pub fn title(self) -> &'static str {
        match self {
            Self::Open => "Open a model, a session or a picture",
            Self::Sky => "Choose a picture of the sky",
            Self::PictureFolder => "Choose a folder for pictures",
        }
    }

    /// Endings of the files that are offered; none where a folder is chosen.
    pub fn endings(self) -> Vec<&'static str> {
        match self {
            Self::Open => import::extensions().chain(["toml", "png", "jpg", "jpeg", "exr", "hdr"]).collect(),
            Self::Sky => vec!["hdr", "exr"],
            Self::PictureFolder => Vec::new(),
        }
    }
}

/// The list of files that is open.
#[derive(Clone, Debug)]
pub struct FileList {
    /// What the file is chosen for.
    pub purpose: Purpose,
    /// The folder that is shown, or being read.
    pub folder: PathBuf,
    /// True while the folder is being read.
    pub is_reading: bool,
    /// The contents of the last folder that was read.
    pub listing: Arc<Listing>,
    /// Why a folder or a file could not be read.
    pub error: Option<String>,
    /// Text of the field: only names with this text are listed.
    pub filter: String,
    /// Indices of the entries that are listed.
    pub shown: Vec<usize>,
    /// Index among those of the entry that Enter opens.
    pub chosen: usize,
    /// Folders that are offered, with their names.
    pub places: Vec<(String, PathBuf)>,
}

impl FileList {
    /// An empty list that waits for a folder.
    pub fn new(purpose: Purpose, folder: PathBuf, places: Vec<(String, PathBuf)>) -> Self {
        Self {
            purpose,
            folder,
            places,
            is_reading: true,
            listing: Arc::default(),
            error: None,
            filter: String::new(),
            shown: Vec::new(),
            chosen: 0,
        }
    }

    /// Shows a folder that was read.
    pub fn show(&mut self, listing: Listing) {
        (self.is_reading, self.error) = (false, None);
        self.folder.clone_from(&listing.folder);
        self.listing = Arc::new(listing);
        self.filter_by(String::new());
    }

    /// Lists only names with this text.
    pub fn filter_by(&mut self, text: String) {
        let wanted = text.trim().to_lowercase();
        let entries = self.listing.entries.iter().enumerate();
        let fitting = entries.filter(|(_, e)| e.name.to_lowercase().contains(&wanted));
        self.shown = fitting.map(|(i, _)| i).collect();
        (self.filter, self.chosen) = (text, 0);
    }

    /// Returns an entry of the list.
    pub fn entry(&self, shown: usize) -> Option<&Entry> {
        self.listing.entries.get(*self.shown.get(shown)?)
    }
}

/// A command about the list of files.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the names say it")]
pub enum ListCommand {
    Ask(Purpose),
    /// Shows a folder, or takes a file.
    Go(PathBuf),
    Filter(String),
    Choose(usize),
    Take(PathBuf),
    Close,
}
