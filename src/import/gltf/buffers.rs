//! Buffers: in the file itself, in a `data:` address, or in a file next to it; all together within
//! a limit.

use super::document::{Document, Fault, Found, List};
use super::{compressed_views, schema_data, uri};
use crate::import::progress::{Phase, Steps};
use crate::import::{files, options::Limits, search::Finder, tally::Tally, trouble::Trouble};
use crate::scene::SceneError;
use std::{borrow::Cow, collections::HashMap};

/// Bytes of all buffers.
pub(super) struct Buffers<'t> {
    /// `None` for a buffer that could not be read, which was counted as a trouble.
    buffers: Vec<Option<Cow<'t, [u8]>>>,
    /// The bytes of compressed views, by the index of the view.
    decoded: HashMap<usize, Vec<u8>>,
}

impl<'t> Buffers<'t> {
    /// Reads all buffers of a document.
    pub(super) fn read(
        document: &Document<'t>,
        finder: &mut Finder,
        limits: &Limits,
        steps: &Steps,
        tally: &mut Tally,
    ) -> Result<Self, SceneError> {
        let mut left = limits.buffers_bytes;
        let mut buffers = Vec::new();
        let count = document.root.buffers.len();
        for index in 0..count {
            steps.at(Phase::Reading, index as f32 / count as f32)?;
            let bytes = buffer(document, index, finder, &mut left);
            let note = |fault: Fault| {
                if !is_placeholder(document, index) {
                    document.note(fault, tally);
                }
            };
            buffers.push(bytes.map_err(note).ok());
        }
        let mut buffers = Self { buffers, decoded: HashMap::new() };
        let stored = |view: usize, of: &schema_data::MeshoptView| {
            buffers.range(document, view, of.buffer, of.byte_offset, of.byte_length)
        };
        buffers.decoded = compressed_views::decode_all(document, &stored, &mut left, steps, tally)?;
        Ok(buffers)
    }

    /// Returns the bytes of a view, and its stride where it has one.
    pub(super) fn view(&self, document: &Document, index: usize) -> Found<(&[u8], Option<usize>)> {
        let view: schema_data::BufferView = document.item(List::BufferViews, index)?;
        let bytes = match self.decoded.get(&index) {
            Some(decoded) => decoded,
            None => self.range(document, index, view.buffer, view.byte_offset, view.byte_length)?,
        };
        // Some exporters write a stride of 0 for "one after the other".
        let stride = view.byte_stride.filter(|stride| *stride > 0);
        Ok((bytes, stride.and_then(|s| usize::try_from(s).ok())))
    }

    /// Returns the bytes of a buffer that a view refers to.
    pub(super) fn range(
        &self,
        document: &Document,
        view: usize,
        buffer: usize,
        from: u64,
        length: u64,
    ) -> Found<&[u8]> {
        let fault = |trouble, detail: &str| document.fault(List::BufferViews, view, trouble, detail);
        let Some(found) = self.buffers.get(buffer) else {
            return Err(fault(Trouble::ITEM_MISSING, &format!("buffers[{buffer}]")));
        };
        let Some(found) = found else { return Err(fault(Trouble::BUFFER_MISSING, "")) };
        let inside = || {
            let from = usize::try_from(from).ok()?;
            found.get(from..from.checked_add(usize::try_from(length).ok()?)?)
        };
        inside().ok_or_else(|| fault(Trouble::OUTSIDE_BUFFER, "the view itself"))
    }
}

/// True for a buffer that only stands for what compressed views are decoded to.
fn is_placeholder(document: &Document, index: usize) -> bool {
    let Ok(json) = document.item::<schema_data::Buffer>(List::Buffers, index) else { return false };
    let [ext, khr] = [json.extensions.ext, json.extensions.khr].map(|e| e.is_some_and(|e| e.fallback));
    let is_compressed = || document.mentions(List::BufferViews, compressed_views::NAME);
    ext || khr || json.uri.is_none() && is_compressed()
}

fn buffer<'t>(
    document: &Document<'t>,
    index: usize,
    finder: &mut Finder,
    left: &mut u64,
) -> Found<Cow<'t, [u8]>> {
    let json: schema_data::Buffer = document.item(List::Buffers, index)?;
    let fault = |trouble, detail: &str| document.fault(List::Buffers, index, trouble, detail);
    let Some(uri) = json.uri else {
        let bin = document.bin.filter(|_| index == 0).map(Cow::Borrowed);
        return bin.ok_or_else(|| fault(Trouble::BUFFER_MISSING, "it has no uri"));
    };
    if let Some(data) = uri::data(&uri) {
        return data.map(Cow::Owned).ok_or_else(|| fault(Trouble::DATA_URI, ""));
    }
    let name = uri::file_name(&uri);
    let found = finder.library(&name);
    let Some(file) = found.file else {
        let detail = format!("'{name}', tried {}", found.tried.join(", "));
        let trouble = if found.outside { Trouble::BUFFER_OUTSIDE } else { Trouble::BUFFER_MISSING };
        return Err(fault(trouble, &detail));
    };
    let bytes = files::read_limited(&file, *left).map_err(|e| fault(Trouble::BUFFER_MISSING, &e.cause))?;
    *left -= bytes.len() as u64;
    Ok(Cow::Owned(bytes))
}
