//! Pixels of a reference whose light no longer holds, because the scene has changed since.

use super::ReferenceFrame;
use super::stale_light::StaleLight;
use crate::reference::light::UNLIT;
use crate::reference::stale::Mark;
use crate::scene::Scene;
use crate::trace::{NO_TRIANGLE, SceneEpoch};
use glam::Vec3;
use std::sync::Arc;

impl ReferenceFrame {
    /// True where the light of a pixel was traced, whether it still holds or not.
    #[inline(always)]
    pub(crate) fn was_lit(&self, pixel: u32) -> bool {
        self.traced_words()[pixel as usize] != UNLIT
    }

    /// All light that was traced for a pixel, whether it still holds or not. Meaningful only if
    /// [`Self::was_lit`].
    pub(crate) fn traced_light(&self, pixel: u32) -> Vec3 {
        let direct = self.light_scale.unpack(self.traced_words()[pixel as usize]);
        self.smooth.get(pixel as usize).map_or(direct, |&word| direct + self.smooth_scale.unpack(word))
    }

    fn traced_words(&self) -> &[u32] {
        self.stale.as_ref().map_or(&self.light, |stale| &stale.traced)
    }

    /// Number of pixels whose light no longer holds.
    pub fn stale(&self) -> usize {
        self.stale.as_ref().map_or(0, |stale| stale.count)
    }

    /// Packed direct light of the pixels where that holds, whether their smooth light does or not;
    /// empty where it holds in no stale pixel.
    pub(crate) fn held_direct(&self) -> &[u32] {
        self.stale.as_ref().map_or(&[], |stale| &stale.held)
    }

    /// Number of stale pixels whose direct light holds.
    pub(crate) fn stale_with_direct(&self) -> usize {
        let held = self.held_direct().iter().zip(&self.light);
        held.filter(|&(&held, &light)| held != UNLIT && light == UNLIT).count()
    }

    /// Packed direct light of all pixels as it was traced, where some is stale; else empty.
    pub(crate) fn stale_words(&self) -> &[u32] {
        self.stale.as_ref().map_or(&[], |stale| &stale.traced)
    }

    /// Marks what still holds in another state of the scene, to which the reference belongs from
    /// now on.
    pub(crate) fn mark(&mut self, epoch: SceneEpoch, mut marks: Vec<Mark>) {
        self.epoch = epoch;
        for (mark, &lost) in marks.iter_mut().zip(&self.lost) {
            *mark = lost.max(*mark);
        }
        let traced = match self.stale.take() {
            Some(stale) => stale.traced,
            None => self.light.clone(),
        };
        let is_stale = |(&word, &mark): (&u32, &Mark)| word != UNLIT && mark != Mark::Holds;
        let count = traced.iter().zip(&marks).filter(|&of| is_stale(of)).count();
        self.lit = traced.iter().filter(|&&word| word != UNLIT).count() - count;
        // The number of reflections may have changed, and objects have moved.
        self.is_dense = false;
        if count == 0 {
            self.light = traced;
            return;
        }
        let up_to = |worst: Mark| -> Vec<u32> {
            traced.iter().zip(&marks).map(|(&word, &mark)| if mark <= worst { word } else { UNLIT }).collect()
        };
        self.light = up_to(Mark::Holds);
        let held = if marks.contains(&Mark::DirectHolds) { up_to(Mark::DirectHolds) } else { Vec::new() };
        self.stale = Some(Box::new(StaleLight { traced, held, count }));
    }

    /// Sets the state of the scene, with its geometry of now, that the light was traced in.
    pub(crate) fn set_origin(&mut self, origin: &Arc<Scene>) {
        self.origin = Arc::clone(origin);
    }

    /// Follows its triangles to their numbers in a scene that was loaded again. `origin` is the
    /// state that its light was traced in, with the triangles of that scene.
    /// `marks` say what objects that moved left of it; pixels of triangles that are gone are no
    /// longer used.
    pub(crate) fn renumber(&mut self, new_of_old: &[u32], origin: Arc<Scene>, marks: Option<Vec<Mark>>) {
        for (triangle, disparity) in self.triangle.iter_mut().zip(&mut self.disparity) {
            let number = new_of_old.get(*triangle as usize).copied();
            if number == Some(NO_TRIANGLE) {
                *disparity = f32::NAN;
            }
            *triangle = number.unwrap_or(NO_TRIANGLE);
        }
        if let Some(mut marks) = marks {
            for (mark, &lost) in marks.iter_mut().zip(&self.lost) {
                *mark = lost.max(*mark);
            }
            self.lost = marks;
            self.moves = self.moves.saturating_add(1);
        }
        self.origin = origin;
        self.forget_layers();
    }

    /// The share of the tolerated change that one more edit may use: each time that objects moved
    /// took half, because they are compared with the state before, not with the first.
    pub(crate) fn share_of_change(&self) -> f32 {
        0.5f32.powi(i32::from(self.moves))
    }

    /// Discards the light in a square of pixels and returns how many pixels held light.
    pub(crate) fn forget_light(&mut self, [x0, y0]: [u32; 2], side: u32) -> usize {
        let [width, height] = self.view.size;
        let mut forgotten = 0;
        for y in y0..(y0 + side).min(height) {
            for x in x0..(x0 + side).min(width) {
                let pixel = (y * width + x) as usize;
                self.forget_stale(pixel);
                forgotten += usize::from(std::mem::replace(&mut self.light[pixel], UNLIT) != UNLIT);
            }
        }
        self.lit = self.lit.saturating_sub(forgotten);
        self.is_dense &= forgotten == 0;
        if forgotten > 0 {
            self.forget_layers();
        }
        forgotten
    }

    /// Forgets the stale light of a pixel.
    pub(super) fn forget_stale(&mut self, pixel: usize) {
        let Some(stale) = &mut self.stale else { return };
        let was_stale = stale.traced[pixel] != UNLIT && self.light[pixel] == UNLIT;
        stale.count -= usize::from(was_stale);
        stale.traced[pixel] = UNLIT;
        if let Some(word) = stale.held.get_mut(pixel) {
            *word = UNLIT;
        }
    }

    /// Memory of the light that is stale, bytes.
    pub(super) fn stale_bytes(&self) -> usize {
        self.lost.len() + self.stale.as_ref().map_or(0, |stale| 4 * (stale.traced.len() + stale.held.len()))
    }
}
