//! A walk: frame after frame from a cache of references, and requests for new references where the
//! placement policy wants them.
//!
//! The window and the headless tour run the same walk. They differ only in when a requested
//! reference is traced.

use super::frame::{Frame, RefineState};
use super::measures::FrameMeasures;
use super::placing::Placing;
use super::refinement::Refinement;
use super::request::{FrameRequest, References};
use super::settings::{Mode, RenderSettings, WalkthroughSettings};
use super::{prefetch::Prefetch, preview, reference_job::ReferenceJob, renderer::Renderer};
use crate::camera::{Camera, View};
use crate::reference::{
    GroupTracer, ReferenceCache, ReferenceFrame, ReferenceId, cache::CachedReference, settings_of_reference,
};
use crate::store::StoreSession;
use crate::trace::Tracer;
use crate::trace::parallel::{NEVER, Stop};
use crate::trace::section::CutPlane;
use crate::warp::ReferenceSelector;
use std::{sync::Arc, time::Instant};

/// The state of a walk.
#[derive(Debug)]
pub struct Walkthrough {
    pub(super) tracer: Arc<Tracer>,
    pub(super) cache: ReferenceCache,
    selector: ReferenceSelector,
    pub(super) renderer: Renderer,
    pub(super) settings: WalkthroughSettings,
    previous: Option<Camera>,
    wanted: Option<Camera>,
    prefetch: Prefetch,
    used: Vec<ReferenceId>,
    pub(super) references_made: u32,
    has_kept: bool,
    /// Settings of the last frame.
    rendered: RenderSettings,
    /// References that mode `paper` warped into the last frame.
    selected: Vec<CachedReference>,
    /// Version of the cache when the last frame was rendered.
    rendered_from: u64,
    measures: FrameMeasures,
    /// The picture of the last frame's pose, once [`Self::refine`] has begun it.
    pub(super) refinement: Option<Refinement>,
    /// Samples of the last reference that was stored of it.
    pub(super) refined_stored: u32,
    has_previews: bool,
    /// Pictures are refined beyond the passes after which they count as converged.
    is_endless: bool,
    /// `None` where references are not stored.
    pub(super) store: Option<StoreSession>,
    /// Traces the light of references by groups; `None` before that is asked for.
    pub(super) group_tracer: Option<Arc<GroupTracer>>,
}

impl Walkthrough {
    /// Starts a walk with an empty cache.
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
            prefetch: Prefetch::default(),
            used: Vec::new(),
            references_made: 0,
            has_kept: false,
            rendered: settings.render,
            selected: Vec::new(),
            rendered_from: 0,
            measures: FrameMeasures::default(),
            refinement: None,
            refined_stored: 0,
            has_previews: false,
            is_endless: false,
            store: None,
            group_tracer: None,
        }
    }

    /// The scene of the walk, ready to be traced.
    pub fn tracer(&self) -> &Arc<Tracer> {
        &self.tracer
    }

    /// Changes the scene, or its state. References of the old scene are dropped.
    pub fn set_tracer(&mut self, tracer: Arc<Tracer>) {
        self.drop_refinement();
        self.tracer = tracer;
        self.cache = ReferenceCache::new(self.tracer.scene(), self.settings.cache_bytes);
        (self.previous, self.wanted) = (None, None);
        self.measures = FrameMeasures::default();
        if let Some(store) = &mut self.store {
            store.set_tracer(&self.tracer);
        }
        *self.renderer.frame_mut() = Frame::default();
        self.selected.clear();
    }

    /// Sets whether frames show the light that arrives at surfaces, as
    /// [`Tracer::showing_light`] says. References and light traced so far serve both.
    pub fn show_light(&mut self, shows_light: bool) {
        if self.tracer.shows_light() == shows_light {
            return;
        }
        self.drop_refinement();
        self.renderer.store_points(&self.tracer);
        self.tracer = Arc::new(self.tracer.showing_light(shows_light));
        self.measures = FrameMeasures::default();
        // Pixels that the first frame has not traced yet would show the other kind.
        *self.renderer.frame_mut() = Frame::default();
    }

    /// Cuts the scene by planes for the camera from the next frame on; without planes, it is shown
    /// whole. References stay: light does not see the section. `tones` are those of
    /// [`Tracer::with_section`].
    pub fn set_section(&mut self, planes: &[CutPlane], tones: [f32; 2]) {
        let cut = self.tracer.with_section(planes, tones);
        if cut.section() != self.tracer.section() {
            self.drop_refinement();
            self.tracer = Arc::new(cut);
        }
    }

    /// The references.
    pub fn cache(&self) -> &ReferenceCache {
        &self.cache
    }

    /// The references, to be changed.
    pub fn cache_mut(&mut self) -> &mut ReferenceCache {
        &mut self.cache
    }

    /// The settings of the next frame.
    pub fn settings(&self) -> &WalkthroughSettings {
        &self.settings
    }

    /// Changes the settings from the next frame on.
    pub fn set_settings(&mut self, settings: WalkthroughSettings) {
        self.cache.set_budget_bytes(settings.cache_bytes);
        self.settings = settings;
    }

    /// The same walk for display: frames may be stopped and shown before they are complete.
    #[must_use]
    pub fn progressive(mut self) -> Self {
        self.renderer.set_progressive(true);
        self
    }

    /// Sets whether a view that is mostly unknown is lit coarsely before its first frame.
    pub fn set_previews(&mut self, has_previews: bool) {
        self.has_previews = has_previews;
    }

    /// Sets whether [`Self::refine`] adds passes for as long as the camera is stationary, up to
    /// 16384, and not only until the picture counts as converged.
    pub fn set_endless(&mut self, is_endless: bool) {
        self.is_endless = is_endless;
    }

    /// The last frame.
    pub fn frame(&self) -> &Frame {
        self.renderer.frame()
    }

    /// The references that the last frame used, in the order of [`Frame::supplier`].
    pub fn used(&self) -> &[ReferenceId] {
        &self.used
    }

    /// Renders the next frame. Afterwards [`Self::wanted_reference`] returns the pose of a new
    /// reference, if the policy wants one.
    pub fn render(&mut self, camera: &Camera, size: [u32; 2], stop: Stop<'_>) -> &Frame {
        self.read_store(camera, size);
        let start = Instant::now();
        self.keep_refinement(camera, size);
        self.rendered = self.settings.render;
        self.prepare_cells();
        self.preview(camera, size);
        self.select(camera, size);
        let select_secs = start.elapsed().as_secs_f64();
        self.run(camera, size, stop, Renderer::render);
        self.conclude(select_secs);
        self.previous = Some(*camera);
        if let Some(refinement) = &self.refinement {
            refinement.write_to(self.renderer.frame_mut());
        }
        self.renderer.frame()
    }

    /// Continues the last frame where a stop left it. A frame that is complete, or whose settings
    /// or references have changed since, stays as it is.
    pub fn resume(&mut self, stop: Stop<'_>) -> &Frame {
        if self.can_resume() {
            let (camera, size) = (self.frame().camera, self.frame().view.size);
            self.run(&camera, size, stop, Renderer::resume);
            self.conclude(0.0);
        }
        self.renderer.frame()
    }

    /// True where the last frame was stopped and [`Self::resume`] can continue it.
    pub fn can_resume(&self) -> bool {
        let frame = self.renderer.frame();
        let is_same = self.rendered == self.settings.render && self.cache.version() == self.rendered_from;
        is_same && !frame.stats.is_complete && !frame.radiance.is_empty()
    }

    /// Lights a reference of few pixels, without stop, where previews are wanted and a view that
    /// the last frame did not show is mostly unknown: the frame would show noise.
    fn preview(&mut self, camera: &Camera, size: [u32; 2]) {
        let render = &self.settings.render;
        let is_new = !preview::is_continued(self.frame(), camera, &self.tracer.scene().frame);
        let applies = is_new && self.has_previews && render.mode.looks_up() && render.trace.bounces > 0;
        if applies && let Some(size) = preview::preview_size(&self.tracer, &self.cache, camera, size) {
            let reference = self.reference_job(*camera, size).trace(NEVER);
            reference.map(|reference| self.cache.insert(Arc::new(reference)));
        }
    }

    /// Prepares the cells in which paths end, in the modes that reuse light by place.
    fn prepare_cells(&mut self) {
        if self.settings.render.mode.looks_up() {
            self.cache.prepare_cells(self.tracer.scene(), &self.settings.render.trace);
        }
    }

    /// Mode `paper`: chooses the references to be warped. Other modes use the whole cache.
    fn select(&mut self, camera: &Camera, size: [u32; 2]) {
        self.selected.clear();
        if self.rendered.mode == Mode::Paper {
            let view = View::new(camera, &self.tracer.scene().frame, size);
            let (epoch, most) = (self.tracer.epoch(), self.settings.max_references);
            self.selected = self.selector.select(&mut self.cache, &view, epoch, most);
        }
    }

    /// Starts or resumes a frame with the selected references.
    fn run(
        &mut self,
        camera: &Camera,
        size: [u32; 2],
        stop: Stop<'_>,
        render: impl for<'r> Fn(&'r mut Renderer, &FrameRequest<'_>) -> &'r Frame,
    ) {
        let frames: Vec<&ReferenceFrame> = self.selected.iter().map(|r| &*r.frame).collect();
        let references = match self.rendered.mode {
            Mode::Paper => References::Warped(&frames),
            _ => References::Cached(&self.cache),
        };
        let (tracer, settings) = (&*self.tracer, &self.rendered);
        let request = FrameRequest::new(tracer, camera, size, settings).with_stop(stop);
        render(&mut self.renderer, &FrameRequest { references, ..request });
    }

    /// Updates the cache after a frame, decides whether a reference is wanted, and measures the
    /// frame's error and stability where that is enabled.
    fn conclude(&mut self, select_secs: f64) {
        let start = Instant::now();
        self.rendered_from = self.cache.version();
        self.keep_frame();
        self.used = match self.settings.render.mode.looks_up() {
            true => self.cache.ids_by_slot(),
            false => self.selected.iter().map(|r| r.id).collect(),
        };
        let (camera, size) = (self.frame().camera, self.frame().view.size);
        let shares = self.renderer.frame().supplier_shares(self.used.len());
        let shares: Vec<_> = self.used.iter().copied().zip(shares).collect();
        self.cache.note_contributions(&shares);
        let store = self.store.as_ref();
        self.renderer.frame_mut().stats.stored_share = store.map(|store| store.share_of(&shares));
        self.wanted = self.decide(&camera, size);
        if let Some(pose) = self.wanted
            && self.read_ahead(&pose, size)
        {
            self.wanted = self.decide(&camera, size);
        }
        let select_secs = select_secs + start.elapsed().as_secs_f64();
        let secs = &mut self.renderer.frame_mut().stats.secs;
        secs.select = select_secs;
        secs.frame += select_secs;
        self.measures.measure(&self.settings, &self.tracer, &mut self.cache, &mut self.renderer);
    }

    /// Turns a looked-up frame that had to shade many pixels itself into a reference, for the cost
    /// of a copy.
    fn keep_frame(&mut self) {
        let stats = &self.renderer.frame().stats;
        let shaded = stats.types.percentages().unseen_percent;
        let settings = &self.settings.render;
        self.has_kept =
            settings.mode.looks_up() && stats.is_complete && self.settings.placement.keeps(shaded);
        if self.has_kept {
            let reference = self.renderer.shaded_reference(&self.tracer, settings);
            self.renderer.show_shared_light(&self.tracer, &reference);
            self.add(reference);
        }
    }

    /// True where the last frame became a reference.
    pub fn has_kept_frame(&self) -> bool {
        self.has_kept
    }

    /// Refines the last frame's picture, for a stationary camera, until it has converged or `stop`
    /// is true. Pixels that had a pass show the mean of their passes, the others what they showed
    /// before. Stopped work is continued by the next call, also after another [`Self::render`] of
    /// the same pose; any other pose drops it and its memory.
    pub fn refine(&mut self, stop: Stop<'_>) -> RefineState {
        let (render, frame) = (self.settings.render, self.renderer.frame());
        let (camera, size, stats) = (frame.camera, frame.view.size, frame.stats);
        if !render.mode.refines() || frame.radiance.is_empty() {
            return RefineState { is_complete: true, ..RefineState::default() };
        }
        if stats.is_complete {
            self.renderer.store_points(&self.tracer);
        }
        self.keep_refinement(&camera, size);
        let is_unrefined = stats.is_complete && stats.refined == RefineState::default();
        let is_first_pass = render.mode == Mode::Full && self.rendered == render && is_unrefined;
        let first_pass = is_first_pass.then(|| self.renderer.frame());
        let refinement = self.refinement.get_or_insert_with(|| {
            Refinement::new(&FrameRequest::new(&self.tracer, &camera, size, &render), first_pass)
        });
        refinement.set_endless(self.is_endless);
        refinement.run(&self.tracer, &mut self.cache, stop);
        refinement.write_to(self.renderer.frame_mut());
        let state = refinement.state();
        self.store_refined();
        state
    }

    /// Drops the refinement if it belongs to another pose or other settings.
    fn keep_refinement(&mut self, camera: &Camera, size: [u32; 2]) {
        let render = &self.settings.render;
        let request = FrameRequest::new(&self.tracer, camera, size, render);
        if !self.refinement.as_ref().is_some_and(|r| render.mode.refines() && r.is_of(&request)) {
            self.drop_refinement();
        }
    }

    /// The pose of the reference that the policy wants after a frame.
    fn decide(&mut self, camera: &Camera, size: [u32; 2]) -> Option<Camera> {
        if let Some(pose) = self.wanted_ahead(camera, size) {
            return Some(pose);
        }
        let (tracer, cache, settings) = (&*self.tracer, &self.cache, &self.settings);
        let placing = Placing { tracer, cache, settings, selector: &mut self.selector };
        placing.decide(self.renderer.frame(), self.previous.unwrap_or(*camera))
    }

    /// The pose of a reference that the policy wants before this frame is rendered, whatever the
    /// frame shows.
    pub fn wanted_ahead(&mut self, camera: &Camera, size: [u32; 2]) -> Option<Camera> {
        if self.settings.render.mode == Mode::Full {
            return None;
        }
        self.prefetch.next(&self.tracer, &self.cache, &self.settings.placement, (camera, size))
    }

    /// The pose at which the policy wants a reference after the last frame.
    pub fn wanted_reference(&self) -> Option<Camera> {
        self.wanted
    }

    /// A job that traces a reference at a pose, on this thread or another. Each job has its own
    /// seed, so that the noise of several references is independent.
    pub fn reference_job(&mut self, camera: Camera, size: [u32; 2]) -> ReferenceJob {
        self.prepare_cells();
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

    /// Adds a finished reference. Returns `None` and drops it where it belongs to another epoch.
    pub fn insert(&mut self, reference: ReferenceFrame) -> Option<ReferenceId> {
        (reference.epoch == self.tracer.epoch()).then(|| self.add(reference))
    }

    fn add(&mut self, reference: ReferenceFrame) -> ReferenceId {
        let reference = Arc::new(reference);
        if let Some(store) = &mut self.store {
            store.keep(&reference, self.settings.render.mode.purpose());
        }
        self.cache.insert(reference)
    }
}
