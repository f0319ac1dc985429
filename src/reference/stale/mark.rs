//! What an edit leaves of the light of a pixel.

/// What still holds of the light of a pixel, from all to nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Mark {
    /// All of it, or there was none.
    #[default]
    Holds,
    /// The light straight from the lights.
    DirectHolds,
    /// Nothing.
    Stale,
}
