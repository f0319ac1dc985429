//! The light of two references of one view, taken together.

use super::ReferenceFrame;
use crate::raster::rgb9e5::Rgb9e5Scale;
use crate::reference::light::{UNLIT, pack_light};
use glam::Vec3;

impl ReferenceFrame {
    /// True where both show the same pixels in the same state of the scene, and no light is stale.
    pub(crate) fn can_merge(&self, other: &Self) -> bool {
        let is_same_view = self.camera == other.camera && self.view.size == other.view.size;
        let is_same_light = self.epoch == other.epoch && self.settings.bounces == other.settings.bounces;
        let is_whole = |frame: &Self| frame.stale() == 0 && frame.lost.is_empty();
        is_same_view && is_same_light && is_whole(self) && is_whole(other)
    }

    /// This reference with the light of an earlier one of the same view, whose samples are
    /// independent: each pixel has the mean of both, weighted by their numbers of samples. A pixel
    /// that one of them has not lit has the light of the other. To be called where
    /// [`Self::can_merge`].
    #[must_use]
    pub(crate) fn merged(&self, earlier: &Self) -> Self {
        let [old, new] = [earlier, self].map(|frame| frame.settings.samples.max(1));
        let share = (f64::from(new) / (f64::from(old) + f64::from(new))) as f32;
        let pixels = || 0..self.light.len();
        let lit = |frame: &Self, pixel: usize| frame.light[pixel] != UNLIT;
        let mean = |pixel: usize, light: &dyn Fn(&Self) -> Vec3| match (lit(earlier, pixel), lit(self, pixel))
        {
            (false, _) => light(self),
            (_, false) => light(earlier),
            _ => light(earlier).lerp(light(self), share),
        };
        let direct = |pixel| mean(pixel, &|frame| frame.light_scale.unpack(frame.light[pixel]));
        let smooth = |pixel| mean(pixel, &|frame| frame.smooth_scale.unpack(frame.smooth[pixel]));
        let is_lit = |pixel: &usize| lit(self, *pixel) || lit(earlier, *pixel);
        let mut merged = self.clone();
        merged.forget_layers();
        merged.settings.samples = old.saturating_add(new);
        merged.light_scale = scale_of(pixels().filter(is_lit).map(direct));
        for pixel in pixels().filter(is_lit) {
            merged.light[pixel] = pack_light(merged.light_scale, direct(pixel));
        }
        if self.has_smooth_light() {
            merged.smooth_scale = scale_of(pixels().filter(is_lit).map(smooth));
            for pixel in pixels().filter(is_lit) {
                merged.smooth[pixel] = merged.smooth_scale.pack(smooth(pixel));
            }
        }
        merged.lit = pixels().filter(is_lit).count();
        merged
    }
}

fn scale_of(lights: impl Iterator<Item = Vec3>) -> Rgb9e5Scale {
    Rgb9e5Scale::for_largest(lights.map(Vec3::max_element).fold(0.0, f32::max))
}
