//! Ranges of depth of a frame's pixels in squares: with them, a ray passes many pixels in one step.

/// Largest and smallest disparity in squares of `2^level` pixels a side, for every level, in scene
/// units.
///
/// Level 0 holds a frame's pixels in rows, padded on the right and at the bottom to a multiple of
/// the largest square, so that each level has half the width and height of the one before. Padding
/// has an empty range.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DepthRanges {
    levels: Vec<Vec<[f32; 2]>>,
    size: [u32; 2],
}

/// Number of levels, including the pixels themselves: the largest square has 64 pixels a side.
pub const LEVELS: u32 = 7;

/// An empty range of disparities: any value extends it.
const EMPTY: [f32; 2] = [f32::NEG_INFINITY, f32::INFINITY];

impl DepthRanges {
    /// Returns width and height of level 0 for a frame of a size.
    pub fn padded(size: [u32; 2]) -> [u32; 2] {
        size.map(|s| s.next_multiple_of(1 << (LEVELS - 1)))
    }

    /// Computes the ranges of a frame's disparities, and keeps allocations. A disparity that is not
    /// finite counts as 0, infinitely far.
    pub fn fill(&mut self, disparity: &[f32], size: [u32; 2]) {
        self.size = Self::padded(size);
        self.levels.resize_with(LEVELS as usize, Vec::new);
        let row = self.size[0] as usize;
        let pixels = &mut self.levels[0];
        pixels.clear();
        pixels.resize(row * self.size[1] as usize, EMPTY);
        if size[0] > 0 {
            for (to, from) in pixels.chunks_exact_mut(row).zip(disparity.chunks_exact(size[0] as usize)) {
                to.iter_mut().zip(from).for_each(|(to, &d)| *to = [if d.is_finite() { d } else { 0.0 }; 2]);
            }
        }
        for level in 1..self.levels.len() {
            let (finer, coarser) = self.levels.split_at_mut(level);
            gather(&finer[level - 1], row >> (level - 1), &mut coarser[0]);
        }
    }

    /// Returns the largest disparity of all; 0 where there is none above.
    pub fn nearest(&self) -> f32 {
        self.levels.last().into_iter().flatten().map(|range| range[0]).fold(0.0, f32::max)
    }

    /// Returns each level with its width and height.
    pub fn levels(&self) -> impl Iterator<Item = ([u32; 2], &[[f32; 2]])> {
        self.levels
            .iter()
            .enumerate()
            .map(|(level, ranges)| (self.size.map(|s| s >> level), ranges.as_slice()))
    }
}

/// Joins squares of two by two ranges.
fn gather(finer: &[[f32; 2]], row: usize, coarser: &mut Vec<[f32; 2]>) {
    coarser.clear();
    for rows in finer.chunks_exact((2 * row).max(1)) {
        let (upper, lower) = rows.split_at(row);
        let pairs = upper.as_chunks::<2>().0.iter().zip(lower.as_chunks::<2>().0);
        coarser.extend(pairs.map(|(&[a, b], &[c, d])| joined(joined(a, b), joined(c, d))));
    }
}

fn joined(a: [f32; 2], b: [f32; 2]) -> [f32; 2] {
    [a[0].max(b[0]), a[1].min(b[1])]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_square_has_the_range_of_its_pixels() {
        let size = [130u32, 70];
        let disparity: Vec<f32> = (0..size[0] * size[1]).map(|i| (i * 7919 % 1009) as f32).collect();
        let mut ranges = DepthRanges::default();
        ranges.fill(&disparity, size);
        ranges.fill(&disparity, size);
        assert_eq!((ranges.levels().count(), ranges.nearest()), (LEVELS as usize, 1008.0));
        for (level, ([width, height], squares)) in ranges.levels().enumerate() {
            assert_eq!([width, height], [192 >> level, 128 >> level]);
            let mut expected = vec![EMPTY; squares.len()];
            for (i, &d) in disparity.iter().enumerate() {
                let (x, y) = ((i as u32 % size[0]) >> level, (i as u32 / size[0]) >> level);
                let square = &mut expected[(y * width + x) as usize];
                *square = joined(*square, [d, d]);
            }
            assert_eq!(squares, expected);
        }
    }
}
