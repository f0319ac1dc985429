//! Profiles of our own of every kind, right and wrong.

use super::*;
use crate::scene::AimedProfile;
use glam::Vec3;
use std::f32::consts::PI;
use std::sync::Arc;

/// A file of type C with these angles and intensities.
fn file(horizontal: &str, vertical: &str, intensities: &str) -> String {
    let count = |list: &str| list.split_whitespace().count();
    format!(
        "IESNA:LM-63-2002\n[TEST] own\n[MANUFAC] none\nTILT=NONE\n1 1000 2.0 {} {} 1 2 0.1 0.1 0\n1 1 60\n{vertical}\n{horizontal}\n{intensities}\n",
        count(vertical),
        count(horizontal)
    )
}

fn shares(text: &str) -> (f64, impl Fn(f32, f32) -> f32 + use<>) {
    let ies = parse(text).unwrap();
    let aimed = AimedProfile::new(Arc::new(ies.profile), Vec3::NEG_Y, Vec3::X);
    // Counter-clockwise from above, from +X: a quarter turn is -Z.
    (ies.candela, move |turn: f32, height: f32| {
        let ((sin, cos), (s, c)) = (turn.to_radians().sin_cos(), height.to_radians().sin_cos());
        aimed.share(Vec3::new(s * cos, -c, -s * sin))
    })
}

#[test]
fn an_even_profile_has_the_intensity_of_its_lumens() {
    // 4 pi lumens are one candela everywhere; the factor is two.
    let ies = parse(&file("0", "0 90 180", "0.5 0.5 0.5")).unwrap();
    assert_eq!(ies.candela, 1.0);
    assert!((ies.profile.flux() / (4.0 * PI) - 1.0).abs() < 1e-5);
}

#[test]
fn a_lambertian_profile_has_the_flux_of_its_lumens() {
    let heights: Vec<f64> = (0..=18).map(|i| f64::from(i) * 5.0).collect();
    let list = |f: &dyn Fn(f64) -> f64| {
        heights.iter().map(|h| format!("{:.6}", f(*h))).collect::<Vec<_>>().join(" ")
    };
    let ies = parse(&file(
        "0",
        &list(&|h| h),
        &list(&|h| 500.0 * std::f64::consts::FRAC_1_PI * h.to_radians().cos()),
    ));
    let ies = ies.unwrap();
    let lumens = ies.candela * f64::from(ies.profile.flux());
    assert!((lumens / 1000.0 - 1.0).abs() < 0.01, "{lumens}");
}

#[test]
fn ranges_of_planes_stand_for_symmetries() {
    let quarter = shares(&file("0 45 90", "0 90", "0 1 0 2 0 4")).1;
    for turn in [30.0f32, 80.0] {
        for image in [turn, 180.0 - turn, 180.0 + turn, 360.0 - turn] {
            assert!((quarter(image, 90.0) - quarter(turn, 90.0)).abs() < 1e-5, "{image}");
        }
    }
    let half = shares(&file("0 90 180", "0 90", "0 1 0 2 0 4")).1;
    assert!((half(180.0, 90.0) - 1.0).abs() < 1e-5 && (half(0.0, 90.0) - 0.25).abs() < 1e-5);
    assert!((half(90.0, 90.0) - half(270.0, 90.0)).abs() < 1e-5);
    let other = shares(&file("90 180 270", "0 90", "0 1 0 2 0 4")).1;
    assert!((other(0.0, 90.0) - 0.5).abs() < 1e-5 && (other(180.0, 90.0) - 0.5).abs() < 1e-5);
    assert!((other(90.0, 90.0) - 0.25).abs() < 1e-5 && (other(270.0, 90.0) - 1.0).abs() < 1e-5);
    // Full turns, with and without the last plane.
    for (planes, values) in [("0 120 240 360", "0 1 0 2 0 4 0 1"), ("0 120 240", "0 1 0 2 0 4")] {
        let full = shares(&file(planes, "0 90", values)).1;
        let expected = [(0.0, 1.0), (120.0, 2.0), (240.0, 4.0), (300.0, 2.5), (60.0, 1.5)];
        for (turn, value) in expected {
            assert!((full(turn, 90.0) - value / 4.0).abs() < 1e-4, "{planes}: {turn}");
        }
    }
}

#[test]
fn old_files_and_tilts_and_broken_lines_are_read() {
    let old = "a lamp of 1986\r\nmade by hand\r\nTILT = INCLUDE\r\n1\r\n3\r\n0 45 90\r\n0.5 .9 .8\r\n1,1000,1,\r\n2 1 1 1 0 0 0\r\n1.0 0.8\r\n50 0 90 0 10\r\n5";
    let (candela, share) = shares(old);
    assert!((candela - 4.0).abs() < 1e-9 && (share(0.0, 90.0) - 0.5).abs() < 1e-5);
    let named = file("0", "0 90", "1 1").replace("TILT=NONE", "TILT=lamp.tlt");
    assert!(parse(&named).unwrap().note.unwrap().contains("'lamp.tlt'"));
    // Mirrored halves of floodlights.
    for kind in ["2", "3"] {
        let flood = file("0 30", "0 30", "4 2 2 0").replacen(" 1 2 0.1", &format!(" {kind} 2 0.1"), 1);
        let share = shares(&flood).1;
        let expected = [(0.0, 0.0, 1.0), (0.0, 15.0, 0.75), (90.0, 15.0, 0.75), (180.0, 15.0, 0.75)];
        for (turn, height, value) in expected {
            assert!((share(turn, height) - value).abs() < 1e-4, "type {kind}: {turn}, {height}");
        }
    }
}

#[test]
fn garbage_is_refused_with_line_cause_and_remedy() {
    let good = file("0 90", "0 90", "1 2 3 4");
    let line = |text: &str| parse(text).unwrap_err().to_string();
    for (text, place, cause) in [
        (String::new(), "line 1", "no line TILT="),
        ("\u{0}\u{1}".repeat(1000), "line 1", "no line TILT="),
        ("TILT=NONE\n1 2 x".to_owned(), "line 2", "must be a number"),
        (good.replace("1 2 3 4", "1 2 3"), "line", "ends before"),
        (good.replace("1 2 3 4", "1 2 3 nan"), "line 9", "must be a number"),
        (good.replace("1 2 3 4", "1 2 3 -4"), "line 9", "negative"),
        (good.replace("1 2 3 4", "0 0 0 0"), "line", "zero"),
        (good.replace("2.0 2 2", "2.0 99999999 2"), "line 5", "whole number"),
        (good.replace("2.0 2 2", "2.0 -2 2"), "line 5", "whole number"),
        (good.replace("2.0 2 2", "2.0 16000 16000"), "line 8", "not above"),
        (good.replace("0 90\n0 90", "0 90\n0 77"), "line", "horizontal angles go from 0 to 77"),
        (good.replace("0 90\n0 90", "90 0\n0 90"), "line 7", "not above"),
        (good.replace("0 90\n0 90", "0 190\n0 90"), "line", "from 0 to 180"),
        (good.replace("2 2 1 2", "2 2 7 2"), "line 5", "type of photometry"),
        (good.replace(" 2.0 ", " 1e308 ").replace("1 2 3 4", "1e308 1 1 1"), "line", "no lamp has"),
    ] {
        let message = line(&text);
        assert!(message.starts_with(place) && message.contains(cause), "{message}");
        assert!(message.ends_with(EXPORT));
    }
}
