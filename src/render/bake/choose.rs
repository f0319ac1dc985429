//! Which poses a plan has, and in which order: the next is always the one whose reference adds most
//! to what viewers see lit.
//!
//! Source: such a choice reaches at least 1 - 1/e = 63 % of what the best set of equal size does
//! (Nemhauser, Wolsey and Fisher, "An analysis of approximations for maximizing submodular set
//! functions", 1978). The gain of a pose only ever falls, so most gains need not be computed again
//! (Minoux, "Accelerated greedy algorithms", 1978).

use super::demand::{Counts, Cover, Demand};
use rayon::prelude::*;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Least gain of a reference, as a share of a picture: what viewers see of less is shaded by their
/// frames.
const MIN_GAIN: f64 = 0.1;

/// References of a plan, at most.
const MAX_REFERENCES: usize = 4096;

/// A pose and what it would add when that was computed last.
#[derive(Clone, Copy, Debug)]
struct Offer {
    gain: f64,
    pose: usize,
    /// Number of poses that were chosen then.
    chosen: usize,
}

impl Ord for Offer {
    fn cmp(&self, other: &Self) -> Ordering {
        self.gain.total_cmp(&other.gain).then(other.pose.cmp(&self.pose))
    }
}

impl PartialOrd for Offer {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Offer {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Offer {}

/// Chooses poses by what they show, and returns their indices, the most useful first. A picture has
/// this number of `pixels`.
pub(super) fn choose(demand: &Demand, poses: &[Counts], pixels: f64) -> Vec<usize> {
    let mut cover = Cover::new(demand);
    let gains: Vec<f64> = poses.par_iter().map(|counts| cover.gain(counts)).collect();
    let offer = |(pose, gain)| Offer { gain, pose, chosen: 0 };
    let mut offers: BinaryHeap<Offer> = gains.into_iter().enumerate().map(offer).collect();
    let mut chosen = Vec::new();
    while chosen.len() < MAX_REFERENCES
        && let Some(best) = offers.pop()
        && best.gain >= MIN_GAIN * pixels
    {
        if best.chosen < chosen.len() {
            let gain = cover.gain(&poses[best.pose]);
            offers.push(Offer { gain, chosen: chosen.len(), ..best });
            continue;
        }
        cover.add_finest(&poses[best.pose]);
        chosen.push(best.pose);
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::super::pictures::{Shown, SurfaceCell};
    use super::*;
    use crate::math::key::Key;

    /// Pictures of cells 0 to 59, drawn at random, and the demand of viewers who see them.
    fn pictures(count: usize) -> (Demand, Vec<Counts>) {
        let bits = |pose: usize, cell: i32| Key::of_pixel(pose as u64, cell as u32).bits();
        let picture = |pose: usize| -> Shown {
            let cells = (0..60).filter(|&cell| bits(pose, cell).is_multiple_of(3));
            let pixels = |cell: i32| 1 + (bits(pose, cell) >> 32) as u32 % 40;
            cells.map(|cell| (SurfaceCell { cube: [cell, 0, 0], side: 0 }, pixels(cell))).collect()
        };
        let shown: Vec<Shown> = (0..count).map(picture).collect();
        let demand = Demand::new(&shown);
        let counts = shown.iter().map(|shown| demand.counts(shown)).collect();
        (demand, counts)
    }

    #[test]
    fn each_pose_adds_most_of_all_that_are_left() {
        let (demand, poses) = pictures(30);
        let chosen = choose(&demand, &poses, 40.0);
        assert!(chosen.len() > 3 && chosen.len() < 30, "{}", chosen.len());
        let mut cover = Cover::new(&demand);
        for &pose in &chosen {
            let most = poses.iter().map(|counts| cover.gain(counts)).fold(0.0, f64::max);
            assert_eq!(cover.gain(&poses[pose]), most);
            cover.add_finest(&poses[pose]);
        }
        assert!(poses.iter().all(|counts| cover.gain(counts) < MIN_GAIN * 40.0));
    }
}
