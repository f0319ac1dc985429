//! Meshes that are compressed by `KHR_draco_mesh_compression`, decoded by the crate `draco-core`.

/// A decoded mesh.
pub(super) struct DracoMesh {
    pub(super) triangles: Vec<[u32; 3]>,
    /// Number of vertices.
    pub(super) count: usize,
    #[cfg(feature = "draco")]
    mesh: draco_core::Mesh,
}

#[cfg(not(feature = "draco"))]
impl DracoMesh {
    /// This build has no decoder.
    pub(super) fn decode(_: &[u8], _: usize) -> Result<Self, String> {
        Err("this build was made without the feature draco".to_owned())
    }

    /// There is no mesh.
    pub(super) fn attribute(&self, _: usize, _: usize, _: bool) -> Option<Vec<f32>> {
        None
    }
}

#[cfg(feature = "draco")]
impl DracoMesh {
    /// Decodes a mesh of at most `limit` vertices and `limit` triangles.
    pub(super) fn decode(bytes: &[u8], limit: usize) -> Result<Self, String> {
        use std::panic::{AssertUnwindSafe, catch_unwind};
        let decoded = catch_unwind(AssertUnwindSafe(|| decode(bytes, limit)));
        decoded.unwrap_or_else(|_| Err("the decoder failed on it".to_owned()))
    }

    /// Returns `width` numbers for each vertex of the attribute with this id.
    pub(super) fn attribute(&self, id: usize, width: usize, is_normalized: bool) -> Option<Vec<f32>> {
        use draco_core::DataType;
        let attribute = self.mesh.attribute_by_unique_id(u32::try_from(id).ok()?)?;
        let mut values = attribute.read_f32s(self.count, width);
        let most = match attribute.data_type() {
            DataType::Int8 => 127.0,
            DataType::Uint8 => 255.0,
            DataType::Int16 => 32_767.0,
            DataType::Uint16 => 65_535.0,
            _ => return Some(values),
        };
        // The equations of the specification for normalised integers.
        if is_normalized {
            values.iter_mut().for_each(|value| *value = (*value / most).max(-1.0));
        }
        Some(values)
    }
}

#[cfg(feature = "draco")]
fn decode(bytes: &[u8], limit: usize) -> Result<DracoMesh, String> {
    use draco_core::{DecodeLimits, DecoderBuffer, Mesh, MeshDecoder};
    /// Bytes of all attributes of a vertex: position, normal, tangent, colours, texture
    /// coordinates.
    const VERTEX_BYTES: u64 = 128;
    let limit = limit as u64;
    let limits = DecodeLimits::default()
        .with_max_points(limit)
        .with_max_faces(limit)
        .with_max_decoded_bytes(limit.saturating_mul(VERTEX_BYTES));
    let mut buffer = DecoderBuffer::new(bytes).with_limits(limits);
    let mut mesh = Mesh::new();
    MeshDecoder::new().decode(&mut buffer, &mut mesh).map_err(|error| error.to_string())?;
    let count = mesh.num_points();
    if count as u64 > limit {
        return Err(format!("{count} vertices"));
    }
    let triangles = mesh.faces().iter().map(|face| face.map(|point| point.0)).collect();
    Ok(DracoMesh { triangles, count, mesh })
}
