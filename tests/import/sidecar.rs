//! The `.afterimage.toml` next to a model.

use super::{Folder, assert_clean, doubts, material, warning};
use afterimage::scene::{Light, MaterialKind, Scene, SkyKind};
use glam::{DVec3, Vec3};

fn with(toml: &str) -> Scene {
    let mtl = "newmtl wall\nKd 0.5 0.5 0.5\nnewmtl pane\nKd 0.25 0.25 0.25\n";
    Folder::with_mtl(&["wall", "pane"], mtl).add("scene.afterimage.toml", toml).load()
}

#[test]
fn unit_and_up_axis_are_set_and_flags_override_them() {
    let obj = "v 0 0 0\nv 100 0 0\nv 0 0 200\nf 1 2 3\n";
    let mut folder = Folder::with_obj(obj).add("scene.afterimage.toml", "unit = \"cm\"\nup = \"+Z\"\n");
    assert_eq!(folder.load().bounds_m[1], DVec3::new(1.0, 2.0, 0.0));
    folder.options.unit = Some(afterimage::import::Unit::Metre);
    assert_eq!(folder.load().bounds_m[1], DVec3::new(100.0, 200.0, 0.0));
}

#[test]
fn materials_are_overridden_by_name() {
    let scene = with(
        "[[material]]\nname = \"wall\"\nkind = \"mirror\"\nreflectance = [0.9, 0.8, 0.7]\n\
         [[material]]\nname = \"pane\"\nkind = \"glass\"\neta = 1.4\ntransmittance = 0.5\ndiffuse = [0.1, 0.1, 0.1]\n",
    );
    assert_clean(&scene);
    let wall = material(&scene, "wall");
    assert_eq!(wall.kind, MaterialKind::Mirror { reflectance: Vec3::new(0.9, 0.8, 0.7), fresnel: false });
    assert_eq!(wall.diffuse, Vec3::ZERO);
    let pane = material(&scene, "pane");
    assert_eq!(pane.kind, MaterialKind::Glass { eta: 1.4, transmittance: Vec3::splat(0.5) });
    assert_eq!(pane.diffuse, Vec3::splat(0.1));
    let scene = with("[[material]]\nname = \"wall\"\nemission = [5, 5, 5]\n");
    assert_clean(&scene);
    assert_eq!((scene.lights.len(), material(&scene, "wall").diffuse.x), (1, 0.5));
}

#[test]
fn a_material_that_only_the_settings_file_defines_is_not_missing() {
    let toml = "[[material]]\nname = \"new\"\ndiffuse = [0.1, 0.2, 0.3]\n";
    let obj = "usemtl new\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let scene = Folder::with_obj(obj).add("scene.afterimage.toml", toml).load();
    assert_clean(&scene);
    assert_eq!(material(&scene, "new").diffuse, Vec3::new(0.1, 0.2, 0.3));
}

#[test]
fn lights_and_sky_are_added() {
    let scene = with(
        "[[point_light]]\nposition_m = [0.5, 0.5, 1]\nintensity = [3, 3, 3]\n\
         [sun]\ndirection = [0, 2, 0]\nirradiance = [4, 4, 4]\nangular_radius_deg = 1.0\n\
         [sky]\nzenith = [0.1, 0.2, 0.3]\n",
    );
    assert_clean(&scene);
    assert_eq!(scene.lights.len(), 3);
    let point = scene.lights.iter().find_map(|l| match l {
        Light::Point { position, .. } => Some(scene.frame.world_from_scene(*position)),
        _ => None,
    });
    assert!((point.unwrap() - DVec3::new(0.5, 0.5, 1.0)).length() < 1e-5);
    let sun = scene.lights.iter().find_map(|l| match l {
        Light::Sun { direction, cos_angular_radius, irradiance } => {
            Some((*direction, *cos_angular_radius, *irradiance))
        }
        _ => None,
    });
    assert_eq!(sun, Some((Vec3::Y, 1.0f32.to_radians().cos(), Vec3::splat(4.0))));
    assert_eq!(scene.sky.unwrap().zenith(), Vec3::new(0.1, 0.2, 0.3));
}

#[test]
fn skies_of_every_kind_and_a_sun_by_place_and_time_are_read() {
    let time = "[sun]\nplace = \"52.52,13.40\"\ntime = \"2026-06-21T12:00[Europe/Berlin]\"\nnorth_deg = 90\n";
    let scene = with(&format!("{time}[sky]\nkind = \"physical\"\nturbidity = 4\n"));
    assert_clean(&scene);
    let (sun, sky) = (scene.sun.unwrap(), scene.sky.unwrap());
    let (sin, cos) = (149.355f32 + 90.0).to_radians().sin_cos();
    let expected =
        Vec3::new(sin, 0.0, -cos) * 58.15f32.to_radians().cos() + Vec3::Y * 58.15f32.to_radians().sin();
    assert!((sun.direction - expected).length() < 1e-3, "{} {expected}", sun.direction);
    assert_eq!(sky.kind(), SkyKind::Physical);
    let scene = with("[sky]\nkind = \"overcast\"\nzenith = 2\n");
    assert_clean(&scene);
    assert_eq!((scene.sun, scene.sky.unwrap().radiance(Vec3::Y)), (None, Vec3::splat(2.0)));
    let night = with(&format!("{}[sky]\nkind = \"clear\"\n", time.replace("12:00", "00:00")));
    assert_eq!(night.sun.map(|sun| sun.direction.y > 0.0), Some(true), "the default, as without light");
    for (bad, part) in [
        ("[sun]\nplace = \"52.5,13.4\"\n", "needs both place and time"),
        ("[sun]\nplace = \"Berlin\"\ntime = \"2026-06-21T12:00Z\"\n", "'Berlin' is not a place"),
        ("[sky]\nkind = \"cloudy\"\n", "'cloudy' is not a kind of sky"),
        ("[sky]\nturbidity = 11\n", "'turbidity' in [sky]"),
    ] {
        warning(&with(bad), part);
    }
}

#[test]
fn start_views_and_walk_are_set() {
    let scene = with(
        "[start]\neye = [0, 1.6, 3]\nat = [0, 1.6, 0]\nfov_y_deg = 70\n\
         [[view]]\nname = \"door\"\neye = [1, 2, 3]\nat = [0, 0, 0]\n\
         [walk]\nframes = 60\nfov_y_deg = 65\nkeyframes = [{ eye = [0, 1, 0], at = [1, 1, 0] }, { eye = [2, 1, 0], at = [3, 1, 0] }]\n",
    );
    assert_clean(&scene);
    assert_eq!(scene.start().eye, DVec3::new(0.0, 1.6, 3.0));
    assert!((scene.start().fov_y.to_degrees() - 70.0).abs() < 1e-9);
    assert_eq!([scene.views[0].name.as_str(), scene.views[1].name.as_str()], ["start", "door"]);
    assert_eq!((scene.walk.frames, scene.walk.keyframes.len()), (60, 2));
    let scene = with("[[walk.keyframes]]\neye = [7, 1, 0]\nat = [1, 1, 0]\n");
    assert_clean(&scene);
    assert_eq!(scene.start().eye, DVec3::new(7.0, 1.0, 0.0));
}

#[test]
fn unknown_keys_bring_a_suggestion() {
    let scene = with("units = \"cm\"\n[sun]\n\ndirecton = [0, 1, 0]\n[[material]]\nname = \"wal\"\n");
    assert_eq!(warning(&scene, "'units'").1, 1);
    assert!(warning(&scene, "'units'").2.contains("did you mean 'unit'?"));
    let (file, line, message) = warning(&scene, "'directon' in [sun]");
    assert_eq!((file, line), ("scene.afterimage.toml", 4));
    assert!(message.contains("did you mean 'direction'?"));
    assert!(warning(&scene, "no material 'wal'").2.contains("'wall'"));
}

#[test]
fn bad_values_are_ignored_one_by_one() {
    let toml = "unit = 3\nup = \"sideways\"\n[start]\neye = [1, 2]\nat = [0, 0, 0]\n[sun]\ndirection = [0, 0, 0]\n\
                [[material]]\nname = \"wall\"\nkind = \"wood\"\ndiffuse = [2, 0, 0]\neta = nan\n[[view]]\nname = \"x\"\n\
                [walk]\n[[point_light]]\n";
    let scene = with(toml);
    let parts = [
        "'unit' must be a text",
        "'sideways' is not an up axis",
        "'eye' in [start] must be three numbers",
        "'wood' is not a kind",
        "'diffuse' in [[material]] must be a colour",
        "'eta' in [[material]]",
        "[[view]] needs eye",
        "[walk] needs keyframes",
        "[[point_light]] needs",
        "no length",
    ];
    parts.iter().for_each(|part| {
        warning(&scene, part);
    });
    assert_eq!(material(&scene, "wall").diffuse, Vec3::splat(0.5));
}

#[test]
fn a_broken_settings_file_does_not_stop_the_import() {
    let scene = with("unit = \"cm\"\n[[material\n");
    let (file, line, message) = warning(&scene, "without this file");
    assert_eq!((file, line), ("scene.afterimage.toml", 2));
    assert!(!message.contains('\n'));
    assert_eq!(scene.triangles.len(), 2);
    let folder = Folder::with_obj(super::TRIANGLE).add("scene.afterimage.toml/x", "");
    assert!(warning(&folder.load(), "is not used").2.contains("not a regular file"));
    assert!(doubts(&with("")).is_empty());
}
