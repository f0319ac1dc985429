//! The panorama around the current pose.

use super::SessionFile;
use crate::picture::panorama::{OtherProjection, PanoramaJob, looked_up_points};
use crate::window::state::AppState;
use afterimage::Mode;
use afterimage::render::panorama::Panorama;
use anyhow::Context;

/// Returns the panorama around the current pose, with the mode and samples of the window; mode
/// `paper` knows none.
pub(super) fn panorama_job(state: &AppState) -> anyhow::Result<PanoramaJob> {
    let width = state.picture.settings.panorama_width;
    let size = [width, width / 2];
    Panorama::check(size)?;
    let mut settings = state.quality.walk.render;
    if settings.mode == Mode::Paper {
        settings.mode = Mode::Exact;
    }
    if let Some(samples) = state.picture.settings.samples {
        settings.trace.samples = samples;
    }
    Ok(PanoramaJob {
        projection: OtherProjection::Equirectangular,
        scene_name: state.scene.as_ref().map(|s| s.source.label()).context("there is no scene yet")?,
        camera: *state.navigation.fly.camera(),
        size,
        settings,
        points: if settings.mode == Mode::Full { 1 } else { looked_up_points(size) },
        exposure_ev: state.exposure_ev(),
        tone_map: state.quality.tone_map,
        document: SessionFile::note_of(state).map(Into::into),
    })
}
