//! Reading models: OBJ with its MTL libraries, and glTF.
//!
//! [`load()`] finds the reader of a file by its extension, in the table [`FORMATS`]. Readers share
//! one context: limits, progress, the search for the files that a model names, pictures, the
//! sidecar (a settings file next to the model), and the tally of troubles.
//!
//! A damaged part of a file does not stop an import. It is left out or replaced, counted, and
//! reported with its line. Only a file that leaves nothing to show is an error, which names file,
//! line, cause and remedy.

mod context;
mod daylight;
mod dds;
mod decoding;
mod files;
mod formats;
mod gltf;
mod ies;
mod load;
mod obj;
mod options;
mod picture;
mod polygon;
mod progress;
mod search;
mod sidecar;
mod sky_picture;
mod surfaces;
mod tally;
mod text;
mod trouble;
mod units;
mod vertex_colors;

pub use daylight::{DaylightOptions, LightChoice, SkyChoice};
pub use formats::{FORMATS, Format, extensions};
pub use load::load;
pub use options::{ImportOptions, Limits};
pub use progress::{Phase, Progress};
pub use sidecar::{AppliedEdit, EditFolder, apply_edit_text, edit_text, save_edit};
pub use sky_picture::load_sky;
pub use units::{Unit, UnknownWord, Up};
