//! Mode 2: indices as differences from one of two indices before.

use super::bytes::{Bytes, unzigzag};

/// Decodes `count` indices.
pub(super) fn decode(data: &[u8], count: usize) -> Option<Vec<u32>> {
    let data = data.strip_prefix(&[0xD1])?;
    let (deltas, _padding) = data.split_at_checked(data.len().checked_sub(4)?)?;
    if deltas.len() < count {
        return None;
    }
    let mut deltas = Bytes(deltas);
    let mut last = [0u32; 2];
    let mut indices = Vec::new();
    indices.try_reserve_exact(count).ok()?;
    for _ in 0..count {
        let code = deltas.varint()?;
        let last = &mut last[(code & 1) as usize];
        *last = last.wrapping_add(unzigzag(code >> 1));
        indices.push(*last);
    }
    deltas.0.is_empty().then_some(indices)
}
