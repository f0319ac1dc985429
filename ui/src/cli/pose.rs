//! From flags to a camera in a scene.

use super::failure::Failure;
use super::flags::{Flags, point};
use afterimage::{Camera, Scene};
use glam::DVec3;

/// Degrees, where neither the flags nor the scene say otherwise.
const DEFAULT_FOV_Y: f64 = 60.0;

/// The camera that the flags ask for; the scene's first view when they do not.
pub(crate) fn camera(flags: &Flags, scene: &Scene) -> Result<Camera, Failure> {
    let degrees = |found: &Camera| flags.fov_y.unwrap_or(found.fov_y.to_degrees());
    let seen = |found: &Camera| Camera { fov_y: degrees(found).to_radians(), ..*found };
    match (flags.eye, flags.look_at, &flags.view) {
        (Some(eye), Some(at), _) => look(eye, at, flags.fov_y.unwrap_or(DEFAULT_FOV_Y)),
        (Some(_), None, _) => Err(Failure::Usage("--eye needs --look-at beside it".to_owned())),
        (None, Some(_), _) => Err(Failure::Usage("--look-at needs --eye beside it".to_owned())),
        (None, None, Some(name)) => named(scene, name).map(seen),
        (None, None, None) => Ok(seen(scene.start())),
    }
}

fn look(eye: DVec3, at: DVec3, fov_y: f64) -> Result<Camera, Failure> {
    if eye == at {
        return Err(Failure::Usage(
            "--eye and --look-at are the same point; they give no direction".to_owned(),
        ));
    }
    Ok(Camera::look_at(eye, at, fov_y))
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
