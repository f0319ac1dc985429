//! Reading models. OBJ: decode -> repair -> OBJ -> MTL -> textures -> welded triangles -> report, a file a step; glTF:
//! the folder `gltf`, with the same limits, jail, pictures and report.
//!
//! What a file leaves open or gets wrong never stops the import: it is counted, named with its line, and said. What
//! leaves nothing to show is an error that names file, line, cause and remedy.

mod decoding;
mod files;
mod gltf;
mod library;
mod materials;
mod mtl;
mod obj;
mod obj_piece;
mod picture;
mod polygon;
mod report;
mod search;
mod sidecar;
mod sidecar_edit;
mod sidecar_table;
mod text;
mod textures;
mod units;
mod weld;

pub use sidecar_edit::save_look_beside;
pub use units::{Unit, Up};

use crate::scene::{Scene, SceneBuilder, SceneError};
use files::Jail;
use search::Finder;
use sidecar::Sidecar;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

/// How to read a model. The default asks the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportOptions {
    /// Length unit; `None`: the scene's `.afterimage.toml`, else the file's header, else a guess.
    pub unit: Option<Unit>,
    /// Up axis; `None`: the scene's `.afterimage.toml`, else +Y.
    pub up: Option<Up>,
    /// Lets the model open textures and libraries outside its own folder.
    pub allow_outside: bool,
    /// Sizes beyond which a file is refused.
    pub limits: Limits,
}

/// Sizes beyond which a file is refused rather than read.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// Of an OBJ file.
    pub obj_bytes: u64,
    /// Of a glTF file.
    pub gltf_bytes: u64,
    /// Of all buffers that a glTF file names, together.
    pub buffers_bytes: u64,
    /// Vertices, and triangles, of a glTF file with every mesh at every place it has: a few bytes can ask for a
    /// million copies.
    pub gltf_vertices: usize,
    /// Of one material library.
    pub mtl_bytes: u64,
    /// Of all materials together.
    pub materials: usize,
    /// Corners of all faces together.
    pub corners: usize,
    /// Texels on a side of a picture.
    pub texture_side: u32,
    /// Of one picture, as a file and decoded.
    pub texture_bytes: u64,
    /// Of all pictures together, decoded.
    pub textures_bytes: u64,
}

impl Limits {
    /// Longest name of a material or a file.
    pub const NAME_BYTES: usize = 4096;
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            obj_bytes: 4 << 30,
            gltf_bytes: 4 << 30,
            buffers_bytes: 4 << 30,
            gltf_vertices: 50_000_000,
            mtl_bytes: 16 << 20,
            materials: 1_000_000,
            corners: 1_000_000_000,
            texture_side: 16_384,
            texture_bytes: 256 << 20,
            textures_bytes: 2 << 30,
        }
    }
}

/// What the importer is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Phase {
    /// Fetching the file.
    Reading,
    /// Understanding its lines.
    Parsing,
    /// Reading material libraries.
    Materials,
    /// Decoding pictures.
    Textures,
    /// Making triangles.
    Building,
}

impl Phase {
    /// For people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Reading => "reading the file",
            Self::Parsing => "understanding the model",
            Self::Materials => "reading materials",
            Self::Textures => "decoding textures",
            Self::Building => "building triangles",
        }
    }
}

/// Told how far each phase is, 0..1, from any thread; returns false to cancel.
pub type Progress<'a> = &'a (dyn Fn(Phase, f32) -> bool + Sync);

/// Where the pipeline reports, and learns that nobody waits any more.
struct Steps<'a> {
    progress: Progress<'a>,
}

impl Steps<'_> {
    fn at(&self, phase: Phase, fraction: f32) -> Result<(), SceneError> {
        if (self.progress)(phase, fraction.clamp(0.0, 1.0)) { Ok(()) } else { Err(SceneError::Cancelled) }
    }
}

/// Reads an OBJ or glTF file with everything that belongs to it.
///
/// # Errors
/// [`SceneError::Read`], [`SceneError::Line`] or [`SceneError::TooLarge`] where nothing can be shown,
/// [`SceneError::Cancelled`] where `progress` said so.
pub fn load(path: &Path, options: &ImportOptions, progress: Progress) -> Result<Scene, SceneError> {
    let import = || Import::new(path, options, Steps { progress })?.run();
    catch_unwind(AssertUnwindSafe(import)).unwrap_or_else(|_| {
        Err(SceneError::Read {
            file: path.to_owned(),
            cause: "the importer failed on it".to_owned(),
            remedy: "please report this file".to_owned(),
        })
    })
}

/// A file's text, freed by a thread of its own: giving back a gigabyte takes a tenth of a second, which nobody who cancels
/// is to wait for.
struct FreedAside(String);

impl Drop for FreedAside {
    fn drop(&mut self) {
        /// Less is given back in milliseconds.
        const LARGE: usize = 64 << 20;
        let text = std::mem::take(&mut self.0);
        if text.len() < LARGE {
            return;
        }
        // Where there is no thread it is freed here.
        let _ = std::thread::Builder::new().name("afterimage-free".to_owned()).spawn(move || drop(text));
    }
}

/// The kinds of files that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    Obj,
    Gltf,
}

impl Format {
    fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "obj" => Some(Self::Obj),
            "gltf" | "glb" => Some(Self::Gltf),
            _ => None,
        }
    }
}

/// The endings of the files that [`load`] reads.
pub const EXTENSIONS: [&str; 3] = ["obj", "gltf", "glb"];

/// One import under way.
struct Import<'a> {
    /// As the user named it, for messages.
    path: &'a Path,
    /// Canonical.
    file: PathBuf,
    /// File name with extension: the scene's name, and the file of warnings about the model.
    name: String,
    format: Format,
    options: &'a ImportOptions,
    steps: Steps<'a>,
}

impl<'a> Import<'a> {
    fn new(path: &'a Path, options: &'a ImportOptions, steps: Steps<'a>) -> Result<Self, SceneError> {
        let failed = |cause: String, remedy: &str| SceneError::Read {
            file: path.to_owned(),
            cause,
            remedy: remedy.to_owned(),
        };
        let file = path.canonicalize().map_err(|e| failed(e.to_string(), "check the path"))?;
        if file.is_dir() {
            return Err(failed("this is a folder".to_owned(), "name the OBJ file in it"));
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let Some(format) = Format::of(path) else {
            let remedy = "export the model as .glb, .gltf or .obj";
            return Err(failed("only OBJ and glTF files are read".to_owned(), remedy));
        };
        Ok(Self { path, file, name, format, options, steps })
    }

    fn run(&self) -> Result<Scene, SceneError> {
        let mut builder = SceneBuilder::new(&self.name);
        let sidecar = Sidecar::beside(self.path, &mut builder);
        let folder = self.file.parent().unwrap_or(Path::new("")).to_owned();
        let mut finder = Finder::new(Jail { folder, allow_outside: self.options.allow_outside });
        match self.format {
            Format::Obj => self.obj(&sidecar, &mut finder, &mut builder)?,
            Format::Gltf => self.gltf(&sidecar, &mut finder, &mut builder)?,
        }
        sidecar.apply(&mut builder);
        self.steps.at(Phase::Building, 1.0)?;
        self.finish(builder)
    }

    fn obj(
        &self,
        sidecar: &Sidecar,
        finder: &mut Finder,
        builder: &mut SceneBuilder,
    ) -> Result<(), SceneError> {
        let limits = &self.options.limits;
        let bytes = files::read_in_steps(&self.file, limits.obj_bytes, &self.steps)?;
        let decoded = text::decode(bytes);
        if let Some(encoding) = decoded.guessed {
            builder.warn(&self.name, 0, format!("the text is not UTF-8; it was read as {encoding}"));
        }
        let text = FreedAside(decoded.text);
        let declared_unit = units::declared(&text.0);
        let looks_binary = text.0.contains('\0');
        let mut model = obj::parse(&text.0, self.path, limits, &self.steps)?;
        drop(text);
        let positions_m = self.place(&mut model, sidecar, declared_unit, builder);
        weld::build(&mut model, &positions_m, builder, &self.steps)?;
        drop(positions_m);
        let doubts = std::mem::take(&mut model.tally).warnings(&self.name);
        if builder.triangles.is_empty() {
            return Err(self.nothing_left(doubts.into_iter().next(), looks_binary));
        }
        builder.warnings.extend(doubts);
        self.hint_up(sidecar, builder);
        library::materials(&model, sidecar, finder, self, builder)
    }

    fn gltf(
        &self,
        sidecar: &Sidecar,
        finder: &mut Finder,
        builder: &mut SceneBuilder,
    ) -> Result<(), SceneError> {
        let unit = self.options.unit.or(sidecar.unit).unwrap_or(Unit::Metre);
        let up = self.options.up.or(sidecar.up).unwrap_or(Up::PlusY);
        let doubts = gltf::read(self, unit, up, finder, builder)?.warnings(&self.name);
        if builder.triangles.is_empty() {
            return Err(self.nothing_left(doubts.into_iter().next(), false));
        }
        builder.warnings.extend(doubts);
        sidecar.override_materials(&[], builder);
        Ok(())
    }

    /// Unit and up axis; positions in world metres.
    fn place(
        &self,
        model: &mut obj::Model,
        sidecar: &Sidecar,
        declared: Option<Unit>,
        builder: &mut SceneBuilder,
    ) -> Vec<glam::DVec3> {
        let unit = self.options.unit.or(sidecar.unit).unwrap_or_else(|| {
            let how = format!("Set it with --unit, or with unit = \"mm\" in {}", sidecar.file_name);
            let guess = units::guess(declared, units::across(model), &how);
            if let Some(said) = guess.said {
                builder.warn(&self.name, 0, said);
            }
            guess.unit
        });
        units::to_world(model, unit, self.options.up.or(sidecar.up).unwrap_or(Up::PlusY))
    }

    fn hint_up(&self, sidecar: &Sidecar, builder: &mut SceneBuilder) {
        let given = self.options.up.or(sidecar.up).is_some();
        if !given && units::looks_z_up(&builder.positions, &builder.triangles) {
            let message = format!(
                "the model seems to lie on its side; if so, use --up +Z, or up = \"+Z\" in {}",
                sidecar.file_name
            );
            builder.warn(&self.name, 0, message);
        }
    }

    /// The error for a file without a single triangle: its first trouble, where it has one.
    fn nothing_left(&self, first: Option<crate::scene::Warning>, looks_binary: bool) -> SceneError {
        let file = self.path.to_owned();
        let unreadable = |cause: String, remedy: &str| SceneError::Read {
            file: file.clone(),
            cause,
            remedy: remedy.to_owned(),
        };
        match first {
            _ if looks_binary => unreadable(
                "this is a binary file, not the text of an OBJ model".to_owned(),
                "export the model as .obj or .glb",
            ),
            Some(first) if first.line > 0 => SceneError::Line {
                file,
                line: first.line,
                cause: format!("no face is left to show: {}", first.message),
                remedy: "correct the file or export it again".to_owned(),
            },
            Some(first) => unreadable(
                format!("no face is left to show: {}", first.message),
                "correct the file or export it again",
            ),
            None => unreadable("it holds no faces".to_owned(), "check that it is a whole model"),
        }
    }

    fn finish(&self, builder: SceneBuilder) -> Result<Scene, SceneError> {
        let triangles = builder.triangles.len();
        builder.finish().map_err(|error| match error {
            SceneError::Empty { .. } => SceneError::Read {
                file: self.path.to_owned(),
                cause: format!("none of its {triangles} triangles has an area"),
                remedy: "correct the file or export it again".to_owned(),
            },
            other => other,
        })
    }
}
