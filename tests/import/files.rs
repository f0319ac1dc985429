//! A scene knows the files it was read from, so that a window can watch them.

use super::{Folder, textures};
use afterimage::scene::{Scene, SourceFile};

/// Names of a scene's files, and whether each exists.
fn names(scene: &Scene) -> Vec<(String, bool)> {
    let name = |file: &SourceFile| file.path.file_name().unwrap().to_string_lossy().into_owned();
    scene.files.iter().map(|file| (name(file), file.stamp.is_some())).collect()
}

/// Names and existence as [`names`] returns them.
fn expected(files: &[(&str, bool)]) -> Vec<(String, bool)> {
    files.iter().map(|(name, exists)| ((*name).to_owned(), *exists)).collect()
}

#[test]
fn all_files_of_a_model_belong_to_its_scene_also_those_that_are_missing() {
    let mtl = "newmtl a\nmap_Kd wood.png\nmap_d lost.png\nnewmtl b\nmap_Kd wood.png\n";
    let folder = Folder::with_mtl(&["a", "b"], mtl)
        .add("textures/wood.png", textures::png(1, 1, &[[9, 9, 9, 255]]))
        .add("scene.afterimage.toml", "unit = \"m\"\n");
    let files = [
        ("scene.obj", true),
        ("scene.afterimage.toml", true),
        ("lost.png", false),
        ("scene.mtl", true),
        ("wood.png", true),
    ];
    let scene = folder.load();
    assert_eq!(names(&scene), expected(&files));
    // A change of any of them can be seen, and nothing else is one.
    let is_changed = |file: &SourceFile| SourceFile::now(&file.path) != *file;
    assert!(!scene.files.iter().any(is_changed));
    for (name, _) in files {
        let at = if name == "wood.png" { "textures/wood.png" } else { name };
        let folder = Folder { dir: tempfile::tempdir().unwrap(), options: folder.options.clone() };
        let folder = folder.add("scene.obj", super::TRIANGLE).add(at, "before");
        let before = SourceFile::now(&folder.path(at));
        let folder = folder.add(at, "after that");
        assert!(is_changed(&before), "{name}");
        std::fs::remove_file(folder.path(at)).unwrap();
        assert!(is_changed(&before), "{name}");
    }
}

#[test]
fn a_file_that_may_not_be_opened_is_not_looked_at() {
    let folder = Folder::with_obj(format!("mtllib ../../secret.mtl\n{}", super::TRIANGLE));
    let scene = folder.load();
    // Only the place inside the folder, where such a file is looked for as well.
    assert!(
        scene.files.iter().all(|file| file
            .path
            .parent()
            .unwrap()
            .ends_with(folder.dir.path().file_name().unwrap()))
    );
    assert_eq!(names(&scene).last().unwrap(), &("secret.mtl".to_owned(), false));
}
