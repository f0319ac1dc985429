//! Camera paths: played, made key by key, and recorded.

use afterimage::Camera;
use afterimage::camera::{CameraKey, CameraPath};

/// Frames of a path per second of playing.
pub const FRAMES_PER_SEC: f64 = 30.0;

/// Time in seconds for each key: turning takes time even without moving.
const SECS_PER_KEY: f64 = 1.0;

/// Poses recorded per second: a key every 25 cm at walking speed.
const RECORDS_PER_SEC: f64 = 10.0;

/// How the camera path of the window is played.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Playback {
    /// Time since the start of the path, in seconds.
    pub at_secs: f64,
    /// True while the path is being played.
    pub is_playing: bool,
    /// The path starts again at its end.
    pub loops: bool,
}

impl Playback {
    /// Pauses at a time of a path, at its end if the time is later.
    pub fn pause_at(&mut self, path: &CameraPath, at_secs: f64) {
        (self.at_secs, self.is_playing) = (at_secs.min(path_secs(path)), false);
    }

    /// Plays from the current time, from the start where the path is at its end, or pauses.
    pub fn toggle(&mut self, path: &CameraPath) {
        self.is_playing = !self.is_playing && !path.keyframes.is_empty();
        if self.is_playing && self.at_secs >= path_secs(path) {
            self.at_secs = 0.0;
        }
    }

    /// Advances the time; returns the pose while the path is played.
    pub fn advance(&mut self, path: &CameraPath, secs: f64) -> Option<Camera> {
        if !self.is_playing {
            return None;
        }
        self.at_secs += secs;
        let end = path_secs(path);
        if self.at_secs >= end {
            self.is_playing = self.loops;
            self.at_secs = if self.loops { self.at_secs % end } else { end };
        }
        self.camera(path)
    }

    /// Returns the pose at the current time.
    pub fn camera(&self, path: &CameraPath) -> Option<Camera> {
        // Finer than frames: a display may be faster than [`FRAMES_PER_SEC`].
        const PARTS: u32 = 1_000_000;
        let part = (self.at_secs / path_secs(path)).clamp(0.0, 1.0) * f64::from(PARTS);
        path.camera(part.round() as u32, PARTS + 1)
    }
}

/// Returns the duration of a path in seconds.
pub fn path_secs(path: &CameraPath) -> f64 {
    f64::from(path.frames.max(2) - 1) / FRAMES_PER_SEC
}

/// Returns the seconds from each key of a path to the next one.
pub fn key_secs(path: &CameraPath) -> Vec<f64> {
    let costs = path.segment_costs();
    let (sum, secs): (f64, f64) = (costs.iter().sum(), path_secs(path));
    let is_exact = path.has_times() && (sum - secs).abs() <= 1.0 / FRAMES_PER_SEC;
    match sum > 0.0 {
        // The number of frames rounds them.
        true if is_exact => costs,
        true => costs.iter().map(|cost| cost * secs / sum).collect(),
        false => vec![secs / costs.len().max(1) as f64; costs.len()],
    }
}

/// Returns a path whose keys take these times to the next one each, in seconds.
fn with_secs(path: &CameraPath, secs: &[f64]) -> CameraPath {
    let mut timed = path.clone();
    for (i, key) in timed.keyframes.iter_mut().enumerate() {
        key.secs = secs.get(i).map(|secs| secs.clamp(0.0, CameraKey::MAX_SECS));
    }
    let sum: f64 = timed.keyframes.iter().filter_map(|key| key.secs).sum();
    timed.frames =
        (sum * FRAMES_PER_SEC).round().clamp(1.0, f64::from(CameraPath::MAX_FRAMES - 1)) as u32 + 1;
    timed
}

/// Returns the user's path with one more key, at a pose. The first key starts a path. Times that
/// were set stay.
pub fn with_key(own: Option<&CameraPath>, camera: &Camera) -> CameraPath {
    let mut keyframes = own.map_or_else(Vec::new, |path| path.keyframes.clone());
    keyframes.push(key_of(camera));
    let longer = path_of(keyframes, camera);
    match own.filter(|path| path.has_times()) {
        Some(own) => {
            let last =
                longer.keyframes[own.keyframes.len() - 1..].iter().map(|key| CameraKey::new(key.eye, key.at));
            let last = CameraPath { keyframes: last.collect(), ..longer.clone() };
            let stroll = last.segment_costs().iter().sum::<f64>() / CameraPath::STROLL_M_PER_S;
            with_secs(&longer, &[key_secs(own), vec![stroll + SECS_PER_KEY]].concat())
        }
        None => longer,
    }
}

/// Returns a path whose key of this index is at a pose. It takes as long as before.
pub fn with_key_moved(path: &CameraPath, index: usize, camera: &Camera) -> CameraPath {
    let mut moved = path.clone();
    if let Some(key) = moved.keyframes.get_mut(index) {
        *key = CameraKey { secs: key.secs, ..key_of(camera) };
    }
    moved
}

/// Returns a path whose key of this index takes a time to the next one, in seconds. The others take
/// as long as before.
pub fn with_key_secs(path: &CameraPath, index: usize, secs: f64) -> CameraPath {
    let mut all = key_secs(path);
    if let Some(place) = all.get_mut(index) {
        *place = secs;
    }
    with_secs(path, &all)
}

/// Returns a path that takes this number of seconds, each key in the same proportion as before.
pub fn lasting(path: &CameraPath, secs: f64) -> CameraPath {
    let all = key_secs(path);
    let sum: f64 = all.iter().sum();
    with_secs(path, &all.iter().map(|part| part * secs / sum.max(f64::MIN_POSITIVE)).collect::<Vec<f64>>())
}

/// Number of pictures of a film of a path, with `rate` pictures per second.
pub fn film_frames(path: &CameraPath, rate: u32) -> u32 {
    (path_secs(path) * f64::from(rate)).round() as u32 + 1
}

/// Returns the pose at a key of a path.
pub fn key_pose(path: &CameraPath, index: usize) -> Option<Camera> {
    let key = path.keyframes.get(index)?;
    Some(Camera::look_at(key.eye, key.at, path.fov_y_deg))
}

/// Returns a path without the key of this index. Where times were set, it takes as long as before
/// between the keys around it.
pub fn without_key(path: &CameraPath, index: usize) -> CameraPath {
    let mut keyframes = path.keyframes.clone();
    if index >= keyframes.len() {
        return path.clone();
    }
    keyframes.remove(index);
    let shorter = path_of(keyframes, &Camera { fov_y: path.fov_y_deg.to_radians(), ..CAMERA_OF_NO_PLACE });
    if !path.has_times() || shorter.keyframes.is_empty() {
        return shorter;
    }
    let mut secs = key_secs(path);
    let gone = if index < secs.len() { secs.remove(index) } else { 0.0 };
    if let Some(before) = index.checked_sub(1).and_then(|before| secs.get_mut(before)) {
        *before += gone;
    }
    with_secs(&shorter, &secs[..shorter.keyframes.len() - 1])
}

const CAMERA_OF_NO_PLACE: Camera =
    Camera { eye: glam::DVec3::ZERO, yaw: 0.0, pitch: 0.0, fov_y: 1.0, roll: 0.0 };

fn key_of(camera: &Camera) -> CameraKey {
    CameraKey::new(camera.eye, camera.eye + camera.forward())
}

fn path_of(keyframes: Vec<CameraKey>, camera: &Camera) -> CameraPath {
    let mut path = CameraPath { fov_y_deg: camera.fov_y.to_degrees(), frames: 1, keyframes };
    let secs = path.length_m() / CameraPath::STROLL_M_PER_S + SECS_PER_KEY * path.keyframes.len() as f64;
    path.frames = (secs * FRAMES_PER_SEC).round().max(1.0) as u32;
    path
}

/// A path that is being recorded.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Recording {
    keyframes: Vec<CameraKey>,
    fov_y_deg: f64,
    secs: f64,
    next_secs: f64,
}

impl Recording {
    /// Notes the pose after `secs` have passed.
    pub fn note(&mut self, camera: &Camera, secs: f64) {
        self.secs += secs;
        if self.secs < self.next_secs && !self.keyframes.is_empty() {
            return;
        }
        self.next_secs = self.secs + 1.0 / RECORDS_PER_SEC;
        self.fov_y_deg = camera.fov_y.to_degrees();
        let key = key_of(camera);
        // Standing still is not part of a path: times between keys follow from distance and
        // turning.
        if self.keyframes.last() != Some(&key) {
            self.keyframes.push(key);
        }
    }

    /// Returns the duration of the recording in seconds.
    pub fn secs(&self) -> f64 {
        self.secs
    }

    /// Returns the path, with one frame per 1/30 s of the recording; `None` where the camera has
    /// not moved.
    pub fn finish(self) -> Option<CameraPath> {
        let frames = (self.secs * FRAMES_PER_SEC).round().clamp(2.0, 1e6) as u32;
        let path = CameraPath { fov_y_deg: self.fov_y_deg, frames, keyframes: self.keyframes };
        (path.keyframes.len() > 1).then_some(path)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn at(x: f64) -> Camera {
        Camera { eye: DVec3::new(x, 1.6, 0.0), ..CAMERA_OF_NO_PLACE }
    }

    #[test]
    fn a_path_is_made_and_unmade_key_by_key() {
        let path = with_key(Some(&with_key(None, &at(0.0))), &at(7.0));
        assert_eq!(path.keyframes.len(), 2);
        assert!((path_secs(&path) - (5.0 + 2.0)).abs() < 0.1, "{}", path_secs(&path));
        assert_eq!(without_key(&path, 0).keyframes.len(), 1);
        assert_eq!(without_key(&path, 2).keyframes.len(), 2);
    }

    #[test]
    fn each_key_has_a_time_of_its_own() {
        let path = with_key(Some(&with_key(Some(&with_key(None, &at(0.0))), &at(7.0))), &at(14.0));
        let even = key_secs(&path);
        assert!((even[0] - even[1]).abs() < 1e-9 && (even[0] + even[1] - path_secs(&path)).abs() < 1e-9);
        let slow = with_key_secs(&path, 1, 20.0);
        assert_eq!(key_secs(&slow), [even[0], 20.0]);
        assert!((path_secs(&slow) - 20.0 - even[0]).abs() < 1.0 / FRAMES_PER_SEC);
        let mut playback = Playback { at_secs: even[0] + 10.0, is_playing: true, ..Playback::default() };
        let middle = playback.advance(&slow, 0.0).unwrap();
        assert!((middle.eye.x - 10.5).abs() < 0.02, "{middle:?}");
        assert_eq!(film_frames(&slow, 25), (path_secs(&slow) * 25.0).round() as u32 + 1);
        let longer = with_key(Some(&slow), &at(14.0));
        assert_eq!(key_secs(&longer), [even[0], 20.0, SECS_PER_KEY], "times that were set stay");
        assert!((path_secs(&lasting(&longer, 60.0)) - 60.0).abs() < 1e-9);
        let shorter = without_key(&longer, 1);
        assert_eq!(key_secs(&shorter), [even[0] + 20.0, SECS_PER_KEY]);
        assert_eq!(key_secs(&without_key(&shorter, 2)), [even[0] + 20.0]);
        assert_eq!(key_secs(&without_key(&shorter, 0)), [SECS_PER_KEY]);
        let moved = with_key_moved(&slow, 1, &at(1.0));
        assert_eq!(key_secs(&moved), key_secs(&slow));
        assert_eq!(without_key(&without_key(&slow, 0), 0).keyframes.len(), 1);
    }

    #[test]
    fn a_path_plays_to_its_end_and_starts_again_when_looping() {
        let mut playback = Playback::default();
        let path = CameraPath::default();
        assert_eq!(playback.advance(&path, 1.0), None);
        playback.toggle(&path);
        assert!(!playback.is_playing, "nothing to play");
        let path = with_key(Some(&with_key(None, &at(0.0))), &at(7.0));
        playback.toggle(&path);
        let half = playback.advance(&path, path_secs(&path) / 2.0).unwrap();
        assert!((half.eye.x - 3.5).abs() < 1e-3, "{half:?}");
        assert!((playback.advance(&path, 100.0).unwrap().eye.x - 7.0).abs() < 1e-9);
        assert!(!playback.is_playing);
        playback.loops = true;
        playback.toggle(&path);
        let again = playback.advance(&path, path_secs(&path) * 1.25).unwrap();
        assert!(playback.is_playing && (again.eye.x - 1.75).abs() < 1e-3, "{again:?}");
    }

    #[test]
    fn a_recording_is_a_path_of_the_same_duration() {
        let mut recording = Recording::default();
        for i in 0..120 {
            recording.note(&at(f64::from(i) * 0.05), 1.0 / 60.0);
        }
        let path = recording.finish().unwrap();
        assert_eq!(path.frames, 60);
        assert!((18..=21).contains(&path.keyframes.len()), "{}", path.keyframes.len());
        let mut still = Recording::default();
        (0..60).for_each(|_| still.note(&at(1.0), 0.1));
        assert_eq!(still.finish(), None);
    }
}
