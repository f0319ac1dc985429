//! Comparing with the full tracer: starts its picture once the view is at rest, drops it when the view changes, and
//! measures how far the two are apart.

use crate::window::app::App;
use crate::window::app::event::AppEvent;
use crate::window::gpu::presentation::Overlay;
use crate::window::gpu::viewport;
use crate::window::rendering::full_trace::{FullTracing, Subject};
use crate::window::rendering::render_thread::give_way;
use crate::window::state::{Compare, Pair, PictureError, difference};
use egui_wgpu::RenderState;

/// What measuring brings back.
pub(crate) type Measured = Result<(PictureError, Vec<[u8; 3]>), String>;

impl App {
    /// Takes the comparison a step further.
    pub(crate) fn compare(&mut self, graphics: Option<&RenderState>) {
        let subject = self.subject();
        if self.tracing.as_ref().is_some_and(|t| Some(t.subject()) != subject.as_ref()) {
            self.tracing = None;
            (self.state.comparison.full, self.state.comparison.error) = (None, None);
        }
        if self.state.comparison.is_wanted() && self.tracing.is_none() && self.is_at_rest() {
            subject.into_iter().for_each(|subject| self.start_tracing(subject));
        }
        let full = &mut self.state.comparison.full;
        if self.tracing.as_ref().is_some_and(|tracing| tracing.take(full))
            && let (Some(graphics), Some(full)) = (graphics, full)
        {
            viewport::upload_full(graphics, full);
        }
        self.measure();
    }

    /// What the full tracer would show now.
    fn subject(&self) -> Option<Subject> {
        let (tracer, frame) = (self.obstacles.as_ref()?.tracer().clone(), self.state.frame.as_ref()?);
        let camera = *self.state.navigation.fly.camera();
        Some(Subject { tracer, camera, size: frame.size, render: self.state.quality.walk.render })
    }

    /// True where the newest frame is complete and of just this view.
    fn is_at_rest(&self) -> bool {
        self.state.frame.as_ref().is_some_and(|frame| {
            let is_newest = frame.generation == self.threads.generation();
            is_newest && frame.stats.is_complete && frame.camera == *self.state.navigation.fly.camera()
        })
    }

    fn start_tracing(&mut self, subject: Subject) {
        let news = self.news.0.clone();
        // The window may be gone.
        let fail = move |text| drop(news.send(AppEvent::Failed(text)));
        match FullTracing::start(subject, self.thread_count(), self.wake.clone(), fail) {
            Ok(tracing) => self.tracing = Some(tracing),
            Err(error) => {
                self.state.comparison.shows = Compare::Off;
                self.state.error(format!("the full tracer cannot be started: {error}"));
            }
        }
    }

    /// Which two pictures there are to be measured.
    fn pair(&self) -> Option<Pair> {
        let (frame, full) = (self.state.frame.as_ref()?, self.state.comparison.full.as_ref()?);
        let is_pair = self.is_at_rest() && frame.camera == full.camera && frame.size == full.size;
        (is_pair && !frame.is_refinement).then_some((
            frame.generation,
            full.stats.refined.pass,
            self.state.quality.exposure_ev,
        ))
    }

    /// Measures on a thread of its own, one pair at a time.
    fn measure(&mut self) {
        let Some(pair) = self.pair().filter(|_| self.state.comparison.is_wanted()) else { return };
        let is_known = self.state.comparison.error.is_some_and(|(of, _)| of == pair);
        let (Some(frame), Some(full)) = (&self.state.frame, &self.state.comparison.full) else { return };
        if is_known || std::mem::replace(&mut self.is_measuring, true) {
            return;
        }
        let (size, quality) = (frame.size, self.state.quality);
        let [picture, full] = [frame, full].map(|f| f.radiance.clone());
        self.in_background("afterimage-measure", move || {
            give_way();
            let measured = difference(&picture, &full, size, &quality).map_err(|error| error.to_string());
            AppEvent::Measured(pair, size, measured)
        });
    }

    /// Takes in what was measured.
    pub(crate) fn take_measured(
        &mut self,
        pair: Pair,
        size: [u32; 2],
        measured: Measured,
        graphics: Option<&RenderState>,
    ) {
        self.is_measuring = false;
        match measured {
            // The view may have changed meanwhile.
            Ok((error, map)) if self.state.comparison.full.as_ref().is_some_and(|f| f.size == size) => {
                self.state.comparison.error = Some((pair, error));
                graphics.into_iter().for_each(|graphics| viewport::upload_errors(graphics, size, &map));
            }
            Ok(_) => {}
            Err(text) => self.state.error(format!("the pictures cannot be compared: {text}")),
        }
    }

    /// What lies over the picture.
    pub(crate) fn overlay(&self) -> Overlay {
        let comparison = &self.state.comparison;
        match (comparison.is_held, comparison.shows) {
            _ if comparison.full.is_none() => Overlay::None,
            (true, _) => Overlay::Full,
            (_, Compare::Split) => Overlay::RightOf(comparison.split),
            (_, Compare::Errors) if comparison.error.is_some() => Overlay::Errors,
            _ => Overlay::None,
        }
    }
}
