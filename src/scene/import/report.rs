//! What was doubtful in a file, counted by kind: a broken exporter repeats itself a hundred thousand times.

use crate::scene::Warning;

/// A kind of trouble in a line of a model or a material library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Trouble {
    VertexUnreadable,
    NormalUnreadable,
    UvUnreadable,
    FaceTooShort,
    FaceTooLong,
    CornerUnreadable,
    VertexMissing,
    VertexRefused,
    NormalMissing,
    UvMissing,
    FaceWithoutArea,
    FaceCrossesItself,
    LineOrPoint,
    FreeForm,
    UnknownLine,
    NameTooLong,
    ValueUnreadable,
    ValueNegative,
    BeforeFirstMaterial,
    MaterialTwice,
    TooBright,
    IndexOfRefraction,
    InvertedTransparency,
    UnknownIllum,
    Distrusted,
}

impl Trouble {
    /// One, many, and what was done.
    fn wording(self) -> (&'static str, &'static str, &'static str) {
        use Trouble::*;
        match self {
            VertexUnreadable => (
                "vertex has a coordinate that is not a finite number",
                "vertices have a coordinate that is not a finite number",
                "refused, with the faces that use it",
            ),
            NormalUnreadable => {
                ("normal is not made of numbers", "normals are not made of numbers", "ignored")
            }
            UvUnreadable => (
                "texture coordinate is not made of numbers",
                "texture coordinates are not made of numbers",
                "ignored",
            ),
            FaceTooShort => {
                ("face has fewer than three corners", "faces have fewer than three corners", "skipped")
            }
            FaceTooLong => {
                ("face has more than 65536 corners", "faces have more than 65536 corners", "skipped")
            }
            CornerUnreadable => (
                "face has a corner that cannot be read",
                "faces have a corner that cannot be read",
                "skipped",
            ),
            VertexMissing => (
                "face uses a vertex that does not exist",
                "faces use a vertex that does not exist",
                "skipped",
            ),
            VertexRefused => ("face uses a refused vertex", "faces use a vertex that was refused", "skipped"),
            NormalMissing => (
                "face uses a normal that does not exist",
                "faces use a normal that does not exist",
                "shaded flat there",
            ),
            UvMissing => (
                "face uses a texture coordinate that does not exist",
                "faces use a texture coordinate that does not exist",
                "kept without it",
            ),
            FaceWithoutArea => ("polygon has no area", "polygons have no area", "skipped"),
            FaceCrossesItself => {
                ("polygon crosses itself", "polygons cross themselves", "filled as far as possible")
            }
            LineOrPoint => ("line or point is no surface", "lines or points are no surfaces", "left out"),
            FreeForm => (
                "free-form curve or surface statement is not supported",
                "free-form curve or surface statements are not supported",
                "left out; export the model as triangles",
            ),
            UnknownLine => ("line has an unknown keyword", "lines have an unknown keyword", "ignored"),
            NameTooLong => ("name is longer than 4 kB", "names are longer than 4 kB", "ignored"),
            ValueUnreadable => {
                ("line has values that cannot be read", "lines have values that cannot be read", "skipped")
            }
            ValueNegative => ("value is negative", "values are negative", "taken as 0"),
            BeforeFirstMaterial => {
                ("line stands before the first newmtl", "lines stand before the first newmtl", "ignored")
            }
            MaterialTwice => {
                ("material is defined again", "materials are defined again", "ignored; the first one counts")
            }
            TooBright => (
                "material reflects more light than arrives",
                "materials reflect more light than arrives",
                "scaled down",
            ),
            IndexOfRefraction => (
                "glass has an index of refraction outside 1 to 10",
                "glasses have an index of refraction outside 1 to 10",
                "clamped",
            ),
            InvertedTransparency => (
                "material would be invisible (d 0 without a glass illum), which is usually an exporter's mistake",
                "materials would be invisible (d 0 without a glass illum), which is usually an exporter's mistake",
                "taken as opaque",
            ),
            UnknownIllum => ("illum is not in 0 to 10", "illum values are not in 0 to 10", "taken as matte"),
            Distrusted => (
                "material claims to mirror or to be glass although it is bright and opaque, as exporters write for \
                 everything",
                "materials claim to mirror or to be glass although they are bright and opaque, as exporters write \
                 for everything",
                "taken as matte; the scene's .afterimage.toml can say otherwise",
            ),
        }
    }
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
pub(super) struct Tally {
    entries: Vec<Entry>,
}

/// Longest quotation of a file in a message: the rest of a broken line helps nobody.
const QUOTE_CHARS: usize = 60;

impl Tally {
    /// Counts a trouble. `detail` is asked for only the first time.
    pub(super) fn add(&mut self, trouble: Trouble, line: u64, detail: impl FnOnce() -> String) {
        match self.entries.iter_mut().find(|e| e.trouble == trouble) {
            Some(entry) => entry.count += 1,
            None => self.entries.push(Entry { trouble, count: 1, line, detail: quote(&detail()) }),
        }
    }

    /// Adds the troubles of a later part of the file.
    pub(super) fn append(&mut self, later: Tally) {
        for entry in later.entries {
            match self.entries.iter_mut().find(|e| e.trouble == entry.trouble) {
                Some(mine) => mine.count += entry.count,
                None => self.entries.push(entry),
            }
        }
    }

    /// As warnings about `file`, in the order of their first lines.
    pub(super) fn warnings(mut self, file: &str) -> Vec<Warning> {
        self.entries.sort_by_key(|e| e.line);
        let warning = |e: &Entry| Warning { file: file.to_owned(), line: e.line, message: e.sentence() };
        self.entries.iter().map(warning).collect()
    }
}

impl Entry {
    fn sentence(&self) -> String {
        let (one, many, done) = self.trouble.wording();
        let detail = if self.detail.is_empty() { String::new() } else { format!(" ({})", self.detail) };
        let (count, line) = (self.count, self.line);
        if count == 1 {
            return format!("1 {one}, in line {line}{detail}; it was {done}");
        }
        format!("{count} {many}, first in line {line}{detail}; they were {done}")
    }
}

fn quote(text: &str) -> String {
    let clean = |c: char| if c.is_control() { ' ' } else { c };
    let short: String = text.chars().take(QUOTE_CHARS).map(clean).collect();
    if text.chars().nth(QUOTE_CHARS).is_some() { format!("{short}...") } else { short }
}

/// A list of names for people: the first few, and how many more.
pub(super) fn list(names: &[String]) -> String {
    const SHOWN: usize = 8;
    let shown: Vec<String> = names.iter().take(SHOWN).map(|n| format!("'{}'", quote(n))).collect();
    let more = names.len().saturating_sub(SHOWN);
    if more == 0 { shown.join(", ") } else { format!("{} and {more} more", shown.join(", ")) }
}
