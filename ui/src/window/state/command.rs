//! Commands: panels and keys return them, and the handlers in `app` apply them.

#![allow(missing_docs, reason = "each name describes its command")]

use super::{
    Answer, Appearance, Change, Compare, LightingCommand, ListCommand, Options, PictureCommand, Quality,
};
use crate::window::input::{MoveMode, Playback};
use crate::window::rendering::{PlanView, SceneSource};
use afterimage::Camera;
use afterimage::reference::ReferenceId;
use afterimage::scene::{MaterialId, ObjectKey};
use std::path::PathBuf;

/// A command of a panel or a key.
#[derive(Clone, Debug)]
pub enum Command {
    Open(SceneSource),
    OpenPath(PathBuf),
    CancelLoading,
    Reload,
    SetPathText(String),
    SetQuality(Quality),
    SetOptions(Options),
    SetSpeed(f64),
    SetFovDegrees(f64),
    EaseTo(Camera),
    Navigate(NavigationCommand),
    Edit(EditCommand),
    Inspect(InspectCommand),
    Say(String),
    Level,
    ChangeFov(f64),
    AddReference,
    /// Starts to bake the scene, or cancels the bake.
    Bake,
    Lighting(LightingCommand),
    AskToClear,
    Clear,
    KeepReferences,
    Remove(ReferenceId),
    Picture(PictureCommand),
    Answer(Answer),
    /// Whether the picture outside its folder that a session names is read.
    ReadOutside(bool),
    Quit,
    Files(FileCommand),
    List(ListCommand),
    SetAppearance(Appearance),
    ShowSettings(bool),
    /// Set the exposure that suits the view that is shown.
    ExposeForView,
    CopyPose,
    Compare(Compare, f32),
    CopyText(String),
    /// Open a file or folder with the system's program for it.
    OpenOutside(PathBuf),
    Dismiss(u64),
    FullScreen,
    /// Moves the focus to the next region of the window, or to the one before.
    FocusRegion(bool),
    Escape,
}

/// A command about views, camera paths and the way the camera moves.
#[derive(Clone, Debug)]
pub enum NavigationCommand {
    GoToView(usize),
    GoToKey(u8),
    StepView(isize),
    SaveView(u8),
    AddView,
    RemoveView(usize),
    Rename(Option<(usize, String)>),
    FinishRenaming,
    /// Moves a saved view to the current pose.
    UpdateView(usize),
    /// Goes back to where the camera was before it was sent somewhere.
    GoBack,
    PastePose(String),
    SetMoveMode(MoveMode),
    AddPathKey,
    RemovePathKey(usize),
    GoToPathKey(usize),
    UpdatePathKey(usize),
    SetPathSecs(f64),
    /// Seconds from a key to the next one.
    SetKeySecs(usize, f64),
    SetPlayback(Playback),
    PlayPath,
    ToggleRecording,
}

/// A command about the scene's materials, objects and daylight.
#[derive(Clone, Debug)]
pub enum EditCommand {
    Change(Change),
    /// Trace light by groups from now on, so that lights are dimmed without a ray.
    KnowLights,
    Undo,
    Redo,
    SaveSidecar,
}

/// A command about the selected pixel, distance, material, object or reference.
#[derive(Clone, Debug)]
pub enum InspectCommand {
    CloseInspector,
    SelectMaterial(MaterialId),
    /// Copies the material that is picked next to this one, or ends that.
    ToggleDropper(MaterialId),
    SelectObject(ObjectKey),
    ToggleMeasure,
    ClearMeasures,
    RemoveMeasure(usize),
    SelectReference(Option<ReferenceId>),
    EnableReference(ReferenceId, bool),
    ShowReference(ReferenceId),
    CloseReference,
    SetPlanView(PlanView),
    /// Shows the storey above a floor, or the one that the camera is in.
    ShowStorey(Option<f64>),
    FilterReport(String),
}

/// A command about sessions and recent files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileCommand {
    SaveSession,
    Recover,
    DiscardRecovery,
    ForgetRecent,
}
