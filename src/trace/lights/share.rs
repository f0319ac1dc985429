//! Which lights of a cell are sampled at a point, and how often.
//!
//! Up to [`MAX_LIGHTS`] lights get all samples that are asked for. More lamps share a number of
//! samples that does not depend on how many there are. A lamp that expects less than one sample is
//! left to chance, and counts for as much more where it is chosen: the estimate stays unbiased.
//!
//! Source: Shirley, Wang and Zimmerman, "Monte Carlo Techniques for Direct Lighting Calculations",
//! ACM TOG 15(1), 1996 (section 5: lights chosen by their estimated contribution), and Madow, "On
//! the Theory of Systematic Sampling, II", 1949: one random offset places the samples of all lamps
//! at equal distances along the sum of their shares. We differ: shares are found down the tree of
//! lamps, for the point, and contain the visibility of a part of the tree from the cell.

use super::tree::{LightTree, share};
use crate::scene::MAX_SINGLE_LIGHTS;
use crate::trace::SurfacePoint;
use glam::Vec3;

/// Number of lights that get all their samples; of more lamps in a cell only some are sampled. No
/// scene of the embedded ones and no real model at hand has a cell with more, so pictures of these
/// do not depend on it.
pub(super) const MAX_LIGHTS: usize = MAX_SINGLE_LIGHTS;

/// Largest number of lamps of a cell each of which is estimated at every point. Of more, parts of
/// the tree are estimated first. Not tuned.
const MAX_SINGLE_ESTIMATES: usize = 512;

/// Largest number of lamps of a part of the tree that are estimated one by one. Not tuned.
const MAX_BLOCK: usize = 32;

/// Dimension of the random offset of shared samples, in addition to those of the lights.
pub(super) const SHARING: u32 = u32::MAX;

/// The lights that matter in a cell.
#[derive(Debug)]
pub(in crate::trace) struct CellLights {
    /// Lights that get all their samples: indices into the scene's lights, ascending.
    pub(super) own: Box<[u32]>,
    /// Parts of the tree whose lamps are chosen; empty where there are few.
    pub(super) parts: Box<[Part]>,
}

/// A node of the tree of lamps, as seen from a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Part {
    pub(super) node: u32,
    /// Factor (0..1) of its importance, by how much of it is visible.
    pub(super) visible: f32,
}

/// A light and its number of samples at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LightTurn {
    /// Index into the scene's lights.
    pub(super) index: u32,
    /// Number of samples, at least one.
    pub(super) samples: u32,
    /// Factor of the estimate of the light's irradiance.
    pub(super) weight: f32,
    /// Factor (0..1) of its importance, by how much of it is visible from the cell.
    pub(super) visible: f32,
}

impl CellLights {
    /// Lights of the scene, `parts` of the tree, and others. A few lamps get all their samples.
    pub(super) fn new(tree: &LightTree, mut own: Vec<u32>, parts: Vec<Part>) -> Self {
        let lamps = || parts.iter().flat_map(|part| tree.lamps_of(part.node));
        let is_shared = lamps().count() > MAX_LIGHTS;
        if !is_shared {
            own.extend(lamps());
        }
        own.sort_unstable();
        Self { own: own.into(), parts: if is_shared { parts.into() } else { Box::default() } }
    }

    /// Lights that all get their samples, ascending.
    pub(super) fn few(own: Vec<u32>) -> Self {
        Self { own: own.into(), parts: Box::default() }
    }

    /// Number of lights.
    pub(super) fn len(&self, tree: &LightTree) -> usize {
        self.own.len() + self.parts.iter().map(|part| tree.lamps_of(part.node).len()).sum::<usize>()
    }

    /// True where a light, given by its index in the scene, matters in the cell.
    pub(super) fn contains(&self, tree: &LightTree, light: u32) -> bool {
        let place = tree.place(light);
        let is_in = |part: &Part| {
            let node = tree.node(part.node);
            (node.first..node.first + node.count).contains(&place)
        };
        self.own.binary_search(&light).is_ok() || self.parts.iter().any(is_in)
    }

    /// True where lamps are chosen.
    pub(super) fn is_shared(&self) -> bool {
        !self.parts.is_empty()
    }

    /// The lights that get all their samples at a point.
    #[inline(always)]
    pub(super) fn own_turns(&self, samples: u32) -> impl Iterator<Item = LightTurn> + '_ {
        self.own.iter().map(move |&index| LightTurn { index, samples, weight: 1.0, visible: 1.0 })
    }

    /// The lamps that are chosen at a point, in the order of the tree, with `count` samples in all.
    /// `random` in [0, 1) places them.
    pub(super) fn chosen_turns(
        &self,
        tree: &LightTree,
        point: &SurfacePoint,
        count: u32,
        random: f32,
    ) -> Vec<LightTurn> {
        let at = (point.position, point.shading_normal);
        let random = f64::from(random);
        let lamps = self.len(tree);
        let (turns, estimates) = (
            Vec::with_capacity(count.min(1 << 10) as usize),
            Vec::with_capacity(lamps.min(MAX_SINGLE_ESTIMATES)),
        );
        let mut chosen = Chosen { tree, at, random, turns, estimates };
        if lamps <= MAX_SINGLE_ESTIMATES {
            chosen.among_all(&self.parts, f64::from(count));
        } else {
            chosen.among_parts(&self.parts, f64::from(count));
        }
        chosen.turns
    }
}

/// The lamps chosen so far.
struct Chosen<'a> {
    tree: &'a LightTree,
    /// Position and normal of the point.
    at: (Vec3, Vec3),
    /// Sample number k lies at k plus this, on a line on which each lamp covers its share.
    random: f64,
    turns: Vec<LightTurn>,
    /// Estimates of the light of single lamps.
    estimates: Vec<f32>,
}

impl Chosen<'_> {
    /// Chooses by an estimate of each lamp.
    fn among_all(&mut self, parts: &[Part], count: f64) {
        let mut ends = Vec::with_capacity(parts.len());
        for part in parts {
            self.tree.append_estimates(part.node, self.at, part.visible, &mut self.estimates);
            ends.push(self.estimates.len());
        }
        let lamp_at = |place: usize| {
            let at = ends.partition_point(|end| *end <= place);
            let (part, begin) = (parts[at], if at == 0 { 0 } else { ends[at - 1] });
            (self.tree.lamps_of(part.node)[place - begin], part.visible)
        };
        choose(&self.estimates, [0.0, count], self.random, lamp_at, &mut self.turns);
    }

    /// Divides the samples among parts first.
    fn among_parts(&mut self, parts: &[Part], count: f64) {
        let of_part = |part: &Part| self.tree.importance(part.node, self.at.0, self.at.1) * part.visible;
        let importances: Vec<f32> = parts.iter().map(of_part).collect();
        let mut begin = 0.0;
        for (part, share) in parts.iter().zip(shares(self.tree, parts, &importances, count)) {
            self.descend(part, [begin, begin + share]);
            begin += share;
        }
    }

    /// Finds the lamps of a part, which covers a piece of the line.
    fn descend(&mut self, part: &Part, piece: [f64; 2]) {
        let mut open = vec![(part.node, piece)];
        while let Some((node, [begin, end])) = open.pop() {
            if samples_in([begin, end], self.random) == 0 {
                continue;
            }
            let halves = self.tree.children(node).filter(|_| self.tree.lamps_of(node).len() > MAX_BLOCK);
            let Some(halves) = halves else {
                self.estimates.clear();
                self.tree.append_estimates(node, self.at, 1.0, &mut self.estimates);
                let lamps = self.tree.lamps_of(node);
                let lamp_at = |place: usize| (lamps[place], part.visible);
                choose(&self.estimates, [begin, end], self.random, lamp_at, &mut self.turns);
                continue;
            };
            let importances = halves.map(|node| self.tree.importance(node, self.at.0, self.at.1));
            let middle = begin + self.tree.divide(end - begin, halves, importances);
            open.push((halves[1], [middle, end]));
            open.push((halves[0], [begin, middle]));
        }
    }
}

/// Appends the lamps that are chosen where they share a piece of the line in proportion to their
/// estimates. `lamp_at` returns a lamp and how much of it is visible, by the place of its estimate.
fn choose(
    estimates: &[f32],
    [begin, end]: [f64; 2],
    random: f64,
    lamp_at: impl Fn(usize) -> (u32, f32),
    turns: &mut Vec<LightTurn>,
) {
    let (live, sum) = live_and_sum(estimates);
    if live == 0.0 {
        return;
    }
    // The share of a lamp is linear in its estimate.
    let least = share(end - begin, live, [1.0 / live, 0.0]);
    let slope = share(end - begin, live, [0.0, 1.0]) / sum;
    let (mut at, mut next) = (begin, samples_before(begin, random) + random);
    for (place, &estimate) in estimates.iter().enumerate() {
        if estimate <= 0.0 {
            continue;
        }
        let expected = least + slope * f64::from(estimate);
        at += expected;
        if next < at {
            let mut samples = 0;
            while next < at {
                (samples, next) = (samples + 1, next + 1.0);
            }
            let weight = if expected < 1.0 { (1.0 / expected) as f32 } else { 1.0 };
            let (index, visible) = lamp_at(place);
            turns.push(LightTurn { index, samples, weight, visible });
        }
    }
}

/// Number of estimates above zero, and the sum of all.
fn live_and_sum(estimates: &[f32]) -> (f64, f64) {
    let (mut live, mut sums) = ([0u32; 4], [0.0f64; 4]);
    for some in estimates.chunks(4) {
        for (lane, &estimate) in some.iter().enumerate() {
            live[lane] += u32::from(estimate > 0.0);
            sums[lane] += f64::from(estimate);
        }
    }
    (f64::from(live.iter().sum::<u32>()), sums.iter().sum())
}

/// Number of samples before a place of the line.
fn samples_before(place: f64, random: f64) -> f64 {
    (place - random).ceil()
}

fn samples_in([begin, end]: [f64; 2], random: f64) -> u32 {
    (samples_before(end, random) - samples_before(begin, random)) as u32
}

/// Expected numbers of samples of parts of the tree, of `count` in all.
fn shares(tree: &LightTree, parts: &[Part], importances: &[f32], count: f64) -> Vec<f64> {
    let lamps = |part: &Part| f64::from(tree.node(part.node).count);
    let live = || parts.iter().zip(importances).filter(|(_, importance)| **importance > 0.0);
    let all_lamps: f64 = live().map(|(part, _)| lamps(part)).sum();
    let all_importance: f64 = live().map(|(_, importance)| f64::from(*importance)).sum();
    let of_part = |(part, &importance): (&Part, &f32)| {
        if importance <= 0.0 {
            return 0.0;
        }
        let (by_number, by_importance) = (lamps(part) / all_lamps, f64::from(importance) / all_importance);
        share(count, all_lamps, [by_number, by_importance])
    };
    parts.iter().zip(importances).map(of_part).collect()
}
