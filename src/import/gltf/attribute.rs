//! An attribute of the vertices of a primitive, stored in a buffer or decoded from a compressed
//! mesh.

use super::accessor::Accessor;
use super::buffers::Buffers;
use super::document::{Document, Found, List};
use super::draco::DracoMesh;
use super::schema_data;
use crate::import::trouble::Trouble;

/// An attribute of all vertices.
pub(super) enum Attribute<'a> {
    Stored(Accessor<'a>),
    /// `width` numbers for each vertex.
    Decoded {
        values: Vec<f32>,
        width: usize,
    },
}

impl<'a> Attribute<'a> {
    /// Opens a stored attribute.
    pub(super) fn open(document: &Document, buffers: &'a Buffers, index: usize, shape: &str) -> Found<Self> {
        Ok(Self::Stored(Accessor::open(document, buffers, index, shape)?))
    }

    /// Takes an attribute of a decoded mesh: `id` is its number there, `accessor` describes it.
    pub(super) fn of(
        mesh: &DracoMesh,
        id: usize,
        document: &Document,
        accessor: usize,
        width: usize,
    ) -> Found<Self> {
        let json: schema_data::Accessor = document.item(List::Accessors, accessor)?;
        let missing = || {
            let detail = format!("attribute {id} of the compressed mesh");
            document.fault(List::Accessors, accessor, Trouble::ITEM_MISSING, &detail)
        };
        let values = mesh.attribute(id, width, json.normalized).ok_or_else(missing)?;
        Ok(Self::Decoded { values, width })
    }

    /// Returns the number of vertices.
    pub(super) fn count(&self) -> usize {
        match self {
            Self::Stored(accessor) => accessor.count,
            Self::Decoded { values, width } => values.len() / width,
        }
    }

    /// Returns the numbers of a vertex; zero beyond the last.
    pub(super) fn vector<const N: usize>(&self, vertex: u32) -> [f32; N] {
        match self {
            Self::Stored(accessor) => accessor.vector(vertex),
            Self::Decoded { values, width } => {
                let first = vertex as usize * width;
                std::array::from_fn(|i| values.get(first + i).copied().unwrap_or(0.0))
            }
        }
    }
}
