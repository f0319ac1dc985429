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
    /// Time from this key frame to the next one, seconds. `None` takes as long as strolling there;
    /// where no key frame has a time, the eye moves at constant speed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub secs: Option<f64>,
}

impl CameraKey {
    /// Largest time of a key frame in seconds: an hour.
    pub const MAX_SECS: f64 = 3600.0;

    /// Returns a key frame without a time of its own.
    pub fn new(eye: DVec3, at: DVec3) -> Self {
        Self { eye, at, secs: None }
    }
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
    /// Speed between key frames where one has no time and others do: strolling, in metres per
    /// second.
    pub const STROLL_M_PER_S: f64 = 1.4;

    /// Maximum default number of frames: five hours at 60 frames per second.
    pub const MAX_FRAMES: u32 = 1_000_000;

    /// Creates a path that turns once around at a camera's position.
    pub fn turning(camera: &Camera) -> Self {
        let key = |quarter: i32| {
            let turned = Camera { yaw: camera.yaw + f64::from(quarter) * FRAC_PI_2, ..*camera };
            CameraKey::new(camera.eye, camera.eye + turned.forward())
        };
        Self { fov_y_deg: camera.fov_y.to_degrees(), frames: 120, keyframes: (0..=4).map(key).collect() }
    }

    /// Creates a path that stays at a camera's pose.
    pub fn still(camera: &Camera) -> Self {
        let key = CameraKey::new(camera.eye, camera.eye + camera.forward());
        Self { fov_y_deg: camera.fov_y.to_degrees(), frames: default_frames(), keyframes: vec![key] }
    }

    /// Length of the eye's path in metres.
    pub fn length_m(&self) -> f64 {
        self.keyframes.windows(2).map(|k| k[0].eye.distance(k[1].eye)).sum()
    }

    /// True where a key frame has a time of its own.
    pub fn has_times(&self) -> bool {
        self.keyframes.iter().rev().skip(1).any(|key| key.secs.is_some())
    }

    /// Returns what each segment takes, as shares of the whole: seconds where a key frame has a
    /// time, metres otherwise.
    pub fn segment_costs(&self) -> Vec<f64> {
        let has_times = self.has_times();
        let cost = |k: &[CameraKey]| match k[0].secs {
            Some(secs) => secs,
            None if has_times => segment_cost(&k[0], &k[1]) / Self::STROLL_M_PER_S,
            None => segment_cost(&k[0], &k[1]),
        };
        self.keyframes.windows(2).map(cost).collect()
    }

    /// Returns the camera at frame `index` of `count`. The last frame is at the end of the path.
    /// `None` without key frames.
    ///
    /// Key frames with times share the path in proportion to these. Without any, the eye moves at
    /// constant speed; a segment that only turns takes as long as walking half a metre per quarter
    /// turn. The direction turns along the shorter way, with an ease-in and
    /// ease-out that avoids sudden changes.
    pub fn camera(&self, index: u32, count: u32) -> Option<Camera> {
        let first = self.keyframes.first()?;
        let costs = self.segment_costs();
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
        let is_time = |secs: f64| (0.0..=CameraKey::MAX_SECS).contains(&secs);
        if let Some(index) = self.keyframes.iter().position(|k| !k.secs.is_none_or(is_time)) {
            return Err(CameraPathError::Time(index));
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
    /// The time of the key frame of this index is outside 0..=[`CameraKey::MAX_SECS`].
    #[error("secs of key frame {0} must be from 0 to 3600")]
    Time(usize),
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

#[cfg(test)]
mod tests {
    use super::*;

    fn key(x: f64, secs: Option<f64>) -> CameraKey {
        CameraKey { secs, ..CameraKey::new(DVec3::X * x, DVec3::new(x, 0.0, -1.0)) }
    }

    fn path(keyframes: Vec<CameraKey>) -> CameraPath {
        CameraPath { fov_y_deg: 60.0, frames: 100, keyframes }
    }

    /// Returns where the eye is after a part of the path, in thousandths.
    fn x(path: &CameraPath, part: u32) -> f64 {
        path.camera(part, 1001).map_or(f64::NAN, |camera| camera.eye.x)
    }

    #[test]
    fn key_frames_take_the_times_that_they_have() {
        let timed =
            path(vec![key(0.0, Some(1.0)), key(9.0, Some(4.0)), key(9.0, Some(5.0)), key(10.0, None)]);
        for (part, expected) in
            [(0, 0.0), (50, 4.5), (100, 9.0), (300, 9.0), (500, 9.0), (750, 9.5), (1000, 10.0)]
        {
            assert!((x(&timed, part) - expected).abs() < 1e-9, "{part}: {}", x(&timed, part));
        }
        let even = path(vec![key(0.0, None), key(9.0, None), key(10.0, Some(3.0))]);
        assert!((x(&even, 500) - 5.0).abs() < 1e-9, "after the last key frame nothing follows");
        let mixed = path(vec![key(0.0, None), key(1.4, Some(3.0)), key(2.0, None)]);
        assert!((x(&mixed, 250) - 1.4).abs() < 1e-9, "strolling takes a second");
        let still = path(vec![key(2.0, Some(0.0)), key(5.0, None)]);
        assert_eq!(x(&still, 500), 2.0);
    }

    #[test]
    #[cfg(feature = "import")]
    fn times_are_read_checked_and_left_out_where_there_are_none() {
        let text = r#"{"fov_y_deg": 60, "keyframes": [{"eye": [0,0,0], "at": [1,0,0]}]}"#;
        let old = CameraPath::from_json(text.as_bytes(), None).expect("a path");
        assert_eq!(old.keyframes[0].secs, None);
        assert!(!serde_json::to_string(&old).expect("text").contains("secs"));
        for (secs, is_valid) in [("2.5", true), ("0", true), ("-1", false), ("3601", false)] {
            let text = text.replace("\"at\"", &format!("\"secs\": {secs}, \"at\""));
            assert_eq!(CameraPath::from_json(text.as_bytes(), None).is_ok(), is_valid, "{secs}");
        }
    }
}
