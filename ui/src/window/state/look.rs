//! The looks of the window, and what is asked for of files.

use crate::settings::{Settings, Theme};

/// The looks of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Dark, light or the system's.
    pub theme: Theme,
    /// Letters and controls, times their usual size.
    pub ui_scale: f32,
    /// Views change at once.
    pub has_reduced_motion: bool,
}

impl Default for Look {
    fn default() -> Self {
        Self { theme: Theme::default(), ui_scale: 1.0, has_reduced_motion: false }
    }
}

impl Look {
    /// As someone has set it.
    pub fn of(settings: &Settings) -> Self {
        let usual = Self::default();
        Self {
            theme: settings.theme.unwrap_or(usual.theme),
            ui_scale: settings.ui_scale.unwrap_or(usual.ui_scale),
            has_reduced_motion: settings.reduced_motion.unwrap_or(usual.has_reduced_motion),
        }
    }

    /// What differs from another one, as settings; `None` is the program's own.
    pub fn changes(&self, before: &Self) -> Vec<(&'static str, Option<toml_edit::Value>)> {
        let usual = Self::default();
        let mut changes = Vec::new();
        if self.theme != before.theme {
            changes.push(("theme", (self.theme != usual.theme).then(|| self.theme.name().into())));
        }
        if self.ui_scale != before.ui_scale {
            let percent = (f64::from(self.ui_scale) * 100.0).round() / 100.0;
            changes.push(("ui_scale", (self.ui_scale != usual.ui_scale).then(|| percent.into())));
        }
        if self.has_reduced_motion != before.has_reduced_motion {
            changes.push(("reduced_motion", self.has_reduced_motion.then(|| true.into())));
        }
        changes
    }
}

/// What is asked for of files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say it")]
pub enum FileCommand {
    SaveSession,
    Recover,
    DiscardRecovery,
    ForgetRecent,
}
