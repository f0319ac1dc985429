//! The commit that the program names is the one that was built.

use super::commit;
use std::path::Path;

const OF_BRANCH: &str = "0123456789abcdef0123456789abcdef01234567";
const OF_HEAD: &str = "89abcdef0123456789abcdef0123456789abcdef";

fn write(folder: &Path, files: &[(&str, &str)]) {
    for (name, text) in files {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
}

/// The commit of a package `ui` in a folder with these files.
fn commit_of(files: &[(&str, &str)]) -> Option<String> {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), files);
    let (commit, read) = commit::of(&folder.path().join("ui"));
    assert!(read.iter().all(|file| file.is_file()), "cargo watches files that exist: {read:?}");
    commit
}

#[test]
fn the_commit_is_found_in_checkouts_worktrees_and_packages() {
    let loose = format!("{OF_BRANCH}\n");
    let head = ("main/.git/HEAD", "ref: refs/heads/a/b\n");
    let checkout =
        [(".git/HEAD", "ref: refs/heads/a/b\n"), (".git/refs/heads/a/b", &loose), ("ui/Cargo.toml", "")];
    assert_eq!(commit_of(&checkout).as_deref(), Some(OF_BRANCH));
    assert_eq!(commit_of(&[(".git/HEAD", OF_HEAD), ("ui/Cargo.toml", "")]).as_deref(), Some(OF_HEAD));
    let packed = format!("# pack-refs\n{OF_HEAD} refs/heads/x/a/b\n{OF_BRANCH} refs/heads/a/b\n^{OF_HEAD}\n");
    let packed = [checkout[0], (".git/packed-refs", &packed), checkout[2]];
    assert_eq!(commit_of(&packed).as_deref(), Some(OF_BRANCH));
    let worktree = [
        head,
        ("main/.git/refs/heads/a/b", loose.as_str()),
        ("main/.git/worktrees/w/HEAD", "ref: refs/heads/a/b\n"),
        ("main/.git/worktrees/w/commondir", "../..\n"),
        (".git", "gitdir: main/.git/worktrees/w\n"),
        ("ui/Cargo.toml", ""),
    ];
    assert_eq!(commit_of(&worktree).as_deref(), Some(OF_BRANCH));
    let info =
        format!("{{\n  \"git\": {{\n    \"sha1\": \"{OF_HEAD}\"\n  }},\n  \"path_in_vcs\": \"ui\"\n}}");
    assert_eq!(commit_of(&[("ui/.cargo_vcs_info.json", &info)]).as_deref(), Some(OF_HEAD));
}

#[test]
fn what_is_no_checkout_has_no_commit() {
    for files in [
        &[("ui/Cargo.toml", "")][..],
        &[(".git/HEAD", "ref: refs/heads/none\n"), ("ui/Cargo.toml", "")],
        &[(".git/HEAD", "nonsense\n"), ("ui/Cargo.toml", "")],
        &[(".git", "gitdir: gone\n"), ("ui/Cargo.toml", "")],
        &[("ui/.cargo_vcs_info.json", "{}")],
    ] {
        assert_eq!(commit_of(files), None, "{files:?}");
    }
}

#[test]
fn this_checkout_has_the_commit_that_git_says() {
    let package = Path::new(env!("CARGO_MANIFEST_DIR"));
    let git = std::process::Command::new("git").arg("-C").arg(package).args(["rev-parse", "HEAD"]).output();
    let Some(output) = git.ok().filter(|output| output.status.success()) else {
        eprintln!("skipped: git names no commit here");
        return;
    };
    assert_eq!(commit::of(package).0.as_deref(), Some(String::from_utf8_lossy(&output.stdout).trim()));
}
