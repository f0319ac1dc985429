//! Selects the camera that the flags describe.

use super::{failure::Failure, flags::Flags};
use crate::picture::pose_text::{SAME_POINT, parse_point};
use afterimage::{Camera, Scene};
use glam::DVec3;

/// Default vertical field of view, in degrees, of a pose given by flags.
const DEFAULT_FOV_Y: f64 = 60.0;

/// Checks that a pose is complete, before the scene is loaded.
pub(crate) fn check(flags: &Flags) -> Result<(), Failure> {
    match (flags.eye, flags.look_at) {
        (Some(_), None) => Err(Failure::Usage("--eye needs --look-at too".to_owned())),
        (None, Some(_)) => Err(Failure::Usage("--look-at needs --eye too".to_owned())),
        (Some(eye), Some(at)) if eye == at => Err(Failure::Usage(SAME_POINT.to_owned())),
        _ => Ok(()),
    }
}

/// The camera at the pose given by `--eye` and `--look-at`, if both are given.
pub(crate) fn given(flags: &Flags) -> Option<Camera> {
    let degrees = flags.fov_y_deg().unwrap_or(DEFAULT_FOV_Y);
    let roll = flags.roll.unwrap_or(0.0).to_radians();
    Some(Camera { roll, ..Camera::look_at(flags.eye?, flags.look_at?, degrees) })
}

/// The camera at the pose or view given by the flags, or at the scene's first view. The flags must
/// have passed [`check`].
pub(crate) fn camera(flags: &Flags, scene: &Scene) -> Result<Camera, Failure> {
    let degrees = |found: &Camera| flags.fov_y_deg().unwrap_or(found.fov_y.to_degrees());
    let with_fov = |found: &Camera| Camera { fov_y: degrees(found).to_radians(), ..*found };
    match (given(flags), &flags.view) {
        (Some(camera), _) => Ok(camera),
        (None, Some(name)) => named(scene, name).map(with_fov),
        (None, None) => Ok(with_fov(scene.start())),
    }
}

fn named<'a>(scene: &'a Scene, name: &str) -> Result<&'a Camera, Failure> {
    scene.views.iter().find(|v| v.name == name).map(|v| &v.camera).ok_or_else(|| {
        let known: Vec<&str> = scene.views.iter().map(|v| v.name.as_str()).collect();
        Failure::Usage(format!("{} has no view '{name}'; it has: {}", scene.name, known.join(", ")))
    })
}

/// Parses `EX,EY,EZ:LX,LY,LZ`: the eye and the point that it looks at.
pub(crate) fn eye_and_target(text: &str) -> Result<[DVec3; 2], String> {
    let (eye, at) = text.split_once(':').ok_or("a pose is EX,EY,EZ:LX,LY,LZ")?;
    let point = |text| parse_point(text).map_err(|error| error.to_string());
    let pose = [point(eye)?, point(at)?];
    if pose[0] == pose[1] { Err("the eye and the point looked at are the same".to_owned()) } else { Ok(pose) }
}
