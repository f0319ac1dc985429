//! Packed colours and fast rounding, against their specifications.

use afterimage::math::rounding::{floor, round};
use afterimage::raster::rgb9e5::{Rgb9e5Scale, pack, unpack};
use afterimage::reference::light::{UNLIT, pack_light};
use glam::Vec3;

#[test]
fn a_color_survives_packing_to_a_512th_of_its_largest_channel() {
    for brightest in [1e-20f32, 1e-3, 1.0, 37.5, 65_000.0, 3e30] {
        let scale = Rgb9e5Scale::for_largest(brightest);
        for i in 0..2000u32 {
            let share = |k: u32| (i.wrapping_mul(2_654_435_761).wrapping_add(k * 977) % 1009) as f32 / 1008.0;
            let fall = 2f32.powi(-((i % 20) as i32));
            let color = Vec3::new(share(1), share(2), share(3)) * brightest * fall;
            let error = (scale.unpack(scale.pack(color)) - color).abs().max_element();
            assert!(error <= color.max_element() / 512.0, "{color} of {brightest}: {error}");
        }
    }
}

#[test]
fn the_smallest_exponent_that_fits_is_chosen() {
    for brightest in [1e-38f32, 1e-20, 1.0, 65_000.0, 3e38] {
        let scale = Rgb9e5Scale::for_largest(brightest);
        for i in 0..40_000u32 {
            let largest = f32::from_bits(i.wrapping_mul(107_374) % f32::INFINITY.to_bits());
            let exponent = scale.pack(Vec3::new(largest, 0.0, 0.0)) >> 27;
            let fits = |e: u32| (largest / scale.unpack(e << 27 | 1).x).round() <= 511.0;
            assert!((0..exponent).all(|e| !fits(e)), "{largest:e} of {brightest:e}: {exponent}");
            assert!(exponent == 31 || fits(exponent), "{largest:e} of {brightest:e}: {exponent}");
        }
    }
}

/// Packing as the format's specification has it, channel by channel.
fn pack_by_the_specification(color: Vec3) -> u32 {
    let c = color.to_array().map(|v| if v.is_nan() { 0.0 } else { v.clamp(0.0, 65408.0) });
    let largest = c[0].max(c[1]).max(c[2]);
    let floor_log2 = ((largest.to_bits() >> 23) as i32 - 127).max(-16);
    let mut exponent = floor_log2 + 16;
    let scale = |exponent: i32| f32::from_bits(((127 + 24 - exponent) as u32) << 23);
    if (largest * scale(exponent) + 0.5) as u32 == 512 {
        exponent += 1;
    }
    let [r, g, b] = c.map(|v| (v * scale(exponent) + 0.5) as u32);
    r | g << 9 | b << 18 | (exponent as u32) << 27
}

#[test]
fn the_standard_format_has_the_bits_of_its_specification() {
    let random = |i: u32, k: u32| i.wrapping_mul(2_654_435_761).wrapping_add(k.wrapping_mul(977_777_777));
    let channel = |i: u32, k: u32| f32::from_bits(random(i, k).rotate_left(k));
    let near_one = |i: u32, k: u32| (random(i, k) % 2048) as f32 / 1024.0;
    let below_half = 0.5 - f32::EPSILON / 4.0;
    let mut colors = vec![
        Vec3::ZERO,
        Vec3::new(-1.0, f32::NAN, 0.0),
        Vec3::new(2.0, f32::NAN, -1.0),
        Vec3::splat(f32::INFINITY),
        Vec3::splat(65408.0),
        Vec3::new(300.0, below_half, below_half) / 256.0,
    ];
    colors.extend((0..200_000).map(|i| Vec3::new(channel(i, 1), channel(i, 2), channel(i, 3))));
    colors.extend((0..20_000).map(|i| Vec3::new(near_one(i, 1), near_one(i, 2), near_one(i, 3))));
    for color in colors {
        assert_eq!(pack(color), pack_by_the_specification(color), "{color:?}");
    }
    assert_eq!(unpack(pack(Vec3::splat(f32::INFINITY))), Vec3::splat(65408.0));
}

#[test]
fn the_two_ways_to_round_differ_just_below_a_half() {
    let color = Vec3::new(300.0, 0.5 - f32::EPSILON / 4.0, 0.0) / 16_777_216.0 * 65_536.0;
    let words = [pack(color), Rgb9e5Scale::STANDARD.pack(color)];
    assert_eq!(words.map(|word| word >> 9 & 511), [1, 0]);
}

#[test]
fn no_light_packs_to_the_word_for_unlit() {
    let scale = Rgb9e5Scale::for_largest(1.0);
    for light in [Vec3::ONE, Vec3::splat(1e30), Vec3::splat(f32::INFINITY), Vec3::NAN, Vec3::NEG_ONE] {
        assert_ne!(pack_light(scale, light), UNLIT);
    }
    assert_eq!(scale.unpack(pack_light(scale, Vec3::ZERO)), Vec3::ZERO);
}

#[test]
fn fast_rounding_agrees_with_the_standard_library() {
    for i in -4000i32..4000 {
        let t = i as f32 * 0.125 + 1e-3 * (i % 7) as f32;
        assert_eq!(floor(t), t.floor() as i32, "{t}");
        assert_eq!(round(t), t.round() as i32, "{t}");
    }
    for t in [1e30f32, -1e30, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, -0.0, 2_147_483_000.0] {
        assert_eq!(floor(t), t.floor() as i32, "{t}");
        assert_eq!(round(t), t.round() as i32, "{t}");
    }
}
