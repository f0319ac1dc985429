//! Which stored references serve a view.
//!
//! A sparse reference lights what older ones do not know, so the light of several adds up: those
//! are chosen, one after the other, that light most of what those before leave dark. The estimate
//! counts pixels by cells of space and reads no pixel.

use super::cells::{Cell, CellCounts};

/// How often each surface should be covered: the estimate is rough, and a mean over several
/// references has less noise.
pub(super) const WANTED_COVER: f32 = 2.0;

/// The same for light of another state of the scene, of which little may hold: it is read only
/// where there is no other.
pub(super) const WANTED_STALE: f32 = 1.0;

/// Least share of the picture that a reference must add.
const MIN_GAIN: f32 = 0.002;

/// Pixels of a view per pixel of a reference up to which the reference is as fine as needed.
const FINE: f32 = 4.0;

/// What a view shows, and how much of it is covered.
pub(super) struct Cover<'v> {
    seen: &'v [(Cell, f32)],
    pixels: f32,
    covered: Vec<f32>,
}

/// The share of each cell of a view that a reference covers: index of the cell, and 0..1.
pub(super) type Shares = Vec<(usize, f32)>;

impl<'v> Cover<'v> {
    /// Begins with nothing covered. `seen` are the cells of the view, ascending, with their shares
    /// of the picture.
    pub(super) fn new(seen: &'v [(Cell, f32)], size: [u32; 2]) -> Self {
        let pixels = size.map(|edge| edge as f32).iter().product();
        Self { seen, pixels, covered: vec![0.0; seen.len()] }
    }

    /// The shares of the cells that a reference covers.
    pub(super) fn shares(&self, counts: &CellCounts) -> Shares {
        let mut shares = Shares::new();
        let mut at = 0;
        for count in &counts.counts {
            at += self.seen[at..].partition_point(|(cell, _)| *cell < count.cell);
            let Some((cell, share)) = self.seen.get(at) else { break };
            if *cell == count.cell {
                let fineness = FINE * count.seen as f32 / (share * self.pixels);
                shares.push((at, count.lit as f32 / count.seen.max(1) as f32 * fineness.min(1.0)));
            }
        }
        shares
    }

    /// Share of the picture that a reference would add, 0..1.
    fn gain(&self, shares: &Shares, wanted: f32) -> f32 {
        let gain =
            |&(at, share): &(usize, f32)| self.seen[at].1 * share.min((wanted - self.covered[at]).max(0.0));
        shares.iter().map(gain).sum()
    }

    /// Counts what a reference covers.
    pub(super) fn add(&mut self, shares: &Shares) {
        shares.iter().for_each(|&(at, share)| self.covered[at] += share);
    }

    /// The share of the surfaces in the picture that is covered at least once, 0..1.
    pub(super) fn lit_share(&self) -> f32 {
        let shares = self.seen.iter().zip(&self.covered);
        let (lit, all) = shares.fold((0.0, 0.0), |(lit, all), ((_, share), covered)| {
            (lit + share * covered.min(1.0), all + share)
        });
        if all > 0.0 { (lit / all).min(1.0) } else { 0.0 }
    }

    /// Chooses some of the references, best first, until surfaces are covered as often as wanted,
    /// and returns their indices.
    pub(super) fn choose(&mut self, references: &[Shares], wanted: f32) -> Vec<usize> {
        let mut gains: Vec<f32> = references.iter().map(|shares| self.gain(shares, wanted)).collect();
        let mut chosen = Vec::new();
        // The gain of a reference only ever falls, so the best old gain need not be beaten by all.
        while let Some(best) = (0..gains.len()).max_by(|&a, &b| gains[a].total_cmp(&gains[b]).then(b.cmp(&a)))
            && gains[best] >= MIN_GAIN
        {
            let gain = self.gain(&references[best], wanted);
            let is_best = gains.iter().enumerate().all(|(at, &other)| at == best || other <= gain);
            gains[best] = gain;
            if is_best && gain >= MIN_GAIN {
                self.add(&references[best]);
                gains[best] = 0.0;
                chosen.push(best);
            }
        }
        chosen
    }
}

#[cfg(test)]
mod tests {
    use super::super::cells::CellCount;
    use super::*;

    fn cell(x: i32) -> Cell {
        Cell { cube: [x, 0, 0], face: 2 }
    }

    fn counts(cells: &[(i32, u32)]) -> CellCounts {
        let count = |&(x, lit): &(i32, u32)| CellCount { cell: cell(x), lit, seen: 100 };
        CellCounts { side_m: 1.0, counts: cells.iter().map(count).collect() }
    }

    #[test]
    fn those_are_chosen_that_light_what_others_leave_dark() {
        let seen = [(cell(0), 0.6), (cell(1), 0.3), (cell(3), 0.1)];
        let mut cover = Cover::new(&seen, [10, 10]);
        let stored = [
            counts(&[(-1, 100), (5, 100)]), // shows nothing of the view
            counts(&[(0, 50), (1, 100)]),
            counts(&[(0, 100)]),
            counts(&[(0, 100), (2, 100)]),
            counts(&[(0, 100)]), // more than enough
            counts(&[(3, 100)]),
        ];
        let shares: Vec<Shares> = stored.iter().map(|counts| cover.shares(counts)).collect();
        // Half of the largest cell and all of the next; twice the largest; the last one.
        let chosen = cover.choose(&shares, WANTED_COVER);
        assert!(chosen == [1, 2, 4, 5] && cover.covered == [2.5, 1.0, 1.0], "{chosen:?}");
    }

    #[test]
    fn a_coarse_reference_covers_less() {
        let seen = [(cell(0), 1.0)];
        let cover = Cover::new(&seen, [80, 40]);
        let shares = cover.shares(&counts(&[(0, 50)]));
        assert_eq!(shares, [(0, 0.5 * 4.0 * 100.0 / 3200.0)]);
    }
}
