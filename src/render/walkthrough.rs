//! A walk: frame after frame from the cache, and the wish for a new reference where the policy has one.
//!
//! The window and the headless tour run the same walk; they differ only in when a wished reference is traced.

use super::accumulate::{Accumulation, CONVERGED_PASSES};
use super::audit::{Audited, Auditor};
use super::frame::{Frame, RefineState};
use super::prefetch::Ahead;
use super::reference_job::ReferenceJob;
use super::renderer::Renderer;
use super::request::{FrameRequest, References};
use super::settings::{Mode, RenderSettings};
use super::temporal_stability::TemporalStabilityWatch;
use crate::camera::{Camera, View};
use crate::lookup::{LookupSet, open_percent};
use crate::reference::cache::CachedReference;
use crate::reference::{
    Observation, PlacementPolicy, ReferenceCache, ReferenceFrame, ReferenceId, settings_of_reference,
};
use crate::trace::Tracer;
use crate::trace::parallel::Stop;
use crate::warp::ReferenceSelector;
use std::sync::Arc;
use std::time::Instant;

/// What a walk is made with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WalkthroughSettings {
    /// Mode, samples, bounces, seed.
    pub render: RenderSettings,
    /// Where references are added.
    pub placement: PlacementPolicy,
    /// References a frame uses at most.
    pub max_references: usize,
    /// Memory for references, bytes.
    pub cache_bytes: usize,
    /// Whether a few pixels of every looked-up frame are traced in full as well, to know how good it is and to find
    /// references that are wrong. How many depends on the clock.
    pub audits: bool,
    /// Whether every frame is compared with the one before it, to see what flickers.
    pub measures_stability: bool,
}

impl Default for WalkthroughSettings {
    fn default() -> Self {
        Self {
            render: RenderSettings::default(),
            placement: PlacementPolicy::default(),
            max_references: 8,
            cache_bytes: 1024 << 20,
            audits: false,
            measures_stability: false,
        }
    }
}

/// The state of a walk.
#[derive(Debug)]
pub struct Walkthrough {
    tracer: Arc<Tracer>,
    cache: ReferenceCache,
    selector: ReferenceSelector,
    renderer: Renderer,
    settings: WalkthroughSettings,
    previous: Option<Camera>,
    wanted: Option<Camera>,
    ahead: Ahead,
    used: Vec<ReferenceId>,
    references_made: u32,
    has_kept: bool,
    /// What the last frame was made with: settings, the references that were warped, the state of the cache.
    rendered: RenderSettings,
    selected: Vec<CachedReference>,
    rendered_from: u64,
    /// While frames are checked.
    auditor: Option<Auditor>,
    /// While frames are compared.
    watch: Option<TemporalStabilityWatch>,
    /// Of the last frame's pose, from the first [`Self::refine`] on.
    refinement: Option<Accumulation>,
}

impl Walkthrough {
    /// A walk with an empty cache.
    pub fn new(tracer: Arc<Tracer>, settings: WalkthroughSettings) -> Self {
        let cache = ReferenceCache::new(tracer.scene(), settings.cache_bytes);
        Self {
            tracer,
            cache,
            selector: ReferenceSelector::default(),
            renderer: Renderer::default(),
            settings,
            previous: None,
            wanted: None,
            ahead: Ahead::default(),
            used: Vec::new(),
            references_made: 0,
            has_kept: false,
            rendered: settings.render,
            selected: Vec::new(),
            rendered_from: 0,
            auditor: None,
            watch: None,
            refinement: None,
        }
    }

    /// The scene being walked.
    pub fn tracer(&self) -> &Arc<Tracer> {
        &self.tracer
    }

    /// Another scene, or the same one edited: references of the old one are dropped.
    pub fn set_tracer(&mut self, tracer: Arc<Tracer>) {
        self.tracer = tracer;
        self.cache = ReferenceCache::new(self.tracer.scene(), self.settings.cache_bytes);
        (self.previous, self.wanted) = (None, None);
        (self.refinement, self.auditor, self.watch) = (None, None, None);
        *self.renderer.frame_mut() = Frame::default();
        self.selected.clear();
    }

    /// The references.
    pub fn cache(&self) -> &ReferenceCache {
        &self.cache
    }

    /// The references, to be changed.
    pub fn cache_mut(&mut self) -> &mut ReferenceCache {
        &mut self.cache
    }

    /// What the walk is made with.
    pub fn settings(&self) -> &WalkthroughSettings {
        &self.settings
    }

    /// Changes what the walk is made with from the next frame on.
    pub fn set_settings(&mut self, settings: WalkthroughSettings) {
        self.cache.set_budget_bytes(settings.cache_bytes);
        self.settings = settings;
    }

    /// The same walk for someone who looks on: frames may be stopped and shown unfinished.
    #[must_use]
    pub fn progressive(mut self) -> Self {
        self.renderer.set_progressive(true);
        self
    }

    /// The last frame.
    pub fn frame(&self) -> &Frame {
        self.renderer.frame()
    }

    /// The references the last frame used, in the order of [`Frame::supplier`].
    pub fn used(&self) -> &[ReferenceId] {
        &self.used
    }

    /// Renders the next frame; afterwards [`Self::wanted_reference`] tells whether the policy wants a new reference.
    pub fn render(&mut self, camera: &Camera, size: [u32; 2], stop: Stop<'_>) -> &Frame {
        let start = Instant::now();
        self.keep_refinement(camera, size);
        let view = View::new(camera, &self.tracer.scene().frame, size);
        let selected = match self.settings.render.mode {
            Mode::Full | Mode::Fast | Mode::Exact => Vec::new(),
            Mode::Paper => {
                let most = self.settings.max_references;
                self.selector.select(&mut self.cache, &view, self.tracer.epoch(), most)
            }
        };
        let select_secs = start.elapsed().as_secs_f64();
        let settings = self.settings.render;
        self.selected = selected;
        let frames: Vec<&ReferenceFrame> = self.selected.iter().map(|r| &*r.frame).collect();
        let references = references_of(settings.mode, &self.cache, &frames);
        let request =
            FrameRequest { tracer: &self.tracer, camera, size, settings: &settings, references, stop };
        self.renderer.render(&request);
        self.rendered = settings;
        self.conclude(select_secs);
        self.previous = Some(*camera);
        if let Some(refinement) = &self.refinement {
            refinement.write_to(self.renderer.frame_mut());
        }
        self.renderer.frame()
    }

    /// Goes on with the last frame where a stop left it. It stays as it is where it is complete, and where settings or
    /// references have changed since.
    pub fn resume(&mut self, stop: Stop<'_>) -> &Frame {
        if !self.can_resume() {
            return self.renderer.frame();
        }
        let settings = self.rendered;
        let frames: Vec<&ReferenceFrame> = self.selected.iter().map(|r| &*r.frame).collect();
        let references = references_of(settings.mode, &self.cache, &frames);
        let Frame { camera, view, .. } = self.renderer.frame();
        let (camera, size) = (*camera, view.size);
        let request = FrameRequest {
            tracer: &self.tracer,
            camera: &camera,
            size,
            settings: &settings,
            references,
            stop,
        };
        self.renderer.resume(&request);
        self.conclude(0.0);
        self.renderer.frame()
    }

    /// True where the last frame was stopped and can be gone on with.
    pub fn can_resume(&self) -> bool {
        let frame = self.renderer.frame();
        let is_same = self.rendered == self.settings.render && self.cache.version() == self.rendered_from;
        is_same && !frame.stats.is_complete && !frame.radiance.is_empty()
    }

    /// What follows from a frame: who gave how much, whether it is kept, where a reference is wanted.
    fn conclude(&mut self, select_secs: f64) {
        let start = Instant::now();
        self.rendered_from = self.cache.version();
        self.keep_what_was_lit();
        self.used = match self.settings.render.mode.looks_up() {
            true => self.cache.ids_by_slot(),
            false => self.selected.iter().map(|r| r.id).collect(),
        };
        let (camera, size) = (self.frame().camera, self.frame().view.size);
        let shares = self.renderer.frame().supplier_shares(self.used.len());
        let shares: Vec<_> = self.used.iter().copied().zip(shares).collect();
        self.cache.note_contributions(&shares);
        self.wanted = self.decide(&camera, size);
        let select_secs = select_secs + start.elapsed().as_secs_f64();
        let secs = &mut self.renderer.frame_mut().stats.secs;
        secs.select = select_secs;
        secs.frame += select_secs;
        self.audit();
        self.measure_stability();
    }

    /// Compares the last frame with the one before it, where that is asked for.
    fn measure_stability(&mut self) {
        if !self.settings.measures_stability {
            self.watch = None;
        } else if self.renderer.frame().stats.is_complete {
            let watch = self.watch.get_or_insert_default();
            let temporal_stability = watch.compare(self.tracer.scene(), self.renderer.frame());
            self.renderer.frame_mut().stats.temporal_stability = temporal_stability;
        }
    }

    /// Checks a few pixels of the last frame, where that is asked for.
    fn audit(&mut self) {
        let settings = &self.settings;
        if !settings.audits || !settings.render.mode.looks_up() {
            self.auditor = None;
            return;
        }
        let auditor = self.auditor.get_or_insert_default();
        let frame = self.renderer.frame();
        if frame.stats.is_complete {
            let (tracer, trace) = (&*self.tracer, &settings.render.trace);
            let (secs, estimate) = auditor.audit(&Audited { tracer, frame, trace }, &mut self.cache);
            let stats = &mut self.renderer.frame_mut().stats;
            stats.audit = Some(estimate);
            stats.secs.audit = secs;
            stats.secs.frame += secs;
        }
    }

    /// A looked-up frame that had to light much itself becomes a reference, at the price of a copy.
    fn keep_what_was_lit(&mut self) {
        let stats = &self.renderer.frame().stats;
        let lit = stats.types.percentages().unseen_percent;
        let settings = &self.settings.render;
        self.has_kept = settings.mode.looks_up() && stats.is_complete && self.settings.placement.keeps(lit);
        if self.has_kept {
            let reference = self.renderer.shaded_reference(&self.tracer, settings);
            self.cache.insert(Arc::new(reference));
        }
    }

    /// True where the last frame became a reference.
    pub fn has_kept_frame(&self) -> bool {
        self.has_kept
    }

    /// Goes on refining the last frame's picture, until it has converged or `stop` says so: for a camera at rest.
    /// Pixels that are done show what they are so far, the others what they showed before. Work that was stopped is
    /// taken up again, also after another [`Self::render`] of the same pose; any other pose drops it and its memory.
    pub fn refine(&mut self, stop: Stop<'_>) -> RefineState {
        let (render, frame) = (self.settings.render, self.renderer.frame());
        let (camera, size, stats) = (frame.camera, frame.view.size, frame.stats);
        if !render.mode.refines() || frame.radiance.is_empty() {
            return RefineState { is_complete: true, ..RefineState::default() };
        }
        self.keep_refinement(&camera, size);
        let is_untouched = stats.is_complete && stats.refined == RefineState::default();
        let is_full = render.mode == Mode::Full && self.rendered == render && is_untouched;
        let refinement = self.refinement.get_or_insert_with(|| {
            let mut new = Accumulation::new(&self.tracer, &camera, size, &render.trace, CONVERGED_PASSES);
            if is_full {
                new.take_first_pass(self.renderer.frame());
            }
            new
        });
        refinement.run(&self.tracer, stop);
        refinement.write_to(self.renderer.frame_mut());
        refinement.state()
    }

    /// Drops the work of [`Self::refine`], so that the next frame is again as its mode makes it.
    pub fn drop_refinement(&mut self) {
        self.refinement = None;
    }

    /// Drops the refinement of another pose or other settings.
    fn keep_refinement(&mut self, camera: &Camera, size: [u32; 2]) {
        let render = &self.settings.render;
        let is_wanted =
            |r: &Accumulation| render.mode.refines() && r.is_of(&self.tracer, camera, size, &render.trace);
        self.refinement = self.refinement.take().filter(is_wanted);
    }

    fn decide(&mut self, camera: &Camera, size: [u32; 2]) -> Option<Camera> {
        if self.settings.render.mode == Mode::Full {
            return None;
        }
        let types = self.frame().stats.types.percentages();
        let is_sparse = self.settings.render.mode.looks_up();
        let seen = Observation {
            camera: *camera,
            previous: self.previous.unwrap_or(*camera),
            open_percent: if is_sparse { types.unseen_percent } else { types.type3_percent },
            is_sparse,
            was_cut: !self.frame().stats.is_complete,
            held: self.cache.entries().len(),
        };
        if let Some(pose) = self.wanted_ahead(camera, size) {
            return Some(pose);
        }
        let (tracer, cache, most) = (&self.tracer, &self.cache, self.settings.max_references);
        let placement = self.settings.placement;
        let view = |pose: &Camera| View::new(pose, &tracer.scene().frame, size);
        if is_sparse {
            let lookup = LookupSet::new(cache, tracer.epoch());
            return placement.decide(&seen, size, tracer, &mut |pose, spots| {
                open_percent(tracer, &view(pose), &lookup, spots)
            });
        }
        let selector = &mut self.selector;
        placement.decide(&seen, size, tracer, &mut |pose, spots| {
            selector.predict_open_percent(cache, &view(pose), tracer.epoch(), most, spots)
        })
    }

    /// The pose of a reference that the policy wants before this frame is rendered, whatever it shows.
    pub fn wanted_ahead(&mut self, camera: &Camera, size: [u32; 2]) -> Option<Camera> {
        let (placement, mode) = (self.settings.placement, self.settings.render.mode);
        if mode == Mode::Full {
            return None;
        }
        self.ahead.next(&self.tracer, &self.cache, &placement, (camera, size))
    }

    /// The pose at which the policy wants a reference after the last frame.
    pub fn wanted_reference(&self) -> Option<Camera> {
        self.wanted
    }

    /// What tracing a reference at a pose takes, for this thread or another. Each has a seed of its own, so that the
    /// noise of several references is independent.
    pub fn reference_job(&mut self, camera: Camera, size: [u32; 2]) -> ReferenceJob {
        self.references_made += 1;
        let trace = self.settings.render.trace;
        ReferenceJob {
            tracer: Arc::clone(&self.tracer),
            camera,
            size,
            settings: settings_of_reference(&trace, u64::from(self.references_made)),
            known: self.settings.render.mode.looks_up().then(|| self.cache.snapshot()),
        }
    }

    /// Adds a finished reference. One of another epoch is refused and `None` returned.
    pub fn insert(&mut self, reference: ReferenceFrame) -> Option<ReferenceId> {
        (reference.epoch == self.tracer.epoch()).then(|| self.cache.insert(Arc::new(reference)))
    }
}

/// The references that a frame of a mode reuses: those selected for the view in mode `paper`, the
/// whole cache elsewhere.
fn references_of<'a>(
    mode: Mode,
    cache: &'a ReferenceCache,
    selected: &'a [&'a ReferenceFrame],
) -> References<'a> {
    if mode == Mode::Paper { References::Warped(selected) } else { References::Cached(cache) }
}
