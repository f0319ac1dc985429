//! The schemas say what the program does: they list the same keys, and refuse what it refuses.

mod check;

use super::{Bench, stderr};
use check::problems;
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// A name that resembles no key.
const NONSENSE: &str = "qqqqqqqqqqqqqqqqqqqqqqqqqqqqqqqq";

/// Every key of a sidecar, with a value that is right.
const SIDECAR: &str = r#"
unit = "m"
up = "+Y"
material = [
    { name = "wall", kind = "glossy", diffuse = [0.5, 0.5, 0.5], reflectance = 0.04, roughness = 0.3, emission = 0 },
    { name = "mirror", number = 1, kind = "mirror", fresnel = true },
    { name = "lamp", kind = "glass", eta = 1.5, transmittance = [1, 1, 1] },
]
object = [{ name = "table", number = 1, move_m = [1, 0, 0], turn_deg = 90, hidden = false, deleted = false }]
point_light = [
    { position_m = [0, 2, 0], lumens = 800, color = [1, 0.9, 0.8], aim = [0, -1, 0], front = [1, 0, 0] },
    { position_m = [0, 2, 1], candela = 100 },
    { position_m = [0, 2, 2], intensity = [1, 1, 1] },
    { position_m = [0, 2, 3], ies = "lamp.ies", factor = 2 },
]
lights = [{ name = "Sun", on = true, intensity = 0.5, color = [1, 1, 1], materials = ["lamp"] }]
view = [{ name = "door", eye = [0, 1.6, 3], at = [0, 1.4, 0], fov_y_deg = 60, roll_deg = 0 }]
[sun]
off = false
direction = [0, 1, 0]
irradiance = 3
lux = 90000
angular_radius_deg = 0.27
place = "52.52,13.40"
time = "2026-06-21T12:00[Europe/Berlin]"
north_deg = 30
[sky]
off = false
kind = "gradient"
zenith = [0.3, 0.5, 1]
horizon = 1
ground = 0.2
sun_direction = [0, 1, 0]
turbidity = 3
albedo = 0.2
brightness = 1
picture = "day.hdr"
rotation_deg = 10
[ground]
height_m = 0
albedo = 0.2
off = false
[start]
eye = [0, 1.6, 3]
at = [0, 1.4, 0]
fov_y_deg = 60
roll_deg = 0
[walk]
frames = 100
fov_y_deg = 60
keyframes = [{ eye = [0, 1.6, 3], at = [0, 1.4, 0], secs = 2 }]
[settings]
samples = 4
"#;

/// Every setting, with a value that is right.
const SETTINGS: &str = r#"
mode = "fast"
samples = 8
bounces = "all"
seed = 7
threads = 2
size = "320x240"
exposure = -1.5
tone_map = "linear"
pictures = "pictures"
theme = "dark"
ui_scale = 1.25
keep_improving = true
reduced_motion = true
tab = "camera"
[keys]
add-reference = "B"
forward = ["W", "I"]
"#;

/// The schema as the program prints it.
fn schema(bench: &Bench, of: &str) -> Value {
    let output = bench.run(&format!("schema {of}"));
    assert!(output.status.success(), "{}", stderr(&output));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn json_of(toml: &str) -> Value {
    serde_json::to_value(toml.parse::<toml::Table>().unwrap()).unwrap()
}

/// Warnings of the program about a sidecar that concern its keys and values.
fn warnings(bench: &Bench, sidecar: &str) -> Vec<String> {
    std::fs::write(bench.path("room.afterimage.toml"), sidecar).unwrap();
    let inspected = bench.json("inspect room.obj --json");
    let all = inspected["warnings"].as_array().unwrap().iter();
    let of_file = all.filter(|w| w["file"] == "room.afterimage.toml");
    of_file.map(|w| w["message"].as_str().unwrap().to_owned()).collect()
}

/// The tables of a schema: the way to each in a document, and its properties.
fn tables(schema: &Value) -> Vec<(Vec<String>, &Value)> {
    let mut found = vec![(Vec::new(), &schema["properties"])];
    let mut at = 0;
    while at < found.len() {
        let (way, properties) = found[at].clone();
        for (name, part) in properties.as_object().unwrap() {
            let inner = if part["items"]["properties"].is_object() { &part["items"] } else { part };
            if inner["properties"].is_object() {
                found.push(([way.as_slice(), std::slice::from_ref(name)].concat(), &inner["properties"]));
            }
        }
        at += 1;
    }
    found
}

/// The table of a document at the end of a way; of a list its first.
fn table_at<'a>(document: &'a mut Value, way: &[String]) -> &'a mut Value {
    way.iter().fold(document, |at, name| {
        let inner = &mut at[name];
        if inner.is_array() { &mut inner[0] } else { inner }
    })
}

/// The names in a message that lists them: `there are a, b, c`.
fn listed(message: &str) -> BTreeSet<String> {
    let names = message.split_once("there are ").unwrap_or_else(|| panic!("{message}")).1;
    names.split(", ").map(str::to_owned).collect()
}

fn names(properties: &Value) -> BTreeSet<String> {
    properties.as_object().unwrap().keys().cloned().collect()
}

#[test]
fn the_schema_of_a_sidecar_has_the_keys_that_the_program_knows() {
    let bench = Bench::new();
    let schema = schema(&bench, "sidecar");
    assert_eq!(problems(&schema, &json_of(SIDECAR)), Vec::<String>::new());
    for (way, properties) in tables(&schema) {
        let mut document = json_of(SIDECAR);
        let table = table_at(&mut document, &way);
        let used: BTreeSet<String> = names(table);
        assert!(used.is_subset(&names(properties)), "{way:?}");
        table[NONSENSE] = json!(1);
        let text = toml::to_string(&document).unwrap();
        let said = warnings(&bench, &text);
        let about = said
            .iter()
            .find(|message| message.contains(NONSENSE))
            .unwrap_or_else(|| panic!("{way:?}: {said:#?}"));
        assert_eq!(listed(about), names(properties), "{way:?}");
        assert!(!problems(&schema, &document).is_empty(), "{way:?}");
    }
    // Every key is in the sample, so that none has a name that is never read.
    let sample = json_of(SIDECAR);
    for (way, properties) in tables(&schema) {
        let mut used = BTreeSet::new();
        let lists = way.iter().fold(vec![&sample], |at, name| {
            at.iter()
                .flat_map(|v| v[name].as_array().map_or(vec![&v[name]], |l| l.iter().collect()))
                .collect()
        });
        lists.iter().for_each(|table| used.extend(names(table)));
        assert_eq!(used, names(properties), "{way:?}");
    }
}

#[test]
fn the_schema_of_a_sidecar_refuses_the_values_that_the_program_refuses() {
    let bench = Bench::new();
    let schema = schema(&bench, "sidecar");
    let before = warnings(&bench, SIDECAR);
    for (right, wrong) in [
        ("unit = \"m\"", "unit = \"yard\""),
        ("up = \"+Y\"", "up = 1"),
        ("kind = \"glossy\"", "kind = \"shiny\""),
        ("roughness = 0.3", "roughness = 1.5"),
        ("reflectance = 0.04", "reflectance = [1, 1]"),
        ("fresnel = true", "fresnel = 1"),
        ("eta = 1.5", "eta = 0.5"),
        ("turn_deg = 90", "turn_deg = 400"),
        ("move_m = [1, 0, 0]", "move_m = [1, 0, \"0\"]"),
        ("lumens = 800", "lumens = -1"),
        ("intensity = 0.5", "intensity = 5000"),
        ("materials = [\"lamp\"]", "materials = \"lamp\""),
        ("angular_radius_deg = 0.27", "angular_radius_deg = 91"),
        ("kind = \"gradient\"", "kind = \"grey\""),
        ("turbidity = 3", "turbidity = 0"),
        ("albedo = 0.2\noff", "albedo = 0.95\noff"),
        ("frames = 100", "frames = 0"),
        ("keyframes = [{ eye = [0, 1.6, 3], at = [0, 1.4, 0], secs = 2 }]", "keyframes = []"),
        ("fov_y_deg = 60\nroll_deg", "fov_y_deg = 171\nroll_deg"),
        ("name = \"table\", ", ""),
    ] {
        assert!(SIDECAR.contains(right), "{right}");
        let text = SIDECAR.replacen(right, wrong, 1);
        assert!(!problems(&schema, &json_of(&text)).is_empty(), "the schema accepts {wrong}");
        let is_new = |message: &String| !before.contains(message);
        assert!(warnings(&bench, &text).iter().any(is_new), "the program accepts {wrong}");
    }
}

#[test]
fn the_schema_of_the_settings_agrees_with_the_program() {
    let bench = Bench::new();
    let schema = schema(&bench, "settings");
    let said = |text: &str| {
        std::fs::write(bench.path("s.toml"), text).unwrap();
        let output = bench.run("inspect room.obj --config s.toml");
        stderr(&output)
    };
    assert_eq!((said(SETTINGS).as_str(), problems(&schema, &json_of(SETTINGS))), ("", Vec::new()));
    assert_eq!(names(&json_of(SETTINGS)), names(&schema["properties"]));
    let unknown = said(&format!("{NONSENSE} = 1\n"));
    assert_eq!(listed(unknown.trim_end()), names(&schema["properties"]));
    for wrong in [
        "mode = 'slow'",
        "samples = 0",
        "bounces = 65",
        "bounces = 'some'",
        "seed = -1",
        "threads = 1025",
        "size = '3by4'",
        "exposure = 65",
        "tone_map = 'film'",
        "pictures = 1",
        "theme = 'blue'",
        "ui_scale = 4",
        "reduced_motion = 2",
        "tab = 'other'",
        "keys = 3",
    ] {
        assert!(said(wrong).contains("is ignored"), "the program accepts {wrong}");
        assert!(!problems(&schema, &json_of(wrong)).is_empty(), "the schema accepts {wrong}");
    }
}

#[test]
fn the_files_of_the_repository_fit_their_schema() {
    let bench = Bench::new();
    let studio = include_str!("../../../../assets/scenes/studio/studio.afterimage.toml");
    assert_eq!(problems(&schema(&bench, "sidecar"), &json_of(studio)), Vec::<String>::new());
}
