//! Where sessions are written.

use super::{EXTENSION, SessionFile};
use crate::window::export::Destination;
use crate::window::rendering::{SceneSource, TaskError};
use afterimage::raster::save::{SaveError, write_atomically};
use std::path::{Path, PathBuf};

/// Returns the file next to a model that holds its session.
pub(in crate::window::app) fn beside_model(model: &Path) -> PathBuf {
    model.with_extension(EXTENSION)
}

/// Writes a session and returns its path: in `file`, or else next to the model where there is none
/// yet, or else in a new file of the destination.
///
/// # Errors
/// A message for the user with cause and remedy.
pub(in crate::window::app) fn write_session(
    session: &SessionFile,
    file: Option<PathBuf>,
    destination: &Destination,
) -> Result<PathBuf, TaskError> {
    if let Some(path) = file {
        return write_to(session, path).map_err(failed);
    }
    let beside = match session.source(Path::new("")) {
        SceneSource::File { path, .. } => Some(beside_model(&path)).filter(|path| !path.exists()),
        _ => None,
    };
    if let Some(Ok(path)) = beside.map(|path| write_to(session, path)) {
        return Ok(path);
    }
    let mut last = None;
    for folder in &destination.folders {
        let text = session.text(Some(folder)).map_err(TaskError::failed)?;
        let one = Destination { folders: vec![folder.clone()], stem: destination.stem.clone() };
        match one.write_new(EXTENSION, text.as_bytes()) {
            Ok(path) => return Ok(path),
            Err(error) => last = error,
        }
    }
    Err(last.map_or(TaskError::failed("there is no folder to save sessions in"), |e| failed(e.into())))
}

fn write_to(session: &SessionFile, path: PathBuf) -> anyhow::Result<PathBuf> {
    let text = session.text(path.parent())?;
    write_atomically(&path, text.as_bytes())?;
    Ok(path)
}

fn failed(error: anyhow::Error) -> TaskError {
    let remedy = match error.is::<SaveError>() {
        true => "; free some space, or choose another folder in File, Picture settings",
        false => "",
    };
    TaskError::Failed(format!("{error:#}{remedy}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn a_full_disk_is_reported_with_a_remedy() {
        let full = PathBuf::from("/dev/full");
        assert!(full.exists(), "every Linux has one");
        let destination = Destination { folders: Vec::new(), stem: String::new() };
        let result = write_session(&SessionFile::example(), Some(full), &destination);
        let Err(TaskError::Failed(text)) = result else { panic!("a full disk accepts no session") };
        assert!(text.contains("No space") && text.contains("free some space"), "{text}");
    }
}
