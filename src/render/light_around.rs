//! The light around a surface point whose own light is not known: a pyramid of the light that is
//! known in a picture.
//!
//! A cell of the pyramid keeps light apart by the side that its surfaces face, so that a floor does
//! not brighten the wall above it. Light is summed from fine to coarse cells, and then filled from
//! coarse to fine: a cell that knows little of a side takes the rest from coarser ones around it. A
//! point reads the four finest cells around it, for its sides and its depth.
//!
//! Sources: pull-push over a pyramid as in Gortler et al., "The Lumigraph", SIGGRAPH 1996, section
//! 3.5; six sides, weighted by the squared components of the normal, as in the ambient cube of
//! McTaggart, "Half-Life 2 / Valve Source Shading", GDC 2004. We differ: light is filled, not
//! colour, and a cell farther away counts less.

use glam::Vec3;
use rayon::prelude::*;

/// Sides that a surface may face: along and against each axis.
const SIDES: usize = 6;

/// Layers of depth, each half an octave, that a cell keeps apart: odd ones and even ones.
const LAYERS: usize = 2;

/// Pixels along an edge of the finest cells: sixteen samples of light have a quarter of the noise
/// of one.
const FINEST: usize = 4;

/// Weight at which a cell is trusted by half: four traced samples, or one that was looked up.
const ENOUGH: f32 = 4.0;

/// Surfaces whose depths differ by a factor of 2^(1/8) count half.
const DEPTH_SHARPNESS: f32 = 8.0;

/// Light that is known at a surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct KnownLight {
    /// Radiance of a white surface.
    pub(super) light: Vec3,
    /// How far it is trusted: 1 for a traced sample.
    pub(super) weight: f32,
}

/// How a surface lies: which sides it faces, and how far it is away.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lie {
    /// The side along each axis, and its weight; the weights sum to one.
    sides: [(usize, f32); 3],
    /// Logarithm of the disparity, about base 2.
    nearness: f32,
}

impl Lie {
    /// The lie of a surface with a normal of any length on the viewer's side.
    pub(super) fn new(normal: Vec3, disparity: f32) -> Self {
        let shares = normal * normal / normal.length_squared();
        let shares = if shares.is_finite() { shares } else { Vec3::Y };
        let side = |axis: usize| (2 * axis + usize::from(normal[axis] < 0.0), shares[axis]);
        Self { sides: [side(0), side(1), side(2)], nearness: logarithm(disparity) }
    }
}

/// The logarithm to base 2, linear between powers of two: off by less than 0.09.
fn logarithm(value: f32) -> f32 {
    value.to_bits() as f32 / (1u32 << 23) as f32
}

/// Weighted sums over the surfaces in a cell that face one side.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    light: Vec3,
    nearness: f32,
    weight: f32,
}

impl Sums {
    fn add(&mut self, other: &Self, share: f32) {
        self.light += other.light * share;
        self.nearness += other.nearness * share;
        self.weight += other.weight * share;
    }

    /// The mean; `None` of nothing.
    fn mean(&self) -> Option<Filled> {
        let Self { light, nearness, weight } = *self;
        (weight > 0.0).then(|| Filled { light: light / weight, nearness: nearness / weight })
    }
}

/// Light that is known or filled, of the surfaces that face one side.
#[derive(Clone, Copy, Debug, Default)]
struct Filled {
    light: Vec3,
    nearness: f32,
}

/// One number for each side and layer of depth.
const SLOTS: usize = SIDES * LAYERS;

type Cell = [Sums; SLOTS];

type FilledCell = [Filled; SLOTS];

/// The pyramid. Keeps its memory from one picture to the next.
#[derive(Debug, Default)]
pub(super) struct LightPyramid {
    /// Cells of 4, 8, 16, ... pixels along an edge, row-major.
    levels: Vec<Vec<Cell>>,
    /// Columns and rows of each level.
    sizes: Vec<[usize; 2]>,
    /// The finest cells, filled; the second is scratch memory for coarser ones.
    filled: [Vec<FilledCell>; 2],
    /// Whether a side and layer is known anywhere.
    knows: [bool; SLOTS],
}

impl LightPyramid {
    /// Memory per pixel: an upper bound for all levels.
    pub(super) const BYTES_PER_PIXEL: usize =
        2 * (size_of::<Cell>() + size_of::<FilledCell>()) / (FINEST * FINEST);

    /// Gathers the light that is known in a picture. `known` is asked for each pixel of a row, from
    /// the left.
    pub(super) fn gather<F: FnMut(usize) -> Option<(KnownLight, Lie)>>(
        &mut self,
        [width, height]: [usize; 2],
        known: impl Fn() -> F + Sync,
    ) {
        let mut size = [width, height].map(|n| n.div_ceil(FINEST));
        self.sizes.clear();
        self.resize_level(size);
        let rows = self.levels[0].par_chunks_mut(size[0].max(1)).enumerate();
        rows.for_each(|(row, cells)| {
            let mut known = known();
            for y in row * FINEST..((row + 1) * FINEST).min(height) {
                for x in 0..width {
                    if let Some((known, lie)) = known(y * width + x) {
                        enter(&mut cells[x / FINEST], known, lie);
                    }
                }
            }
        });
        while size[0] > 1 || size[1] > 1 {
            let finer = size;
            size = size.map(|n| n.div_ceil(2));
            self.resize_level(size);
            self.gather_level(finer);
        }
        self.fill();
    }

    fn resize_level(&mut self, size: [usize; 2]) {
        let at = self.sizes.len();
        if self.levels.len() == at {
            self.levels.push(Vec::new());
        }
        self.levels[at].clear();
        self.levels[at].resize(size[0] * size[1], Cell::default());
        self.sizes.push(size);
    }

    /// Fills the last level from the one before, of a size.
    fn gather_level(&mut self, finer: [usize; 2]) {
        let (below, level) = self.levels.split_at_mut(self.sizes.len() - 1);
        let (Some(below), Some(level)) = (below.last(), level.first_mut()) else { return };
        for (i, cell) in below.iter().enumerate() {
            let (x, y) = (i % finer[0] / 2, i / finer[0] / 2);
            let coarser = &mut level[y * finer[0].div_ceil(2) + x];
            coarser.iter_mut().zip(cell).for_each(|(to, from)| to.add(from, 1.0));
        }
    }

    /// Fills all cells, from the coarsest on.
    fn fill(&mut self) {
        let Self { levels, sizes, filled: [finer, coarser], knows } = self;
        let whole = levels[sizes.len() - 1].first().copied().unwrap_or_default();
        let all = whole.iter().fold(Sums::default(), |mut all, sums| {
            all.add(sums, 1.0);
            all
        });
        *knows = whole.map(|sums| sums.weight > 0.0);
        finer.clear();
        finer.push(whole.map(|sums| sums.mean().or(all.mean()).unwrap_or_default()));
        for level in (0..sizes.len() - 1).rev() {
            std::mem::swap(finer, coarser);
            let ([columns, rows], around) = (sizes[level], (&coarser[..], sizes[level + 1]));
            finer.clear();
            finer.resize(columns * rows, FilledCell::default());
            let cells = finer.par_chunks_mut(columns.max(1)).zip(levels[level].par_chunks(columns.max(1)));
            cells.enumerate().for_each(|(y, (filled, known))| {
                for (x, (filled, known)) in filled.iter_mut().zip(known).enumerate() {
                    let corners = corners([x, y].map(|at| (at as f32 + 0.5) / 2.0), around.1);
                    for (slot, (filled, known)) in filled.iter_mut().zip(known).enumerate() {
                        *filled = completed(known, around.0, &corners, slot);
                    }
                }
            });
        }
    }

    /// The light around a pixel whose surface lies like this; `None` where none is known in the
    /// whole picture.
    pub(super) fn around(&self, pixel: [usize; 2], lie: &Lie) -> Option<Vec3> {
        let corners = corners(pixel.map(|at| (at as f32 + 0.5) / FINEST as f32), self.sizes[0]);
        let of_sides = self.sums(&corners, lie, |slot| self.knows[slot]).mean();
        // Where no surface faces alike, all slots of its sides hold the mean of the picture.
        let any = || self.knows.contains(&true).then(|| self.sums(&corners, lie, |_| true).mean()).flatten();
        of_sides.or_else(any).map(|found| found.light)
    }

    /// The sums around a place over the sides that a surface faces, of the slots that count.
    fn sums(&self, corners: &[(usize, f32); 4], lie: &Lie, counts: impl Fn(usize) -> bool) -> Sums {
        let mut sums = Sums::default();
        for &(cell, share) in corners {
            for (side, of_side) in lie.sides.into_iter().filter(|(_, share)| *share > 0.0) {
                for slot in (side..SLOTS).step_by(SIDES).filter(|slot| counts(*slot)) {
                    let found = &self.filled[0][cell][slot];
                    sums.add(&found.sums(), share * of_side * likeness(found.nearness, lie.nearness));
                }
            }
        }
        sums
    }
}

/// The four cells around a place, given in cells, and their shares. Cells beyond the border are
/// those at the border.
fn corners(place: [f32; 2], [columns, rows]: [usize; 2]) -> [(usize, f32); 4] {
    let [across, down] = [(place[0], columns), (place[1], rows)].map(|(place, count)| {
        let (first, last) = ((place - 0.5).floor(), count - 1);
        let part = place - 0.5 - first;
        [(first, 1.0 - part), (first + 1.0, part)].map(|(i, share)| ((i.max(0.0) as usize).min(last), share))
    });
    let corner = |y: usize, x: usize| (down[y].0 * columns + across[x].0, down[y].1 * across[x].1);
    [corner(0, 0), corner(0, 1), corner(1, 0), corner(1, 1)]
}

/// A side of a cell, completed by the coarser cells around it.
fn completed(known: &Sums, coarser: &[FilledCell], corners: &[(usize, f32); 4], slot: usize) -> Filled {
    let own = known.mean();
    let mut around = Sums::default();
    for &(cell, share) in corners {
        let found = &coarser[cell][slot];
        let alike = own.map_or(1.0, |own| likeness(found.nearness, own.nearness));
        around.add(&found.sums(), share * alike);
    }
    let Some(around) = around.mean() else { return own.unwrap_or_default() };
    let Some(own) = own else { return around };
    let trust = known.weight / (known.weight + ENOUGH);
    Filled { light: around.light + (own.light - around.light) * trust, nearness: own.nearness }
}

/// The weight of a surface for one at another depth, 0..1.
fn likeness(nearness: f32, other: f32) -> f32 {
    let off = (nearness - other) * DEPTH_SHARPNESS;
    1.0 / (1.0 + off * off)
}

impl Filled {
    /// The sums of one sample.
    fn sums(&self) -> Sums {
        Sums { light: self.light, nearness: self.nearness, weight: 1.0 }
    }
}

/// Adds a pixel to the cell that it lies in.
fn enter(cell: &mut Cell, known: KnownLight, lie: Lie) {
    let KnownLight { light, weight } = known;
    let sums = Sums { light: light * weight, nearness: lie.nearness * weight, weight };
    let layer = (lie.nearness * 2.0) as usize % LAYERS;
    for (side, share) in lie.sides {
        cell[side + SIDES * layer].add(&sums, share);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [usize; 2] = [53, 38];

    fn pyramid(known: impl Fn(usize) -> Option<(KnownLight, Lie)> + Sync) -> LightPyramid {
        let mut pyramid = LightPyramid::default();
        pyramid.gather(SIZE, || &known);
        pyramid
    }

    fn sample(light: Vec3, normal: Vec3) -> (KnownLight, Lie) {
        (KnownLight { light, weight: 1.0 }, Lie::new(normal, 0.25))
    }

    #[test]
    fn even_light_is_found_everywhere_whatever_is_known_of_it() {
        let light = Vec3::new(0.3, 2.0, 7.0);
        for step in [1, 7, 1999] {
            let pyramid =
                pyramid(|pixel| (pixel % step == 0).then(|| sample(light, Vec3::new(1.0, 2.0, -0.5))));
            for pixel in 0..SIZE[0] * SIZE[1] {
                let at = [pixel % SIZE[0], pixel / SIZE[0]];
                for normal in [Vec3::Y, Vec3::new(-3.0, 0.1, 0.2)] {
                    let found = pyramid.around(at, &Lie::new(normal, 3.0)).unwrap();
                    assert!((found - light).abs().max_element() < 1e-5 * 7.0, "{found}");
                }
            }
        }
    }

    #[test]
    fn nothing_is_found_where_nothing_is_known() {
        let found = pyramid(|_| None).around([3, 4], &Lie::new(Vec3::Y, 1.0));
        assert_eq!(found, None);
    }

    #[test]
    fn a_wall_takes_its_light_from_walls_that_face_alike() {
        let [dark, bright] = [Vec3::splat(0.1), Vec3::splat(3.0)];
        // A bright floor fills the picture but for a few spots of the wall.
        let pyramid = pyramid(|pixel| {
            Some(if pixel % 101 == 0 { sample(dark, Vec3::X) } else { sample(bright, Vec3::Y) })
        });
        let wall = pyramid.around([20, 20], &Lie::new(Vec3::X, 0.25)).unwrap();
        assert!((wall - dark).abs().max_element() < 1e-6, "{wall}");
        // Nothing faces along z, so it takes what is around.
        let other = pyramid.around([20, 20], &Lie::new(Vec3::Z, 0.25)).unwrap();
        assert!(other.x > 2.0, "{other}");
    }

    #[test]
    fn a_surface_far_behind_counts_little() {
        let [near, far] = [0.25, 0.1];
        let pyramid = pyramid(|pixel| {
            let (light, disparity) =
                if (pixel / SIZE[0]).is_multiple_of(2) { (1.0, near) } else { (9.0, far) };
            Some((KnownLight { light: Vec3::splat(light), weight: 1.0 }, Lie::new(Vec3::X, disparity)))
        });
        for (disparity, light) in [(near, 1.0), (far, 9.0)] {
            let found = pyramid.around([20, 20], &Lie::new(Vec3::X, disparity)).unwrap();
            assert!((found.x - light).abs() < 0.8, "{found} for {light}");
        }
    }
}
