//! The part of a record that the index holds: what the reference is, and what it shows.

use super::bytes::{ByteReader, ByteWriter, list};
use super::cells::{Cell, CellCount, CellCounts, MAX_CELLS};
use super::content::SceneContent;
use crate::camera::{Camera, SceneFrame};
use crate::raster::rgb9e5::Rgb9e5Scale;
use crate::reference::ReferenceFrame;
use crate::scene::Scene;
use crate::trace::TraceSettings;

/// Largest number of pixels of a stored reference: a picture of 8192 by 4096.
pub(super) const MAX_PIXELS: u64 = 1 << 25;

/// Largest number of dependencies of a record.
const MAX_DEPENDENCIES: usize = 1 << 16;

/// Largest exponent offset whose colours are finite.
const MAX_EXPONENT_OFFSET: u32 = 254 - 31;

const DENSE: u32 = 1;
const SMOOTH: u32 = 2;
const REFLECTIONS: u32 = 4;
const WARPED: u32 = 8;
const REFINED: u32 = 16;

/// What a reference is traced for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Look-ups of modes `fast` and `exact`.
    LookUp,
    /// The warp of mode `paper`, whose references are not filtered.
    Warp,
}

/// What a stored reference is, without its pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordSummary {
    /// Camera of the picture, world space.
    pub camera: Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Samples, bounces and seed.
    pub settings: TraceSettings,
    /// Number of pixels whose light is stored.
    pub lit: u32,
    /// True if every pixel was lit, as in the paper's references.
    pub is_dense: bool,
    /// True if it holds the light of all records of the view that were refined less.
    pub is_refined: bool,
    /// What it was traced for.
    pub purpose: Purpose,
    /// Hashes of everything that the light depends on.
    pub dependencies: Vec<u128>,
    /// Hash of the geometry that it shows.
    pub(super) geometry: u128,
    /// Hash of the materials, sun and sky that it was lit with.
    pub(super) state: u128,
    /// Transform between world and scene space when the reference was traced.
    pub(super) frame: SceneFrame,
    pub(super) light_scale: Rgb9e5Scale,
    pub(super) smooth_scale: Rgb9e5Scale,
    pub(super) has_smooth: bool,
    pub(super) has_reflections: bool,
    pub(super) cells: CellCounts,
}

impl RecordSummary {
    pub(super) fn of(
        reference: &ReferenceFrame,
        purpose: Purpose,
        scene: &Scene,
        content: &SceneContent,
    ) -> Self {
        Self {
            purpose,
            camera: reference.camera,
            size: reference.view.size,
            settings: reference.settings,
            lit: reference.lit() as u32,
            is_dense: reference.is_dense(),
            is_refined: reference.is_refined,
            dependencies: content.dependencies().to_vec(),
            geometry: content.geometry(),
            state: content.state().1,
            frame: scene.frame,
            light_scale: reference.packed_light().1,
            smooth_scale: reference.packed_smooth().1,
            has_smooth: reference.has_smooth_light(),
            has_reflections: reference.has_reflections(),
            cells: CellCounts::of(reference, scene),
        }
    }

    /// Number of pixels, lit or not.
    pub(super) fn pixels(&self) -> usize {
        self.size.map(|edge| edge as usize).iter().product()
    }

    /// True where the light still holds in a scene, all of it.
    pub(super) fn holds_in(&self, content: &SceneContent) -> bool {
        self.dependencies == content.dependencies()
    }

    /// True where some of the light may still hold in a scene: one of the same geometry.
    pub(super) fn may_hold_in(&self, content: &SceneContent) -> bool {
        self.geometry == content.geometry()
    }

    /// True where another record holds all of this one's light: of the same view and light, and
    /// refined further.
    pub(super) fn is_in(&self, other: &Self) -> bool {
        let is_view = self.camera == other.camera && self.size == other.size;
        let is_light = self.dependencies == other.dependencies
            && self.settings.bounces == other.settings.bounces
            && self.purpose == other.purpose;
        let is_refined = self.is_refined && other.is_refined;
        is_view && is_light && is_refined && other.settings.samples > self.settings.samples
    }

    pub(super) fn write(&self) -> Vec<u8> {
        let mut to = ByteWriter::default();
        to.point(self.camera.eye);
        [self.camera.yaw, self.camera.pitch, self.camera.fov_y].iter().for_each(|angle| to.f64(*angle));
        to.point(self.frame.origin_in_world_m);
        to.f64(self.frame.units_per_metre);
        to.u32(self.size[0]);
        to.u32(self.size[1]);
        to.u32(self.settings.samples);
        to.u32(self.settings.bounces);
        to.u64(self.settings.seed);
        to.u32(self.lit);
        to.u32(
            (u32::from(self.is_dense) * DENSE)
                | (u32::from(self.has_smooth) * SMOOTH)
                | (u32::from(self.has_reflections) * REFLECTIONS)
                | (u32::from(self.purpose == Purpose::Warp) * WARPED)
                | (u32::from(self.is_refined) * REFINED),
        );
        to.u32(self.light_scale.exponent_offset);
        to.u32(self.smooth_scale.exponent_offset);
        to.u32(self.dependencies.len() as u32);
        self.dependencies.iter().for_each(|hash| to.u128(*hash));
        to.u128(self.geometry);
        to.u128(self.state);
        to.f64(self.cells.side_m);
        to.u32(self.cells.counts.len() as u32);
        for CellCount { cell, lit, seen } in &self.cells.counts {
            cell.cube.iter().for_each(|coordinate| to.u32(*coordinate as u32));
            [cell.face, *lit, *seen].iter().for_each(|value| to.u32(*value));
        }
        to.0
    }

    /// Reads a summary; `None` where the bytes are none.
    pub(super) fn read(bytes: &[u8]) -> Option<Self> {
        let mut from = ByteReader(bytes);
        let eye = from.point()?;
        let camera = Camera { eye, yaw: from.f64()?, pitch: from.f64()?, fov_y: from.f64()?, roll: 0.0 };
        let frame = SceneFrame { origin_in_world_m: from.point()?, units_per_metre: from.f64()? };
        let size = [from.u32()?, from.u32()?];
        let settings = TraceSettings { samples: from.u32()?, bounces: from.u32()?, seed: from.u64()? };
        let (lit, flags) = (from.u32()?, from.u32()?);
        let [light_scale, smooth_scale] = [scale(&mut from)?, scale(&mut from)?];
        let summary = Self {
            camera,
            size,
            settings,
            lit,
            is_dense: flags & DENSE != 0,
            is_refined: flags & REFINED != 0,
            purpose: if flags & WARPED == 0 { Purpose::LookUp } else { Purpose::Warp },
            dependencies: list(&mut from, MAX_DEPENDENCIES, 16, ByteReader::u128)?,
            geometry: from.u128()?,
            state: from.u128()?,
            frame,
            light_scale,
            smooth_scale,
            has_smooth: flags & SMOOTH != 0,
            has_reflections: flags & REFLECTIONS != 0,
            cells: CellCounts { side_m: from.f64()?, counts: list(&mut from, MAX_CELLS, 24, cell)? },
        };
        (from.0.is_empty() && summary.is_sound()).then_some(summary)
    }

    /// True where the numbers can describe a reference.
    fn is_sound(&self) -> bool {
        let pixels = self.size.map(u64::from).iter().product::<u64>();
        let frame = &self.frame;
        let is_placed = frame.origin_in_world_m.is_finite() && is_length(frame.units_per_metre);
        let is_sized = self.size.iter().all(|&edge| edge > 0 && edge <= 1 << 16) && pixels <= MAX_PIXELS;
        let is_lit = u64::from(self.lit) <= pixels && self.has_smooth == (self.settings.bounces > 0);
        self.camera.is_valid() && is_placed && is_sized && is_lit && is_length(self.cells.side_m)
    }
}

fn is_length(value: f64) -> bool {
    value.is_finite() && value > 0.0
}

fn scale(from: &mut ByteReader<'_>) -> Option<Rgb9e5Scale> {
    let exponent_offset = from.u32()?;
    (1..=MAX_EXPONENT_OFFSET).contains(&exponent_offset).then_some(Rgb9e5Scale { exponent_offset })
}

fn cell(from: &mut ByteReader<'_>) -> Option<CellCount> {
    let cube = [from.u32()?, from.u32()?, from.u32()?].map(|coordinate| coordinate as i32);
    let cell = Cell { cube, face: from.u32()? };
    Some(CellCount { cell, lit: from.u32()?, seen: from.u32()? })
}
