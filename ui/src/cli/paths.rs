//! Where the system wants a program's settings and its throw-away files.

use std::ffi::OsString;
use std::path::PathBuf;

/// Settings of the user.
pub(crate) fn config_folder() -> Option<PathBuf> {
    folder("XDG_CONFIG_HOME", ".config", "Library/Application Support", "APPDATA")
}

/// What can be made again.
pub(crate) fn cache_folder() -> Option<PathBuf> {
    folder("XDG_CACHE_HOME", ".cache", "Library/Caches", "LOCALAPPDATA")
}

/// What is worth keeping from one start to the next: recent files, sessions that were cut short.
pub(crate) fn state_folder() -> Option<PathBuf> {
    folder("XDG_STATE_HOME", ".local/state", "Library/Application Support", "LOCALAPPDATA")
}

fn folder(xdg: &str, unix: &str, mac: &str, windows: &str) -> Option<PathBuf> {
    // The XDG rules ignore a relative path.
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
