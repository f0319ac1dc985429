//! Folders of the operating system for a program's settings, state and cache.

use std::{ffi::OsString, path::PathBuf};

/// Folder of the user's settings.
pub(crate) fn config_folder() -> Option<PathBuf> {
    folder("XDG_CONFIG_HOME", ".config", "Library/Application Support", "APPDATA")
}

/// Folder of files that can be computed again.
pub(crate) fn cache_folder() -> Option<PathBuf> {
    folder("XDG_CACHE_HOME", ".cache", "Library/Caches", "LOCALAPPDATA")
}

/// Folder of state kept between runs: recent files and recovery sessions.
pub(crate) fn state_folder() -> Option<PathBuf> {
    folder("XDG_STATE_HOME", ".local/state", "Library/Application Support", "LOCALAPPDATA")
}

fn folder(xdg: &str, unix: &str, mac: &str, windows: &str) -> Option<PathBuf> {
    // The XDG specification requires that relative paths are ignored.
    let variable = |name: &str| std::env::var_os(name).map(PathBuf::from).filter(|p| p.is_absolute());
    let home = || std::env::var_os("HOME").filter(|h: &OsString| !h.is_empty()).map(PathBuf::from);
    let base = if cfg!(windows) {
        variable(windows)
    } else if cfg!(target_os = "macos") {
        home().map(|h| h.join(mac))
    } else {
        variable(xdg).or_else(|| home().map(|h| h.join(unix)))
    };
    base.map(|b| b.join("afterimage"))
}
