//! Accessors: numbers in buffers, read one by one in place. Nothing is allocated for sizes that a
//! file only claims.

use super::document::{Document, Found, List};
use super::{buffers::Buffers, schema_data};
use crate::import::trouble::Trouble;

/// Storage type of a number, by its code in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Component {
    I8 = 5120,
    U8 = 5121,
    I16 = 5122,
    U16 = 5123,
    U32 = 5125,
    F32 = 5126,
}

impl Component {
    fn of(code: u32) -> Option<Self> {
        let all = [Self::I8, Self::U8, Self::I16, Self::U16, Self::U32, Self::F32];
        all.into_iter().find(|component| *component as u32 == code)
    }

    fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// Returns the number at the start of `bytes`; zero where there are too few.
    fn read(self, bytes: &[u8], normalized: bool) -> f32 {
        // The equations of the specification for normalised integers.
        let scaled = |value: f32, max: f32| if normalized { (value / max).max(-1.0) } else { value };
        match (self, bytes) {
            (Self::I8, &[a, ..]) => scaled(f32::from(a as i8), 127.0),
            (Self::U8, &[a, ..]) => scaled(f32::from(a), 255.0),
            (Self::I16, &[a, b, ..]) => scaled(f32::from(i16::from_le_bytes([a, b])), 32_767.0),
            (Self::U16, &[a, b, ..]) => scaled(f32::from(u16::from_le_bytes([a, b])), 65_535.0),
            (Self::U32, &[a, b, c, d, ..]) => u32::from_le_bytes([a, b, c, d]) as f32,
            (Self::F32, &[a, b, c, d, ..]) => f32::from_le_bytes([a, b, c, d]),
            _ => 0.0,
        }
    }

    /// Returns the index at the start of `bytes`; `u32::MAX` where there is none.
    fn read_index(self, bytes: &[u8]) -> u32 {
        match (self, bytes) {
            (Self::U8, &[a, ..]) => a.into(),
            (Self::U16, &[a, b, ..]) => u16::from_le_bytes([a, b]).into(),
            (Self::U32, &[a, b, c, d, ..]) => u32::from_le_bytes([a, b, c, d]),
            _ => u32::MAX,
        }
    }
}

/// Elements of a buffer at equal distances. The constructor checks that every element lies inside.
#[derive(Clone, Copy, Debug)]
struct Elements<'a> {
    bytes: &'a [u8],
    stride: usize,
}

impl<'a> Elements<'a> {
    fn at(&self, index: usize) -> &'a [u8] {
        self.bytes.get(index * self.stride..).unwrap_or(&[])
    }
}

/// Elements that replace some of the others.
#[derive(Debug)]
struct Sparse<'a> {
    count: usize,
    component: Component,
    indices: Elements<'a>,
    values: Elements<'a>,
}

impl<'a> Sparse<'a> {
    /// Returns the replacement of an element, by binary search: the indices in a file increase.
    fn find(&self, index: u32) -> Option<&'a [u8]> {
        let (mut low, mut high) = (0, self.count);
        while low < high {
            let middle = (low + high) / 2;
            match self.component.read_index(self.indices.at(middle)).cmp(&index) {
                std::cmp::Ordering::Equal => return Some(self.values.at(middle)),
                std::cmp::Ordering::Less => low = middle + 1,
                std::cmp::Ordering::Greater => high = middle,
            }
        }
        None
    }
}

/// An accessor, all elements of which can be read.
#[derive(Debug)]
pub(super) struct Accessor<'a> {
    pub(super) count: usize,
    component: Component,
    normalized: bool,
    /// `None` where all elements are zero except the sparse ones.
    elements: Option<Elements<'a>>,
    sparse: Option<Sparse<'a>>,
}

impl<'a> Accessor<'a> {
    /// Opens an accessor by its index. Its type must be `shape`, for example `VEC3`.
    pub(super) fn open(document: &Document, buffers: &'a Buffers, index: usize, shape: &str) -> Found<Self> {
        let json: schema_data::Accessor = document.item(List::Accessors, index)?;
        let fault = |trouble, detail: &str| document.fault(List::Accessors, index, trouble, detail);
        let component = Component::of(json.component_type)
            .ok_or_else(|| fault(Trouble::ACCESSOR, &format!("component type {}", json.component_type)))?;
        if json.shape != shape {
            let found: String = json.shape.chars().take(16).collect();
            return Err(fault(Trouble::ACCESSOR, &format!("{found} where {shape} is needed")));
        }
        let size = component.bytes() * width(shape);
        let count = usize::try_from(json.count).ok().filter(|c| *c < u32::MAX as usize);
        let count = count.ok_or_else(|| fault(Trouble::ACCESSOR, &format!("{} elements", json.count)))?;
        let outside = || fault(Trouble::OUTSIDE_BUFFER, &format!("{count} elements of {size} bytes"));
        let elements = |view, offset, size, count| {
            let found = elements(document, buffers, view, offset, size, count)?;
            found.ok_or_else(outside)
        };
        let all = json.buffer_view.map(|view| elements(view, json.byte_offset, size, count)).transpose()?;
        let sparse = json.sparse.map(|s| -> Found<Sparse> {
            let component = s.indices.component_type.and_then(Component::of).unwrap_or(Component::U32);
            let count = usize::try_from(s.count).map_err(|_| outside())?;
            let indices = elements(s.indices.buffer_view, s.indices.byte_offset, component.bytes(), count)?;
            let values = elements(s.values.buffer_view, s.values.byte_offset, size, count)?;
            Ok(Sparse { count, component, indices, values })
        });
        Ok(Self { count, component, normalized: json.normalized, elements: all, sparse: sparse.transpose()? })
    }

    /// False where no buffer holds the elements: all are zero.
    pub(super) fn has_data(&self) -> bool {
        self.elements.is_some() || self.sparse.is_some()
    }

    fn bytes(&self, index: u32) -> &'a [u8] {
        let replaced = self.sparse.as_ref().and_then(|s| s.find(index));
        replaced.or_else(|| Some(self.elements.as_ref()?.at(index as usize))).unwrap_or(&[])
    }

    /// Returns an element as numbers; zero beyond the last.
    pub(super) fn vector<const N: usize>(&self, index: u32) -> [f32; N] {
        let bytes = self.bytes(index);
        let number = |i: usize| bytes.get(i * self.component.bytes()..).unwrap_or(&[]);
        std::array::from_fn(|i| self.component.read(number(i), self.normalized))
    }

    /// Returns an element as an index; an index that no vertex has where the element is not an
    /// index.
    pub(super) fn index(&self, index: u32) -> u32 {
        match (&self.elements, &self.sparse) {
            (None, None) => 0,
            _ => self.component.read_index(self.bytes(index)),
        }
    }
}

fn width(shape: &str) -> usize {
    match shape {
        "SCALAR" => 1,
        "VEC2" => 2,
        "VEC3" => 3,
        _ => 4,
    }
}

/// Returns the elements of a view, or `None` where they do not lie inside it.
fn elements<'a>(
    document: &Document,
    buffers: &'a Buffers,
    view: usize,
    offset: u64,
    size: usize,
    count: usize,
) -> Found<Option<Elements<'a>>> {
    let (bytes, stride) = buffers.view(document, view)?;
    let stride = stride.unwrap_or(size);
    let inside = || {
        let bytes = bytes.get(usize::try_from(offset).ok()?..)?;
        let end = count.checked_sub(1)?.checked_mul(stride)?.checked_add(size)?;
        (stride >= size && end <= bytes.len()).then_some(Elements { bytes, stride })
    };
    Ok(inside())
}
