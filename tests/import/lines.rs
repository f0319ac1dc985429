//! Lines, faces and vertices: every way to write them, right and wrong.

use super::{Folder, TRIANGLE, area_m2, assert_clean, doubts, load_obj, warning};
use afterimage::import::{Unit, Up};
use afterimage::scene::SceneError;
use glam::DVec3;

fn assert_triangle(text: impl AsRef<[u8]>) {
    let scene = load_obj(text);
    assert_eq!(scene.triangles.len(), 1);
    assert!((area_m2(&scene) - 0.5).abs() < 1e-6);
    assert_clean(&scene);
}

#[test]
fn import_reads_the_simplest_file_without_a_warning() {
    assert_triangle(TRIANGLE);
}

#[test]
fn import_reads_every_line_ending() {
    assert_triangle(TRIANGLE.replace('\n', "\r\n"));
    assert_triangle(TRIANGLE.replace('\n', "\r"));
    assert_triangle(TRIANGLE.trim_end());
    assert_triangle(TRIANGLE.replace('\n', "\n\r"));
}

#[test]
fn import_reads_a_byte_order_mark_and_utf_16() {
    assert_triangle(format!("\u{feff}{TRIANGLE}"));
    let utf_16 = |bytes: fn(u16) -> [u8; 2]| -> Vec<u8> {
        format!("\u{feff}{TRIANGLE}").encode_utf16().flat_map(bytes).collect()
    };
    assert_triangle(utf_16(u16::to_le_bytes));
    assert_triangle(utf_16(u16::to_be_bytes));
}

#[test]
fn a_byte_order_mark_does_not_hide_the_first_line_of_obj_or_mtl() {
    let scene = Folder::with_obj(format!("\u{feff}mtllib scene.mtl\nusemtl a\n{TRIANGLE}"))
        .add("scene.mtl", "\u{feff}newmtl a\nKd 0.1 0.2 0.3\n")
        .load();
    assert_clean(&scene);
    assert_eq!(scene.materials[0].diffuse.to_array(), [0.1, 0.2, 0.3]);
}

fn assert_name(bytes: &[u8], name: &str, encoding: &str) {
    let with = |before: &[u8]| [before, bytes, b"\n"].concat();
    let mut obj = with(b"mtllib scene.mtl\nusemtl ");
    obj.extend_from_slice(TRIANGLE.as_bytes());
    let mut mtl = with(b"newmtl ");
    mtl.extend_from_slice(b"Kd 0.25 0.25 0.25\n");
    let scene = Folder::with_obj(obj).add("scene.mtl", mtl).load();
    assert_eq!(scene.materials[0].name, name);
    assert_eq!(scene.materials[0].diffuse.x, 0.25);
    assert!(warning(&scene, "not UTF-8").2.contains(encoding));
}

#[test]
fn import_guesses_legacy_encodings_and_says_so() {
    assert_name(b"T\xFCr", "T\u{fc}r", "Windows-1252");
    assert_name(b"\xC7\xBD\xB1\xDA", "\u{5899}\u{58c1}", "GB18030");
}

#[test]
fn import_repairs_tabs_comments_and_continuations() {
    assert_triangle("v\t0 0 0 # first\nv 1 0 0#second\n  v 0 1 0\nf 1 2 \\\n 3 # done\n");
    assert_triangle("v 0 0 \\\r\n0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\\\r\n\r\n");
    assert_triangle(format!("# a folder: C:\\models\\\n{TRIANGLE}"));
    let scene = Folder::with_obj(format!("mtllib\tscene.mtl\nusemtl\ta # red\n{TRIANGLE}"))
        .add("scene.mtl", "newmtl\ta\nKd\t0.5 0.5 0.5 # grey\n")
        .load();
    assert_clean(&scene);
    assert_eq!(scene.materials[0].diffuse.x, 0.5);
}

#[test]
fn line_numbers_count_physical_lines_after_continuations_and_cr() {
    for end in ["\n", "\r\n", "\r"] {
        let text = "v 0 0 \\\n0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n\nf 1 2 9\n".replace('\n', end);
        let (file, line, message) = {
            let scene = load_obj(&text);
            let (f, l, m) = warning(&scene, "does not exist");
            (f.to_owned(), l, m.to_owned())
        };
        assert_eq!((file.as_str(), line), ("scene.obj", 7));
        assert!(message.contains("in line 7 (vertex 9 of 3); skipped"), "{message}");
    }
}

#[test]
fn import_accepts_negative_indices_weights_and_colours() {
    assert_triangle("v 0 0 0 1.0\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0\nf -3 -2 -1\n");
    assert_triangle("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0\nvn 0 0 1\nf 1/1/1 2//1 3/-1\n");
    assert_triangle("v 0 0 0\nv 1 0 0\nf 1 2 3\nv 0 1 0\n");
}

#[test]
fn import_reads_names_with_spaces_and_quotes() {
    let scene = Folder::with_obj(format!("mtllib \"my lib.mtl\"\nusemtl \"red wall\"\n{TRIANGLE}"))
        .add("my lib.mtl", "newmtl red wall\nKd 0.5 0.5 0.5\n")
        .load();
    assert_clean(&scene);
    assert_eq!(scene.materials[0].name, "red wall");
    let scene = Folder::with_obj(format!("mtllib my lib.mtl\nusemtl wood #2\n{TRIANGLE}"))
        .add("my lib.mtl", "newmtl wood #2\nKd 0.5 0.5 0.5\n")
        .load();
    assert_clean(&scene);
    assert_eq!(scene.materials[0].diffuse.x, 0.5);
}

#[test]
fn import_reads_several_libraries_of_one_line() {
    for line in
        ["mtllib a.mtl b.mtl", "mtllib \"a.mtl\" b.mtl", "mtllib A.MTL B.mtl", "mtllib x\\a.mtl b.mtl"]
    {
        let triangles = "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3\n";
        let scene = Folder::with_obj(format!("{line}\n{TRIANGLE}{triangles}"))
            .add("a.mtl", "newmtl a\nKd 0.1 0.1 0.1\n")
            .add("b.mtl", "newmtl b\nKd 0.2 0.2 0.2\n")
            .load();
        assert_clean(&scene);
        assert_eq!(super::material(&scene, "a").diffuse.x, 0.1);
        assert_eq!(super::material(&scene, "b").diffuse.x, 0.2);
    }
}

#[test]
fn lines_and_points_are_left_out() {
    let scene = load_obj(format!("{TRIANGLE}l 1 2 3\np 1\nl 1 2\n"));
    assert_eq!(scene.triangles.len(), 1);
    let (_, line, message) = warning(&scene, "lines or points");
    assert_eq!(line, 5);
    assert!(message.starts_with("3 "), "{message}");
}

#[test]
fn only_a_bad_face_is_lost() {
    let bad = "f 1 2 9\nf\nf 1 2\nf 1 x 3\nf 0 1 2\nf 1 2 -9\nf 1 1 2\nf 1.5 2 3\n";
    let scene = load_obj(format!("{TRIANGLE}{bad}f 3 2 1\n"));
    assert_eq!(scene.triangles.len(), 2);
    let missing = warning(&scene, "does not exist");
    assert_eq!(missing.1, 5);
    assert_eq!(
        missing.2,
        "3 faces with a vertex that does not exist, first in line 5 (vertex 9 of 3); skipped"
    );
    assert_eq!(warning(&scene, "fewer than three").1, 6);
    assert!(warning(&scene, "fewer than three").2.starts_with("3 faces"));
    assert_eq!(warning(&scene, "cannot be read").1, 8);
    assert!(warning(&scene, "cannot be read").2.starts_with("2 faces"));
}

#[test]
fn a_face_is_kept_without_a_missing_normal_or_texture_coordinate() {
    let scene = load_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//5 3//1\nf 1/7 2 3\n");
    assert_eq!(scene.triangles.len(), 2);
    assert_eq!(warning(&scene, "a normal that does not exist").1, 5);
    assert_eq!(warning(&scene, "a texture coordinate that does not exist").1, 6);
}

#[test]
fn faces_of_a_vertex_that_is_not_finite_are_skipped() {
    for bad in ["nan 0 0", "0 inf 0", "0 0 1e999", "0 0", "1,5,2 0 0", "-nan(ind) 0 0", "1.#QNAN 0 0"] {
        let scene = load_obj(format!("{TRIANGLE}v {bad}\nv 0 0 1\nf 1 2 4\nf 1 2 5\n"));
        assert_eq!(scene.triangles.len(), 2, "{bad}");
        assert_eq!(warning(&scene, "finite number").1, 5);
        let refused = warning(&scene, "refused vertex");
        assert_eq!(refused.1, 7);
        assert!(refused.2.contains("(vertex 4)"), "{refused:?}");
    }
}

#[test]
fn faces_that_mix_corner_styles_keep_their_texture_coordinates() {
    let picture = super::textures::png(1, 1, &[[255, 0, 0, 255]]);
    let obj = "mtllib scene.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0.25 0.75\nvt 0.5 0.5\n\
               f 1 2 3\nf 1/1 2/2 4/1\nf 1//1 2/2 3\n";
    let scene = Folder::with_obj(format!("vn 0 0 1\n{obj}"))
        .add("scene.mtl", "newmtl a\nmap_Kd a.png\n")
        .add("a.png", picture)
        .load();
    assert_eq!(scene.triangles.len(), 3);
    let uv = |t: usize, corner: usize| scene.uvs[scene.triangles[t][corner] as usize].to_array();
    assert_eq!([uv(0, 0), uv(1, 0), uv(1, 1), uv(1, 2)], [[0.0; 2], [0.25, 0.75], [0.5, 0.5], [0.25, 0.75]]);
    assert_eq!(uv(2, 1), [0.5, 0.5]);
    let normal = |t: usize, corner: usize| scene.normals[scene.triangles[t][corner] as usize].to_array();
    assert_eq!([normal(2, 0), normal(2, 2)], [[0.0, 0.0, 1.0], [0.0; 3]]);
}

#[test]
fn equal_corners_share_a_vertex() {
    let scene =
        load_obj("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 1//1 3//1 4//1\n");
    assert_eq!(scene.positions.len(), 4);
    let scene = load_obj("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 1 3 4\n");
    assert_eq!(scene.positions.len(), 6);
}

#[test]
fn polygons_are_filled_with_their_own_area() {
    let convex = load_obj("v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\nf 1 2 3 4\n");
    assert_eq!((convex.triangles.len(), area_m2(&convex)), (2, 2.0));
    // An arrow head, with each of its corners as the first.
    for face in ["1 2 3 4", "2 3 4 1", "3 4 1 2", "4 1 2 3"] {
        let arrow = load_obj(format!("v 0 0 0\nv 2 0 1\nv 0 0 2\nv 1 0 1\nf {face}\n"));
        assert!((area_m2(&arrow) - 1.0).abs() < 1e-6, "{face}: {}", area_m2(&arrow));
    }
    let letter_l = load_obj("v 0 0 0\nv 3 0 0\nv 3 1 0\nv 1 1 0\nv 1 3 0\nv 0 3 0\nf 1 2 3 4 5 6\n");
    assert!((area_m2(&letter_l) - 5.0).abs() < 1e-5);
    assert_clean(&letter_l);
}

#[test]
fn a_polygon_keeps_its_winding_in_any_plane() {
    for up in [DVec3::X, DVec3::NEG_Y, DVec3::Z, DVec3::new(0.3, -0.5, 0.2)] {
        let (x, y) = up.normalize_or(DVec3::Z).any_orthonormal_pair();
        let corners = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
        let mut obj = String::new();
        for [u, v] in corners {
            let p = x * u + y * v + DVec3::new(1e4, -2e4, 3e4);
            obj += &format!("v {} {} {}\n", p.x, p.y, p.z);
        }
        let scene = load_obj(obj + "f 1 2 3 4 5 6\n");
        assert!((area_m2(&scene) - 5.0).abs() < 1e-3);
        for t in 0..scene.triangles.len() as u32 {
            let [a, b, c] = scene.corners(t).map(|p| p.as_dvec3());
            assert!((b - a).cross(c - a).dot(x.cross(y)) > 0.0);
        }
    }
}

#[test]
fn polygons_without_area_and_self_intersecting_ones_are_reported() {
    let flat = "v 5 0 0\nv 6 0 0\nv 7 0 0\nv 8 0 0\nv 9 0 0\n";
    let scene = load_obj(format!("{TRIANGLE}{flat}f 4 5 6 7 8\n"));
    assert_eq!((scene.triangles.len(), warning(&scene, "without area").1), (1, 10));
    let bow = "v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 0.5 0\nf 4 5 6 7\n";
    assert_eq!(warning(&load_obj(format!("{TRIANGLE}{bow}")), "edges that cross").1, 9);
}

#[test]
fn a_model_far_away_keeps_its_digits() {
    let text = "v 3456789.125 0 5432109.5\nv 3456790.125 0 5432109.5\nv 3456789.125 1 5432109.5\nf 1 2 3\n";
    let scene = load_obj(text);
    assert!((area_m2(&scene) - 0.5).abs() < 1e-9);
    assert_eq!(scene.frame.world_from_scene(scene.positions[0]), DVec3::new(3456789.125, 0.0, 5432109.5));
    assert_eq!(scene.bounds_m[0], DVec3::new(3456789.125, 0.0, 5432109.5));
}

#[test]
fn units_and_up_axis_can_be_set() {
    let mut folder = Folder::with_obj("v 0 0 0\nv 1000 0 0\nv 0 0 2000\nf 1 2 3\n");
    folder.options.unit = Some(Unit::Millimetre);
    folder.options.up = Some(Up::PlusZ);
    let scene = folder.load();
    assert_eq!(scene.bounds_m, [DVec3::ZERO, DVec3::new(1.0, 2.0, 0.0)]);
    assert_clean(&scene);
    assert_eq!("+z".parse(), Ok(Up::PlusZ));
    assert_eq!("MM".parse(), Ok(Unit::Millimetre));
    assert!("yard".parse::<Unit>().unwrap_err().to_string().contains("mm, cm, m, in, ft"));
}

#[test]
fn z_up_turns_normals_too() {
    let mut folder = Folder::with_obj("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n");
    folder.options.up = Some(Up::PlusZ);
    assert_eq!(folder.load().normals[0].to_array(), [0.0, 1.0, 0.0]);
}

#[test]
fn doubtful_units_are_reported_and_used_only_when_clear() {
    let scene = |size: f64| load_obj(format!("v 0 0 0\nv {size} 0 0\nv 0 0 {size}\nf 1 2 3\n"));
    assert_clean(&scene(50.0));
    // A wall of this height is no wall in metres; a field may be.
    let wall = load_obj("v 0 0 0\nv 4000 0 0\nv 0 4000 0\nf 1 2 3\n");
    assert!(warning(&wall, "--unit").2.contains("taken as mm (5.7 m)"), "{:?}", doubts(&wall));
    assert_eq!(wall.bounds_m[1].x, 4.0);
    let doubtful = scene(4000.0);
    assert!(warning(&doubtful, "--unit").2.contains("in mm it would be 5.7 m"), "{:?}", doubts(&doubtful));
    assert_eq!(doubtful.bounds_m[1].x, 4000.0);
    let clear = scene(80_000.0);
    assert!(warning(&clear, "--unit").2.contains("taken as millimetres"));
    assert_eq!(clear.bounds_m[1].x, 80.0);
    let declared = load_obj("# Units: centimeters\nv 0 0 0\nv 900 0 0\nv 0 900 0\nf 1 2 3\n");
    assert_eq!(declared.bounds_m[1].x, 9.0);
    assert!(warning(&declared, "header").2.contains("cm"));
    for no_unit in ["ms", "cms", "mms", "ins"] {
        assert_clean(&load_obj(format!("# Units: {no_unit}\nv 0 0 0\nv 50 0 0\nv 0 50 0\nf 1 2 3\n")));
    }
}

#[test]
fn a_model_on_its_side_is_reported() {
    // A storey in Z-up coordinates: 10 x 8 floor and ceiling, 3 high.
    let mut obj = String::new();
    for z in [0, 3] {
        obj += &format!("v 0 0 {z}\nv 10 0 {z}\nv 10 8 {z}\nv 0 8 {z}\n");
    }
    let scene = load_obj(obj + "f 1 2 3 4\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\n");
    assert!(warning(&scene, "--up +Z").2.contains("scene.afterimage.toml"));
}

#[test]
fn unknown_and_free_form_lines_are_counted() {
    let scene = load_obj(format!("{TRIANGLE}cstype bezier\nsurf 0 1 0 1 1 2 3\nhello world\n"));
    assert!(warning(&scene, "free-form").2.starts_with("2 "));
    assert_eq!(warning(&scene, "unknown keyword").1, 7);
}

#[test]
fn an_error_names_file_line_cause_and_remedy() {
    let error = |text: &[u8]| Folder::with_obj(text).try_load().unwrap_err();
    let bad_index = error(b"v 0 0 0\n\nf 1 2 3\n");
    assert!(matches!(bad_index, SceneError::Line { line: 3, .. }), "{bad_index}");
    let message = bad_index.to_string();
    let parts = ["scene.obj", "line 3", "vertex 2 of 1", "export it again"];
    parts.iter().for_each(|part| assert!(message.contains(part), "{message}"));
    assert!(error(b"").to_string().contains("holds no faces"));
    assert!(error(b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").to_string().contains("1 triangles has an area"));
    let far = error(b"v 0 0 0\nv 1 0 0\nv 1e200 1 0\nf 1 2 3\n").to_string();
    assert!(far.contains("too far") && !far.contains("area"), "{far}");
    let both = error(b"v 0 0 0\nv 1 0 0\nv 1e200 1 0\nv 2 0 0\nf 1 2 3\nf 1 2 4\n").to_string();
    assert!(both.contains("of its 2 triangles, 1 have no area, and 1 have"), "{both}");
    assert!(error(b"\x7fELF\0\0\0\x01\n\0\0").to_string().contains("binary"));
}

#[test]
fn a_file_larger_than_a_piece_keeps_indices_materials_and_lines() {
    // Each triangle has its own vertices, alternately by negative and positive indices; one in a
    // thousand is bad.
    const TRIANGLES: usize = 30_000;
    let mut obj = "usemtl a\n".to_owned();
    for i in 0..TRIANGLES {
        obj += &format!("v {i} 0 0\nv {}.5 0 0\nv {i} 1 0\n", i);
        match i % 1000 {
            999 => obj += "f 1 2 9999999\n",
            _ if i % 2 == 0 => obj += "f -3 -2 -1\n",
            _ => obj += &format!("f {} {} {}\n", 3 * i + 1, 3 * i + 2, 3 * i + 3),
        }
    }
    let scene = load_obj(&obj);
    assert_eq!(scene.triangles.len(), TRIANGLES - 30);
    assert_eq!(scene.materials.len(), 1);
    assert!((area_m2(&scene) - 0.25 * (TRIANGLES - 30) as f64).abs() < 1.0);
    let (_, line, message) = warning(&scene, "does not exist");
    assert_eq!(line, 1 + 4 * 1000);
    assert!(message.starts_with("30 faces"), "{message}");
}

#[test]
fn import_agrees_with_tobj_on_a_clean_file() {
    let mut obj = String::new();
    for i in 0..400 {
        let (x, y) = (i % 20, i / 20);
        obj += &format!("v {x}.25 {} {y}e-1\nvt 0.{i:03} 0.5\nvn 0 1 0.{i:03}\n", (i * 7) % 11);
    }
    for i in (1..379).filter(|i| i % 20 != 0) {
        let [a, b, c] = [i, i + 1, i + 21];
        obj += &format!("f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}\nf {a}//{a} {c}//{c} {0}//{0}\n", i + 20);
    }
    let scene = load_obj(&obj);
    let options = tobj::LoadOptions { single_index: false, ..Default::default() };
    let (models, _) = tobj::load_obj_buf(&mut obj.as_bytes(), &options, |_| Ok(Default::default())).unwrap();
    let mesh = &models[0].mesh;
    assert_eq!(mesh.indices.len(), scene.triangles.len() * 3);
    for (corner, index) in mesh.indices.iter().enumerate() {
        let vertex = scene.triangles[corner / 3][corner % 3] as usize;
        let expected = DVec3::from_slice(&mesh.positions[3 * *index as usize..]);
        let found = scene.frame.world_from_scene(scene.positions[vertex]);
        assert!((expected - found).length() < 1e-4, "{expected} {found}");
        let normal = &mesh.normals[3 * mesh.normal_indices[corner] as usize..];
        let normal = DVec3::from_slice(normal).normalize_or(DVec3::ZERO).as_vec3();
        assert!((normal - scene.normals[vertex]).length() < 1e-6);
    }
}
