//! Folders of the operating system for a program's settings, state and cache.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

/// The systems, by where they keep the files of programs.
#[derive(Clone, Copy, Debug)]
enum System {
    /// Linux and others, by the XDG base directories.
    Xdg,
    MacOs,
    Windows,
}

impl System {
    fn here() -> Self {
        if cfg!(windows) {
            Self::Windows
        } else if cfg!(target_os = "macos") {
            Self::MacOs
        } else {
            Self::Xdg
        }
    }

    /// Returns the folder for a purpose. `variable` reads the environment, where relative paths
    /// are ignored, as the specification of XDG requires.
    fn folder(self, purpose: &Purpose, variable: impl Fn(&str) -> Option<PathBuf>) -> Option<PathBuf> {
        let in_home = |below: &str| variable("HOME").map(|home| home.join(below));
        let base = match self {
            Self::Xdg => variable(purpose.xdg).or_else(|| in_home(purpose.unix)),
            Self::MacOs => in_home(purpose.mac),
            Self::Windows => variable(purpose.windows),
        };
        base.map(|folder| folder.join("afterimage"))
    }
}

/// Where each system keeps the files of one purpose.
struct Purpose {
    /// Variable of XDG, and the folder in the home folder where it is not set.
    xdg: &'static str,
    unix: &'static str,
    /// Folder in the home folder.
    mac: &'static str,
    /// Variable.
    windows: &'static str,
}

const CONFIG: Purpose = Purpose {
    xdg: "XDG_CONFIG_HOME",
    unix: ".config",
    mac: "Library/Application Support",
    windows: "APPDATA",
};

const CACHE: Purpose =
    Purpose { xdg: "XDG_CACHE_HOME", unix: ".cache", mac: "Library/Caches", windows: "LOCALAPPDATA" };

const STATE: Purpose = Purpose {
    xdg: "XDG_STATE_HOME",
    unix: ".local/state",
    mac: "Library/Application Support",
    windows: "LOCALAPPDATA",
};

/// Folder of the user's settings.
pub(crate) fn config_folder() -> Option<PathBuf> {
    System::here().folder(&CONFIG, variable)
}

/// Folder of files that can be computed again.
pub(crate) fn cache_folder() -> Option<PathBuf> {
    System::here().folder(&CACHE, variable)
}

/// Folder of state kept between runs: recent files and recovery sessions.
pub(crate) fn state_folder() -> Option<PathBuf> {
    System::here().folder(&STATE, variable)
}

fn variable(name: &str) -> Option<PathBuf> {
    let value: Option<OsString> = std::env::var_os(name);
    value.map(PathBuf::from).filter(|path: &PathBuf| Path::is_absolute(path))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_system_has_its_folders() {
        let set = |names: &'static [(&str, &str)]| {
            move |name: &str| names.iter().find(|(n, _)| *n == name).map(|(_, path)| PathBuf::from(path))
        };
        let home = set(&[("HOME", "/home/me")]);
        let folders =
            |system: System| [CONFIG, CACHE, STATE].map(|purpose| system.folder(&purpose, home).unwrap());
        let linux = ["/home/me/.config", "/home/me/.cache", "/home/me/.local/state"];
        assert_eq!(folders(System::Xdg), linux.map(|folder| Path::new(folder).join("afterimage")));
        let mac = ["Library/Application Support", "Library/Caches", "Library/Application Support"];
        assert_eq!(
            folders(System::MacOs),
            mac.map(|folder| Path::new("/home/me").join(folder).join("afterimage"))
        );
        let moved = set(&[("HOME", "/home/me"), ("XDG_CACHE_HOME", "/fast"), ("APPDATA", "/roaming")]);
        assert_eq!(System::Xdg.folder(&CACHE, moved), Some("/fast/afterimage".into()));
        assert_eq!(System::Windows.folder(&CONFIG, moved), Some("/roaming/afterimage".into()));
        assert_eq!(System::Windows.folder(&CACHE, moved), None);
        assert_eq!(System::MacOs.folder(&CACHE, set(&[])), None);
    }
}
