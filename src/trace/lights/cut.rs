//! The parts of the tree of lamps that matter in a cell, for a bounded number of lines.
//!
//! The parts that may bring most light are divided, until there are [`MAX_PARTS`]. A few lines are
//! drawn from the cell to lamps of each, chosen by their power. By the same bound as for single
//! lamps (`grid`), a part that no line reaches is left out where it can bring next to nothing, and
//! the places that it gives free serve to divide others. Elsewhere it stays, with few samples.

use super::region::{Region, unshadowed};
use super::share::Part;
use super::tree::{LightTree, group_of};
use crate::math::key::Key;
use crate::scene::{MAX_LIGHT_GROUPS, Scene};
use glam::Vec3;

/// Largest number of parts of a cell.
const MAX_PARTS: usize = 64;

/// Number of times that parts are divided after others were left out.
const MAX_ROUNDS: u32 = 8;

/// Number of lines drawn to every part.
const FIRST_LINES: u32 = 16;

/// Largest number of lines drawn to a part that none has reached yet.
const MAX_LINES: u32 = 512;

/// Largest number of further lines drawn from one cell: about 2 ms of shadow rays.
const CELL_LINES: u32 = 1 << 14;

/// How a cell sees its surroundings.
pub(super) struct Sight<'a, F> {
    pub(super) scene: &'a Scene,
    pub(super) tree: &'a LightTree,
    pub(super) region: &'a Region,
    /// True where a line from the region to a light, by its index, with the random numbers of a
    /// key, meets nothing opaque.
    pub(super) reaches: F,
    /// Lamps are compared with others of their group only.
    pub(super) is_by_groups: bool,
    /// Largest mean contribution of a part that is left out, relative to the light in the cell.
    pub(super) tolerance: f32,
}

/// A part, with what is known of its light in the cell.
#[derive(Clone, Copy)]
struct Known {
    node: u32,
    /// Bound on its unshadowed irradiance.
    most: f32,
    /// Number of lines drawn to it.
    lines: u32,
    /// Share (0..1) of the lines that reach it.
    share: f32,
    /// Estimated irradiance.
    estimate: f32,
}

impl<F: Fn(u32, Key) -> bool> Sight<'_, F> {
    /// Returns the parts that matter, in the order of the tree.
    pub(super) fn parts(&self) -> Vec<Part> {
        let mut parts: Vec<Known> = Vec::new();
        let mut fresh: Vec<Known> = self.tree.roots().iter().map(|&node| self.unknown(node)).collect();
        let mut lines_left = CELL_LINES;
        for _ in 0..MAX_ROUNDS {
            self.divide_brightest(&mut parts, &mut fresh);
            if fresh.is_empty() {
                break;
            }
            fresh.iter_mut().for_each(|part| self.look_at(part));
            let arriving = self.arriving(parts.iter().chain(&fresh));
            fresh.retain_mut(|part| self.matters(part, &arriving, &mut lines_left));
            parts.append(&mut fresh);
        }
        parts.sort_unstable_by_key(|part| part.node);
        parts.iter().map(|part| Part { node: part.node, visible: part.visible() }).collect()
    }

    fn unknown(&self, node: u32) -> Known {
        Known {
            node,
            most: self.bound(node, self.region.radius()),
            lines: FIRST_LINES,
            share: 0.0,
            estimate: 0.0,
        }
    }

    /// Replaces the part of the largest bound by its halves, as often as there is room.
    fn divide_brightest(&self, parts: &mut Vec<Known>, fresh: &mut Vec<Known>) {
        while parts.len() + fresh.len() < MAX_PARTS {
            let divisible = |part: &Known| self.tree.children(part.node).is_some();
            let brightest = |of: &[Known]| {
                let divisible = of.iter().enumerate().filter(|(_, part)| divisible(part));
                divisible.max_by(|a, b| a.1.most.total_cmp(&b.1.most)).map(|(at, part)| (at, part.most))
            };
            let part = match (brightest(parts), brightest(fresh)) {
                (None, None) => return,
                (Some((at, most)), other) if other.is_none_or(|(_, other)| most >= other) => {
                    parts.swap_remove(at)
                }
                (_, Some((at, _))) => fresh.swap_remove(at),
                (Some((at, _)), None) => parts.swap_remove(at),
            };
            let halves = self.tree.children(part.node).into_iter().flatten();
            fresh.extend(halves.map(|node| self.unknown(node)));
        }
    }

    /// Draws the first lines to a part.
    fn look_at(&self, part: &mut Known) {
        let reached = (0..FIRST_LINES).filter(|&line| self.line_reaches(part.node, line)).count();
        part.share = reached as f32 / FIRST_LINES as f32;
        // Estimate the light for the far side of the cell, so that a lamp near the middle does not
        // make the others seem negligible.
        part.estimate = part.share * self.bound(part.node, -self.region.radius());
    }

    /// Light that arrives, by groups where these are compared.
    fn arriving<'k>(&self, parts: impl Iterator<Item = &'k Known>) -> [f32; MAX_LIGHT_GROUPS + 1] {
        let mut arriving = [0.0; MAX_LIGHT_GROUPS + 1];
        parts.for_each(|part| arriving[self.group(part.node)] += part.estimate);
        arriving
    }

    /// Draws more lines to a part that none has reached, until its bound is low enough or one does.
    /// False where it can be left out.
    fn matters(&self, part: &mut Known, arriving: &[f32], lines_left: &mut u32) -> bool {
        if part.share > 0.0 {
            return true;
        }
        // In a dark cell the quotient is infinite: every lamp counts.
        let needed = 3.0 * part.most / (self.tolerance * arriving[self.group(part.node)]);
        let is_decided = needed <= MAX_LINES as f32;
        // A faint lamp may be visible beside a bright one that is not: many lines would not tell.
        if !is_decided && self.tree.children(part.node).is_some() {
            return true;
        }
        let until = (needed.min(MAX_LINES as f32) as u32).max(FIRST_LINES);
        let Some(left) = lines_left.checked_sub(until - FIRST_LINES) else { return true };
        *lines_left = left;
        let reaches = (FIRST_LINES..until).find(|&line| self.line_reaches(part.node, line));
        part.lines = reaches.map_or(until, |line| line + 1);
        part.share = if reaches.is_some() { 1.0 / part.lines as f32 } else { 0.0 };
        !is_decided || reaches.is_some()
    }

    fn line_reaches(&self, node: u32, line: u32) -> bool {
        let key = self.region.key.with(node).with(line);
        (self.reaches)(self.tree.lamp_by_power(node, key.with(3).pair()[0]), key)
    }

    /// Returns a bound on the unshadowed irradiance that a part brings within `slack` of the middle
    /// of the cell.
    fn bound(&self, node: u32, slack: f32) -> f32 {
        let at: Vec3 = self.region.centre();
        if let [light] = self.tree.lamps_of(node) {
            return unshadowed(&self.scene.lights[*light as usize], at, slack);
        }
        let node = self.tree.node(node);
        let nearest = (node.centre.distance(at) - node.radius - slack).max(0.0);
        (node.power / (nearest * nearest).max(f32::MIN_POSITIVE)).min(f32::MAX)
    }

    fn group(&self, node: u32) -> usize {
        if self.is_by_groups { group_of(self.scene, self.tree.lamps_of(node)[0]) } else { 0 }
    }
}

impl Known {
    /// Factor of the importance: the root of the share that is visible, because the variance of
    /// what is hidden by chance grows with the share itself. The share is that of half a line more,
    /// which is seen.
    fn visible(&self) -> f32 {
        let lines = self.lines as f32;
        ((self.share * lines + 0.5) / (lines + 0.5)).sqrt()
    }
}
