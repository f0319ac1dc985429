//! The OBJ reader: its steps in order.

use super::parse::{self, Model};
use super::{far_uvs, library, smoothing, weld};
use crate::import::units::{self, Unit, Up};
use crate::import::{context::Import, files, text, vertex_colors};
use crate::scene::SceneError;

/// Reads an OBJ file with its libraries and textures.
pub(in crate::import) fn read(import: &mut Import) -> Result<(), SceneError> {
    let limits = &import.options.limits;
    let decoded = text::decode(files::read_in_steps(&import.file, limits.obj_bytes, &import.steps)?);
    if let Some(encoding) = decoded.guessed {
        import.warn(text::guessed(encoding));
    }
    let text = FreedOnAnotherThread(decoded.text);
    let declared_unit = units::declared(&text.0);
    let looks_binary = text.0.contains('\0');
    let mut model = parse::parse(&text.0, import.path, limits, &import.steps)?;
    drop(text);
    place(&mut model, declared_unit, import);
    smoothing::add_normals(&mut model);
    far_uvs::wrap(&mut model);
    let colors = weld::build(&mut model, &mut import.builder, &import.steps)?;
    model.positions = Vec::new(); // gives the memory back before pictures are decoded
    if looks_binary && import.builder.triangles.is_empty() {
        let cause = "this is a binary file, not the text of an OBJ model";
        return Err(import.failed(cause, "export the model as .obj or .glb"));
    }
    import.report(std::mem::take(&mut model.tally))?;
    import.hint_up();
    library::add_materials(&model, import)?;
    vertex_colors::show(&colors, import);
    Ok(())
}

/// Converts positions and normals to world space.
fn place(model: &mut Model, declared: Option<Unit>, import: &mut Import) {
    let unit = import.unit().unwrap_or_else(|| {
        let how = format!("Set it with --unit, or with unit = \"mm\" in {}", import.sidecar.file_name);
        let first_corners = |f: parse::Polygon| [0, 1, 2].map(|i| f.corners[i].position);
        let triangles: Vec<[u32; 3]> = model.faces().map(first_corners).collect();
        let guess = units::guess(declared, units::measure(&model.positions, &triangles), &how);
        if let Some(message) = guess.message {
            import.warn(message);
        }
        guess.unit
    });
    units::to_world(&mut model.positions, &mut model.normals, unit, import.up().unwrap_or(Up::PlusY));
}

/// A file's text. A large one is freed on a thread of its own: freeing a gigabyte takes a tenth of
/// a second, which would delay a cancellation.
struct FreedOnAnotherThread(String);

impl Drop for FreedOnAnotherThread {
    fn drop(&mut self) {
        /// Bytes below which freeing takes milliseconds.
        const LARGE: usize = 64 << 20;
        let text = std::mem::take(&mut self.0);
        if text.len() >= LARGE {
            // Where no thread can be made, the text is freed here.
            let _ = std::thread::Builder::new().name("afterimage-free".to_owned()).spawn(move || drop(text));
        }
    }
}
