//! Where the user is, and how he moves.

use crate::window::input::fly_camera::FlyCamera;
use crate::window::input::playback::{Playback, Recording};
use afterimage::Camera;

/// The camera, the saved view it was last at, and the camera path.
#[derive(Clone, Debug)]
pub struct Navigation {
    /// The camera.
    pub fly: FlyCamera,
    /// Index of the saved view that was visited last.
    pub view_index: usize,
    /// The camera path.
    pub playback: Playback,
    /// The walk that is being recorded, if any.
    pub recording: Option<Recording>,
    /// The saved view that is being renamed: its index, and the text typed so far.
    pub renaming: Option<(usize, String)>,
    /// True until the user moves for the first time: the viewport shows how.
    pub shows_hint: bool,
}

impl Navigation {
    /// At a pose, with no camera path.
    pub fn new(camera: Camera) -> Self {
        Self {
            fly: FlyCamera::new(camera),
            view_index: 0,
            playback: Playback::default(),
            recording: None,
            renaming: None,
            shows_hint: true,
        }
    }
}
