//! Buffer views that are stored in compressed form, decoded once, within the limit of all buffers.

use super::document::{Document, Found, List};
use super::meshopt::{self, Filter, Layout, Mode};
use super::schema_data::{self, MeshoptView};
use crate::import::progress::{Phase, Steps};
use crate::import::{tally::Tally, trouble::Trouble};
use crate::scene::SceneError;
use std::collections::HashMap;

/// Part of the names of both extensions.
pub(super) const NAME: &str = "meshopt_compression";

/// Decodes all compressed views of a document. Returns their bytes by the index of the view. A view
/// that cannot be decoded is counted as a trouble; its fallback is used where it has one. `stored`
/// returns the compressed bytes of the view with an index.
pub(super) fn decode_all<'b>(
    document: &Document,
    stored: &dyn Fn(usize, &MeshoptView) -> Found<&'b [u8]>,
    left: &mut u64,
    steps: &Steps,
    tally: &mut Tally,
) -> Result<HashMap<usize, Vec<u8>>, SceneError> {
    let views = &document.root.buffer_views;
    let mut decoded = HashMap::new();
    for index in (0..views.len()).filter(|index| views[*index].get().contains(NAME)) {
        steps.at(Phase::Reading, index as f32 / views.len() as f32)?;
        match decode(document, stored, index, left) {
            Ok(Some(bytes)) => {
                decoded.insert(index, bytes);
            }
            Ok(None) => {}
            Err(fault) => document.note(fault, tally),
        }
    }
    Ok(decoded)
}

/// Decodes a view; `None` where it is not compressed.
fn decode<'b>(
    document: &Document,
    stored: &dyn Fn(usize, &MeshoptView) -> Found<&'b [u8]>,
    index: usize,
    left: &mut u64,
) -> Found<Option<Vec<u8>>> {
    let view: schema_data::BufferView = document.item(List::BufferViews, index)?;
    let Some(compressed) = view.extensions.khr.or(view.extensions.ext) else { return Ok(None) };
    let fault = |detail: &str| document.fault(List::BufferViews, index, Trouble::COMPRESSED_VIEW, detail);
    let data = stored(index, &compressed)?;
    let (layout, size) = layout_of(&compressed).ok_or_else(|| fault("its mode, filter or size"))?;
    if size > *left {
        return Err(fault("larger than all buffers may be"));
    }
    let bytes = meshopt::decode(data, &layout).ok_or_else(|| fault(&format!("{size} bytes")))?;
    *left -= size;
    Ok(Some(bytes))
}

/// Returns the layout of a compressed view, and its size in bytes.
fn layout_of(stored: &MeshoptView) -> Option<(Layout, u64)> {
    let layout = Layout {
        mode: Mode::of(&stored.mode)?,
        filter: stored.filter.as_deref().map_or(Some(Filter::None), Filter::of)?,
        count: usize::try_from(stored.count).ok()?,
        stride: usize::try_from(stored.byte_stride).ok()?,
    };
    Some((layout, stored.count.checked_mul(stored.byte_stride)?))
}
