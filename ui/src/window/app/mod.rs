//! The app: applies commands, takes over results, and draws the window. Nothing else imports it.

mod autosave;
mod baking;
mod canvas;
mod choose_file;
mod comparison;
mod current_scene;
mod inspect;
mod lighting;
mod material_copy;
mod navigation;
mod open_scene;
mod panorama;
mod parts;
mod persistence;
mod picture_note;
mod picture_view;
mod pictures;
mod poll;
mod recovery;
mod render_request;
mod save_shown;
mod scene_edits;
mod services;
mod session;
mod update;
mod watch;
mod window_app;

use afterimage::render::schedule::MOTION_TIME;
use autosave::Autosave;
use baking::{poll_bake, toggle_bake, update_floor};
use canvas::Canvas;
use choose_file::{handle_list, poll_files, set_path_text};
use comparison::{overlay, update_comparison};
use current_scene::{Arrival, CurrentScene, PictureNote, ReadNote};
use inspect::{handle_inspect, show_reference, update_outline, update_plan, update_thumbnails};
use lighting::{handle_lighting, poll_lighting, rendered_quantity};
use material_copy::paste_picked;
use navigation::{end_recording, go_to, handle_navigation};
use open_scene::{
    answer_outside, cancel_loading, handle_answer, hold_close, is_shown, open, open_model, open_new,
    open_path, open_session, poll_loading, poll_saving, poll_watch, reload,
};
use panorama::panorama_job;
use parts::Parts;
use persistence::{
    autosave, end_autosave, forget_recent, is_own_recovery, read_state_folder, remember_model,
    restore_session, save_session,
};
use picture_note::{apply_note, show_note};
use picture_view::go_to_picture;
use pictures::{handle_picture, poll_export, save_from_references};
use poll::poll;
use recovery::{Recovery, is_recovery, keep_session, left_behind};
use render_request::{current_work, note_frame, send_request};
use save_shown::save_shown;
use scene_edits::{
    begin_document, change, handle_edit, is_sky, open_sky, poll_edit, rebuild, show_sky_picture,
};
use services::{
    AppEvent, Choosing, FloorWatch, Measurement, PendingEdit, SavedEdit, SavedSession, Services, model_folder,
};
use session::{EXTENSION, SessionFile, beside_model, is_session, write_session};
use update::{apply, show_appearance};
use watch::{OwnWrites, look_again, modified, watch};
pub use window_app::App;
