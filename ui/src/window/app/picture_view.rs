//! Going to the view of a picture, with the light and the materials that it shows.

use super::{Arrival, Parts, PictureNote, is_shown, open, show_note};
use crate::picture::restore::PictureView;
use crate::window::rendering::SceneSource;
use crate::window::state::AppState;
use afterimage::raster::exposure::Exposure;

/// Goes to the view of a picture. Its scene is loaded unless it is shown.
pub(super) fn go_to_picture(app: &mut Parts, view: PictureView) {
    if app.current.tracer().is_some_and(|tracer| tracer.scene().hash == view.scene_hash) {
        go_there(app, &view);
        return app.state.info("the picture was taken here");
    }
    let source = SceneSource::named(&view.scene, Default::default());
    let note = PictureNote { file: view.file.clone(), text: view.document.clone() };
    let is_same_model = note.text.is_some() || app.current.files_hash == view.scene_hash;
    if is_shown(&app.state, &source) && is_same_model {
        go_there(app, &view);
        return show_note(app, note);
    }
    if let SceneSource::File { path, .. } = &source
        && !path.exists()
    {
        return app.state.error(format!(
            "the picture shows {}, which does not exist; open the model, then drop the picture again",
            view.scene
        ));
    }
    if is_shown(&app.state, &source) {
        // A reload keeps the pose.
        app.state.navigation.fly.jump_to(view.camera);
        expose_as(&mut app.state, &view);
    }
    app.current.arrival = Arrival {
        camera: Some(view.camera),
        exposure_ev: view.exposure_ev,
        // The hash is that of the changed scene where there is a note.
        scene_hash: Some(view.scene_hash).filter(|_| note.text.is_none()),
        note: note.text.is_some().then_some(note),
        ..Arrival::default()
    };
    open(app, source);
}

fn go_there(app: &mut Parts, view: &PictureView) {
    app.state.navigation.fly.ease_to(view.camera);
    expose_as(&mut app.state, view);
}

/// Shows the exposure of a picture. It belongs to the view, as the pose does: nothing is unsaved by
/// it. Where the window shows the same by itself, it goes on to do so.
fn expose_as(state: &mut AppState, view: &PictureView) {
    /// Difference in stops that is not seen: less than a step of 8 bits.
    const SAME_EV: f32 = 0.005;
    let Some(ev) = view.exposure_ev.filter(|ev| (ev - state.exposure_ev()).abs() > SAME_EV) else { return };
    let (before, now) = (state.quality.exposure, Exposure::Stops(ev));
    state.quality.exposure = now;
    if let Some(document) = &mut state.document {
        document.follow_exposure(before, now);
    }
}
