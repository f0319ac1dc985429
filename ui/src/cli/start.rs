//! `afterimage [SCENE]`: the window, or without a display the same walk headless.

use super::failure::Failure;
use super::flags::Flags;
use super::{output, tour};
use clap::Parser;

/// Where the headless walk leaves its records.
const OUT: &str = "afterimage-out";

pub(crate) fn start(scene: Option<&str>, flags: &Flags) -> Result<(), Failure> {
    if has_display() {
        return open_window(scene, flags);
    }
    output::say(&format!("no display was found; walking the scene's tour headless into {OUT}/"));
    tour::run(&headless_tour(scene), flags)
}

/// True where a window can be opened: someone said where.
fn has_display() -> bool {
    let is_set = |name: &&str| std::env::var_os(name).is_some_and(|v| !v.is_empty());
    cfg!(any(windows, target_os = "macos"))
        || ["WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY"].iter().any(is_set)
}

fn open_window(_scene: Option<&str>, _flags: &Flags) -> Result<(), Failure> {
    Err(Failure::Failed("this build has no window; 'afterimage tour' walks headless".to_owned()))
}

/// The tour with its defaults, as if its command had been typed.
fn headless_tour(scene: Option<&str>) -> tour::TourArgs {
    #[derive(Parser)]
    struct Typed {
        #[command(flatten)]
        args: tour::TourArgs,
    }
    let mut args = Typed::parse_from(["tour", "--out", OUT]).args;
    args.scene = scene.map(str::to_owned);
    args
}
