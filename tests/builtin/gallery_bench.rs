//! Properties of the gallery on which speed is measured.

use super::{scene, triangles_where};
use afterimage::scene::{Light, Material, SolidSide};

/// Every figure of speed is measured on this scene: it must stay as it is. The sines of its shapes
/// come from the C library, so other platforms may have other bits.
#[test]
#[cfg(all(target_os = "linux", target_env = "gnu", target_arch = "x86_64"))]
fn bench_gallery_never_changes() {
    let hash = "8d97b812bf7954defa6d3313a3a294fca7fbb7593012775a38b8d530696ae152";
    assert_eq!(scene("gallery-bench").hash, hash);
}

#[test]
fn bench_gallery_has_its_documented_size() {
    let scene = scene("gallery-bench");
    let count = scene.triangles.len();
    assert!((225_000..=300_000).contains(&count), "{count} triangles");
    let size = scene.bounds_m[1] - scene.bounds_m[0];
    assert!((size.x - 34.0).abs() < 0.01 && (size.z - 24.0).abs() < 0.01, "{size}");
}

#[test]
fn bench_gallery_has_twelve_quad_lights() {
    let scene = scene("gallery-bench");
    assert_eq!(scene.lights.len(), 12);
    for light in &scene.lights {
        let Light::Quad { edge_u, edge_v, .. } = light else { panic!("not a quad: {light:?}") };
        // Both edges are horizontal, so the lamp faces straight down.
        assert_eq!((edge_u.y, edge_v.y), (0.0, 0.0));
        for edge in [edge_u, edge_v] {
            let metres = f64::from(edge.length()) / scene.frame.units_per_metre;
            assert!((0.8..=1.6001).contains(&metres), "{metres} m");
        }
    }
}

#[test]
fn bench_gallery_uses_mirrors_glass_textures_and_area_lights() {
    let features = scene("gallery-bench").features;
    assert!(features.mirror && features.glass && features.textures && features.area_lights);
    assert!(!features.alpha && !features.sky);
}

#[test]
fn bench_gallery_glass_is_solid() {
    let scene = scene("gallery-bench");
    let glass = triangles_where(scene, Material::is_glass);
    // Five panes, each of them a box.
    assert_eq!(glass.len(), 5 * 12);
    assert!(glass.iter().all(|&t| scene.solids[t as usize] == SolidSide::InsideBehind));
}

#[test]
fn bench_gallery_mirrors_do_not_face_each_other() {
    let scene = scene("gallery-bench");
    let mirrors = triangles_where(scene, Material::is_mirror);
    assert!(!mirrors.is_empty());
    let plane = scene.corners(mirrors[0])[0].x;
    for t in mirrors {
        assert!(scene.corners(t).iter().all(|p| p.x == plane), "all mirrors lie in one plane");
    }
}

#[test]
fn bench_gallery_views_are_named() {
    let scene = scene("gallery-bench");
    for name in ["start", "hall", "mirrors", "vitrine", "railing"] {
        assert!(scene.views.iter().any(|v| v.name == name), "{name}");
    }
}

#[test]
fn bench_gallery_camera_path_is_long_and_smooth() {
    let walk = &scene("gallery-bench").walk;
    assert_eq!(walk.frames, 300);
    assert!((60.0..=80.0).contains(&walk.length_m()), "{} m", walk.length_m());
    let eyes: Vec<_> = (0..walk.frames).map(|i| walk.camera(i, walk.frames).unwrap().eye).collect();
    let longest = eyes.windows(2).map(|e| e[0].distance(e[1])).fold(0.0, f64::max);
    assert!(longest < 0.3, "{longest} m in one frame");
}
