//! How much the references of a store light of what is seen from the walkable places.

use super::poses::{looking_around, places};
use crate::store::{StoreCoverage, StoreIndex};
use crate::trace::{Tracer, parallel::Stop};
use glam::DVec3;

/// The walkable places of a scene, and what is seen from each.
#[derive(Debug)]
pub struct FloorCover {
    places: Vec<DVec3>,
    views: StoreCoverage,
}

impl FloorCover {
    /// Finds the places, and looks around from each in pictures of a size. `None` after a stop.
    pub fn new(tracer: &Tracer, size: [u32; 2], stop: Stop<'_>) -> Option<Self> {
        let places = places(tracer);
        let views = looking_around(&places, size, tracer.scene().start().fov_y);
        let views = StoreCoverage::new(tracer, &views, size, stop)?;
        Some(Self { places, views })
    }

    /// The places as eyes in world metres, each with the share of what is seen from it, 0..1, that
    /// references of a store light for walks with these bounces.
    pub fn shares(&self, index: &StoreIndex, bounces: u32) -> Vec<(DVec3, f32)> {
        let shares = self.views.shares(index, bounces);
        let around = shares.len() / self.places.len().max(1);
        let mean = |shares: &[f32]| shares.iter().sum::<f32>() / shares.len() as f32;
        self.places.iter().copied().zip(shares.chunks(around.max(1)).map(mean)).collect()
    }
}
