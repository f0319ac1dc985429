//! Finding a file that a model names: exporters write paths of another machine, in another case, with another ending.

use crate::import::files::{Jail, Refusal};
use std::collections::HashMap;
use std::ffi::OsString;
use std::path::{Component, Path, PathBuf};

/// Folders beside a model where textures usually lie.
const DEFAULT_FOLDERS: [&str; 4] = ["textures", "maps", "images", "tex"];
/// Endings tried where the named one does not exist: exporters name the format they read, not the one they wrote.
const ENDINGS: [&str; 6] = ["png", "jpg", "jpeg", "tga", "bmp", "hdr"];

/// The outcome of a search.
#[derive(Debug)]
pub(crate) struct Found {
    /// Canonical; may be opened.
    pub(crate) file: Option<PathBuf>,
    /// Every path tried, as people should see it.
    pub(crate) tried: Vec<String>,
    /// Some of them exist or point outside the scene's folder.
    pub(crate) outside: bool,
}

/// Searches, and remembers folders' contents.
pub(crate) struct Finder {
    pub(crate) jail: Jail,
    /// Of folders: lower-case name -> name, for folders that may be read.
    listings: HashMap<PathBuf, HashMap<String, OsString>>,
}

impl Finder {
    pub(crate) fn new(jail: Jail) -> Self {
        Self { jail, listings: HashMap::new() }
    }

    /// Finds a material library beside the model.
    pub(crate) fn library(&mut self, name: &str) -> Found {
        let folder = self.jail.folder.clone();
        let given = portable(name);
        let mut candidates = vec![folder.join(&given)];
        push_new(&mut candidates, folder.join(base(&given)));
        self.first_of(candidates, &[])
    }

    /// Finds a texture: as given from the library's folder and the model's, by base name in both, in the usual
    /// folders below both; each in any case and with another ending.
    pub(crate) fn texture(&mut self, name: &str, library_folder: &Path) -> Found {
        let given = portable(name);
        let folders = [library_folder.to_owned(), self.jail.folder.clone()];
        let mut candidates = Vec::new();
        folders.iter().for_each(|f| push_new(&mut candidates, f.join(&given)));
        folders.iter().for_each(|f| push_new(&mut candidates, f.join(base(&given))));
        for folder in &folders {
            DEFAULT_FOLDERS.iter().for_each(|u| push_new(&mut candidates, folder.join(u).join(base(&given))));
        }
        self.first_of(candidates, &ENDINGS)
    }

    fn first_of(&mut self, candidates: Vec<PathBuf>, endings: &[&str]) -> Found {
        let mut found = Found { file: None, tried: Vec::new(), outside: false };
        for candidate in &candidates {
            found.tried.push(self.jail.shown(candidate));
            match self.one(candidate) {
                Ok(file) => return Found { file: Some(file), ..found },
                Err(refusal) => found.outside |= refusal == Refusal::Outside,
            }
        }
        // Only now: an exact name anywhere is better than another ending nearby.
        for candidate in candidates {
            let other = endings.iter().find_map(|e| self.one(&candidate.with_extension(e)).ok());
            if other.is_some() {
                return Found { file: other, ..found };
            }
        }
        if !endings.is_empty() {
            found.tried.push(format!("the same with the endings {}", endings.join(", ")));
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

    /// The path as the folders spell it, each part below the jail looked up without regard to case.
    fn in_any_case(&mut self, candidate: &Path) -> Option<PathBuf> {
        let below = candidate.strip_prefix(&self.jail.folder).ok()?.to_owned();
        let mut path = self.jail.folder.clone();
        for part in below.components() {
            match part {
                Component::Normal(name) => {
                    let lower = name.to_string_lossy().to_lowercase();
                    let real = self.listing(&path)?.get(&lower)?.clone();
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
            // Of two names that differ in case only, always the same one.
            names.sort_by(|a, b| b.cmp(a));
            names.into_iter().map(|n| (n.to_string_lossy().to_lowercase(), n)).collect()
        });
        Some(listing)
    }
}

fn push_new(candidates: &mut Vec<PathBuf>, candidate: PathBuf) {
    if !candidates.contains(&candidate) {
        candidates.push(candidate);
    }
}

/// A path as written on any system, with `/` between its parts.
fn portable(name: &str) -> String {
    let name = name.strip_prefix("file://").unwrap_or(name);
    name.replace('\\', "/")
}

fn base(name: &str) -> &str {
    name.rsplit(['/', ':']).next().unwrap_or(name)
}
