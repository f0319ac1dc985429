//! Messages over the viewport.

use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Whether a message reports a result or a failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// Something was done. The message disappears by itself.
    Info,
    /// Something is not as expected. The message disappears by itself.
    Warning,
    /// Something failed. The message stays until it is dismissed.
    Error,
}

/// A message over the viewport.
#[derive(Clone, Debug, PartialEq)]
pub struct Notice {
    /// Identifies the message among all that were shown.
    pub id: u64,
    /// Whether the message reports a result or a failure.
    pub severity: Severity,
    /// Text of the message in plain words.
    pub text: String,
    /// The file or folder that the message is about, which can be opened from it.
    pub file: Option<PathBuf>,
    /// Time at which the message appeared.
    pub since: Instant,
}

/// An info or a warning disappears after this time: long enough to read two lines.
const INFO_TIME: Duration = Duration::from_secs(8);

/// Number of messages that are kept; the oldest are dropped.
const MAX_NOTICES: usize = 4;

/// Adds a message. A message with the same text is replaced.
pub(super) fn push(notices: &mut Vec<Notice>, id: u64, severity: Severity, text: String) {
    notices.retain(|n| n.text != text);
    notices.push(Notice { id, severity, text, file: None, since: Instant::now() });
    let surplus = notices.len().saturating_sub(MAX_NOTICES);
    notices.drain(..surplus);
}

impl Notice {
    /// True for an info or a warning that was shown for long enough.
    pub fn is_expired(&self) -> bool {
        self.severity != Severity::Error && self.since.elapsed() >= INFO_TIME
    }
}
