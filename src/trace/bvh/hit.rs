//! The result of tracing a ray.

/// Triangle index of a ray that hits nothing, and of a sky pixel.
pub const NO_TRIANGLE: u32 = u32::MAX;

/// A triangle met by a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance, in units of the ray's direction.
    pub t: f32,
    /// Index into the scene's triangles.
    pub triangle: u32,
    /// Barycentric weight of the second corner.
    pub b1: f32,
    /// Barycentric weight of the third corner.
    pub b2: f32,
}
