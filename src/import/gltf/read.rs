//! The glTF reader: its steps in order.

use super::document::Document;
use super::{buffers::Buffers, mesh::Mesher, nodes, pictures::Pictures};
use crate::import::tally::{Tally, list};
use crate::import::units::{self, Unit, Up};
use crate::import::{context::Import, files};
use crate::scene::SceneError;
use glam::{DMat4, DVec3};

/// Extensions that are supported.
const KNOWN: [&str; 18] = [
    "KHR_materials_transmission",
    "KHR_materials_ior",
    "KHR_materials_volume",
    "KHR_materials_emissive_strength",
    "KHR_materials_specular",
    "KHR_materials_clearcoat",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_lights_punctual",
    "EXT_lights_ies",
    "KHR_texture_transform",
    "KHR_mesh_quantization",
    "KHR_node_visibility",
    "EXT_mesh_gpu_instancing",
    "EXT_texture_webp",
    "MSFT_texture_dds",
    "KHR_draco_mesh_compression",
    "EXT_meshopt_compression",
    "KHR_meshopt_compression",
];

/// Extensions without effect, and what is seen instead.
const WITHOUT_EFFECT: [(&str, &str); 10] = [
    ("KHR_materials_unlit", "its materials are lit like paint"),
    ("KHR_materials_sheen", "cloth is shown without its sheen"),
    ("KHR_materials_anisotropy", "brushed surfaces reflect evenly in all directions"),
    ("KHR_materials_iridescence", "surfaces are shown without iridescent colours"),
    ("KHR_materials_dispersion", "glass refracts all colours alike"),
    ("KHR_materials_diffuse_transmission", "cloth and leaves let no light through"),
    ("KHR_materials_variants", "the first variant of each material is shown"),
    ("KHR_texture_basisu", "pictures in KTX2 are left out where there is no other"),
    ("EXT_texture_avif", "pictures in AVIF are left out where there is no other"),
    ("KHR_animation_pointer", "animations are not played"),
];

/// Reads a glTF file with its buffers and pictures.
pub(in crate::import) fn read(import: &mut Import) -> Result<(), SceneError> {
    let limits = &import.options.limits;
    let bytes = files::read_in_steps(&import.file, limits.gltf_bytes, &import.steps)?;
    let document = Document::parse(&bytes, import.path)?;
    check_extensions(&document, import);
    let world = world_from_root(import.unit().unwrap_or(Unit::Metre), import.up().unwrap_or(Up::PlusY));
    let mut tally = Tally::default();
    document.note_root(&mut tally);
    let Import { finder, builder, steps, .. } = import;
    let buffers = Buffers::read(&document, finder, limits, steps, &mut tally)?;
    let placements = nodes::walk((&document, &buffers), world, builder, finder, &mut tally, steps)?;
    let mut mesher = Mesher {
        document: &document,
        buffers: &buffers,
        materials: Default::default(),
        builder,
        tally: &mut tally,
        steps,
        limit: limits.gltf_vertices,
    };
    mesher.add_all(&placements)?;
    let materials = mesher.materials;
    let images = materials.images();
    let pictures = Pictures::read(&images, &document, &buffers, finder, (limits, steps), &mut tally)?;
    materials.finish(&pictures, builder, &document, &mut tally);
    import.report(tally)?;
    fit_unit(import);
    import.hint_up();
    Ok(())
}

/// Converts a model that would be absurdly large in metres, which glTF prescribes.
fn fit_unit(import: &mut Import) {
    if import.unit().is_some() {
        return;
    }
    let builder = &import.builder;
    let measured = units::measure(&builder.positions, &builder.triangles);
    let Some(unit) = measured.and_then(units::absurd_in_metres) else { return };
    let how = format!("Set it with --unit, or with unit = \"m\" in {}", import.sidecar.file_name);
    let across = measured.map_or(0.0, |m| m.across);
    import.warn(units::taken_as(across, unit, &how));
    let scale = unit.metres();
    let builder = &mut import.builder;
    builder.positions.iter_mut().for_each(|p| *p *= scale);
    builder.point_lights.iter_mut().for_each(|(p, _)| *p *= scale);
    builder.spot_lights.iter_mut().for_each(|spot| spot.position_m *= scale);
    builder.profile_lights.iter_mut().for_each(|lamp| lamp.position_m *= scale);
    builder.views.iter_mut().for_each(|view| view.camera.eye *= scale);
}

fn world_from_root(unit: Unit, up: Up) -> DMat4 {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| up.world_from_model(axis) * unit.metres());
    DMat4::from_cols(axes[0].extend(0.0), axes[1].extend(0.0), axes[2].extend(0.0), DVec3::ZERO.extend(1.0))
}

fn check_extensions(document: &Document, import: &mut Import) {
    let root = &document.root;
    let mut used: Vec<&str> =
        root.extensions_used.iter().chain(&root.extensions_required).map(String::as_str).collect();
    used.sort_unstable();
    used.dedup();
    let mut unknown = Vec::new();
    for name in used {
        let instead = WITHOUT_EFFECT.iter().find(|(known, _)| *known == name);
        if let Some((_, instead)) = instead {
            import.warn(format!("the extension {name} has no effect: {instead}"));
        } else if !KNOWN.contains(&name) {
            unknown.push(name.to_owned());
        }
    }
    if !unknown.is_empty() {
        import.warn(format!("extensions that are not supported are left out: {}", list(&unknown)));
    }
    if !root.animations.is_empty() {
        import.warn("animations are not played; everything stays where the nodes place it");
    }
}
