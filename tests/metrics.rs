//! Measures of difference, against values calculated by hand.

use afterimage::raster::load::{Picture, PictureKind, display_of};
use afterimage::raster::metrics::{PSNR_OF_EQUALS_DB, flip, max_abs, psnr_db, rel_mse, ssim};
use glam::Vec3;

const SIZE: [u32; 2] = [32, 24];

/// A smooth picture with some texture and all values in 0.2..0.8.
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

/// Compares with the means and 95th percentiles of `flip-evaluator` 1.7, the authors' program, at
/// its default of 67.02 pixels per degree.
#[test]
fn flip_is_that_of_its_authors() {
    let flat = |c: [f32; 3]| vec![Vec3::from(c); 768];
    let (grey, column) = (flat([0.5; 3]), |i: usize| i % SIZE[0] as usize);
    let mut dot = grey.clone();
    dot[12 * SIZE[0] as usize + 16] = Vec3::ONE;
    let edge: Vec<Vec3> = (0..768).map(|i| Vec3::splat(if column(i) < 16 { 0.5 } else { 0.8 })).collect();
    let pattern = pattern();
    let shifted: Vec<Vec3> =
        (0..768).map(|i| pattern[if column(i) == 0 { i + SIZE[0] as usize - 1 } else { i - 1 }]).collect();
    let cases = [
        ("offset 0.1", moved(0.1), pattern.clone(), [0.409_141, 0.450_442]),
        ("offset 0.02", moved(0.02), pattern.clone(), [0.129_449, 0.143_834]),
        ("shifted by a pixel", shifted, pattern, [0.237_650, 0.340_982]),
        ("white for black", flat([1.0; 3]), flat([0.0; 3]), [0.967_388, 0.967_388]),
        ("green for red", flat([0.0, 1.0, 0.0]), flat([1.0, 0.0, 0.0]), [0.986_665, 0.986_665]),
        ("a dot", dot, grey.clone(), [0.005_628, 0.009_577]),
        ("an edge", edge, grey, [0.359_647, 0.747_604]),
    ];
    for (name, shown, truth, [mean, p95]) in cases {
        let found = flip(&shown, &truth, SIZE).unwrap();
        let is_near = (found.mean - mean).abs() < 1e-4 && (found.p95 - p95).abs() < 1e-3;
        assert!(is_near, "{name}: {found:?}, the authors have {mean} and {p95}");
    }
}

#[test]
fn radiance_is_clipped_for_display_and_never_a_random_colour() {
    let shown = display_of(&[Vec3::new(7.0, -1.0, f32::NAN), Vec3::splat(0.5)]);
    assert!((shown[0] - Vec3::X).abs().max_element() < 1e-6, "{}", shown[0]);
    assert!((shown[1].x - 0.735_357).abs() < 1e-5);
    let back = Picture { size: [1, 1], kind: PictureKind::Display, values: vec![shown[1]] };
    assert!((back.linear()[0].x - 0.5).abs() < 1e-6);
}
