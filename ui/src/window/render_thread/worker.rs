//! The work of the thread that makes frames: takes wishes in, renders, asks for references, hands pictures out.

use super::{Lending, Message, Order, Picture, Shared, Wake, Wish};
use crate::picture::memory;
use crate::window::frames::{PublishedFrame, locked};
use crate::window::reference_thread::{Job, Outcome};
use afterimage::reference::{ReferenceFrame, ReferenceId};
use afterimage::{Camera, Walkthrough};
use crossbeam_channel::Sender;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

/// The window and a software rasteriser's threads go first: on two cores without a graphics card the window came
/// round every 300 ms while the gallery was rendered, and every 75 ms since. References stay equal to frames: the
/// frames after them are the cheaper.
const NICENESS: i32 = 10;

/// A picture that is gone on with, and one at rest, is shown anew after so long: often enough to be seen converging, seldom enough that drawing it is
/// little beside tracing it. Whatever changes ends the work at once.
const REFINE_TIME: Duration = Duration::from_millis(200);

/// Lowers the priority of the calling thread.
pub(in crate::window) fn give_way() {
    // Elsewhere it is the whole process that becomes nicer. Refused means equal shares: nothing is wrong then.
    #[cfg(target_os = "linux")]
    let _ = rustix::process::nice(NICENESS);
    #[cfg(not(target_os = "linux"))]
    let _ = NICENESS;
}

/// Where a reference stands, and its size.
pub(super) type Place = (Camera, [u32; 2]);

/// A reference in the making.
pub(super) struct Running {
    cancel: Arc<AtomicBool>,
    place: Place,
}

/// What the frames' thread owns.
pub(super) struct Worker {
    pub(super) shared: Arc<Shared>,
    pub(super) pool: rayon::ThreadPool,
    pub(super) jobs: Sender<Job>,
    pub(super) messages: Sender<Message>,
    pub(super) wake: Wake,
    pub(super) walk: Option<Walkthrough>,
    pub(super) wish: Option<Wish>,
    /// Ends the reference in the making.
    pub(super) job: Option<Running>,
    /// Poses and sizes at which tracing a reference failed: the policy would ask for them for ever.
    pub(super) refused: Vec<Place>,
    /// A reference asked for by hand while another was in the making.
    pub(super) asked: Option<Camera>,
    pub(super) wants_picture: bool,
    /// The generation of the last frame, `None` where it is to be made again.
    pub(super) rendered: Option<u64>,
    /// The generation whose picture has converged.
    pub(super) converged: Option<u64>,
    pub(super) added: Vec<(ReferenceId, Instant)>,
}

impl Worker {
    pub(super) fn run(&mut self) {
        while let Some(generation) = self.wait() {
            if self.can_render() && self.rendered != Some(generation) {
                self.render(generation);
            } else if self.can_resume(generation) {
                self.resume(generation);
            } else if self.can_refine(generation) {
                self.refine(generation);
            }
            self.request_reference();
            self.hand_out_picture();
        }
        self.cancel_reference();
    }

    /// Sleeps until there is something to do and takes it in. Returns the generation taken in, `None` at the end.
    fn wait(&mut self) -> Option<u64> {
        let shared = self.shared.clone();
        let mut inbox = locked(&shared.inbox);
        loop {
            if shared.quit.load(Ordering::Acquire) {
                return None;
            }
            let generation = shared.generation.load(Ordering::Acquire);
            if std::mem::take(&mut inbox.forgets_wish) {
                self.wish = None;
            }
            let wish = inbox.wish.or(self.wish);
            let is_due = self.rendered != Some(generation)
                && self.walk.is_some()
                && wish.is_some_and(|w| !w.is_paused && !w.size.contains(&0));
            let has_news = inbox.wish.is_some() || !inbox.orders.is_empty() || !inbox.outcomes.is_empty();
            // Settings of a new wish are taken in before anything is gone on with.
            let can_go_on = !is_due
                && inbox.wish.is_none()
                && (self.can_resume(generation) || self.can_refine(generation));
            if is_due || has_news || can_go_on {
                let is_new = inbox.wish.is_some();
                self.wish = wish;
                inbox.wish = None;
                let (orders, outcomes) =
                    (std::mem::take(&mut inbox.orders), std::mem::take(&mut inbox.outcomes));
                drop(inbox);
                if is_new {
                    self.refuse_too_large();
                }
                outcomes.into_iter().for_each(|o| self.take_in(o));
                orders.into_iter().for_each(|o| self.carry_out(o));
                return Some(generation);
            }
            inbox = shared.bell.wait(inbox).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// A wish that memory cannot hold is dropped with a message: a failed allocation would end the program.
    fn refuse_too_large(&mut self) {
        let Some([width, height]) = self.wish.map(|w| w.size) else { return };
        if let Err(why) = memory::check(u64::from(width) * u64::from(height), 1) {
            self.wish = None;
            self.say(Message::Failed(format!("a picture of {width} x {height}: {why}")));
            (self.wake)();
        }
    }

    fn can_render(&self) -> bool {
        self.walk.is_some() && self.wish.is_some_and(|w| !w.is_paused && !w.size.contains(&0))
    }

    /// True where the last frame is still wanted and was cut at the budget.
    fn can_resume(&self, generation: u64) -> bool {
        let is_shown = self.rendered == Some(generation) && self.can_render();
        is_shown && self.walk.as_ref().is_some_and(Walkthrough::can_resume)
    }

    /// True where the last frame is still wanted and its picture has not converged. A reference in the making goes first:
    /// the next frames are the cheaper for it.
    fn can_refine(&self, generation: u64) -> bool {
        let is_shown = self.rendered == Some(generation) && self.converged != Some(generation);
        let is_compared = self.wish.is_some_and(|w| w.is_compared);
        is_shown && !is_compared && self.job.is_none() && self.asked.is_none() && self.can_render()
    }

    fn carry_out(&mut self, order: Order) {
        match order {
            Order::SetTracer(tracer) => {
                self.cancel_reference();
                self.shared.abandon.store(false, Ordering::Release);
                let settings = self.wish.map(|w| w.settings).unwrap_or_default();
                // A new walk rather than the old one with another tracer: what is not traced yet in the first frame
                // would show the old scene.
                self.walk = Some(Walkthrough::new(tracer, settings).showing_unfinished());
                self.added.clear();
                self.refused.clear();
            }
            Order::AddReference(camera) => self.asked = Some(camera),
            Order::Remove(id) => {
                if let Some(walk) = &mut self.walk {
                    walk.cache_mut().remove(id);
                }
            }
            Order::Enable(id, is_enabled) => {
                if let Some(walk) = &mut self.walk {
                    walk.cache_mut().set_enabled(id, is_enabled);
                }
            }
            Order::Lend(id) => self.lend(id),
            Order::Clear => {
                self.cancel_reference();
                if let Some(walk) = &mut self.walk {
                    walk.cache_mut().clear();
                }
            }
            Order::Picture => self.wants_picture = true,
        }
    }

    fn take_in(&mut self, outcome: Outcome) {
        let job = self.job.take();
        let was_cancelled = job.as_ref().is_none_or(|job| job.cancel.load(Ordering::Acquire));
        self.shared.is_adding.store(false, Ordering::Release);
        match outcome {
            Outcome::Traced(frame) if !was_cancelled => {
                let id = self.walk.as_mut().and_then(|walk| walk.insert(*frame));
                self.added.extend(id.map(|id| (id, Instant::now())));
                if let Some(walk) = &self.walk {
                    self.added.retain(|(id, _)| walk.cache().entries().iter().any(|e| e.id == *id));
                }
            }
            Outcome::Panicked(text) => {
                self.refused.extend(job.filter(|_| !was_cancelled).map(|job| job.place));
                self.say(Message::Failed(format!("tracing a reference failed: {text}")))
            }
            Outcome::Traced(_) | Outcome::Cancelled => {}
        }
        (self.wake)();
    }

    fn render(&mut self, generation: u64) {
        let (Some(walk), Some(wish)) = (&mut self.walk, self.wish) else { return };
        let start = Instant::now();
        let shared = &*self.shared;
        let stop = || {
            let is_useless = shared.quit.load(Ordering::Relaxed) || shared.abandon.load(Ordering::Relaxed);
            is_useless || start.elapsed() >= wish.budget
        };
        if *walk.settings() != wish.settings {
            walk.set_settings(wish.settings);
            self.refused.clear();
        }
        if wish.is_compared {
            walk.drop_refinement();
        }
        let mut published = shared.exchange.spare();
        let added = &self.added;
        let made = catch_unwind(AssertUnwindSafe(|| {
            self.pool.install(|| {
                walk.render(&wish.camera, wish.size, &stop);
                published.fill(walk.frame(), &walk.tracer().scene().frame, walk.used(), generation);
                published.list(walk.cache(), walk.used(), added);
            });
        }));
        self.rendered = Some(generation);
        shared.frames_rendered.fetch_add(1, Ordering::AcqRel);
        self.publish(made.map(|()| Some(published)));
    }

    /// Goes on for a while with the last frame, which was cut at the budget.
    fn resume(&mut self, generation: u64) {
        let Some(walk) = &mut self.walk else { return };
        let start = Instant::now();
        let shared = &*self.shared;
        let is_useless = || shared.is_useless(generation);
        let stop = || is_useless() || start.elapsed() >= REFINE_TIME;
        let mut published = shared.exchange.spare();
        let added = &self.added;
        let made = catch_unwind(AssertUnwindSafe(|| {
            self.pool.install(|| {
                walk.resume(&stop);
                if is_useless() {
                    return None;
                }
                published.fill(walk.frame(), &walk.tracer().scene().frame, walk.used(), generation);
                published.list(walk.cache(), walk.used(), added);
                published.is_refinement = !walk.frame().stats.is_complete;
                Some(published)
            })
        }));
        self.publish(made);
    }

    /// Goes on with the picture of the last frame for a while.
    fn refine(&mut self, generation: u64) {
        let Some(walk) = &mut self.walk else { return };
        let start = Instant::now();
        let shared = &*self.shared;
        let is_useless = || shared.is_useless(generation);
        let stop = || is_useless() || start.elapsed() >= REFINE_TIME;
        let mut published = shared.exchange.spare();
        let added = &self.added;
        let made = catch_unwind(AssertUnwindSafe(|| {
            self.pool.install(|| {
                let state = walk.refine(&stop);
                if is_useless() || state.of == 0 {
                    return (state, None);
                }
                published.fill(walk.frame(), &walk.tracer().scene().frame, walk.used(), generation);
                published.list(walk.cache(), walk.used(), added);
                published.is_refinement = true;
                (state, Some(published))
            })
        }));
        let has_converged = made.as_ref().map_or(true, |(state, _)| state.is_complete);
        self.converged = has_converged.then_some(generation);
        self.publish(made.map(|(_, published)| published));
    }

    /// Shows what was made. After a panic the walk begins anew.
    fn publish(&mut self, made: std::thread::Result<Option<PublishedFrame>>) {
        match made {
            Ok(Some(published)) if !self.shared.abandon.load(Ordering::Acquire) => {
                self.shared.exchange.publish(published);
            }
            Ok(_) => {}
            Err(panic) => {
                // Its buffers may be half-written; the scene is not.
                if let (Some(walk), Some(wish)) = (&mut self.walk, self.wish) {
                    *walk = Walkthrough::new(walk.tracer().clone(), wish.settings).showing_unfinished();
                }
                let text = panic_text(&*panic);
                self.say(Message::Failed(format!("rendering failed: {text}")));
            }
        }
        (self.wake)();
    }

    /// Starts the reference that was asked for or that the policy wants, unless one is in the making.
    fn request_reference(&mut self) {
        if self.job.is_some() || !self.can_render() {
            return;
        }
        // What a frame that is gone on with lights is kept: no reference need light it again.
        let goes_on = self.can_resume(self.shared.generation.load(Ordering::Acquire));
        let (Some(walk), Some(wish)) = (&mut self.walk, self.wish) else { return };
        let wanted = || {
            let camera = wanted(walk, wish.size).filter(|_| !goes_on)?;
            (!self.refused.contains(&(camera, wish.size))).then_some(camera)
        };
        let Some(camera) = self.asked.take().or_else(wanted) else { return };
        let cancel = Arc::new(AtomicBool::new(false));
        let job = Job { reference: walk.reference_job(camera, wish.size), cancel: cancel.clone() };
        if self.jobs.send(job).is_ok() {
            self.job = Some(Running { cancel, place: (camera, wish.size) });
            self.shared.is_adding.store(true, Ordering::Release);
            (self.wake)();
        }
    }

    /// The outcome still arrives and is then dropped.
    fn cancel_reference(&mut self) {
        self.asked = None;
        if let Some(job) = &self.job {
            job.cancel.store(true, Ordering::Release);
        }
    }

    fn hand_out_picture(&mut self) {
        let Some(walk) = self.walk.as_ref().filter(|_| self.wants_picture) else { return };
        let frame = walk.frame();
        let is_paused = self.wish.is_some_and(|w| w.is_paused);
        if frame.radiance.is_empty() || !(frame.stats.is_complete || is_paused) {
            return;
        }
        self.wants_picture = false;
        self.say(Message::Picture(Picture {
            size: frame.view.size,
            radiance: frame.radiance.clone(),
            scene: walk.tracer().scene().clone(),
            camera: frame.camera,
            settings: walk.settings().render,
            is_complete: frame.stats.is_complete,
            refined: frame.stats.refined,
            references: useful_references(walk),
        }));
        (self.wake)();
    }

    /// Hands out what a reference holds: what does not depend on the viewer.
    fn lend(&self, id: ReferenceId) {
        let Some(walk) = &self.walk else { return };
        let entry = walk.cache().entries().iter().find(|e| e.id == id);
        let radiance = entry.map(|entry| {
            let (frame, tracer) = (&entry.frame, walk.tracer());
            let count = frame.view.pixel_count() as u32;
            (0..count).map(|p| frame.has_light(p).then(|| frame.diffuse_radiance(tracer, p))).collect()
        });
        let (camera, size) =
            entry.map_or((walk.frame().camera, [0, 0]), |e| (e.frame.camera, e.frame.view.size));
        self.say(Message::Lent(Lending { id, camera, size, radiance }));
        (self.wake)();
    }

    fn say(&self, message: Message) {
        // Nobody listens once the window is gone.
        let _ = self.messages.send(message);
    }
}

/// The pose at which the policy wants a reference, unless there already is one of just that pose: a view whose Type 3
/// stays high all the same would ask for it for ever.
fn wanted(walk: &Walkthrough, size: [u32; 2]) -> Option<Camera> {
    let camera = walk.wanted_reference()?;
    let is_same = |e: &afterimage::reference::cache::CachedReference| {
        e.frame.camera == camera && e.frame.view.size == size
    };
    (!walk.cache().entries().iter().any(is_same)).then_some(camera)
}

/// What another picture of the same view can be made from.
fn useful_references(walk: &Walkthrough) -> Vec<Arc<ReferenceFrame>> {
    let is_used = |id| walk.settings().render.mode.looks_up() || walk.used().contains(&id);
    walk.cache().entries().iter().filter(|e| is_used(e.id)).map(|e| Arc::clone(&e.frame)).collect()
}

/// What a panic said.
pub(in crate::window) fn panic_text(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|s| (*s).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no message".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use afterimage::reference::PlacementPolicy;
    use afterimage::reference::placement::THRESHOLD;
    use afterimage::scene::{Material, SceneBuilder};
    use afterimage::{Mode, Tracer, WalkthroughSettings};
    use crossbeam_channel::{Receiver, unbounded};
    use glam::{DVec3, Vec2, Vec3};

    fn worker() -> (Worker, Receiver<Job>, Receiver<Message>) {
        let mut builder = SceneBuilder::new("square");
        let material = builder.add_material(Material::diffuse("m", Vec3::ONE));
        let corners = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
        builder.add_quad(corners, Vec2::ONE, material);
        let tracer = Arc::new(Tracer::new(Arc::new(builder.finish().unwrap())));
        let mut settings = WalkthroughSettings {
            placement: PlacementPolicy::new(&THRESHOLD, 5.0),
            ..WalkthroughSettings::default()
        };
        settings.render.mode = Mode::Paper;
        let camera = Camera::look_at(DVec3::new(0.5, 0.5, 0.5), DVec3::new(0.5, 0.5, 0.0), 60.0);
        let wish = Wish {
            camera,
            size: [16, 16],
            settings,
            budget: Duration::from_secs(3600),
            is_paused: false,
            is_compared: false,
        };
        let (jobs, sent) = unbounded();
        let (messages, said) = unbounded();
        let worker = Worker {
            shared: Arc::default(),
            pool: rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap(),
            jobs,
            messages,
            wake: Arc::new(|| {}),
            walk: Some(Walkthrough::new(tracer, settings)),
            wish: Some(wish),
            job: None,
            refused: Vec::new(),
            asked: None,
            wants_picture: false,
            rendered: None,
            converged: None,
            added: Vec::new(),
        };
        (worker, sent, said)
    }

    #[test]
    fn a_reference_that_failed_is_not_asked_for_again_until_settings_change() {
        let (mut worker, sent, said) = worker();
        worker.render(0);
        worker.request_reference();
        assert_eq!(sent.try_iter().count(), 1, "the first view has no reference");
        worker.take_in(Outcome::Panicked("a bug".to_owned()));
        assert!(matches!(said.try_recv(), Ok(Message::Failed(text)) if text.contains("a bug")));
        worker.request_reference();
        worker.render(0);
        worker.request_reference();
        assert_eq!(sent.try_iter().count(), 0);
        if let Some(wish) = &mut worker.wish {
            wish.settings.render.trace.samples += 1;
        }
        worker.render(0);
        worker.request_reference();
        assert_eq!(sent.try_iter().count(), 1);
    }
}
