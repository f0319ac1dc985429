//! How far a long job is: a bar with rate and remaining time on a terminal, a plain line now and then elsewhere.

use super::output::say;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Between two lines where there is no terminal.
const LINE_EVERY: Duration = Duration::from_secs(10);

/// The progress of a job of known length.
#[derive(Debug)]
pub(crate) struct Progress {
    bar: Option<ProgressBar>,
    label: String,
    total: u64,
    started: Instant,
    last_line: Instant,
}

impl Progress {
    /// Nothing of `total` is done.
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

    /// So much is done; `note` says what is going on.
    pub(crate) fn at(&mut self, done: u64, note: &str) {
        if let Some(bar) = &self.bar {
            // Told many times a second; the bar draws itself seldom.
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

    /// A line that stays, beside the bar.
    pub(crate) fn say(&self, text: &str) {
        match &self.bar {
            Some(bar) => bar.suspend(|| say(text)),
            None => say(text),
        }
    }
}

/// The progress of one job that is told in parts of it, by any thread.
#[derive(Debug)]
pub(crate) struct SharedProgress {
    inner: Mutex<Progress>,
}

impl SharedProgress {
    /// A job is told in so many steps.
    const STEPS: u64 = 100;

    /// Nothing is done.
    pub(crate) fn new(label: &str) -> Self {
        let style = "{prefix} [{bar:30}] {percent} %  {eta} left  {msg}";
        Self { inner: Mutex::new(Progress::styled(label, Self::STEPS, style)) }
    }

    /// This part is done, 0..1.
    pub(crate) fn at(&self, part: f64) {
        self.note(part, "");
    }

    /// This part is done, 0..1; `note` says what is going on. A thread that would have to wait leaves it to the others.
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
