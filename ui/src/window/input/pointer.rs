//! Keys, drags, wheel and dropped files as motion and commands.

use crate::window::app::App;
use crate::window::gpu::presentation::{Coloring, Heatmap};
use crate::window::input::aim;
use crate::window::input::fly_camera::{Motion, MoveMode, SPEED_FACTOR};
use crate::window::input::keymap::{Action, Attention, Pressed};
use crate::window::panels::legend;
use crate::window::state::{
    Command, Compare, EditCommand, FileCommand, InspectCommand, NavigationCommand, Options, PictureCommand,
};
use afterimage::trace::Probe;
use egui::{
    Context, CursorGrab, Event, MouseWheelUnit, PointerButton, Pos2, Response, Vec2, ViewportCommand,
};

/// A wheel that reports points instead of notches moves so many points a notch.
const POINTS_PER_NOTCH: f32 = 50.0;

/// One press changes the exposure by half a stop.
const EXPOSURE_STEP_EV: f32 = 0.5;

impl App {
    /// What was pressed or dropped since the last frame.
    pub(crate) fn key_commands(&mut self, ctx: &Context) -> Vec<Command> {
        let typing = ctx.text_edit_focused() || self.state.is_asking();
        let (events, dropped) = ctx.input(|i| (i.raw.events.clone(), i.raw.dropped_files.clone()));
        let attention = match () {
            () if typing => Attention::Text,
            () if ctx.memory(|m| m.focused().is_some_and(|id| Some(id) != self.viewport)) => {
                Attention::Control
            }
            () => Attention::View,
        };
        let pressed = self.keyboard.update(&events, attention);
        let mut commands: Vec<Command> = pressed.into_iter().flat_map(|p| self.command_of(p)).collect();
        if !typing {
            commands.extend(events.iter().filter_map(clipboard_command));
        }
        if let Some(file) = dropped.first().filter(|f| !f.path().as_os_str().is_empty()) {
            commands.push(Command::OpenPath(file.path().to_owned()));
        }
        commands
    }

    fn command_of(&self, Pressed { action, chord }: Pressed) -> Option<Command> {
        let (o, mut q) = (self.state.options, self.state.quality);
        Some(match action {
            Action::ToggleWalk => Command::Navigate(NavigationCommand::SetMoveMode(
                match self.state.navigation.fly.move_mode() {
                    MoveMode::Fly => MoveMode::Walk,
                    MoveMode::Walk => MoveMode::Fly,
                },
            )),
            Action::Focus => self.look_at_cursor(),
            Action::FrameAll => {
                let bounds = self.obstacles.as_ref()?.tracer().scene().bounds_m;
                Command::EaseTo(aim::framing(bounds, self.state.navigation.fly.camera(), self.aspect()))
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
            Action::Level => Command::Level,
            Action::NarrowFov => Command::ChangeFov(-1.0),
            Action::WidenFov => Command::ChangeFov(1.0),
            Action::DarkerExposure | Action::BrighterExposure | Action::ResetExposure => {
                q.exposure_ev = match action {
                    Action::DarkerExposure => q.exposure_ev - EXPOSURE_STEP_EV,
                    Action::BrighterExposure => q.exposure_ev + EXPOSURE_STEP_EV,
                    _ => self.state.default_quality.exposure_ev,
                };
                Command::SetQuality(q)
            }
            Action::CompareSplit => self.toggled(Compare::Split),
            Action::CompareErrors => self.toggled(Compare::Errors),
            Action::AddReference => Command::AddReference,
            Action::ClearCache => Command::AskToClear,
            Action::Open => Command::Browse,
            Action::SaveSession => Command::Files(FileCommand::SaveSession),
            Action::Quit => Command::Quit,
            Action::Reload => Command::Reload,
            Action::Screenshot => Command::Picture(PictureCommand::Save),
            Action::ScreenshotWithoutBackground => Command::Picture(PictureCommand::SaveWithoutBackground),
            Action::SaveSequence => Command::Picture(PictureCommand::SaveSequence),
            Action::FullScreen => Command::FullScreen,
            Action::Escape => Command::Escape,
            _ => Command::SetOptions(switched(o, action)?),
        })
    }

    /// The comparison that was asked for, or none where it is shown already.
    fn toggled(&self, wanted: Compare) -> Command {
        let comparison = &self.state.comparison;
        let shows = if comparison.shows == wanted { Compare::Off } else { wanted };
        Command::Compare(shows, comparison.split)
    }

    /// Lets time pass for the camera, and turns and moves it by the mouse over the viewport.
    pub(crate) fn steer(&mut self, ctx: &Context, viewport: &Response) {
        if viewport.drag_started() {
            // Who grabs the picture no longer types.
            ctx.memory_mut(|m| m.focused().into_iter().for_each(|id| m.surrender_focus(id)));
        }
        let (secs, factor) = ctx.input(|i| (f64::from(i.stable_dt), speed_factor(i.modifiers)));
        self.state.comparison.is_held = self.keyboard.is_held(Action::ShowFull);
        self.play(secs);
        self.grab(ctx, viewport);
        let height = f64::from(viewport.rect.height().max(1.0));
        let drag = look_drag(ctx, viewport);
        self.state.navigation.fly.look([f64::from(drag.x) / height, f64::from(drag.y) / height]);
        self.cursor =
            viewport.hover_pos().filter(|_| viewport.contains_pointer()).map(|at| unit(viewport, at));
        if viewport.contains_pointer() {
            self.wheel(ctx, viewport, factor);
        }
        self.click(viewport);
        if viewport.double_clicked()
            && let Some(at) = viewport.interact_pointer_pos()
        {
            self.go_there(unit(viewport, at));
        }
        self.fly(ctx, secs, factor);
        if let Some(recording) = &mut self.state.navigation.recording {
            recording.note(self.state.navigation.fly.camera(), secs);
        }
    }

    fn fly(&mut self, ctx: &Context, secs: f64, factor: f64) {
        let keys = &self.keyboard;
        let motion = Motion {
            right: keys.axis(Action::Right, Action::Left),
            up: keys.axis(Action::Up, Action::Down),
            forward: keys.axis(Action::Forward, Action::Back),
            factor,
        };
        let is_flying = [motion.right, motion.up, motion.forward] != [0.0; 3];
        if is_flying {
            self.state.navigation.playback.is_playing = false;
        }
        self.state.navigation.fly.advance(&motion, secs, self.obstacles.as_ref());
        if is_flying || self.state.navigation.fly.is_easing() || self.state.navigation.playback.is_playing {
            ctx.request_repaint();
        }
    }

    /// Lets the camera path play.
    fn play(&mut self, secs: f64) {
        if let Some(camera) = self.state.navigation.playback.advance(secs) {
            self.state.navigation.fly.jump_to(camera);
        }
    }

    /// Holds the pointer in the window while the right button looks around, where the system can.
    fn grab(&mut self, ctx: &Context, viewport: &Response) {
        let wants = viewport.dragged_by(PointerButton::Secondary);
        if wants != self.has_grab {
            self.has_grab = wants;
            let grab = if wants { grab_mode() } else { CursorGrab::None };
            ctx.send_viewport_cmd(ViewportCommand::CursorGrab(grab));
            ctx.send_viewport_cmd(ViewportCommand::CursorVisible(!wants));
        }
    }

    /// What is seen at a point of the viewport, right and up from its centre in -1..1.
    pub(crate) fn probe_at(&self, [x, y]: [f64; 2]) -> Option<Probe> {
        let direction = self.state.navigation.fly.direction_through(x, y, self.aspect());
        self.obstacles.as_ref()?.tracer().probe(
            self.state.navigation.fly.camera().eye,
            direction,
            f64::INFINITY,
        )
    }

    fn go_there(&mut self, at: [f64; 2]) {
        if let Some(probe) = self.probe_at(at) {
            self.state.navigation.fly.ease_to(aim::gone_to(&probe, self.state.navigation.fly.camera()));
        }
    }

    fn look_at_cursor(&self) -> Command {
        match self.probe_at(self.cursor.unwrap_or([0.0, 0.0])) {
            Some(probe) => Command::EaseTo(aim::focused_on(&probe, self.state.navigation.fly.camera())),
            None => Command::Say("there is nothing under the cursor to look at".to_owned()),
        }
    }

    /// Width over height of the viewport.
    pub(crate) fn aspect(&self) -> f64 {
        let [width, height] = self.viewport_size.map(f64::from);
        width / height.max(1.0)
    }

    fn wheel(&mut self, ctx: &Context, viewport: &Response, factor: f64) {
        let (notches, at, is_right_down) =
            ctx.input(|i| (notches(&i.raw.events), i.pointer.hover_pos(), i.pointer.secondary_down()));
        if notches == 0.0 {
            return;
        }
        if is_right_down {
            self.state.navigation.fly.change_speed(notches);
            return;
        }
        let at = at.unwrap_or(viewport.rect.center());
        let ([x, y], fly) = (unit(viewport, at), &mut self.state.navigation.fly);
        let direction = fly.direction_through(x, y, f64::from(viewport.rect.aspect_ratio()));
        fly.dolly(direction, notches, factor, self.obstacles.as_ref());
    }
}

/// A point of the viewport as parts of its half size, right and up from the centre.
pub(crate) fn unit(viewport: &Response, at: Pos2) -> [f64; 2] {
    let (from_centre, half) = (at - viewport.rect.center(), viewport.rect.size() / 2.0);
    [f64::from(from_centre.x / half.x.max(1.0)), f64::from(-from_centre.y / half.y.max(1.0))]
}

/// How far the pointer was dragged to look around since the last frame, in points. Motion before egui was sure that it
/// is no click counts too.
fn look_drag(ctx: &Context, viewport: &Response) -> Vec2 {
    if ![PointerButton::Primary, PointerButton::Secondary].into_iter().any(|b| viewport.dragged_by(b)) {
        return Vec2::ZERO;
    }
    ctx.input(|i| {
        let held = i.pointer.secondary_down().then(|| i.pointer.motion()).flatten();
        match (held, i.pointer.press_origin(), i.pointer.latest_pos()) {
            (Some(motion), ..) => motion * grabbed_motion_scale() / i.pixels_per_point(),
            (None, Some(origin), Some(at)) if viewport.drag_started() => at - origin,
            _ => i.pointer.delta(),
        }
    })
}

/// X11 cannot lock the pointer in its place, only keep it in the window (winit#3094).
fn grab_mode() -> CursorGrab {
    if is_x11() { CursorGrab::Confined } else { CursorGrab::Locked }
}

/// X11 reports the raw motion of a confined pointer twice (winit#3773).
fn grabbed_motion_scale() -> f32 {
    if is_x11() { 0.5 } else { 1.0 }
}

fn is_x11() -> bool {
    let has_wayland =
        ["WAYLAND_DISPLAY", "WAYLAND_SOCKET"].iter().any(|name| std::env::var_os(name).is_some());
    cfg!(target_os = "linux") && !has_wayland
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
        Action::ToggleByReference => {
            let coloring = match o.coloring {
                Coloring::ByType => Coloring::ByReference,
                Coloring::ByReference => Coloring::ByType,
            };
            legend::shown(Options { coloring, ..o }, &o)
        }
        Action::ToggleOutline => Options { has_outline: !o.has_outline, ..o },
        Action::Pause => Options { is_paused: !o.is_paused, ..o },
        Action::Help => Options { shows_help: !o.shows_help, ..o },
        Action::TogglePanels => Options { shows_panels: !o.shows_panels, ..o },
        Action::ToggleStatistics => Options { shows_statistics: !o.shows_statistics, ..o },
        _ => return None,
    })
}

fn speed_factor(modifiers: egui::Modifiers) -> f64 {
    let up = if modifiers.shift { SPEED_FACTOR } else { 1.0 };
    if modifiers.alt { up / SPEED_FACTOR } else { up }
}

/// From the events themselves: egui's scroll delta is smoothed over several frames.
fn notches(events: &[Event]) -> f64 {
    let notches = events.iter().map(|event| match event {
        Event::MouseWheel { unit: MouseWheelUnit::Point, delta, .. } => delta.y / POINTS_PER_NOTCH,
        // Shift turns the wheel sideways on some systems.
        Event::MouseWheel { delta, .. } if delta.y == 0.0 => delta.x,
        Event::MouseWheel { delta, .. } => delta.y,
        _ => 0.0,
    });
    f64::from(notches.sum::<f32>())
}
