//! What controls ask for: panels and keys make commands, only the app carries them out.

use super::{
    Answer, Change, Compare, FileCommand, Look, Options, PictureCommand, Quality, Severity, SunControls,
};
use crate::window::app::scene_loading::SceneSource;
use crate::window::input::fly_camera::MoveMode;
use crate::window::input::playback::Playback;
use crate::window::rendering::plan::PlanView;
use afterimage::Camera;
use afterimage::reference::ReferenceId;
use afterimage::scene::MaterialId;
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
    Editing(Editing),
    Seeing(Seeing),
    Say(Severity, String),
    Level,
    ChangeFov(f64),
    AddReference,
    AskToClear,
    Clear,
    KeepReferences,
    Remove(ReferenceId),
    Picture(PictureCommand),
    Answer(Answer),
    Quit,
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
    SetGait(MoveMode),
    AddPathKey,
    RemovePathKey(usize),
    SetPlayback(Playback),
    PlayPath,
    ToggleRecording,
}

/// What a control asks for of the scene's materials and light.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Editing {
    Change(Change),
    SetSun(SunControls),
    Undo,
    Redo,
    SaveBeside,
}

/// What a control asks for of what is looked at more closely.
#[derive(Clone, Debug)]
#[allow(missing_docs, reason = "the names say it")]
pub enum Seeing {
    CloseInspector,
    SelectMaterial(MaterialId),
    ToggleMeasure,
    ClearMeasure,
    SelectReference(Option<ReferenceId>),
    EnableReference(ReferenceId, bool),
    ShowReference(ReferenceId),
    CloseReference,
    SetPlanView(PlanView),
    FilterReport(String),
}
