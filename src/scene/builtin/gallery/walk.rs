//! The named views, and a camera path through all rooms.

use crate::camera::CameraPath;
use crate::scene::NamedView;
use crate::scene::builtin::views::{view, walk as path};

const FOV_Y_DEG: f64 = 60.0;
const FRAMES: u32 = 300;

pub(super) fn views() -> Vec<NamedView> {
    vec![
        view("start", [17.9, 1.6, 22.2], [16.2, 1.75, 13.0], FOV_Y_DEG),
        view("hall", [15.2, 1.6, 10.4], [18.2, 1.9, 20.0], FOV_Y_DEG),
        view("garden room", [26.0, 1.6, 10.6], [31.6, 1.5, 17.6], FOV_Y_DEG),
        view("mirrors", [7.6, 1.6, 3.0], [0.3, 1.6, 5.2], FOV_Y_DEG),
        view("vitrine", [27.6, 1.6, 5.4], [29.0, 1.15, 3.3], FOV_Y_DEG),
        view("railing", [28.6, 2.2, 19.6], [24.0, 1.4, 14.0], FOV_Y_DEG),
        view("salon", [11.6, 1.6, 7.2], [18.4, 1.5, 2.2], FOV_Y_DEG),
        view("long gallery", [7.6, 1.6, 10.6], [3.8, 1.4, 19.0], FOV_Y_DEG),
        view("entrance", [16.4, 1.6, 17.0], [17.2, 1.6, 24.0], FOV_Y_DEG),
    ]
}

/// Returns a camera path from the hall through the long gallery, the mirror room, the salon and the
/// treasury to the garden room and up to its platform.
///
/// The eye stays 1.6 m above the floor, also on the stairs. Where it does not move, only the view
/// turns.
pub(super) fn walk() -> CameraPath {
    const EYE: f64 = 1.6;
    const RAISED: f64 = 2.2;
    let keys = [
        ([17.9, EYE, 22.2], [16.2, 1.75, 13.0]),
        ([17.0, EYE, 18.2], [13.0, 1.6, 15.0]),
        ([17.0, EYE, 14.4], [13.0, 1.6, 12.6]),
        ([15.2, EYE, 12.6], [9.0, 1.6, 12.6]),
        ([10.0, EYE, 12.6], [4.0, 1.5, 14.2]),
        ([6.2, EYE, 12.8], [3.8, 1.4, 18.0]),
        ([5.0, EYE, 13.4], [5.0, 1.5, 20.0]),
        ([5.0, EYE, 13.4], [5.0, 1.6, 9.0]),
        ([5.0, EYE, 9.0], [4.2, 1.6, 4.0]),
        ([5.0, EYE, 6.8], [0.3, 1.6, 4.2]),
        ([4.2, EYE, 5.0], [0.3, 1.6, 3.4]),
        ([5.0, EYE, 3.6], [0.3, 1.6, 4.9]),
        ([6.8, EYE, 4.5], [0.3, 1.6, 4.9]),
        ([6.8, EYE, 4.5], [12.0, 1.6, 4.5]),
        ([10.0, EYE, 4.5], [16.0, 1.5, 3.6]),
        ([13.4, EYE, 5.3], [17.4, 1.4, 2.6]),
        ([17.0, EYE, 6.2], [18.8, 1.5, 0.3]),
        ([20.6, EYE, 5.3], [24.6, 1.6, 4.5]),
        ([24.0, EYE, 4.5], [29.0, 1.3, 3.4]),
        ([27.2, EYE, 4.9], [29.0, 1.15, 3.3]),
        ([28.9, EYE, 5.2], [28.9, 1.1, 3.3]),
        ([30.6, EYE, 5.2], [28.8, 1.15, 3.3]),
        ([29.6, EYE, 6.6], [29.3, 1.5, 12.0]),
        ([29.0, EYE, 9.0], [30.0, 1.6, 17.4]),
        ([29.0, EYE, 12.0], [33.4, 1.7, 15.6]),
        ([29.0, EYE, 14.6], [27.6, 1.6, 18.5]),
        ([29.0, EYE, 16.2], [29.0, 2.0, 22.0]),
        ([29.0, RAISED, 17.7], [29.6, 2.1, 23.0]),
        ([29.0, RAISED, 19.4], [33.8, 2.2, 20.8]),
        ([27.8, RAISED, 19.6], [25.2, 1.7, 15.0]),
        ([26.4, RAISED, 19.2], [24.0, 1.6, 12.6]),
    ];
    path(&keys, FRAMES, FOV_Y_DEG)
}
