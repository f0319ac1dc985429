//! Questions that must be answered before anything else. Each has the keyboard: Tab goes round the answers, Enter gives
//! one, Escape is the one that changes nothing.

use super::super::state::{Answer, AppState, Command, FileCommand, Leaving};
use crate::window::rendering::scene_loading::SceneSource;
use egui::{Context, Ui};

/// Shows the question that is open, if any.
pub fn show(ctx: &Context, state: &AppState, commands: &mut Vec<Command>) {
    if let Some(leaving) = &state.dialogs.leaving {
        ask_to_leave(ctx, state, leaving, commands);
    } else if state.dialogs.asks_to_clear {
        ask_to_clear(ctx, state, commands);
    } else if state.files.recovery.is_some() {
        ask_to_recover(ctx, commands);
    }
}

/// A question and its answers; the first has the keyboard. `otherwise` is Escape's and a click's beside it.
fn ask(
    ctx: &Context,
    name: &str,
    heading: &str,
    text: &str,
    answers: &[(&str, Command)],
    otherwise: Option<Command>,
    commands: &mut Vec<Command>,
) {
    let modal = egui::Modal::new(egui::Id::unique(name)).show(ctx, |ui| {
        ui.set_width(340.0);
        ui.heading(heading);
        ui.label(text);
        ui.add_space(8.0);
        ui.horizontal(|ui| buttons(ui, answers, commands));
    });
    // Closed is said by the click itself; without an answer that changes nothing the question stays.
    if modal.should_close() {
        commands.extend(otherwise);
    }
}

fn buttons(ui: &mut Ui, answers: &[(&str, Command)], commands: &mut Vec<Command>) {
    let ids: Vec<egui::Id> = answers
        .iter()
        .map(|(text, command)| {
            let button = ui.button(*text);
            if button.clicked() {
                commands.push(command.clone());
            }
            button.id
        })
        .collect();
    let focused = ui.memory(|m| m.focused());
    if let Some(first) = ids.first().filter(|_| !focused.is_some_and(|id| ids.contains(&id))) {
        ui.memory_mut(|m| m.request_focus(*first));
    }
}

/// Asks before changes are lost.
fn ask_to_leave(ctx: &Context, state: &AppState, leaving: &Leaving, commands: &mut Vec<Command>) {
    let Some(scene) = &state.scene else { return };
    let heading = match leaving {
        Leaving::Close => "Save changes before closing?",
        Leaving::Open(_) | Leaving::Show(..) => "Save changes before opening another scene?",
    };
    let name = scene.source.label();
    let answer = Command::Answer;
    let (text, answers) = if matches!(scene.source, SceneSource::File { .. }) {
        let text = format!("Materials or light of {name} were changed. They are saved in a file beside it.");
        let save = [("Save", answer(Answer::Save)), ("Don't save", answer(Answer::Discard))];
        (text, save.to_vec())
    } else {
        let text = format!(
            "Materials or light of {name} were changed. It is part of the program and has no folder to save \
             them beside."
        );
        (text, vec![("Lose changes", answer(Answer::Discard))])
    };
    let answers = [answers, vec![("Cancel", answer(Answer::Stay))]].concat();
    ask(ctx, "leave", heading, &text, &answers, Some(answer(Answer::Stay)), commands);
}

/// Asks before all references go.
fn ask_to_clear(ctx: &Context, state: &AppState, commands: &mut Vec<Command>) {
    let [_, held] = state.references_used_and_held();
    let text = format!("{held} are held. They are traced again where they are needed.");
    let answers = [("Clear all", Command::Clear), ("Keep", Command::KeepReferences)];
    ask(ctx, "clear", "Clear all references?", &text, &answers, Some(Command::KeepReferences), commands);
}

/// Asks whether a session that was cut short goes on.
fn ask_to_recover(ctx: &Context, commands: &mut Vec<Command>) {
    let text = "The program did not end as it should the last time. Scene, pose, views and path were kept.";
    let answers = [
        ("Go on", Command::Files(FileCommand::Recover)),
        ("Start anew", Command::Files(FileCommand::DiscardRecovery)),
    ];
    ask(ctx, "recover", "Go on where you were?", text, &answers, None, commands);
}
