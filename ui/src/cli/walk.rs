//! Reads recorded camera paths.

use super::failure::Failure;
use afterimage::{camera::CameraPath, raster::load::read_bounded};
use std::path::Path;

/// Maximum length in bytes of a file of camera paths; a path of a million key frames has about 100
/// MB.
const MAX_BYTES: u64 = 256 << 20;

/// Reads the camera path in `FILE`, or the one called `NAME` in `FILE#NAME`.
pub(super) fn read_path(text: &str) -> Result<CameraPath, Failure> {
    let (file, name) = match text.rsplit_once('#') {
        // The name of a file may itself contain `#`.
        Some((file, name)) if !Path::new(text).exists() => (file, Some(name)),
        _ => (text, None),
    };
    let failed = |cause: &dyn std::fmt::Display| {
        Failure::Failed(format!("cannot read the camera path {file}: {cause}"))
    };
    let bytes = read_bounded(Path::new(file), MAX_BYTES).map_err(|e| failed(&e.cause))?;
    CameraPath::from_json(&bytes, name).map_err(|e| failed(&e))
}
