//! The ring around the control that has the focus.

use egui::{Context, Event, Id, Key, Rect, Stroke, StrokeKind, Ui};

/// Draws the ring on top of the control, from when the focus is moved by a key until the pointer is
/// pressed.
pub fn show(ctx: &Context) {
    let id = Id::unique("focus ring");
    let is_shown = ctx.input(|input| {
        let moves =
            |event: &Event| matches!(event, Event::Key { key, pressed: true, .. } if moves_focus(*key));
        let is_moved = input.raw.events.iter().any(|event| moves(event) || is_by_reader(event));
        if is_moved { Some(true) } else { input.pointer.any_pressed().then_some(false) }
    });
    if let Some(is_shown) = is_shown {
        ctx.data_mut(|data| data.insert_temp(id, is_shown));
    }
    let focused = ctx.memory(|memory| memory.focused()).and_then(|id| ctx.read_response(id));
    let Some(control) = focused.filter(|_| ctx.data(|data| data.get_temp(id) == Some(true))) else { return };
    let visible = control.interact_rect;
    // The ring of what fills the window lies inside.
    let room = ctx.content_rect().shrink(4.0);
    let rect = control.rect.expand(2.0).intersect(Rect::from_min_max(room.min, room.max));
    let painter = ctx.layer_painter(control.layer_id).with_clip_rect(visible.expand(4.0));
    let color = ctx.global_style().visuals.selection.stroke.color;
    painter.rect_stroke(rect, 3.0, Stroke::new(2.0, color), StrokeKind::Middle);
}

fn moves_focus(key: Key) -> bool {
    matches!(key, Key::Tab | Key::F6 | Key::ArrowUp | Key::ArrowDown | Key::ArrowLeft | Key::ArrowRight)
}

/// True where assistive software moves the focus.
fn is_by_reader(event: &Event) -> bool {
    matches!(event, Event::AccessKitActionRequest(_))
}

/// Scrolls `ui` to a control that has got the focus by a key and is not fully shown.
pub fn scroll_to(ui: &Ui) {
    let Some(id) = ui.memory(|memory| memory.focused().filter(|id| !memory.had_focus_last_frame(*id))) else {
        return;
    };
    let Some(control) = ui.ctx().read_response(id) else { return };
    let is_here =
        control.layer_id == ui.layer_id() && ui.max_rect().x_range().contains(control.rect.center().x);
    if is_here && !control.interact_rect.contains_rect(control.rect) {
        ui.scroll_to_rect(control.rect.expand(6.0), None);
    }
}
