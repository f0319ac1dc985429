//! The pieces of a model: triangles that share vertex positions.

use glam::DVec3;
use rayon::prelude::*;

/// Cosine of the largest slope of a level triangle: 2.6 degrees. Drains and rounding slope less,
/// ramps and roofs more.
const LEVEL_COSINE: f64 = 0.999;

/// Smallest share of a sheet's area that is seen from above: that of a slope of 45 degrees.
const MIN_SHEET_LEVEL: f64 = 0.7;

/// Largest ratio of a sheet's area seen from above and the area of its plan: a sheet covers its
/// plan once, a closed body twice.
const MAX_SHEET_COVER: f64 = 1.2;

/// Largest ratio of height and diagonal of a plate. The rim of a base plate of 20 m and 0.2 m has
/// 0.007; the walls of a hall of 180 m and 6 m have 0.033.
const MAX_PLATE_RATIO: f64 = 0.02;

/// Triangles connected by shared vertex positions, all of them level or none.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// Lower corner of the box, world metres.
    pub(super) low: DVec3,
    /// Upper corner of the box, world metres.
    pub(super) high: DVec3,
    /// Area, in square scene units.
    pub(super) area: f64,
    /// Area seen from above in the same unit; surfaces that lie below others count too.
    level_area: f64,
    /// Mean height over the area, world metres.
    pub(super) mean_height: f64,
    /// Number of triangles.
    pub(super) triangles: usize,
    is_body: bool,
}

impl Piece {
    /// True unless the piece is a sheet or a plate.
    pub(super) fn is_body(&self) -> bool {
        self.is_body
    }

    /// Length of the diagonal of the box, metres.
    pub(super) fn diagonal(&self) -> f64 {
        (self.high - self.low).length()
    }

    /// Adds a triangle. `area` and `level_area` are in square scene units.
    fn add(&mut self, corners: [DVec3; 3], [area, level_area]: [f64; 2]) {
        let [a, b, c] = corners;
        self.low = self.low.min(a).min(b).min(c);
        self.high = self.high.max(a).max(b).max(c);
        self.area += area;
        self.level_area += level_area;
        let share = if self.area > 0.0 { area / self.area } else { 1.0 };
        self.mean_height += ((a.y + b.y + c.y) / 3.0 - self.mean_height) * share;
        self.triangles += 1;
    }

    /// Decides whether the piece is a body, given the scale of scene space.
    fn classify(&mut self, units_per_metre: f64) {
        let size = self.high - self.low;
        let plan = (size.x * units_per_metre) * (size.z * units_per_metre);
        let is_sheet =
            self.level_area >= MIN_SHEET_LEVEL * self.area && self.level_area <= MAX_SHEET_COVER * plan;
        self.is_body = !is_sheet && size.y > MAX_PLATE_RATIO * self.diagonal();
    }
}

/// Returns the pieces of a model in the order of their first triangles.
pub(super) fn pieces_of(positions: &[DVec3], triangles: &[[u32; 3]], units_per_metre: f64) -> Vec<Piece> {
    let first = first_at_position(positions);
    // One forest for level triangles, and one for the others.
    let mut forests = [first.clone(), first];
    let areas: Vec<[f64; 2]> =
        triangles.par_iter().map(|t| areas(t.map(|v| positions[v as usize]), units_per_metre)).collect();
    let forest_of = |[area, level]: [f64; 2]| usize::from(level >= LEVEL_COSINE * area);
    for (t, areas) in triangles.iter().zip(&areas) {
        let forest = &mut forests[forest_of(*areas)];
        let [a, b, c] = t.map(|v| root(forest, v));
        let lowest = a.min(b).min(c);
        for corner in [a, b, c] {
            forest[corner as usize] = lowest;
        }
    }
    let mut numbers = [vec![u32::MAX; positions.len()], vec![u32::MAX; positions.len()]];
    let mut pieces: Vec<Piece> = Vec::new();
    for (t, areas) in triangles.iter().zip(&areas) {
        let forest = forest_of(*areas);
        let number = &mut numbers[forest][root(&mut forests[forest], t[0]) as usize];
        let corners = t.map(|v| positions[v as usize]);
        if *number == u32::MAX {
            *number = pieces.len() as u32;
            pieces.push(Piece::empty());
        }
        pieces[*number as usize].add(corners, *areas);
    }
    pieces.par_iter_mut().for_each(|piece| piece.classify(units_per_metre));
    pieces
}

impl Piece {
    fn empty() -> Self {
        Self {
            low: DVec3::INFINITY,
            high: DVec3::NEG_INFINITY,
            area: 0.0,
            level_area: 0.0,
            mean_height: 0.0,
            triangles: 0,
            is_body: false,
        }
    }
}

/// Returns the area of a triangle and its area seen from above, in square scene units.
fn areas([a, b, c]: [DVec3; 3], units_per_metre: f64) -> [f64; 2] {
    let normal = ((b - a) * units_per_metre).cross((c - a) * units_per_metre) / 2.0;
    [normal.length(), normal.y.abs()]
}

/// Returns, for each vertex, the first vertex at the same position.
fn first_at_position(positions: &[DVec3]) -> Vec<u32> {
    // Adding zero makes -0 equal to +0.
    let key = |v: u32| (positions[v as usize] + 0.0).to_array().map(f64::to_bits);
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.par_sort_unstable_by_key(|&v| (key(v), v));
    let mut first = vec![0; positions.len()];
    for equal in order.chunk_by(|&a, &b| key(a) == key(b)) {
        for &v in equal {
            first[v as usize] = equal[0];
        }
    }
    first
}

fn root(forest: &mut [u32], mut v: u32) -> u32 {
    while forest[v as usize] != v {
        forest[v as usize] = forest[forest[v as usize] as usize];
        v = forest[v as usize];
    }
    v
}
