//! What stands between the pixels of a surface.

use super::surfaces::{Facet, Likenesses, Surfaces};
use crate::trace::Tracer;
use glam::Vec3;
use rayon::prelude::*;

/// Height above the surfaces, as a share of the distance between two places, at which they must see
/// each other to share light. An arc that turns by 37 degrees from one to the other rises by 0.08.
pub(super) const LIFT: f32 = 0.25;

/// What stands between the pixels of a surface.
pub(super) struct Walls<'a> {
    surfaces: &'a Surfaces,
    eye: Vec3,
    tracer: &'a Tracer,
    /// Walls between neighbours on one surface, so thin that no pixel shows them.
    thin: Steps,
    /// Borders between neighbours on different surfaces, or of which one has no samples.
    borders: Steps,
}

impl<'a> Walls<'a> {
    /// Finds the walls of a picture, whose neighbours are compared in `near`.
    pub(super) fn between(surfaces: &'a Surfaces, near: &Likenesses, eye: Vec3, tracer: &'a Tracer) -> Self {
        let [right, _, below, _] = &near.shares;
        let borders = Steps::count(surfaces.size, |at| right[at] == 0, |at| below[at] == 0);
        let mut walls = Self { surfaces, eye, tracer, thin: Steps::NONE, borders };
        let width = surfaces.size[0];
        let thin = Steps::count(
            surfaces.size,
            |at| right[at] > 0 && !walls.see_each_other(at, at + 1),
            |at| below[at] > 0 && !walls.see_each_other(at, at + width),
        );
        walls.thin = if thin.is_empty() { Steps::NONE } else { thin };
        walls
    }

    /// True where two pixels see each other from a little above their surfaces.
    fn see_each_other(&self, a: usize, b: usize) -> bool {
        let [a, b] = [a, b].map(|at| self.surfaces.facet(at));
        let place = |facet: Facet| (self.eye + facet.position, facet.normal);
        self.tracer.see_each_other(place(a), place(b), LIFT)
    }

    /// The pixels from `at` on, one bit each, between which and the pixels from `other` on there
    /// may be a wall: at most 32. `corner` is the pixel in the row of `at` and the column of
    /// `other`.
    #[inline(always)]
    pub(super) fn crossings(&self, at: usize, other: usize, corner: usize, count: usize) -> u32 {
        self.thin.crossed(at, other, corner, count) | self.borders.crossed(at, other, corner, count)
    }

    /// True where no wall is between two pixels of a surface. Behind the border of another surface,
    /// a ray decides.
    pub(super) fn are_absent(&self, at: usize, other: usize, corner: usize) -> bool {
        self.thin.crossed(at, other, corner, 1) == 0
            && (self.borders.crossed(at, other, corner, 1) == 0
                || self.see_each_other(at.min(other), at.max(other)))
    }
}

/// Counts of steps from one pixel to the next that cross something, summed up along each row and
/// each column, so that the number between any two pixels of a line is a difference.
struct Steps {
    width: usize,
    along_rows: Vec<u32>,
    along_columns: Vec<u32>,
}

impl Steps {
    /// No step crosses anything.
    const NONE: Self = Self { width: 0, along_rows: Vec::new(), along_columns: Vec::new() };

    /// Counts the steps from each pixel to its right and to its lower neighbour that cross
    /// something.
    fn count(
        [width, height]: [usize; 2],
        crosses_right: impl Fn(usize) -> bool + Sync,
        crosses_down: impl Fn(usize) -> bool + Sync,
    ) -> Self {
        let mut along_rows = vec![0; width * height];
        along_rows.par_chunks_mut(width.max(1)).enumerate().for_each(|(y, row)| {
            for x in 1..width {
                row[x] = row[x - 1] + u32::from(crosses_right(y * width + x - 1));
            }
        });
        let mut along_columns = vec![0; width * height];
        along_columns.par_chunks_mut(width.max(1)).enumerate().skip(1).for_each(|(y, row)| {
            let above = (y - 1) * width;
            row.iter_mut().zip(above..).for_each(|(step, at)| *step = u32::from(crosses_down(at)));
        });
        for at in width..along_columns.len() {
            along_columns[at] += along_columns[at - width];
        }
        Self { width, along_rows, along_columns }
    }

    fn is_empty(&self) -> bool {
        let width = self.width.max(1);
        let last_row = self.along_columns.len().saturating_sub(width);
        self.along_rows.chunks(width).all(|row| row.last() == Some(&0))
            && self.along_columns[last_row..].iter().all(|&steps| steps == 0)
    }

    /// The pixels from `at` on, one bit each, for which a step crosses something on the way to
    /// those from `other` on, along the row of the first and the column of the second.
    #[inline(always)]
    fn crossed(&self, at: usize, other: usize, corner: usize, count: usize) -> u32 {
        if self.along_rows.is_empty() {
            return 0;
        }
        let rows = self.along_rows[at..at + count].iter().zip(&self.along_rows[corner..corner + count]);
        let columns =
            self.along_columns[corner..corner + count].iter().zip(&self.along_columns[other..other + count]);
        let steps = rows.zip(columns).map(|((a, b), (c, d))| (a ^ b) | (c ^ d));
        steps.enumerate().fold(0, |bits, (lane, steps)| bits | u32::from(steps != 0) << lane)
    }
}
