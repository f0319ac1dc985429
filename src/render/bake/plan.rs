//! The plan of a bake: which references are to be traced, and which pixels each of them lights.

use super::choose::choose;
use super::demand::{Counts, Demand};
use super::mask::{PixelMask, coarse_size};
use super::pictures::{Shown, picture, picture_size, pictures};
use super::poses::{along, looking_around, on_grid, places};
use crate::camera::{Camera, CameraPath};
use crate::lookup::{LookupSet, PlannedPictures};
use crate::math::key::Key;
use crate::reference::{ReferenceCache, settings_of_reference};
use crate::trace::{TraceSettings, Tracer, parallel::Stop};

/// Numbers of baked references have this bit, and those of walks and of pictures at rest have not
/// (`settings_of_reference`), so that their noise is independent.
const BAKED: u64 = 1 << 31;

/// Least share of its pixels that a reference lights, 0..1: finding its surfaces costs as much as
/// lighting this many.
const MIN_LIT: f64 = 0.002;

/// Which poses the references of a bake are chosen from.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum BakePlacement {
    /// Those all over the walkable space that add most, one after the other.
    #[default]
    Greedy,
    /// Those on a regular grid over the walkable floor.
    Grid,
    /// These, as along a camera path. Nothing but what is seen from them is lit.
    Poses(Vec<Camera>),
}

impl BakePlacement {
    /// Poses along a camera path.
    pub fn along(path: &CameraPath) -> Self {
        Self::Poses(along(path))
    }
}

/// No bake can be planned.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BakeError {
    /// The plan was stopped.
    #[error("planning was interrupted")]
    Stopped,
    /// There is no place to look from.
    #[error(
        "nobody can walk in this scene: there is no floor below its views and its camera path; the placement \
         'path' follows a camera path instead"
    )]
    NoPlace,
    /// There is no pose to choose from.
    #[error("the camera path has no key frames")]
    EmptyPath,
    /// No surface is seen.
    #[error("no surface that could be lit is seen from where one can walk")]
    NothingSeen,
    /// There is no light to store.
    #[error("the scene has no light: no lamp, sun or sky, and nothing that shines; --sky adds daylight")]
    NoLight,
}

/// A reference of a plan.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PlanEntry {
    pub(super) camera: Camera,
    pub(super) mask: PixelMask,
    /// Pixels that it lights, in coarse pictures and by what viewers see.
    pub(super) counts: Counts,
}

/// The references of a bake in the order in which they are traced: those that add most to what a
/// walker sees lit come first.
#[derive(Debug)]
pub struct BakePlan {
    pub(super) size: [u32; 2],
    pub(super) entries: Vec<PlanEntry>,
    pub(super) demand: Demand,
    /// Reach of the masks, in their pixels.
    pub(super) reach: f64,
}

impl BakePlan {
    /// Makes the plan of references of a size. It depends on the scene's geometry and on nothing
    /// else: neither on the number of threads nor on what a store holds.
    ///
    /// # Errors
    /// [`BakeError`] if there is nothing to bake, or after a stop.
    pub fn new(
        tracer: &Tracer,
        placement: &BakePlacement,
        size: [u32; 2],
        stop: Stop<'_>,
    ) -> Result<Self, BakeError> {
        if tracer.scene().lights.is_empty() {
            return Err(BakeError::NoLight);
        }
        let (viewers, poses) = poses_of(tracer, placement, size)?;
        let see = |poses: &[Camera]| -> Result<Vec<Shown>, BakeError> {
            pictures(tracer, poses, picture_size(size), stop).ok_or(BakeError::Stopped)
        };
        let seen = see(&viewers)?;
        let shown = if poses.is_empty() { None } else { Some(see(&poses)?) };
        let demand = Demand::new(&seen);
        let counts = |shown: &[Shown]| shown.iter().map(|shown| demand.counts(shown)).collect();
        let offered: Vec<Counts> = counts(shown.as_ref().unwrap_or(&seen));
        let poses = if poses.is_empty() { viewers } else { poses };
        let pixels = picture_size(size).map(f64::from).iter().product();
        let chosen: Vec<Camera> = choose(&demand, &offered, pixels).into_iter().map(|at| poses[at]).collect();
        let (coarse, step) = coarse_size(size);
        let reach = if step == 1 { 1.5 } else { 1.0 };
        let mut plan = Self { size, entries: Vec::new(), demand, reach };
        plan.share_out(tracer, &chosen, coarse, stop)?;
        if plan.entries.is_empty() { Err(BakeError::NothingSeen) } else { Ok(plan) }
    }

    /// Leaves every surface to the first of the poses that sees it finely enough.
    fn share_out(
        &mut self,
        tracer: &Tracer,
        poses: &[Camera],
        coarse: [u32; 2],
        stop: Stop<'_>,
    ) -> Result<(), BakeError> {
        let cache = ReferenceCache::new(tracer.scene(), 0);
        let empty = LookupSet::without_references(&cache, tracer.epoch());
        let least = (coarse.map(f64::from).iter().product::<f64>() * MIN_LIT) as usize;
        let mut planned = PlannedPictures::default();
        for camera in poses {
            if stop() {
                return Err(BakeError::Stopped);
            }
            let lit = planned.add(tracer, camera, coarse, &empty, least);
            if !lit.is_empty() {
                let mask = PixelMask::of(&lit, coarse);
                let is_lit = |x: f32, y: f32| mask.covers([x.into(), y.into()], 0.5);
                let shown = picture(tracer, camera, picture_size(self.size), is_lit);
                self.entries.push(PlanEntry { camera: *camera, counts: self.demand.counts(&shown), mask });
            }
        }
        Ok(())
    }

    /// Number of references.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// True if there are no references; never so for a plan that was made without an error.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Poses of the references.
    pub fn cameras(&self) -> impl Iterator<Item = &Camera> {
        self.entries.iter().map(|entry| &entry.camera)
    }

    /// True if a reference lights a pixel, given by its index in a row-major picture of the plan's
    /// size, where it shows a surface that can be lit.
    pub fn lights(&self, reference: usize, pixel: u32) -> bool {
        let [width, height] = self.size;
        let place = |at: u32, edge: u32| (f64::from(at) + 0.5) / f64::from(edge.max(1));
        let at = [place(pixel % width.max(1), width), place(pixel / width.max(1), height)];
        self.entries[reference].mask.covers(at, self.reach)
    }

    /// The settings of a reference in a pass. All that it depends on, besides the scene, decides
    /// its random numbers, so that these also tell it from others in a store.
    pub fn settings(&self, reference: usize, trace: &TraceSettings, pass: u32) -> TraceSettings {
        let PlanEntry { camera, mask, .. } = &self.entries[reference];
        let eye = camera.eye.to_array();
        let numbers = eye.into_iter().chain([camera.yaw, camera.pitch, camera.fov_y]).map(f64::to_bits);
        let start = Key::of_pixel(mask.hash(), self.size[0]).with(self.size[1]).with(pass);
        let key = numbers.fold(start, |key, bits| key.with(bits as u32).with((bits >> 32) as u32));
        let samples = trace.samples.max(1).checked_shl(pass).unwrap_or(u32::MAX);
        settings_of_reference(&TraceSettings { samples, ..*trace }, BAKED | key.bits() >> 33)
    }
}

/// The poses of viewers, and those that references are chosen from; none where they are the same.
fn poses_of(
    tracer: &Tracer,
    placement: &BakePlacement,
    size: [u32; 2],
) -> Result<(Vec<Camera>, Vec<Camera>), BakeError> {
    if let BakePlacement::Poses(poses) = placement {
        return if poses.is_empty() { Err(BakeError::EmptyPath) } else { Ok((poses.clone(), Vec::new())) };
    }
    let fov_y = tracer.scene().start().fov_y;
    let viewers = looking_around(&places(tracer), size, fov_y);
    if viewers.is_empty() {
        return Err(BakeError::NoPlace);
    }
    match placement {
        BakePlacement::Grid => Ok((viewers, on_grid(tracer, size, fov_y))),
        _ => Ok((viewers, Vec::new())),
    }
}
impl BakePlan {
    #[doc(hidden)]
    pub fn describe(&self) -> String {
        let mut cover = super::demand::Cover::new(&self.demand);
        let mut lines = String::new();
        let mut sum = 0.0;
        for (at, entry) in self.entries.iter().enumerate() {
            cover.add(&entry.counts);
            sum += entry.mask.share();
            if at % 10 == 9 || at + 1 == self.entries.len() {
                lines += &format!(
                    "{at}: share {:.3} sum {sum:.2} covered {:.4}\n",
                    entry.mask.share(),
                    cover.share()
                );
            }
        }
        lines
    }
}
