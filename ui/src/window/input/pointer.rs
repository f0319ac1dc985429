//! Drags, clicks and the wheel over the viewport.

use super::{Motion, Obstacles, SPEED_FACTOR, inspect, probe_at, snap_at};
use crate::window::input::aim;
use crate::window::input::keymap::{Action, Keyboard};
use crate::window::state::{AppState, Change, Snap};
use egui::{
    Context, CursorGrab, CursorIcon, Event, EventFilter, MouseWheelUnit, PointerButton, Pos2, Response, Vec2,
    ViewportCommand,
};
use std::time::Duration;

/// A wheel that reports points instead of notches moves by this number of points per notch.
const POINTS_PER_NOTCH: f32 = 50.0;

/// Motion advances by at most this time, so that the camera does not jump through a wall while the
/// window is busy.
const LONGEST_UPDATE_SECS: f32 = 0.25;

/// Time after which the window is drawn again without a new frame, where that takes its time from
/// the renderer.
const LONGEST_WAIT: Duration = Duration::from_millis(100);

/// A key that stands for a click of the mouse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Click {
    /// A click: inspects a pixel, or sets a point of a measurement.
    Pick,
    /// A double click: goes to the point.
    GoThere,
}

/// Turn per second by keys, in heights of the viewport over which a drag turns as far.
const LOOK_PER_SEC: f64 = 0.4;

/// Largest factor of the turn while Shift is held: at five times, the camera cannot be aimed.
const MAX_LOOK_FACTOR: f64 = 2.0;

/// State of the keyboard and the pointer.
#[derive(Default)]
pub(crate) struct Input {
    pub(crate) keyboard: Keyboard,
    /// Pointer over the viewport: right and up from the centre, -1..1.
    pub(crate) cursor: Option<[f64; 2]>,
    /// The pointer is held in the window.
    has_grab: bool,
    /// The camera moved in the last update by itself, or by keys that are held.
    is_moving: bool,
    /// The viewport's identity among egui's controls.
    pub(crate) viewport: Option<egui::Id>,
    /// A key that stands for a click was pressed since the last update.
    pub(crate) click: Option<Click>,
    /// A text field had the focus at the end of the last update.
    pub(crate) was_typing: bool,
}

/// Advances the camera, and turns and moves it by keys and by the mouse over the viewport.
pub(crate) fn steer(
    state: &mut AppState,
    input: &mut Input,
    obstacles: Option<&Obstacles>,
    viewport: &Response,
) {
    let ctx = &viewport.ctx;
    input.viewport = Some(viewport.id);
    input.was_typing = ctx.text_edit_focused();
    keep_arrows(viewport);
    if viewport.drag_started()
        && let Some(id) = ctx.memory(|m| m.focused())
    {
        // A drag of the picture ends typing.
        ctx.memory_mut(|m| m.surrender_focus(id));
    }
    let factor = ctx.input(|i| speed_factor(i.modifiers));
    let secs = secs_of_motion(input, ctx);
    state.comparison.is_held = input.keyboard.is_held(Action::ShowFull);
    let mut playback = state.navigation.playback;
    let played = playback.advance(state.path(), secs);
    let navigation = &mut state.navigation;
    navigation.playback = playback;
    if let Some(camera) = played {
        navigation.fly.jump_to(camera);
    }
    grab(input, viewport);
    let height = viewport.rect.height().max(1.0);
    let drag = look_drag(viewport);
    navigation.fly.look([drag.x, drag.y].map(|points| f64::from(points) / f64::from(height)));
    input.cursor = viewport.hover_pos().filter(|_| viewport.contains_pointer()).map(|at| unit(viewport, at));
    if viewport.contains_pointer() {
        wheel(state, obstacles, viewport, factor);
    }
    click(state, input, obstacles, viewport);
    fly(state, input, obstacles, ctx, [secs, factor]);
    if let Some(note) = state.navigation.fly.take_note() {
        state.info(note);
    }
    if let Some(recording) = &mut state.navigation.recording {
        recording.note(state.navigation.fly.camera(), secs);
    }
}

/// Keeps the arrow keys from moving the focus away from the viewport.
fn keep_arrows(viewport: &Response) {
    let filter = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
    if viewport.has_focus() {
        viewport.ctx.memory_mut(|memory| memory.set_focus_lock_filter(viewport.id, filter));
    }
}

/// Returns the seconds by which motion advances: those since the last update, or those that an
/// update usually takes where motion has just begun.
fn secs_of_motion(input: &Input, ctx: &Context) -> f64 {
    let (since_last, usual) = ctx.input(|i| (i.unstable_dt, i.predicted_dt));
    f64::from(if input.is_moving { since_last.min(LONGEST_UPDATE_SECS) } else { usual })
}

/// Flies or walks by the keys that are held.
fn fly(
    state: &mut AppState,
    input: &mut Input,
    obstacles: Option<&Obstacles>,
    ctx: &Context,
    [secs, factor]: [f64; 2],
) {
    let keys = &input.keyboard;
    let motion = Motion {
        right: keys.axis(Action::Right, Action::Left),
        up: keys.axis(Action::Up, Action::Down),
        forward: keys.axis(Action::Forward, Action::Back),
        factor,
    };
    let turn = [keys.axis(Action::LookRight, Action::LookLeft), keys.axis(Action::LookDown, Action::LookUp)];
    let is_flying = [motion.right, motion.up, motion.forward] != [0.0; 3] || turn != [0.0; 2];
    let navigation = &mut state.navigation;
    if is_flying {
        navigation.playback.is_playing = false;
    }
    let angle = LOOK_PER_SEC * factor.min(MAX_LOOK_FACTOR) * secs;
    navigation.fly.look(turn.map(|axis| axis * angle));
    navigation.fly.advance(&motion, secs, obstacles);
    input.is_moving = is_flying || navigation.fly.is_easing() || navigation.playback.is_playing;
    match input.is_moving {
        true if state.software_adapter.is_some() && !state.options.is_paused => {
            ctx.request_repaint_after(LONGEST_WAIT);
        }
        true => ctx.request_repaint(),
        false => {}
    }
}

/// Holds the pointer in the window while the right button turns the camera, where the system can.
fn grab(input: &mut Input, viewport: &Response) {
    let wants = viewport.dragged_by(PointerButton::Secondary);
    if wants != input.has_grab {
        input.has_grab = wants;
        let grab = if wants { grab_mode() } else { CursorGrab::None };
        viewport.ctx.send_viewport_cmd(ViewportCommand::CursorGrab(grab));
        viewport.ctx.send_viewport_cmd(ViewportCommand::CursorVisible(!wants));
    }
}

/// A click inspects a pixel or sets a point of a measurement; a double click goes there. Keys do
/// the same at the cursor, or in the middle of the viewport.
fn click(state: &mut AppState, input: &mut Input, obstacles: Option<&Obstacles>, viewport: &Response) {
    let key = input.click.take();
    let Some(obstacles) = obstacles else { return };
    let is_measuring = state.selection.measure.is_on;
    if state.selection.dropper.is_some() && viewport.hovered() {
        viewport.ctx.set_cursor_icon(CursorIcon::Crosshair);
    }
    if is_measuring {
        let middle = viewport.has_focus().then_some([0.0, 0.0]);
        let hover = input.cursor.or(middle).and_then(|at| snap_at(state, obstacles, at, viewport.rect));
        state.selection.measure.hover = hover;
        if viewport.hovered() {
            viewport.ctx.set_cursor_icon(CursorIcon::Crosshair);
        }
    }
    let by_key = key.map(|_| input.cursor.unwrap_or_default());
    let by_pointer = || viewport.interact_pointer_pos().map(|at| unit(viewport, at));
    let Some(at) = by_key.or_else(by_pointer) else { return };
    if viewport.clicked_by(PointerButton::Primary) || key == Some(Click::Pick) {
        if state.selection.dropper.is_some() {
            pick(state, obstacles, at);
        } else if !is_measuring {
            state.selection.inspection = inspect(state, obstacles, at);
            let found = state.selection.inspection.as_ref().map(|found| found.material);
            state.selection.material = found.or(state.selection.material);
            if let Some(found) = &state.selection.inspection {
                state.selection.object.clone_from(&found.object);
            }
        } else if let Some(snap) = snap_at(state, obstacles, at, viewport.rect) {
            measure_to(state, snap);
        }
    }
    if (viewport.double_clicked() || key == Some(Click::GoThere))
        && let Some(probe) = probe_at(state, obstacles, at)
    {
        state.navigation.leave_pose();
        let fly = &mut state.navigation.fly;
        fly.ease_to(aim::gone_to(&probe, fly.camera()));
    }
}

/// Picks the material of a surface, to be copied.
fn pick(state: &mut AppState, obstacles: &Obstacles, at: [f64; 2]) {
    let found = probe_at(state, obstacles, at).map(|probe| probe.material);
    if let Some(dropper) = &mut state.selection.dropper {
        dropper.from = found;
    }
}

/// Sets a point; the second one of a pair adds a distance to the document.
fn measure_to(state: &mut AppState, snap: Snap) {
    let Some(pair) = state.selection.measure.set(snap) else { return };
    if let Some(document) = &mut state.document {
        let measures = [document.now().measures.as_slice(), &[pair]].concat();
        document.change(Change::Measures(measures));
    }
}

fn wheel(state: &mut AppState, obstacles: Option<&Obstacles>, viewport: &Response, factor: f64) {
    let (notches, at, is_right_down) =
        viewport.ctx.input(|i| (notches(&i.raw.events), i.pointer.hover_pos(), i.pointer.secondary_down()));
    let fly = &mut state.navigation.fly;
    if notches != 0.0 && is_right_down {
        fly.change_speed(notches);
    } else if notches != 0.0 {
        let [x, y] = unit(viewport, at.unwrap_or(viewport.rect.center()));
        let direction = fly.direction_through(x, y, f64::from(viewport.rect.aspect_ratio()));
        fly.dolly(direction, notches, factor, obstacles);
    }
}

/// Converts a point of the viewport to parts of its half size, right and up from the centre.
fn unit(viewport: &Response, at: Pos2) -> [f64; 2] {
    let (from_centre, half) = (at - viewport.rect.center(), viewport.rect.size() / 2.0);
    [f64::from(from_centre.x / half.x.max(1.0)), f64::from(-from_centre.y / half.y.max(1.0))]
}

/// Returns how far the pointer was dragged to turn the camera since the last update, in points.
/// Motion from before egui has decided that it is not a click counts too.
fn look_drag(viewport: &Response) -> Vec2 {
    if ![PointerButton::Primary, PointerButton::Secondary].into_iter().any(|b| viewport.dragged_by(b)) {
        return Vec2::ZERO;
    }
    viewport.ctx.input(|i| {
        let held = i.pointer.secondary_down().then(|| i.pointer.motion()).flatten();
        match (held, i.pointer.press_origin(), i.pointer.latest_pos()) {
            (Some(motion), ..) => motion * grabbed_motion_scale() / i.pixels_per_point(),
            (None, Some(origin), Some(at)) if viewport.drag_started() => at - origin,
            _ => i.pointer.delta(),
        }
    })
}

/// X11 cannot lock the pointer in place, only keep it in the window (winit#3094).
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

fn speed_factor(modifiers: egui::Modifiers) -> f64 {
    let up = if modifiers.shift { SPEED_FACTOR } else { 1.0 };
    if modifiers.alt { up / SPEED_FACTOR } else { up }
}

/// Returns the notches of the wheel from the events themselves: egui's scroll delta is smoothed
/// over several updates.
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
