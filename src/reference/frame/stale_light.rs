//! Light of a reference that no longer holds.

/// The light of a reference some of whose pixels are stale.
#[derive(Clone, Debug)]
pub(super) struct StaleLight {
    /// Packed direct light of all pixels as it was traced.
    pub(super) traced: Vec<u32>,
    /// Packed direct light of all pixels where that holds; empty where it holds in no stale one.
    pub(super) held: Vec<u32>,
    /// Number of stale pixels.
    pub(super) count: usize,
}
