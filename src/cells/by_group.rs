//! Cells that hold the light of each group of lights.

use super::compute::{Anchor, Cell, POINTS, for_each_sample, kinds_by_rays, light_shift, serves};
use super::key::{CellKey, MAX_SPLITS};
use super::table::{MAX_BYTES, Table};
use crate::bsdf::Diffuse;
use crate::math::key::mix;
use crate::trace::{CachedGroups, GroupLight, GroupSettings, Reader, SurfacePoint, TraceSettings, Tracer};
use glam::Vec3;

/// Cells of one scene by groups of lights, for paths of one setting. Shared by threads.
#[derive(Debug)]
pub(crate) struct GroupCells {
    bounces: u32,
    seed: u64,
    groups: usize,
    table: Table,
}

impl GroupCells {
    /// Creates an empty cache for paths of these settings, in a scene with this number of groups.
    pub(crate) fn new(groups: usize, settings: &TraceSettings) -> Self {
        let bytes = if settings.bounces > 0 { MAX_BYTES } else { 0 };
        let bounces = settings.bounces.saturating_sub(1);
        Self { bounces, seed: settings.seed, groups, table: Table::new(bytes) }
    }

    /// True where the cells hold the light of paths of these settings.
    pub(crate) fn are_for(&self, settings: &TraceSettings) -> bool {
        settings.bounces.saturating_sub(1) == self.bounces && settings.seed == self.seed
    }

    /// The light of each group in a cell, and whether it serves a point; `None` where the cell is
    /// divided.
    fn cell(&self, tracer: &Tracer, key: &CellKey, point: Vec3) -> Option<(GroupLight, bool)> {
        let (hash, mut computed) = (key.hash(), None);
        let (mut light, mut is_served) = (GroupLight::default(), None);
        for (group, light) in (0..self.groups).zip(&mut light) {
            let compute = || {
                let cells = computed.get_or_insert_with(|| self.compute(tracer, key));
                cells.map_or(Cell::Divided, |(light, anchor)| Cell::Lit(light[group], anchor)).to_bits()
            };
            let bits = self.table.get_or_insert(mix(hash ^ group as u64).max(1), compute);
            let Cell::Lit(found, anchor) = Cell::from_bits(bits) else { return None };
            *light = found;
            is_served.get_or_insert_with(|| serves(tracer, key, self.seed, anchor, point));
        }
        Some((light, is_served?))
    }

    fn compute(&self, tracer: &Tracer, key: &CellKey) -> Option<(GroupLight, Anchor)> {
        let trace = TraceSettings { samples: 1, bounces: self.bounces, seed: self.seed };
        let settings = GroupSettings { trace, cache: None, footprint: 0.0, finds_near: true };
        let mut sum = GroupLight::default();
        let anchor = for_each_sample(tracer, key, self.seed, |point, sample, sequence, rays| {
            let (mut direct, shift) = (GroupLight::default(), light_shift(sequence, sample));
            let to = (&mut *rays, &mut direct);
            tracer.add_irradiance_by_group(kinds_by_rays(self.bounces), point, 1, shift, to);
            let smooth = tracer.path_by_group(point, (sequence, sample), &settings, rays);
            for ((sum, direct), smooth) in sum.iter_mut().zip(direct).zip(smooth) {
                *sum += Diffuse::WHITE.radiance(direct) + smooth;
            }
        })?;
        let light = sum.map(|sum| sum / POINTS as f32);
        light.iter().all(|light| light.is_finite()).then_some((light, anchor))
    }
}

impl CachedGroups for GroupCells {
    fn groups_at(&self, tracer: &Tracer, point: &SurfacePoint, reader: &Reader) -> Option<GroupLight> {
        let levels = CellKey::levels_of(reader);
        let finest = *levels.start().max(&(levels.end() - MAX_SPLITS));
        (finest..=*levels.end()).rev().find_map(|level| {
            let key = CellKey::new(point.position, point.geometric_normal, level)?;
            let (light, is_served) = self.cell(tracer, &key, point.position)?;
            is_served.then_some(light)
        })
    }
}
