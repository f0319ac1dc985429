//! A camera pose as text: flags of `afterimage render`, as copied to and pasted from the clipboard.

use afterimage::Camera;
use glam::DVec3;

/// Why a text contains no pose.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PoseError(String);

impl std::error::Error for PoseError {}

impl std::fmt::Display for PoseError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

/// The pose of a camera as flags of `afterimage render`.
pub fn pose_flags(camera: &Camera) -> String {
    let list = |v: DVec3| format!("{:.4},{:.4},{:.4}", v.x, v.y, v.z);
    let roll = match camera.roll {
        0.0 => String::new(),
        roll => format!(" --roll {:.3}", roll.to_degrees()),
    };
    format!(
        "--eye {} --look-at {} --fov-y {:.3}{roll}",
        list(camera.eye),
        list(camera.eye + camera.forward()),
        camera.fov_y.to_degrees()
    )
}

/// Finds a pose in a text that contains its flags, such as a whole command line. Without `--fov-y`,
/// the field of view is that of `before`.
///
/// # Errors
/// [`PoseError`] if a flag is missing or invalid.
pub fn pose_of_flags(text: &str, before: &Camera) -> Result<Camera, PoseError> {
    let eye = point(text, "--eye")?;
    let at = point(text, "--look-at")?;
    if eye == at {
        return Err(PoseError(SAME_POINT.to_owned()));
    }
    let fov_y_deg = match value(text, "--fov-y") {
        None => before.fov_y.to_degrees(),
        Some(word) => {
            word.parse().ok().filter(|degrees| Camera::FOV_Y_DEGREES.contains(degrees)).ok_or_else(|| {
                PoseError(format!("--fov-y {word}: a field of view is from 1 to 170 degrees"))
            })?
        }
    };
    let roll_deg = match value(text, "--roll") {
        None => 0.0,
        Some(word) => parse_roll(word).map_err(PoseError)?,
    };
    Ok(Camera { roll: roll_deg.to_radians(), ..Camera::look_at(eye, at, fov_y_deg) })
}

/// Message for a pose whose view direction is undefined.
pub(crate) const SAME_POINT: &str =
    "--eye and --look-at are the same point; the direction of view is undefined";

/// The word after a flag, separated by a space or `=`.
fn value<'a>(text: &'a str, flag: &str) -> Option<&'a str> {
    let mut words = text.split(|c: char| c.is_whitespace() || c == '=' || c == '"' || c == '\'');
    words.find(|word| *word == flag)?;
    words.find(|word| !word.is_empty())
}

fn point(text: &str, flag: &str) -> Result<DVec3, PoseError> {
    let missing = || PoseError(format!("the text has no {flag}; a pose is --eye X,Y,Z --look-at X,Y,Z"));
    let word = value(text, flag).ok_or_else(missing)?;
    parse_point(word).map_err(|PoseError(cause)| PoseError(format!("{flag} {word}: {cause}")))
}

/// Parses a roll in degrees.
///
/// # Errors
/// The message for a text that is not a number from -180 to 180.
pub(crate) fn parse_roll(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|degrees: &f64| degrees.abs() <= 180.0);
    number.ok_or_else(|| format!("--roll {text}: a roll is from -180 to 180 degrees"))
}

/// Parses a point like `-1.5,2,0.25`.
///
/// # Errors
/// [`PoseError`] if the text is not three numbers, or a number is beyond 1e12: there, an `f64`
/// position in metres no longer resolves millimetres.
pub(crate) fn parse_point(text: &str) -> Result<DVec3, PoseError> {
    let number = |t: &str| t.trim().parse::<f64>().ok().filter(|n| n.abs() <= 1e12);
    let numbers: Option<Vec<f64>> = text.split(',').map(number).collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) => Ok(DVec3::new(x, y, z)),
        _ => Err(PoseError("a point is three finite numbers, like -1.5,1.6,0".to_owned())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera::look_at(DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, 2.0, 0.0), 60.0)
    }

    #[test]
    fn a_pose_is_written_as_flags() {
        let flags = "--eye 1.0000,2.0000,3.0000 --look-at 1.0000,2.0000,2.0000 --fov-y 60.000";
        assert_eq!(pose_flags(&camera()), flags);
    }

    #[test]
    fn flags_are_found_within_a_command() {
        let was = Camera { yaw: 1.0, pitch: -0.4, fov_y: 0.7, roll: -0.3, ..camera() };
        let text = format!("afterimage render \"house.obj\" {} -o a.png", pose_flags(&was));
        let pose = pose_of_flags(&text, &camera()).unwrap();
        assert!(pose.eye == was.eye && (pose.yaw - was.yaw).abs() < 1e-3);
        assert!((pose.pitch - was.pitch).abs() < 1e-3 && (pose.fov_y - was.fov_y).abs() < 1e-4);
        assert!((pose.roll - was.roll).abs() < 1e-4);
        let kept = pose_of_flags("--eye=0,1,2 --look-at=-1,1,2", &camera()).unwrap();
        assert_eq!((kept.eye, kept.fov_y), (DVec3::new(0.0, 1.0, 2.0), camera().fov_y));
    }

    #[test]
    fn text_without_a_pose_is_refused() {
        let error = |text| pose_of_flags(text, &camera()).unwrap_err().to_string();
        assert!(error("hello").contains("no --eye"));
        assert!(error("--eye 1,2,3").contains("no --look-at"));
        assert!(error("--eye 1,2 --look-at 0,0,0").contains("three finite numbers"));
        assert!(error("--eye 1,nan,2 --look-at 0,0,0").contains("three finite numbers"));
        assert!(error("--eye 1,2,3 --look-at 1,2,3").contains("same point"));
        assert!(error("--eye 1,2,3 --look-at 0,2,3 --fov-y 500").contains("1 to 170"));
    }
}
