//! What controls ask for: panels and keys make commands, only the app carries them out.

use super::{Compare, FileCommand, Look, Options, PictureCommand, Quality, Severity};
use crate::window::fly_camera::Gait;
use crate::window::load::SceneSource;
use crate::window::playback::Playback;
use afterimage::Camera;
use afterimage::reference::ReferenceId;
use std::path::PathBuf;

/// What a control asks for.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Command {
    Open(SceneSource),
    OpenPath(PathBuf),
    Browse,
    CancelLoading,
    Reload,
    SetPathText(String),
    SetQuality(Quality),
    SetOptions(Options),
    SetSpeed(f64),
    SetFovDegrees(f64),
    EaseTo(Camera),
    Moving(Moving),
    Say(Severity, String),
    Level,
    ChangeFov(f64),
    AddReference,
    AskToClear,
    Clear,
    KeepReferences,
    Remove(ReferenceId),
    Picture(PictureCommand),
    Files(FileCommand),
    SetLook(Look),
    ShowSettings(bool),
    CopyPose,
    Compare(Compare, f32),
    CopyText(String),
    Dismiss(u64),
    FullScreen,
    Escape,
}

/// What a control asks for of views, paths and the way one moves.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Moving {
    GoToView(usize),
    GoToKey(u8),
    StepView(isize),
    SaveView(u8),
    AddView,
    RemoveView(usize),
    Rename(Option<(usize, String)>),
    FinishRenaming,
    PastePose(String),
    SetGait(Gait),
    AddPathKey,
    RemovePathKey(usize),
    SetPlayback(Playback),
    PlayPath,
    ToggleRecording,
}
