//! A small golden file: the type of every pixel of a known view.

use crate::rooms::{room_camera, room_tracer};
use afterimage::{
    Camera, FrameRequest, Mode, RenderSettings, Renderer, reference::ReferenceFrame, trace::TraceSettings,
    trace::parallel::NEVER,
};
use std::path::Path;

/// After a change that is meant to change pixels, run with `AFTERIMAGE_BLESS=1`, inspect the
/// difference, and explain it in the commit message.
#[test]
fn pixel_types_of_a_room_seen_from_two_steps_ahead() {
    let size = [64, 40];
    let tracer = room_tracer(true, true);
    let settings =
        RenderSettings { mode: Mode::Paper, trace: TraceSettings { samples: 1, bounces: 0, seed: 0 } };
    let start = room_camera();
    let reference = ReferenceFrame::trace(&tracer, &start, size, &settings.trace, NEVER).unwrap();
    let camera = Camera { eye: start.eye + start.forward() * 0.8, yaw: start.yaw + 0.15, ..start };
    let mut renderer = Renderer::default();
    let request = FrameRequest::new(&tracer, &camera, size, &settings);
    let frame = renderer.render(&request.warping(&[&reference]));
    let row = |types: &[_]| {
        types.iter().map(|t: &afterimage::raster::pixel_types::PixelType| t.number().to_string()).collect()
    };
    let rows: Vec<String> = frame.types.chunks(size[0] as usize).map(row).collect();
    let map = rows.join("\n") + "\n";
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/room_types.txt");
    if std::env::var_os("AFTERIMAGE_BLESS").is_some() {
        std::fs::write(&path, &map).unwrap();
    }
    assert!(
        std::fs::read_to_string(&path).unwrap() == map,
        "the map differs from {}:\n{map}",
        path.display()
    );
}
