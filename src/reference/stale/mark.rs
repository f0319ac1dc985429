//! What an edit leaves of the light of a pixel.

use crate::scene::{Material, Scene};

/// Light that differs by at most this share of a pixel's light still holds.
pub const MAX_CHANGE: f32 = 0.01;

/// The share of [`MAX_CHANGE`] at which a pixel is marked: an estimate of few samples may be too
/// low.
pub(super) const SAFETY: f32 = 0.5;

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

/// True where a surface may have been black in one scene and is not in another. It is given by its
/// triangle in each.
pub(super) fn was_black([(old, before), (new, now)]: [(&Scene, u32); 2]) -> bool {
    let [before, now] = [old.material_of(before), new.material_of(now)];
    let may_be_black = !before.has_base() || before.diffuse_texture.is_some();
    let of = |m: &Material| (m.diffuse, m.diffuse_texture, m.has_base());
    may_be_black && of(before) != of(now)
}
