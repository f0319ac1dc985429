//! Frames while the view moves: whatever time they have, they show the surfaces of their pose with
//! their textures, in light that is known or filled from around.

use crate::rooms::{dvec, quad, room_camera, room_tracer};
use afterimage::raster::pixel_types::PixelType;
use afterimage::reference::{PlacementPolicy, placement::NONE};
use afterimage::scene::{Encoding, Material, SceneBuilder, Sun, Texture, TextureRef};
use afterimage::trace::{TraceSettings, parallel::NEVER};
use afterimage::{Camera, Mode, RenderSettings, Tracer, Walkthrough, WalkthroughSettings};
use glam::Vec3;
use std::sync::Arc;

const SIZE: [u32; 2] = [90, 54];

/// The modes that find the surface of every pixel.
const MODES: [Mode; 3] = [Mode::Full, Mode::Fast, Mode::Exact];

fn walk(tracer: &Arc<Tracer>, mode: Mode) -> Walkthrough {
    let trace = TraceSettings { samples: 4, bounces: 0, seed: 9 };
    let settings = WalkthroughSettings {
        render: RenderSettings { mode, trace },
        placement: PlacementPolicy::new(&NONE, 0.0),
        ..WalkthroughSettings::default()
    };
    Walkthrough::new(tracer.clone(), settings).progressive()
}

/// A step into the room.
fn stepped(step: f64) -> Camera {
    Camera { eye: room_camera().eye + room_camera().forward() * step, ..room_camera() }
}

/// A floor and two walls that form a corner, open to the sun, with a checkered texture.
fn sunny_corner() -> Arc<Tracer> {
    let mut b = SceneBuilder::new("corner");
    let texel =
        |i: u32| if (i % 8 + i / 8).is_multiple_of(2) { [230, 200, 60, 255] } else { [30, 60, 120, 255] };
    let texels = (0..64).map(texel).collect();
    let texture = b.add_texture(Texture { width: 8, height: 8, texels, encoding: Encoding::Srgb });
    let map = Some(TextureRef::plain(texture));
    let tiles = b.add_material(Material { diffuse_texture: map, ..Material::diffuse("tiles", Vec3::ONE) });
    let [x, y, z] = [dvec(4.0, 0.0, 0.0), dvec(0.0, 4.0, 0.0), dvec(0.0, 0.0, 4.0)];
    for (u, v) in [(z, x), (x, y), (y, z)] {
        quad(&mut b, dvec(0.0, 0.0, 0.0), u, v, tiles);
    }
    let direction = Vec3::new(0.5, 0.8, 0.6).normalize_or(Vec3::Y);
    b.sun = Some(Sun { direction, angular_radius: 0.0, irradiance: Vec3::new(3.0, 2.5, 2.0) });
    Arc::new(Tracer::new(Arc::new(b.finish().unwrap())))
}

#[test]
fn in_even_light_a_frame_that_is_stopped_at_once_is_the_whole_picture() {
    let tracer = sunny_corner();
    let camera = Camera::look_at(dvec(5.0, 4.0, 6.0), dvec(1.0, 1.0, 1.0), 50.0);
    for mode in MODES {
        let mut walk = walk(&tracer, mode);
        let cut = walk.render(&camera, SIZE, &|| true).clone();
        assert!(!cut.stats.is_complete, "{mode:?}: nothing was left to do");
        let whole = walk.resume(NEVER);
        assert!(whole.stats.is_complete && whole.stats.types.unseen > 1000);
        for (pixel, (cut, whole)) in cut.radiance.iter().zip(&whole.radiance).enumerate() {
            let off = (*cut - *whole).abs().max_element();
            assert!(off <= 1e-4 * whole.max_element(), "{mode:?}: pixel {pixel} shows {cut} for {whole}");
        }
    }
}

#[test]
fn a_frame_that_is_stopped_at_once_shows_the_surfaces_of_its_pose() {
    let tracer = Arc::new(room_tracer(true, true));
    for mode in MODES {
        let mut moving = walk(&tracer, mode);
        for step in 0..4 {
            let camera = stepped(0.3 * f64::from(step));
            let cut = moving.render(&camera, SIZE, &|| true).clone();
            let mut whole = walk(&tracer, mode);
            let whole = whole.render(&camera, SIZE, NEVER);
            assert!(!cut.stats.is_complete && cut.camera == camera);
            assert!(cut.triangle == whole.triangle && cut.disparity == whole.disparity, "{mode:?}, {step}");
            assert!(cut.types == whole.types, "{mode:?}: what is filled counts as unseen");
        }
    }
}

/// The mean distance of two pictures over pixels of matte surfaces, as a share of their light.
fn mean_error(shown: &[Vec3], whole: &[Vec3], is_matte: impl Fn(usize) -> bool) -> f32 {
    let matte = || (0..whole.len()).filter(|&i| is_matte(i) && whole[i].max_element() < 1.0);
    let off: f32 = matte().map(|i| (shown[i] - whole[i]).abs().element_sum()).sum();
    off / matte().map(|i| whole[i].element_sum()).sum::<f32>()
}

#[test]
fn light_is_filled_from_around_and_carried_on_from_frame_to_frame() {
    let tracer = Arc::new(room_tracer(false, false));
    for mode in MODES {
        let (mut truth, mut walk) = (walk(&tracer, Mode::Full), walk(&tracer, mode));
        let mut settings = *truth.settings();
        settings.render.trace.samples = 64;
        truth.set_settings(settings);
        let mut errors = Vec::new();
        for step in 0..12 {
            let camera = stepped(0.02 * f64::from(step));
            let cut = walk.render(&camera, SIZE, &|| true).radiance.clone();
            let whole = truth.render(&camera, SIZE, NEVER);
            let darkest = cut.iter().map(|c| c.max_element()).fold(f32::INFINITY, f32::min);
            assert!(darkest > 0.0, "{mode:?}: frame {step} has black pixels");
            errors.push(mean_error(&cut, &whole.radiance, |i| whole.types[i] == PixelType::Unseen));
        }
        // One pixel in 256 was traced, of the first frame only.
        assert!(errors.iter().all(|&error| error < 0.8), "{mode:?}: {errors:?}");
    }
}
