//! The session that is kept in case of a crash.

use super::{Recovery, SessionFile, keep_session};
use crate::window::rendering::{Task, TaskError, Wake, spawn_task, take_result};
use crate::window::state::{AppState, Quality};
use afterimage::Camera;
use std::path::Path;
use std::time::{Duration, Instant};

/// Interval at which the session is kept where only the camera has moved.
const CAMERA_INTERVAL: Duration = Duration::from_secs(20);

/// Shortest time between two writes after changes of the document or of the settings.
const CHANGE_INTERVAL: Duration = Duration::from_secs(1);

/// The session as it was kept last.
#[derive(Default)]
pub(super) struct Autosave {
    camera: Option<Camera>,
    /// Revision of the document, and the settings.
    content: Option<(u64, Quality)>,
    at: Option<Instant>,
    task: Option<Task<()>>,
    /// The file of this window, once something was kept.
    place: Option<Recovery>,
}

impl Autosave {
    /// True where the session is to be kept now; and the time until the next one where something
    /// has changed meanwhile.
    pub(super) fn due(&mut self, state: &AppState) -> (bool, Option<Duration>) {
        let Some(document) = &state.document else { return (false, None) };
        let (camera, content) = (*state.navigation.fly.camera(), (document.revision(), state.quality));
        let since = self.at.get_or_insert_with(Instant::now).elapsed();
        // What was loaded is not a change.
        let interval = if *self.content.get_or_insert(content) != content {
            CHANGE_INTERVAL
        } else if self.camera != Some(camera) {
            CAMERA_INTERVAL
        } else {
            return (false, None);
        };
        let rest = interval.saturating_sub(since);
        if !rest.is_zero() || self.task.is_some() {
            return (false, Some(rest.max(SHORTEST_WAIT)));
        }
        (self.camera, self.content, self.at) = (Some(camera), Some(content), Some(Instant::now()));
        (true, None)
    }

    /// Returns the file of this window in a folder.
    ///
    /// # Errors
    /// A message for the user, if the folder or the file cannot be made.
    pub(super) fn place(&mut self, folder: &Path) -> Result<&Recovery, TaskError> {
        let place = match self.place.take() {
            Some(place) => place,
            None => Recovery::begin(folder)?,
        };
        Ok(self.place.insert(place))
    }

    /// Keeps a session in the background.
    ///
    /// # Errors
    /// As [`Self::place`].
    pub(super) fn keep(&mut self, session: SessionFile, folder: &Path, wake: Wake) -> Result<(), TaskError> {
        let file = self.place(folder)?.file().to_owned();
        self.task = Some(spawn_task("recovery", wake, move |_| keep_session(&session, &file)));
        Ok(())
    }

    /// Removes what this window has kept, if it has kept anything.
    pub(super) fn remove(&mut self) {
        if let Some(place) = self.place.take() {
            // It may not have been written yet.
            let _ = std::fs::remove_file(place.file());
        }
    }

    /// Returns the result of keeping the session, once.
    pub(super) fn finished(&mut self) -> Option<Result<(), TaskError>> {
        take_result(&mut self.task)
    }

    /// Waits until nothing is being written.
    pub(super) fn wait(&mut self) {
        if let Some(task) = self.task.take() {
            task.cancel_and_wait();
        }
    }
}

/// Time after which it is looked again whether the last session is written.
const SHORTEST_WAIT: Duration = Duration::from_millis(100);
