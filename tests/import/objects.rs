//! Named objects of OBJ and glTF, and their edits in the sidecar.

use super::{Folder, assert_clean, load_obj, warning};
use afterimage::import::save_edit;
use afterimage::scene::{ObjectEdit, ObjectKey, Scene};
use glam::DVec3;
use std::fs;

const CORNERS: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\n";

fn key(name: &str, number: u32) -> ObjectKey {
    ObjectKey { name: name.to_owned(), number }
}

/// The name of the object of each triangle; empty where it has none.
fn names(scene: &Scene) -> Vec<String> {
    let name = |t: u32| scene.object_of(t).map_or_else(String::new, ObjectKey::to_string);
    (0..scene.triangles.len() as u32).map(name).collect()
}

#[test]
fn objects_are_those_of_o_lines_or_of_g_lines_where_there_are_none() {
    let faces = |first: &str, second: &str| {
        load_obj(format!("{CORNERS}f 1 2 3\n{first}f 1 3 4\nf 1 2 6\n{second}f 1 2 5\n{first}f 2 3 6\n"))
    };
    assert_eq!(names(&faces("o chair\n", "o \"long name\"\n")), ["", "chair", "chair", "long name", "chair"]);
    assert_eq!(names(&faces("g a b\n", "g\n")), ["", "a b", "a b", "", "a b"]);
    assert_eq!(names(&faces("o x\ng y\n", "g z\n")), ["", "x", "x", "x", "x"]);
    // Faces without area are dropped, and the others keep their objects.
    let scene = load_obj(format!("{CORNERS}o a\nf 1 2 3\nf 1 1 2\no b\nf 1 3 4\n"));
    assert_eq!(names(&scene), ["a", "b"]);
    let long = "x".repeat(5000);
    let scene = load_obj(format!("{CORNERS}o {long}\nf 1 2 3\n"));
    assert_eq!(names(&scene), [""]);
}

#[test]
fn an_edit_of_objects_is_saved_and_imported_again_and_removed_when_undone() {
    let model = format!("{CORNERS}o chair\nf 1 2 3\no table\nf 1 3 4\no lamp\nf 1 2 6 5\n");
    let written = "# notes\n[[object]]\nname = \"lamp\" # the old one\nhidden = true\n";
    let folder = Folder::with_obj(model).add("scene.afterimage.toml", written);
    let before = folder.load().to_edit();
    assert!(before.objects[&key("lamp", 1)].is_hidden);
    let mut now = before.clone();
    let moved_m = DVec3::new(0.1, -1.0 / 3.0, 1e-7);
    now.objects.insert(key("chair", 1), ObjectEdit { moved_m, turned_deg: 12.5, ..ObjectEdit::default() });
    now.objects.insert(key("table", 1), ObjectEdit { is_deleted: true, ..ObjectEdit::default() });
    now.objects.insert(key("lamp", 1), ObjectEdit { moved_m: DVec3::Y, ..ObjectEdit::default() });
    let file = save_edit(&folder.path("scene.obj"), &before, &now).unwrap();
    let again = folder.load();
    assert_eq!(again.to_edit().objects, now.objects);
    assert_eq!(names(&again), ["chair", "lamp", "lamp"]);
    let text = fs::read_to_string(&file).unwrap();
    assert!(text.contains("# notes") && text.contains("# the old one") && !text.contains("hidden"), "{text}");
    let mut back = now.clone();
    back.objects.clear();
    save_edit(&folder.path("scene.obj"), &now, &back).unwrap();
    assert!(!fs::read_to_string(&file).unwrap().contains("object"));
    assert!(folder.load().edited_objects.is_none());
}

#[test]
fn what_cannot_be_done_is_one_line_and_the_rest_is_done() {
    let model = format!("{CORNERS}o chair\nf 1 2 3\no table\nf 1 3 4\n");
    let load = |toml: &str| Folder::with_obj(&model).add("scene.afterimage.toml", toml).load();
    let scene =
        load("[[object]]\nname = \"chiar\"\nhidden = true\n[[object]]\nname = \"table\"\nhidden = true\n");
    let (file, line, message) = warning(&scene, "no object");
    assert_eq!((file, line), ("scene.afterimage.toml", 1));
    assert_eq!(message, "the model has no object 'chiar'; did you mean 'chair'?");
    assert_eq!(names(&scene), ["chair"]);
    for (number, part) in
        [("nan", "'move_m'"), ("1e300", "'move_m'"), ("inf", "'move_m'"), ("1e50", "the way of")]
    {
        let scene = load(&format!("[[object]]\nname = \"chair\"\nmove_m = [{number}, 0.0, 0.0]\n"));
        warning(&scene, part);
        assert_eq!(scene.warnings.iter().filter(|w| w.file == "scene.afterimage.toml").count(), 1);
        assert!(scene.edited_objects.is_none());
    }
    for bad in ["number = 0", "number = 2", "turn_deg = 1e9", "colour = 1", "hidden = 3"] {
        let scene = load(&format!("[[object]]\nname = \"chair\"\n{bad}\n"));
        assert_eq!(scene.warnings.iter().filter(|w| w.file == "scene.afterimage.toml").count(), 1, "{bad}");
    }
    let all = "[[object]]\nname = \"chair\"\ndeleted = true\n[[object]]\nname = \"table\"\ndeleted = true\n";
    let scene = load(all);
    warning(&scene, "nothing would be left");
    assert_eq!(names(&scene), ["chair", "table"]);
    let unknown: String = (0..100).map(|i| format!("[[object]]\nname = \"x{i}\"\n")).collect();
    warning(&load(&unknown), "100 objects in all");
    let light = "[sun]\ndirection = [0, 1, 0]\n";
    assert_clean(&load(&format!("{light}[[object]]\nname = \"chair\"\nmove_m = [1, 0, 0]\n")));
}
