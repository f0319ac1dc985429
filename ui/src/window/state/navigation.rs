//! Position and motion of the user.

use crate::window::input::{FlyCamera, Playback, Recording};
use afterimage::Camera;

/// The camera, the saved view it was last at, and how the camera path is played.
#[derive(Clone, Debug, Default)]
pub struct Navigation {
    /// Pose and motion of the camera.
    pub fly: FlyCamera,
    /// Index of the saved view that was visited last.
    pub view_index: usize,
    /// The time at which the camera path is played.
    pub playback: Playback,
    /// The walk that is being recorded, if any.
    pub recording: Option<Recording>,
    /// The saved view that is being renamed: its index, and the text typed so far.
    pub renaming: Option<(usize, String)>,
    /// Poses before the camera was sent somewhere, the oldest first.
    pub before: Vec<Camera>,
    /// False until the user moves for the first time: the viewport shows how.
    pub has_moved: bool,
}

/// Number of poses to which the camera goes back.
const POSES: usize = 64;

impl Navigation {
    /// Notes the pose before the camera is sent somewhere.
    pub fn leave_pose(&mut self) {
        let now = *self.fly.camera();
        if self.before.last() != Some(&now) {
            if self.before.len() == POSES {
                self.before.remove(0);
            }
            self.before.push(now);
        }
    }

    /// Returns the pose to go back to, and forgets it.
    pub fn pose_before(&mut self) -> Option<Camera> {
        let now = *self.fly.camera();
        while let Some(pose) = self.before.pop() {
            if pose != now {
                return Some(pose);
            }
        }
        None
    }
}
