//! glTF 2.0, `.gltf` and `.glb`: document -> buffers -> nodes -> meshes -> materials -> pictures. Metres and +Y up are
//! given by the format.
//!
//! Why not the `gltf` crate: it gives up a whole file for one bad item, reads buffers and pictures without a bound, and
//! knows no lines. It remains the independent second opinion in the tests.

mod accessor;
mod buffers;
mod document;
mod mesh;
mod nodes;
mod palette;
mod pictures;
mod schema;
mod uri;

use crate::import::report::{Tally, list};
use crate::import::search::Finder;
use crate::import::units::{Unit, Up};
use crate::import::{Import, files};
use crate::scene::{SceneBuilder, SceneError};
use buffers::Buffers;
use document::Document;
use glam::{DMat4, DVec3};
use mesh::Mesher;
use palette::Palette;
use pictures::Pictures;

/// Extensions that are read.
const KNOWN: [&str; 6] = [
    "KHR_materials_transmission",
    "KHR_materials_ior",
    "KHR_materials_emissive_strength",
    "KHR_lights_punctual",
    "KHR_texture_transform",
    "KHR_mesh_quantization",
];

/// Extensions without which the triangles are not what they seem.
const COMPRESSED: [&str; 2] = ["KHR_draco_mesh_compression", "EXT_meshopt_compression"];

/// Reads the file into the builder; returns what was doubtful in it.
pub(crate) fn read(
    import: &Import,
    unit: Unit,
    up: Up,
    finder: &mut Finder,
    builder: &mut SceneBuilder,
) -> Result<Tally, SceneError> {
    let (limits, steps) = (&import.options.limits, &import.steps);
    let bytes = files::read_in_steps(&import.file, limits.gltf_bytes, steps)?;
    let document = Document::parse(&bytes, import.path)?;
    check_extensions(&document, import, builder)?;
    let mut tally = Tally::default();
    let buffers = Buffers::read(&document, finder, limits, steps, &mut tally)?;
    let placements = nodes::walk(&document, world_from_root(unit, up), builder, &mut tally, steps)?;
    let mut mesher = Mesher {
        document: &document,
        buffers: &buffers,
        palette: Palette::default(),
        builder,
        tally: &mut tally,
        steps,
        limit: limits.gltf_vertices,
    };
    mesher.add_all(&placements)?;
    let palette = mesher.palette;
    let images = palette.images();
    let pictures = Pictures::read(&images, &document, &buffers, finder, (limits, steps), &mut tally)?;
    palette.paint(&pictures, builder, &document, &mut tally);
    Ok(tally)
}

fn world_from_root(unit: Unit, up: Up) -> DMat4 {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| up.world_from_model(axis) * unit.metres());
    DMat4::from_cols(axes[0].extend(0.0), axes[1].extend(0.0), axes[2].extend(0.0), DVec3::ZERO.extend(1.0))
}

fn check_extensions(
    document: &Document,
    import: &Import,
    builder: &mut SceneBuilder,
) -> Result<(), SceneError> {
    let root = &document.root;
    let all = root.extensions_used.iter().chain(&root.extensions_required);
    if let Some(compressed) = all.clone().find(|e| COMPRESSED.contains(&e.as_str())) {
        return Err(SceneError::Read {
            file: import.path.to_owned(),
            cause: format!("its meshes are compressed ({compressed}), which is not read"),
            remedy: "export it without compression".to_owned(),
        });
    }
    let mut unknown: Vec<String> = all.filter(|e| !KNOWN.contains(&e.as_str())).cloned().collect();
    unknown.sort();
    unknown.dedup();
    if !unknown.is_empty() {
        let message = format!("extensions that are not supported are left out: {}", list(&unknown));
        builder.warn(&import.name, 0, message);
    }
    if !root.animations.is_empty() {
        builder.warn(&import.name, 0, "animations are not played; everything stays where the nodes place it");
    }
    Ok(())
}
