//! A real window on a virtual display, driven as by a user: keys, drags, clicks. Its effects are
//! read from the clipboard, from files and from the screen; screenshots are kept in the build
//! folder.

use super::desk::{COURTYARD, Desk, display, program};
use std::process::{Command, Output};

pub(super) const TYPE1: [u8; 3] = [0x00, 0x72, 0xB2];
/// Background of panels: a fifth of the window, half of it with the help.
const PANEL: [u8; 3] = [0x1B, 0x1B, 0x1B];
/// A point of the picture away from panels and figures.
pub(super) const MIDDLE: &str = "600 500";

#[test]
fn a_person_walks_looks_and_saves() {
    let Some(desk) = Desk::open() else { return };
    let start = desk.pose();
    desk.shoot("start");

    let ahead = desk.fly("w", start.eye);
    let way = ahead.eye - start.eye;
    assert!(way.normalize_or_zero().dot(start.forward()) > 0.99, "W flies ahead: {way}");

    desk.xdotool(&format!("mousemove {MIDDLE} sleep 0.3 mousedown 1 sleep 0.6"));
    // Slowly: press and release within one frame of a busy machine are a click.
    for _ in 0..4 {
        desk.xdotool("mousemove_relative 25 0 sleep 0.4");
    }
    desk.xdotool("sleep 0.4 mouseup 1");
    let turned = desk.pose();
    let is_there = turned.eye.distance(ahead.eye) < 1e-3;
    assert!(
        turned.yaw < ahead.yaw - 0.1 && is_there,
        "a drag to the right looks right: {ahead:?} {turned:?}"
    );

    desk.xdotool("click --delay 100 4");
    let nearer = desk.pose();
    assert!(nearer.eye.distance(turned.eye) > 0.1, "the wheel flies to the cursor");

    desk.xdotool("key 1");
    let back = desk.pose();
    assert!(back.eye.distance(start.eye) < 1e-3, "1 goes to the first saved view");

    // A key pressed again within one frame counts as held.
    desk.xdotool("key t sleep 1 key t");
    desk.wait_for_share("types", TYPE1, 0.2);

    desk.xdotool("key F1");
    desk.wait_for_share("help", PANEL, 0.35);
    // Both keys in one frame would find the help still open.
    desk.xdotool("key Escape");
    desk.wait_for("the help to close", || (desk.share("closed", PANEL) < 0.3).then_some(()));
    desk.xdotool("key F2");
    desk.wait_for("a window without panels", || (desk.share("bare", PANEL) < 0.02).then_some(()));
    desk.xdotool("key F2");
    desk.wait_for_share("panels", PANEL, 0.15);

    desk.xdotool("key F12");
    let picture = desk.wait_for("a picture", || desk.saved("png"));
    let picture = image::open(picture).expect("a whole picture").to_rgb8();
    assert!(picture.width() > 200 && picture.pixels().any(|p| p.0 != picture.get_pixel(0, 0).0));
    desk.shoot("end");
}

#[test]
fn drawing_again_and_again_takes_no_memory() {
    // In the other modes the picture at rest is refined at full size, and memory grows with it.
    let arguments = ["model.obj", "--samples", "1", "--bounces", "1", "--mode", "paper"];
    let Some(desk) = Desk::start(Some(COURTYARD), &arguments, &[]) else { return };
    let wander = |steps: u32| {
        let moves: String = (0..steps)
            .map(|i| format!("mousemove {} {} sleep 0.03 ", 100 + i % 50, 300 + i * 7 % 90))
            .collect();
        desk.xdotool(&moves);
    };
    // Everything that is created once exists by then.
    wander(40);
    let (_, before) = desk.usage();
    wander(120);
    let (_, after) = desk.usage();
    // Shaders compiled at every draw took 0.5 MB per step.
    assert!(after < before + 16 * 1024, "{before} KiB grew to {after} KiB; {}", desk.evidence());
}

#[test]
fn missing_parts_are_reported_in_one_sentence() {
    let Some(display) = display() else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let failure = |command: &mut Command| {
        let Output { status, stderr, .. } = command.output().expect("the program runs");
        (status.code(), String::from_utf8_lossy(&stderr).into_owned())
    };
    let mut no_driver = program(&display.name, folder.path());
    no_driver.envs([
        ("VK_ICD_FILENAMES", "/nonexistent"),
        ("VK_DRIVER_FILES", "/nonexistent"),
        ("WGPU_BACKEND", "vulkan"),
    ]);
    let mut no_server = program(":987", folder.path());
    for (what, command) in [("no driver", &mut no_driver), ("no server", &mut no_server)] {
        let (code, text) = failure(command);
        assert_eq!(code, Some(1), "{what}: {text}");
        assert!(
            text.contains("the window cannot be opened") && text.contains("mesa-vulkan-drivers"),
            "{what}: {text}"
        );
        assert!(!text.contains("panicked") && text.trim().lines().count() == 1, "{what}: {text}");
    }
}

#[test]
fn a_signal_to_end_closes_the_window_and_leaves_no_question_for_the_next_start() {
    let Some(mut desk) = Desk::open() else { return };
    let start = desk.pose();
    desk.fly("w", start.eye);
    let id = desk.app.id().to_string();
    assert!(Command::new("kill").args(["-TERM", &id]).status().expect("kill runs").success());
    let status = desk.app.wait().expect("it ends");
    assert!(status.success(), "{status}; {}", desk.evidence());
    let state = desk.folder().join(".local/state/afterimage");
    let files = std::fs::read_dir(state).into_iter().flatten().flatten();
    let kept: Vec<_> =
        files.filter(|file| file.file_name().to_string_lossy().starts_with("recovery-")).collect();
    assert!(kept.is_empty(), "only the camera has moved: {kept:?}");
}
