//! `afterimage inspect`: a scene's contents, the features it uses, and its warnings.

use super::scene::{Loaded, load, place};
use super::section::SectionFlags;
use super::{failure::Failure, flags::Flags, output, pose::camera, section};
use afterimage::scene::{Light, Material, Scene, Sky};
use afterimage::trace::truncation_bound;
use clap::Args;
use serde_json::{Value, json};
use std::collections::BTreeMap;

#[derive(Args, Debug)]
pub(crate) struct InspectArgs {
    /// A model (.obj, .gltf, .glb) or builtin:NAME.
    pub(super) scene: String,
    #[command(flatten)]
    section: SectionFlags,
}

pub(crate) fn run(args: &InspectArgs, flags: &Flags) -> Result<(), Failure> {
    let loaded = load(Some(&args.scene), flags)?;
    let camera = camera(flags, loaded.scene())?;
    let loaded = args.section.cut(loaded, &camera, flags)?;
    let mut object = object(&loaded);
    output::extend(&mut object, section::record(&loaded));
    output::result(flags.json, &object, || table(&loaded) + &section::table(&loaded));
    loaded.verdict(flags)
}

fn object(loaded: &Loaded) -> Value {
    let scene = loaded.scene();
    let material = |m: &Material| {
        let (types, why) = m.types();
        let textured = m.diffuse_texture.is_some();
        json!({"name": m.name, "kind": m.kind_name(), "textured": textured, "types": types, "why": why,
            "by_picture": m.varies_by_picture()})
    };
    let kinds: serde_json::Map<String, Value> =
        light_kinds(scene).into_iter().map(|(kind, count)| (kind.to_owned(), count.into())).collect();
    let (reflectance, bound) = mirrors(scene);
    json!({
        "scene": loaded.name,
        "hash": scene.hash,
        "triangles": scene.triangles.len(),
        "vertices": scene.positions.len(),
        "materials": scene.materials.iter().map(material).collect::<Vec<_>>(),
        "objects": scene.all_objects().keys().len(),
        "edited_objects": scene.object_edits().keys().map(ToString::to_string).collect::<Vec<_>>(),
        "textures": scene.textures.len(),
        "lights": scene.lights.len(),
        "light_kinds": kinds,
        "light_groups": scene.light_groups.list.iter().map(|group| group.name.as_str()).collect::<Vec<_>>(),
        "sky": scene.sky.as_ref().map(Sky::describe),
        "bounds_m": scene.bounds_m.map(|b| b.to_array()),
        "building_m": scene.building_m.map(|b| b.to_array()),
        "start_view": start_view(loaded),
        "origin_m": scene.frame.origin_in_world_m.to_array(),
        "units_per_metre": scene.frame.units_per_metre,
        "views": scene.views.iter().map(|v| v.name.as_str()).collect::<Vec<_>>(),
        "walk": {"frames": scene.walk.frames, "keyframes": scene.walk.keyframes.len(), "length_m": scene.walk.length_m()},
        "exposure": scene.exposure,
        "needs": scene.features,
        "left_out": scene.features.left_out(),
        "mirror_reflectance_max": reflectance,
        "mirror_truncation_bound": bound,
        "stiffness": scene.conditioning,
        "bvh_bytes": loaded.tracer.bvh().bytes(),
        "secs": {"load": loaded.load_secs, "build": loaded.tracer.build_secs()},
        "warnings": scene.warnings,
    })
}

/// The start view, and the share of its picture that shows building.
fn start_view(loaded: &Loaded) -> Value {
    let start = loaded.scene().start();
    json!({
        "eye": start.eye.to_array(),
        "look_at": (start.eye + start.forward()).to_array(),
        "fov_y_deg": start.fov_y.to_degrees(),
        "roll_deg": start.roll.to_degrees(),
        "building_share": loaded.tracer.building_share(start),
    })
}

fn light_kinds(scene: &Scene) -> Vec<(&'static str, usize)> {
    let count = |is: fn(&Light) -> bool| scene.lights.iter().filter(|l| is(l)).count();
    vec![
        ("quad", count(|l| matches!(l, Light::Quad { .. }))),
        ("mesh", count(|l| matches!(l, Light::Triangles { .. }))),
        ("point", count(|l| matches!(l, Light::Point { profile: None, .. }))),
        ("with a profile", count(|l| matches!(l, Light::Point { profile: Some(_), .. }))),
        ("sun", count(|l| matches!(l, Light::Sun { .. }))),
        ("sky", count(|l| matches!(l, Light::Sky))),
        ("bright parts of the sky", count(|l| matches!(l, Light::SkySuns))),
    ]
}

/// The largest reflectance of all mirrors, and a bound on the radiance that is lost by ending
/// chains of mirrors early, relative to the largest radiance reflected; `None` if it is unbounded.
fn mirrors(scene: &Scene) -> (f32, Option<f32>) {
    let r = scene.materials.iter().map(Material::max_mirror_reflectance).fold(0.0, f32::max);
    let bound = if r > 0.0 { truncation_bound(r, 1.0) } else { 0.0 };
    (r, bound.is_finite().then_some(bound))
}

/// The number of named objects, and how many of them are moved or not shown.
fn objects(scene: &Scene) -> String {
    let edits = scene.object_edits();
    let gone = edits.values().filter(|edit| edit.is_gone()).count();
    let (all, moved) = (scene.all_objects().keys().len(), edits.len() - gone);
    match edits.is_empty() {
        true => format!("{all} named"),
        false => format!("{all} named, {moved} moved, {gone} not shown"),
    }
}

/// Names of the materials that emit from their front alone; `None` where there is none.
fn one_sided(scene: &Scene) -> Option<String> {
    let lamps = scene.materials.iter().filter(|material| material.has_dark_back());
    let names: Vec<&str> = lamps.map(|material| material.name.as_str()).collect();
    (!names.is_empty()).then(|| names.join(", "))
}

/// How the materials are traced: a line for each way, with names.
fn traced(scene: &Scene) -> Vec<String> {
    /// Names shown of each way; `--json` lists all.
    const MAX_NAMES: usize = 8;
    let mut ways: BTreeMap<(&str, &str), Vec<&str>> = BTreeMap::new();
    for material in &scene.materials {
        ways.entry(material.types()).or_default().push(&material.name);
    }
    let line = |((types, why), names): ((&str, &str), Vec<&str>)| {
        let more = names.len().saturating_sub(MAX_NAMES);
        let shown = names[..names.len() - more].join(", ");
        let more = if more > 0 { format!(" and {more} more") } else { String::new() };
        format!("{types} ({why}): {shown}{more}")
    };
    ways.into_iter().map(line).collect()
}

/// What pictures vary in the materials, apart from colour: a line for each such thing, with a
/// count.
fn varied(scene: &Scene) -> Vec<String> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for what in scene.materials.iter().flat_map(Material::varies_by_picture) {
        *counts.entry(what).or_default() += 1;
    }
    counts.into_iter().map(|(what, count)| format!("{what} by picture in {count} materials")).collect()
}

fn table(loaded: &Loaded) -> String {
    let scene = loaded.scene();
    let [low, high] = scene.bounds_m;
    let size = high - low;
    let kinds = light_kinds(scene).into_iter().filter(|(_, n)| *n > 0).map(|(kind, n)| format!("{n} {kind}"));
    let (reflectance, bound) = mirrors(scene);
    let bound = bound.map_or("an unbounded share".to_owned(), |b| format!("at most {:.2} %", b * 100.0));
    let textured = scene.materials.iter().filter(|m| m.diffuse_texture.is_some()).count();
    let left_out = scene.features.left_out();
    let building = scene.building_m[1] - scene.building_m[0];
    let mut text = output::table(&[
        ("scene", loaded.name.clone()),
        ("triangles", format!("{}, {} vertices", scene.triangles.len(), scene.positions.len())),
        ("size", format!("{:.2} x {:.2} x {:.2} m", size.x, size.y, size.z)),
        ("building", format!("{:.2} x {:.2} x {:.2} m", building.x, building.y, building.z)),
        ("materials", format!("{}, {textured} textured", scene.materials.len())),
        ("objects", objects(scene)),
        ("lights", format!("{} ({})", scene.lights.len(), kinds.collect::<Vec<_>>().join(", "))),
        (
            "light groups",
            scene.light_groups.list.iter().map(|g| g.name.as_str()).collect::<Vec<_>>().join(", "),
        ),
        ("sky", scene.sky.as_ref().map_or("none".to_owned(), Sky::describe)),
        ("left out", if left_out.is_empty() { "nothing".to_owned() } else { left_out.join(", ") }),
        (
            "mirrors",
            format!(
                "reflectance {reflectance:.3}; ending their chains early loses {bound} of the reflected radiance"
            ),
        ),
        (
            "hierarchy",
            format!(
                "{:.1} MB in {:.3} s",
                loaded.tracer.bvh().bytes() as f64 / 1e6,
                loaded.tracer.build_secs()
            ),
        ),
        ("loaded in", format!("{:.3} s", loaded.load_secs)),
        ("warnings", scene.warnings.len().to_string()),
    ]);
    for line in traced(scene).into_iter().chain(varied(scene)) {
        text += &format!("  {line}\n");
    }
    if let Some(names) = one_sided(scene) {
        text += &format!("  emit from their front alone: {names}\n");
    }
    for sentence in scene.conditioning.sentences() {
        text += &format!("  {sentence}\n");
    }
    for w in &scene.warnings {
        text += &format!("  {}{}\n", place(w), w.message);
    }
    text
}
