//! What stands between the pixels of a surface.

use super::surfaces::{DIRECTIONS, Facet, Likenesses, Surfaces};
use crate::trace::Tracer;
use glam::Vec3;
use rayon::prelude::*;

/// Height above the surfaces, as a share of the distance between two places, at which they must see
/// each other to share light. An arc that turns by 37 degrees from one to the other rises by 0.08.
pub(super) const LIFT: f32 = 0.25;

/// Pairs of pixels whose walls are examined at a time.
const LANES: usize = 16;

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

    /// Ends the likeness of neighbours at walls.
    pub(super) fn end(&self, likenesses: &mut Likenesses) {
        let ([width, height], step) = (self.surfaces.size, likenesses.step);
        for (plane, (dx, dy)) in likenesses.shares.iter_mut().zip(DIRECTIONS) {
            let (across, down) = (dx * step.cast_signed(), dy * step);
            let columns = across.min(0).unsigned_abs()..width.saturating_sub(across.max(0).unsigned_abs());
            let rows = plane.par_chunks_mut(width.max(1)).take(height.saturating_sub(down)).enumerate();
            rows.for_each(|(y, row)| {
                for span in self.surfaces.spans_in(y, columns.clone()) {
                    let at = y * width + span.start;
                    let corner = at.wrapping_add_signed(across);
                    let pairs = Pairs { at, other: corner + down * width, corner, below: at + down * width };
                    self.end_row(pairs, &mut row[span]);
                }
            });
        }
    }

    /// Ends the likeness of the pixels of a row and their neighbours at walls.
    fn end_row(&self, first: Pairs, shares: &mut [u8]) {
        for (group, shares) in shares.chunks_mut(LANES).enumerate() {
            if shares.iter().all(|&share| share == 0) {
                continue;
            }
            let pairs = first.ahead(group * LANES);
            let (thin, borders) =
                (self.thin.crossed(pairs, shares.len()), self.borders.crossed(pairs, shares.len()));
            if thin | borders == 0 {
                continue;
            }
            for (lane, share) in shares.iter_mut().enumerate().filter(|(_, share)| **share > 0) {
                let pair = pairs.ahead(lane);
                // Behind the border of another surface, a ray decides.
                let is_behind = || borders >> lane & 1 == 1 && !self.see_each_other(pair.at, pair.other);
                if thin >> lane & 1 == 1 || is_behind() {
                    *share = 0;
                }
            }
        }
    }
}

/// Pixels, and those at the other corners of the rectangles that they span with their neighbours: a
/// run of each, by its first.
#[derive(Clone, Copy)]
struct Pairs {
    at: usize,
    other: usize,
    /// In the row of `at` and the column of `other`.
    corner: usize,
    /// In the row of `other` and the column of `at`.
    below: usize,
}

impl Pairs {
    fn ahead(self, by: usize) -> Self {
        let Self { at, other, corner, below } = self;
        Self { at: at + by, other: other + by, corner: corner + by, below: below + by }
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

    /// The pairs of a run, at most 32, one bit each, for which a step crosses something on one of
    /// the two ways between them along a row and a column.
    #[inline(always)]
    fn crossed(&self, first: Pairs, count: usize) -> u32 {
        if self.along_rows.is_empty() {
            return 0;
        }
        let Pairs { at, other, corner, below } = first;
        let run = |steps: &'_ [u32], first: usize| -> [u32; LANES] {
            let mut run = [0; LANES];
            run[..count].copy_from_slice(&steps[first..first + count]);
            run
        };
        let apart = |steps: &[u32], a: usize, b: usize| {
            let (a, b) = (run(steps, a), run(steps, b));
            std::array::from_fn::<bool, LANES, _>(|lane| a[lane] != b[lane])
        };
        let (rows, columns) = (&self.along_rows, &self.along_columns);
        let sides = [
            apart(rows, at, corner),
            apart(columns, corner, other),
            apart(columns, at, below),
            apart(rows, below, other),
        ];
        (0..LANES).fold(0, |bits, lane| bits | u32::from(sides.iter().any(|side| side[lane])) << lane)
    }
}
