//! What was doubtful in a file, counted by kind: a broken exporter repeats itself a hundred thousand times.

use crate::scene::Warning;

/// A kind of trouble in a line of a model or a material library: one, many, and what was done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Trouble {
    one: &'static str,
    many: &'static str,
    done: &'static str,
}

const fn trouble(one: &'static str, many: &'static str, done: &'static str) -> Trouble {
    Trouble { one, many, done }
}

impl Trouble {
    pub(crate) const VERTEX_UNREADABLE: Self = trouble(
        "vertex has a coordinate that is not a finite number",
        "vertices have a coordinate that is not a finite number",
        "refused, with the faces that use it",
    );
    pub(crate) const NORMAL_UNREADABLE: Self =
        trouble("normal is not made of numbers", "normals are not made of numbers", "ignored");
    pub(crate) const UV_UNREADABLE: Self = trouble(
        "texture coordinate is not made of numbers",
        "texture coordinates are not made of numbers",
        "ignored",
    );
    pub(crate) const FACE_TOO_SHORT: Self =
        trouble("face has fewer than three corners", "faces have fewer than three corners", "skipped");
    pub(crate) const FACE_TOO_LONG: Self =
        trouble("face has more than 4096 corners", "faces have more than 4096 corners", "skipped");
    pub(crate) const CORNER_UNREADABLE: Self = trouble(
        "face has a corner that cannot be read",
        "faces have a corner that cannot be read",
        "skipped",
    );
    pub(crate) const VERTEX_MISSING: Self = trouble(
        "face uses a vertex that does not exist",
        "faces use a vertex that does not exist",
        "skipped",
    );
    pub(crate) const VERTEX_REFUSED: Self =
        trouble("face uses a refused vertex", "faces use a vertex that was refused", "skipped");
    pub(crate) const NORMAL_MISSING: Self = trouble(
        "face uses a normal that does not exist",
        "faces use a normal that does not exist",
        "shaded flat there",
    );
    pub(crate) const UV_MISSING: Self = trouble(
        "face uses a texture coordinate that does not exist",
        "faces use a texture coordinate that does not exist",
        "kept without it",
    );
    pub(crate) const FACE_WITHOUT_AREA: Self =
        trouble("polygon has no area", "polygons have no area", "skipped");
    pub(crate) const FACE_CROSSES_ITSELF: Self =
        trouble("polygon crosses itself", "polygons cross themselves", "filled as far as possible");
    pub(crate) const LINE_OR_POINT: Self =
        trouble("line or point is no surface", "lines or points are no surfaces", "left out");
    pub(crate) const FREE_FORM: Self = trouble(
        "free-form curve or surface statement is not supported",
        "free-form curve or surface statements are not supported",
        "left out; export the model as triangles",
    );
    pub(crate) const UNKNOWN_LINE: Self =
        trouble("line has an unknown keyword", "lines have an unknown keyword", "ignored");
    pub(crate) const NAME_TOO_LONG: Self =
        trouble("name is longer than 4 kB", "names are longer than 4 kB", "ignored");
    pub(crate) const VALUE_UNREADABLE: Self =
        trouble("line has values that cannot be read", "lines have values that cannot be read", "skipped");
    pub(crate) const VALUE_NEGATIVE: Self = trouble("value is negative", "values are negative", "taken as 0");
    pub(crate) const BEFORE_FIRST_MATERIAL: Self =
        trouble("line stands before the first newmtl", "lines stand before the first newmtl", "ignored");
    pub(crate) const MATERIAL_TWICE: Self =
        trouble("material is defined again", "materials are defined again", "ignored; the first one counts");
    pub(crate) const TOO_BRIGHT: Self = trouble(
        "material reflects more light than arrives",
        "materials reflect more light than arrives",
        "scaled down",
    );
    pub(crate) const INDEX_OF_REFRACTION: Self = trouble(
        "glass has an index of refraction outside 1 to 10",
        "glasses have an index of refraction outside 1 to 10",
        "clamped",
    );
    pub(crate) const INVERTED_TRANSPARENCY: Self = trouble(
        "material would be invisible (d 0 without a glass illum), which is usually an exporter's mistake",
        "materials would be invisible (d 0 without a glass illum), which is usually an exporter's mistake",
        "taken as opaque",
    );
    pub(crate) const UNKNOWN_ILLUM: Self =
        trouble("illum is not in 0 to 10", "illum values are not in 0 to 10", "taken as matte");
    // Of glTF.
    pub(crate) const ITEM_MISSING: Self = trouble(
        "reference names an item that does not exist",
        "references name items that do not exist",
        "left out",
    );
    pub(crate) const ITEM_UNREADABLE: Self =
        trouble("item cannot be read", "items cannot be read", "left out");
    pub(crate) const ACCESSOR: Self = trouble(
        "accessor is not of a kind that fits its use",
        "accessors are not of a kind that fits their use",
        "left out",
    );
    pub(crate) const OUTSIDE_BUFFER: Self = trouble(
        "piece of data lies outside its buffer",
        "pieces of data lie outside their buffers",
        "left out",
    );
    pub(crate) const BUFFER_MISSING: Self =
        trouble("buffer cannot be had", "buffers cannot be had", "left out with all that lies in it");
    pub(crate) const BUFFER_OUTSIDE: Self = trouble(
        "buffer lies outside the scene's folder",
        "buffers lie outside the scene's folder",
        "not opened; that must be allowed",
    );
    pub(crate) const DATA_URI: Self =
        trouble("data: address is not base64", "data: addresses are not base64", "left out");
    pub(crate) const NODE_AGAIN: Self = trouble(
        "node has two parents or is its own ancestor",
        "nodes have two parents or are their own ancestors",
        "shown once",
    );
    pub(crate) const ROTATION: Self =
        trouble("rotation has no length", "rotations have no length", "ignored");
    pub(crate) const SKIN: Self =
        trouble("mesh is bent by a skeleton", "meshes are bent by skeletons", "shown as at rest");
    pub(crate) const MORPH: Self =
        trouble("primitive has morph targets", "primitives have morph targets", "shown without them");
    pub(crate) const VERTEX_COLOR: Self = trouble(
        "primitive has colours of its vertices",
        "primitives have colours of their vertices",
        "shown without them",
    );
    pub(crate) const MODE: Self =
        trouble("primitive is of an unknown kind", "primitives are of an unknown kind", "left out");
    pub(crate) const NO_POSITION: Self =
        trouble("primitive has no positions", "primitives have no positions", "left out");
    pub(crate) const TRIANGLE_VERTEX: Self = trouble(
        "primitive has triangles that use a vertex that does not exist",
        "primitives have triangles that use a vertex that does not exist",
        "shown without those",
    );
    pub(crate) const ORTHOGRAPHIC: Self =
        trouble("camera has no perspective", "cameras have no perspective", "left out");
    pub(crate) const CAMERA: Self = trouble("camera looks nowhere", "cameras look nowhere", "left out");
    pub(crate) const LIGHT: Self = trouble(
        "light has no known kind, no direction or an impossible strength",
        "lights have no known kind, no direction or an impossible strength",
        "left out",
    );
    pub(crate) const SPOT: Self =
        trouble("spot light is lit as a point", "spot lights are lit as points", "kept without a cone");
    pub(crate) const SECOND_SUN: Self = trouble(
        "directional light comes after the first",
        "directional lights come after the first",
        "left out; there is one sun",
    );
    pub(crate) const OUT_OF_RANGE: Self =
        trouble("material value is out of its range", "material values are out of their ranges", "clamped");
    pub(crate) const ALPHA_MODE: Self = trouble(
        "material has an unknown alphaMode",
        "materials have an unknown alphaMode",
        "taken as opaque",
    );
    pub(crate) const BLENDED: Self = trouble(
        "material blends by a picture's alpha",
        "materials blend by a picture's alpha",
        "cut at one half instead",
    );
    pub(crate) const MASKED_AWAY: Self =
        trouble("material is masked away entirely", "materials are masked away entirely", "taken as opaque");
    pub(crate) const TURNED_TEXTURE: Self = trouble(
        "texture is turned by KHR_texture_transform",
        "textures are turned by KHR_texture_transform",
        "used without turning",
    );
    pub(crate) const NO_PICTURE: Self = trouble(
        "texture has no picture of a format that is read",
        "textures have no picture of a format that is read",
        "left out",
    );
    pub(crate) const PICTURE: Self = trouble(
        "picture cannot be used",
        "pictures cannot be used",
        "replaced by a magenta checker where they are a colour",
    );
    pub(crate) const PICTURE_MISSING: Self = trouble(
        "picture was not found",
        "pictures were not found",
        "replaced by a magenta checker where they are a colour",
    );
    pub(crate) const PICTURE_OUTSIDE: Self = trouble(
        "picture lies outside the scene's folder",
        "pictures lie outside the scene's folder",
        "not opened; that must be allowed",
    );
    // Of exporters.
    pub(crate) const DISTRUSTED: Self = trouble(
        "material claims to mirror or to be glass although it is bright and opaque, as exporters write for \
                 everything",
        "materials claim to mirror or to be glass although they are bright and opaque, as exporters write \
                 for everything",
        "taken as matte; the scene's .afterimage.toml can say otherwise",
    );
}

#[derive(Clone, Debug)]
struct Entry {
    trouble: Trouble,
    count: u64,
    line: u64,
    detail: String,
}

/// Troubles of one file, merged by kind.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    entries: Vec<Entry>,
}

/// Longest quotation of a file in a message: the rest of a broken line helps nobody.
const QUOTE_CHARS: usize = 100;

impl Tally {
    /// Counts a trouble. `detail` is asked for only the first time.
    pub(crate) fn add(&mut self, trouble: Trouble, line: u64, detail: impl FnOnce() -> String) {
        match self.entries.iter_mut().find(|e| e.trouble == trouble) {
            Some(entry) => entry.count += 1,
            None => self.entries.push(Entry { trouble, count: 1, line, detail: quote(&detail()) }),
        }
    }

    /// True where a trouble of this kind was counted.
    pub(crate) fn has(&self, trouble: Trouble) -> bool {
        self.entries.iter().any(|e| e.trouble == trouble)
    }

    /// Adds the troubles of a later part of the file.
    pub(crate) fn append(&mut self, later: Tally) {
        for entry in later.entries {
            match self.entries.iter_mut().find(|e| e.trouble == entry.trouble) {
                Some(mine) => mine.count += entry.count,
                None => self.entries.push(entry),
            }
        }
    }

    /// As warnings about `file`, in the order of their first lines.
    pub(crate) fn warnings(mut self, file: &str) -> Vec<Warning> {
        self.entries.sort_by_key(|e| e.line);
        let warning = |e: &Entry| Warning { file: file.to_owned(), line: e.line, message: e.sentence() };
        self.entries.iter().map(warning).collect()
    }
}

impl Entry {
    fn sentence(&self) -> String {
        let Trouble { one, many, done } = self.trouble;
        let detail = if self.detail.is_empty() { String::new() } else { format!(" ({})", self.detail) };
        // A binary file has no lines.
        let (count, line) =
            (self.count, if self.line == 0 { String::new() } else { format!(" in line {}", self.line) });
        match (count, line.is_empty()) {
            (1, true) => format!("1 {one}{detail}; it was {done}"),
            (1, false) => format!("1 {one},{line}{detail}; it was {done}"),
            (_, true) => format!("{count} {many}{}; they were {done}", detail.replacen('(', "(first ", 1)),
            (_, false) => format!("{count} {many}, first{line}{detail}; they were {done}"),
        }
    }
}

/// A text from a file, short and without control characters.
pub(crate) fn quote(text: &str) -> String {
    let clean = |c: char| if c.is_control() { ' ' } else { c };
    let short: String = text.chars().take(QUOTE_CHARS).map(clean).collect();
    if text.chars().nth(QUOTE_CHARS).is_some() { format!("{short}...") } else { short }
}

/// A list of names for people: the first few, and how many more.
pub(crate) fn list(names: &[String]) -> String {
    const SHOWN: usize = 8;
    let shown: Vec<String> = names.iter().take(SHOWN).map(|n| format!("'{}'", quote(n))).collect();
    let more = names.len().saturating_sub(SHOWN);
    if more == 0 { shown.join(", ") } else { format!("{} and {more} more", shown.join(", ")) }
}
