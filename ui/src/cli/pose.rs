//! From flags to a camera in a scene.

use super::failure::Failure;
use super::flags::{Flags, point};
use afterimage::{Camera, Scene};
use glam::DVec3;

/// Degrees, where neither the flags nor the scene say otherwise.
const DEFAULT_FOV_Y: f64 = 60.0;

/// Refuses half a pose, before a scene is loaded for nothing.
pub(crate) fn check(flags: &Flags) -> Result<(), Failure> {
    match (flags.eye, flags.look_at) {
        (Some(_), None) => Err(Failure::Usage("--eye needs --look-at beside it".to_owned())),
        (None, Some(_)) => Err(Failure::Usage("--look-at needs --eye beside it".to_owned())),
        (Some(eye), Some(at)) if eye == at => {
            let text = "--eye and --look-at are the same point; they give no direction";
            Err(Failure::Usage(text.to_owned()))
        }
        _ => Ok(()),
    }
}

/// The camera whose eye and target the flags give, if they do.
pub(crate) fn given(flags: &Flags) -> Option<Camera> {
    let degrees = flags.fov_y.unwrap_or(DEFAULT_FOV_Y);
    Some(Camera::look_at(flags.eye?, flags.look_at?, degrees))
}

/// The camera that the flags ask for, which [`check`] let pass; the scene's first view when they do not.
pub(crate) fn camera(flags: &Flags, scene: &Scene) -> Result<Camera, Failure> {
    let degrees = |found: &Camera| flags.fov_y.unwrap_or(found.fov_y.to_degrees());
    let seen = |found: &Camera| Camera { fov_y: degrees(found).to_radians(), ..*found };
    match (given(flags), &flags.view) {
        (Some(camera), _) => Ok(camera),
        (None, Some(name)) => named(scene, name).map(seen),
        (None, None) => Ok(seen(scene.start())),
    }
}

fn named<'a>(scene: &'a Scene, name: &str) -> Result<&'a Camera, Failure> {
    scene.views.iter().find(|v| v.name == name).map(|v| &v.camera).ok_or_else(|| {
        let known: Vec<&str> = scene.views.iter().map(|v| v.name.as_str()).collect();
        Failure::Usage(format!("{} has no view '{name}'; it has: {}", scene.name, known.join(", ")))
    })
}

/// Reads `EX,EY,EZ:LX,LY,LZ`: an eye and a point to look at.
pub(crate) fn eye_and_target(text: &str) -> Result<[DVec3; 2], String> {
    let (eye, at) = text.split_once(':').ok_or("a pose is EX,EY,EZ:LX,LY,LZ")?;
    let pose = [point(eye)?, point(at)?];
    if pose[0] == pose[1] { Err("the eye and the point looked at are the same".to_owned()) } else { Ok(pose) }
}
