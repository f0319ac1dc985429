//! The tour of a scene without a display: a dozen frames with their types, the records of all
//! frames, and a page that shows them.

use super::{
    failure::Failure,
    flags::Flags,
    interrupt, output,
    report::{TourPage, write_tour_page},
    scene::{Loaded, load},
    tour::{self, TourArgs},
};
use crate::picture::memory;
use crate::window::state::WINDOW_SAMPLES;
use afterimage::{Camera, FrameRequest, Mode, RenderSettings, Renderer, experiment::tour::Pose};
use clap::Parser;
use glam::DVec3;

/// Folder of the page, the pictures and the records.
const OUT: &str = "afterimage-out";

/// Size of the frames, unless it is given.
const SIZE: [u32; 2] = [640, 360];

/// Number of frames that are written as pictures.
const PICTURES: u32 = 12;

/// Maximum number of frames from one picture to the next.
const MAX_STEPS: u32 = 10;

/// Time that the frames of the tour may take together, seconds.
const TOUR_SECS: f64 = 40.0;

/// Time of a frame with its part of the references, over that of a frame in mode `full`: measured
/// on the gallery's walk of 300 frames, 640x360 pixels, 4 samples. With fewer frames it is higher.
const FRAME_SHARE: f64 = 0.6;

/// Flies the camera path, and writes pictures, records and the page. What is there when it is
/// interrupted is kept.
pub(super) fn run(scene: Option<&str>, flags: &Flags) -> Result<(), Failure> {
    // Frames as cheap as those of the window.
    let samples = flags.samples.or(Some(WINDOW_SAMPLES));
    let flags = &Flags { given_size: flags.given_size.or(Some(SIZE)), samples, ..flags.clone() };
    let [width, height] = flags.size();
    output::say(&format!(
        "no display was found; rendering a tour of the scene at {width}x{height} into {OUT}/"
    ));
    memory::check(flags.pixels(), 1)?;
    let loaded = load(scene, flags)?;
    let flags = &loaded.expose(flags)?;
    let steps = steps_between_pictures(estimated_full_secs(&loaded, flags)?);
    let args = arguments(scene, steps);
    let walk = loaded.scene().walk.clone();
    let (record, outcome) = tour::record(&args, flags, &loaded, &walk)?;
    let last = record.frames.last().filter(|_| record.is_complete && flags.mode != Mode::Full);
    let full_secs =
        last.and_then(|last| full_frame_secs(&loaded, flags, &camera_of(&last.pose), flags.size()));
    let page = TourPage { scene: &loaded.name, flags, record: &record, picture_every: steps, full_secs };
    let path = args.out.join("report.html");
    write_tour_page(&path, &page)?;
    output::say(&format!("open {} to see the frames", path.display()));
    outcome
}

/// Frames from one picture to the next, so that the tour takes about [`TOUR_SECS`].
fn steps_between_pictures(full_frame_secs: f64) -> u32 {
    let frames = TOUR_SECS / (FRAME_SHARE * full_frame_secs.max(1e-6));
    ((frames / f64::from(PICTURES - 1)) as u32).clamp(1, MAX_STEPS)
}

/// Estimates the time of a frame in mode `full` from a small one, rendered twice: the first time
/// finds the lights that matter at each place, which later frames know.
fn estimated_full_secs(loaded: &Loaded, flags: &Flags) -> Result<f64, Failure> {
    let size = flags.size().map(|side| side.div_ceil(4));
    let secs = || full_frame_secs(loaded, flags, loaded.scene().start(), size);
    let small = secs().and_then(|_| secs()).ok_or(Failure::Interrupted)?;
    Ok(small * flags.pixels() as f64 / (f64::from(size[0]) * f64::from(size[1])))
}

/// Time of a frame in mode `full`; `None` if it was interrupted.
fn full_frame_secs(loaded: &Loaded, flags: &Flags, camera: &Camera, size: [u32; 2]) -> Option<f64> {
    let settings = RenderSettings { mode: Mode::Full, trace: flags.trace() };
    let request = FrameRequest::new(&loaded.tracer, camera, size, &settings);
    let stats = Renderer::default().render(&request.with_stop(&interrupt::is_cancelled)).stats;
    stats.is_complete.then_some(stats.secs.frame)
}

fn camera_of(pose: &Pose) -> Camera {
    Camera::look_at(DVec3::from_array(pose.eye), DVec3::from_array(pose.look_at), pose.fov_y_deg)
}

/// Arguments of the tour with their defaults.
fn arguments(scene: Option<&str>, steps: u32) -> TourArgs {
    #[derive(Parser)]
    struct Typed {
        #[command(flatten)]
        args: TourArgs,
    }
    let args = Typed::parse_from(["tour", "--out", OUT, "--pictures", "--audit"]).args;
    let frames = Some((PICTURES - 1) * steps + 1);
    TourArgs { scene: scene.map(str::to_owned), frames, picture_every: steps, ..args }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tour_has_as_many_frames_as_there_is_time_for() {
        assert_eq!(steps_between_pictures(0.0), MAX_STEPS);
        assert_eq!(steps_between_pictures(100.0), 1, "a dozen frames at least");
        let secs = 2.0;
        let frames = f64::from((PICTURES - 1) * steps_between_pictures(secs) + 1);
        assert!(frames * FRAME_SHARE * secs <= TOUR_SECS + FRAME_SHARE * secs);
    }
}
