//! The materials that a model's faces name: found in its libraries, interpreted, overridden, textured.

use crate::import::materials;
use crate::import::mtl;
use crate::import::mtl::MtlMaterial;
use crate::import::obj::Model;
use crate::import::report::{Tally, list};
use crate::import::search::Finder;
use crate::import::sidecar::Sidecar;
use crate::import::text;
use crate::import::text::without_comment;
use crate::import::textures;
use crate::import::textures::Library;
use crate::import::{Import, Phase, files};
use crate::scene::{Material, SceneBuilder, SceneError};
use glam::Vec3;
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Takes the model; gives the builder one material per name that its faces use, in the model's order.
pub(crate) fn materials(
    model: &Model,
    sidecar: &Sidecar,
    finder: &mut Finder,
    import: &Import,
    builder: &mut SceneBuilder,
) -> Result<(), SceneError> {
    let shelf = Shelf::read(model, finder, import, builder)?;
    let mut tallies = shelf.tallies.clone();
    let distrusted = materials::distrusted(&shelf.materials);
    let written: Vec<Option<&MtlMaterial>> = model.material_names.iter().map(|n| shelf.find(n)).collect();
    let mut missing = Vec::new();
    for (name, written) in model.material_names.iter().zip(&written) {
        let material = match written {
            Some(m) => {
                let mut material = materials::interpret(m, distrusted, &mut tallies[m.library]);
                material.emission = textures::emission_before_texture(m);
                material
            }
            None => {
                missing.push(name.clone());
                Material::diffuse(name, Vec3::splat(materials::NEUTRAL))
            }
        };
        builder.add_material(material);
    }
    let defined = sidecar.defined();
    missing.retain(|name| !defined.contains(name.as_str()));
    warn_missing(&missing, import, builder);
    for (library, tally) in shelf.libraries.iter().zip(tallies) {
        builder.warnings.extend(tally.warnings(&library.shown));
    }
    textures::attach(&written, &shelf.libraries, finder, &import.options.limits, builder, &import.steps)?;
    sidecar.override_materials(&shelf.names(), builder);
    Ok(())
}

fn warn_missing(missing: &[String], import: &Import, builder: &mut SceneBuilder) {
    let (unnamed, named): (Vec<String>, Vec<String>) = missing.iter().cloned().partition(String::is_empty);
    let name = &import.name;
    if !named.is_empty() {
        let message = format!("no library defines the material {}; shown in neutral grey", list(&named));
        builder.warn(name, 0, message);
    }
    if !unnamed.is_empty() {
        builder.warn(name, 0, "some faces come before any usemtl; they are shown in neutral grey");
    }
}

/// All libraries of a model.
struct Shelf {
    libraries: Vec<Library>,
    /// One per library.
    tallies: Vec<Tally>,
    materials: Vec<MtlMaterial>,
    /// Exact names, then names without a comment, then lower-case names: the first that matches counts.
    by_name: HashMap<String, usize>,
    /// Libraries that were not found.
    missing: usize,
}

/// Libraries that were not found, each said with every path tried, before the rest is only counted.
const MISSING_SHOWN: usize = 20;

impl Shelf {
    fn read(
        model: &Model,
        finder: &mut Finder,
        import: &Import,
        builder: &mut SceneBuilder,
    ) -> Result<Self, SceneError> {
        let mut shelf = Self {
            libraries: Vec::new(),
            tallies: Vec::new(),
            materials: Vec::new(),
            by_name: HashMap::new(),
            missing: 0,
        };
        // The same line again, as some exporters write before every object, costs nothing.
        let (mut read, mut seen) = (HashSet::new(), HashSet::new());
        let lines = model.libraries.iter().filter(|(_, operand)| seen.insert(operand.as_str()));
        for (i, (line, operand)) in lines.enumerate() {
            import.steps.at(Phase::Materials, i as f32 / model.libraries.len() as f32)?;
            for name in library_names(operand, finder) {
                let found = finder.library(&name);
                let Some(file) = found.file else {
                    let message = format!(
                        "the material library '{name}' was not found{}. Tried: {}",
                        if found.outside { " inside the scene's folder" } else { "" },
                        found.tried.join(", ")
                    );
                    shelf.missing += 1;
                    if shelf.missing <= MISSING_SHOWN {
                        builder.warn(&import.name, *line, message);
                    }
                    continue;
                };
                if read.insert(file.clone()) {
                    shelf.add(&file, finder, import, builder)?;
                }
            }
        }
        if let Some(more) = shelf.missing.checked_sub(MISSING_SHOWN).filter(|more| *more > 0) {
            builder.warn(&import.name, 0, format!("{more} more material libraries were not found"));
        }
        shelf.index();
        Ok(shelf)
    }

    fn add(
        &mut self,
        file: &Path,
        finder: &Finder,
        import: &Import,
        builder: &mut SceneBuilder,
    ) -> Result<(), SceneError> {
        let shown = finder.jail.shown(file);
        let limits = &import.options.limits;
        let bytes = match files::read_limited(file, limits.mtl_bytes) {
            Ok(bytes) => bytes,
            Err((cause, remedy)) => {
                builder.warn(&shown, 0, format!("the material library is not used: {cause}; {remedy}"));
                return Ok(());
            }
        };
        let decoded = text::decode(bytes);
        if let Some(encoding) = decoded.guessed {
            builder.warn(&shown, 0, format!("the text is not UTF-8; it was read as {encoding}"));
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
                let twice = crate::import::report::Trouble::MATERIAL_TWICE;
                self.tallies[m.library].add(twice, m.line, || m.name.clone());
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

    fn names(&self) -> Vec<&str> {
        self.materials.iter().map(|m| m.name.as_str()).collect()
    }
}

/// The files of a `mtllib` line: one name with spaces where such a file exists, else one per `.mtl` or quotation.
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
    names.retain(|n| !n.is_empty() && n.len() <= crate::import::Limits::NAME_BYTES);
    names
}

fn unquoted_names(part: &str) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    let mut open = false; // the last name has no ending yet: a blank inside it
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
