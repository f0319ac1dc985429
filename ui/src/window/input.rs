//! Keys, drags, wheel and dropped files as motion and commands.

use super::app::App;
use super::fly_camera::{Motion, SPEED_FACTOR};
use super::keymap::{Action, Pressed};
use super::load::SceneSource;
use super::panels::legend;
use super::state::{Command, Options};
use super::viewport::{Coloring, Heatmap};
use egui::{Context, Event, MouseWheelUnit, PointerButton, Response};

/// A wheel that reports points instead of notches moves so many points a notch.
const POINTS_PER_NOTCH: f32 = 50.0;

/// One press changes the exposure by half a stop.
const EXPOSURE_STEP_EV: f32 = 0.5;

impl App {
    /// What was pressed or dropped since the last frame.
    pub(super) fn key_commands(&mut self, ctx: &Context) -> Vec<Command> {
        let typing = ctx.text_edit_focused();
        let (events, dropped) = ctx.input(|i| (i.raw.events.clone(), i.raw.dropped_files.clone()));
        let pressed = self.keyboard.update(&events, typing);
        let mut commands: Vec<Command> = pressed.into_iter().flat_map(|p| self.command_of(p)).collect();
        if !typing && events.contains(&Event::Copy) {
            commands.push(Command::CopyPose);
        }
        if let Some(file) = dropped.first().filter(|f| !f.path().as_os_str().is_empty()) {
            commands.push(Command::Open(SceneSource::file(file.path())));
        }
        commands
    }

    fn command_of(&self, Pressed { action, chord }: Pressed) -> Option<Command> {
        let (o, mut q) = (self.state.options, self.state.quality);
        Some(match action {
            Action::Home => Command::GoToView(0),
            Action::NextView => Command::StepView(1),
            Action::PreviousView => Command::StepView(-1),
            Action::GoToView => Command::GoToView(chord),
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
            Action::AddReference => Command::AddReference,
            Action::ClearCache => Command::AskToClear,
            Action::Open => Command::Browse,
            Action::Reload => Command::Reload,
            Action::Screenshot => Command::Screenshot,
            Action::FullScreen => Command::FullScreen,
            Action::Escape => Command::Escape,
            _ => Command::SetOptions(switched(o, action)?),
        })
    }

    /// Lets time pass for the camera, and turns and moves it by the mouse over the viewport.
    pub(super) fn steer(&mut self, ctx: &Context, viewport: &Response) {
        if viewport.drag_started() {
            // Who grabs the picture no longer types.
            ctx.memory_mut(|m| m.focused().into_iter().for_each(|id| m.surrender_focus(id)));
        }
        let height = f64::from(viewport.rect.height().max(1.0));
        if [PointerButton::Primary, PointerButton::Secondary].into_iter().any(|b| viewport.dragged_by(b)) {
            let drag = viewport.drag_delta();
            self.state.fly.look([f64::from(drag.x) / height, f64::from(drag.y) / height]);
        }
        let (secs, factor) = ctx.input(|i| (f64::from(i.stable_dt), speed_factor(i.modifiers)));
        if viewport.contains_pointer() {
            self.wheel(ctx, viewport, factor);
        }
        let keys = &self.keyboard;
        let motion = Motion {
            right: keys.axis(Action::Right, Action::Left),
            up: keys.axis(Action::Up, Action::Down),
            forward: keys.axis(Action::Forward, Action::Back),
            factor,
        };
        self.state.fly.advance(&motion, secs);
        let is_flying = [motion.right, motion.up, motion.forward] != [0.0; 3];
        if is_flying || self.state.fly.is_easing() {
            ctx.request_repaint();
        }
    }

    fn wheel(&mut self, ctx: &Context, viewport: &Response, factor: f64) {
        let (notches, at, is_right_down) =
            ctx.input(|i| (notches(&i.raw.events), i.pointer.hover_pos(), i.pointer.secondary_down()));
        if notches == 0.0 {
            return;
        }
        if is_right_down {
            self.state.fly.change_speed(notches);
            return;
        }
        let (rect, fly) = (viewport.rect, &mut self.state.fly);
        let at = at.unwrap_or(rect.center()) - rect.center();
        let half = rect.size() / 2.0;
        let direction = fly.direction_through(
            f64::from(at.x / half.x.max(1.0)),
            f64::from(-at.y / half.y.max(1.0)),
            f64::from(rect.aspect_ratio()),
        );
        fly.dolly(direction, notches, factor);
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
