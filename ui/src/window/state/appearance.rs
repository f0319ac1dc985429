//! Theme, scale and motion of the window.

use crate::settings::{Settings, Tab, Theme};

/// Theme, scale and motion of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Appearance {
    /// Dark, light or the system's theme.
    pub theme: Theme,
    /// Size of text and controls relative to their default size.
    pub ui_scale: f32,
    /// Views change at once instead of being eased.
    pub has_reduced_motion: bool,
    /// Tab of the side panel that is shown.
    pub tab: Tab,
}

impl Default for Appearance {
    fn default() -> Self {
        Self { theme: Theme::default(), ui_scale: 1.0, has_reduced_motion: false, tab: Tab::default() }
    }
}

impl Appearance {
    /// The appearance that settings ask for; defaults where they are silent.
    pub fn of(settings: &Settings) -> Self {
        let default = Self::default();
        Self {
            theme: settings.theme.unwrap_or(default.theme),
            ui_scale: settings.ui_scale.unwrap_or(default.ui_scale),
            has_reduced_motion: settings.reduced_motion.unwrap_or(default.has_reduced_motion),
            tab: settings.tab.unwrap_or(default.tab),
        }
    }

    /// Returns the settings that differ from `before`, by name; `None` stands for the default
    /// value.
    pub fn changes(&self, before: &Self) -> Vec<(&'static str, Option<toml_edit::Value>)> {
        let default = Self::default();
        let mut changes = Vec::new();
        if self.theme != before.theme {
            changes.push(("theme", (self.theme != default.theme).then(|| self.theme.name().into())));
        }
        if self.ui_scale != before.ui_scale {
            let percent = (f64::from(self.ui_scale) * 100.0).round() / 100.0;
            changes.push(("ui_scale", (self.ui_scale != default.ui_scale).then(|| percent.into())));
        }
        if self.has_reduced_motion != before.has_reduced_motion {
            changes.push(("reduced_motion", self.has_reduced_motion.then(|| true.into())));
        }
        if self.tab != before.tab {
            changes.push(("tab", (self.tab != default.tab).then(|| self.tab.name().into())));
        }
        changes
    }
}
