//! What viewers see of each surface, and how much of that a set of references lights.
//!
//! A viewer whose picture shows a cell in `c` pixels is served by a reference that shows it in `x`:
//! wholly from `c / 4` on, and in proportion below. The sum over all viewers is, for each cell, a
//! concave function of `x`, so the cover of several references has falling returns.

use super::pictures::{Shown, SurfaceCell};
use std::collections::{BTreeMap, HashMap};

/// Pixels of a view per pixel of a reference up to which the reference is as fine as needed: half
/// as many per axis, as in the look-up that decides what a planned reference leaves to others.
const FINE: f64 = 4.0;

/// How much viewers see of each surface cell, in pictures from all places of a bake.
#[derive(Debug, Default)]
pub(super) struct Demand {
    numbers: HashMap<SurfaceCell, u32>,
    cells: Vec<SeenCell>,
    /// The pixels that all viewers see.
    total: f64,
}

/// The pictures of viewers in which a surface cell is seen.
#[derive(Debug, Default)]
struct SeenCell {
    /// Pixels in which each viewer's picture shows it, ascending.
    pixels: Vec<u32>,
    /// Sums of the first numbers, one more than there are numbers.
    sums: Vec<u64>,
}

/// Pixels of the cells that a reference shows, by their numbers in a [`Demand`].
pub(super) type Counts = Vec<(u32, u32)>;

impl Demand {
    /// The demand of viewers whose pictures show this.
    pub(super) fn new(viewers: &[Shown]) -> Self {
        let mut cells = BTreeMap::<SurfaceCell, Vec<u32>>::new();
        for &(cell, pixels) in viewers.iter().flatten() {
            cells.entry(cell).or_default().push(pixels);
        }
        let numbers = (0..).zip(cells.keys()).map(|(number, cell)| (*cell, number)).collect();
        let cells: Vec<SeenCell> = cells.into_values().map(SeenCell::new).collect();
        let total = cells.iter().map(|cell| cell.pixels_of_all() as f64).sum();
        Self { numbers, cells, total }
    }

    /// The cells of a picture that a viewer sees, by number.
    pub(super) fn counts(&self, shown: &Shown) -> Counts {
        let number = |&(cell, pixels): &(SurfaceCell, u32)| Some((*self.numbers.get(&cell)?, pixels));
        shown.iter().filter_map(number).collect()
    }

    /// The pixels that viewers gain where the pixels of a cell grow from one number to another.
    pub(super) fn gain(&self, cell: u32, [from, to]: [u32; 2]) -> f64 {
        let cell = &self.cells[cell as usize];
        cell.served(to) - cell.served(from)
    }
}

impl SeenCell {
    fn new(mut pixels: Vec<u32>) -> Self {
        pixels.sort_unstable();
        let sum = |sum: &mut u64, pixels: &u32| {
            *sum += u64::from(*pixels);
            Some(*sum)
        };
        let sums = std::iter::once(0).chain(pixels.iter().scan(0, sum)).collect();
        Self { pixels, sums }
    }

    fn pixels_of_all(&self) -> u64 {
        self.sums.last().copied().unwrap_or(0)
    }

    /// The pixels that viewers see served, where references light this many.
    fn served(&self, lit: u32) -> f64 {
        let enough = FINE * f64::from(lit);
        let whole = self.pixels.partition_point(|&pixels| f64::from(pixels) <= enough);
        self.sums[whole] as f64 + enough * (self.pixels.len() - whole) as f64
    }
}

/// How much of a demand some references light.
#[derive(Debug)]
pub(super) struct Cover<'d> {
    demand: &'d Demand,
    lit: Vec<u32>,
    served: f64,
}

impl<'d> Cover<'d> {
    /// Nothing is lit.
    pub(super) fn new(demand: &'d Demand) -> Self {
        Self { demand, lit: vec![0; demand.cells.len()], served: 0.0 }
    }

    /// Adds the pixels that a reference lights and no other does.
    pub(super) fn add(&mut self, counts: &Counts) {
        for &(cell, pixels) in counts {
            let lit = &mut self.lit[cell as usize];
            let sum = lit.saturating_add(pixels);
            self.served += self.demand.gain(cell, [*lit, sum]);
            *lit = sum;
        }
    }

    /// Adds a reference that may show what others show.
    pub(super) fn add_finest(&mut self, counts: &Counts) {
        for &(cell, pixels) in counts {
            let lit = &mut self.lit[cell as usize];
            *lit = pixels.max(*lit);
        }
    }

    /// The pixels that viewers would gain by a reference that may show what others show.
    pub(super) fn gain(&self, counts: &Counts) -> f64 {
        let gain = |&(cell, pixels): &(u32, u32)| {
            let lit = self.lit[cell as usize];
            if pixels > lit { self.demand.gain(cell, [lit, pixels]) } else { 0.0 }
        };
        counts.iter().map(gain).sum()
    }

    /// The share of what viewers see that is lit, 0..1.
    pub(super) fn share(&self) -> f64 {
        if self.demand.total > 0.0 { (self.served / self.demand.total).clamp(0.0, 1.0) } else { 1.0 }
    }
}
