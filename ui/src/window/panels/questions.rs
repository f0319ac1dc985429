//! Modal questions. They have the keyboard focus: Tab cycles through the answers, Enter selects
//! one, Escape selects the one that changes nothing.

use super::super::state::{Answer, AppState, Command, FileCommand, Leaving, OutsidePicture};
use egui::{Context, Ui};

/// Shows the open question, if any.
pub fn show(ctx: &Context, state: &AppState, commands: &mut Vec<Command>) {
    if let Some(leaving) = &state.dialogs.leaving {
        ask_to_leave(ctx, state, leaving, commands);
    } else if let Some(picture) = &state.dialogs.outside_picture {
        ask_to_read(ctx, picture, commands);
    } else if state.dialogs.asks_to_clear {
        ask_to_clear(ctx, state, commands);
    } else if state.files.recovery.is_some() {
        ask_to_recover(ctx, commands);
    }
}

/// Shows a question and its answers; the first has the focus, and must not lose anything.
/// `otherwise` is the answer for Escape and for a click outside.
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
    // Without `otherwise`, the question stays open.
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

/// Asks before unsaved changes are lost.
fn ask_to_leave(ctx: &Context, state: &AppState, leaving: &Leaving, commands: &mut Vec<Command>) {
    let Some(scene) = &state.scene else { return };
    if !state.is_unsaved() && matches!(leaving, Leaving::Close) {
        return ask_to_end_export(ctx, commands);
    }
    let heading = match leaving {
        Leaving::Close => "Save changes before closing?",
        Leaving::Open(_) | Leaving::Show(..) => "Save changes before opening another scene?",
    };
    let text = format!(
        "{} has changes that are not saved. Save keeps all of them in a session: materials, light, views, path and settings.",
        scene.source.label()
    );
    let answer = Command::Answer;
    let answers = [
        ("Save", answer(Answer::Save)),
        ("Don't save", answer(Answer::Discard)),
        ("Cancel", answer(Answer::Stay)),
    ];
    ask(ctx, "leave", heading, &text, &answers, Some(answer(Answer::Stay)), commands);
}

/// Asks before closing the window ends an export.
fn ask_to_end_export(ctx: &Context, commands: &mut Vec<Command>) {
    let text = "Pictures are still being saved. Closing the window ends that; those that are complete stay.";
    let answer = Command::Answer;
    let answers = [("Keep open", answer(Answer::Stay)), ("Close", answer(Answer::Discard))];
    let stay = Some(answer(Answer::Stay));
    ask(ctx, "end export", "Stop saving pictures?", text, &answers, stay, commands);
}

/// Asks before a picture is read that a session names in another folder: the session may come from
/// elsewhere.
fn ask_to_read(ctx: &Context, picture: &OutsidePicture, commands: &mut Vec<Command>) {
    let text = format!(
        "The session of {} uses a picture of the sky in another folder: {}. Read it only if you know where the session comes from.",
        picture.source.label(),
        picture.name
    );
    let answers = [("Leave it out", Command::ReadOutside(false)), ("Read it", Command::ReadOutside(true))];
    let otherwise = Some(Command::ReadOutside(false));
    ask(
        ctx,
        "outside picture",
        "Read a picture outside the model's folder?",
        &text,
        &answers,
        otherwise,
        commands,
    );
}

/// Asks before all references are removed.
fn ask_to_clear(ctx: &Context, state: &AppState, commands: &mut Vec<Command>) {
    let [_, held] = state.references_used_and_held();
    let text = format!("There are {held}. New ones are traced when they are needed.");
    let answers = [("Keep", Command::KeepReferences), ("Clear all", Command::Clear)];
    ask(ctx, "clear", "Clear all references?", &text, &answers, Some(Command::KeepReferences), commands);
}

/// Asks whether to restore the session of a program that crashed.
fn ask_to_recover(ctx: &Context, commands: &mut Vec<Command>) {
    let text = "The program did not exit normally last time. The scene with all changes, views, path and pose was kept.";
    let answers = [
        ("Restore", Command::Files(FileCommand::Recover)),
        ("Start new", Command::Files(FileCommand::DiscardRecovery)),
    ];
    ask(ctx, "recover", "Restore the last session?", text, &answers, None, commands);
}
