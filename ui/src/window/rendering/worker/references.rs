//! References: when one is asked for, and what becomes of it.

use crate::window::rendering::references::{Job, Outcome};
use crate::window::rendering::render_thread::Message;
use crate::window::rendering::worker::Worker;
use afterimage::{Camera, Walkthrough};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Where a reference stands, and its size.
pub(crate) type RequestedPose = (Camera, [u32; 2]);

/// A reference in the making.
pub(crate) struct Running {
    cancel: Arc<AtomicBool>,
    place: RequestedPose,
}

impl Worker {
    pub(crate) fn take_in(&mut self, outcome: Outcome) {
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

    /// Starts the reference that was asked for or that the policy wants, unless one is in the making.
    pub(crate) fn request_reference(&mut self) {
        if self.job.is_some() || !self.can_render() {
            return;
        }
        // What a frame that is gone on with lights is kept: no reference need light it again.
        let goes_on = self.can_resume(self.shared.generation.load(Ordering::Acquire));
        let (Some(walk), Some(request)) = (&mut self.walk, self.request) else { return };
        let wanted = || {
            let camera = wanted(walk, request.size).filter(|_| !goes_on)?;
            (!self.refused.contains(&(camera, request.size))).then_some(camera)
        };
        let Some(camera) = self.asked.take().or_else(wanted) else { return };
        let cancel = Arc::new(AtomicBool::new(false));
        let job = Job { reference: walk.reference_job(camera, request.size), cancel: cancel.clone() };
        if self.jobs.send(job).is_ok() {
            self.job = Some(Running { cancel, place: (camera, request.size) });
            self.shared.is_adding.store(true, Ordering::Release);
            (self.wake)();
        }
    }

    /// The outcome still arrives and is then dropped.
    pub(crate) fn cancel_reference(&mut self) {
        self.asked = None;
        if let Some(job) = &self.job {
            job.cancel.store(true, Ordering::Release);
        }
    }
}

/// The pose at which the policy wants a reference, unless there already is one in use of just that pose: a view whose Type 3
/// stays high all the same would ask for it for ever. One that is switched off is as good as gone, and replaced.
fn wanted(walk: &Walkthrough, size: [u32; 2]) -> Option<Camera> {
    let camera = walk.wanted_reference()?;
    let is_same = |e: &afterimage::reference::cache::CachedReference| {
        e.is_enabled && e.frame.camera == camera && e.frame.view.size == size
    };
    (!walk.cache().entries().iter().any(is_same)).then_some(camera)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::rendering::render_thread::RenderRequest;
    use afterimage::reference::PlacementPolicy;
    use afterimage::reference::placement::THRESHOLD;
    use afterimage::scene::{Material, SceneBuilder};
    use afterimage::{Mode, Tracer, WalkthroughSettings};
    use crossbeam_channel::{Receiver, unbounded};
    use glam::{DVec3, Vec2, Vec3};
    use std::time::Duration;

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
        let request = RenderRequest {
            camera,
            size: [16, 16],
            settings,
            budget: Some(Duration::from_secs(3600)),
            is_paused: false,
            is_compared: false,
        };
        let (jobs, sent) = unbounded();
        let (messages, said) = unbounded();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let mut worker = Worker::new(Arc::default(), pool, jobs, messages, Arc::new(|| {}));
        (worker.walk, worker.request) = (Some(Walkthrough::new(tracer, settings)), Some(request));
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
        if let Some(request) = &mut worker.request {
            request.settings.render.trace.samples += 1;
        }
        worker.render(0);
        worker.request_reference();
        assert_eq!(sent.try_iter().count(), 1);
    }

    #[test]
    fn a_reference_that_is_switched_off_is_replaced_at_its_pose_and_only_once() {
        let (mut worker, sent, _said) = worker();
        worker.render(0);
        let trace_one = |worker: &mut Worker| {
            worker.request_reference();
            let job = sent.try_recv().ok()?;
            let frame = job.reference.trace(&|| false).expect("nobody stops it");
            worker.take_in(Outcome::Traced(Box::new(frame)));
            worker.render(0);
            Some(())
        };
        assert!(trace_one(&mut worker).is_some() && trace_one(&mut worker).is_none());
        let walk = worker.walk.as_mut().unwrap();
        let first = walk.cache().entries()[0].id;
        walk.cache_mut().set_enabled(first, false);
        worker.render(0);
        assert!(trace_one(&mut worker).is_some() && trace_one(&mut worker).is_none());
        let entries = worker.walk.as_ref().unwrap().cache().entries();
        assert!(entries.len() == 2 && entries[0].frame.camera == entries[1].frame.camera);
    }
}
