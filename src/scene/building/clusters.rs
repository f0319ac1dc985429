//! Clusters: pieces of a model that lie near each other.

use super::pieces::Piece;
use glam::DVec3;

/// Largest gap between a cluster and a piece that joins it, in diagonals of the cluster: the next
/// house of a street joins, an object in the landscape does not.
const MAX_GAP: f64 = 0.5;

/// Largest number of clusters that are compared. They begin with the largest pieces, so the others
/// are small.
const MAX_CLUSTERS: usize = 32;

/// Largest number of passes over the pieces while a cluster grows. Real models need up to ten; a
/// malicious row of pieces could need one for each.
const MAX_PASSES: usize = 64;

/// Smallest share of all area, or of all triangles, that the main cluster must hold. Otherwise the
/// model is a scatter of many parts, such as the doors of a house without its walls, and all of
/// them count.
const MIN_MAIN_SHARE: f64 = 0.5;

/// Pieces near each other.
#[derive(Clone, Debug)]
pub(super) struct Cluster {
    /// Lower corner of the box, world metres.
    pub(super) low: DVec3,
    /// Upper corner of the box, world metres.
    pub(super) high: DVec3,
    area: f64,
    triangles: usize,
}

impl Cluster {
    fn empty() -> Self {
        Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY, area: 0.0, triangles: 0 }
    }

    /// Length of the diagonal of the box, metres.
    pub(super) fn diagonal(&self) -> f64 {
        (self.high - self.low).length()
    }

    fn add(&mut self, piece: &Piece) {
        (self.low, self.high) = (self.low.min(piece.low), self.high.max(piece.high));
        self.area += piece.area;
        self.triangles += piece.triangles;
    }

    /// True if the gap to a piece is at most [`MAX_GAP`] and not larger than the piece itself.
    fn is_near(&self, piece: &Piece) -> bool {
        let gap = (piece.low - self.high).max(self.low - piece.high).max(DVec3::ZERO).length();
        gap <= MAX_GAP * self.diagonal() && gap <= piece.diagonal()
    }

    /// Adds the pieces that are near and accepted, until there are none. Returns which were added.
    pub(super) fn grow(&mut self, pieces: &[&Piece], accepts: impl Fn(&Self, &Piece) -> bool) -> Vec<bool> {
        let mut is_added = vec![false; pieces.len()];
        for _ in 0..MAX_PASSES {
            let mut has_grown = false;
            for (is_added, piece) in is_added.iter_mut().zip(pieces).filter(|(is_added, _)| !**is_added) {
                if self.is_near(piece) && accepts(self, piece) {
                    self.add(piece);
                    (*is_added, has_grown) = (true, true);
                }
            }
            if !has_grown {
                break;
            }
        }
        is_added
    }
}

/// Returns the main cluster, or one of all pieces if none holds enough; `None` without pieces.
pub(super) fn main_cluster(pieces: &[&Piece]) -> Option<Cluster> {
    let mut all = Cluster::empty();
    pieces.iter().for_each(|piece| all.add(piece));
    let mut rest = pieces.to_vec();
    // The sort is stable: equal pieces keep their order in the file.
    rest.sort_by(|a, b| b.area.total_cmp(&a.area));
    let mut best: Option<Cluster> = None;
    for _ in 0..MAX_CLUSTERS {
        let Some(seed) = rest.first() else { break };
        let mut cluster = Cluster::empty();
        cluster.add(seed);
        rest.remove(0);
        let is_added = cluster.grow(&rest, |_, _| true);
        let mut is_added = is_added.iter();
        rest.retain(|_| is_added.next() == Some(&false));
        if best.as_ref().is_none_or(|best| cluster.area > best.area) {
            best = Some(cluster);
        }
    }
    let holds_enough = |c: &Cluster| {
        c.area >= MIN_MAIN_SHARE * all.area || c.triangles as f64 >= MIN_MAIN_SHARE * all.triangles as f64
    };
    best.map(|best| if holds_enough(&best) { best } else { all.clone() })
}
