//! Light at the surfaces that bounce rays meet, kept by place: the cells in which the paths of
//! smooth light end.
//!
//! | File | Contents |
//! |---|---|
//! | `key` | [`CellKey`]: the cube, its size, and the side that its surfaces face |
//! | `by_group` | cells with the light of each group of lights |
//! | `compute` | the light of one cell, a function of the scene and the key alone |
//! | `table` | a hash table that threads fill without locks |
//!
//! Sources: Ward, Rubinstein and Clear, "A Ray Tracing Solution for Diffuse Interreflection",
//! SIGGRAPH 1988, for the idea that light at secondary surfaces may be coarse; Binder, Fricke and
//! Keller, "Massively Parallel Path Space Filtering", 2019, for cells whose size follows the path.
//! We differ: what a cell holds does not depend on who reads it or when, so a picture has the same
//! bits at any number of threads, and a full table costs time, never bits.

mod by_group;
mod compute;
mod key;
mod table;

pub(crate) use by_group::GroupCells;
pub use key::CellKey;

use crate::scene::Scene;
use crate::trace::{CachedLight, Reader, SurfacePoint, TraceSettings, Tracer};
use compute::{Cell, compute, serves};
use glam::Vec3;
use key::MAX_SPLITS;
use table::{MAX_BYTES, Table};

/// Cells of one scene, for paths of one setting. Shared by threads.
#[derive(Debug)]
pub struct SurfaceCells {
    /// Diffuse surfaces that light passes on its way to a cell, at most.
    bounces: u32,
    seed: u64,
    table: Table,
}

impl SurfaceCells {
    /// Memory of the table, bytes.
    pub const BYTES: usize = MAX_BYTES;

    /// Creates an empty cache for paths of these settings. Scenes without light, and paths without
    /// bounces, need none.
    pub fn new(scene: &Scene, settings: &TraceSettings) -> Self {
        let is_used = settings.bounces > 0 && !scene.lights.is_empty();
        Self {
            bounces: settings.bounces.saturating_sub(1),
            seed: settings.seed,
            table: Table::new(if is_used { Self::BYTES } else { 0 }),
        }
    }

    /// True where the cells hold the light of paths of these settings.
    pub fn are_for(&self, settings: &TraceSettings) -> bool {
        settings.bounces > 0 && self.bounces == settings.bounces - 1 && self.seed == settings.seed
    }

    /// Number of cells that are held.
    pub fn len(&self) -> usize {
        self.table.len()
    }

    /// True where no cell is held.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Memory in bytes.
    pub fn bytes(&self) -> usize {
        self.table.bytes()
    }

    fn cell(&self, tracer: &Tracer, key: &CellKey) -> Cell {
        let hash = key.hash();
        let compute = || compute(tracer, key, self.bounces, self.seed).to_bits();
        Cell::from_bits(self.table.get_or_insert(hash, compute))
    }
}

impl CachedLight for SurfaceCells {
    fn light_at(&self, tracer: &Tracer, point: &SurfacePoint, reader: &Reader) -> Option<Vec3> {
        let levels = CellKey::levels_of(reader);
        let finest = *levels.start().max(&(levels.end() - MAX_SPLITS));
        (finest..=*levels.end()).rev().find_map(|level| {
            let key = CellKey::new(point.position, point.geometric_normal, level)?;
            match self.cell(tracer, &key) {
                Cell::Lit(light, anchor) => {
                    serves(tracer, &key, self.seed, anchor, point.position).then_some(light)
                }
                Cell::Divided => None,
            }
        })
    }
}
