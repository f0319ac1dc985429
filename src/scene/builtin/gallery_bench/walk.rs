//! The named views, and a camera path through all rooms.

use crate::camera::CameraPath;
use crate::scene::NamedView;
use crate::scene::builtin::views::{view, walk as path};

const FOV_Y_DEG: f64 = 60.0;
const FRAMES: u32 = 300;

pub(super) fn views() -> Vec<NamedView> {
    vec![
        view("start", [17.9, 1.6, 22.2], [16.3, 1.55, 13.0], FOV_Y_DEG),
        view("hall", [15.2, 1.6, 10.4], [19.0, 1.5, 20.0], FOV_Y_DEG),
        view("mirrors", [7.6, 1.6, 3.0], [0.3, 1.5, 5.4], FOV_Y_DEG),
        view("vitrine", [28.2, 1.6, 5.4], [29.7, 1.15, 3.2], FOV_Y_DEG),
        view("railing", [28.6, 2.2, 19.6], [24.0, 1.4, 14.0], FOV_Y_DEG),
        view("red room", [12.0, 1.6, 6.6], [18.2, 1.5, 1.6], FOV_Y_DEG),
        view("court", [8.0, 1.6, 11.0], [3.6, 1.2, 18.4], FOV_Y_DEG),
    ]
}

/// Returns a camera path from the hall through the court, the mirror room, the red room and the
/// vitrine up to the platform of the terrace.
///
/// The eye stays 1.6 m above the floor, also on the stairs. Where it does not move, only the view
/// turns.
pub(super) fn walk() -> CameraPath {
    const EYE: f64 = 1.6;
    const RAISED: f64 = 2.2;
    let keys = [
        ([18.6, EYE, 22.2], [16.2, 1.6, 12.0]),
        ([17.0, EYE, 18.2], [13.0, 1.5, 15.0]),
        ([17.0, EYE, 14.4], [13.0, 1.5, 12.6]),
        ([15.2, EYE, 12.6], [9.0, 1.6, 12.6]),
        ([10.0, EYE, 12.6], [4.0, 1.5, 14.2]),
        ([6.2, EYE, 12.8], [3.8, 1.4, 18.0]),
        ([5.0, EYE, 13.4], [5.0, 1.3, 18.0]),
        ([5.0, EYE, 13.4], [5.0, 1.6, 9.0]),
        ([5.0, EYE, 9.0], [4.2, 1.6, 4.0]),
        ([5.0, EYE, 6.8], [0.3, 1.5, 4.2]),
        ([4.2, EYE, 5.0], [0.3, 1.5, 3.4]),
        ([5.0, EYE, 3.6], [0.3, 1.5, 4.9]),
        ([6.8, EYE, 4.5], [0.3, 1.5, 4.9]),
        ([6.8, EYE, 4.5], [12.0, 1.6, 4.5]),
        ([10.0, EYE, 4.5], [16.0, 1.6, 3.2]),
        ([14.6, EYE, 4.5], [17.0, 1.6, 1.7]),
        ([18.4, EYE, 4.5], [20.4, 1.6, 0.3]),
        ([24.0, EYE, 4.5], [29.6, 1.3, 3.4]),
        ([27.8, EYE, 4.5], [29.7, 1.15, 3.2]),
        ([29.4, EYE, 4.7], [29.7, 1.1, 3.2]),
        ([30.4, EYE, 5.3], [29.6, 1.15, 3.2]),
        ([29.4, EYE, 6.6], [29.3, 1.4, 12.0]),
        ([29.0, EYE, 9.0], [28.8, 1.5, 17.4]),
        ([29.0, EYE, 14.0], [25.6, 1.2, 17.5]),
        ([29.0, EYE, 16.2], [29.0, 1.9, 22.0]),
        ([29.0, RAISED, 17.7], [29.0, 2.1, 23.0]),
        ([29.0, RAISED, 19.4], [26.1, 1.9, 21.0]),
        ([27.4, RAISED, 19.4], [24.2, 1.5, 15.0]),
        ([26.2, RAISED, 18.9], [24.0, 1.5, 12.6]),
    ];
    path(&keys, FRAMES, FOV_Y_DEG)
}
