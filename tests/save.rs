//! Picture files: a written file is read back unchanged, and a failed write leaves the old file.

use afterimage::raster::load::{Picture, PictureKind};
use afterimage::raster::save::{Channel, ChannelValues, SaveError, Target, save_png, write_atomically};
use afterimage::raster::stream::{Contents, PictureFile, Rows};
use glam::Vec3;
use std::path::Path;

fn names(folder: &Path) -> Vec<String> {
    let entry = |e: std::io::Result<std::fs::DirEntry>| e.unwrap().file_name().into_string().unwrap();
    std::fs::read_dir(folder).unwrap().map(entry).collect()
}

#[test]
fn a_png_comes_back_with_its_notes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    let pixels = [[0, 114, 178], [240, 228, 66], [213, 94, 0], [255, 255, 255], [0, 0, 0], [1, 2, 3]];
    save_png(&path, [3, 2], &pixels, &[("Scene", "r\u{e4}um".to_owned())]).unwrap();
    let picture = Picture::load(&path).unwrap();
    assert_eq!((picture.size, picture.kind), ([3, 2], PictureKind::Display));
    let back: Vec<[u8; 3]> =
        picture.values.iter().map(|v| (*v * 255.0).to_array().map(|c| c.round() as u8)).collect();
    assert_eq!(back, pixels);
    let reader = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(&path).unwrap()));
    let info = reader.read_info().unwrap().info().clone();
    assert_eq!(info.utf8_text[0].keyword, "Scene");
    assert_eq!(info.utf8_text[0].get_text().unwrap(), "r\u{e4}um");
    assert_eq!(names(folder.path()), ["a.png"]);
}

/// Writes an OpenEXR file in one portion of rows.
fn save_exr(path: &Path, size: [u32; 2], channels: &[Channel], note: &str) -> Result<(), SaveError> {
    let is_index = |c: &Channel| matches!(c.values, ChannelValues::Index(_));
    let named = channels.iter().map(|c| (c.name.clone(), is_index(c))).collect();
    let notes = [("Pose", note.to_owned())];
    let mut file = PictureFile::begin(Target::File(path.to_owned()), Contents::Exr(named), size, &notes)?;
    file.write(Rows::Channels(channels.iter().map(|c| c.values.clone()).collect()))?;
    file.finish(true).map(drop)
}

#[test]
fn an_exr_comes_back_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let colors: Vec<Vec3> = (0..35).map(|i| Vec3::new(i as f32 * 1e-6, 1e4 / (i + 1) as f32, 0.1)).collect();
    let mut channels = Channel::rgb(&colors);
    channels.push(Channel::real("depth.Z", vec![f32::INFINITY; 35]));
    channels.push(Channel::index("primitive.V", (0..35).map(|i| u32::MAX - i).collect()));
    save_exr(&path, [7, 5], &channels, "--eye 0,1,2").unwrap();
    let picture = Picture::load(&path).unwrap();
    assert_eq!((picture.size, picture.kind), ([7, 5], PictureKind::SceneLinear));
    assert_eq!(picture.values, colors);
    let image = exr::prelude::read_first_flat_layer_from_file(&path).unwrap();
    let mut stored: Vec<String> =
        image.layer_data.channel_data.list.iter().map(|c| c.name.to_string()).collect();
    stored.sort();
    assert_eq!(stored, ["B", "G", "R", "depth.Z", "primitive.V"]);
    let exr::prelude::FlatSamples::U32(ids) = &image.layer_data.channel_data.list[4].sample_data else {
        panic!("indices are stored as such")
    };
    assert_eq!(ids[34], u32::MAX - 34);
}

#[test]
fn a_channel_of_the_wrong_length_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    let error = save_exr(&path, [2, 2], &[Channel::real("R", vec![0.0; 3])], "").unwrap_err();
    assert!(error.to_string().contains("one value per pixel"), "{error}");
    assert!(!path.exists());
}

#[test]
fn a_failed_write_names_the_file_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("none").join("a.png");
    let error = save_png(&missing, [1, 1], &[[0; 3]], &[]).unwrap_err().to_string();
    assert!(error.contains("a.png") && error.contains("No such file"), "{error}");
    let error = write_atomically(folder.path(), b"x").unwrap_err().to_string();
    assert!(error.contains("directory"), "{error}");
    assert!(names(folder.path()).is_empty());
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_an_error_and_a_device_stays_a_device() {
    let full = Path::new("/dev/full");
    if !full.exists() {
        eprintln!("skipped: there is no /dev/full");
        return;
    }
    let error = save_png(full, [64, 64], &[[9; 3]; 4096], &[]).unwrap_err().to_string();
    assert!(error.contains("/dev/full") && error.contains("No space"), "{error}");
    assert!(!std::fs::metadata(full).unwrap().is_file());
}

#[test]
#[cfg(unix)]
fn an_unwritable_folder_keeps_the_old_file() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.png");
    save_png(&path, [1, 1], &[[7; 3]], &[]).unwrap();
    let before = std::fs::read(&path).unwrap();
    std::fs::set_permissions(folder.path(), PermissionsExt::from_mode(0o555)).unwrap();
    let outcome = save_png(&path, [1, 1], &[[8; 3]], &[]);
    std::fs::set_permissions(folder.path(), PermissionsExt::from_mode(0o755)).unwrap();
    match outcome {
        Err(_) => assert_eq!(std::fs::read(&path).unwrap(), before),
        Ok(()) => eprintln!("skipped: this user may write anywhere"),
    }
    assert_eq!(names(folder.path()), ["a.png"]);
}

#[test]
#[cfg(unix)]
fn a_link_keeps_pointing_and_a_picture_is_readable_by_others() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let (real, link) = (folder.path().join("real.bin"), folder.path().join("link.bin"));
    write_atomically(&real, b"old").unwrap();
    std::os::unix::fs::symlink(&real, &link).unwrap();
    write_atomically(&link, b"new").unwrap();
    assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(std::fs::read(&real).unwrap(), b"new");
    // The permissions are those of an ordinary new file, not those of a temporary file.
    let plain = folder.path().join("plain");
    std::fs::write(&plain, b"").unwrap();
    let mode = |p: &Path| std::fs::metadata(p).unwrap().permissions().mode() & 0o777;
    assert_eq!(mode(&real), mode(&plain));
}

#[test]
fn broken_pictures_are_refused_with_their_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("broken.png");
    for content in [&b""[..], b"not a picture", b"\x89PNG\r\n\x1a\nrubbish", b"\x76\x2f\x31\x01\xff\xff\xff"]
    {
        std::fs::write(&path, content).unwrap();
        let error = Picture::load(&path).unwrap_err().to_string();
        assert!(error.contains("broken.png"), "{error}");
    }
}

/// A disk of 64 kB, unmounted when dropped. `None` without the permission to mount one.
#[cfg(target_os = "linux")]
struct SmallDisk(tempfile::TempDir);

#[cfg(target_os = "linux")]
impl SmallDisk {
    fn new() -> Option<Self> {
        let folder = tempfile::tempdir().unwrap();
        let mut mount = std::process::Command::new("mount");
        mount
            .args(["-t", "tmpfs", "-o", "size=64k", "tmpfs"])
            .arg(folder.path())
            .stderr(std::process::Stdio::null());
        mount.status().is_ok_and(|s| s.success()).then_some(Self(folder))
    }
}

#[cfg(target_os = "linux")]
impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = std::process::Command::new("umount").arg(self.0.path()).status();
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_disk_that_fills_up_keeps_the_old_files() {
    use afterimage::experiment::run::{Done, Journal, RunRecord};
    let Some(disk) = SmallDisk::new() else {
        eprintln!("skipped: no right to mount a small disk");
        return;
    };
    let path = disk.0.path().join("a.png");
    save_png(&path, [2, 2], &[[7; 3]; 4], &[]).unwrap();
    let old = std::fs::read(&path).unwrap();
    let error = write_atomically(&path, "7".repeat(200_000).as_bytes()).unwrap_err().to_string();
    assert!(error.contains("a.png") && error.contains("No space left"), "{error}");
    assert_eq!(std::fs::read(&path).unwrap(), old);
    assert_eq!(names(disk.0.path()), ["a.png"], "no temporary file is left");

    // A journal that no longer fits returns an error and keeps its earlier entries.
    let done = |key: &str, bytes: usize| {
        let records = vec![RunRecord::default().with("x", "y".repeat(bytes))];
        Done { place: 0, key: key.to_owned(), records, cell_secs: 0.0 }
    };
    let mut journal = Journal::open(disk.0.path()).unwrap();
    journal.add(done("a", 10)).unwrap();
    let error = journal.add(done("b", 100_000)).unwrap_err().to_string();
    assert!(error.contains("No space left"), "{error}");
    let kept = Journal::read(disk.0.path()).unwrap();
    assert_eq!(kept.iter().map(|d| d.key.as_str()).collect::<Vec<_>>(), ["a"]);
}
