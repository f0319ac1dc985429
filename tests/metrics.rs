//! Figures of difference against cases worked out by hand.

use afterimage::raster::load::{Picture, PictureKind, display_of};
use afterimage::raster::metrics::{PSNR_OF_EQUALS_DB, flip, max_abs, psnr_db, rel_mse, ssim};
use glam::Vec3;

const SIZE: [u32; 2] = [32, 24];

/// Smooth, with some texture, all values in 0.2..0.8.
fn pattern() -> Vec<Vec3> {
    let value = |i: u32| {
        let (x, y) = ((i % SIZE[0]) as f32, (i / SIZE[0]) as f32);
        Vec3::new(0.5 + 0.3 * (x * 0.7).sin(), 0.5 + 0.3 * (y * 0.5).cos(), 0.5)
    };
    (0..SIZE[0] * SIZE[1]).map(value).collect()
}

fn moved(by: f32) -> Vec<Vec3> {
    pattern().iter().map(|v| *v + by).collect()
}

#[test]
fn a_constant_offset_has_the_psnr_of_its_square() {
    // mse = 0.1^2, so -10 log10(0.01) = 20 dB.
    assert!((psnr_db(&moved(0.1), &pattern()) - 20.0).abs() < 1e-4);
    assert!((psnr_db(&moved(0.01), &pattern()) - 40.0).abs() < 1e-3);
}

#[test]
fn one_wrong_channel_of_one_pixel() {
    let mut a = pattern();
    a[5].y += 0.2;
    // mse = 0.04 / (3 * 768).
    let expected = -10.0 * (0.04f64 / 2304.0).log10();
    assert!((psnr_db(&a, &pattern()) - expected).abs() < 1e-3);
    assert!((max_abs(&a, &pattern()) - 0.2).abs() < 1e-6);
}

#[test]
fn equal_pictures_are_perfect() {
    let a = pattern();
    assert_eq!(psnr_db(&a, &a), PSNR_OF_EQUALS_DB);
    assert_eq!(rel_mse(&a, &a), 0.0);
    assert_eq!(max_abs(&a, &a), 0.0);
    assert!((ssim(&a, &a, SIZE) - 1.0).abs() < 1e-12);
    let f = flip(&a, &a, SIZE).unwrap();
    assert_eq!((f.mean, f.p95), (0.0, 0.0));
}

#[test]
fn rel_mse_divides_by_the_truth() {
    let (a, b) = (vec![Vec3::splat(1.5)], vec![Vec3::splat(1.0)]);
    assert!((rel_mse(&a, &b) - 0.25 / 1.01).abs() < 1e-9);
    assert!((rel_mse(&b, &a) - 0.25 / 2.26).abs() < 1e-9);
}

#[test]
fn ssim_of_two_flat_pictures_is_their_luminance_term() {
    let flat = |v: f32| vec![Vec3::splat(v); 768];
    let (a, b) = (0.4f64, 0.6f64);
    let expected = (2.0 * a * b + 1e-4) / (a * a + b * b + 1e-4);
    assert!((ssim(&flat(0.4), &flat(0.6), SIZE) - expected).abs() < 1e-5);
}

#[test]
fn ssim_sees_lost_structure_and_small_pictures() {
    let grey = vec![Vec3::splat(0.5); 768];
    assert!(ssim(&grey, &pattern(), SIZE) < 0.5);
    assert!((ssim(&grey[..4], &grey[..4], [2, 2]) - 1.0).abs() < 1e-12);
}

#[test]
fn flip_grows_with_the_difference_and_stays_below_one() {
    let means = [0.02, 0.05, 0.2].map(|by| flip(&moved(by), &pattern(), SIZE).unwrap());
    assert!(means[0].mean < means[1].mean && means[1].mean < means[2].mean && means[2].p95 <= 1.0);
    let black_white = flip(&vec![Vec3::ONE; 768], &vec![Vec3::ZERO; 768], SIZE).unwrap();
    assert!(black_white.mean > 0.9 && black_white.mean <= 1.0, "{black_white:?}");
    assert!(flip(&[], &[], [0, 0]).is_err());
}

#[test]
fn radiance_is_clipped_for_display_and_never_a_random_colour() {
    let shown = display_of(&[Vec3::new(7.0, -1.0, f32::NAN), Vec3::splat(0.5)]);
    assert!((shown[0] - Vec3::X).abs().max_element() < 1e-6, "{}", shown[0]);
    assert!((shown[1].x - 0.735_357).abs() < 1e-5);
    let back = Picture { size: [1, 1], kind: PictureKind::Display, values: vec![shown[1]] };
    assert!((back.linear()[0].x - 0.5).abs() < 1e-6);
}
