//! The kinds of trouble in a model, with their texts.

/// A kind of trouble that is counted: the things affected, what is wrong with them, and what was
/// done about it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Trouble {
    /// One affected thing, as a noun.
    pub(super) noun: &'static str,
    pub(super) plural: &'static str,
    pub(super) fault: &'static str,
    pub(super) done: &'static str,
}

/// Makes a constant per line: `NAME: noun / plural, fault => what was done`.
macro_rules! troubles {
    ($($name:ident: $noun:literal / $plural:literal, $fault:literal => $done:literal;)*) => {
        impl Trouble {
            $(pub(super) const $name: Self = Self { noun: $noun, plural: $plural, fault: $fault, done: $done };)*
        }
    };
}

// OBJ.
troubles! {
    VERTEX_UNREADABLE: "vertex" / "vertices",
        "with a coordinate that is not a finite number" => "refused, with the faces that use it";
    NORMAL_UNREADABLE: "normal" / "normals", "not made of numbers" => "ignored";
    UV_UNREADABLE: "texture coordinate" / "texture coordinates", "not made of numbers" => "ignored";
    FACE_TOO_SHORT: "face" / "faces", "with fewer than three corners" => "skipped";
    FACE_TOO_LONG: "face" / "faces", "with more than 4096 corners" => "skipped";
    CORNER_UNREADABLE: "face" / "faces", "with a corner that cannot be read" => "skipped";
    VERTEX_MISSING: "face" / "faces", "with a vertex that does not exist" => "skipped";
    VERTEX_REFUSED: "face" / "faces", "with a refused vertex" => "skipped";
    NORMAL_MISSING: "face" / "faces", "with a normal that does not exist" => "shaded flat there";
    UV_MISSING: "face" / "faces",
        "with a texture coordinate that does not exist" => "kept without it";
    FACE_WITHOUT_AREA: "polygon" / "polygons", "without area" => "skipped";
    FACE_CROSSES_ITSELF: "polygon" / "polygons",
        "with edges that cross" => "filled as far as possible";
    SMOOTHING_GROUP: "smoothing group" / "smoothing groups", "without a number" => "shaded flat";
    WITHOUT_EFFECT: "statement" / "statements",
        "of display attributes (mg, lod, bevel, c_interp, d_interp, shadow_obj, trace_obj, usemap, maplib)"
        => "ignored; the faces are shown without";
    LINE_OR_POINT: "line or point" / "lines or points", "without a surface" => "left out";
    FREE_FORM: "free-form statement" / "free-form statements",
        "of curves or surfaces, which are not supported"
        => "left out; export the model as triangles";
    UNKNOWN_LINE: "line" / "lines", "with an unknown keyword" => "ignored";
    NAME_TOO_LONG: "name" / "names", "longer than 4 kB" => "ignored";
}

// MTL.
troubles! {
    VALUE_UNREADABLE: "line" / "lines", "with values that cannot be read" => "skipped";
    VALUE_NEGATIVE: "line" / "lines", "with a negative value" => "taken as 0";
    BEFORE_FIRST_MATERIAL: "line" / "lines", "before the first newmtl" => "ignored";
    MATERIAL_TWICE: "material" / "materials",
        "defined again" => "ignored; the first definition counts";
    TOO_BRIGHT: "material" / "materials", "reflecting more light than arrives" => "scaled down";
    INDEX_OF_REFRACTION: "glass material" / "glass materials",
        "with an index of refraction outside 1 to 10" => "clamped";
    INVERTED_TRANSPARENCY: "material" / "materials",
        "that would be invisible (d 0 without a glass illum), usually an exporter's mistake"
        => "taken as opaque";
    UNKNOWN_ILLUM: "illum value" / "illum values", "outside 0 to 10" => "taken as matte";
    DISTRUSTED: "opaque material" / "opaque materials",
        "declared as mirror or glass by an illum that other values contradict, as some exporters write for everything"
        => "taken as matte; the scene's .afterimage.toml can override it";
    MAYA_OPACITY: "material" / "materials",
        "with illum 4, Ni 1 and a Tf, by which Maya writes opacity" => "taken as translucent";
    BLACK_PICTURE: "material" / "materials",
        "with Kd 0 in front of a picture, which would hide it" => "the picture is shown as it is";
    AMBIENT_PICTURE: "material" / "materials",
        "with a picture of ambient light (map_Ka) alone" => "shown with it as their colour";
    DECIMAL_COMMA: "line" / "lines", "with decimal commas" => "read as decimal points";
    DISPLACEMENT: "picture" / "pictures",
        "of displacement" => "not used; the surface keeps its shape";
    GLOSS_PICTURE: "picture" / "pictures",
        "of gloss (map_Ks, map_Ns, map_Ps, map_Ni)" => "not used; the surface reflects evenly";
    DECAL: "picture" / "pictures", "of a decal or a reflection" => "not used";
    FINISH: "value" / "values",
        "of sheen or anisotropy" => "not used; the surface is shown without";
    MAP_OPTION: "option of a picture" / "options of pictures",
        "without support here" => "ignored; the picture is shown without";

}

// glTF.
troubles! {
    ITEM_MISSING: "reference" / "references", "to an item that does not exist" => "left out";
    ROOT_KEY: "key of the root" / "keys of the root", "that cannot be read" => "left out with all in it";
    ITEM_UNREADABLE: "item" / "items", "that cannot be read" => "left out";
    ACCESSOR: "accessor" / "accessors", "of a type that does not fit its use" => "left out";
    OUTSIDE_BUFFER: "range of data" / "ranges of data", "outside its buffer" => "left out";
    BUFFER_MISSING: "buffer" / "buffers", "that cannot be read" => "left out with all data in it";
    BUFFER_OUTSIDE: "buffer" / "buffers",
        "outside the scene's folder" => "not opened; allow files outside the folder to use it";
    DATA_URI: "data: address" / "data: addresses", "that is not base64" => "left out";
    NODE_AGAIN: "node" / "nodes", "with two parents or within itself" => "shown once";
    ROTATION: "rotation" / "rotations", "without length" => "ignored";
    SKIN: "mesh" / "meshes", "with a skeleton" => "shown at rest";
    MORPH: "primitive" / "primitives", "with morph targets" => "shown without them";
    VERTEX_COLOR: "primitive" / "primitives", "with vertex colours" => "shown without them";
    MODE: "primitive" / "primitives", "of an unknown mode" => "left out";
    NO_POSITION: "primitive" / "primitives", "without positions" => "left out";
    TRIANGLE_VERTEX: "primitive" / "primitives",
        "with triangles that use a vertex that does not exist" => "shown without those";
    ORTHOGRAPHIC: "camera" / "cameras", "without perspective (orthographic)" => "left out";
    CAMERA: "camera" / "cameras", "without a direction" => "left out";
    LIGHT: "light" / "lights",
        "without a known type or direction, or with an impossible intensity" => "left out";
    TILT: "light profile" / "light profiles",
        "with a file of its light when tilted" => "not used; the lamp is as bright as it was measured";
    PROFILE: "light profile" / "light profiles",
        "that cannot be read" => "its lamps are left out";
    INVISIBLE: "node" / "nodes", "hidden by KHR_node_visibility" => "left out with all below";
    COMPRESSED: "primitive" / "primitives",
        "whose compressed form cannot be decoded" => "left out; export the model without compression";
    COMPRESSED_VIEW: "compressed range of data" / "compressed ranges of data",
        "that cannot be decoded" => "left out where it is stored in no other form";
    SECOND_SUN: "directional light" / "directional lights",
        "after the first" => "left out; there is one sun";
    METAL_COAT: "metal" / "metals", "with a clear coat" => "shown without the coat";
    OUT_OF_RANGE: "material value" / "material values", "out of range" => "clamped";
    ALPHA_MODE: "material" / "materials", "with an unknown alphaMode" => "taken as opaque";
    BLENDED: "mirror" / "mirrors",
        "blended by the alpha of a picture" => "cut out at one half instead";
    MASKED_AWAY: "material" / "materials", "masked away entirely" => "taken as opaque";
    UV_SET: "material" / "materials",
        "whose pictures use several sets of texture coordinates" => "shown with that of the first";
    NO_UV_SET: "primitive" / "primitives",
        "without the set of texture coordinates of its material" => "shown without its pictures' patterns";
    NO_PICTURE: "texture" / "textures", "without a picture of a supported format" => "left out";
    PICTURE: "picture" / "pictures",
        "that cannot be used" => "replaced by a magenta checker where it is a colour";
    PICTURE_MISSING: "picture" / "pictures",
        "not found" => "replaced by a magenta checker where it is a colour";
    PICTURE_OUTSIDE: "picture" / "pictures",
        "outside the scene's folder" => "not opened; allow files outside the folder to use it";
}
