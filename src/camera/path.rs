//! Camera paths: key frames, interpolated with the same result on every machine.

use crate::camera::Camera;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;

/// Key frame of a camera path.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CameraKey {
    /// Eye, world metres.
    pub eye: DVec3,
    /// Point that the camera looks at, world metres.
    pub at: DVec3,
}

/// A camera path through key frames, as stored in a file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CameraPath {
    /// Vertical field of view in degrees.
    pub fov_y_deg: f64,
    /// Default number of frames.
    #[serde(default = "default_frames")]
    pub frames: u32,
    /// Key frames in order. Eyes are joined by straight lines, so that a path tested free of
    /// obstacles stays so.
    pub keyframes: Vec<CameraKey>,
}

fn default_frames() -> u32 {
    300
}

impl CameraPath {
    /// Maximum default number of frames: five hours at 60 frames per second.
    pub const MAX_FRAMES: u32 = 1_000_000;

    /// Creates a path that turns once around at a camera's position.
    pub fn turning(camera: &Camera) -> Self {
        let key = |quarter: i32| {
            let turned = Camera { yaw: camera.yaw + f64::from(quarter) * FRAC_PI_2, ..*camera };
            CameraKey { eye: camera.eye, at: camera.eye + turned.forward() }
        };
        Self { fov_y_deg: camera.fov_y.to_degrees(), frames: 120, keyframes: (0..=4).map(key).collect() }
    }

    /// Creates a path that stays at a camera's pose.
    pub fn still(camera: &Camera) -> Self {
        let key = CameraKey { eye: camera.eye, at: camera.eye + camera.forward() };
        Self { fov_y_deg: camera.fov_y.to_degrees(), frames: default_frames(), keyframes: vec![key] }
    }

    /// Length of the eye's path in metres.
    pub fn length_m(&self) -> f64 {
        self.keyframes.windows(2).map(|k| k[0].eye.distance(k[1].eye)).sum()
    }

    /// Returns the camera at frame `index` of `count`. The last frame is at the end of the path.
    /// `None` without key frames.
    ///
    /// The eye moves at constant speed; a segment that only turns takes as long as walking half a
    /// metre per quarter turn. The direction turns along the shorter way, with an ease-in and
    /// ease-out that avoids sudden changes.
    pub fn camera(&self, index: u32, count: u32) -> Option<Camera> {
        let first = self.keyframes.first()?;
        let costs: Vec<f64> = self.keyframes.windows(2).map(|k| segment_cost(&k[0], &k[1])).collect();
        let total: f64 = costs.iter().sum();
        if self.keyframes.len() == 1 || total <= 0.0 {
            return Some(Camera::look_at(first.eye, first.at, self.fov_y_deg));
        }
        let mut left = total * f64::from(index) / f64::from(count.max(2) - 1);
        let mut segment = 0;
        while segment + 1 < costs.len() && left > costs[segment] {
            left -= costs[segment];
            segment += 1;
        }
        let s = if costs[segment] > 0.0 { (left / costs[segment]).clamp(0.0, 1.0) } else { 1.0 };
        Some(between(&self.keyframes[segment], &self.keyframes[segment + 1], s, self.fov_y_deg))
    }
}

#[cfg(feature = "import")]
impl CameraPath {
    /// Reads a JSON file: a camera path or, with `name`, an object of camera paths by name.
    ///
    /// # Errors
    /// [`CameraPathError`] if the text is not such JSON, or the path is not valid.
    pub fn from_json(json: &[u8], name: Option<&str>) -> Result<Self, CameraPathError> {
        let path: Self = match name {
            None => serde_json::from_slice(json)?,
            Some(name) => {
                let mut paths: std::collections::BTreeMap<String, serde_json::Value> =
                    serde_json::from_slice(json)?;
                let Some(found) = paths.remove(name) else {
                    let names = paths.into_keys().collect::<Vec<_>>().join(", ");
                    return Err(CameraPathError::UnknownName {
                        name: name.to_owned(),
                        names: shortened(&names),
                    });
                };
                serde_json::from_value(found)?
            }
        };
        path.checked()
    }

    /// True where a path read from a file may have these values.
    pub fn is_valid(&self) -> bool {
        self.clone().checked().is_ok()
    }

    fn checked(self) -> Result<Self, CameraPathError> {
        /// A light year is 9.5e15 m. Larger coordinates are a mistake, and their distances would
        /// soon overflow.
        const MAX_COORDINATE_M: f64 = 1e15;
        let is_near = |p: DVec3| p.abs().max_element() <= MAX_COORDINATE_M;
        if self.keyframes.is_empty() {
            return Err(CameraPathError::NoKeyFrames);
        }
        if !Camera::FOV_Y_DEGREES.contains(&self.fov_y_deg) {
            return Err(CameraPathError::FieldOfView(self.fov_y_deg));
        }
        if !(1..=Self::MAX_FRAMES).contains(&self.frames) {
            return Err(CameraPathError::Frames(self.frames));
        }
        match self.keyframes.iter().position(|k| !is_near(k.eye) || !is_near(k.at)) {
            Some(index) => Err(CameraPathError::TooFar(index)),
            None => Ok(self),
        }
    }
}

/// A camera path could not be read.
#[cfg(feature = "import")]
#[derive(Debug, thiserror::Error)]
pub enum CameraPathError {
    /// The text is not the JSON of a camera path. Holds the parser's message with line and column.
    #[error("{0}")]
    Json(String),
    /// The file has no camera path of this name.
    #[error("it has no camera path '{name}'; it has: {names}")]
    UnknownName {
        /// Name that was asked for.
        name: String,
        /// Names in the file.
        names: String,
    },
    /// There are no key frames.
    #[error("a camera path needs keyframes")]
    NoKeyFrames,
    /// The field of view is outside [`Camera::FOV_Y_DEGREES`].
    #[error("fov_y_deg is {0}; it must be from 1 to 170")]
    FieldOfView(f64),
    /// The number of frames is outside 1..=[`CameraPath::MAX_FRAMES`].
    #[error("frames is {0}; a camera path has from 1 to {max}", max = CameraPath::MAX_FRAMES)]
    Frames(u32),
    /// The key frame of this index is too far away.
    #[error("key frame {0} is more than 1e15 m away from the origin")]
    TooFar(usize),
}

#[cfg(feature = "import")]
impl From<serde_json::Error> for CameraPathError {
    fn from(error: serde_json::Error) -> Self {
        Self::Json(shortened(&error.to_string()))
    }
}

/// Limits a text that may quote the whole file.
#[cfg(feature = "import")]
fn shortened(text: &str) -> String {
    text.chars().take(200).collect()
}

fn heading(key: &CameraKey) -> DVec3 {
    (key.at - key.eye).try_normalize().unwrap_or(DVec3::NEG_Z)
}

/// Returns the duration of a segment, as the distance in metres that takes equally long.
fn segment_cost(a: &CameraKey, b: &CameraKey) -> f64 {
    const METRES_PER_RADIAN: f64 = 0.5 / std::f64::consts::FRAC_PI_2;
    a.eye.distance(b.eye).max(METRES_PER_RADIAN * heading(a).angle_between(heading(b)))
}

fn between(a: &CameraKey, b: &CameraKey, s: f64, fov_y_deg: f64) -> Camera {
    let eased = s * s * (3.0 - 2.0 * s);
    let from = Camera::look_at(a.eye, a.at, fov_y_deg);
    let to = Camera::look_at(b.eye, b.at, fov_y_deg);
    let turn =
        (to.yaw - from.yaw + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI;
    Camera {
        eye: a.eye.lerp(b.eye, s),
        yaw: from.yaw + turn * eased,
        pitch: from.pitch + (to.pitch - from.pitch) * eased,
        fov_y: from.fov_y,
        roll: 0.0,
    }
}
