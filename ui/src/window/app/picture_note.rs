//! Going to the view of a picture, with the light and the materials that it shows.

use super::{Arrival, Parts, SessionFile, change, is_shown, open};
use crate::picture::restore::PictureView;
use crate::window::rendering::SceneSource;
use crate::window::state::{Change, SunControls};
use afterimage::raster::exposure::Exposure;
use afterimage::scene::SceneEdit;
use std::path::{Path, PathBuf};

/// The session in the metadata of a picture.
#[derive(Clone, Debug)]
pub(super) struct PictureNote {
    /// The picture.
    pub(super) file: PathBuf,
    /// Text of the session; `None` where the picture shows the model as its files have it.
    pub(super) text: Option<String>,
}

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
        return show_note(app, &note);
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
    app.state.quality.exposure = view.exposure_ev.map_or(app.state.quality.exposure, Exposure::Stops);
}

/// Shows the light and the materials of a picture, in a step that can be undone.
pub(super) fn show_note(app: &mut Parts, note: &PictureNote) {
    let read = note.text.as_deref().map(|text| edit_of(app, text, &note.file)).transpose();
    let (Some(document), read) = (&app.state.document, read) else { return };
    let (edit, messages) = match read {
        Ok(Some(Some(read))) => read,
        Ok(Some(None)) => return,
        Ok(None) => (document.files().scene.clone(), Vec::new()),
        Err(error) => {
            let text = format!("{error:#}; light and materials of the picture are not restored");
            return app.state.error(text);
        }
    };
    if edit != *document.scene() {
        let mut sun: SunControls = document.now().sun.clone();
        sun.show(&edit.daylight);
        change(app, Change::Scene(Box::new((edit, sun))));
        app.state.info("light and materials are those of the picture; Undo brings back the others");
    }
    for message in messages {
        app.state.error(format!("{}: {message}", note.file.display()));
    }
}

/// Reads what a picture makes of the scene that is shown; `None` without one.
fn edit_of(app: &Parts, text: &str, file: &Path) -> anyhow::Result<Option<(SceneEdit, Vec<String>)>> {
    let session = SessionFile::parse(text, file)?;
    let (Some(document), Some(info), Some(tracer)) =
        (&app.state.document, &app.state.scene, app.current.tracer())
    else {
        return Ok(None);
    };
    Ok(Some(session.edit(tracer.scene(), &document.files().scene, &info.source, false)))
}
