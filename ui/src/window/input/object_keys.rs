//! The keys that move, hide and delete the selected object.

use crate::window::input::keymap::Action;
use crate::window::state::{AppState, Change, Command, EditCommand, SceneInfo};
use glam::DVec3;

/// Way of one press, metres.
const STEP_M: f64 = 0.1;

/// The command of a key for the selected object; `None` of other keys.
pub(super) fn object_command(state: &AppState, action: Action) -> Option<Command> {
    let forward = along_an_axis(state.navigation.fly.camera().forward());
    let right = forward.cross(DVec3::Y);
    let way = match action {
        Action::ObjectAway => forward,
        Action::ObjectNearer => -forward,
        Action::ObjectLeft => -right,
        Action::ObjectRight => right,
        Action::ObjectUp => DVec3::Y,
        Action::ObjectDown => -DVec3::Y,
        Action::HideObject | Action::DeleteObject => DVec3::ZERO,
        _ => return None,
    };
    let (Some(key), Some(document)) = (&state.selection.object, &state.document) else {
        return Some(Command::Say("click an object first".to_owned()));
    };
    let mut edit = document.object(key);
    let reach_m = state.scene.as_ref().map_or(0.0, SceneInfo::reach_m);
    edit.moved_m = (edit.moved_m + way * STEP_M).clamp(DVec3::splat(-reach_m), DVec3::splat(reach_m));
    edit.is_hidden ^= action == Action::HideObject;
    edit.is_deleted |= action == Action::DeleteObject;
    Some(Command::Edit(EditCommand::Change(Change::Object(key.clone(), edit))))
}

/// The horizontal axis that a direction is nearest to.
fn along_an_axis(direction: DVec3) -> DVec3 {
    match direction.x.abs() > direction.z.abs() {
        true => DVec3::X * direction.x.signum(),
        false => DVec3::Z * direction.z.signum(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn objects_move_along_the_axis_that_the_view_is_nearest_to() {
        for (direction, axis) in [
            (DVec3::new(0.3, -0.9, -0.4), -DVec3::Z),
            (DVec3::new(-0.5, 0.1, 0.4), -DVec3::X),
            (DVec3::new(0.1, 0.0, 0.2), DVec3::Z),
        ] {
            assert_eq!(along_an_axis(direction), axis);
            let right = along_an_axis(direction).cross(DVec3::Y);
            assert!((right - direction.cross(DVec3::Y).normalize_or(DVec3::X)).length() < 1.0);
        }
    }
}
