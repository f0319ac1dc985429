//! The views of the session that the window has saved next to a model.

use crate::cli::output;
use afterimage::Camera;
use afterimage::raster::load::read_bounded;
use afterimage::scene::NamedView;
use serde::Deserialize;
use std::path::Path;

/// Extension of session files.
const EXTENSION: &str = "afterimage-session.toml";

/// Maximum size of a session file, bytes.
const MAX_BYTES: u64 = 64 << 20;

/// The part of a session that is read here.
#[derive(Deserialize)]
struct Session {
    #[serde(default)]
    views: Vec<View>,
}

#[derive(Deserialize)]
struct View {
    name: String,
    camera: Camera,
}

/// Returns the views of the session next to a model; none where there is no session. One that
/// cannot be read is left out with a warning.
pub(super) fn beside(model: &Path) -> Vec<NamedView> {
    let path = model.with_extension(EXTENSION);
    if !path.is_file() {
        return Vec::new();
    }
    match read(&path) {
        Ok(views) => views,
        Err(error) => {
            output::say(&format!("warning: the views of {} are left out: {error:#}", path.display()));
            Vec::new()
        }
    }
}

fn read(path: &Path) -> anyhow::Result<Vec<NamedView>> {
    let text = String::from_utf8(read_bounded(path, MAX_BYTES)?)?;
    let session: Session = toml::from_str(&text)?;
    let valid = session.views.into_iter().filter(|view| view.camera.is_valid());
    Ok(valid.map(|view| NamedView { name: view.name, camera: view.camera }).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_are_read_and_broken_ones_are_left_out() {
        let folder = tempfile::tempdir().unwrap();
        let model = folder.path().join("house.obj");
        assert!(beside(&model).is_empty());
        let session = folder.path().join("house.afterimage-session.toml");
        let view = |name: &str, fov: f64| {
            format!(
                "[[views]]\nname = \"{name}\"\n[views.camera]\neye = [1.0, 1.6, 2.0]\nyaw = 0.5\npitch = 0.0\nfov_y = {fov}\n"
            )
        };
        std::fs::write(&session, format!("version = 2\n{}{}", view("desk", 1.0), view("bad", 9.0))).unwrap();
        let views = beside(&model);
        assert_eq!(views.iter().map(|v| v.name.as_str()).collect::<Vec<_>>(), ["desk"]);
        assert_eq!(views[0].camera.yaw, 0.5);
        std::fs::write(&session, "views = 3").unwrap();
        assert!(beside(&model).is_empty());
    }
}
