//! Searching the files that a model names. Exporters write paths of another machine, in another
//! case, with another extension.

use super::files::{Jail, Refusal};
use crate::scene::SourceFile;
use std::path::{Component, Path, PathBuf};
use std::{collections::HashMap, ffi::OsString};
use unicode_normalization::UnicodeNormalization;

/// Folders next to a model in which textures usually are.
const DEFAULT_FOLDERS: [&str; 4] = ["textures", "maps", "images", "tex"];
/// Extensions tried where a file does not exist: exporters name the format that they read, not the
/// one they wrote.
const EXTENSIONS: [&str; 14] =
    ["png", "jpg", "jpeg", "tga", "bmp", "hdr", "webp", "tif", "tiff", "gif", "dds", "ppm", "pgm", "exr"];

/// Result of a search.
#[derive(Debug)]
pub(super) struct Found {
    /// Canonical path of a file that may be opened.
    pub(super) file: Option<PathBuf>,
    /// Every path tried, for messages.
    pub(super) tried: Vec<String>,
    /// True where one of them is outside the scene's folder.
    pub(super) outside: bool,
}

/// Searches files, and remembers the contents of folders.
pub(super) struct Finder {
    pub(super) jail: Jail,
    /// For each folder that may be read: name to be compared -> name.
    listings: HashMap<PathBuf, HashMap<String, OsString>>,
    /// The files that were found; for one that was not, the place where it was looked for first.
    files: Vec<SourceFile>,
}

impl Finder {
    pub(super) fn new(jail: Jail) -> Self {
        Self { jail, listings: HashMap::new(), files: Vec::new() }
    }

    /// Finds a material library or a buffer next to the model.
    pub(super) fn library(&mut self, name: &str) -> Found {
        let folder = self.jail.folder.clone();
        let given = portable(name);
        let mut candidates = vec![folder.join(&given)];
        push_new(&mut candidates, folder.join(base(&given)));
        self.first_of(candidates, &[])
    }

    /// Finds a texture: by its path from the folders of the library and of the model, by its base
    /// name in both, then in the usual folders below both. Case is ignored, and other extensions
    /// are tried.
    pub(super) fn texture(&mut self, name: &str, library_folder: &Path) -> Found {
        let given = portable(name);
        let folders = [library_folder.to_owned(), self.jail.folder.clone()];
        let mut candidates = Vec::new();
        for name in [given.as_str(), base(&given)] {
            for folder in &folders {
                push_new(&mut candidates, folder.join(name));
            }
        }
        for folder in &folders {
            for usual in DEFAULT_FOLDERS {
                push_new(&mut candidates, folder.join(usual).join(base(&given)));
            }
        }
        self.first_of(candidates, &EXTENSIONS)
    }

    /// Returns the files that were looked for, each once.
    pub(super) fn into_files(mut self) -> Vec<SourceFile> {
        self.files.sort();
        // A file that changed while it was read keeps its first state.
        self.files.dedup_by(|later, first| later.path == first.path);
        self.files
    }

    /// Finds the first file that exists, and notes which file belongs to the scene.
    fn first_of(&mut self, candidates: Vec<PathBuf>, extensions: &[&str]) -> Found {
        let first = candidates.iter().find(|path| self.jail.may_look_at(path)).cloned();
        let found = self.search(candidates, extensions);
        log::debug!("{:?} is {:?}", found.tried.first(), found.file);
        self.files.extend(found.file.as_ref().or(first.as_ref()).map(|path| SourceFile::now(path)));
        found
    }

    fn search(&mut self, candidates: Vec<PathBuf>, extensions: &[&str]) -> Found {
        let mut found = Found { file: None, tried: Vec::new(), outside: false };
        for candidate in &candidates {
            found.tried.push(self.jail.shown(candidate));
            match self.one(candidate) {
                Ok(file) => return Found { file: Some(file), ..found },
                Err(refusal) => found.outside |= refusal == Refusal::Outside,
            }
        }
        // Only now: an exact name anywhere is better than another extension nearby.
        for candidate in candidates {
            let other = extensions.iter().find_map(|e| self.one(&candidate.with_extension(e)).ok());
            if other.is_some() {
                return Found { file: other, ..found };
            }
        }
        if !extensions.is_empty() {
            found.tried.push(format!("the same with the extensions {}", extensions.join(", ")));
        }
        found
    }

    fn one(&mut self, candidate: &Path) -> Result<PathBuf, Refusal> {
        match self.jail.admit(candidate) {
            Err(Refusal::Missing) => {
                let other = self.in_any_case(candidate).ok_or(Refusal::Missing)?;
                self.jail.admit(&other)
            }
            known => known,
        }
    }

    /// Returns the path as the folders spell it, with each part below the jail looked up regardless
    /// of case.
    fn in_any_case(&mut self, candidate: &Path) -> Option<PathBuf> {
        let below = candidate.strip_prefix(&self.jail.folder).ok()?.to_owned();
        let mut path = self.jail.folder.clone();
        for part in below.components() {
            match part {
                Component::Normal(name) => {
                    let real = self.listing(&path)?.get(&comparable(&name.to_string_lossy()))?.clone();
                    path.push(real);
                }
                Component::ParentDir => {
                    path.pop();
                }
                _ => {}
            }
        }
        Some(path)
    }

    fn listing(&mut self, folder: &Path) -> Option<&HashMap<String, OsString>> {
        let real = folder.canonicalize().ok()?;
        if !real.starts_with(&self.jail.folder) {
            return None;
        }
        let listing = self.listings.entry(real).or_insert_with_key(|real| {
            let mut names: Vec<OsString> =
                std::fs::read_dir(real).into_iter().flatten().flatten().map(|e| e.file_name()).collect();
            // Of two names that differ only in case, the choice is always the same.
            names.sort_by(|a, b| b.cmp(a));
            names.into_iter().map(|n| (comparable(&n.to_string_lossy()), n)).collect()
        });
        Some(listing)
    }
}

/// Returns a name as names are compared: in lower case, with accents joined to their letters
/// (NFC). Some systems write them apart.
fn comparable(name: &str) -> String {
    name.to_lowercase().nfc().collect()
}

fn push_new(candidates: &mut Vec<PathBuf>, candidate: PathBuf) {
    if !candidates.contains(&candidate) {
        candidates.push(candidate);
    }
}

/// Returns a path that was written on any system with `/` between its parts.
fn portable(name: &str) -> String {
    let name = name.strip_prefix("file://").unwrap_or(name);
    name.replace('\\', "/")
}

fn base(name: &str) -> &str {
    name.rsplit(['/', ':']).next().unwrap_or(name)
}
