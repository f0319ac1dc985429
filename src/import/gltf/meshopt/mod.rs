//! Decoding buffer views that are compressed by `EXT_meshopt_compression` or
//! `KHR_meshopt_compression`.
//!
//! Source: the text of the two extensions, appendix A (bitstream) and B (filters). The decoder is
//! our own, because it must bear any bytes: nothing is allocated for a size that the data cannot
//! fill.

mod attributes;
mod bytes;
mod filters;
mod indices;
#[cfg(test)]
mod tests;
mod triangles;

pub(super) use filters::Filter;

/// Maximum size of an element in bytes, which is that of the extension.
const MAX_STRIDE: usize = 256;

/// Layout of the elements of a compressed buffer view (`mode` of `EXT_meshopt_compression`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mode {
    /// Elements of any kind.
    Attributes,
    /// Indices of a list of triangles.
    Triangles,
    /// Other indices.
    Indices,
}

impl Mode {
    /// Returns the mode of a name in a file.
    pub(super) fn of(name: &str) -> Option<Self> {
        match name {
            "ATTRIBUTES" => Some(Self::Attributes),
            "TRIANGLES" => Some(Self::Triangles),
            "INDICES" => Some(Self::Indices),
            _ => None,
        }
    }
}

/// The elements of a compressed view.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layout {
    pub(super) mode: Mode,
    pub(super) filter: Filter,
    pub(super) count: usize,
    /// Bytes of an element.
    pub(super) stride: usize,
}

/// Decodes a view. Returns `count` elements of `stride` bytes, or `None` where the bytes are not
/// those of such a view.
pub(super) fn decode(data: &[u8], layout: &Layout) -> Option<Vec<u8>> {
    let Layout { mode, filter, count, stride } = *layout;
    match mode {
        Mode::Attributes => {
            let is_possible = (4..=MAX_STRIDE).contains(&stride) && stride.is_multiple_of(4);
            if !is_possible || !filter.fits(stride) {
                return None;
            }
            let mut bytes = attributes::decode(data, count, stride)?;
            filter.apply(&mut bytes, stride);
            Some(bytes)
        }
        Mode::Triangles => Some(bytes_of(&triangles::decode(data, count)?, stride)?),
        Mode::Indices => Some(bytes_of(&indices::decode(data, count)?, stride)?),
    }
}

/// Returns indices as bytes: two or four for each.
fn bytes_of(indices: &[u32], stride: usize) -> Option<Vec<u8>> {
    match stride {
        2 => Some(indices.iter().flat_map(|index| (*index as u16).to_le_bytes()).collect()),
        4 => Some(indices.iter().flat_map(|index| index.to_le_bytes()).collect()),
        _ => None,
    }
}
