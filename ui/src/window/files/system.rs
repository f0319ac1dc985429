//! The file dialog of the system, where there is one. On Linux that takes a desktop portal or the
//! program zenity, and a dialog that cannot be shown looks like one that was closed.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Answer of the system's dialog.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Asked {
    /// The user chose this file or folder.
    Chosen(PathBuf),
    /// The user closed the dialog.
    Closed,
    /// There is no dialog.
    Missing,
}

/// The question of a file dialog: its title, the kinds of files, and where it begins.
#[derive(Clone, Debug)]
pub struct Question {
    /// Title of the dialog.
    pub title: &'static str,
    /// Endings of the files that are offered; empty for a folder.
    pub endings: Vec<&'static str>,
    /// Folder that is shown first.
    pub folder: Option<PathBuf>,
}

/// Shortest time in which a person closes a dialog that has opened; an answer that comes sooner
/// means that none has opened.
const SOONEST_ANSWER: Duration = Duration::from_millis(150);

/// Asks with the system's dialog, which blocks this thread.
pub fn ask_system(question: &Question) -> Asked {
    if cfg!(target_os = "linux") && !Desktop::here().has_dialog() {
        return Asked::Missing;
    }
    let mut dialog = rfd::FileDialog::new().set_title(question.title);
    if let Some(folder) = &question.folder {
        dialog = dialog.set_directory(folder);
    }
    let begun = Instant::now();
    let chosen = match question.endings.as_slice() {
        [] => dialog.pick_folder(),
        endings => dialog.add_filter(question.title, endings).pick_file(),
    };
    match chosen {
        Some(path) => Asked::Chosen(path),
        None if begun.elapsed() < SOONEST_ANSWER => Asked::Missing,
        None => Asked::Closed,
    }
}

/// What decides whether there is a dialog.
#[derive(Debug, Default)]
struct Desktop {
    programs: Vec<PathBuf>,
    data: Vec<PathBuf>,
    /// There is a bus over which a portal is reached.
    has_bus: bool,
    is_sandboxed: bool,
}

impl Desktop {
    fn here() -> Self {
        let variable = |name: &str| std::env::var_os(name).filter(|value| !value.is_empty());
        let folders = |text: std::ffi::OsString| std::env::split_paths(&text).collect::<Vec<_>>();
        let data = variable("XDG_DATA_DIRS").unwrap_or_else(|| "/usr/local/share:/usr/share".into());
        let socket = variable("XDG_RUNTIME_DIR").map(|folder| Path::new(&folder).join("bus"));
        Self {
            programs: variable("PATH").map(folders).unwrap_or_default(),
            data: folders(data),
            has_bus: variable("DBUS_SESSION_BUS_ADDRESS").is_some() || socket.is_some_and(|s| s.exists()),
            is_sandboxed: Path::new("/.flatpak-info").exists(),
        }
    }

    fn has_dialog(&self) -> bool {
        let portal = Path::new("dbus-1/services/org.freedesktop.portal.Desktop.service");
        let has_portal = self.is_sandboxed || self.data.iter().any(|folder| folder.join(portal).exists());
        self.has_bus && has_portal || self.programs.iter().any(|folder| folder.join("zenity").exists())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dialog_takes_a_portal_on_a_bus_or_zenity() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().to_owned();
        let desktop = |has_bus| Desktop {
            programs: vec![place.join("bin")],
            data: vec![place.join("share")],
            has_bus,
            is_sandboxed: false,
        };
        assert!(!desktop(true).has_dialog(), "a bus alone shows nothing");
        let services = place.join("share/dbus-1/services");
        std::fs::create_dir_all(&services).unwrap();
        std::fs::write(services.join("org.freedesktop.portal.Desktop.service"), "").unwrap();
        assert!(desktop(true).has_dialog() && !desktop(false).has_dialog());
        std::fs::create_dir_all(place.join("bin")).unwrap();
        std::fs::write(place.join("bin/zenity"), "").unwrap();
        assert!(desktop(false).has_dialog());
    }
}
