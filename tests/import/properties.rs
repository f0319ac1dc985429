//! Properties of everything that reads files of unknown origin: no panic, no number that is not
//! finite, a file name in every warning. A normal run tries 64 cases each; `PROPTEST_CASES=100000
//! cargo test properties` tries more.
//!
//! Texts consist of the words of their languages, so that most of them get past the first line, and
//! of some raw bytes. A case that fails is printed; it goes into `tests/data/corpus` together with
//! the fix.

use crate::entry_points;
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;
use proptest::test_runner::Config;
use std::time::{Duration, Instant};

/// Takes the number of cases from the environment. Failures are kept in the corpus, not in files of
/// proptest.
fn config() -> Config {
    let cases = std::env::var("PROPTEST_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(64);
    Config { cases, failure_persistence: None, ..Config::default() }
}

/// Numbers as files contain them, valid and invalid.
fn number() -> impl Strategy<Value = String> {
    prop_oneof![
        6 => (-4i32..5).prop_map(|n| n.to_string()),
        4 => (-1000.0f64..1000.0).prop_map(|n| n.to_string()),
        1 => any::<f64>().prop_map(|n| format!("{n:e}")),
        1 => any::<i64>().prop_map(|n| n.to_string()),
        1 => select(vec!["nan", "inf", "-inf", "1e400", "1.#QNAN", "0x10", "1,5", "", "-", "1e", "--1", "18446744073709551616"])
            .prop_map(str::to_owned),
    ]
}

/// A text of words, separated by `|` in `words`, and numbers.
fn text(words: &'static str, ends: &'static [&'static str]) -> impl Strategy<Value = Vec<u8>> {
    let words: Vec<&str> = words.split('|').collect();
    let word = prop_oneof![3 => select(words.clone()).prop_map(str::to_owned), 3 => number()];
    let line = (select(words), vec(word, 0..8), select(ends));
    let line = line.prop_map(|(first, rest, end)| format!("{first} {}{end}", rest.join(" ")).into_bytes());
    let noise = vec(any::<u8>(), 0..12);
    vec(prop_oneof![12 => line, 1 => noise], 0..30).prop_map(|parts| parts.concat())
}

/// Bytes of a valid file, some of them changed, removed or inserted.
fn spoilt(seeds: Vec<Vec<u8>>) -> impl Strategy<Value = Vec<u8>> {
    let changes = vec((any::<prop::sample::Index>(), any::<u8>(), 0..4u8), 0..8);
    (select(seeds), changes).prop_map(|(mut bytes, changes)| {
        for (at, value, kind) in changes {
            let at = at.index(bytes.len().max(1));
            match kind {
                0 => bytes.truncate(at),
                1 => bytes.insert(at.min(bytes.len()), value),
                _ => bytes.get_mut(at).into_iter().for_each(|b| *b = value),
            }
        }
        bytes
    })
}

fn seeds(name: &str) -> Vec<Vec<u8>> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/corpus").join(name);
    let read = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path());
    let mut paths: Vec<_> = read.collect();
    paths.sort();
    paths.iter().map(|p| std::fs::read(p).unwrap()).collect()
}

/// Entry points of formats that are decoded by packages, with spoilt files.
fn spoilt_of_any(names: &'static [&'static str]) -> impl Strategy<Value = (&'static str, Vec<u8>)> {
    select(names).prop_flat_map(|name| spoilt(seeds(name)).prop_map(move |bytes| (name, bytes)))
}

/// Runs an entry point on a small input, which must be fast even on a busy machine.
fn in_time(run: fn(&[u8]), bytes: &[u8]) {
    let start = Instant::now();
    run(bytes);
    let took = start.elapsed();
    assert!(took < Duration::from_secs(20), "{took:?} for {} bytes", bytes.len());
}

const OBJ: &str = "v|vt|vn|f|l|p|o|g|s|usemtl|mtllib|f 1 2 3|f 1/1/1 2/2/2 3/3/3|f -1 -2 -3|\
    v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -3\n|1/1|1//1|/|\\|#|\"|a|a.mtl|scene.obj|curv";
const MTL: &str = "newmtl a|newmtl b|newmtl|Kd|Ks|Ke|Ka|Tf|Ni|Ns|d|Tr|illum|Pr|Pm|map_Kd|map_d|map_Ke|-s|\
    -o|-mm|-clamp on|a.png|scene.mtl|spectral|xyz|#|\\|-halo";
const TOML: &str = "unit =|up =|\"mm\"|\"+Z\"|[[material]]\nname = \"a\"\n|kind = \"mirror\"\n|[sun]\n|\
    [sky]\n|direction = [|]|,|[start]\neye = [1, 2, 3]\nat = [|\
    [walk]\nkeyframes = [{eye = [0,0,0], at = [|}|[[view]]\n|\
    [[point_light]]\nposition_m = [0,1,0]\nintensity = |eta =|frames =|fov_y_deg =|=|{|\
    \"\"\"|true";
const JSON: &str = "{|}|[|]|:|,|\"keyframes\"|\"eye\"|\"at\"|\"fov_y_deg\"|\"frames\"|null|true|\"a\"|\
    {\"fov_y_deg\":60,\"frames\":3,\"keyframes\":[{\"eye\":[0,0,0],\"at\":[1,0,0]}]}\n|\
    \"records\"|\"key\"|{\"place\":0,\"key\":\"a\",\"records\":[],\"cell_secs\":1.0}\n|\
    \"format\":1";
const ENDS: &[&str] = &["\n", "\n", "\r\n", "\r", " ", "\\\n", ""];

proptest! {
    #![proptest_config(config())]

    #[test]
    fn any_obj_ends_in_a_scene_or_a_message(bytes in prop_oneof![3 => text(OBJ, ENDS), 1 => spoilt(seeds("obj"))]) {
        in_time(entry_points::obj, &bytes);
    }

    #[test]
    fn any_library_leaves_a_scene(bytes in prop_oneof![3 => text(MTL, ENDS), 1 => spoilt(seeds("mtl"))]) {
        in_time(entry_points::mtl, &bytes);
    }

    #[test]
    fn any_picture_leaves_a_scene(bytes in prop_oneof![3 => spoilt(seeds("texture")), 1 => vec(any::<u8>(), 0..200)]) {
        in_time(entry_points::texture, &bytes);
    }

    #[test]
    fn any_gltf_ends_in_a_scene_or_a_message(bytes in prop_oneof![4 => spoilt(seeds("gltf")), 1 => text(JSON, ENDS)]) {
        in_time(entry_points::gltf, &bytes);
    }

    #[test]
    fn any_settings_leave_a_scene(bytes in prop_oneof![3 => text(TOML, ENDS), 1 => spoilt(seeds("sidecar"))]) {
        in_time(entry_points::sidecar, &bytes);
    }

    #[test]
    fn any_session_leaves_a_scene(bytes in prop_oneof![2 => text(TOML, ENDS), 2 => spoilt(seeds("session"))]) {
        in_time(entry_points::session, &bytes);
    }

    #[test]
    fn any_walk_is_walked_or_refused(bytes in prop_oneof![1 => text(JSON, ENDS), 2 => spoilt(seeds("walk"))]) {
        in_time(entry_points::walk, &bytes);
    }

    #[test]
    fn any_journal_is_gone_on_with(bytes in prop_oneof![1 => text(JSON, ENDS), 2 => spoilt(seeds("journal"))]) {
        in_time(entry_points::journal, &bytes);
    }

    #[test]
    fn any_picture_to_compare_is_read_or_refused(bytes in spoilt(seeds("picture"))) {
        in_time(entry_points::picture, &bytes);
    }

    #[test]
    fn any_compressed_mesh_and_any_picture_ends_in_a_scene_or_a_message(
        (name, bytes) in spoilt_of_any(&["draco", "meshopt", "webp", "tiff", "gif", "dds", "exr"])
    ) {
        let (_, run) = entry_points::ALL.iter().find(|(known, _)| *known == name).unwrap();
        in_time(*run, &bytes);
    }

    /// Whatever the encoding and the line ends, the numbers are the same.
    #[test]
    fn repairs_change_no_vertex(points in vec((-1e6f64..1e6, -1e6f64..1e6, -1e6f64..1e6), 3..40), end in select(vec!["\n", "\r\n", "\r"])) {
        let mut plain = String::new();
        points.iter().for_each(|(x, y, z)| plain += &format!("v {x} {y} {z}\n"));
        (3..=points.len()).for_each(|i| plain += &format!("f {} {} {}\n", i - 2, i - 1, i));
        let dressed = format!("\u{feff}# \u{fc}\n{}", plain.replace("v ", "v\t").replace("f ", "f \\\n").replace('\n', end));
        let utf16: Vec<u8> = dressed.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let hash = |bytes: &[u8]| super::Folder::with_obj(bytes).try_load().map(|s| s.hash).map_err(|e| e.to_string());
        let first = hash(plain.as_bytes());
        prop_assert_eq!(&hash(dressed.as_bytes()), &first);
        prop_assert_eq!(&hash(&utf16), &first);
    }
}
