//! A pose as text: the flags of `afterimage render`, to and from the clipboard.

use afterimage::Camera;
use glam::DVec3;

/// A pose as flags of `afterimage render`.
pub fn pose_flags(camera: &Camera) -> String {
    let list = |v: DVec3| format!("{:.4},{:.4},{:.4}", v.x, v.y, v.z);
    format!(
        "--eye {} --look-at {} --fov-y {:.3}",
        list(camera.eye),
        list(camera.eye + camera.forward()),
        camera.fov_y.to_degrees()
    )
}

/// The pose that flags in a text give, anywhere in it: a whole command line will do. The field of view stays what it
/// was where the text names none.
///
/// # Errors
/// What is missing, in words.
pub fn pose_of_flags(text: &str, before: &Camera) -> Result<Camera, String> {
    let eye = point(text, "--eye")?;
    let at = point(text, "--look-at")?;
    if eye == at {
        return Err("--eye and --look-at are the same point; they give no direction".to_owned());
    }
    let fov_y_deg = match value(text, "--fov-y") {
        None => before.fov_y.to_degrees(),
        Some(word) => word
            .parse()
            .ok()
            .filter(|degrees| Camera::FOV_Y_DEGREES.contains(degrees))
            .ok_or_else(|| format!("--fov-y {word}: a field of view is from 1 to 170 degrees"))?,
    };
    Ok(Camera::look_at(eye, at, fov_y_deg))
}

/// The word after a flag or its `=`.
fn value<'a>(text: &'a str, flag: &str) -> Option<&'a str> {
    let mut words = text.split(|c: char| c.is_whitespace() || c == '=' || c == '"' || c == '\'');
    words.find(|word| *word == flag)?;
    words.find(|word| !word.is_empty())
}

fn point(text: &str, flag: &str) -> Result<DVec3, String> {
    let word = value(text, flag)
        .ok_or_else(|| format!("the text has no {flag}; a pose is --eye X,Y,Z --look-at X,Y,Z"))?;
    let numbers: Option<Vec<f64>> =
        word.split(',').map(|n| n.parse().ok().filter(|n: &f64| n.is_finite())).collect();
    match numbers.as_deref() {
        Some(&[x, y, z]) => Ok(DVec3::new(x, y, z)),
        _ => Err(format!("{flag} {word}: a point is three finite numbers, like -1.5,1.6,0")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera::look_at(DVec3::new(1.0, 2.0, 3.0), DVec3::new(1.0, 2.0, 0.0), 60.0)
    }

    #[test]
    fn a_pose_reads_as_flags() {
        let flags = "--eye 1.0000,2.0000,3.0000 --look-at 1.0000,2.0000,2.0000 --fov-y 60.000";
        assert_eq!(pose_flags(&camera()), flags);
    }

    #[test]
    fn flags_give_the_pose_back_also_within_a_command() {
        let was = Camera { yaw: 1.0, pitch: -0.4, fov_y: 0.7, ..camera() };
        let text = format!("afterimage render \"house.obj\" {} -o a.png", pose_flags(&was));
        let pose = pose_of_flags(&text, &camera()).unwrap();
        assert!(pose.eye == was.eye && (pose.yaw - was.yaw).abs() < 1e-3);
        assert!((pose.pitch - was.pitch).abs() < 1e-3 && (pose.fov_y - was.fov_y).abs() < 1e-4);
        let kept = pose_of_flags("--eye=0,1,2 --look-at=-1,1,2", &camera()).unwrap();
        assert_eq!((kept.eye, kept.fov_y), (DVec3::new(0.0, 1.0, 2.0), camera().fov_y));
    }

    #[test]
    fn what_is_no_pose_is_said() {
        let error = |text| pose_of_flags(text, &camera()).unwrap_err();
        assert!(error("hello").contains("no --eye"));
        assert!(error("--eye 1,2,3").contains("no --look-at"));
        assert!(error("--eye 1,2 --look-at 0,0,0").contains("three finite numbers"));
        assert!(error("--eye 1,nan,2 --look-at 0,0,0").contains("three finite numbers"));
        assert!(error("--eye 1,2,3 --look-at 1,2,3").contains("same point"));
        assert!(error("--eye 1,2,3 --look-at 0,2,3 --fov-y 500").contains("1 to 170"));
    }
}
