//! The glTF reader: its steps in order.

use super::{buffers::Buffers, document::Document, mesh::Mesher, nodes, pictures::Pictures};
use crate::import::tally::{Tally, list};
use crate::import::units::{Unit, Up};
use crate::import::{context::Import, files};
use crate::scene::SceneError;
use glam::{DMat4, DVec3};

/// Extensions that are supported.
const KNOWN: [&str; 8] = [
    "KHR_materials_transmission",
    "KHR_materials_ior",
    "KHR_materials_emissive_strength",
    "KHR_materials_specular",
    "KHR_materials_clearcoat",
    "KHR_lights_punctual",
    "KHR_texture_transform",
    "KHR_mesh_quantization",
];

/// Extensions that store meshes in another way. Without them nothing can be shown.
const COMPRESSED: [&str; 2] = ["KHR_draco_mesh_compression", "EXT_meshopt_compression"];

/// Reads a glTF file with its buffers and pictures.
pub(in crate::import) fn read(import: &mut Import) -> Result<(), SceneError> {
    let limits = &import.options.limits;
    let bytes = files::read_in_steps(&import.file, limits.gltf_bytes, &import.steps)?;
    let document = Document::parse(&bytes, import.path)?;
    check_extensions(&document, import)?;
    let world = world_from_root(import.unit().unwrap_or(Unit::Metre), import.up().unwrap_or(Up::PlusY));
    let mut tally = Tally::default();
    let Import { finder, builder, steps, .. } = import;
    let buffers = Buffers::read(&document, finder, limits, steps, &mut tally)?;
    let placements = nodes::walk(&document, world, builder, &mut tally, steps)?;
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
    import.report(tally)
}

fn world_from_root(unit: Unit, up: Up) -> DMat4 {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| up.world_from_model(axis) * unit.metres());
    DMat4::from_cols(axes[0].extend(0.0), axes[1].extend(0.0), axes[2].extend(0.0), DVec3::ZERO.extend(1.0))
}

fn check_extensions(document: &Document, import: &mut Import) -> Result<(), SceneError> {
    let root = &document.root;
    let all = root.extensions_used.iter().chain(&root.extensions_required);
    if let Some(compressed) = all.clone().find(|e| COMPRESSED.contains(&e.as_str())) {
        let cause = format!("its meshes are compressed ({compressed}), which is not supported");
        return Err(import.failed(cause, "export it without compression"));
    }
    let mut unknown: Vec<String> = all.filter(|e| !KNOWN.contains(&e.as_str())).cloned().collect();
    unknown.sort();
    unknown.dedup();
    if !unknown.is_empty() {
        import.warn(format!("extensions that are not supported are left out: {}", list(&unknown)));
    }
    if !root.animations.is_empty() {
        import.warn("animations are not played; everything stays where the nodes place it");
    }
    Ok(())
}
