//! Reading the sidecar of a model: what the model cannot express, or expresses wrongly.
//! Lengths are metres, coordinates are world space.
//!
//! A broken sidecar is a warning: the model is shown without it.

use super::ground::{self, GroundLine};
use super::lamps::{self, Lamp};
use super::light::Light;
use super::lights::Lights;
use super::objects::{self, ObjectLine};
use super::table::{Notes, Section, suggestion};
use crate::camera::{Camera, CameraKey, CameraPath};
use crate::import::surfaces::{COAT, DEFAULT_ROUGHNESS};
use crate::import::units::{Unit, UnknownWord, Up};
use crate::import::{files, options::Limits, search::Finder, text};
use crate::scene::{Material, MaterialKind, NamedView, ObjectEdit, ObjectKey, Scene, SceneBuilder};
use glam::Vec3;
use std::collections::{HashMap, HashSet};
use std::path::Path;
use toml::de::DeTable;

/// Maximum size of a sidecar in bytes; files written by hand are far smaller.
pub(super) const MAX_BYTES: u64 = 16 << 20;

/// A `[[material]]`: the parts of a material that the file replaces.
struct Override {
    name: String,
    /// Which of several materials of this name, counted from 1; `None` for all of them.
    number: Option<usize>,
    line: u64,
    kind: Option<Kind>,
    fresnel: Option<bool>,
    diffuse: Option<Vec3>,
    reflectance: Option<Vec3>,
    eta: Option<f32>,
    transmittance: Option<Vec3>,
    roughness: Option<f32>,
    emission: Option<Vec3>,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Diffuse,
    Mirror,
    Glass,
    Glossy,
    Frosted,
}

impl std::str::FromStr for Kind {
    type Err = UnknownWord;

    fn from_str(text: &str) -> Result<Self, UnknownWord> {
        match text {
            "diffuse" => Ok(Self::Diffuse),
            "mirror" => Ok(Self::Mirror),
            "glass" => Ok(Self::Glass),
            "glossy" => Ok(Self::Glossy),
            "frosted" => Ok(Self::Frosted),
            _ => {
                let known = "diffuse, mirror, glass, glossy, frosted";
                Err(UnknownWord::new(text, "a kind of material", known))
            }
        }
    }
}

/// Contents of a sidecar; empty where there is none.
#[derive(Default)]
pub(in crate::import) struct Sidecar {
    /// Name of the file, whether it exists or not: messages say where a setting belongs.
    pub(in crate::import) file_name: String,
    pub(in crate::import) unit: Option<Unit>,
    pub(in crate::import) up: Option<Up>,
    overrides: Vec<Override>,
    objects: Vec<ObjectLine>,
    lamps: Vec<Lamp>,
    light: Light,
    lights: Lights,
    pub(super) ground: Option<GroundLine>,
    start: Option<Camera>,
    views: Vec<NamedView>,
    walk: Option<CameraPath>,
}

impl Sidecar {
    /// Reads the sidecar of a model, where there is one.
    pub(in crate::import) fn of_model(model: &Path, builder: &mut SceneBuilder) -> Self {
        let path = model.with_extension("afterimage.toml");
        let file_name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let nothing = Self { file_name: file_name.clone(), ..Self::default() };
        if path.symlink_metadata().is_err() {
            return nothing;
        }
        let bytes = match files::read_limited(&path, MAX_BYTES) {
            Ok(bytes) => bytes,
            Err(error) => {
                builder.warn(&file_name, 0, format!("the file is not used: {error}"));
                return nothing;
            }
        };
        let text = text::decode(bytes).text;
        let mut notes = Notes::new(&text);
        let sidecar = match DeTable::parse(&text) {
            Ok(table) => Self { file_name, ..Self::of(table.get_ref(), &mut notes) },
            Err(error) => {
                let at = error.span().map_or(0, |s| s.start);
                let message = format!("{}; the scene is shown without this file", error.message());
                notes.add(at, message.replace('\n', ", "));
                nothing
            }
        };
        for (line, message) in notes.messages {
            builder.warn(&sidecar.file_name, line, message);
        }
        if notes.more > 0 {
            builder.warn(&sidecar.file_name, 0, format!("and {} more problems", notes.more));
        }
        sidecar
    }

    pub(super) fn of(table: &DeTable, notes: &mut Notes) -> Self {
        let known = [
            "unit",
            "up",
            "material",
            "object",
            "point_light",
            "sun",
            "sky",
            "lights",
            "ground",
            "start",
            "walk",
            "view",
            "settings",
        ];
        let top = Section::new(table, "", 0, &known, notes);
        Self {
            file_name: String::new(),
            unit: top.word("unit", notes),
            up: top.word("up", notes),
            overrides: overrides(&top, notes),
            objects: objects::read(&top, notes),
            lamps: lamps::read(&top, notes),
            light: Light::read(&top, notes),
            lights: Lights::read(&top, notes),
            ground: ground::read(&top, notes),
            start: start(&top, notes),
            views: views(&top, notes),
            walk: walk(&top, notes),
        }
    }

    /// Returns the names of the materials that the file describes, which no library needs to
    /// define.
    pub(in crate::import) fn defined(&self) -> HashSet<&str> {
        self.overrides.iter().map(|o| o.name.as_str()).collect()
    }

    /// Overrides materials of the builder. `defined` are names of materials that may exist without
    /// being used.
    pub(in crate::import) fn override_materials(&self, defined: &[String], builder: &mut SceneBuilder) {
        /// Maximum number of unknown materials that are reported with a suggestion; others are only
        /// counted.
        const MAX_UNKNOWN_SHOWN: usize = 20;
        let defined: HashSet<&str> = defined.iter().map(String::as_str).collect();
        let mut by_name: HashMap<String, Vec<usize>> = HashMap::new();
        for (i, m) in builder.materials.iter().enumerate() {
            by_name.entry(m.name.clone()).or_default().push(i);
        }
        let (mut warnings, mut unknown) = (Vec::new(), 0);
        // What is said of one material counts more than what is said of all of its name.
        let (of_all, of_one): (Vec<_>, Vec<_>) = self.overrides.iter().partition(|o| o.number.is_none());
        for o in of_all.into_iter().chain(of_one) {
            let mut found = o.number.is_none() && defined.contains(o.name.as_str());
            for &i in o.chosen(by_name.get(&o.name).map_or(&[], Vec::as_slice)) {
                let material = &mut builder.materials[i];
                found = true;
                o.apply(material);
                if material.scale_to_conserve() {
                    let name = &o.name;
                    let message =
                        format!("material '{name}' reflects more light than arrives; it was scaled down");
                    warnings.push((o.line, message));
                }
            }
            unknown += usize::from(!found);
            if !found && unknown <= MAX_UNKNOWN_SHOWN {
                let names: Vec<&str> = builder.materials.iter().map(|m| m.name.as_str()).collect();
                let help = suggestion(&o.name, &names);
                let number = o.number.map_or_else(String::new, |number| format!(" number {number}"));
                warnings.push((o.line, format!("the model has no material '{}'{number}; {help}", o.name)));
            }
        }
        if unknown > MAX_UNKNOWN_SHOWN {
            warnings.push((0, format!("{unknown} materials in all are not in the model")));
        }
        for (line, message) in warnings {
            builder.warn(&self.file_name, line, message);
        }
    }

    /// Moves, hides and deletes objects of the finished scene.
    pub(in crate::import) fn edit_objects(&mut self, scene: Scene) -> Scene {
        let scene = objects::apply(std::mem::take(&mut self.objects), &self.file_name, scene);
        ground::apply(self.ground, scene)
    }

    /// Returns the changes of objects, in the order of the file.
    pub(super) fn take_objects(&mut self) -> impl Iterator<Item = (ObjectKey, ObjectEdit)> {
        std::mem::take(&mut self.objects).into_iter().map(ObjectLine::into_edit)
    }

    /// Sets groups of lights, sun and sky.
    pub(super) fn apply_light(&mut self, finder: &mut Finder, builder: &mut SceneBuilder) {
        std::mem::take(&mut self.lights).apply(builder);
        std::mem::take(&mut self.light).apply(&self.file_name, finder, builder);
    }

    /// Adds lights, sky, views and walk.
    pub(in crate::import) fn apply(&mut self, finder: &mut Finder, builder: &mut SceneBuilder) {
        lamps::apply(std::mem::take(&mut self.lamps), &self.file_name, finder, builder);
        self.apply_light(finder, builder);
        // The first frame of a walk is a better start than a view of the whole model from outside.
        let start = self.start.or_else(|| self.walk.as_ref()?.camera(0, 2));
        let of_model = std::mem::take(&mut builder.views);
        builder.views.extend(start.map(|camera| NamedView { name: "start".to_owned(), camera }));
        builder.views.append(&mut self.views);
        builder.views.extend(of_model);
        builder.walk = self.walk.take();
    }
}

impl Override {
    /// Returns those of all materials of this name that are meant.
    fn chosen<'a>(&self, of_name: &'a [usize]) -> &'a [usize] {
        match self.number {
            None => of_name,
            Some(number) => of_name.get(number - 1..number).unwrap_or(&[]),
        }
    }

    fn apply(&self, material: &mut Material) {
        let was = material.kind;
        material.kind = self.kind_after(was);
        // A material that becomes a mirror or glass was matte in the file only because OBJ could
        // not express it. Below a coat, the matte part stays.
        let became_specular = material.is_view_dependent() && was == MaterialKind::Diffuse;
        let stays = !became_specular || self.kind == Some(Kind::Glossy);
        let kept = if stays { material.diffuse } else { Vec3::ZERO };
        material.diffuse = self.diffuse.unwrap_or(kept);
        material.emission = self.emission.unwrap_or(material.emission);
    }

    /// The kind of a material that was of another kind.
    fn kind_after(&self, was: MaterialKind) -> MaterialKind {
        let kind = self.kind.unwrap_or(match was {
            MaterialKind::Diffuse => Kind::Diffuse,
            MaterialKind::Mirror { .. } => Kind::Mirror,
            MaterialKind::Glass { .. } => Kind::Glass,
            MaterialKind::Glossy { .. } => Kind::Glossy,
            MaterialKind::Frosted { .. } => Kind::Frosted,
        });
        let default_reflectance = if kind == Kind::Glossy { COAT } else { 0.9 };
        let (mut reflectance, mut fresnel) = (Vec3::splat(default_reflectance), false);
        let (mut eta, mut transmittance, mut roughness) = (1.5, Vec3::ONE, DEFAULT_ROUGHNESS);
        match was {
            MaterialKind::Mirror { reflectance: r, fresnel: f } => (reflectance, fresnel) = (r, f),
            MaterialKind::Glass { eta: e, transmittance: t } => (eta, transmittance) = (e, t),
            MaterialKind::Glossy { reflectance: r, roughness: rough } => {
                (reflectance, roughness) = (r, rough)
            }
            MaterialKind::Frosted { eta: e, transmittance: t, roughness: r } => {
                (eta, transmittance, roughness) = (e, t, r);
            }
            MaterialKind::Diffuse => {}
        }
        let reflectance = self.reflectance.unwrap_or(reflectance);
        let (eta, transmittance) = (self.eta.unwrap_or(eta), self.transmittance.unwrap_or(transmittance));
        let roughness = self.roughness.unwrap_or(roughness);
        match kind {
            Kind::Diffuse => MaterialKind::Diffuse,
            Kind::Mirror => MaterialKind::Mirror { reflectance, fresnel: self.fresnel.unwrap_or(fresnel) },
            Kind::Glass => MaterialKind::Glass { eta, transmittance },
            Kind::Glossy => MaterialKind::Glossy { reflectance, roughness },
            Kind::Frosted => MaterialKind::Frosted { eta, transmittance, roughness },
        }
    }
}

fn overrides(top: &Section, notes: &mut Notes) -> Vec<Override> {
    let known = [
        "name",
        "number",
        "kind",
        "fresnel",
        "diffuse",
        "reflectance",
        "eta",
        "transmittance",
        "roughness",
        "emission",
    ];
    let sections = top.sections("material", "[[material]]", &known, notes);
    sections
        .into_iter()
        .filter_map(|s| {
            let Some(name) = s.text("name", notes) else {
                notes.add(s.at(), "[[material]] needs a name; it was ignored".to_owned());
                return None;
            };
            Some(Override {
                name: name.to_owned(),
                number: s.number("number", 1.0..=f64::from(u32::MAX), notes).map(|n| n as usize),
                line: notes.line(s.at()),
                kind: s.word("kind", notes),
                fresnel: s.flag("fresnel", notes),
                diffuse: s.color("diffuse", 1.0, notes),
                reflectance: s.color("reflectance", 1.0, notes),
                eta: s.number("eta", 1.0..=10.0, notes).map(|n| n as f32),
                transmittance: s.color("transmittance", 1.0, notes),
                roughness: s.number("roughness", 0.0..=1.0, notes).map(|n| n as f32),
                emission: s.color("emission", Limits::RADIANCE, notes),
            })
        })
        .collect()
}

fn fov_y_deg(s: &Section, notes: &mut Notes) -> f64 {
    s.number("fov_y_deg", Camera::FOV_Y_DEGREES, notes).unwrap_or(Camera::DEFAULT_FOV_Y_DEG)
}

fn camera(s: &Section, name: &str, notes: &mut Notes) -> Option<Camera> {
    let (key, fov) = (key_frame(s, name, notes)?, fov_y_deg(s, notes));
    let roll = s.number("roll_deg", -180.0..=180.0, notes).unwrap_or(0.0).to_radians();
    Some(Camera { roll, ..Camera::look_at(key.eye, key.at, fov) })
}

fn key_frame(s: &Section, name: &str, notes: &mut Notes) -> Option<CameraKey> {
    let (eye, at) = (s.point("eye", notes), s.point("at", notes));
    if eye.is_none() || at.is_none() {
        notes.add(s.at(), format!("{name} needs eye and at; it was ignored"));
    }
    Some(CameraKey::new(eye?, at?))
}

fn start(top: &Section, notes: &mut Notes) -> Option<Camera> {
    let s = top.section("start", "[start]", &["eye", "at", "fov_y_deg", "roll_deg"], notes)?;
    camera(&s, "[start]", notes)
}

fn views(top: &Section, notes: &mut Notes) -> Vec<NamedView> {
    let sections = top.sections("view", "[[view]]", &["name", "eye", "at", "fov_y_deg", "roll_deg"], notes);
    let view = |(i, s): (usize, Section)| {
        let name = s.text("name", notes).map_or_else(|| format!("view {}", i + 1), str::to_owned);
        Some(NamedView { name, camera: camera(&s, "[[view]]", notes)? })
    };
    sections.into_iter().enumerate().filter_map(view).collect()
}

fn walk(top: &Section, notes: &mut Notes) -> Option<CameraPath> {
    let s = top.section("walk", "[walk]", &["frames", "fov_y_deg", "keyframes"], notes)?;
    let sections = s.sections("keyframes", "a key frame of [walk]", &["eye", "at", "secs"], notes);
    let timed = |k: &Section| {
        let secs = k.number("secs", 0.0..=CameraKey::MAX_SECS, notes);
        Some(CameraKey { secs, ..key_frame(k, "a key frame of [walk]", notes)? })
    };
    let keyframes: Vec<CameraKey> = sections.iter().filter_map(timed).collect();
    if keyframes.is_empty() {
        notes.add(s.at(), "[walk] needs keyframes = [{ eye, at }, ...]; it was ignored".to_owned());
        return None;
    }
    let frames = s.number("frames", 1.0..=1e6, notes).map_or(300, |n| n as u32);
    Some(CameraPath { fov_y_deg: fov_y_deg(&s, notes), frames, keyframes })
}
