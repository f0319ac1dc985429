//! A store in use by a walk: which of its references serve a view, and which new ones it gets.

use super::cells::{cells_of_view, side_m};
use super::content::SceneContent;
use super::index::{RecordPlace, StoreIndex};
use super::serving::{Cover, Shares, WANTED_COVER, WANTED_STALE};
use super::states::States;
use super::summary::{Purpose, RecordSummary};
use super::writer::{StoreWriter, WriteJob, WriteReport};
use super::{StoreError, StoreSettings};
use crate::camera::Camera;
use crate::reference::{ReferenceCache, ReferenceFrame, ReferenceId};
use crate::trace::{TraceSettings, Tracer};
use rayon::prelude::*;
use std::cmp::Reverse;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;
use std::time::Instant;

/// How far the viewer moves, as a share of a cell's side, until references are chosen again.
const STEP: f64 = 0.125;

/// Cosine of the angle by which the viewer turns until references are chosen again: 4 degrees.
const TURN_COSINE: f64 = 0.9976;

/// Choices during which a reference that was evicted is not read again.
const REST: u64 = 16;

/// References that are read at once: they are in memory twice, as bytes and as pixels.
const AT_ONCE: usize = 8;

/// A record that fits the scene and the settings.
#[derive(Clone, Copy, Debug)]
struct Candidate {
    place: RecordPlace,
    state: State,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    /// It can be read.
    Stored,
    /// It was read, and is in the cache unless it was evicted since.
    Read(ReferenceId),
    /// It was evicted, or cannot be read, and is not read before a choice with this number.
    Resting(u64),
}

/// What a walk took from a store, and gave to it.
#[derive(Clone, Debug, Default)]
pub struct StoreReport {
    /// References that were read.
    pub references_read: usize,
    /// Time in seconds that the walk spent on the store, without the thread that writes.
    pub secs: f64,
    /// Records that were written to the store, and those that could not be.
    pub written: WriteReport,
    /// Problems, one line each.
    pub problems: Vec<String>,
}

/// Leaves out records of a view that was refined further: a later one holds their light as well.
fn leave_out_improved(index: &StoreIndex, places: &mut Vec<RecordPlace>) {
    let refined: Vec<RecordPlace> =
        places.iter().copied().filter(|place| index.summary(*place).is_refined).collect();
    let is_improved =
        |place: &RecordPlace| refined.iter().any(|other| index.summary(*place).is_in(index.summary(*other)));
    places.retain(|place| !is_improved(place));
}

/// What candidates of one kind cover of a view.
#[derive(Default)]
struct Offers {
    /// Of those that were read already.
    read: Vec<Shares>,
    /// Those that can be read, and what they cover.
    open: Vec<usize>,
    shares: Vec<Shares>,
}

/// A store in use by a walk.
#[derive(Debug)]
pub struct StoreSession {
    settings: StoreSettings,
    index: StoreIndex,
    tracer: Arc<Tracer>,
    content: Arc<SceneContent>,
    /// Which references serve: those with these bounces, for this purpose.
    kind: Option<(u32, Purpose)>,
    candidates: Vec<Candidate>,
    /// The view for which references were chosen last, and how often that was done.
    chosen_for: Option<Camera>,
    /// The pose ahead of the viewer for which all were read.
    ahead: Option<Camera>,
    /// References serve that view that were not read yet.
    is_unfinished: bool,
    choices: u64,
    states: States,
    touched: Vec<bool>,
    writer: StoreWriter,
    waits: bool,
    report: StoreReport,
}

impl StoreSession {
    /// Opens a store for a walk through a scene. With `waits`, the walk waits for the store: it
    /// reads all references that serve a view at once, and drops none of its own. Without, it reads
    /// a few before each frame.
    ///
    /// # Errors
    /// [`StoreError`] if the folder exists and cannot be read.
    pub fn open(settings: &StoreSettings, tracer: &Arc<Tracer>, waits: bool) -> Result<Self, StoreError> {
        let start = Instant::now();
        let index = StoreIndex::read(&settings.folder)?;
        let report = StoreReport { problems: index.problems.clone(), ..StoreReport::default() };
        let mut session = Self {
            settings: settings.clone(),
            touched: vec![false; index.segments.len()],
            index,
            tracer: Arc::clone(tracer),
            content: Arc::new(SceneContent::new(tracer.scene())),
            kind: None,
            candidates: Vec::new(),
            chosen_for: None,
            ahead: None,
            is_unfinished: false,
            choices: 0,
            states: States::default(),
            writer: StoreWriter::start(settings),
            waits,
            report,
        };
        session.report.secs = start.elapsed().as_secs_f64();
        let (folder, segments) = (session.settings.folder.display(), session.index.segments.len());
        log::info!("store {folder}: {segments} segments, in {:.3} s", session.report.secs);
        for problem in &session.index.problems {
            log::warn!("store {folder}: {problem}");
        }
        Ok(session)
    }

    /// A number that no stored reference of a walk has, by which new ones get random numbers of
    /// their own (`settings_of_reference`): there are at most as many as records of the scene.
    pub fn last_number(&self) -> u32 {
        /// Numbers from the double of this on belong to pictures at rest.
        const NUMBERS: usize = 1 << 14;
        let is_of_scene = |place: &RecordPlace| {
            let summary = self.index.summary(*place);
            summary.holds_in(&self.content) || summary.may_hold_in(&self.content)
        };
        (self.index.places().iter().filter(|place| is_of_scene(place)).count() % NUMBERS) as u32
    }

    /// Changes the scene.
    pub fn set_tracer(&mut self, tracer: &Arc<Tracer>) {
        let [before, now] = [&self.tracer, tracer].map(|tracer| tracer.scene());
        let is_edit = before.has_same_geometry(now) && Arc::ptr_eq(&before.textures, &now.textures);
        let content = match is_edit {
            true => self.content.edited(tracer.scene()),
            false => SceneContent::new(tracer.scene()),
        };
        self.content = Arc::new(content);
        self.tracer = Arc::clone(tracer);
        self.kind = None;
        self.states.clear();
    }

    /// Reads the references that serve a view into the cache, those that show most of it first.
    pub fn read_for(
        &mut self,
        (camera, size): (&Camera, [u32; 2]),
        trace: &TraceSettings,
        purpose: Purpose,
        cache: &mut ReferenceCache,
    ) {
        let start = Instant::now();
        self.choose_candidates(trace.bounces, purpose, cache);
        if !self.candidates.is_empty() && self.has_moved(camera) {
            let serving = self.serving(camera, size, cache);
            self.is_unfinished = self.read_some(&serving, cache) < serving.len();
        }
        self.report.secs += start.elapsed().as_secs_f64();
    }

    /// Reads the references that serve a pose where a new reference is about to be traced, and
    /// returns their number: what is stored need not be traced.
    pub fn read_ahead(
        &mut self,
        (pose, size): (&Camera, [u32; 2]),
        trace: &TraceSettings,
        purpose: Purpose,
        cache: &mut ReferenceCache,
    ) -> usize {
        let start = Instant::now();
        let before = self.report.references_read;
        self.choose_candidates(trace.bounces, purpose, cache);
        let is_known = self.ahead.as_ref().is_some_and(|last| self.is_near(last, pose));
        if !is_known && self.candidates.iter().any(|candidate| candidate.state == State::Stored) {
            let serving = self.serving(pose, size, cache);
            let is_whole = self.read_some(&serving, cache) == serving.len();
            self.ahead = is_whole.then_some(*pose);
        }
        self.report.secs += start.elapsed().as_secs_f64();
        self.report.references_read - before
    }

    /// Reads all of these references if the walk waits for the store, otherwise the first few.
    /// Returns how many were tried.
    fn read_some(&mut self, serving: &[usize], cache: &mut ReferenceCache) -> usize {
        let tried = if self.waits { serving.len() } else { serving.len().min(AT_ONCE) };
        self.read(&serving[..tried], cache);
        tried
    }

    /// True where the view differs from that of the last choice.
    fn has_moved(&mut self, camera: &Camera) -> bool {
        let is_near = self.chosen_for.as_ref().is_some_and(|last| self.is_near(last, camera));
        let has_moved = self.is_unfinished || !is_near;
        if has_moved {
            self.chosen_for = Some(*camera);
        }
        has_moved
    }

    /// True where what serves one camera serves the other.
    fn is_near(&self, last: &Camera, camera: &Camera) -> bool {
        let step = STEP * side_m(self.tracer.scene());
        let is_turned = last.forward().dot(camera.forward()) < TURN_COSINE;
        last.eye.distance(camera.eye) <= step && !is_turned && last.fov_y >= camera.fov_y
    }

    /// Lists the records that fit scene and settings, unless they are listed already.
    fn choose_candidates(&mut self, bounces: u32, purpose: Purpose, cache: &ReferenceCache) {
        if self.kind.replace((bounces, purpose)) == Some((bounces, purpose)) {
            return;
        }
        let fits = |place: &RecordPlace| {
            let summary = self.index.summary(*place);
            let is_kind = summary.settings.bounces == bounces && summary.purpose == purpose;
            // References of mode `paper` also hold how often light is reflected.
            let is_marked = purpose == Purpose::LookUp && summary.may_hold_in(&self.content);
            let is_of_use = is_marked && self.states.may_serve(summary.state);
            is_kind && (summary.holds_in(&self.content) || is_of_use)
        };
        (self.chosen_for, self.ahead) = (None, None);
        let mut places: Vec<RecordPlace> = self.index.places().into_iter().filter(fits).collect();
        // Of references that serve equally well, those with the least noise come first.
        places.sort_by_key(|place| Reverse(self.index.summary(*place).settings.samples));
        leave_out_improved(&self.index, &mut places);
        let read = self.read_already(cache);
        let state = |place: &RecordPlace| read.get(place).copied().unwrap_or(State::Stored);
        self.candidates = places.into_iter().map(|place| Candidate { place, state: state(&place) }).collect();
    }

    /// What was read for another state of the scene, and is in the cache still.
    fn read_already(&self, cache: &ReferenceCache) -> HashMap<RecordPlace, State> {
        let is_held = |candidate: &&Candidate| {
            let camera = self.index.summary(candidate.place).camera;
            let State::Read(id) = candidate.state else { return false };
            cache.entries().iter().any(|entry| entry.id == id && entry.frame.camera == camera)
        };
        let read = self.candidates.iter().filter(is_held);
        read.map(|candidate| (candidate.place, candidate.state)).collect()
    }

    /// Candidates to be read for a view, best first.
    fn serving(&mut self, camera: &Camera, size: [u32; 2], cache: &ReferenceCache) -> Vec<usize> {
        self.choices += 1;
        let seen = cells_of_view(&self.tracer, camera);
        let mut cover = Cover::new(&seen, size);
        let held: HashSet<ReferenceId> = cache.entries().iter().map(|entry| entry.id).collect();
        // First those all of whose light holds.
        let mut offers = [(Offers::default(), WANTED_COVER), (Offers::default(), WANTED_STALE)];
        for (at, candidate) in self.candidates.iter_mut().enumerate() {
            let summary = self.index.summary(candidate.place);
            let is_stale = !summary.holds_in(&self.content);
            let covers = cover.shares(&summary.cells);
            candidate.state = match candidate.state {
                State::Read(id) if !held.contains(&id) => State::Resting(self.choices + REST),
                State::Resting(until) if self.choices >= until => State::Stored,
                state => state,
            };
            let (offers, _) = &mut offers[usize::from(is_stale)];
            match candidate.state {
                State::Read(_) => offers.read.push(covers),
                State::Stored if is_stale && !self.states.may_serve(summary.state) => {}
                State::Stored if !covers.is_empty() => {
                    offers.open.push(at);
                    offers.shares.push(covers);
                }
                _ => {}
            }
        }
        let mut chosen = Vec::new();
        for (offers, wanted) in offers {
            offers.read.iter().for_each(|covers| cover.add(covers));
            chosen.extend(cover.choose(&offers.shares, wanted).into_iter().map(|at| offers.open[at]));
        }
        chosen
    }

    /// Reads references into the cache, several at a time, until they fill half of it.
    fn read(&mut self, serving: &[usize], cache: &mut ReferenceCache) {
        let mut bytes = 0;
        for group in serving.chunks(AT_ONCE) {
            let places = group.iter().map(|&at| self.candidates[at].place);
            for (&at, reference) in group.iter().zip(self.load(&places.collect::<Vec<_>>(), cache)) {
                bytes += self.take(at, reference, cache);
            }
            if bytes > cache.budget_bytes() / 2 {
                break;
            }
        }
    }

    /// Reads records. `None` for those that are damaged, or of which nothing is known to hold.
    fn load(&mut self, places: &[RecordPlace], cache: &ReferenceCache) -> Vec<Option<ReferenceFrame>> {
        let (index, scene) = (&self.index, (&*self.tracer, &*self.content));
        let load = |&place: &RecordPlace| index.load(place, scene.0, scene.1);
        let results: Vec<_> = places.par_iter().map(load).collect();
        let mut loaded = Vec::new();
        for (&place, result) in places.iter().zip(results) {
            let found = result.map_err(|problem| self.report.problems.push(problem)).ok();
            loaded.push((index.summary(place), found));
        }
        self.states.mark(&mut loaded, scene, cache);
        loaded.into_iter().map(|(_, found)| found.map(|(reference, _)| reference)).collect()
    }

    /// Puts a reference that was read into the cache and returns its bytes in memory.
    fn take(&mut self, at: usize, reference: Option<ReferenceFrame>, cache: &mut ReferenceCache) -> usize {
        let place = self.candidates[at].place;
        self.candidates[at].state = State::Resting(u64::MAX);
        let Some(reference) = reference else { return 0 };
        let bytes = reference.bytes();
        self.candidates[at].state = State::Read(cache.insert(Arc::new(reference)));
        self.report.references_read += 1;
        if !std::mem::replace(&mut self.touched[place.segment], true) {
            self.index.touch(place);
        }
        bytes
    }

    /// Sum of the shares of a frame that references of the store supplied, 0..1.
    pub fn share_of(&self, shares: &[(ReferenceId, f32)]) -> f32 {
        let is_stored = |id: ReferenceId| self.candidates.iter().any(|c| c.state == State::Read(id));
        shares.iter().filter(|(id, share)| *share > 0.0 && is_stored(*id)).map(|(_, share)| share).sum()
    }

    /// Problems that were not taken yet, one line each.
    pub fn take_problems(&mut self) -> Vec<String> {
        let mut problems = std::mem::take(&mut self.report.problems);
        problems.extend(self.writer.take_problem());
        problems
    }

    /// Stores a new reference, on a thread of its own. Records have no roll: one that has is left
    /// out.
    pub fn keep(&mut self, reference: &Arc<ReferenceFrame>, purpose: Purpose) {
        let start = Instant::now();
        let is_level = reference.camera.roll == 0.0;
        if is_level && reference.lit() > 0 && reference.epoch == self.tracer.epoch() {
            self.forget_improved(reference);
            let (tracer, content) = (Arc::clone(&self.tracer), Arc::clone(&self.content));
            let job = WriteJob { reference: Arc::clone(reference), purpose, tracer, content };
            self.writer.write(job, self.waits);
        }
        self.report.secs += start.elapsed().as_secs_f64();
    }

    /// Reads no record again whose light is in a reference that was refined.
    fn forget_improved(&mut self, reference: &ReferenceFrame) {
        let is_held = |old: &RecordSummary| {
            old.is_refined
                && old.camera == reference.camera
                && old.size == reference.view.size
                && old.settings.samples < reference.settings.samples
        };
        for candidate in self.candidates.iter_mut().filter(|_| reference.is_refined) {
            if is_held(self.index.summary(candidate.place)) {
                candidate.state = State::Resting(u64::MAX);
            }
        }
    }

    /// Waits until all references are written.
    pub fn finish(&mut self) {
        let start = Instant::now();
        self.writer.finish();
        self.report.secs += start.elapsed().as_secs_f64();
    }

    /// Size of the store in bytes, all segments together.
    pub fn bytes(&self) -> u64 {
        let paths = super::segment::segment_paths(&self.settings.folder).unwrap_or_default();
        paths.iter().filter_map(|path| path.metadata().ok()).map(|metadata| metadata.len()).sum()
    }

    /// What was read and written so far.
    pub fn report(&self) -> StoreReport {
        let written = self.writer.report();
        let problems = self.report.problems.iter().chain(&written.problem).cloned().collect();
        StoreReport { written: written.clone(), problems, ..self.report.clone() }
    }
}
