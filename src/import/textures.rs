//! Textures of materials: found, decoded two at a time within a budget, and hung on the materials.

use crate::import::mtl::{MapSpec, MtlMaterial};
use crate::import::picture;
use crate::import::picture::Picture;
use crate::import::search::{Finder, Found};
use crate::import::text::without_comment;
use crate::import::{Limits, Steps};
use crate::import::{decoding, files};
use crate::scene::{SceneBuilder, SceneError, TextureId, TextureRef};
use glam::Vec3;
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// What a texture is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Purpose {
    Color,
    Coverage,
    Glow,
}

/// A texture that a material asks for.
struct Request<'a> {
    /// Index into the builder's materials.
    material: usize,
    purpose: Purpose,
    spec: &'a MapSpec,
    library: usize,
}

/// A material library, as messages and searches need it.
#[derive(Clone, Debug)]
pub(crate) struct Library {
    pub(crate) shown: String,
    pub(crate) folder: PathBuf,
}

/// Takes the materials as written, beside those of the builder with the same index (`None` where the library does not
/// define it); adds their textures to the builder.
pub(crate) fn attach(
    written: &[Option<&MtlMaterial>],
    libraries: &[Library],
    finder: &mut Finder,
    limits: &Limits,
    builder: &mut SceneBuilder,
    steps: &Steps,
) -> Result<(), SceneError> {
    let requests = requests(written);
    let mut hanger = Hanger { libraries, builder, decoded: HashMap::new(), checker: None, missing: 0 };
    let mut file_of: HashMap<(&str, usize), Option<PathBuf>> = HashMap::new();
    for request in &requests {
        let key = (request.spec.file.as_str(), request.library);
        file_of.entry(key).or_insert_with(|| {
            let found = find(finder, request.spec, &libraries[request.library].folder);
            if found.file.is_none() {
                hanger.warn_missing(request, &found);
            }
            found.file
        });
    }
    if hanger.missing > MISSING_SAID {
        let message = format!("{} textures in all were not found", hanger.missing);
        hanger.builder.warn(&libraries[requests[0].library].shown, 0, message);
    }
    let files: Vec<Option<&PathBuf>> =
        requests.iter().map(|r| file_of[&(r.spec.file.as_str(), r.library)].as_ref()).collect();
    hanger.decoded = decode_all(&files, limits, steps)?;
    for (request, file) in requests.iter().zip(files) {
        hanger.hang(request, file.map(PathBuf::as_path));
    }
    Ok(())
}

fn requests<'a>(written: &[Option<&'a MtlMaterial>]) -> Vec<Request<'a>> {
    let of_material = |(material, m): (usize, &Option<&'a MtlMaterial>)| {
        let m = (*m)?;
        let maps = [
            (Purpose::Color, &m.map_diffuse),
            (Purpose::Coverage, &m.map_opacity),
            (Purpose::Glow, &m.map_emission),
        ];
        Some(maps.into_iter().filter_map(move |(purpose, spec)| {
            Some(Request { material, purpose, spec: spec.as_ref()?, library: m.library })
        }))
    };
    written.iter().enumerate().filter_map(of_material).flatten().collect()
}

fn find(finder: &mut Finder, spec: &MapSpec, folder: &Path) -> Found {
    let found = finder.texture(&spec.file, folder);
    let shorter = without_comment(&spec.file);
    if found.file.is_none() && shorter != spec.file {
        return finder.texture(shorter, folder);
    }
    found
}

/// A decoded picture, and the textures made from it so far.
struct Decoded {
    picture: Result<Picture, String>,
    color: Option<TextureId>,
    coverage: Option<TextureId>,
    reported: bool,
}

fn decode_all(
    wanted: &[Option<&PathBuf>],
    limits: &Limits,
    steps: &Steps,
) -> Result<HashMap<PathBuf, Decoded>, SceneError> {
    let mut unique: Vec<&PathBuf> = wanted.iter().flatten().copied().collect();
    unique.sort();
    unique.dedup();
    let read = |i: usize| {
        let path: &Path = unique[i];
        let bytes = files::read_limited(path, limits.texture_bytes).map_err(|(cause, _)| cause)?;
        Ok((bytes.into(), path))
    };
    let pictures = decoding::decode_all(unique.len(), limits, steps, read)?;
    let fresh = |picture| Decoded { picture, color: None, coverage: None, reported: false };
    Ok(unique.into_iter().cloned().zip(pictures.into_iter().map(fresh)).collect())
}

/// Hangs decoded pictures on materials.
struct Hanger<'a> {
    libraries: &'a [Library],
    builder: &'a mut SceneBuilder,
    decoded: HashMap<PathBuf, Decoded>,
    checker: Option<TextureId>,
    /// Textures that were not found.
    missing: usize,
}

/// Textures that were not found, each said with every path tried, before the rest is only counted.
const MISSING_SAID: usize = 100;

impl Hanger<'_> {
    fn warn_missing(&mut self, request: &Request, found: &Found) {
        self.missing += 1;
        if self.missing > MISSING_SAID {
            return;
        }
        let Request { purpose, spec, material, library } = request;
        let material = &self.builder.materials[*material].name;
        let outside = if found.outside {
            ". Files outside the scene's folder are opened only when that is allowed"
        } else {
            ""
        };
        let message = format!(
            "texture '{}' of material '{material}' was not found; {}. Tried: {}{outside}",
            spec.file,
            instead(*purpose),
            found.tried.join(", ")
        );
        self.builder.warn(&self.libraries[*library].shown, spec.line, message);
    }

    fn hang(&mut self, request: &Request, file: Option<&Path>) {
        let mut decoded = file.and_then(|f| self.decoded.remove_entry(f));
        match &mut decoded {
            Some((_, Decoded { picture: Ok(picture), color, coverage, .. })) => {
                self.hang_picture(request, picture, color, coverage);
            }
            Some((path, Decoded { picture: Err(cause), reported, .. })) => {
                if !std::mem::replace(reported, true) {
                    self.warn_unreadable(request, path, cause);
                }
                self.hang_checker(request);
            }
            None => self.hang_checker(request),
        }
        self.decoded.extend(decoded);
    }

    fn hang_picture(
        &mut self,
        request: &Request,
        picture: &Picture,
        color: &mut Option<TextureId>,
        coverage: &mut Option<TextureId>,
    ) {
        let mut with = |slot: &mut Option<TextureId>, make: &dyn Fn() -> crate::scene::Texture| {
            let texture = *slot.get_or_insert_with(|| self.builder.add_texture(make()));
            TextureRef { texture, scale: request.spec.scale, offset: request.spec.offset }
        };
        let as_it_is = || picture.texture.clone();
        match request.purpose {
            Purpose::Color => {
                let texture = with(color, &as_it_is);
                self.builder.materials[request.material].diffuse_texture = Some(texture);
            }
            Purpose::Coverage => {
                let texture = if picture.alpha_varies {
                    with(color, &as_it_is)
                } else {
                    with(coverage, &|| picture::coverage(&picture.texture))
                };
                self.builder.materials[request.material].alpha_texture = Some(texture);
            }
            Purpose::Glow => {
                self.builder.materials[request.material].emission *= picture::mean_color(&picture.texture);
            }
        }
    }

    fn warn_unreadable(&mut self, request: &Request, path: &Path, cause: &str) {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let message = format!("texture '{name}' cannot be used: {cause}; {}", instead(request.purpose));
        self.builder.warn(&self.libraries[request.library].shown, request.spec.line, message);
    }

    fn hang_checker(&mut self, request: &Request) {
        if request.purpose != Purpose::Color {
            return;
        }
        let builder = &mut *self.builder;
        let checker = *self.checker.get_or_insert_with(|| builder.add_texture(picture::checker()));
        builder.materials[request.material].diffuse_texture = Some(TextureRef::plain(checker));
    }
}

fn instead(purpose: Purpose) -> &'static str {
    match purpose {
        Purpose::Color => "a magenta checker is shown instead",
        Purpose::Coverage => "the surface is shown without holes",
        Purpose::Glow => "the surface glows evenly",
    }
}

/// What a material emits before its texture is known: with a texture alone, the texture's colours.
pub(crate) fn emission_before_texture(m: &MtlMaterial) -> Vec3 {
    m.emission.unwrap_or(if m.map_emission.is_some() { Vec3::ONE } else { Vec3::ZERO })
}
