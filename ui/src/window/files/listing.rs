//! The contents of a folder, as a list to choose from.

use std::path::{Path, PathBuf};

/// Number of entries that are listed at most.
pub const MOST_ENTRIES: usize = 10_000;

/// Number of names that are read at most: a folder may hold millions that are not listed.
const MOST_NAMES: usize = 1_000_000;

/// A file or a folder in a list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// Name as it is shown.
    pub name: String,
    /// Its path.
    pub path: PathBuf,
    /// True for folders.
    pub is_folder: bool,
}

/// The contents of a folder.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Listing {
    /// The folder.
    pub folder: PathBuf,
    /// Folders, then files, each in the order of their names.
    pub entries: Vec<Entry>,
    /// True where the folder holds more than is listed.
    pub is_cut: bool,
}

/// A folder with its contents, or a file: the result of following a typed path.
#[derive(Clone, Debug)]
pub enum Reached {
    /// A folder and its contents.
    Folder(Listing),
    /// A file.
    File(PathBuf),
}

impl Reached {
    /// Looks at a path. Of a folder, the files that `is_shown` accepts are listed; hidden ones are
    /// not.
    ///
    /// # Errors
    /// Where there is nothing, or it cannot be read; the text names the path and a remedy.
    pub fn look(path: &Path, is_shown: &dyn Fn(&Path) -> bool) -> Result<Self, String> {
        let refused = |error| format!("{} cannot be read: {error}; choose another folder", path.display());
        let path = std::path::absolute(path).map_err(refused)?;
        if !path.metadata().map_err(refused)?.is_dir() {
            return Ok(Self::File(path));
        }
        let names = std::fs::read_dir(&path).map_err(refused)?.flatten();
        let mut listing = Listing { folder: path.clone(), ..Listing::default() };
        for (count, found) in names.enumerate() {
            if count == MOST_NAMES || listing.entries.len() == MOST_ENTRIES {
                listing.is_cut = true;
                break;
            }
            listing.entries.extend(entry(&found.path(), is_shown));
        }
        listing.entries.sort_by_cached_key(|e| (!e.is_folder, e.name.to_lowercase(), e.name.clone()));
        Ok(Self::Folder(listing))
    }
}

/// The entry of a path, unless it is hidden or not shown.
fn entry(path: &Path, is_shown: &dyn Fn(&Path) -> bool) -> Option<Entry> {
    let name = path.file_name()?.to_string_lossy().into_owned();
    if name.starts_with('.') {
        return None;
    }
    // Follows links; a link to nothing is not listed.
    let is_folder = path.metadata().ok()?.is_dir();
    (is_folder || is_shown(path)).then(|| Entry { name, path: path.to_owned(), is_folder })
}

/// True where a file has one of the endings, in large or small letters.
pub fn has_ending(path: &Path, endings: &[&str]) -> bool {
    path.extension().is_some_and(|e| endings.iter().any(|ending| e.eq_ignore_ascii_case(ending)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn listing(folder: &Path) -> Listing {
        match Reached::look(folder, &|path| has_ending(path, &["obj"])) {
            Ok(Reached::Folder(listing)) => listing,
            other => panic!("a folder was expected: {other:?}"),
        }
    }

    #[test]
    fn folders_come_first_and_other_files_are_left_out() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["b.OBJ", "A.obj", "note.txt", ".hidden.obj"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        std::fs::create_dir(folder.path().join("z")).unwrap();
        let listing = listing(folder.path());
        let names: Vec<&str> = listing.entries.iter().map(|e| e.name.as_str()).collect();
        assert_eq!(names, ["z", "A.obj", "b.OBJ"]);
        assert!(!listing.is_cut);
    }

    #[test]
    fn a_long_folder_is_cut_and_says_so() {
        let folder = tempfile::tempdir().unwrap();
        for i in 0..MOST_ENTRIES + 3 {
            std::fs::File::create(folder.path().join(format!("{i}.obj"))).unwrap();
        }
        let listing = listing(folder.path());
        assert!(listing.is_cut && listing.entries.len() == MOST_ENTRIES);
    }

    #[test]
    fn a_path_that_is_missing_is_named_and_a_file_is_a_file() {
        let error = Reached::look(Path::new("/no/such/folder"), &|_| true).unwrap_err();
        assert!(error.contains("/no/such/folder") && error.contains("choose another"), "{error}");
        let file = tempfile::NamedTempFile::new().unwrap();
        assert!(matches!(Reached::look(file.path(), &|_| true), Ok(Reached::File(_))));
    }
}
