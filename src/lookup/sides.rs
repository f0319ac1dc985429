//! Keeps light of the other side of a wall out of mode `fast`, which checks no guess.
//!
//! A sample next to an edge may lie on the same floor as a point and yet on the other side of a
//! wall that stands between them. Where some of the samples around a point lie on surfaces in front
//! of its plane, or hold no light, such an edge may be near: there, the samples that the point does
//! not see are left out. Points whose four samples all lie on their plane need no rays: they lie
//! between their samples, and light that differs too much from one to the other is not used
//! ([`super::policy::MAX_SMOOTH_SPREAD`]). Samples behind the plane show that the surface ends
//! before them, with no wall on it.
//!
//! With direct light alone nothing is left out: there an edge of light has no such consequences as
//! the light of another room.

use super::found::{FoundLight, Sampled};
use super::point::LookupReference;
use super::policy::{LIFT, WHOLE_COVERAGE};
use super::{SurfaceKey, TileLight, TilePoints, ViewLookup};
use crate::raster::pixel_types::NO_SUPPLIER;
use crate::trace::Tracer;
use glam::Vec3;

impl LookupReference<'_> {
    /// The light as [`Self::light_at`] finds it, without that of samples that a wall hides from the
    /// point.
    pub(super) fn light_seen_at(
        &self,
        tracer: &Tracer,
        point: &SurfaceKey,
        triangle: u32,
    ) -> Option<Sampled> {
        let SurfaceKey { position, normal, .. } = *point;
        let all = self.light_at::<false>(position, normal, triangle, |_| true)?;
        if all.coverage + all.open >= WHOLE_COVERAGE || self.smooth.is_empty() {
            return Some(all);
        }
        self.light_at::<false>(position, normal, triangle, |sample| sees(tracer, point, sample))
    }
}

/// True where a point and a sample on its plane see each other from a little above it.
fn sees(tracer: &Tracer, point: &SurfaceKey, sample: Vec3) -> bool {
    tracer.see_each_other((point.position, point.normal), (sample, point.normal), LIFT)
}

impl ViewLookup<'_> {
    /// Leaves out the light of samples that a wall hides from their pixel. A pixel that is left
    /// without light asks all references, and is not known if none has any.
    pub(super) fn leave_out_hidden(&self, tracer: &Tracer, points: &TilePoints, found: &mut TileLight) {
        let mut doubtful = found.known & !found.whole();
        while doubtful != 0 {
            let pixel = doubtful.trailing_zeros() as usize;
            doubtful &= doubtful - 1;
            let (key, triangle) = (self.key(points, pixel), points.triangle[pixel]);
            let supplier = self.set.references.get(usize::from(found.slot[pixel])).and_then(Option::as_ref);
            match supplier.and_then(|reference| reference.light_seen_at(tracer, &key, triangle)) {
                Some(Sampled { light, smooth, .. }) => found.set(pixel, light, smooth),
                None => {
                    found.slot[pixel] = NO_SUPPLIER;
                    found.known &= !(1 << pixel);
                    if let Some(FoundLight { light, smooth, .. }) =
                        self.set.unchecked_light_at(tracer, &key, triangle)
                    {
                        found.set(pixel, light, smooth);
                    }
                }
            }
        }
    }
}
