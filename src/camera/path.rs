//! Walks: key-framed or recorded, the same numbers on every machine.

use crate::camera::Camera;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;

/// A pose on a walk.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CameraKey {
    /// Eye, world metres.
    pub eye: DVec3,
    /// A point looked at, world metres.
    pub at: DVec3,
}

/// A walk through key frames, as stored in a file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CameraPath {
    /// Vertical field of view in degrees.
    pub fov_y_deg: f64,
    /// Number of frames when nothing else is asked for.
    #[serde(default = "default_frames")]
    pub frames: u32,
    /// Visited in order. Eyes are joined by straight lines, so that a walk tested free of obstacles stays so.
    pub keyframes: Vec<CameraKey>,
}

fn default_frames() -> u32 {
    300
}

impl CameraPath {
    /// The most frames a walk may have when nothing else is asked for: five hours at 60 a second.
    pub const MAX_FRAMES: u32 = 1_000_000;

    /// Once around from where a camera stands.
    pub fn turning(camera: &Camera) -> Self {
        let key = |quarter: i32| {
            let turned = Camera { yaw: camera.yaw + f64::from(quarter) * FRAC_PI_2, ..*camera };
            CameraKey { eye: camera.eye, at: camera.eye + turned.forward() }
        };
        Self { fov_y_deg: camera.fov_y.to_degrees(), frames: 120, keyframes: (0..=4).map(key).collect() }
    }

    /// A walk that stays where it is.
    pub fn still(camera: &Camera) -> Self {
        let key = CameraKey { eye: camera.eye, at: camera.eye + camera.forward() };
        Self { fov_y_deg: camera.fov_y.to_degrees(), frames: default_frames(), keyframes: vec![key] }
    }

    /// Length of the way of the eye in metres.
    pub fn length_m(&self) -> f64 {
        self.keyframes.windows(2).map(|k| k[0].eye.distance(k[1].eye)).sum()
    }

    /// The camera at frame `index` of `count`, the last one at the end of the walk. `None` without key frames.
    ///
    /// The eye moves at constant speed; a key frame that only turns takes the time of walking half a metre per
    /// quarter turn. The direction turns along the shorter way, eased so that it has no kinks.
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
    /// Takes the bytes of a JSON file: a walk, or with `name` an object of walks by their names.
    ///
    /// # Errors
    /// What is wrong, for people; where the text is no JSON, with its line.
    pub fn from_json(json: &[u8], name: Option<&str>) -> Result<Self, String> {
        /// What the parser quotes may be as long as the file.
        const LONGEST: usize = 200;
        let said = |e: serde_json::Error| e.to_string().chars().take(LONGEST).collect::<String>();
        let walk: Self = match name {
            None => serde_json::from_slice(json).map_err(said)?,
            Some(name) => {
                let mut walks: std::collections::BTreeMap<String, serde_json::Value> =
                    serde_json::from_slice(json).map_err(said)?;
                let found = walks.remove(name).ok_or_else(|| {
                    let names: Vec<&str> = walks.keys().map(String::as_str).collect();
                    let names: String = names.join(", ").chars().take(LONGEST).collect();
                    format!("it has no walk '{name}'; it has: {names}")
                })?;
                serde_json::from_value(found).map_err(said)?
            }
        };
        walk.checked()
    }

    fn checked(self) -> Result<Self, String> {
        /// A light year is 9.5e15 m: what lies farther is a mistake, and its distances soon overflow.
        const FARTHEST_M: f64 = 1e15;
        let near = |p: DVec3| p.abs().max_element() <= FARTHEST_M;
        if self.keyframes.is_empty() || !Camera::FOV_Y_DEGREES.contains(&self.fov_y_deg) {
            return Err("a walk needs keyframes, and fov_y_deg from 1 to 170".to_owned());
        }
        if !(1..=Self::MAX_FRAMES).contains(&self.frames) {
            return Err(format!("frames is {}; a walk has from 1 to {}", self.frames, Self::MAX_FRAMES));
        }
        match self.keyframes.iter().position(|k| !near(k.eye) || !near(k.at)) {
            Some(at) => Err(format!("key frame {at} is more than 1e15 m away from the origin")),
            None => Ok(self),
        }
    }
}

fn heading(key: &CameraKey) -> DVec3 {
    (key.at - key.eye).try_normalize().unwrap_or(DVec3::NEG_Z)
}

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
    }
}
