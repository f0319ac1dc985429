//! Progress of a long job: a bar with rate and remaining time on a terminal, a line every few
//! seconds elsewhere.

use super::output::say;
use indicatif::{ProgressBar, ProgressStyle};
use std::time::{Duration, Instant};
use std::{io::IsTerminal, sync::Mutex};

/// Time between two lines without a terminal.
const LINE_EVERY: Duration = Duration::from_secs(10);

/// Progress of a job with a known number of steps.
#[derive(Debug)]
pub(crate) struct Progress {
    bar: Option<ProgressBar>,
    label: String,
    total: u64,
    started: Instant,
    last_line: Instant,
}

impl Progress {
    /// A job of `total` steps, none of them finished.
    pub(crate) fn new(label: &str, total: u64) -> Self {
        Self::styled(label, total, "{prefix} [{bar:30}] {pos}/{len}  {per_sec}  {eta} left  {msg}")
    }

    fn styled(label: &str, total: u64, style: &str) -> Self {
        let bar = std::io::stderr().is_terminal().then(|| {
            let bar = ProgressBar::new(total);
            if let Ok(style) = ProgressStyle::with_template(style) {
                bar.set_style(style.progress_chars("=> "));
            }
            bar.set_prefix(label.to_owned());
            bar
        });
        let now = Instant::now();
        Self { bar, label: label.to_owned(), total, started: now, last_line: now }
    }

    /// Shows that `done` steps are finished; `note` describes the current step.
    pub(crate) fn at(&mut self, done: u64, note: &str) {
        if let Some(bar) = &self.bar {
            // This is called many times per second; only changes are passed on.
            if bar.position() != done || bar.message() != note {
                bar.set_message(note.to_owned());
                bar.set_position(done);
            }
        } else if self.last_line.elapsed() >= LINE_EVERY {
            self.last_line = Instant::now();
            let left = self.started.elapsed().as_secs_f64() / done.max(1) as f64
                * self.total.saturating_sub(done) as f64;
            let (label, total) = (&self.label, self.total);
            say(format!("{label}: {done} of {total}, about {left:.0} s left  {note}").trim_end());
        }
    }

    /// Writes a message that stays above the bar.
    pub(crate) fn say(&self, text: &str) {
        match &self.bar {
            Some(bar) => bar.suspend(|| say(text)),
            None => say(text),
        }
    }
}

/// Progress of a job that several threads report as a part of the whole.
#[derive(Debug)]
pub(crate) struct SharedProgress {
    inner: Mutex<Progress>,
}

impl SharedProgress {
    /// Number of steps that the whole job is divided into.
    const STEPS: u64 = 100;

    /// A job of which nothing is finished.
    pub(crate) fn new(label: &str) -> Self {
        let style = "{prefix} [{bar:30}] {percent} %  {eta} left  {msg}";
        Self { inner: Mutex::new(Progress::styled(label, Self::STEPS, style)) }
    }

    /// Shows the finished part, 0..1.
    pub(crate) fn at(&self, part: f64) {
        self.note(part, "");
    }

    /// Shows the finished part, 0..1; `note` describes the current step. A thread that would have
    /// to wait for the lock returns at once: other threads report soon.
    pub(crate) fn note(&self, part: f64, note: &str) {
        if let Ok(mut inner) = self.inner.try_lock() {
            inner.at((part * Self::STEPS as f64) as u64, note);
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
