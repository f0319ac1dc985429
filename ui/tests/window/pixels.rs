//! Pixels that are drawn on a real device.

use super::*;
use egui::Key;

/// Returns a patch below and to the right of the viewport's centre: figures are at its upper left.
fn patch(harness: &mut Harness<'static, App>) -> Vec<[u8; 4]> {
    let centre = viewport_centre(harness) + egui::vec2(100.0, 50.0);
    let image = harness.render().expect("a picture of the window");
    let at = |x: i32, y: i32| image.get_pixel((centre.x as i32 + x) as u32, (centre.y as i32 + y) as u32).0;
    (-40..40).flat_map(|y| (-40..40).map(move |x| (x, y))).map(|(x, y)| at(x, y)).collect()
}

#[test]
fn the_heatmap_shows_types_in_their_colours() {
    let Some(mut harness) = app_with_graphics() else { return };
    harness.step();
    let plain = patch(&mut harness);
    harness.key_press(Key::T);
    harness.run_steps(2);
    let blended = patch(&mut harness);
    harness.key_press(Key::T);
    harness.run_steps(2);
    let only = patch(&mut harness);
    assert!(plain != blended && blended != only);
    let types = [[0x00, 0x72, 0xB2, 255], [0xF0, 0xE4, 0x42, 255]];
    let share = only.iter().filter(|p| types.contains(p)).count() as f64 / only.len() as f64;
    assert!(share > 0.9, "{share} of the patch in the colours of Type 1 and 2");
}

#[test]
fn the_picture_is_developed_as_the_engine_does_it() {
    let Some(mut harness) = app_with_graphics() else { return };
    harness.step();
    let frame = harness.state().state().frame.as_ref().expect("a frame");
    let [width, height] = frame.size.map(|s| s as usize);
    let at = height / 2 * width + width / 2;
    let packed = frame.radiance[at];
    let scale = 2f32.powi((packed >> 27) as i32 - 24);
    let radiance = glam::Vec3::from_array([0, 9, 18].map(|bit| (packed >> bit & 511) as f32 * scale));
    let expected =
        afterimage::raster::color::srgb8(radiance, harness.state().state().exposure_ev(), Default::default());
    let centre = viewport_centre(&harness);
    let image = harness.render().expect("a picture of the window");
    let shown = image.get_pixel(centre.x as u32, centre.y as u32).0;
    // Filtered between four pixels of one wall: only noise of one sample per light may differ.
    let distance = (0..3).map(|c| shown[c].abs_diff(expected[c])).max();
    assert!(distance < Some(40), "{shown:?} for {expected:?}");
}

#[test]
fn the_picture_stands_upright() {
    let Some(mut harness) = app_with_graphics() else { return };
    harness.step();
    let rect = harness.get_by_label("3D viewport").rect();
    let image = harness.render().expect("a picture of the window");
    let frame = harness.state().state().frame.as_ref().expect("a frame");
    let ([width, height], types) = (frame.size, &frame.types);
    // The mirror is the only Type 2; its rows on the screen are those of the frame.
    let rows: Vec<u32> = (0..height)
        .filter(|y| types[(y * width) as usize..((y + 1) * width) as usize].contains(&2))
        .collect();
    let middle = (rows[0] + rows[rows.len() - 1]) as f32 / 2.0 / height as f32;
    assert!((middle - 0.5).abs() > 0.01, "the start view does not tell up from down: {middle}");
    // Of the columns of the mirror, without the figures and the legend, whose swatches have the
    // same colour.
    let mirrors = || types.iter().enumerate().filter(|(_, t)| **t == 2).map(|(i, _)| i as u32 % width);
    let column =
        |x: Option<u32>| (rect.left() + x.expect("a mirror") as f32 / width as f32 * rect.width()) as u32;
    let columns = column(mirrors().min())..column(mirrors().max());
    harness.key_press(Key::T);
    harness.key_press(Key::T);
    harness.run_steps(2);
    drop(image);
    let image = harness.render().expect("a picture of the window");
    let is_mirror = |y: &u32| {
        let columns = columns.clone();
        columns.into_iter().any(|x| image.get_pixel(x, *y).0 == [0xF0, 0xE4, 0x42, 255])
    };
    let shown: Vec<u32> = (rect.top() as u32..rect.bottom() as u32 - 1).filter(is_mirror).collect();
    let last = (shown[shown.len() - 1] as f32 - rect.top()) / rect.height();
    let expected = rows[rows.len() - 1] as f32 / height as f32;
    assert!((last - expected).abs() < 0.02, "the mirror ends at {last}, in the frame at {expected}");
}
