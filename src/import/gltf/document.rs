//! The JSON and the binary part of a glTF file; items of the JSON by list and index.

use super::schema::{Root, RootExtensions};
use crate::import::tally::{Tally, quote};
use crate::import::{files::unreadable, trouble::Trouble};
use crate::scene::SceneError;
use serde::Deserialize;
use serde_json::value::RawValue;
use std::collections::HashMap;
use std::path::Path;

/// A trouble with one item, and its place.
#[derive(Debug)]
pub(super) struct Fault {
    pub(super) trouble: Trouble,
    /// Byte in the JSON, from which the line is counted.
    pub(super) at: usize,
    pub(super) detail: String,
}

/// An item, or the trouble with it.
pub(super) type Found<T> = Result<T, Fault>;

/// A glTF file, split into its parts.
pub(super) struct Document<'t> {
    text: &'t str,
    /// True for `.glb`: its JSON has no lines that a user could look up.
    is_binary: bool,
    pub(super) root: Root<'t>,
    /// Binary part of a `.glb`.
    pub(super) bin: Option<&'t [u8]>,
    /// Troubles with keys of the root.
    pub(super) faults: Vec<Fault>,
}

/// First bytes of files that are given for glTF by mistake, and what they are.
const OTHER_FILES: [(&[u8], &str); 6] = [
    (b"PK\x03\x04", "a ZIP archive"),
    (b"\x1f\x8b", "a gzip archive"),
    (b"7z\xbc\xaf", "a 7z archive"),
    (b"%PDF", "a PDF document"),
    (b"Kaydara FBX", "an FBX file"),
    (b"<", "a text of XML or HTML"),
];

/// A list of items in the root of the JSON.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum List {
    Scenes,
    Nodes,
    Meshes,
    Materials,
    Textures,
    Samplers,
    Images,
    Accessors,
    BufferViews,
    Buffers,
    Cameras,
    Lights,
    Profiles,
}

impl<'t> Document<'t> {
    /// Parses the bytes of a file.
    pub(super) fn parse(bytes: &'t [u8], file: &Path) -> Result<Self, SceneError> {
        let is_binary = bytes.starts_with(b"glTF");
        let (json, bin) = if is_binary { split(bytes, file)? } else { (bytes, None) };
        if let Some((_, what)) = OTHER_FILES.iter().find(|(magic, _)| bytes.starts_with(magic)) {
            return Err(unreadable(
                file,
                format!("it is {what}, not a glTF file"),
                "unpack it, or export the model",
            ));
        }
        let json = json.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(json);
        let text = std::str::from_utf8(json).map_err(|e| {
            let line = lines_before(&json[..e.valid_up_to()]) + 1;
            broken(file, line, "the JSON is not UTF-8".to_owned())
        })?;
        let keys: Keys = serde_json::from_str(text).map_err(|e| {
            broken(file, e.line() as u64, format!("the JSON cannot be read: {}", without_place(&e)))
        })?;
        let mut faults = Vec::new();
        let root = root_of(&keys, text, &mut faults);
        match &root.asset.version {
            Some(version) if !version.starts_with("2.") => {
                let cause = format!("it is glTF {}, only glTF 2.0 is supported", quote(version));
                Err(unreadable(file, cause, "export the model as glTF 2.0"))
            }
            _ => Ok(Self { text, is_binary, root, bin, faults }),
        }
    }

    /// Returns the name of a list in the JSON, and its items.
    fn list(&self, list: List) -> (&'static str, &[&'t RawValue]) {
        let root = &self.root;
        match list {
            List::Scenes => ("scenes", &root.scenes),
            List::Nodes => ("nodes", &root.nodes),
            List::Meshes => ("meshes", &root.meshes),
            List::Materials => ("materials", &root.materials),
            List::Textures => ("textures", &root.textures),
            List::Samplers => ("samplers", &root.samplers),
            List::Images => ("images", &root.images),
            List::Accessors => ("accessors", &root.accessors),
            List::BufferViews => ("bufferViews", &root.buffer_views),
            List::Buffers => ("buffers", &root.buffers),
            List::Cameras => ("cameras", &root.cameras),
            List::Lights => ("lights", &root.extensions.lights.lights),
            List::Profiles => ("light profiles", &root.extensions.profiles.lights),
        }
    }

    /// True where the text of an item of a list contains a name.
    pub(super) fn mentions(&self, list: List, name: &str) -> bool {
        self.list(list).1.iter().any(|raw| raw.get().contains(name))
    }

    /// Parses an item by its index.
    pub(super) fn item<T: Deserialize<'t>>(&self, list: List, index: usize) -> Found<T> {
        let (name, items) = self.list(list);
        let Some(raw) = items.get(index) else {
            let detail = format!("{name}[{index}] of {}", items.len());
            return Err(Fault { trouble: Trouble::ITEM_MISSING, at: 0, detail });
        };
        self.read(raw, || format!("{name}[{index}]"))
    }

    /// Parses a part that is still text. `name` is for messages.
    pub(super) fn read<T: Deserialize<'t>>(
        &self,
        raw: &'t RawValue,
        name: impl FnOnce() -> String,
    ) -> Found<T> {
        serde_json::from_str(raw.get()).map_err(|e| {
            let detail = format!("{}: {}", name(), without_place(&e));
            Fault { trouble: Trouble::ITEM_UNREADABLE, at: self.at(raw), detail }
        })
    }

    /// Returns a trouble with an item.
    pub(super) fn fault(&self, list: List, index: usize, trouble: Trouble, detail: &str) -> Fault {
        let (name, items) = self.list(list);
        let at = items.get(index).map_or(0, |raw| self.at(raw));
        let colon = if detail.is_empty() { "" } else { ": " };
        Fault { trouble, at, detail: format!("{name}[{index}]{colon}{detail}") }
    }

    /// Returns the byte at which a part of the text starts.
    pub(super) fn at(&self, part: &RawValue) -> usize {
        place_in(self.text, part)
    }

    /// Counts a trouble.
    pub(super) fn note(&self, fault: Fault, tally: &mut Tally) {
        // Lines are counted only for the first trouble of a kind: a file may have a million.
        let line = if self.is_binary || tally.has(fault.trouble) { 0 } else { self.line(fault.at) };
        tally.add(fault.trouble, line, || fault.detail);
    }

    /// Counts the troubles with keys of the root.
    pub(super) fn note_root(&self, tally: &mut Tally) {
        for Fault { trouble, at, detail } in &self.faults {
            self.note(Fault { trouble: *trouble, at: *at, detail: detail.clone() }, tally);
        }
    }

    fn line(&self, at: usize) -> u64 {
        lines_before(&self.text.as_bytes()[..at.min(self.text.len())]) + 1
    }
}

/// Returns the byte at which a part of a text begins.
fn place_in(text: &str, part: &RawValue) -> usize {
    (part.get().as_ptr() as usize).saturating_sub(text.as_ptr() as usize)
}

/// The keys of the root, as text.
type Keys<'t> = HashMap<String, &'t RawValue>;

/// Reads the keys of the root one by one: one that cannot be read costs only itself.
fn root_of<'t>(keys: &Keys<'t>, text: &'t str, faults: &mut Vec<Fault>) -> Root<'t> {
    Root {
        asset: key("asset", keys, text, faults),
        scene: key("scene", keys, text, faults),
        scenes: key("scenes", keys, text, faults),
        nodes: key("nodes", keys, text, faults),
        meshes: key("meshes", keys, text, faults),
        materials: key("materials", keys, text, faults),
        textures: key("textures", keys, text, faults),
        samplers: key("samplers", keys, text, faults),
        images: key("images", keys, text, faults),
        accessors: key("accessors", keys, text, faults),
        buffer_views: key("bufferViews", keys, text, faults),
        buffers: key("buffers", keys, text, faults),
        cameras: key("cameras", keys, text, faults),
        animations: key("animations", keys, text, faults),
        extensions_used: names("extensionsUsed", keys, text, faults),
        extensions_required: names("extensionsRequired", keys, text, faults),
        extensions: {
            let extensions: Keys = key("extensions", keys, text, faults);
            RootExtensions {
                lights: key("KHR_lights_punctual", &extensions, text, faults),
                profiles: key("EXT_lights_ies", &extensions, text, faults),
            }
        },
    }
}

/// Returns the names in a list; items that are no names are left out.
fn names<'t>(name: &str, keys: &Keys<'t>, text: &'t str, faults: &mut Vec<Fault>) -> Vec<String> {
    let items: Vec<&RawValue> = key(name, keys, text, faults);
    items.into_iter().filter_map(|item| serde_json::from_str(item.get()).ok()).collect()
}

/// Returns the value of a key; the default where it is missing or cannot be read.
fn key<'t, T: Deserialize<'t> + Default>(
    name: &str,
    keys: &Keys<'t>,
    text: &'t str,
    faults: &mut Vec<Fault>,
) -> T {
    let Some(raw) = keys.get(name) else { return T::default() };
    serde_json::from_str(raw.get()).unwrap_or_else(|e| {
        let detail = format!("{name}: {}", without_place(&e));
        faults.push(Fault { trouble: Trouble::ROOT_KEY, at: place_in(text, raw), detail });
        T::default()
    })
}

fn lines_before(bytes: &[u8]) -> u64 {
    bytes.iter().filter(|b| **b == b'\n').count() as u64
}

fn broken(file: &Path, line: u64, cause: String) -> SceneError {
    SceneError::Line {
        file: file.to_owned(),
        line: line.max(1),
        cause,
        remedy: "correct the file or export it again".to_owned(),
    }
}

/// Returns the message of the parser without the line and column, which are those of the part it
/// was given.
fn without_place(error: &serde_json::Error) -> String {
    let text = error.to_string();
    quote(text.rsplit_once(" at line ").map_or(text.as_str(), |(message, _)| message))
}

/// Splits a `.glb` into its JSON and its binary part. A chunk that is cut short keeps the bytes
/// that are there: data that is missing is reported where it is used.
fn split<'t>(bytes: &'t [u8], file: &Path) -> Result<(&'t [u8], Option<&'t [u8]>), SceneError> {
    let failed = |cause: &str| unreadable(file, cause, "export the model as glTF 2.0 again");
    match word(bytes, 4) {
        Some(2) => {}
        Some(version) => {
            return Err(failed(&format!("it is binary glTF version {version}, only version 2 is supported")));
        }
        None => return Err(failed("it ends inside its header")),
    }
    let json = chunk(bytes, 12, b"JSON").ok_or_else(|| failed("it does not begin with a JSON chunk"))?;
    Ok((json, chunk(bytes, 20 + json.len(), b"BIN\0")))
}

/// Returns the little-endian number at a byte.
fn word(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at.checked_add(4)?)?.try_into().ok()?))
}

fn chunk<'t>(bytes: &'t [u8], at: usize, kind: &[u8; 4]) -> Option<&'t [u8]> {
    let length = word(bytes, at)? as usize;
    let rest = bytes.get(at..)?.get(4..)?.strip_prefix(kind)?;
    Some(&rest[..length.min(rest.len())])
}
