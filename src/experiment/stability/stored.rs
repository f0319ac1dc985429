//! Cases J of the catalogue: a store of references on disk, and whatever happens to its files.

use super::case::{Case, Measured, Outcome, Trial, case, total};
use super::pictures::{SIZE, TRACE, reference, unequal};
use super::rooms::{Room, dvec};
use crate::camera::Camera;
use crate::experiment::run::ExperimentError;
use crate::math::key::Key;
use crate::reference::{ReferenceCache, ReferenceFrame};
use crate::render::{Mode, RenderSettings, Walkthrough, WalkthroughSettings};
use crate::store::{Purpose, StoreIndex, StoreSession, StoreSettings};
use crate::trace::{Tracer, parallel::NEVER};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

pub(super) const CASES: &[Case] = &[
    case("J1 a store that is read back", "pixels with other bits", 0.0, read_back),
    case("J2 a segment cut at any byte", "whole records lost, and wrong pixels", 0.0, cut),
    case("J3 a flipped bit in a segment", "other records lost, and wrong pixels", 0.0, flipped),
    case("J4 lengths of 2^63", "records accepted", 0.0, hostile_lengths),
    case("J5 a store of another version", "records read, and lines but one", 0.0, other_version),
    case("J6 a store of another scene", "references read", 0.0, other_scene),
    case("J7 light of before an edit", "pixels used whose light is off by 2 %", 0.0, halved_light),
    case("J8 four writers at once", "records lost", 0.0, four_writers),
    case("J9 a store that cannot be written", "pixels that change, and lines but one", 0.0, unwritable),
    case("J10 a store that is full", "bytes above its limit, and lines but one", 0.0, full_store),
];

/// A folder that is removed in the end.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Result<Self, ExperimentError> {
        static NUMBER: AtomicU32 = AtomicU32::new(0);
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("afterimage-stability-{}-{number}", std::process::id()));
        std::fs::create_dir_all(&path)
            .map_err(|cause| ExperimentError::File { path: path.clone(), cause })?;
        Ok(Self(path))
    }

    fn settings(&self) -> StoreSettings {
        StoreSettings { folder: self.0.clone(), max_bytes: 1 << 30 }
    }

    /// The only segment.
    fn segment(&self) -> PathBuf {
        self.0.join("00000001.seg")
    }

    fn write(&self, bytes: &[u8]) -> Result<(), ExperimentError> {
        let path = self.segment();
        std::fs::write(&path, bytes).map_err(|cause| ExperimentError::File { path, cause })
    }

    fn bytes(&self) -> Result<Vec<u8>, ExperimentError> {
        let path = self.segment();
        std::fs::read(&path).map_err(|cause| ExperimentError::File { path, cause })
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A store of two references, one per record.
struct Stored {
    tracer: Arc<Tracer>,
    camera: Camera,
    references: Vec<Arc<ReferenceFrame>>,
    folder: Folder,
}

fn failed(error: &dyn std::error::Error) -> ExperimentError {
    ExperimentError::Unsuitable(error.to_string())
}

fn open(settings: &StoreSettings, tracer: &Arc<Tracer>) -> Result<StoreSession, ExperimentError> {
    StoreSession::open(settings, tracer, true).map_err(|error| failed(&error))
}

fn index(folder: &Path) -> Result<StoreIndex, ExperimentError> {
    StoreIndex::read(folder).map_err(|error| failed(&error))
}

impl Stored {
    fn new() -> Result<Self, ExperimentError> {
        let (tracer, camera) = Room::SHINY.stage()?;
        let aside = Camera { eye: camera.eye + dvec(0.4, 0.2, -0.3), ..camera };
        let references = [camera, aside].map(|camera| Arc::new(reference(&tracer, &camera, SIZE)));
        let stored =
            Self { tracer: Arc::new(tracer), camera, references: references.into(), folder: Folder::new()? };
        let mut session = open(&stored.folder.settings(), &stored.tracer)?;
        stored.references.iter().for_each(|reference| session.keep(reference, Purpose::LookUp));
        session.finish();
        Ok(stored)
    }

    /// Reads what serves the view, and counts the references that were read, and their pixels that
    /// no reference that was written has.
    fn read(&self, tracer: &Arc<Tracer>) -> Result<(Vec<Arc<ReferenceFrame>>, usize), ExperimentError> {
        let mut session = open(&self.folder.settings(), tracer)?;
        let mut cache = ReferenceCache::new(tracer.scene(), 1 << 30);
        session.read_for((&self.camera, SIZE), &TRACE, Purpose::LookUp, &mut cache);
        let read: Vec<_> = cache.entries().iter().map(|entry| Arc::clone(&entry.frame)).collect();
        let wrong = |found: &Arc<ReferenceFrame>| {
            let written = self.references.iter().find(|written| written.camera == found.camera);
            written.map_or(found.lit(), |written| differing(written, found))
        };
        let wrong = read.iter().map(wrong).sum();
        Ok((read, wrong))
    }

    /// Counts what is wrong where a segment holds these bytes: missing records, and pixels.
    fn wrong_with(&self, bytes: &[u8], records: usize) -> Result<usize, ExperimentError> {
        self.folder.write(bytes)?;
        let missing = records.saturating_sub(index(&self.folder.0)?.len());
        Ok(missing + self.read(&self.tracer)?.1)
    }
}

/// Counts the pixels whose light, surface or depth has other bits.
fn differing(a: &ReferenceFrame, b: &ReferenceFrame) -> usize {
    let bits = |frame: &ReferenceFrame, pixel: u32| {
        let at = pixel as usize;
        (
            frame.light(pixel).to_array().map(f32::to_bits),
            frame.triangle()[at],
            frame.disparity()[at].to_bits(),
        )
    };
    let pixels = 0..(SIZE[0] * SIZE[1]);
    pixels.filter(|&pixel| b.has_light(pixel) && bits(a, pixel) != bits(b, pixel)).count()
}

fn read_back(_: &Trial) -> Outcome {
    let stored = Stored::new()?;
    let (read, wrong) = stored.read(&stored.tracer)?;
    let lost = usize::from(read.is_empty()) * stored.references[0].lit();
    Ok(Measured::from(wrong + lost).with_note(format!("{} references read", read.len())))
}

/// Where the records end, bytes from the beginning of the segment.
fn ends(folder: &Path) -> Result<Vec<usize>, ExperimentError> {
    const SEGMENT_HEADER: usize = 16;
    let mut end = SEGMENT_HEADER;
    let sizes: Vec<u64> = index(folder)?.records().map(|(_, _, bytes)| bytes).collect();
    Ok(sizes.iter().map(|&bytes| (end += bytes as usize, end).1).collect())
}

fn cut(trial: &Trial) -> Outcome {
    let stored = Stored::new()?;
    let (whole, ends) = (stored.folder.bytes()?, ends(&stored.folder.0)?);
    let cuts = (trial.tries / 200).min(1000) as usize;
    total(0..cuts, |cut| {
        let length = cut * whole.len() / cuts;
        stored.wrong_with(&whole[..length], ends.iter().filter(|&&end| end <= length).count())
    })
}

fn flipped(trial: &Trial) -> Outcome {
    let stored = Stored::new()?;
    let whole = stored.folder.bytes()?;
    total(0..(trial.tries / 200).min(1000), |flip| {
        let mut bytes = whole.clone();
        let bit = (f64::from(Key::of_pixel(7, flip).pair()[0]) * whole.len() as f64 * 8.0) as usize;
        bytes[(bit / 8).min(whole.len() - 1)] ^= 1 << (bit % 8);
        // The record that holds the bit is lost, or every one where it is in the first bytes.
        let records = if bit / 8 < 16 { 0 } else { stored.references.len() - 1 };
        stored.wrong_with(&bytes, records)
    })
}

fn hostile_lengths(_: &Trial) -> Outcome {
    let stored = Stored::new()?;
    let whole = stored.folder.bytes()?;
    // The lengths in the header of the first record: of the summary, the pixels, and both inflated.
    total([(16 + 8, 4), (16 + 16, 8), (16 + 24, 8)], |(at, size)| {
        let mut bytes = whole[..ends(&stored.folder.0)?.first().copied().unwrap_or(0)].to_vec();
        bytes[at..at + size].fill(0);
        bytes[at + size - 1] = 0x80;
        let found = Folder::new()?;
        found.write(&bytes)?;
        Ok(index(&found.0)?.len())
    })
}

fn other_version(_: &Trial) -> Outcome {
    let stored = Stored::new()?;
    let whole = stored.folder.bytes()?;
    total(1..=255, |version| {
        let mut bytes = whole.clone();
        bytes[8] = bytes[8].wrapping_add(version);
        stored.folder.write(&bytes)?;
        let found = index(&stored.folder.0)?;
        // A wrong checksum of the first bytes loses no record, a right one belongs to a version.
        Ok(stored.read(&stored.tracer)?.1 + found.problems.len().abs_diff(1))
    })
}

fn other_scene(_: &Trial) -> Outcome {
    let stored = Stored::new()?;
    let other = Arc::new(Room::PLAIN.tracer()?);
    Ok(stored.read(&other)?.0.len().into())
}

fn halved_light(_: &Trial) -> Outcome {
    let stored = Stored::new()?;
    let scene = stored.tracer.scene();
    let mut edit = scene.to_edit();
    edit.materials.iter_mut().for_each(|material| material.emission *= 0.5);
    if let Some(sun) = &mut edit.daylight.sun {
        sun.irradiance *= 0.5;
    }
    let halved = Arc::new(stored.tracer.with_same_geometry(Arc::new(scene.with_edit(&edit))));
    let (read, _) = stored.read(&halved)?;
    // The same random numbers: where a light is not halved, its light has the same bits.
    let used = |frame: &Arc<ReferenceFrame>| {
        let now = reference(&halved, &frame.camera, SIZE);
        let is_off = |&pixel: &u32| {
            let (old, now) = (frame.light(pixel), now.light(pixel));
            frame.has_light(pixel) && (old - now).abs().max_element() > 0.02 * now.max_element()
        };
        (0..SIZE[0] * SIZE[1]).filter(is_off).count()
    };
    let stale: usize = read.iter().map(|frame| frame.stale()).sum();
    let used: usize = read.iter().map(used).sum();
    Ok(Measured::from(used).with_note(format!("{stale} pixels marked as stale")))
}

fn four_writers(_: &Trial) -> Outcome {
    const EACH: usize = 8;
    let stored = Stored::new()?;
    let folder = Folder::new()?;
    let settings = folder.settings();
    let write = || {
        let mut session = open(&settings, &stored.tracer)?;
        (0..EACH).for_each(|_| session.keep(&stored.references[0], Purpose::LookUp));
        session.finish();
        Ok::<(), ExperimentError>(())
    };
    std::thread::scope(|scope| {
        let writers: Vec<_> = (0..4).map(|_| scope.spawn(write)).collect();
        writers.into_iter().try_for_each(|writer| writer.join().unwrap_or(Ok(())))
    })?;
    Ok((4 * EACH).abs_diff(index(&folder.0)?.len()).into())
}

/// Renders a view of a walk with a store, and returns its colours and the lines about the store.
fn walk_with(stored: &Stored, settings: &StoreSettings) -> Result<(Vec<glam::Vec3>, usize), ExperimentError> {
    let render = RenderSettings { mode: Mode::Exact, trace: TRACE };
    let mut walk = Walkthrough::new(
        Arc::clone(&stored.tracer),
        WalkthroughSettings { render, ..WalkthroughSettings::default() },
    );
    walk.set_store(Some(open(settings, &stored.tracer)?));
    let radiance = walk.render(&stored.camera, SIZE, NEVER).radiance.clone();
    let mut session = walk.set_store(None);
    let lines = session.as_mut().map_or(0, |session| {
        session.finish();
        session.take_problems().len()
    });
    Ok((radiance, lines))
}

fn unwritable(_: &Trial) -> Outcome {
    let stored = Stored::new()?;
    let right = walk_with(&stored, &Folder::new()?.settings())?.0;
    // A folder cannot be created below a file.
    let settings = StoreSettings { folder: stored.folder.segment().join("below"), max_bytes: 1 << 30 };
    let (shown, lines) = match walk_with(&stored, &settings) {
        Ok(found) => found,
        // It is refused when it is opened, in one line.
        Err(_) => (right.clone(), 1),
    };
    Ok((unequal(&right, &shown) + lines.abs_diff(1)).into())
}

fn full_store(_: &Trial) -> Outcome {
    const LIMIT: u64 = 2000;
    let stored = Stored::new()?;
    let folder = Folder::new()?;
    let settings = StoreSettings { max_bytes: LIMIT, ..folder.settings() };
    let mut session = open(&settings, &stored.tracer)?;
    (0..4).for_each(|_| session.keep(&stored.references[0], Purpose::LookUp));
    session.finish();
    let above = index(&folder.0)?.bytes().saturating_sub(LIMIT) as usize;
    Ok((above + session.take_problems().len().abs_diff(1)).into())
}
