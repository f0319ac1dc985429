//! Keys, the clipboard and dropped files as commands.

use super::object_keys::object_command;
use super::section_keys::section_command;
use super::{Click, Input, MoveMode, Obstacles, probe_at};
use crate::window::input::aim;
use crate::window::input::keymap::{Action, Attention, Pressed};
use crate::window::rendering::Quantity;
use crate::window::state::{
    AppState, Command, Compare, EditCommand, FileCommand, InspectCommand, ListCommand, NavigationCommand,
    Options, PictureCommand, Purpose, Quality,
};
use crate::window::state::{Coloring, Heatmap};
use afterimage::raster::exposure::Exposure;
use egui::{Context, Event};

/// One press changes the exposure by half a stop.
const EXPOSURE_STEP_EV: f32 = 0.5;

/// Returns the commands of keys that were pressed and of files that were dropped since the last
/// update.
pub(crate) fn key_commands(
    state: &AppState,
    input: &mut Input,
    obstacles: Option<&Obstacles>,
    ctx: &Context,
) -> Vec<Command> {
    let (events, dropped) = ctx.input(|i| (i.raw.events.clone(), i.raw.dropped_files.clone()));
    let attention = attention(state, input, ctx);
    let is_typing = matches!(attention, Attention::Text | Attention::Question);
    let mut pressed = input.keyboard.update(&events, attention);
    // Escape that leaves a text field does no more than that.
    pressed.retain(|p| p.action != Action::Escape || !input.was_typing);
    let mut commands: Vec<Command> =
        pressed.into_iter().filter_map(|p| command_of(state, input, obstacles, p)).collect();
    if !is_typing {
        commands.extend(events.iter().filter_map(clipboard_command));
    }
    if let Some(file) = dropped.first().filter(|f| !f.path().as_os_str().is_empty()) {
        commands.push(Command::OpenPath(file.path().to_owned()));
    }
    commands
}

/// Returns what receives the keys: a question and an open menu, list or colour keep all of them.
fn attention(state: &AppState, input: &Input, ctx: &Context) -> Attention {
    let has_control = || ctx.memory(|m| m.focused().is_some_and(|id| Some(id) != input.viewport));
    match () {
        () if state.is_asking() || egui::Popup::is_any_open(ctx) => Attention::Question,
        () if ctx.text_edit_focused() => Attention::Text,
        () if has_control() => Attention::Control,
        () => Attention::View,
    }
}

fn command_of(
    state: &AppState,
    input: &mut Input,
    obstacles: Option<&Obstacles>,
    Pressed { action, chord }: Pressed,
) -> Option<Command> {
    let o = state.options;
    Some(match action {
        Action::ToggleWalk => {
            Command::Navigate(NavigationCommand::SetMoveMode(match state.navigation.fly.move_mode() {
                MoveMode::Fly => MoveMode::Walk,
                MoveMode::Walk => MoveMode::Fly,
            }))
        }
        Action::Focus => focus(state, input, obstacles),
        Action::FrameAll => {
            let building = obstacles?.tracer().scene().building_m;
            Command::EaseTo(aim::framing(building, state.navigation.fly.camera(), state.aspect()))
        }
        Action::Undo => Command::Edit(EditCommand::Undo),
        Action::Redo => Command::Edit(EditCommand::Redo),
        Action::Measure => Command::Inspect(InspectCommand::ToggleMeasure),
        Action::AddPathKey => Command::Navigate(NavigationCommand::AddPathKey),
        Action::PlayPath => Command::Navigate(NavigationCommand::PlayPath),
        Action::SaveView => Command::Navigate(NavigationCommand::SaveView(chord as u8 + 1)),
        Action::NextView => Command::Navigate(NavigationCommand::StepView(1)),
        Action::PreviousView => Command::Navigate(NavigationCommand::StepView(-1)),
        Action::GoToView => Command::Navigate(NavigationCommand::GoToKey(chord as u8 + 1)),
        Action::GoBack => Command::Navigate(NavigationCommand::GoBack),
        Action::Level => Command::Level,
        Action::NarrowFov => Command::ChangeFov(-1.0),
        Action::WidenFov => Command::ChangeFov(1.0),
        Action::DarkerExposure | Action::BrighterExposure | Action::ResetExposure => {
            Command::SetQuality(Quality { exposure: exposure_of(state, action), ..state.quality })
        }
        Action::ExposeForView => Command::ExposeForView,
        Action::CompareSplit => toggled(state, Compare::Split),
        Action::CompareErrors => toggled(state, Compare::Errors),
        Action::AddReference => Command::AddReference,
        Action::Bake => Command::Bake,
        Action::ClearCache => Command::AskToClear,
        Action::Open => Command::List(ListCommand::Ask(Purpose::Open)),
        Action::SaveSession => Command::Files(FileCommand::SaveSession),
        Action::Quit => Command::Quit,
        Action::Reload => Command::Reload,
        Action::Screenshot => Command::Picture(PictureCommand::Save),
        Action::ScreenshotWithoutBackground => Command::Picture(PictureCommand::SaveWithoutBackground),
        Action::SaveSequence => Command::Picture(PictureCommand::SaveSequence),
        Action::SaveFilm => Command::Picture(PictureCommand::SaveFilm),
        Action::FullScreen => Command::FullScreen,
        Action::NextRegion => Command::FocusRegion(true),
        Action::PreviousRegion => Command::FocusRegion(false),
        Action::Escape => Command::Escape,
        Action::Pick | Action::GoThere => {
            input.click = Some(if action == Action::Pick { Click::Pick } else { Click::GoThere });
            return None;
        }
        _ => section_command(state, action)
            .or_else(|| object_command(state, action))
            .or_else(|| Some(Command::SetOptions(switched(o, action)?)))?,
    })
}

/// The exposure that a key sets.
fn exposure_of(state: &AppState, action: Action) -> Exposure {
    let ev = state.exposure_ev();
    match action {
        Action::DarkerExposure => Exposure::Stops(ev - EXPOSURE_STEP_EV),
        Action::BrighterExposure => Exposure::Stops(ev + EXPOSURE_STEP_EV),
        _ => state.default_quality.exposure,
    }
}

/// Shows a comparison, or hides it where it is shown already.
fn toggled(state: &AppState, wanted: Compare) -> Command {
    let comparison = &state.comparison;
    let shows = if comparison.shows == wanted { Compare::Off } else { wanted };
    Command::Compare(shows, comparison.split)
}

/// Looks at the point under the cursor.
fn focus(state: &AppState, input: &Input, obstacles: Option<&Obstacles>) -> Command {
    let at = input.cursor.unwrap_or([0.0, 0.0]);
    match obstacles.and_then(|obstacles| probe_at(state, obstacles, at)) {
        Some(probe) => Command::EaseTo(aim::focused_on(&probe, state.navigation.fly.camera())),
        None => Command::Say("there is nothing under the cursor to look at".to_owned()),
    }
}

fn clipboard_command(event: &Event) -> Option<Command> {
    match event {
        Event::Copy => Some(Command::CopyPose),
        Event::Paste(text) => Some(Command::Navigate(NavigationCommand::PastePose(text.clone()))),
        _ => None,
    }
}

fn switched(o: Options, action: Action) -> Option<Options> {
    Some(match action {
        Action::CycleHeatmap => Options {
            heatmap: match o.heatmap {
                Heatmap::Off => Heatmap::Blend,
                Heatmap::Blend => Heatmap::Only,
                Heatmap::Only => Heatmap::Off,
            },
            ..o
        },
        Action::ShowPicture => Options { quantity: Quantity::Picture, ..o },
        Action::ShowIlluminance => Options { quantity: Quantity::Illuminance, ..o },
        Action::ShowLuminance => Options { quantity: Quantity::Luminance, ..o },
        Action::ShowDaylightFactor => Options { quantity: Quantity::DaylightFactor, ..o },
        Action::ShowClay => Options { quantity: Quantity::Clay, ..o },
        Action::ToggleByReference => {
            let coloring = match o.coloring {
                Coloring::ByType => Coloring::ByReference,
                Coloring::ByReference => Coloring::ByType,
            };
            Options { coloring, ..o }.with_visible_colors(&o)
        }
        Action::ToggleOutline => Options { has_outline: !o.has_outline, ..o },
        Action::ToggleEdges => Options { has_edges: !o.has_edges, ..o },
        Action::Pause => o.paused(!o.is_paused),
        Action::Freeze => o.frozen(!o.is_frozen),
        Action::Help => Options { shows_help: !o.shows_help, ..o },
        Action::TogglePanels => Options { shows_panels: !o.shows_panels, ..o },
        Action::ToggleStatistics => Options { statistics: o.statistics.next(), ..o },
        _ => return None,
    })
}
