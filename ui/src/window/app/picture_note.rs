//! The light and the materials that a picture shows, from the session in its metadata.

use super::{Parts, PictureNote, SessionFile, change};
use crate::window::state::{Change, SunControls};
use afterimage::scene::SceneEdit;
use std::path::Path;

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
