//! The last frame seen from another pose: the shader against rays, and the whole window against the
//! frame that follows.

use super::*;
use afterimage::Camera;
use afterimage::camera::{SceneFrame, View};
use afterimage_ui::window::gpu::timewarp::{Reprojection, Timewarp};
use afterimage_ui::window::rendering::depth_ranges::DepthRanges;
use egui::{Key, Modifiers, vec2};
use glam::{DVec3, Vec2, Vec3};

const SIZE: [u32; 2] = [160, 100];
const WORLD: SceneFrame = SceneFrame { origin_in_world_m: DVec3::ZERO, units_per_metre: 1.0 };

/// A wall 6 m away and a board of 1.2 m in front of it.
fn depth(view: &View, direction: Vec3) -> (f32, bool) {
    let board = (-3.0 - view.eye.z) / direction.z;
    let at = view.eye + direction * board;
    let is_board = board > 0.0 && at.x.abs() < 0.6 && at.y.abs() < 0.6;
    (if is_board { board } else { (-6.0 - view.eye.z) / direction.z }, is_board)
}

fn camera(x: f64, y: f64, z: f64, yaw: f64) -> Camera {
    Camera { eye: DVec3::new(x, y, z), yaw, ..Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 60.0) }
}

fn project(view: &View, position: Vec3) -> Option<Vec2> {
    let q = view.scene_from_pixel.inverse() * (position - view.eye);
    let at = Vec2::new(q.x / q.z, q.y / q.z);
    let size = Vec2::new(SIZE[0] as f32, SIZE[1] as f32);
    (q.z > 0.0 && at.cmpge(Vec2::ZERO).all() && at.cmplt(size).all()).then_some(at)
}

fn device() -> Option<(wgpu::Adapter, wgpu::Device, wgpu::Queue)> {
    if !has_adapter() {
        let is_required = std::env::var("AFTERIMAGE_REQUIRE_GRAPHICS").is_ok_and(|v| v == "1");
        assert!(!is_required, "no graphics adapter");
        writeln!(std::io::stderr(), "skipped: no graphics adapter").expect("stderr");
        return None;
    }
    let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
    let adapter = pollster::block_on(instance.request_adapter(&Default::default())).expect("an adapter");
    let (device, queue) = pollster::block_on(adapter.request_device(&Default::default())).expect("a device");
    Some((adapter, device, queue))
}

/// Displacement of every pixel, and whether it is filled.
fn warp(from: &Camera, to: &Camera) -> Option<Vec<(Vec2, bool)>> {
    let (adapter, device, queue) = device()?;
    let timewarp = Timewarp::new(&adapter, &device).expect("half floats can be drawn to");
    let map = timewarp.make_map(&device, SIZE);
    let view = View::new(from, &WORLD, SIZE);
    let disparity: Vec<f32> =
        (0..view.pixel_count() as u32).map(|i| 1.0 / depth(&view, view.direction_of_pixel(i)).0).collect();
    let extent = wgpu::Extent3d { width: SIZE[0], height: SIZE[1], depth_or_array_layers: 1 };
    let rows = |bytes| wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(SIZE[0] * bytes),
        rows_per_image: None,
    };
    let mut ranges = DepthRanges::default();
    ranges.fill(&disparity, SIZE);
    map.write(&queue, &ranges);
    let nearest = disparity.iter().copied().fold(0.0, f32::max);
    let mut encoder = device.create_command_encoder(&Default::default());
    timewarp.draw(&queue, &mut encoder, &map, &Reprojection::new(from, to, &WORLD, SIZE, nearest));
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: u64::from(SIZE[0] * SIZE[1] * 8),
        usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let target = wgpu::TexelCopyBufferInfo { buffer: &buffer, layout: rows(8) };
    encoder.copy_texture_to_buffer(map.map.as_image_copy(), target, extent);
    queue.submit([encoder.finish()]);
    buffer.slice(..).map_async(wgpu::MapMode::Read, |mapped| mapped.expect("the map comes back"));
    device.poll(wgpu::PollType::wait_indefinitely()).expect("the device works");
    let bytes = buffer.slice(..).get_mapped_range().expect("mapped").to_vec();
    let halves: &[[u16; 4]] = bytemuck::cast_slice(&bytes);
    Some(halves.iter().map(|h| (Vec2::new(f32_of_half(h[0]), f32_of_half(h[1])), h[2] != 0)).collect())
}

fn f32_of_half(half: u16) -> f32 {
    let sign = if half >> 15 == 1 { -1.0 } else { 1.0 };
    let (exponent, fraction) = (i32::from(half >> 10 & 31), f32::from(half & 1023));
    match exponent {
        0 => sign * fraction * 2f32.powi(-24),
        _ => sign * (1.0 + fraction / 1024.0) * 2f32.powi(exponent - 15),
    }
}

fn centre_of(pixel: usize) -> Vec2 {
    Vec2::new((pixel % SIZE[0] as usize) as f32 + 0.5, (pixel / SIZE[0] as usize) as f32 + 0.5)
}

#[test]
fn from_the_same_place_nothing_moves_and_nothing_is_filled() {
    let here = camera(0.3, 0.1, 0.0, 0.2);
    let Some(map) = warp(&here, &here) else { return };
    assert!(map.iter().all(|(moved, is_filled)| moved.length() < 1e-3 && !is_filled));
}

#[test]
fn a_turn_moves_every_pixel_to_where_its_ray_is_seen() {
    let (from, to) = (camera(0.0, 0.0, 0.0, 0.0), camera(0.0, 0.0, 0.0, 0.12));
    let Some(map) = warp(&from, &to) else { return };
    let [source, target] = [from, to].map(|c| View::new(&c, &WORLD, SIZE));
    let mut kept = 0;
    for (pixel, (moved, is_filled)) in map.into_iter().enumerate() {
        let direction = target.direction_of_pixel(pixel as u32);
        let Some(at) = project(&source, target.eye + direction) else {
            assert!(is_filled, "pixel {pixel} was beside the frame");
            continue;
        };
        let error = (centre_of(pixel) + moved - at).length();
        assert!(!is_filled && error < 0.05, "pixel {pixel}: {moved} is {error} off");
        kept += 1;
    }
    assert!((13_000..15_500).contains(&kept), "{kept} of 16000 pixels are seen from both");
}

/// Ground truth of a pixel of the new view: on the board or not, and where the frame shows it, if
/// it does.
fn truth(source: &View, target: &View, pixel: usize) -> (bool, Option<Vec2>) {
    let direction = target.direction_of_pixel(pixel as u32);
    let (t, is_board) = depth(target, direction);
    let at = project(source, target.eye + direction * t);
    let is_seen = |at: &Vec2| depth(source, source.direction_of_point(at.x, at.y)).1 == is_board;
    (is_board, at.filter(is_seen))
}

/// True where all pixels within two of this one are of its kind: silhouettes are known to about a
/// pixel.
fn is_plain(kinds: &[(bool, bool)], pixel: usize) -> bool {
    let [width, height] = SIZE.map(|s| s as i64);
    let (x, y) = (pixel as i64 % width, pixel as i64 / width);
    let beside = (-2..=2).flat_map(|dy| (-2..=2).map(move |dx| (x + dx, y + dy)));
    beside
        .filter(|(x, y)| (0..width).contains(x) && (0..height).contains(y))
        .all(|(x, y)| kinds[(y * width + x) as usize] == kinds[pixel])
}

/// Checks every pixel off the silhouettes; `seen` and `hidden` are the least numbers of pixels to
/// check.
fn agrees_with_rays(to: &Camera, seen: usize, hidden: usize) {
    let from = camera(0.0, 0.0, 0.0, 0.0);
    let Some(map) = warp(&from, to) else { return };
    let [source, target] = [from, *to].map(|c| View::new(&c, &WORLD, SIZE));
    let truths: Vec<_> = (0..map.len()).map(|pixel| truth(&source, &target, pixel)).collect();
    let kinds: Vec<_> = truths.iter().map(|(is_board, at)| (*is_board, at.is_some())).collect();
    let mut checked = [0, 0];
    for pixel in (0..map.len()).filter(|pixel| is_plain(&kinds, *pixel)) {
        let (moved, is_filled) = map[pixel];
        let Some(at) = truths[pixel].1 else {
            assert!(is_filled, "pixel {pixel} was not seen by the frame");
            checked[1] += 1;
            continue;
        };
        let error = (centre_of(pixel) + moved - at).length();
        assert!(!is_filled && error < 0.25, "pixel {pixel}, filled: {is_filled}, is {error} off");
        checked[0] += 1;
    }
    assert!(checked[0] >= seen && checked[1] >= hidden, "{checked:?} checked");
}

#[test]
fn a_step_aside_finds_the_first_surface_and_marks_what_was_hidden() {
    agrees_with_rays(&camera(0.35, 0.0, 0.0, 0.0), 13_000, 300);
    agrees_with_rays(&camera(-0.1, 0.08, 0.0, 0.0), 13_000, 0);
}

#[test]
fn a_step_ahead_and_back_finds_it_too() {
    agrees_with_rays(&camera(0.0, 0.0, -0.5, 0.0), 13_000, 0);
    agrees_with_rays(&camera(0.05, 0.0, 0.6, 0.05), 11_000, 1000);
}

#[test]
fn after_a_long_flight_it_still_finds_the_first_surface() {
    agrees_with_rays(&camera(1.6, 0.2, -0.9, 0.2), 6000, 1000);
}

#[test]
fn what_was_hidden_is_filled_from_the_wall_behind() {
    let (from, to) = (camera(0.0, 0.0, 0.0, 0.0), camera(0.5, 0.0, 0.0, 0.0));
    let Some(map) = warp(&from, &to) else { return };
    let [source, target] = [from, to].map(|c| View::new(&c, &WORLD, SIZE));
    let size = Vec2::new(SIZE[0] as f32, SIZE[1] as f32);
    let (mut filled, mut by_board) = (0, 0);
    for (pixel, (moved, is_filled)) in map.into_iter().enumerate() {
        let direction = target.direction_of_pixel(pixel as u32);
        let is_in_frame = project(&source, target.eye + direction * depth(&target, direction).0).is_some();
        if is_filled && is_in_frame {
            let from = (centre_of(pixel) + moved).clamp(Vec2::ZERO, size);
            filled += 1;
            by_board += usize::from(depth(&source, source.direction_of_point(from.x, from.y)).1);
        }
    }
    assert!(filled > 150 && by_board * 10 < filled, "{by_board} of {filled} are filled from the board");
}

/// Returns the viewport's pixels without the figures at its upper left.
fn shown(harness: &mut Harness<'static, App>) -> Vec<[u8; 4]> {
    let rect = harness.get_by_label("3D viewport").rect().shrink(12.0);
    let image = harness.render().expect("a picture of the window");
    let columns = rect.left() as u32 + 220..rect.right() as u32;
    let rows = rect.top() as u32..rect.bottom() as u32;
    rows.flat_map(|y| columns.clone().map(move |x| (x, y))).map(|(x, y)| image.get_pixel(x, y).0).collect()
}

fn psnr_db(a: &[[u8; 4]], b: &[[u8; 4]]) -> f64 {
    let square = |(a, b): (&[u8; 4], &[u8; 4])| -> f64 {
        (0..3).map(|c| (f64::from(a[c]) - f64::from(b[c])).powi(2)).sum::<f64>() / 3.0
    };
    let mse = a.iter().zip(b).map(square).sum::<f64>() / a.len() as f64;
    10.0 * (255.0f64.powi(2) / mse).log10()
}

#[test]
fn the_picture_follows_the_hand_though_nothing_is_rendered() {
    let Some(mut harness) = app_with_graphics() else { return };
    harness.key_press_modifiers(Modifiers::SHIFT, Key::P);
    harness.run_steps(2);
    let rendered = harness.state().threads().frames_rendered();
    let before = shown(&mut harness);
    harness.key_down(Key::D);
    harness.run_steps(4);
    harness.key_up(Key::D);
    harness.step();
    let followed = shown(&mut harness);
    assert_eq!(harness.state().threads().frames_rendered(), rendered);
    harness.key_press(Key::P);
    settle(&mut harness);
    harness.step();
    let after = shown(&mut harness);
    let (stale, warped) = (psnr_db(&before, &after), psnr_db(&followed, &after));
    assert!(warped > stale + 6.0 && warped > 26.0, "{warped} dB, {stale} dB if it stood still");
}

#[test]
fn what_the_frame_did_not_see_is_marked_in_the_heatmap() {
    let Some(mut harness) = app_with_graphics() else { return };
    for (modifiers, key) in [(Modifiers::SHIFT, Key::P), (Modifiers::NONE, Key::T), (Modifiers::NONE, Key::T)]
    {
        harness.key_press_modifiers(modifiers, key);
        harness.step();
    }
    let filled = [0xCC, 0x79, 0xA7, 255];
    let count = |harness: &mut Harness<'static, App>| shown(harness).iter().filter(|p| **p == filled).count();
    assert_eq!(count(&mut harness), 0, "at rest nothing is filled");
    let centre = viewport_centre(&harness);
    harness.hover_at(centre);
    harness.step();
    harness.drag_at(centre);
    harness.step();
    harness.hover_at(centre + vec2(30.0, 0.0));
    harness.step();
    harness.drop_at(centre + vec2(30.0, 0.0));
    harness.step();
    assert!(count(&mut harness) > 500, "a band at the border");
}
