//! The materials that the faces of a model name: found in its libraries, interpreted, and given
//! their textures.

use super::interpret::{Habits, interpret};
use super::mtl::{self, MtlMaterial};
use super::parse::Model;
use super::textures::{self, Library};
use crate::import::search::{Finder, Found};
use crate::import::tally::{Tally, list};
use crate::import::text::{self, without_comment};
use crate::import::{context::Import, files, options::Limits, progress::Phase, surfaces, trouble::Trouble};
use crate::scene::SceneError;
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Adds one material per name that the faces of the model use, in the order of the model.
pub(super) fn add_materials(model: &Model, import: &mut Import) -> Result<(), SceneError> {
    let mut shelf = Shelf::read(model, import)?;
    let mut tallies = std::mem::take(&mut shelf.tallies);
    let habits = Habits::of(&shelf.materials);
    let written: Vec<Option<&MtlMaterial>> = model.material_names.iter().map(|n| shelf.find(n)).collect();
    let mut missing = Vec::new();
    for (name, written) in model.material_names.iter().zip(&written) {
        import.builder.add_material(match written {
            Some(m) => interpret(m, &habits, &mut tallies[m.library]),
            None => {
                missing.push(name.clone());
                surfaces::undefined(name)
            }
        });
    }
    let defined = import.sidecar.defined();
    missing.retain(|name| !defined.contains(name.as_str()));
    warn_missing(missing, import);
    for (library, tally) in shelf.libraries.iter().zip(tallies) {
        import.builder.warnings.extend(tally.warnings(&library.shown));
    }
    textures::attach(&written, &shelf.libraries, import)?;
    import.defined_materials = shelf.materials.into_iter().map(|m| m.name).collect();
    Ok(())
}

fn warn_missing(missing: Vec<String>, import: &mut Import) {
    let (unnamed, named): (Vec<String>, Vec<String>) = missing.into_iter().partition(String::is_empty);
    if !named.is_empty() {
        import.warn(format!("no library defines the material {}; shown in neutral grey", list(&named)));
    }
    if !unnamed.is_empty() {
        import.warn("some faces come before any usemtl; they are shown in neutral grey");
    }
}

/// All libraries of a model.
#[derive(Default)]
struct Shelf {
    libraries: Vec<Library>,
    /// Troubles of each library.
    tallies: Vec<Tally>,
    materials: Vec<MtlMaterial>,
    /// Index of a material by its exact name, else by its name without a comment or in lower case.
    /// The first material of a name counts.
    by_name: HashMap<String, usize>,
    /// Number of libraries that were not found.
    missing: usize,
}

/// Maximum number of libraries that are reported as missing with every path tried; others are only
/// counted.
const MAX_MISSING_SHOWN: usize = 20;

impl Shelf {
    fn read(model: &Model, import: &mut Import) -> Result<Self, SceneError> {
        let mut shelf = Self::default();
        // Some exporters write the same line before every object.
        let (mut read, mut seen) = (HashSet::new(), HashSet::new());
        let lines = model.libraries.iter().filter(|(_, operand)| seen.insert(operand.as_str()));
        for (i, (line, operand)) in lines.enumerate() {
            import.steps.at(Phase::Materials, i as f32 / model.libraries.len() as f32)?;
            for name in library_names(operand, &mut import.finder) {
                let found = import.finder.library(&name);
                match &found.file {
                    Some(file) if read.insert(file.clone()) => shelf.add(file, import)?,
                    Some(_) => {}
                    None => shelf.warn_missing(&name, *line, &found, import),
                }
            }
        }
        if shelf.missing > MAX_MISSING_SHOWN {
            let more = shelf.missing - MAX_MISSING_SHOWN;
            import.warn(format!("{more} more material libraries were not found"));
        }
        shelf.index();
        Ok(shelf)
    }

    fn warn_missing(&mut self, name: &str, line: u64, found: &Found, import: &mut Import) {
        self.missing += 1;
        if self.missing <= MAX_MISSING_SHOWN {
            let place = if found.outside { " inside the scene's folder" } else { "" };
            let tried = found.tried.join(", ");
            let message = format!("the material library '{name}' was not found{place}. Tried: {tried}");
            import.builder.warn(&import.name, line, message);
        }
    }

    fn add(&mut self, file: &Path, import: &mut Import) -> Result<(), SceneError> {
        let shown = import.finder.jail.shown(file);
        let (limits, builder) = (&import.options.limits, &mut import.builder);
        let bytes = match files::read_limited(file, limits.mtl_bytes) {
            Ok(bytes) => bytes,
            Err(error) => {
                builder.warn(&shown, 0, format!("the material library is not used: {error}"));
                return Ok(());
            }
        };
        let decoded = text::decode(bytes);
        if let Some(encoding) = decoded.guessed {
            builder.warn(&shown, 0, text::guessed(encoding));
        }
        let mut tally = Tally::default();
        mtl::parse(&decoded.text, self.libraries.len(), &mut self.materials, &mut tally);
        let folder = file.parent().unwrap_or(Path::new("")).to_owned();
        self.libraries.push(Library { shown, folder });
        self.tallies.push(tally);
        let (count, limit) = (self.materials.len(), limits.materials);
        if count > limit {
            return Err(SceneError::TooLarge { name: import.name.clone(), what: "materials", count, limit });
        }
        Ok(())
    }

    fn index(&mut self) {
        for (i, m) in self.materials.iter().enumerate() {
            if self.by_name.contains_key(&m.name) {
                self.tallies[m.library].add(Trouble::MATERIAL_TWICE, m.line, || m.name.clone());
            }
            self.by_name.entry(m.name.clone()).or_insert(i);
        }
        for (i, m) in self.materials.iter().enumerate() {
            self.by_name.entry(without_comment(&m.name).to_owned()).or_insert(i);
            self.by_name.entry(m.name.to_lowercase()).or_insert(i);
        }
    }

    fn find(&self, name: &str) -> Option<&MtlMaterial> {
        let spellings = [name.to_owned(), without_comment(name).to_owned(), name.to_lowercase()];
        let found = spellings.iter().find_map(|s| self.by_name.get(s))?;
        Some(&self.materials[*found]).filter(|m| !m.name.is_empty())
    }
}

/// Returns the file names of a `mtllib` line: one name with spaces where such a file exists, else
/// one per `.mtl` or per quotation.
fn library_names(operand: &str, finder: &mut Finder) -> Vec<String> {
    let whole = text::name(operand);
    if whole.is_empty() {
        return Vec::new();
    }
    let one_quoted = operand.starts_with('"') && operand.matches('"').count() == 2;
    if one_quoted && operand.ends_with('"') || whole == operand && finder.library(whole).file.is_some() {
        return vec![whole.to_owned()];
    }
    let mut names = Vec::new();
    let mut quoted = false;
    for part in without_comment(operand).split('"') {
        if quoted {
            names.push(part.trim().to_owned());
        } else {
            names.extend(unquoted_names(part));
        }
        quoted = !quoted;
    }
    names.retain(|n| !n.is_empty() && n.len() <= Limits::NAME_BYTES);
    names
}

fn unquoted_names(part: &str) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    let mut open = false; // the last name has no extension yet: it contains a blank
    for word in part.split_ascii_whitespace() {
        match names.last_mut() {
            Some(last) if open => {
                last.push(' ');
                last.push_str(word);
            }
            _ => names.push(word.to_owned()),
        }
        open = !word.to_ascii_lowercase().ends_with(".mtl");
    }
    names
}
