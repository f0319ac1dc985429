//! Keys of the section.

use crate::window::input::keymap::Action;
use crate::window::state::{AppState, Change, Command, EditCommand, SectionView};

/// One press moves the plane by this length, metres.
const STEP_M: f64 = 0.1;

/// Returns the command of a key of the section.
pub(super) fn section_command(state: &AppState, action: Action) -> Option<Command> {
    let step_m = match action {
        Action::ToggleSection => return Some(toggled(state)),
        Action::SectionBack => -STEP_M,
        Action::SectionForward => STEP_M,
        _ => return None,
    };
    let section = state.document.as_ref().and_then(|document| document.now().section);
    let Some(mut section) = section.filter(|section| section.is_on) else {
        return Some(Command::Say("there is no section to move".to_owned()));
    };
    let [low, high] = state.scene.as_ref()?.building_m.map(|corner| corner[section.plane.axis]);
    section.plane.at_m = (section.plane.at_m + step_m).clamp(low, high);
    Some(changed(section))
}

fn toggled(state: &AppState) -> Command {
    let (Some(document), Some(scene)) = (&state.document, &state.scene) else {
        return Command::Say("there is no scene to cut".to_owned());
    };
    let camera = state.navigation.fly.camera();
    changed(match document.now().section {
        Some(section) => SectionView { is_on: !section.is_on, ..section },
        None => SectionView::new(scene.building_m, camera.eye, camera.forward()),
    })
}

fn changed(section: SectionView) -> Command {
    Command::Edit(EditCommand::Change(Change::Section(Some(section))))
}
