//! Messages over the viewport.

use super::State;
use std::time::{Duration, Instant};

/// How serious a notice is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// Something was done.
    Info,
    /// Something failed.
    Error,
}

/// A message over the viewport, there until it is dismissed.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// Its name.
    pub id: u64,
    /// How serious.
    pub severity: Severity,
    /// In full.
    pub text: String,
    /// When it came up.
    pub since: Instant,
}

/// Good news goes away by itself after so long.
const INFO_TIME: Duration = Duration::from_secs(8);

/// So many notices are kept.
const MAX_NOTICES: usize = 4;

impl State {
    /// Puts a message over the viewport; one that is there already is not repeated.
    pub fn notify(&mut self, severity: Severity, text: String) {
        self.notices.retain(|n| n.text != text);
        let id = self.next_notice;
        self.next_notice += 1;
        self.notices.push(Notice { id, severity, text, since: Instant::now() });
        let surplus = self.notices.len().saturating_sub(MAX_NOTICES);
        self.notices.drain(..surplus);
    }

    /// Takes away good news that was there for long enough.
    pub fn expire_notices(&mut self) {
        self.notices.retain(|n| n.severity == Severity::Error || n.since.elapsed() < INFO_TIME);
    }
}
