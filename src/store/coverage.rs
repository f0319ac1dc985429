//! How much of what some views show the references of a store light.

use super::cells::{Cell, cells_of_view};
use super::content::SceneContent;
use super::index::StoreIndex;
use super::serving::Cover;
use super::summary::{Purpose, RecordSummary};
use crate::camera::Camera;
use crate::trace::{Tracer, parallel::Stop};
use rayon::prelude::*;

/// What some views of a scene show.
#[derive(Debug)]
pub struct StoreCoverage {
    content: SceneContent,
    seen: Vec<Vec<(Cell, f32)>>,
    size: [u32; 2],
}

impl StoreCoverage {
    /// Finds out what views show in pictures of a size. `None` after a stop.
    pub fn new(tracer: &Tracer, views: &[Camera], size: [u32; 2], stop: Stop<'_>) -> Option<Self> {
        let seen = |view: &Camera| (!stop()).then(|| cells_of_view(tracer, view));
        let seen = views.par_iter().map(seen).collect::<Option<_>>()?;
        Some(Self { content: SceneContent::new(tracer.scene()), seen, size })
    }

    /// The share of each view, 0..1, that references of a store light which hold in the scene and
    /// serve walks with these bounces: by the estimate with which a walk chooses what it reads.
    pub fn shares(&self, index: &StoreIndex, bounces: u32) -> Vec<f32> {
        let summaries = index.records().map(|(_, summary, _)| summary);
        let fits = |summary: &&RecordSummary| {
            let is_kind = summary.settings.bounces == bounces && summary.purpose == Purpose::LookUp;
            is_kind && summary.holds_in(&self.content)
        };
        let serving: Vec<&RecordSummary> = summaries.filter(fits).collect();
        let share = |seen: &Vec<(Cell, f32)>| {
            let mut cover = Cover::new(seen, self.size);
            for summary in &serving {
                cover.add(&cover.shares(&summary.cells));
            }
            cover.lit_share()
        };
        self.seen.par_iter().map(share).collect()
    }
}
