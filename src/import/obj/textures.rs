//! Textures of OBJ materials: found, decoded, and assigned to the materials.

use super::mtl::{MapSpec, MtlMaterial};
use crate::import::picture::{self, Picture, PictureError};
use crate::import::search::{Finder, Found};
use crate::import::{
    context::Import, decoding, files, options::Limits, progress::Phase, progress::Steps, surfaces,
    text::without_comment,
};
use crate::scene::{NormalMap, SceneBuilder, SceneError, Texture, TextureId, TextureRef};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// Number of textures that are searched between two checks for a cancellation. One that is missing
/// takes about a millisecond.
const SEARCHED: usize = 16;

/// Use of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Purpose {
    Color,
    Coverage,
    Glow,
    Roughness,
    Metalness,
    /// Heights or directions.
    Bump,
    Normal,
}

/// A texture that a material names.
struct Request<'a> {
    /// Index of the material in the builder.
    material: usize,
    purpose: Purpose,
    spec: &'a MapSpec,
    library: usize,
    /// The material has a picture of its coverage.
    has_coverage: bool,
}

/// A material library: what messages and searches need of it.
#[derive(Clone, Debug)]
pub(super) struct Library {
    /// Path for messages.
    pub(super) shown: String,
    pub(super) folder: PathBuf,
}

/// Adds the textures of materials as written, which have the indices of the builder's materials.
/// `None` stands for a material that no library defines.
pub(super) fn attach(
    written: &[Option<&MtlMaterial>],
    libraries: &[Library],
    import: &mut Import,
) -> Result<(), SceneError> {
    let Import { finder, builder, options, steps, .. } = import;
    let requests = requests(written);
    let (decoded, reliefs) = (HashMap::new(), HashSet::new());
    let mut painter = Painter { libraries, builder, decoded, checker: None, reliefs, missing: 0 };
    let mut file_of: HashMap<(&str, usize), Option<PathBuf>> = HashMap::new();
    for (i, request) in requests.iter().enumerate() {
        if i % SEARCHED == 0 {
            steps.at(Phase::Textures, 0.0)?;
        }
        let key = (request.spec.file.as_str(), request.library);
        file_of.entry(key).or_insert_with(|| {
            let found = find(finder, request.spec, &libraries[request.library].folder);
            if found.file.is_none() {
                painter.warn_missing(request, &found);
            }
            found.file
        });
    }
    if painter.missing > MAX_MISSING_SHOWN {
        let message = format!("{} textures in all were not found", painter.missing);
        painter.builder.warn(&libraries[requests[0].library].shown, 0, message);
    }
    let files: Vec<Option<&PathBuf>> =
        requests.iter().map(|r| file_of[&(r.spec.file.as_str(), r.library)].as_ref()).collect();
    painter.decoded = decode_all(&files, &options.limits, steps)?;
    for (request, file) in requests.iter().zip(files) {
        painter.assign(request, file.map(PathBuf::as_path));
    }
    let has_gloss = |r: &&Request| matches!(r.purpose, Purpose::Roughness | Purpose::Metalness);
    for request in requests.iter().filter(has_gloss) {
        surfaces::settle(&mut painter.builder.materials[request.material]);
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
            (Purpose::Roughness, &m.map_roughness),
            (Purpose::Metalness, &m.map_metallic),
            (Purpose::Bump, if m.map_normal.is_some() { &None } else { &m.map_bump }),
            (Purpose::Normal, &m.map_normal),
        ];
        Some(maps.into_iter().filter_map(move |(purpose, spec)| {
            let has_coverage = m.map_opacity.is_some();
            Some(Request { material, purpose, spec: spec.as_ref()?, library: m.library, has_coverage })
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

/// A decoded picture, and the textures that were made from it.
struct Decoded {
    picture: Result<Picture, PictureError>,
    color: Option<TextureId>,
    coverage: Option<TextureId>,
    /// Directions made of heights.
    relief: Option<TextureId>,
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
        let bytes = files::read_limited(path, limits.texture_bytes)
            .map_err(|error| PictureError::Unreadable(error.cause))?;
        Ok((bytes.into(), path))
    };
    let pictures = decoding::decode_all(unique.len(), limits, steps, read)?;
    let fresh = |picture| Decoded { picture, color: None, coverage: None, relief: None, reported: false };
    Ok(unique.into_iter().cloned().zip(pictures.into_iter().map(fresh)).collect())
}

/// Assigns decoded pictures to materials.
struct Painter<'a> {
    libraries: &'a [Library],
    builder: &'a mut SceneBuilder,
    decoded: HashMap<PathBuf, Decoded>,
    checker: Option<TextureId>,
    /// Bump pictures that were reported.
    reliefs: HashSet<String>,
    /// Number of textures that were not found.
    missing: usize,
}

/// Maximum number of textures that are reported as missing with every path tried; others are only
/// counted.
const MAX_MISSING_SHOWN: usize = 100;

impl Painter<'_> {
    fn warn_missing(&mut self, request: &Request, found: &Found) {
        self.missing += 1;
        if self.missing > MAX_MISSING_SHOWN {
            return;
        }
        let Request { purpose, spec, material, library, .. } = request;
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

    fn assign(&mut self, request: &Request, file: Option<&Path>) {
        let mut decoded = file.and_then(|f| self.decoded.remove_entry(f));
        match &mut decoded {
            Some((_, Decoded { picture: Ok(picture), color, coverage, relief, .. })) => {
                self.assign_picture(request, picture, [color, coverage, relief]);
            }
            Some((path, Decoded { picture: Err(cause), reported, .. })) => {
                if !std::mem::replace(reported, true) {
                    self.warn_unreadable(request, path, cause);
                }
                self.assign_checker(request);
            }
            None => self.assign_checker(request),
        }
        self.decoded.extend(decoded);
    }

    fn assign_picture(
        &mut self,
        request: &Request,
        picture: &Picture,
        [color, coverage, relief]: [&mut Option<TextureId>; 3],
    ) {
        let mut with = |slot: &mut Option<TextureId>, make: &dyn Fn() -> Texture| {
            let texture = *slot.get_or_insert_with(|| self.builder.add_texture(make()));
            let spec = request.spec;
            TextureRef { sampling: spec.sampling, ..TextureRef::new(texture, spec.scale, spec.offset) }
        };
        let as_it_is = || picture.texture.clone();
        match request.purpose {
            Purpose::Color => {
                let texture = with(color, &as_it_is);
                self.builder.materials[request.material].diffuse_texture = Some(texture);
                if picture.alpha_varies && !request.has_coverage {
                    surfaces::cover(&mut self.builder.materials[request.material], texture, picture);
                }
            }
            Purpose::Coverage => {
                let texture = if picture.alpha_varies {
                    with(color, &as_it_is)
                } else {
                    with(coverage, &|| picture::coverage(&picture.texture))
                };
                let covering = match picture.alpha_varies {
                    true => picture::is_translucent(picture.texture.texels.iter().map(|t| t[3])),
                    false => picture::is_translucent(picture.texture.texels.iter().map(picture::luma)),
                };
                let material = &mut self.builder.materials[request.material];
                surfaces::cover_with(material, texture, covering);
            }
            Purpose::Glow => {
                let texture = with(color, &as_it_is);
                self.builder.materials[request.material].emission_texture = Some(texture);
            }
            Purpose::Roughness | Purpose::Metalness => {
                let texture = with(color, &as_it_is);
                let material = &mut self.builder.materials[request.material];
                match request.purpose {
                    Purpose::Metalness => material.detail.metalness_texture = Some(texture),
                    _ => surfaces::roughen(material, texture, picture),
                }
            }
            Purpose::Bump | Purpose::Normal => {
                let is_map = request.purpose == Purpose::Normal || picture::holds_normals(&picture.texture);
                let texture = match is_map {
                    true => with(color, &as_it_is),
                    false => with(relief, &|| picture::normals_of_heights(&picture.texture)),
                };
                let material = &mut self.builder.materials[request.material];
                material.detail.normal = Some(NormalMap { texture, strength: request.spec.strength });
                if request.purpose == Purpose::Bump {
                    self.note_relief(request, is_map);
                }
            }
        }
    }

    /// Reports once for each picture what a `bump` was taken for.
    fn note_relief(&mut self, request: &Request, is_map: bool) {
        if self.reliefs.insert(request.spec.file.clone()) {
            let read = if is_map { "bluish: read as a normal map" } else { "grey: read as heights" };
            let message = format!("bump picture '{}' is {read}", request.spec.file);
            self.builder.warn(&self.libraries[request.library].shown, request.spec.line, message);
        }
    }

    fn warn_unreadable(&mut self, request: &Request, path: &Path, cause: &PictureError) {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let message = format!("texture '{name}' cannot be used: {cause}; {}", instead(request.purpose));
        self.builder.warn(&self.libraries[request.library].shown, request.spec.line, message);
    }

    fn assign_checker(&mut self, request: &Request) {
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
        Purpose::Roughness | Purpose::Metalness => "the surface reflects evenly",
        Purpose::Bump | Purpose::Normal => "the surface is shown smooth",
    }
}
