//! The light and the materials that a picture shows, from the session in its metadata.

use super::{AppEvent, Parts, PictureNote, ReadNote, SessionFile, change};
use crate::window::rendering::SceneSource;
use crate::window::state::{Change, SunControls};
use afterimage::Tracer;
use afterimage::import::AppliedEdit;
use afterimage::scene::SceneEdit;
use std::sync::Arc;

/// Reads the light and the materials of a picture off the window's thread: they may name a picture
/// of the sky.
pub(super) fn show_note(app: &mut Parts, note: PictureNote) {
    let (Some(document), Some(info), Some(tracer)) =
        (&app.state.document, &app.state.scene, app.current.tracer().cloned())
    else {
        return;
    };
    let (files, source) = (document.files().scene.clone(), info.source.clone());
    let files_hash = app.current.files_hash.clone();
    app.services.spawn(&format!("{}: reading its light", note.file.display()), move || {
        let read = read(&note, &tracer, files, &source);
        Ok(AppEvent::Note(Box::new(ReadNote { file: note.file, files_hash, read })))
    });
}

fn read(
    note: &PictureNote,
    tracer: &Arc<Tracer>,
    files: SceneEdit,
    source: &SceneSource,
) -> anyhow::Result<AppliedEdit> {
    match &note.text {
        Some(text) => {
            let session = SessionFile::parse(text, &note.file)?;
            Ok(session.edit(tracer.scene(), &files, source, false))
        }
        None => Ok(AppliedEdit { edit: files, messages: Vec::new(), outside: None }),
    }
}

/// Shows the light and the materials of a picture, in a step that can be undone. Nothing is done
/// where another scene is shown by now.
pub(super) fn apply_note(app: &mut Parts, note: ReadNote) {
    let Some(document) = app.state.document.as_ref().filter(|_| note.files_hash == app.current.files_hash)
    else {
        return;
    };
    let AppliedEdit { edit, messages, outside } = match note.read {
        Ok(applied) => applied,
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
    let outside = outside
        .map(|name| format!("the picture of the sky {name} is outside the model's folder and is not read"));
    for message in messages.into_iter().chain(outside) {
        app.state.error(format!("{}: {message}", note.file.display()));
    }
}
