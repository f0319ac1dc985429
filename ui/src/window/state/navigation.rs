//! Position and motion of the user.

use crate::window::input::{FlyCamera, Playback, Recording};

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
    /// False until the user moves for the first time: the viewport shows how.
    pub has_moved: bool,
}
