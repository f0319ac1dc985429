//! The commit of a checkout, read from the files of git.

use std::path::{Path, PathBuf};

/// Returns the commit of the package in a folder, and the files that change with it. In a package
/// of cargo, the commit is in a file of cargo; in a checkout, `.git` is the folder above.
pub(crate) fn of(package: &Path) -> (Option<String>, Vec<PathBuf>) {
    let mut read = Vec::new();
    let commit = of_package(package, &mut read).or_else(|| of_checkout(package, &mut read));
    (commit.filter(|commit| commit.len() >= 40 && commit.bytes().all(|b| b.is_ascii_hexdigit())), read)
}

/// Reads a text file and notes it.
fn text(file: PathBuf, read: &mut Vec<PathBuf>) -> Option<String> {
    let text = std::fs::read_to_string(&file).ok()?;
    read.push(file);
    Some(text)
}

/// Reads what `cargo package` notes: `{"git": {"sha1": "..."}}`.
fn of_package(package: &Path, read: &mut Vec<PathBuf>) -> Option<String> {
    let text = text(package.join(".cargo_vcs_info.json"), read)?;
    let after = text.split_once("\"sha1\"")?.1;
    Some(after.split('"').nth(1)?.to_owned())
}

fn of_checkout(package: &Path, read: &mut Vec<PathBuf>) -> Option<String> {
    let git = git_folder(&package.parent()?.join(".git"), read)?;
    let head = text(git.join("HEAD"), read)?;
    // Where the branch has no file of its own yet, only this one changes with a commit.
    read.extend(Some(git.join("logs/HEAD")).filter(|log| log.is_file()));
    let Some(name) = head.strip_prefix("ref:").map(str::trim) else {
        return Some(head.trim().to_owned());
    };
    // Branches of a worktree are in the folder that all worktrees share.
    let shared = std::fs::read_to_string(git.join("commondir")).map_or(git.clone(), |to| git.join(to.trim()));
    let loose = text(git.join(name), read).or_else(|| text(shared.join(name), read));
    loose.map(|commit| commit.trim().to_owned()).or_else(|| packed(&shared, name, read))
}

/// Returns the folder of git: `.git` itself or, in a worktree, the one that the file `.git` names.
fn git_folder(dot_git: &Path, read: &mut Vec<PathBuf>) -> Option<PathBuf> {
    if dot_git.is_dir() {
        return Some(dot_git.to_owned());
    }
    let text = text(dot_git.to_owned(), read)?;
    Some(dot_git.parent()?.join(text.strip_prefix("gitdir:")?.trim()))
}

/// Looks a branch up in `packed-refs`: lines of a commit and a name.
fn packed(git: &Path, name: &str, read: &mut Vec<PathBuf>) -> Option<String> {
    let text = text(git.join("packed-refs"), read)?;
    let line = text.lines().find_map(|line| line.strip_suffix(name)?.strip_suffix(' '));
    line.map(str::to_owned)
}
